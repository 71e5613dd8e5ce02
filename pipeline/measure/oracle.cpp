#include "pipeline/measure/oracle.h"

#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/lobe/sweep.h"
#include "bake/truth/error_metrics.h"
#include "pipeline/measure/radiance.h"

namespace cloudbake {

namespace {

constexpr size_t kTruthVertices = 2000, kMarchedTruthVertices = 200;
constexpr int kVolumeDirections = 64, kVolumeVoxels = 64;

// The light that a march through the volume shows at the points that are seen.
VolumeTruth marchedLight(const Cloud& cloud, FieldSettings settings, const BakePoints& points, std::span<const Vec3> axes,
                         const OracleQuestion& question) {
  settings.bake_voxels = kVolumeVoxels;
  Warnings told_already;
  const IntegrationField field = buildField(cloud, settings, Method::kSweep, told_already);
  return marchVolume(points, *field.coverage, bothSenses(axes), {question.extinction, *question.volume});
}

// Keeps the light that a march shows, and of the vertices those that are seen.
void judgeByVolume(const Cloud& cloud, const FieldSettings& settings, const OracleQuestion& question, Oracle& oracle) {
  const std::vector<Vec3> normals = pick(cloud.surface.normals, oracle.vertices);
  VolumeTruth volume = marchedLight(cloud, settings, {oracle.positions, normals}, oracle.axes, question);
  oracle.name = "a march through the volume";
  oracle.vertices = pick(oracle.vertices, volume.seen);
  oracle.positions = pick(oracle.positions, volume.seen);
  oracle.truth.lobes = pick(oracle.truth.lobes, volume.seen);
  oracle.truth.concentration = pick(oracle.truth.concentration, volume.seen);
  const size_t lights = 2 * oracle.axes.size();
  std::vector<float> lengths;
  for (const size_t v : volume.seen)
    lengths.insert(lengths.end(), oracle.lengths.begin() + ptrdiff_t(v * lights), oracle.lengths.begin() + ptrdiff_t((v + 1) * lights));
  oracle.lengths = std::move(lengths);
  oracle.light = std::move(volume.mean);
}

std::vector<Vec3> axesOf(const OracleQuestion& question) {
  return !question.axes.empty() ? question.axes : sweepAxes(question.volume ? kVolumeDirections : kTransmittanceDirections);
}

size_t pointsOf(const Cloud& cloud, std::optional<size_t> wanted, const OracleQuestion& question) {
  return wanted.value_or(truthIsMarched(cloud) || question.volume ? kMarchedTruthVertices : kTruthVertices);
}

std::vector<float> transmittances(std::span<const float> lengths, float extinction) {
  std::vector<float> light;
  for (const float length : lengths) light.push_back(float(std::exp(-double(extinction) * length)));
  return light;
}

}  // namespace

Oracle askOracle(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, const OracleQuestion& question) {
  Oracle oracle;
  oracle.vertices = evenlySpread(cloud.surface.positions.size(), pointsOf(cloud, vertices, question));
  oracle.positions = pick(cloud.surface.positions, oracle.vertices);
  const auto reference = referenceFor(cloud, settings);
  oracle.name = reference->name();
  oracle.truth = trueLobes(*reference, oracle.positions, fibonacciDirections(question.directions), question.ray_length);
  oracle.axes = axesOf(question);
  oracle.lengths = trueLengths(*reference, oracle.positions, bothSenses(oracle.axes), question.ray_length);
  if (question.volume)
    judgeByVolume(cloud, settings, question, oracle);
  else
    oracle.light = transmittances(oracle.lengths, question.extinction);
  return oracle;
}

SurfaceOracle askOverSurface(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> points,
                             const OracleQuestion& question) {
  SurfaceOracle oracle{spreadOverSurface(cloud.surface, pointsOf(cloud, points, question)), axesOf(question), {}};
  std::vector<Vec3> positions, normals;
  for (const SurfacePoint& point : oracle.points) {
    positions.push_back(valueAt(point, cloud.surface.positions));
    normals.push_back(normalAt(point, cloud.surface.normals));
  }
  if (question.volume) {
    VolumeTruth volume = marchedLight(cloud, settings, {positions, normals}, oracle.axes, question);
    oracle.points = pick(oracle.points, volume.seen);
    oracle.light = std::move(volume.mean);
  } else {
    const auto reference = referenceFor(cloud, settings);
    oracle.light = transmittances(trueLengths(*reference, positions, bothSenses(oracle.axes), question.ray_length), question.extinction);
  }
  return oracle;
}

LightSet judgingLights(const AssetInfo& info) {
  return fitLights(info.lobe == "fit" ? info.sun_arc : std::nullopt, info.volume.has_value(),
                   info.volume ? kVolumeDirections : kTransmittanceDirections);
}

BakeFigures figuresAgainst(const Oracle& oracle, const SurfaceOracle& over_surface, const std::vector<Lobe>& all_lobes, bool is_fit,
                           LobeShape shape, float extinction) {
  const std::vector<Lobe> lobes = pick(all_lobes, oracle.vertices);
  return {oracle.name,
          lobes.size(),
          is_fit,
          compareLobes(lobes, oracle.truth),
          compareLight(lobes, shape, bothSenses(oracle.axes), oracle.light, extinction),
          compareOverSurface(over_surface.points, all_lobes, shape, bothSenses(over_surface.axes), over_surface.light, extinction)};
}

}  // namespace cloudbake
