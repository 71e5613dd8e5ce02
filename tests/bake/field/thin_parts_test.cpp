#include "bake/field/thin_parts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/mesh/mesh_topology.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

struct Thin {
  Defect coverage, dense;
};

// With voxels of 1.
Thin thinOf(const SurfaceMesh& mesh) {
  LevelSetSettings settings;
  settings.voxel_size = 1.0F;
  Warnings warnings;
  const std::vector<Vec3> normals = smoothNormals(mesh);
  const BakePoints points{mesh.positions, normals};
  return {findThinParts(points, coverageFromClosedMesh(mesh, settings, warnings).value()),
          findThinParts(points, denseFromLevelSet(levelSetFromMesh(mesh, settings, warnings)))};
}

}  // namespace

TEST(ThinParts, NoneInASolid) {
  for (const SurfaceMesh& mesh : {ballMesh(8, 3), boxMesh({-8.1F, -7.3F, -6.2F}, {8.1F, 7.3F, 6.2F}), torusMesh(12, 3, 48, 24)}) {
    EXPECT_EQ(thinOf(mesh).coverage.count, 0U);
    EXPECT_EQ(thinOf(mesh).dense.count, 0U);
  }
}

// An ellipsoid whose middle is t voxels thick: at height y of the unit ball it is made of, t |y|; that is under a voxel for the share 1/t
// of its vertices. At the rim, normals lead along the disc, and some see more.
TEST(ThinParts, ASheetUnderAVoxel) {
  for (const float thickness : {0.3F, 0.6F, 3.0F}) {
    SCOPED_TRACE(thickness);
    SurfaceMesh disc = ballMesh(1, 4);
    for (Vec3& p : disc.positions) p = {20 * p.x, thickness / 2 * p.y, 20 * p.z};
    const auto all = double(disc.positions.size());
    const double most = std::min(1.0, 1 / double(thickness)) * all;
    const Thin thin = thinOf(disc);
    for (const uint64_t count : {thin.coverage.count, thin.dense.count}) {
      EXPECT_LE(double(count), most);
      EXPECT_GT(double(count), thickness < 1 ? 0.9 * most : 0.5 * most);
    }
  }
}

TEST(ThinParts, NeedANormal) {
  const SurfaceMesh ball = ballMesh(1, 1);
  LevelSetSettings settings;
  settings.voxel_size = 3.0F;
  Warnings warnings;
  const auto field = coverageFromClosedMesh(ball, settings, warnings).value();
  EXPECT_EQ(findThinParts({ball.positions, std::vector<Vec3>(ball.positions.size())}, field).count, 0U);
  EXPECT_EQ(findThinParts({ball.positions, {}}, field).count, 0U);
}
