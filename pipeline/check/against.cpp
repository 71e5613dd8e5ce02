// Vertices are matched by position, because optimisers reorder, split and weld them. They are put into a grid of cells as wide as the
// tolerance, so that all near vertices are in one of 27 cells.
#include "pipeline/check/against.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "bake/lobe/directions.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/truth/error_metrics.h"
#include "core/error.h"
#include "core/harmonics.h"
#include "core/random.h"
#include "io/file/write_file.h"
#include "pipeline/fields/fields.h"
#include "pipeline/fields/stopwatch.h"

namespace cloudbake {

namespace {

constexpr double kAngle_degrees = 0.1, kDensity = 0.001, kHarmonics = 0.001;
constexpr size_t kDiagnosedVertices = 2000;
constexpr int kLights = 64;

// One of the two files, decoded as far as possible.
struct DecodedAsset {
  StoredAsset stored;
  AssetExamination file;
  SurfaceMesh surface;
  std::vector<Affine> to_scene;  // of every vertex
  std::vector<Lobe> lobes;
};

DecodedAsset decodeAsset(const std::filesystem::path& file, const ReadSettings& settings, Warnings& warnings) {
  DecodedAsset asset;
  asset.stored = readStoredAsset(file, readFileBytes(file), warnings, settings);
  asset.file = examineAsset(file, asset.stored);
  asset.surface = surfaceInScene(asset.stored.sculpt);
  for (const SculptPart& part : asset.stored.sculpt.parts)
    for (size_t v = 0; v < part.positions.size(); ++v) asset.to_scene.push_back(part.toScene(v));
  for (size_t v = 0; v < asset.file.uvs.size(); ++v) asset.lobes.push_back(unpackLobe(asset.file.uvs[v], asset.to_scene[v]));
  return asset;
}

std::string namesText(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + (name.empty() ? "(unnamed)" : name);
  return text.empty() ? "none" : text;
}

// What engines and previews read of the metadata, where it differs.
std::string differingConstants(const std::optional<AssetInfo>& asset, const std::optional<AssetInfo>& before) {
  if (!asset || !before) return "";  // reported as a note
  std::string text;
  const auto compare = [&](const char* name, const auto& now, const auto& then) {
    if (now != then) text += fmt::format("{}{} {} instead of {}", text.empty() ? "" : ", ", name, now, then);
  };
  compare("lobe", asset->lobe, before->lobe);
  compare("exponent", asset->shape.exponent, before->shape.exponent);
  compare("bias", asset->shape.bias, before->shape.bias);
  compare("extinction", asset->extinction, before->extinction);
  compare("extinction_range from", asset->extinction_low, before->extinction_low);
  compare("extinction_range to", asset->extinction_high, before->extinction_high);
  compare("fit_to", asset->volume ? "volume" : "transmittance", before->volume ? "volume" : "transmittance");
  compare("harmonic_order", asset->harmonic_order, before->harmonic_order);
  return text;
}

// The rms of T by the coefficients of the matched vertices; infinite if only one asset has any.
std::optional<double> harmonicsError(const StoredAsset& asset, const StoredAsset& before, const std::vector<uint32_t>& matches) {
  if (asset.harmonics.empty() && before.harmonics.empty()) return std::nullopt;
  const size_t width = before.harmonics.empty() ? 0 : harmonicCount(before.info->harmonic_order);
  if (width == 0 || asset.harmonics.size() != width * matches.size()) return INFINITY;
  const std::vector<Vec3> lights = fibonacciDirections(kLights);
  double squares = 0;
  size_t count = 0;
  for (size_t v = 0; v < matches.size(); ++v) {
    if (matches[v] == kUnmatched) continue;
    const auto now = std::span(asset.harmonics).subspan(v * width, width),
               then = std::span(before.harmonics).subspan(matches[v] * width, width);
    for (const Vec3& light : lights) {
      const double difference = double(harmonicTransmittance(now, light)) - harmonicTransmittance(then, light);
      squares += difference * difference;
    }
    count += lights.size();
  }
  return count > 0 ? std::sqrt(squares / double(count)) : 0;
}

struct Cell {
  int64_t x, y, z;
  uint64_t key() const { return mix64(uint64_t(x) + mix64(uint64_t(y) + mix64(uint64_t(z)))); }
};

void compare(const DecodedAsset& asset, const DecodedAsset& before, CheckReport& report) {
  ComparisonFigures& c = *report.comparison;
  const std::vector<uint32_t> matches = matchVertices(asset.surface, before.surface);
  std::vector<bool> met(before.lobes.size());
  std::vector<Lobe> lobes;
  Truth truth;
  double sum = 0;
  DiagnosisSample all;
  for (size_t v = 0; v < matches.size(); ++v) {
    if (matches[v] == kUnmatched) {
      ++c.added;
      continue;
    }
    met[matches[v]] = true;
    lobes.push_back(asset.lobes[v]);
    truth.lobes.push_back(before.lobes[matches[v]]);
    truth.concentration.push_back(1);
    all.stored.push_back(asset.file.uvs[v]);
    all.to_scene.push_back(asset.to_scene[v]);
    sum += truth.lobes.back().thickness;
    c.density_max = std::max(c.density_max, std::fabs(double(lobes.back().thickness) - truth.lobes.back().thickness));
  }
  c.matched = lobes.size();
  c.lost = uint64_t(std::count(met.begin(), met.end(), false));
  if (lobes.empty()) return;
  c.density_max = sum > 0 ? c.density_max * double(lobes.size()) / sum : 0;
  c.difference.lobe = compareLobes(lobes, truth);
  const AssetInfo& info = report.run.info;
  c.harmonics_rms = harmonicsError(asset.stored, before.stored, matches);
  c.difference.transmittance = compareLobeTransmittance(lobes, truth.lobes, info.shape, fibonacciDirections(kLights), info.extinction);
  const std::vector<size_t> chosen = evenlySpread(lobes.size(), kDiagnosedVertices);
  DiagnosisSample sample;
  sample.stored = pick(all.stored, chosen);
  sample.to_scene = pick(all.to_scene, chosen);
  sample.truth = pick(truth.lobes, chosen);
  report.diagnosis = diagnose(sample);
}

std::optional<AssetFault> judge(const CheckReport& report) {
  const ComparisonFigures& c = *report.comparison;
  if (report.file.fatal) return report.file.fatal;
  if (!report.file.faults.empty() && (report.file.undone || report.file.first_set < 0 || report.file.faults.front().cause == "moved"))
    return report.file.faults.front();
  if (c.matched == 0)
    return AssetFault{"moved-mesh", "no vertex is where it was before: the mesh was turned, moved, scaled or replaced",
                      "compare files with the same scene space; `cloudbake check` without --against judges the asset alone"};
  if (const std::string over = overBound(c.difference, report.bounds, "differs from before"); !over.empty()) {
    if (report.diagnosis && report.diagnosis->explained()) {
      const Hypothesis& cause = report.diagnosis->tried[report.diagnosis->best];
      return AssetFault{cause.cause, over + "; likely cause: " + cause.what, cause.cure};
    }
    return AssetFault{"changed", over + "; no single change explains it", "look at the tool's options for UVs, or bake as the last step"};
  }
  if (!report.file.faults.empty()) return report.file.faults.front();
  if (!c.constants.empty())
    return AssetFault{"constants", "other constants than before: " + c.constants,
                      "give asset.extras.cloudbake its values back, or bake again with the ones you want"};
  if (c.harmonics_rms && !(*c.harmonics_rms <= kHarmonics))
    return AssetFault{"harmonics",
                      std::isfinite(*c.harmonics_rms)
                          ? fmt::format("T by the spherical harmonics differs from before by {:.2g} rms", *c.harmonics_rms)
                          : "only one of the two assets has spherical harmonics of this order",
                      "keep the attributes _TRANSMITTANCE_SH_0 and up as they are, or bake as the last step"};
  if (c.added > 0)
    return AssetFault{"new-vertices",
                      std::to_string(c.added) + " vertices are where there was none before: their lobes were interpolated or made up",
                      "simplify without moving vertices, or bake as the last step"};
  return std::nullopt;
}

}  // namespace

std::vector<uint32_t> matchVertices(const SurfaceMesh& mesh, const SurfaceMesh& before, double share) {
  const Box box = boundingBox(before);
  const double tolerance = share * std::max(double(box.diagonal()), 1e-30);
  const auto cellOf = [&](Vec3 p) {
    return Cell{int64_t(std::floor((double(p.x) - box.low.x) / tolerance)), int64_t(std::floor((double(p.y) - box.low.y) / tolerance)),
                int64_t(std::floor((double(p.z) - box.low.z) / tolerance))};
  };
  std::unordered_multimap<uint64_t, uint32_t> cells;
  Box reach;
  for (uint32_t v = 0; v < before.positions.size(); ++v)
    cells.emplace(cellOf(before.positions[v]).key(), v), reach.add(before.positions[v]);
  std::vector<uint32_t> matches(mesh.positions.size(), kUnmatched);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = mesh.positions[v];
    if (!(length(p - reach.center()) < 2 * double(reach.diagonal()) + tolerance)) continue;  // its cell's number might overflow
    const Cell cell = cellOf(p);
    double nearest = tolerance, agreement = -2;
    for (int64_t neighbour = 0; neighbour < 27; ++neighbour) {
      const Cell near{cell.x + neighbour % 3 - 1, cell.y + neighbour / 3 % 3 - 1, cell.z + neighbour / 9 - 1};
      const auto [begin, end] = cells.equal_range(near.key());
      for (auto at = begin; at != end; ++at) {
        const double distance = length(before.positions[at->second] - p);
        const double cosine = mesh.normals.empty() || before.normals.empty() ? 0 : dot(mesh.normals[v], before.normals[at->second]);
        // Of vertices that are as good, the first: a hash table has them in any order.
        if (std::tuple(distance, -cosine, at->second) >= std::tuple(nearest, -agreement, matches[v])) continue;
        nearest = distance, agreement = cosine, matches[v] = at->second;
      }
    }
  }
  return matches;
}

CheckReport checkAgainst(const std::filesystem::path& file, const JudgeSettings& settings, const ReadSettings& read,
                         const std::function<void(const std::string&)>& on_stage) {
  CheckReport report;
  report.run.command = "check";
  report.run.input = file.string();
  Stopwatch watch(on_stage);
  const DecodedAsset asset = decodeAsset(file, read, report.run.warnings);
  const DecodedAsset before = decodeAsset(*settings.against, read, report.run.warnings);
  if (before.file.fatal || before.file.first_set < 0 || before.file.undone)
    throw InputError(settings.against->string(),
                     "nothing to compare with: " + (before.file.fatal ? *before.file.fatal : before.file.faults.front()).what +
                         "; give the asset as it was baked");
  watch.lap(report.run.seconds, "read");
  report.file = asset.file;
  if (const auto& info = asset.stored.info ? asset.stored.info : before.stored.info) report.run.info = *info;
  report.run.vertices = asset.surface.positions.size();
  report.run.triangles = asset.surface.triangles.size();
  report.comparison.emplace();
  ComparisonFigures& c = *report.comparison;
  c.before = settings.against->string();
  c.constants = differingConstants(asset.stored.info, before.stored.info);
  c.sets_before = uvSetsText(before.stored), c.sets = uvSetsText(asset.stored);
  c.materials_before = namesText(before.stored.materials), c.materials = namesText(asset.stored.materials);
  const ErrorBounds& bounds = settings.bounds;
  const auto bound = [&](const char* key, double most) { report.bounds.push_back({&figureField(key), most}); };
  if (bounds.angle_degrees || !bounds.any()) bound("direction_rms_degrees", bounds.angle_degrees.value_or(kAngle_degrees));
  if (!bounds.any()) bound("density_rms", kDensity);
  if (bounds.transmittance_rms) bound("transmittance_rms", *bounds.transmittance_rms);
  if (asset.file.first_set >= 0) compare(asset, before, report);
  watch.lap(report.run.seconds, "compare");
  report.verdict = judge(report);
  return report;
}

}  // namespace cloudbake
