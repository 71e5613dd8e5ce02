// In a slab of t voxels, a point at depth 1 below the upper face is t − 1 above the lower face. The inside fraction of a cell there, which
// is linear across a face, is ½ for t = 1. Below a sharp corner the first voxel is mostly outside too, but deeper ones are not.
#include "bake/field/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr int kDeepest = 3;

// Trilinear interpolation of lattice values. Everything beyond the lattice is `outside`.
template <class ValueAt>
float sampled(const std::array<int, 3>& counts, Vec3 p, float outside, const ValueAt& value_at) {
  const float at[3] = {p.x, p.y, p.z};
  int low[3];
  float share[3];
  for (size_t a = 0; a < 3; ++a) {
    if (!(at[a] >= 0 && at[a] < float(counts[a] - 1))) return outside;
    low[a] = int(at[a]);
    share[a] = at[a] - float(low[a]);
  }
  float sum = 0;
  for (int n = 0; n < 8; ++n) {
    const int x = n & 1, y = n >> 1 & 1, z = n >> 2;
    sum += (x ? share[0] : 1 - share[0]) * (y ? share[1] : 1 - share[1]) * (z ? share[2] : 1 - share[2]) *
           value_at(low[0] + x, low[1] + y, low[2] + z);
  }
  return sum;
}

template <class IsInside>
Defect findThin(const BakePoints& points, const GridFrame& frame, const std::array<int, 3>& first, const IsInside& is_inside) {
  constexpr size_t kGrain = 1 << 13;
  Defect thin;
  std::mutex mutex;
  parallelBlocks(points.normals.size(), kGrain, [&](size_t begin, size_t end) {
    Defect found;
    for (size_t v = begin; v < end; ++v) {
      if (points.normals[v] == Vec3{}) continue;
      const Vec3 at = frame.toIndex(points.positions[v]) - Vec3{float(first[0]), float(first[1]), float(first[2])};
      bool is_thick = false;
      for (int depth = 1; depth <= kDeepest && !is_thick; ++depth) is_thick = is_inside(at - points.normals[v] * float(depth));
      if (!is_thick) found.meet(uint32_t(v));
    }
    const std::lock_guard lock(mutex);
    thin.add(found);
  });
  return thin;
}

}  // namespace

Defect findThinParts(const BakePoints& points, const CoverageField& field) {
  return findThin(points, field.frame, field.first, [&](Vec3 p) {
    return sampled(field.cells, p, 0, [&](int x, int y, int z) {
             return field.fractions[(size_t(z) * size_t(field.cells[1]) + size_t(y)) * size_t(field.cells[0]) + size_t(x)];
           }) >= 0.5F;
  });
}

Defect findThinParts(const BakePoints& points, const DenseField& field) {
  constexpr int kBrick = DenseField::kBrick;
  const std::array<int, 3> counts{field.bricks[0] * kBrick, field.bricks[1] * kBrick, field.bricks[2] * kBrick};
  return findThin(points, field.frame, field.first, [&](Vec3 p) {
    return sampled(counts, p, field.band, [&](int x, int y, int z) {
             const size_t brick =
                 (size_t(z / kBrick) * size_t(field.bricks[1]) + size_t(y / kBrick)) * size_t(field.bricks[0]) + size_t(x / kBrick);
             return field.values[size_t(field.offsets[brick]) +
                                 size_t(z % kBrick * DenseField::kPlane + y % kBrick * DenseField::kRow + 2 * (x % kBrick))];
           }) <= 0;
  });
}

}  // namespace cloudbake
