// A sample of the asset's vertices is compared with exact chords (docs/lobe_math.md).
//
// Default bounds of mean lobes: the median error of the direction is at most 10°, its rms 20°, and the mean of d is right within a quarter.
// Bakes of closed sculpts at default settings keep a median of 6° (docs/sculpts.md), and lobes that were flipped, swapped or turned are off
// by 30° to 120°. The default bound of fitted lobes is the rms of T of the mean lobes. A fit is below it by construction, and fitted lobes
// that were turned or scaled exceed it.

#include "pipeline/check/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bake/lobe/fit_lobe.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/shells.h"
#include "bake/truth/error_metrics.h"
#include "core/error.h"
#include "core/memory_budget.h"
#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "pipeline/asset.h"
#include "pipeline/check/against.h"
#include "pipeline/check/report.h"
#include "pipeline/measure/oracle.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

constexpr size_t kCheckedVertices = 200;
constexpr int kCheckedDirections = 1024;  // of the truth's mean lobes: 4096 change the rms of 2° by 0.02°
constexpr size_t kDiagnosisAxes = 32;     // about so many axes of the lights
constexpr double kMedian_degrees = 10, kRms_degrees = 20, kDensityBias = 0.25, kFitSlack = 0.01, kLengthSlack = 1e-3;

// The mesh and the lobes of an asset.
struct CheckedAsset {
  Cloud cloud;
  std::vector<Affine> to_scene;  // of every vertex
  std::vector<Lobe> lobes;
  bool has_metadata = false;
};

// The truth of the asset. If its objects were baked separately, each has its own.
Oracle askTruth(const CheckedAsset& asset, const Settings& settings, const OracleQuestion& question, CheckReport& report) {
  const size_t wanted = settings.judge.truth_vertices.value_or(kCheckedVertices), count = asset.cloud.surface.positions.size();
  if (!report.run.info.separate) return askOracle(asset.cloud, settings.field, wanted, question);
  Oracle all;
  size_t first = 0;
  for (const Cloud& object : separateObjects(asset.cloud, settings.mesh, report.run)) {
    const size_t own = object.surface.positions.size();
    const Oracle part = askOracle(object, settings.field, std::max<size_t>(1, wanted * own / count), question);
    all.name = part.name;
    all.axes = part.axes;
    for (const size_t v : part.vertices) all.vertices.push_back(first + v);
    all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
    all.truth.lobes.insert(all.truth.lobes.end(), part.truth.lobes.begin(), part.truth.lobes.end());
    all.truth.concentration.insert(all.truth.concentration.end(), part.truth.concentration.begin(), part.truth.concentration.end());
    all.lengths.insert(all.lengths.end(), part.lengths.begin(), part.lengths.end());
    all.light.insert(all.light.end(), part.light.begin(), part.light.end());
    for (SurfacePoint point : part.surface.points) {
      for (uint32_t& corner : point.corners) corner += uint32_t(first);
      all.surface.points.push_back(point);
    }
    all.surface.light.insert(all.surface.light.end(), part.surface.light.begin(), part.surface.light.end());
    first += own;
  }
  return all;
}

// Lobes fitted again to the truth with the asset's k and b: to exact chords over its σ, or to the volume at one σ.
std::vector<Lobe> fitAnew(const Oracle& oracle, const std::vector<float>& weights, const AssetInfo& info) {
  FitSettings fit;
  fit.shape = info.shape;
  const bool has_range = info.extinction_low > 0 && info.extinction_high >= info.extinction_low;
  fit.extinctions =
      has_range && !info.volume ? extinctionSteps(info.extinction_low, info.extinction_high) : std::vector<float>{info.extinction};
  const std::span<const float> targets = info.volume ? std::span(oracle.light) : std::span<const float>();
  return fitLobes(oracle.truth.lobes, {bothSenses(oracle.axes), oracle.lengths, weights, targets}, fit);
}

std::vector<uint32_t> piecesOfVertices(const SurfaceMesh& surface) {
  std::vector<uint32_t> pieces(surface.positions.size(), 0);
  const std::vector<Shell> shells = shellsOf(weldedByPosition(surface));
  for (uint32_t i = 0; i < shells.size(); ++i)
    for (const uint32_t triangle : shells[i].triangles)
      for (const uint32_t v : surface.triangles[triangle]) pieces[v] = i;
  return pieces;
}

// Through a sheet of thickness t a chord is t/cos θ long, so that half the median is t; on a ball half the median is half the radius.
float thicknessFrom(std::span<const float> lengths) {
  constexpr float kRounding = 1e-3F;  // of the longest; shorter chords come from rounding
  const float least = lengths.empty() ? 0 : kRounding * *std::max_element(lengths.begin(), lengths.end());
  std::vector<float> chords;
  std::copy_if(lengths.begin(), lengths.end(), std::back_inserter(chords), [&](float length) { return length > least; });
  if (chords.empty()) return 0;
  const auto middle = chords.begin() + ptrdiff_t(chords.size() / 2);
  std::nth_element(chords.begin(), middle, chords.end());
  return *middle / 2;
}

// The sample for the diagnosis: vertices that have a direction and finite lobes.
DiagnosisSample diagnosisSample(const CheckedAsset& asset, const Oracle& oracle, const std::vector<float>& weights,
                                const std::vector<Lobe>& truth, const CheckReport& report) {
  const std::vector<uint32_t> pieces = piecesOfVertices(asset.cloud.surface);
  const AssetInfo& info = report.run.info;
  const bool is_fit = report.figures->bake.is_fit;
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  const size_t stride = std::max<size_t>(1, oracle.axes.size() / kDiagnosisAxes);
  const auto is_chosen = [&](size_t light) { return light / 2 % stride == 0 && (weights.empty() || weights[light] > 0); };
  DiagnosisSample sample;
  sample.shape = info.shape;
  sample.extinction = info.extinction;
  for (size_t i = 0; is_fit && i < directions.size(); ++i)
    if (is_chosen(i)) sample.lights.push_back(directions[i]);
  for (size_t i = 0; i < oracle.vertices.size(); ++i) {
    const size_t v = oracle.vertices[i];
    const Lobe& lobe = asset.lobes[v];
    if (!isFinite(lobe.direction) || !std::isfinite(lobe.thickness) || (!is_fit && oracle.truth.concentration[i] < 0.1)) continue;
    sample.stored.push_back(report.file.uvs[v]);
    sample.to_scene.push_back(asset.to_scene[v]);
    sample.truth.push_back(truth[i]);
    sample.pieces.push_back(pieces[v]);
    sample.thickness.push_back(thicknessFrom(std::span(oracle.lengths).subspan(i * directions.size(), directions.size())));
    for (size_t light = 0; is_fit && light < directions.size(); ++light)
      if (is_chosen(light)) sample.true_fit.push_back(oracle.light[i * directions.size() + light]);
  }
  return sample;
}

// Measures a sample of vertices with rays of `ray_length`. `lobe` of the metadata says how to read the lobes.
DiagnosisSample measure(const CheckedAsset& asset, const Settings& settings, float ray_length, CheckReport& report) {
  const AssetInfo& info = report.run.info;
  const LightSet lights = judgingLights(info);
  const Oracle oracle =
      askTruth(asset, settings, {info.extinction, info.volume, ray_length, lights.axes, kCheckedDirections, true}, report);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  const auto rms = [&](const std::vector<Lobe>& of, LobeShape shape) {
    return compareLight(of, shape, directions, oracle.light, info.extinction, lights.weights);
  };
  CheckFigures& figures = report.figures.emplace();
  figures.bake = figuresAgainst(oracle, asset.lobes, info.lobe == "fit", info.shape, info.extinction, lights.weights);
  figures.lights = directions.size();
  std::vector<Lobe> truth = oracle.truth.lobes;
  if (figures.bake.is_fit) {
    truth = fitAnew(oracle, lights.weights, info);
    figures.mean_rms = rms(oracle.truth.lobes, defaultMeanShape(asset.cloud.surface)).rms;
    figures.best_fit_rms = rms(truth, info.shape).rms;
  }
  return diagnosisSample(asset, oracle, lights.weights, truth, report);
}

std::vector<FigureBound> boundsFor(const CheckFigures& figures, const ErrorBounds& asked) {
  std::vector<FigureBound> bounds;
  const auto bound = [&](const char* key, double most) { bounds.push_back({&figureField(key), most}); };
  if (asked.angle_degrees && !figures.bake.is_fit) bound("direction_rms_degrees", *asked.angle_degrees);
  if (asked.transmittance_rms) bound("transmittance_rms", *asked.transmittance_rms);
  for (const char* key : kSurfaceRmsKeys)
    if (asked.surface_rms) bound(key, *asked.surface_rms);
  if (!bounds.empty()) return bounds;
  if (figures.bake.is_fit) {
    bound("transmittance_rms", figures.mean_rms + kFitSlack);
  } else {
    bound("direction_median_degrees", kMedian_degrees);
    bound("direction_rms_degrees", kRms_degrees);
    bound("density_bias", kDensityBias);
  }
  return bounds;
}

// Whether the settings only give a rough bake. The longest side is at least 1/√3 of the diagonal, which is the length of a ray.
bool isRough(const AssetInfo& info) {
  return (info.rays > 0 && info.rays < 64) || (info.voxel_size > 0 && info.ray_length < 90 * info.voxel_size) || info.sampler == "uniform";
}

// No change of the whole asset explains the error, so the distribution of the error decides.
AssetFault unexplained(const std::string& over, const DiagnosisSample& sample, const CheckReport& report) {
  constexpr double kWrong = 0.25, kThinVoxels = 2, kUnrelated = 0.8, kSound = 0.15, kMostRight = 0.95, kNearBestFit = 1.15;
  std::vector<Lobe> lobes;
  for (size_t v = 0; v < sample.stored.size(); ++v) lobes.push_back(unpackLobe(sample.stored[v], sample.to_scene[v]));
  const std::vector<double> errors = vertexErrors(lobes, sample);
  size_t wrong = 0, thin = 0;
  for (size_t v = 0; v < errors.size(); ++v)
    if (errors[v] >= kWrong) ++wrong, thin += sample.thickness[v] < kThinVoxels * double(report.run.info.voxel_size);
  const auto& [cause, what, cure, error, right] = report.diagnosis->tried.front();
  const CheckFigures& f = *report.figures;
  const std::string likely = over + "; likely cause: ", rebake = "bake the mesh as it is now";
  if (f.bake.is_fit ? f.bake.transmittance.rms <= kNearBestFit * f.best_fit_rms + kFitSlack : error < kSound && right > kMostRight)
    return {"bound", likely + "the bake itself; no other program changed the lobes",
            f.bake.is_fit ? "a single lobe cannot come closer: use a looser bound"
                          : "bake with more --rays or --voxels, or for transmittance with --lobe fit"};
  if (f.bake.is_fit) return {"stale", likely + "stale, the mesh has changed since the bake, or the fit was for other lights", rebake};
  if (2 * thin > wrong)
    return {"too-coarse", likely + "most of the wrong vertices are on parts thinner than two voxels of the bake",
            "bake again with more --voxels or --bake-voxels"};
  if (isRough(report.run.info) && error < kUnrelated)
    return {"rough", likely + "a bake with few directions or voxels, which is somewhat wrong everywhere",
            "bake again with more --rays or --voxels"};
  if (error >= kUnrelated) return {"stale", likely + "stale, the lobes are those of another mesh or another order of vertices", rebake};
  return {"stale",
          likely + fmt::format("stale, {:.0f} % of the vertices are right and the others are not: the mesh has changed since the bake",
                               100 * right),
          rebake};
}

// Why the asset fails; none if it is sound.
std::optional<AssetFault> judge(const DiagnosisSample& sample, const CheckReport& report, bool bounds_asked) {
  const std::vector<AssetFault>& faults = report.file.faults;
  const std::string over = overBound(report.figures->bake, report.bounds);
  const Diagnosis& diagnosis = *report.diagnosis;
  const Hypothesis& cause = diagnosis.tried[diagnosis.best];
  const bool was_changed = !faults.empty() && (report.file.undone || faults.front().cause == "moved");
  if (was_changed) {
    AssetFault fault = faults.front();
    fault.what += diagnosis.explained() ? "; also " + cause.what
                  : over.empty()        ? "; apart from that the lobes are intact"
                                        : "; apart from that " + over;
    return fault;
  }
  if (diagnosis.explained() && (!over.empty() || !faults.empty() || !bounds_asked)) {
    const std::string symptom = !over.empty() ? over : !faults.empty() ? faults.front().what : "the lobes are off";
    return AssetFault{cause.cause, symptom + "; likely cause: " + cause.what, cause.cure};
  }
  if (!faults.empty()) return faults.front();
  if (!over.empty()) return unexplained(over, sample, report);
  return std::nullopt;
}

// d cannot be longer than a ray, nor than the cloud.
void boundDensities(const CheckedAsset& asset, CheckReport& report) {
  if (report.run.info.lobe == "fit" || report.file.undone) return;
  const float diagonal = boundingBox(asset.cloud.surface).diagonal();
  const auto over = std::count_if(asset.lobes.begin(), asset.lobes.end(),
                                  [&](const Lobe& lobe) { return double(lobe.thickness) > diagonal * (1 + kLengthSlack); });
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
  if (stored.info) info = *stored.info;
  if (!stored.info || !(info.extinction > 0)) info.extinction = defaults.extinction;
  if (stored.info) return;
  info.shape = defaults.shape;
  info.method.clear();
}

// Measures and judges the asset, with lobes and rays as `report.run.info` and `ray_length` say.
void judgeReading(const CheckedAsset& asset, const Settings& settings, float ray_length, CheckReport& report) {
  boundDensities(asset, report);
  const DiagnosisSample sample = measure(asset, settings, ray_length, report);
  report.bounds = boundsFor(*report.figures, settings.judge.bounds);
  report.diagnosis = diagnose(sample);
  report.verdict = judge(sample, report, settings.judge.bounds.any());
}

void checkAlone(const Settings& settings, CheckReport& report) {
  const std::filesystem::path& file = settings.source.input;
  Stopwatch watch;
  report.run.input = file.string();
  requireMemoryForFile(file, settings.source.memory_limit);
  const std::string bytes = readFileBytes(file);
  Warnings told_by_sculpt;
  const StoredAsset stored = readStoredAsset(file, bytes, told_by_sculpt, settings.source.read);
  report.file = examineAsset(file, stored);
  watch.lap(report.run.seconds, "read");
  CheckedAsset asset;
  asset.cloud = readSculpt(settings, report.run, watch);
  for (const SculptPart& part : asset.cloud.sculpt.parts)
    for (size_t v = 0; v < part.positions.size(); ++v) asset.to_scene.push_back(part.toScene(v));
  resolveMetadata(settings, stored, asset, report);
  if (report.file.first_set < 0) {
    report.verdict = report.file.faults.front();
    return;
  }
  for (size_t v = 0; v < report.file.uvs.size(); ++v) asset.lobes.push_back(unpackLobe(report.file.uvs[v], asset.to_scene[v]));

  // Rays are as long as those of the bake, or as the diagonal if the mesh was scaled since. The first reading without a fault is taken,
  // else the one that leaves the least error unexplained.
  const float diagonal = boundingBox(asset.cloud.surface).diagonal(), recorded = report.run.info.ray_length;
  std::vector<float> ray_lengths{diagonal};
  if (recorded > 0 && recorded < diagonal * (1 - kLengthSlack)) ray_lengths = {recorded, diagonal};
  std::vector<std::pair<std::string, LobeShape>> readings{{report.run.info.lobe, report.run.info.shape}};
  if (!asset.has_metadata) readings.emplace_back("fit", LobeShape{defaultShape(true).exponent, 0});
  std::vector<CheckReport> attempts;
  for (const auto& [lobe, shape] : readings)
    for (const float ray_length : ray_lengths) {
      CheckReport& attempt = attempts.emplace_back(report);
      attempt.run.info.lobe = lobe;
      attempt.run.info.shape = shape;
      judgeReading(asset, settings, ray_length, attempt);
      if (!attempt.verdict) {
        report = std::move(attempt);
        watch.lap(report.run.seconds, "truth");
        return;
      }
    }
  report = *std::min_element(attempts.begin(), attempts.end(), [](const CheckReport& a, const CheckReport& b) {
    return a.diagnosis->tried[a.diagnosis->best].error < b.diagnosis->tried[b.diagnosis->best].error;
  });
  watch.lap(report.run.seconds, "truth");
}

void requireGltf(const std::filesystem::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension != ".glb" && extension != ".gltf")
    throw InputError(file.string(), "not a baked asset, which is a .glb or .gltf: run `cloudbake bake` first");
}

}  // namespace

CheckReport checkAsset(const Settings& settings) {
  requireGltf(settings.source.input);
  CheckReport report;
  if (settings.judge.against) {
    requireGltf(*settings.judge.against);
    return checkAgainst(settings.source.input, settings.judge, settings.source.read);
  }
  checkAlone(settings, report);
  return report;
}

}  // namespace cloudbake
