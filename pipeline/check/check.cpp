#include "pipeline/check/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/memory_budget.h"
#include "core/sequence.h"
#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "io/gltf/sequence/sequence_file.h"
#include "pipeline/check/against.h"
#include "pipeline/check/bake_anew.h"
#include "pipeline/check/certificate.h"
#include "pipeline/check/judge.h"
#include "pipeline/check/measure_keys.h"
#include "pipeline/lobes/parameters.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

constexpr double kLengthSlack = 1e-3, kMostDiagonals_fit = 1e6;

// A mean d cannot be longer than a ray, nor than the cloud. A fitted one can: where σ d is large, nothing tells how large (3500 diagonals
// were seen in the presets).
void boundDensities(const CheckedAsset& asset, CheckReport& report) {
  if (report.file.undone) return;
  const double diagonal = boundingBox(asset.cloud.surface).diagonal();
  const double most = report.run.info.lobe == "fit" ? kMostDiagonals_fit * diagonal : (1 + kLengthSlack) * diagonal;
  const auto over = std::count_if(asset.lobes.begin(), asset.lobes.end(), [&](const Lobe& lobe) { return double(lobe.thickness) > most; });
  if (over > 0)
    report.file.faults.push_back({"too-dense", "d is larger than the cloud at " + std::to_string(over) + " vertices",
                                  "scale d as the positions were scaled, or bake again"});
}

// The metadata of the asset, or the defaults of cloudbake.
void resolveMetadata(const Settings& settings, const StoredAsset& stored, CheckedAsset& asset, CheckReport& report) {
  const BakeParameters defaults = parametersFor(asset.cloud, settings);
  report.run.vertices = asset.cloud.surface.positions.size();
  report.run.triangles = asset.cloud.surface.triangles.size();
  AssetInfo& info = report.run.info;
  asset.has_metadata = stored.info.has_value();
  if (stored.info) {
    info = *stored.info;
    return;
  }
  info.extinction = defaults.extinction;
  info.shape = defaults.shape;
  info.method.clear();
}

// Measures and judges the asset, with lobes and rays as `report.run.info` and `ray_length` say.
void judgeReading(const CheckedAsset& asset, const Settings& settings, float ray_length, CheckReport& report) {
  boundDensities(asset, report);
  const AssetSample sample = measureAsset(asset, settings, ray_length, report);
  report.bounds = boundsFor(*report.figures, settings.judge.bounds);
  report.diagnosis = diagnose(sample.diagnosis);
  report.verdict = judge(asset, sample, report);
}

// k and b that a search finds, where no metadata tells those of the bake.
LobeShape shapeByDefault(const Cloud& cloud, const AssetInfo& info) {
  LobeShape shape;
  Warnings told_by_the_bake;
  lobesByDefault(cloud, info, {}, shape, told_by_the_bake);
  return shape;
}

// Rays are as long as those of the bake, or as the diagonal if the mesh was scaled since. Lobes without metadata may be mean, or
// fitted to either light.
// The first reading without a fault is taken, else the one that leaves the least error unexplained.
void judgeLobes(const CheckedAsset& asset, const Settings& settings, CheckReport& report) {
  const float diagonal = boundingBox(asset.cloud.surface).diagonal(), recorded = report.run.info.ray_length;
  std::vector<float> ray_lengths{diagonal};
  if (recorded > 0 && recorded < diagonal * (1 - kLengthSlack)) ray_lengths = {recorded, diagonal};
  std::vector<AssetInfo> readings{report.run.info};
  if (!asset.has_metadata) {
    AssetInfo& transmittance = readings.emplace_back(report.run.info);
    transmittance.lobe = "fit", transmittance.shape = {defaultShape(true).exponent, 0};
    AssetInfo& volume = readings.emplace_back(transmittance);
    volume.volume.emplace();
  }
  std::vector<CheckReport> attempts;
  for (const AssetInfo& reading : readings)
    for (const float ray_length : ray_lengths) {
      CheckReport& attempt = attempts.emplace_back(report);
      attempt.run.info = reading;
      if (reading.volume && !asset.has_metadata) attempt.run.info.shape = shapeByDefault(asset.cloud, reading);
      if (ray_length == diagonal && recorded > 0) attempt.run.info.ray_length = diagonal;
      judgeReading(asset, settings, ray_length, attempt);
      if (!attempt.verdict) {
        report = std::move(attempt);
        return;
      }
    }
  report = *std::min_element(attempts.begin(), attempts.end(), [](const CheckReport& a, const CheckReport& b) {
    return a.diagnosis->tried[a.diagnosis->best].error < b.diagnosis->tried[b.diagnosis->best].error;
  });
}

// The asset's mesh as a cloud, closed as the bake closed it.
Cloud cloudOfAsset(Sculpt sculpt, const Settings& settings, CheckReport& report, Stopwatch& watch) {
  Cloud cloud = cloudOfSculpt(std::move(sculpt), settings.mesh, report.run, watch);
  const Box box = boundingBox(cloud.surface);
  requireUsableSize(box);
  const double diagonal = box.diagonal(), area = surfaceArea(cloud.surface);
  constexpr double kLeastArea = 1e-9;  // of the square of the diagonal
  if (!(area > kLeastArea * diagonal * diagonal)) throw InputError("", "the triangles have no area");
  return cloud;
}

// All keys of a sequence are compared with new bakes of their meshes. The worst of them is judged as an asset is.
void checkKeys(const Settings& settings, const std::string& bytes, CheckReport& report, Stopwatch& watch) {
  const std::filesystem::path& file = settings.source.input;
  const CloudSequence sequence = decodeSequence(file, bytes, settings.source.memory_limit);
  report.run.info = sequence.info;
  for (const SequenceSegment& segment : sequence.segments)
    report.run.vertices += segment.keys.front().positions.size(), report.run.triangles += segment.triangles.size();
  watch.lap(report.run.seconds, "read");
  if ((report.verdict = oddConstants(report.run.info, meshAt(sequence, {}).surface))) return;
  SequenceFigures& figures = report.sequence.emplace(namingFile(file.string(), [&] { return measureKeys(sequence, settings.mesh); }));
  if (!sequence.seal.empty())
    figures.seal = sequence.seal == sealOf(sequence) ? SequenceFigures::Seal::kWhole : SequenceFigures::Seal::kBroken;
  watch.lap(report.run.seconds, "keys");

  const KeyFigures& worst = *worstOf(figures, true);
  BakedMesh mesh = meshAt(sequence, {worst.segment, worst.frame});
  CheckedAsset asset;
  asset.has_metadata = true;
  asset.most_disagreement = kKeyAgreement;
  asset.lobes = std::move(mesh.lobes);
  asset.to_scene.resize(asset.lobes.size());
  for (const Lobe& lobe : asset.lobes)
    report.file.uvs.push_back({{lobe.direction.x, lobe.direction.y}, {lobe.direction.z, lobe.thickness}});
  asset.cloud = cloudOfAsset(sculptOf("cloud", std::move(mesh.surface)), settings, report, watch);
  judgeLobes(asset, settings, report);
  if (report.verdict)
    report.verdict->what = fmt::format("the key at frame {:g}: {}", worst.frame, report.verdict->what);
  else
    report.verdict = judgeKeys(figures);
  watch.lap(report.run.seconds, "truth");
}

void checkAlone(const Settings& given, CheckReport& report, const std::function<void(const std::string&)>& on_stage) {
  const std::filesystem::path& file = given.source.input;
  Stopwatch watch(on_stage);
  report.run.input = file.string();
  requireMemoryForFile(file, given.source.memory_limit);
  const std::string bytes = readFileBytes(file);
  if (isSequence(bytes)) return checkKeys(given, bytes, report, watch);
  const StoredAsset stored = readStoredAsset(file, bytes, report.run.warnings, given.source.read);
  report.file = examineAsset(file, stored);
  Settings settings = given;
  if (stored.info && stored.info->wrapped) settings.mesh.close = CloseChoice::kWrap;
  watch.lap(report.run.seconds, "read");

  CheckedAsset asset;
  if (const auto& fatal = report.file.fatal) {
    report.verdict = *fatal;
    return;
  }
  try {
    asset.cloud = cloudOfAsset(stored.sculpt, settings, report, watch);
    for (const SculptPart& part : asset.cloud.sculpt.parts)
      for (size_t v = 0; v < part.positions.size(); ++v) asset.to_scene.push_back(part.toScene(v));
    resolveMetadata(settings, stored, asset, report);
    asset.harmonics = stored.harmonics;
    if (report.file.first_set < 0) {
      report.verdict = report.file.faults.front();
      return;
    }
    for (size_t v = 0; v < report.file.uvs.size(); ++v) asset.lobes.push_back(unpackLobe(report.file.uvs[v], asset.to_scene[v]));
    report.seal = sealDifference(asset, report.run.info, report.file.uvs);
    if (const auto odd = oddConstants(report.run.info, asset.cloud.surface)) {
      const auto stale = staleFault(report.seal);
      report.verdict = stale ? stale : odd;
      return;
    }
    judgeLobes(asset, settings, report);
  } catch (const MemoryError&) {
    throw;
  } catch (const InputError& error) {
    if (!error.file.empty() && error.file != file.string()) throw;  // of the lattice
    report.verdict = AssetFault{"no-volume", "nothing can be measured: " + error.message, "bake a mesh that encloses a volume"};
  }
  watch.lap(report.run.seconds, "truth");
}

void requireGltf(const std::filesystem::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension != ".glb" && extension != ".gltf")
    throw InputError(file.string(), "not a baked asset, which is a .glb or .gltf: run `cloudbake bake` first");
}

}  // namespace

CheckReport checkAsset(const Settings& settings, const std::function<void(const std::string& stage)>& on_stage) {
  requireGltf(settings.source.input);
  CheckReport report;
  if (settings.judge.against) requireGltf(*settings.judge.against);
  if (settings.judge.certificate) return checkCertificate(settings, on_stage);
  if (settings.judge.against) {
    return checkAgainst(settings.source.input, settings.judge, settings.source.read, on_stage);
  }
  checkAlone(settings, report, on_stage);
  return report;
}

}  // namespace cloudbake
