// The error of a sweep falls with the number of directions until only the error of the field is left, which falls with the number of
// voxels. So the search tries one resolution after the other, coarse first, and raises the directions until the target is met or the error
// no longer falls. It ends at a resolution that costs more than the best choice so far, even with the fewest directions. Each trial is a
// real bake of the sampled vertices.
#include "pipeline/lobes/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/truth/error_metrics.h"
#include "core/error.h"
#include "pipeline/fields/fields.h"

namespace cloudbake {

namespace {

constexpr std::array kVoxels{16, 24, 35, 50, 70, 100, 140, 200, 280, 400};
constexpr std::array kDirections{8, 12, 16, 24, 36, 50, 72, 100, 144, 200, 288, 400, 576, 800, 1152, 1600, 2304, 3200, 4608};
constexpr int kTruthDirections = 4096, kMarchedTruthDirections = 1024, kTransmittanceDirections = 128;
constexpr size_t kSampledVertices = 256, kMarchedVertices = 96;
constexpr double kSafety = 0.9;  // only a sample of the vertices is measured, but the target is for all of them

// The sampled vertices and their truth.
struct Trial {
  std::vector<Vec3> positions, normals;
  Truth truth;
  std::vector<Vec3> lights;
};

double errorOf(const std::vector<Lobe>& lobes, const Trial& trial, const TargetError& target, const BakeParameters& parameters) {
  if (!target.is_transmittance) return compareLobes(lobes, trial.truth).angle_rms_degrees;
  return compareLobeTransmittance(lobes, trial.truth.lobes, parameters.shape, trial.lights, parameters.extinction).rms;
}

// Estimated seconds: resampling per cell and axis, look-ups per vertex and direction, building and turning the field per cell.
double expectedCost(double cells, double vertices, double directions) {
  return cells * (6e-9 + 0.5 * directions * 0.15e-9) + vertices * directions * 1.1e-9;
}

struct Choice {
  double cost = INFINITY, error = 0;
  int voxels = 0, directions = 0;
};

Choice cheapest(const Cloud& cloud, const FieldSettings& fields, const TargetError& target, const BakeParameters& parameters,
                const Trial& trial) {
  Choice best;
  double nearest = INFINITY;
  for (const int voxels : kVoxels) {
    Warnings not_told;  // the bake itself reports them
    FieldSettings tried = fields;
    tried.bake_voxels = voxels;
    const IntegrationField field = buildField(cloud, tried, parameters.bake.method, not_told);
    const auto& cells = field.coverage->cells;
    const double cell_count = double(cells[0]) * cells[1] * cells[2], vertices = double(cloud.surface.positions.size());
    double least = INFINITY;
    int stood_still = 0;
    for (const int directions : kDirections) {
      const double cost = expectedCost(cell_count, vertices, directions);
      if (cost >= best.cost) break;
      BakeSettings bake = parameters.bake;
      bake.rays = directions;
      const double error = errorOf(meanLobes({trial.positions, trial.normals}, field, bake, not_told), trial, target, parameters);
      nearest = std::min(nearest, error);
      if (error <= kSafety * target.value) {
        best = {cost, error, voxels, directions};
        break;
      }
      stood_still = error > 0.95 * least ? stood_still + 1 : 0;
      least = std::min(least, error);
      if (stood_still == 3) break;  // the rest is the error of the field
    }
    if (expectedCost(cell_count, vertices, kDirections[0]) >= best.cost) break;
  }
  if (best.voxels == 0) {
    throw Error(ExitCode::kBound, "", 0, 0,
                fmt::format("the target error of {:.3g} (from --target-error or --scene) cannot be met with a margin of a tenth: "
                            "the least error was {:.3g}, with up to {} voxels and {} directions; allow a larger error",
                            target.value, nearest, kVoxels.back(), kDirections.back()));
  }
  return best;
}

}  // namespace

BakeParameters keepingTarget(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters) {
  const TargetError& target = *settings.lobe.target_error;
  const bool marched = truthIsMarched(cloud);
  Trial trial;
  const std::vector<size_t> sampled = evenlySpread(cloud.surface.positions.size(), marched ? kMarchedVertices : kSampledVertices);
  trial.positions = pick(cloud.surface.positions, sampled);
  trial.normals = pick(cloud.surface.normals, sampled);
  const auto reference = referenceFor(cloud, settings.field);
  trial.truth = trueLobes(*reference, trial.positions, fibonacciDirections(marched ? kMarchedTruthDirections : kTruthDirections),
                          *parameters.bake.ray_length);
  trial.lights = fibonacciDirections(kTransmittanceDirections);

  const Choice choice = cheapest(cloud, settings.field, target, parameters, trial);
  BakeParameters chosen = parameters;
  chosen.bake.rays = choice.directions;
  chosen.bake_voxels = choice.voxels;
  chosen.target = TargetReport{target.is_transmittance ? "transmittance rms" : "direction rms, degrees",
                               target.value,
                               choice.error,
                               reference->name(),
                               trial.positions.size(),
                               choice.voxels};
  return chosen;
}

}  // namespace cloudbake
