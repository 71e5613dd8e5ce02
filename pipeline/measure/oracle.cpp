#include "pipeline/measure/oracle.h"

#include <algorithm>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/lobe/sweep.h"
#include "bake/truth/error_metrics.h"
#include "core/memory_budget.h"
#include "core/portable_math.h"
#include "pipeline/measure/radiance.h"

namespace cloudbake {

namespace {

constexpr size_t kTruthVertices = 2000, kMarchedTruthVertices = 200;
constexpr int kVolumeDirections = 64;

// How finely a volume is marched; docs/check.md has the difference.
struct MarchSize {
  int voxels, views, steps;
};
constexpr MarchSize kMeasured{64, 96, 128}, kChecked{48, 48, 64};

std::vector<float> transmittances(std::span<const float> lengths, float extinction) {
  std::vector<float> light;
  light.reserve(lengths.size());
  for (const float length : lengths) light.push_back(float(portableExp(-double(extinction) * length)));
  return light;
}

// Lengths, the light that comes of them, and the lengths of a bake that are compared with them.
void requireMemoryOfTruth(size_t vertices, size_t points, size_t lights, uint64_t limit) {
  constexpr double kBytesPerLight = 3 * sizeof(float), kBytesPerPlace = 200;
  std::string what = "the truth at " + std::to_string(vertices) + " vertices";
  if (points > 0) what += " and " + std::to_string(points) + " points of the surface";
  requireMemory({what, double(vertices + points) * (kBytesPerPlace + kBytesPerLight * double(lights)), "use fewer --truth-vertices"},
                limit);
}

// Replaces the transmittance by the light that a march through the volume shows, and keeps the vertices and points that are seen.
void judgeByVolume(const Cloud& cloud, FieldSettings settings, const OracleQuestion& question, std::span<const Vec3> places,
                   Oracle& oracle) {
  const MarchSize& march = question.is_check ? kChecked : kMeasured;
  settings.bake_voxels = march.voxels;
  Warnings told_already;
  const IntegrationField field = buildField(cloud, settings, Method::kSweep, told_already);
  std::vector<Vec3> positions = oracle.positions, normals = pick(cloud.surface.normals, oracle.vertices);
  positions.insert(positions.end(), places.begin(), places.end());
  for (const SurfacePoint& point : oracle.surface.points) normals.push_back(normalAt(point, cloud.surface.normals));
  const VolumeTruth volume = marchVolume({positions, normals}, *field.coverage, bothSenses(oracle.axes), {&question.extinction, 1},
                                         {*question.volume, march.views, march.steps})
                                 .front();

  std::vector<size_t> vertices, points;
  for (const size_t i : volume.seen) (i < oracle.vertices.size() ? vertices : points).push_back(i);
  for (size_t& i : points) i -= oracle.vertices.size();
  const size_t lights = 2 * oracle.axes.size();
  const auto first_point = volume.mean.begin() + ptrdiff_t(vertices.size() * lights);
  std::vector<float> lengths;
  for (const size_t v : vertices)
    lengths.insert(lengths.end(), oracle.lengths.begin() + ptrdiff_t(v * lights), oracle.lengths.begin() + ptrdiff_t((v + 1) * lights));
  oracle = {"a march through the volume",
            pick(oracle.vertices, vertices),
            pick(oracle.positions, vertices),
            {pick(oracle.truth.lobes, vertices), pick(oracle.truth.concentration, vertices)},
            oracle.axes,
            std::move(lengths),
            {volume.mean.begin(), first_point},
            {pick(oracle.surface.points, points), {first_point, volume.mean.end()}}};
}

}  // namespace

namespace {

Oracle answerOf(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, const OracleQuestion& question) {
  Oracle oracle;
  const bool is_slow = truthIsMarched(cloud) || question.volume;
  const size_t count = vertices.value_or(is_slow ? kMarchedTruthVertices : kTruthVertices);
  oracle.axes = !question.axes.empty() ? question.axes : sweepAxes(question.volume ? kVolumeDirections : kTransmittanceDirections);
  requireMemoryOfTruth(std::min(count, cloud.surface.positions.size()), question.over_surface ? count : 0, 2 * oracle.axes.size(),
                       settings.memory_limit);
  oracle.vertices = (question.is_check ? drawnFromStretches : evenlySpread)(cloud.surface.positions.size(), count);
  oracle.positions = pick(cloud.surface.positions, oracle.vertices);
  if (question.over_surface) oracle.surface.points = spreadOverSurface(cloud.surface, count);
  std::vector<Vec3> places;
  for (const SurfacePoint& point : oracle.surface.points) places.push_back(valueAt(point, cloud.surface.positions));
  const auto reference = referenceFor(cloud, settings);
  oracle.name = reference->name();
  oracle.truth = trueLobes(*reference, oracle.positions, fibonacciDirections(question.directions), question.ray_length);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  oracle.lengths = trueLengths(*reference, oracle.positions, directions, question.ray_length);
  if (question.volume) {
    judgeByVolume(cloud, settings, question, places, oracle);
  } else {
    oracle.light = transmittances(oracle.lengths, question.extinction);
    oracle.surface.light = transmittances(trueLengths(*reference, places, directions, question.ray_length), question.extinction);
  }
  return oracle;
}

}  // namespace

Oracle askOracle(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, const OracleQuestion& question) {
  return inStage("the truth", "use fewer --truth-vertices", [&] { return answerOf(cloud, settings, vertices, question); });
}

LightSet judgingLights(const AssetInfo& info) {
  return fitLights(info.lobe == "fit" ? info.sun_arc : std::nullopt, info.volume.has_value(),
                   info.volume ? kVolumeDirections : kTransmittanceDirections);
}

BakeFigures figuresAgainst(const Oracle& oracle, const std::vector<Lobe>& all_lobes, bool is_fit, LobeShape shape, float extinction,
                           std::span<const float> weights) {
  const std::vector<Lobe> lobes = pick(all_lobes, oracle.vertices);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  return {oracle.name,
          lobes.size(),
          is_fit,
          compareLobes(lobes, oracle.truth),
          compareLight(lobes, shape, directions, oracle.light, extinction, weights),
          compareOverSurface(oracle.surface.points, all_lobes, shape, directions, oracle.surface.light, extinction, weights)};
}

}  // namespace cloudbake
