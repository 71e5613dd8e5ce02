#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>

#include "bake/field/coverage.h"
#include "core/level_set_type.h"
#include "core/parallel.h"

namespace cloudbake {

CoverageField coverageFromLevelSet(const LevelSet& level_set, std::span<const Vec3> points) {
  const openvdb::FloatGrid& grid = *level_set.grid->vdb;
  openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  for (const Vec3& p : points) {
    const Vec3 index = level_set.frame.toIndex(p);
    box.expand(openvdb::Coord(int(std::floor(index.x)), int(std::floor(index.y)), int(std::floor(index.z))));
    box.expand(openvdb::Coord(int(std::ceil(index.x)), int(std::ceil(index.y)), int(std::ceil(index.z))));
  }
  if (box.empty()) return emptyField(level_set.frame, {0, 0, 0}, {0, 0, 0});
  CoverageField field =
      emptyField(level_set.frame, {box.min().x(), box.min().y(), box.min().z()}, {box.max().x(), box.max().y(), box.max().z()});
  parallelFor(field.cells[2], [&](int k) {
    const auto accessor = grid.getConstAccessor();
    size_t cell = size_t(k) * size_t(field.cells[1]) * size_t(field.cells[0]);
    for (int j = 0; j < field.cells[1]; ++j)
      for (int i = 0; i < field.cells[0]; ++i)
        field.fractions[cell++] =
            std::clamp(0.5F - accessor.getValue({field.first[0] + i, field.first[1] + j, field.first[2] + k}), 0.0F, 1.0F);
  });
  return field;
}

}  // namespace cloudbake
