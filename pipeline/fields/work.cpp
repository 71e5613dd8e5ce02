// Seconds were measured with the preset humilis at 100 to 1,200 voxels, with a blend of 0 to 50 % of its longest side, remeshed to 8,000 to
// 340,000 triangles, and swept at 200 to 800 voxels, on a Xeon of 2.1 GHz.
#include "pipeline/fields/work.h"

#include <algorithm>
#include <cmath>

#include "bake/field/level_set.h"
#include "core/memory_budget.h"
#include "core/portable_math.h"
#include "pipeline/fields/fields.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

namespace {

// The mean number of spheres that can affect the surface of one of them: what a smooth union adds of others fades as e⁻ᵈ/ᵏ.
double spheresInReach(std::span<const Sphere> spheres, double k) {
  constexpr size_t kAsked = 64;
  constexpr double kReach = 12;
  const size_t step = std::max<size_t>(1, spheres.size() / kAsked);
  double near = 0, asked = 0;
  for (size_t i = 0; i < spheres.size(); i += step, ++asked)
    for (const Sphere& other : spheres)
      near += double(length(spheres[i].center - other.center)) < double(spheres[i].radius) + double(other.radius) + kReach * k;
  return near / std::max(1.0, asked);
}

}  // namespace

StageWork levelSetWork(std::span<const Sphere> spheres, const FieldSettings& settings) {
  constexpr double kSecondsPerVoxel = 2e-6, kSecondsPerBlockAndSphere = 5e-9, kSecondsPerVoxelAndSphere = 3e-9, kBlock = 8, kLayers = 3;
  const Box box = boundingBox(spheres);
  const double longest_side = box.longestSide(), blend = settings.blend.resolve(box.longestSide());
  const double voxel_size = settings.voxel_size ? double(*settings.voxel_size) : longest_side / settings.voxels;
  const double k = blend / (4 * portableLog(2.0)), margin = 2 * 4 * k * portableLog(double(spheres.size()) + 1);
  const auto cells = [&](float side, double more) { return (double(side) + more) / voxel_size + 1; };
  const Vec3 size = box.size();
  const double x = cells(size.x, 0), y = cells(size.y, 0), z = cells(size.z, 0), on_surface = 2 * (x * y + y * z + z * x);
  const double blocks = cells(size.x, margin) * cells(size.y, margin) * cells(size.z, margin) / (kBlock * kBlock * kBlock);
  return {"the level set of " + countText(std::round(longest_side / voxel_size)) + " voxels along the longest side",
          kSecondsPerVoxel * on_surface + kSecondsPerBlockAndSphere * blocks * double(spheres.size()) +
              kSecondsPerVoxelAndSphere * kLayers * kBlock * on_surface * spheresInReach(spheres, k),
          estimateBytes(box, voxel_size)};
}

StageWork remeshWork(double triangles) {
  constexpr double kSeconds = 2.2e-5, kBytes = 300;
  return {"a mesh of about " + countText(std::round(triangles)) + " triangles", kSeconds * triangles, kBytes * triangles};
}

StageWork sweepWork(const Box& box, double voxel_size, int directions, size_t vertices) {
  constexpr double kSecondsPerCell = 4e-10, kSecondsPerVertex = 8e-9, kBytesPerCell = 12;
  const Vec3 size = box.size();
  const double cells = (size.x / voxel_size + 4) * (size.y / voxel_size + 4) * (size.z / voxel_size + 4), axes = double(directions) / 2;
  return {"a sweep of " + std::to_string(directions) + " directions over " + countText(std::round(cells)) + " cells",
          axes * (kSecondsPerCell * cells + kSecondsPerVertex * double(vertices)), kBytesPerCell * cells};
}

}  // namespace cloudbake
