// The error of a sweep falls with the number of directions until the field's own error is left, and that falls with the voxels. So for one
// resolution after the other, coarse first, the directions are raised until the target is kept or the error stands still; a resolution that
// alone costs more than the best so far ends the search. Each trial is a real bake of the sampled vertices.
#include "pipeline/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/truth/error_metrics.h"
#include "bake/mesh/mesh_topology.h"
#include "core/error.h"

namespace cloudbake {

namespace {

constexpr std::array kVoxels{16, 24, 35, 50, 70, 100, 140, 200, 280, 400};
constexpr std::array kDirections{8, 12, 16, 24, 36, 50, 72, 100, 144, 200, 288, 400, 576, 800, 1152, 1600, 2304, 3200, 4608};
constexpr int kTruthDirections = 4096, kMarchedTruthDirections = 1024, kTransmittanceDirections = 128;
constexpr size_t kSampledVertices = 256, kMarchedVertices = 96;
constexpr double kSafety = 0.9;  // a sample of vertices is measured, all are meant

// What is measured, and against what.
struct Trial {
  std::vector<Vec3> positions, normals;
  Truth truth;
  std::vector<Vec3> lights;
};

double errorOf(const std::vector<Lobe>& lobes, const Trial& trial, const Settings& settings, const AssetInfo& info) {
  if (!settings.target_error->is_transmittance) return compareLobes(lobes, trial.truth).angle_rms_degrees;
  return compareLobeTransmittance(lobes, trial.truth.lobes, info.shape, trial.lights, info.extinction).rms;
}

// Seconds, roughly: resampling per cell and axis, look-ups per vertex and direction, making and turning the field per cell.
double expectedCost(double cells, double vertices, double directions) {
  return cells * (6e-9 + 0.5 * directions * 0.15e-9) + vertices * directions * 1.1e-9;
}

struct Choice {
  double cost = INFINITY, error = 0;
  int voxels = 0, directions = 0;
};

Choice cheapest(const Scene& scene, const Settings& settings, const Trial& trial, const BakeReport& report) {
  Choice best;
  double nearest = INFINITY;
  for (const int voxels : kVoxels) {
    Warnings not_told;  // the bake itself tells them
    Settings tried = settings;
    tried.bake_voxels = voxels;
    const IntegrationField field = buildField(scene, tried, not_told);
    const auto& cells = field.coverage->cells;
    const double cell_count = double(cells[0]) * cells[1] * cells[2], vertices = double(scene.surface.positions.size());
    double least = INFINITY;
    int stood_still = 0;
    for (const int directions : kDirections) {
      const double cost = expectedCost(cell_count, vertices, directions);
      if (cost >= best.cost) break;
      BakeSettings bake = settings.bake;
      bake.rays = directions;
      const double error = errorOf(meanLobes({trial.positions, trial.normals}, field, bake, not_told), trial, settings, report.info);
      nearest = std::min(nearest, error);
      if (error <= kSafety * settings.target_error->value) {
        best = {cost, error, voxels, directions};
        break;
      }
      stood_still = error > 0.95 * least ? stood_still + 1 : 0;
      least = std::min(least, error);
      if (stood_still == 3) break;  // what is left is the field's
    }
    if (expectedCost(cell_count, vertices, kDirections[0]) >= best.cost) break;
  }
  if (best.voxels == 0) {
    throw Error(ExitCode::kBound, report.input, 0, 0,
                fmt::format("--target-error {:g} cannot be kept: the nearest was {:.3g} with up to {} voxels and {} directions",
                            settings.target_error->value, nearest, kVoxels.back(), kDirections.back()));
  }
  return best;
}

}  // namespace

void chooseForTarget(const Scene& scene, Settings& settings, BakeReport& report) {
  const bool marched = truthIsMarched(scene);
  Trial trial;
  const std::vector<size_t> sampled = evenlySpread(scene.surface.positions.size(), marched ? kMarchedVertices : kSampledVertices);
  trial.positions = pick(scene.surface.positions, sampled);
  trial.normals = pick(scene.surface.normals, sampled);
  const auto reference = referenceFor(scene, settings);
  trial.truth = trueLobes(*reference, trial.positions, fibonacciDirections(marched ? kMarchedTruthDirections : kTruthDirections),
                          *settings.bake.ray_length);
  trial.lights = fibonacciDirections(kTransmittanceDirections);

  const Choice choice = cheapest(scene, settings, trial, report);
  settings.bake.rays = choice.directions;
  settings.bake_voxels = choice.voxels;
  report.info.rays = choice.directions;
  report.target = TargetReport{settings.target_error->is_transmittance ? "transmittance rms" : "direction rms, degrees",
                               settings.target_error->value,
                               choice.error,
                               reference->name(),
                               trial.positions.size(),
                               choice.voxels};
}

std::optional<SceneView> takeSceneView(Settings& settings) {
  if (!settings.scene && !settings.scene_view) return std::nullopt;
  const SceneView view = settings.scene ? readSceneView(*settings.scene) : *settings.scene_view;
  constexpr double kEightBitStep = 1.0 / 255;
  const bool chosen_by_hand = settings.rays || settings.bake_voxels || settings.method == Method::kRays;
  if (!settings.target_error && !chosen_by_hand) settings.target_error = TargetError{kEightBitStep, true};
  if (settings.fit && !settings.sun_arc) settings.sun_arc = view.sun_arc;
  return view;
}

size_t vertexBudget(const SceneView& view, const SurfaceMesh& mesh) {
  constexpr double kEdge_pixels = 8;
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area += 0.5 * double(length(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])));
  const double edge = kEdge_pixels * view.pixel();
  return size_t(std::clamp(area / (0.5 * std::sqrt(3.0) * edge * edge), 4.0, 1e9));
}

}  // namespace cloudbake
