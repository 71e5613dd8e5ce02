#include "bake/field/thin_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

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

// A hundred points each on the upper and on the lower side of a slab 40 voxels wide.
struct SlabPoints {
  std::vector<Vec3> positions, normals;
  BakePoints view() const { return {positions, normals}; }
};
SlabPoints pointsOnSlab(float low, float high) {
  SlabPoints points;
  for (int i = 0; i < 100; ++i)
    for (const bool up : {true, false}) {
      points.positions.push_back({1.37F * float(i % 10) - 6, up ? high : low, 1.41F * float(i / 10) - 6});
      points.normals.push_back({0, up ? 1.0F : -1.0F, 0});
    }
  return points;
}

uint64_t thinByCoverage(const SurfaceMesh& mesh, const SlabPoints& points) {
  return findThinParts(points.view(), coverageFromMesh(mesh, GridFrame{}).value()).count;
}

uint64_t thinByDistance(const SurfaceMesh& mesh, const SlabPoints& points) {
  LevelSetSettings settings;
  settings.voxel_size = 1.0F;
  Warnings warnings;
  return findThinParts(points.view(), denseFromLevelSet(levelSetFromMesh(mesh, settings, warnings))).count;
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

// A slab of t voxels is thin for t under 1. The fractions of its cells put a face up to a third of a voxel off, as it lies to the lattice.
TEST(ThinParts, SlabsAreThinUnderAVoxel) {
  for (int place = 0; place < 10; ++place) {
    const float low = 0.1F * float(place) + 0.03F;
    for (const float thickness : {0.1F, 0.3F, 0.6F, 1.4F, 2.0F, 2.7F, 5.0F, 9.0F}) {
      const SurfaceMesh slab = boxMesh({-20, low, -20}, {20, low + thickness, 20});
      EXPECT_EQ(thinByCoverage(slab, pointsOnSlab(low, low + thickness)), thickness < 1 ? 200U : 0U) << thickness << " at " << low;
    }
  }
  // Distances are exact. The slab's centre lies on the lattice.
  for (const float thickness : {0.2F, 0.5F, 0.9F, 1.1F, 1.5F, 2.0F, 2.7F, 5.0F, 9.0F}) {
    const SurfaceMesh slab = boxMesh({-20, -thickness / 2, -20}, {20, thickness / 2, 20});
    EXPECT_EQ(thinByDistance(slab, pointsOnSlab(-thickness / 2, thickness / 2)), thickness < 1 ? 200U : 0U) << thickness;
  }
}

// What lies four voxels below a sheet is another part: it does not make the sheet thick.
TEST(ThinParts, ASheetAboveAnotherIsThin) {
  const SurfaceMesh sheet = boxMesh({-20, 1.75F, -20}, {20, 2.25F, 20}), other = boxMesh({-20, -9, -20}, {20, -2.25F, 20});
  const SurfaceMesh both = merged(sheet, other);
  const SlabPoints points = pointsOnSlab(1.75F, 2.25F);
  EXPECT_EQ(thinByCoverage(both, points), 200U);
  EXPECT_EQ(thinByDistance(both, points), 200U);
}

// The tip of a spike that is inside two or three voxels below is sharp and not thin; one that is inside four below is thin. The axis of the
// square pyramid runs midway between four columns of cells, half a cell from each, so that it is inside where its half-width is over ½.
TEST(ThinParts, SharpTipsAreThickThreeVoxelsBelow) {
  for (const auto& [half_width_per_depth, is_thin] :
       {std::pair{0.6F, false}, {0.36F, false}, {0.21F, false}, {0.14F, true}, {0.11F, true}}) {
    const float w = 40 * half_width_per_depth;
    const SurfaceMesh spike{
        {{0.5F, 0, 0.5F}, {0.5F - w, -40, 0.5F - w}, {0.5F + w, -40, 0.5F - w}, {0.5F + w, -40, 0.5F + w}, {0.5F - w, -40, 0.5F + w}},
        {},
        {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}, {1, 2, 3}, {1, 3, 4}}};
    ASSERT_GT(signedVolume(spike), 0);
    const CoverageField field = coverageFromMesh(spike, GridFrame{}).value();
    const std::vector<Vec3> normals{{0, 1, 0}, {}, {}, {}, {}};
    EXPECT_EQ(findThinParts({spike.positions, normals}, field).count, is_thin ? 1U : 0U) << half_width_per_depth;
  }
}

// Only the points of a thin fin on a solid are counted, and the first of them is named by its index.
TEST(ThinParts, TheFirstIsNamed) {
  const SurfaceMesh solid = boxMesh({-10, -10, -10}, {10, 0, 10}), fin = boxMesh({10, -5.25F, -10}, {20, -4.75F, 10});
  const CoverageField field = coverageFromMesh(merged(solid, fin), GridFrame{}).value();
  const std::vector<Vec3> positions{{0, 0, 0}, {5, 0, 5}, {15, -4.75F, 0}, {3, 0, 3}, {16, -5.25F, 2}};
  const std::vector<Vec3> normals{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, -1, 0}};
  const Defect thin = findThinParts({positions, normals}, field);
  EXPECT_EQ(thin.count, 2U);
  EXPECT_EQ(thin.first, 2U);
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
