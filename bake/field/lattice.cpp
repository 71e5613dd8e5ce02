// The lattice of a field, and whether it can hold a shape.
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "bake/field/level_set.h"
#include "core/error.h"
#include "core/memory_budget.h"

namespace cloudbake {

// float32 has 24 bits of precision, so its steps become visible on a shape far from the origin.
void warnIfCoarse(const Box& box, Warnings& warnings) {
  const Vec3 far{std::fmax(-box.low.x, box.high.x), std::fmax(-box.low.y, box.high.y), std::fmax(-box.low.z, box.high.z)};
  const float largest = std::fmax(far.x, std::fmax(far.y, far.z));
  const float step = std::nextafter(largest, INFINITY) - largest;
  if (step > 1e-3F * box.longestSide())
    warnings.add(
        WarningKind::kCoarseCoordinates,
        fmt::format(
            "at this distance from the origin float32 coordinates have steps of {:.2g} of the shape's size: move the shape to the origin",
            double(step) / box.longestSide()));
}

void checkMemory(double bytes, const Box& box, double voxel_size, uint64_t limit) {
  const double longest = box.longestSide() / voxel_size;
  const std::string voxels = countText(std::round(longest)) + " voxels along the longest side";
  requireMemory({"a field of " + voxels, bytes, "use fewer --voxels or a larger --voxel-size"}, limit);
  constexpr double kLargestIndex = 8000;  // bound of bake/field/winding.h, and far below float's 2²⁴
  if (longest > kLargestIndex)
    throw InputError("", fmt::format("{} exceed the limit of {:.0f}: use fewer --voxels or a larger --voxel-size", voxels, kLargestIndex));
}

GridFrame meshFrame(const SurfaceMesh& mesh, const LevelSetSettings& settings, BytesEstimate estimate, Warnings& warnings) {
  if (mesh.triangles.empty()) throw InputError("", "the mesh has no triangles");
  Box box;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    box.add(mesh.positions[v]);
    if (!isFinite(mesh.positions[v])) throw InputError("", "vertex " + std::to_string(v) + " is not finite: repair the mesh");
  }
  const GridFrame frame = frameFor(box, settings);
  checkMemory(estimate(box, frame.voxel_size), box, frame.voxel_size, settings.memory_limit);
  warnIfCoarse(box, warnings);
  return frame;
}

void warnIfNotHeld(double volume_of_mesh, double volume_of_field, Warnings& warnings) {
  if (volume_of_mesh < 0) warnings.add(WarningKind::kInvertedMesh, "the triangles face inwards: the mesh is treated as the same solid");
  if (volume_of_field < 0.5 * std::fabs(volume_of_mesh))
    warnings.add(WarningKind::kVolumeMismatch,
                 fmt::format("the field contains {:.3g} of the mesh's volume, because parts are thinner than a voxel: use more --voxels",
                             volume_of_field / std::fabs(volume_of_mesh)));
}

GridFrame frameFor(const Box& box, const LevelSetSettings& settings) {
  const double longest = box.longestSide();
  if (!(longest > 0)) throw InputError("", "the shape has no extent: all its points coincide");
  if (!std::isfinite(longest)) throw InputError("", "the bounding box is beyond the range of float: scale the shape down");
  GridFrame frame;
  frame.voxel_size = settings.voxel_size ? double(*settings.voxel_size) : longest / settings.voxels;
  // In double, because GCC 12 leaves out the rounding of some, but not all, floats that are converted.
  const auto middle = [](double low, double high) { return (low + high) / 2; };
  frame.origin = {middle(box.low.x, box.high.x), middle(box.low.y, box.high.y), middle(box.low.z, box.high.z)};
  return frame;
}

double estimateBytes(const Box& box, double voxel_size) {
  // A crumpled surface has about twice the area of its box. The band is a little over 6 voxels thick, in leaves that are half full. A
  // voxel needs a float, its masks and the distance builder's index; a surface voxel also needs a vertex and two triangles.
  const double x = box.size().x / voxel_size + 1, y = box.size().y / voxel_size + 1, z = box.size().z / voxel_size + 1;
  const double surface_voxels = 2 * 2 * (x * y + y * z + z * x);
  return surface_voxels * (2 * 6 * 10.0 + 100);
}

}  // namespace cloudbake
