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

// Keeps the light that a march shows, and of the vertices those that are seen.
void judgeByVolume(const Cloud& cloud, FieldSettings settings, const OracleQuestion& question, Oracle& oracle) {
  settings.bake_voxels = kVolumeVoxels;
  Warnings told_already;
  const IntegrationField field = buildField(cloud, settings, Method::kSweep, told_already);
  const std::vector<Vec3> normals = pick(cloud.surface.normals, oracle.vertices);
  VolumeTruth volume =
      marchVolume({oracle.positions, normals}, *field.coverage, bothSenses(oracle.axes), {question.extinction, *question.volume});
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

}  // namespace

Oracle askOracle(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, const OracleQuestion& question) {
  Oracle oracle;
  const bool is_slow = truthIsMarched(cloud) || question.volume;
  oracle.vertices = evenlySpread(cloud.surface.positions.size(), vertices.value_or(is_slow ? kMarchedTruthVertices : kTruthVertices));
  oracle.positions = pick(cloud.surface.positions, oracle.vertices);
  const auto reference = referenceFor(cloud, settings);
  oracle.name = reference->name();
  oracle.truth = trueLobes(*reference, oracle.positions, fibonacciDirections(question.directions), question.ray_length);
  oracle.axes = !question.axes.empty() ? question.axes : sweepAxes(question.volume ? kVolumeDirections : kTransmittanceDirections);
  oracle.lengths = trueLengths(*reference, oracle.positions, bothSenses(oracle.axes), question.ray_length);
  if (question.volume) {
    judgeByVolume(cloud, settings, question, oracle);
  } else {
    for (const float length : oracle.lengths) oracle.light.push_back(float(std::exp(-double(question.extinction) * length)));
  }
  return oracle;
}

LightSet judgingLights(const AssetInfo& info) {
  return fitLights(info.lobe == "fit" ? info.sun_arc : std::nullopt, info.volume.has_value(),
                   info.volume ? kVolumeDirections : kTransmittanceDirections);
}

BakeFigures figuresAgainst(const Oracle& oracle, const std::vector<Lobe>& all_lobes, bool is_fit, LobeShape shape, float extinction) {
  const std::vector<Lobe> lobes = pick(all_lobes, oracle.vertices);
  return {oracle.name, lobes.size(), is_fit, compareLobes(lobes, oracle.truth),
          compareLight(lobes, shape, bothSenses(oracle.axes), oracle.light, extinction)};
}

}  // namespace cloudbake
