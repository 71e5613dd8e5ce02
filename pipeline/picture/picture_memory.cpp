// The numbers of bytes were compared with the peak memory of pictures of all scenes in data/scenes, of 100 to 2,000 clouds, of up to 1,000
// slabs, and of 960x640 to 8192x8192 pixels.
#include "pipeline/picture/picture_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "core/memory_budget.h"
#include "pipeline/picture/scene_shadows.h"
#include "preview/layer.h"

namespace cloudbake {

namespace {

// The background, the picture and a copy while it is graded, and the PNG. The plain look has the picture and the PNG.
constexpr double kBytesPerPixel = 3 * sizeof(Vec3) + 8, kBytesPerPlainPixel = sizeof(Vec3) + 8,
                 kBytesPerBlurredPixel = sizeof(float) + sizeof(Vec2);
// Three images of the chain of mesh clouds; with --steps as many as it has steps.
constexpr double kBytesPerStep = sizeof(Rgba), kStepsKept = 3, kAllSteps = 7;
constexpr double kBytesPerVertex = 60, kBytesPerTriangle = 130;  // placed, lit, and prepared for the camera
constexpr double kBytesPerTracedTriangle = 300;                  // prepared for rays
constexpr double kBytesPerHit = 80;                              // of a slab's ray
constexpr double kRowsBytes = 256 << 20;
constexpr int kLeastRows = 8;

struct LayerLoad {
  double bytes_per_pixel = 0;
  int layers = 0, most_samples = 1;

  void add(size_t count, int samples_per_side) {
    const int samples = samples_per_side * samples_per_side;
    bytes_per_pixel += double(count) * samples * double(sizeof(LayerPixel));
    layers += int(count);
    most_samples = std::max(most_samples, samples);
  }
};

// A cloud that is marched has a layer before, between and behind the surfaces.
LayerLoad layersOf(const SceneFile& scene) {
  LayerLoad load;
  const size_t surfaces = scene.terrain ? 2 : 1, parts = surfaces + 1;
  load.add(1, 1);  // the mesh clouds
  if (scene.terrain) load.add(1, scene.terrain->samples_per_side);
  double hits = 0;
  for (const SlabSettings& one : scene.slabs) {
    load.add(parts, one.samples_per_side);
    hits = std::max(hits, kBytesPerHit * one.samples_per_side * one.samples_per_side);
  }
  for (const DistanceCloudSettings& one : scene.distance_clouds) load.add(parts, one.samples_per_side);
  for (const DensityCloudSettings& one : scene.density_clouds) load.add(parts, one.samples_per_side);
  for (const SceneDust& one : scene.dust) load.add(parts, one.settings.samples_per_side);
  load.bytes_per_pixel += hits;
  return load;
}

std::string sizeText(const Camera& camera) { return fmt::format("{}x{} pixels", camera.width, camera.height); }

MemoryNeed pixelsNeed(const SceneFile& scene, std::span<const Instance> instances, const Camera& camera) {
  const bool all_steps = scene.view.channels || scene.view.steps;
  // The light of lamps and own colours go through the chain as two more images each.
  const double lights = 1 + (scene.light.lamps.empty() ? 0 : 2) + (haveOwnColors(instances, scene.light) ? 2 : 0);
  const double steps = instances.empty() || scene.view.plain ? 0 : all_steps ? kAllSteps : kStepsKept;
  const double blurred = scene.grade.motion_blur ? kBytesPerBlurredPixel : 0;
  double pictures = 1;
  if (scene.compares_techniques)  // each in a panel, and all of them in the sheet
    pictures += 2 * double(scene.slabs.size() + scene.distance_clouds.size() + scene.density_clouds.size() + scene.dust.size() + 1);
  return {(pictures > 1 ? "a sheet of pictures of " : "a picture of ") + sizeText(camera),
          double(camera.width) * camera.height *
              (pictures * (scene.view.plain ? kBytesPerPlainPixel : kBytesPerPixel) + blurred + lights * steps * kBytesPerStep),
          "use a smaller --size, or width and height of [picture]"};
}

MemoryNeed rowsNeed(const SceneFile& scene, const Camera& camera) {
  const LayerLoad load = layersOf(scene);
  const int rows = std::min(rowsTogether(scene, camera) + 2, camera.height);
  return {fmt::format("{} layers of up to {} samples per pixel, {} rows at a time,", load.layers, load.most_samples, rows),
          load.bytes_per_pixel * camera.width * rows, "lower samples_per_side, or use fewer layers"};
}

MemoryNeed meshesNeed(std::span<const Instance> instances, bool is_traced) {
  double vertices = 0, triangles = 0;
  size_t clouds = 0;
  for (const Instance& instance : instances) {
    if (!instance.is_seen) continue;
    ++clouds;
    vertices += double(instance.mesh->surface.positions.size());
    triangles += double(instance.mesh->surface.triangles.size());
  }
  return {fmt::format("{} clouds with {} vertices in all", clouds, countText(vertices)),
          kBytesPerVertex * vertices + (kBytesPerTriangle + (is_traced ? kBytesPerTracedTriangle : 0)) * triangles,
          "use fewer clouds, or clouds with fewer vertices or with levels = true"};
}

// The plane of a shadow has about twice the cells of its field's longest side in each direction.
MemoryNeed shadowsNeed(const SceneFile& scene, std::span<const Instance> instances) {
  constexpr double kPlane = 4.0 * kCasterVoxels * kCasterVoxels * sizeof(double);
  const auto casters = double(std::count_if(instances.begin(), instances.end(), [](const Instance& one) { return one.caster != nullptr; }));
  return {fmt::format("the shadows of {} clouds", countText(casters)), drawsShadows(scene) ? casters * kPlane : 0,
          "use fewer clouds, or shadows = false in [light]"};
}

}  // namespace

int rowsTogether(const SceneFile& scene, const Camera& camera) {
  const double per_row = std::max(1.0, layersOf(scene).bytes_per_pixel * camera.width);
  const double bytes = std::min(kRowsBytes, double(scene.view.memory_limit) / 4);
  return std::clamp(int(std::min(bytes / per_row, 1e9)), std::min(kLeastRows, camera.height), camera.height);
}

void requirePictureMemory(const SceneFile& scene, std::span<const Instance> instances, const Camera& camera) {
  const bool is_traced = scene.view.plain || scene.post.published;
  const std::array needs{pixelsNeed(scene, instances, camera), rowsNeed(scene, camera), meshesNeed(instances, is_traced),
                         shadowsNeed(scene, instances)};
  requireMemory(needs, scene.view.memory_limit);
}

}  // namespace cloudbake
