#include "bake/lobe/sparse_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bake/field/coverage.h"
#include "core/parallel.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

const SurfaceMesh& fineTorus() {
  static const SurfaceMesh mesh = torusMesh(1, 0.4F, 800, 400);
  return mesh;
}
CoverageField fieldOf(float voxel) { return coverageFromMesh(fineTorus(), {{0, 0, 0}, voxel}).value(); }
BakePoints pointsOf(const SurfaceMesh& mesh) { return {mesh.positions, mesh.normals}; }

// A lobe that changes smoothly with the place.
Lobe lobeAt(Vec3 p) { return {normalized(Vec3{0.3F * p.x, -1, 0.3F * p.z}).value(), 1 + 0.2F * p.x}; }

std::vector<Lobe> lobesAtChosen(const SparsePoints& sparse, const SurfaceMesh& mesh) {
  std::vector<Lobe> lobes;
  for (const size_t v : sparse.chosen()) lobes.push_back(lobeAt(mesh.positions[v]));
  return lobes;
}

}  // namespace

TEST(SparsePoints, AreChosenOnlyWhereMeshesAreFine) {
  const SurfaceMesh few = torusMesh(1, 0.4F, 100, 50);
  EXPECT_FALSE(SparsePoints::choose(pointsOf(few), fieldOf(0.1F)));
  EXPECT_FALSE(SparsePoints::choose(pointsOf(fineTorus()), fieldOf(0.008F)));
  const auto sparse = SparsePoints::choose(pointsOf(fineTorus()), fieldOf(0.06F));
  ASSERT_TRUE(sparse);
  EXPECT_GT(sparse->chosen().size(), 4000U);
  EXPECT_LE(4 * sparse->chosen().size(), fineTorus().positions.size());
  EXPECT_EQ(std::set<size_t>(sparse->chosen().begin(), sparse->chosen().end()).size(), sparse->chosen().size());
}

TEST(SparsePoints, BlendsSmoothly) {
  const auto sparse = SparsePoints::choose(pointsOf(fineTorus()), fieldOf(0.06F));
  ASSERT_TRUE(sparse);
  const std::vector<Lobe> blended = sparse->blended(lobesAtChosen(*sparse, fineTorus()));
  ASSERT_EQ(blended.size(), fineTorus().positions.size());
  double largest_angle = 0, largest_step = 0;
  for (size_t v = 0; v < blended.size(); ++v) {
    const Lobe truth = lobeAt(fineTorus().positions[v]);
    largest_angle = std::max(largest_angle, angleDegrees(blended[v].direction, truth.direction));
    EXPECT_NEAR(blended[v].thickness, truth.thickness, 0.012F);
    EXPECT_NEAR(length(blended[v].direction), 1, 1e-5F);
    largest_step = std::max(largest_step, std::fabs(double(blended[v].thickness) - double(blended[(v + 1) % blended.size()].thickness)));
  }
  EXPECT_LT(largest_angle, 1);
  EXPECT_LT(largest_step, 0.004) << "neighbours, 0.006 apart, have a step between them";
}

// A lobe without thickness keeps its direction.
TEST(SparsePoints, BlendsLobesWithoutThickness) {
  const auto sparse = SparsePoints::choose(pointsOf(fineTorus()), fieldOf(0.06F));
  ASSERT_TRUE(sparse);
  for (const Lobe& lobe : sparse->blended(std::vector<Lobe>(sparse->chosen().size(), {{1, 0, 0}, 0}))) {
    ASSERT_EQ(lobe.thickness, 0);
    ASSERT_NEAR(lobe.direction.x, 1, 1e-6F);
  }
}

TEST(SparsePoints, DoNotDependOnOrderAndThreads) {
  SurfaceMesh turned = fineTorus();
  std::reverse(turned.positions.begin(), turned.positions.end());
  std::reverse(turned.normals.begin(), turned.normals.end());
  const CoverageField field = fieldOf(0.06F);
  const auto blendedOf = [&](const SurfaceMesh& mesh, int threads) {
    const ThreadLimit limit(threads);
    const auto sparse = SparsePoints::choose(pointsOf(mesh), field);
    return sparse->blended(lobesAtChosen(*sparse, mesh));
  };
  const std::vector<Lobe> first = blendedOf(fineTorus(), 1), second = blendedOf(fineTorus(), 2);
  std::vector<Lobe> third = blendedOf(turned, 2);
  std::reverse(third.begin(), third.end());
  for (size_t v = 0; v < first.size(); ++v) {
    ASSERT_TRUE(first[v].direction == second[v].direction && first[v].thickness == second[v].thickness);
    ASSERT_TRUE(first[v].direction == third[v].direction && first[v].thickness == third[v].thickness);
  }
}
