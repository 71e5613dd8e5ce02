#include "bake/field/dense_field.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bake/field/level_set.h"
#include "core/level_set_type.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

constexpr int kBrick = DenseField::kBrick;
constexpr float kSafeShare = 0.9F;  // of |φ|, the promise of core/types.h

size_t brickCount(const DenseField& field) { return size_t(field.bricks[0]) * size_t(field.bricks[1]) * size_t(field.bricks[2]); }

std::array<int, 3> brickAt(const DenseField& field, size_t brick) {
  return {int(brick % size_t(field.bricks[0])), int(brick / size_t(field.bricks[0]) % size_t(field.bricks[1])),
          int(brick / size_t(field.bricks[0]) / size_t(field.bricks[1]))};
}

// Both places where a brick holds its corner (i, j, k): as the lower of its pair of rows, and as the upper one. At the ends there is only
// one.
std::vector<float> cornerValues(const DenseField& field, size_t brick, int i, int j, int k) {
  const float* values = field.values.data() + field.offsets[brick] + k * DenseField::kPlane + 2 * i;
  std::vector<float> found;
  if (j < kBrick) found.push_back(values[j * DenseField::kRow]);
  if (j > 0) found.push_back(values[(j - 1) * DenseField::kRow + 1]);
  return found;
}

struct Counts {
  size_t band_corners = 0, wrong_values = 0, wrong_signs = 0, inside_corners = 0, constant_bricks = 0, deep_bricks = 0;
};

// Holds every corner of every brick to the grid, and every constant brick to its promise.
Counts checkAgainstGrid(const DenseField& field, const LevelSet& level_set) {
  const auto accessor = level_set.grid->vdb->getConstAccessor();
  const float band = level_set.grid->vdb->background();
  EXPECT_EQ(field.band, band);
  EXPECT_EQ(field.offsets.size(), brickCount(field));
  Counts counts;
  std::vector<float> deep(brickCount(field), 0.0F);  // φ of bricks that hold one value of the grid only
  std::vector<std::array<int, 3>> with_band;
  for (size_t b = 0; b < brickCount(field); ++b) {
    const auto at = brickAt(field, b);
    bool same = true;
    const float first =
        accessor.getValue({field.first[0] + kBrick * at[0], field.first[1] + kBrick * at[1], field.first[2] + kBrick * at[2]});
    for (int k = 0; k <= kBrick; ++k)
      for (int j = 0; j <= kBrick; ++j)
        for (int i = 0; i <= kBrick; ++i) {
          const float truth = accessor.getValue(
              {field.first[0] + kBrick * at[0] + i, field.first[1] + kBrick * at[1] + j, field.first[2] + kBrick * at[2] + k});
          same = same && truth == first;
          counts.band_corners += std::fabs(truth) < band, counts.inside_corners += truth < 0;
          for (const float phi : cornerValues(field, b, i, j, k)) {
            counts.wrong_signs += (phi < 0) != (truth < 0);
            counts.wrong_values += std::fabs(truth) < band ? phi != truth : !(std::fabs(phi) >= band);
          }
        }
    if (same)
      deep[b] = cornerValues(field, b, 0, 0, 0)[0];
    else
      with_band.push_back(at);
  }

  // 0.9 |φ| may not reach from any point of a constant brick into one with band, nor does it stay far below what it could be.
  for (size_t b = 0; b < deep.size(); ++b) {
    if (deep[b] == 0) continue;
    ++counts.constant_bricks;
    counts.deep_bricks += std::fabs(deep[b]) > band;
    const auto at = brickAt(field, b);
    int gap = 1 << 20;  // bricks in between, by the largest component: no more than the distance
    for (const auto& other : with_band)
      gap = std::min(gap, std::max({std::abs(at[0] - other[0]), std::abs(at[1] - other[1]), std::abs(at[2] - other[2])}) - 1);
    if (with_band.empty()) continue;
    EXPECT_LE(kSafeShare * std::fabs(deep[b]), std::max(float(gap * kBrick), kSafeShare * band) * 1.00001F) << b;
    EXPECT_GE(kSafeShare * std::fabs(deep[b]), float(gap * kBrick) * 0.99999F) << b;
  }
  return counts;
}

void expectBorderOutside(const DenseField& field) {
  size_t inside = 0;
  for (size_t b = 0; b < brickCount(field); ++b) {
    const auto at = brickAt(field, b);
    bool border = false;
    for (size_t a = 0; a < 3; ++a) border = border || at[a] == 0 || at[a] == field.bricks[a] - 1;
    if (!border) continue;
    for (int n = 0; n < 9 * 9 * 9; ++n)
      for (const float phi : cornerValues(field, b, n % 9, n / 9 % 9, n / 81)) inside += !(phi > 0);
  }
  EXPECT_EQ(inside, 0U);
}

LevelSet levelSetOfSpheres(const std::vector<Sphere>& spheres, int voxels) {
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxels = voxels;
  return levelSetFromSpheres(spheres, settings, warnings);
}

LevelSet levelSetOfMesh(const SurfaceMesh& mesh, int voxels) {
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxels = voxels;
  return levelSetFromMesh(mesh, settings, warnings);
}

LevelSet hollowBall() {
  SurfaceMesh inner = ballMesh(0.55F, 4);
  reverse(inner);
  return levelSetOfMesh(merged(ballMesh(1, 4), inner), 90);
}

}  // namespace

// Every corner in the band has the grid's value to the bit, every other its sign: for several spheres, a torus, a cavity, and two clouds
// far apart.
TEST(DenseField, HoldsTheGrid) {
  const std::pair<const char*, LevelSet> shapes[] = {
      {"spheres", levelSetOfSpheres({{{0, 0, 0}, 1}, {{0.9F, 0.3F, 0}, 0.7F}, {{-0.7F, 0.4F, 0.5F}, 0.6F}}, 73)},
      {"torus", levelSetOfMesh(torusMesh(1, 0.4F, 64, 32), 111)},
      {"hollow ball", hollowBall()},
      {"two balls apart", levelSetOfSpheres({{{0, 0, 0}, 1}, {{9, 2, 1}, 0.6F}}, 140)},
      {"small spheres", levelSetOfSpheres({{{0, 0, 0}, 1}, {{1.7F, 0, 0}, 0.03F}, {{0, 1.5F, 0.2F}, 0.02F}}, 60)}};
  for (const auto& [name, level_set] : shapes) {
    SCOPED_TRACE(name);
    const DenseField field = denseFromLevelSet(level_set);
    const Counts counts = checkAgainstGrid(field, level_set);
    EXPECT_EQ(counts.wrong_values, 0U);
    EXPECT_EQ(counts.wrong_signs, 0U);
    EXPECT_GT(counts.band_corners, 1000U);
    EXPECT_GT(counts.inside_corners, 1000U);
    EXPECT_GT(counts.constant_bricks, 0U);
    expectBorderOutside(field);
  }
}

// A field whose inside and surroundings are many bricks deep: constant bricks keep their sign for as many voxels as they promise.
TEST(DenseField, DeepBricksPromiseTheirDistance) {
  const LevelSet level_set = levelSetOfSpheres({{{0, 0, 0}, 1}, {{3, 0, 0}, 0.2F}}, 260);
  const DenseField field = denseFromLevelSet(level_set);
  const Counts counts = checkAgainstGrid(field, level_set);
  EXPECT_EQ(counts.wrong_signs + counts.wrong_values, 0U);
  EXPECT_GT(counts.deep_bricks, 1000U);
  expectBorderOutside(field);
}

// Two voxels of cloud, each in the middle of one brick: whatever the neighbour that a distance comes from, it is the largest component.
TEST(DenseField, LoneBricksPromiseTheirDistance) {
  const auto grid = openvdb::FloatGrid::create(kBandHalfWidth_voxels);
  for (const openvdb::Coord& middle : {openvdb::Coord(4, 4, 4), openvdb::Coord(84, 36, 60)})
    for (int n = 0; n < 27; ++n) grid->tree().setValue(middle.offsetBy(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1), n == 13 ? -0.5F : 0.5F);
  const LevelSet level_set{std::make_shared<LevelSetGrid>(LevelSetGrid{grid}), {}};
  const Counts counts = checkAgainstGrid(denseFromLevelSet(level_set), level_set);
  EXPECT_EQ(counts.wrong_signs + counts.wrong_values, 0U);
  EXPECT_EQ(counts.band_corners, 2U * 27U);
  EXPECT_GT(counts.deep_bricks, 100U);
}

// The interpolated φ keeps its sign within 0.9 |φ|: at pairs of points so far apart, next to smooth and to rough surfaces.
TEST(DenseField, InterpolationKeepsItsSignAsPromised) {
  for (const LevelSet& level_set :
       {levelSetOfSpheres({{{0, 0, 0}, 1}, {{1.3F, 0.2F, 0}, 0.05F}}, 60), levelSetOfMesh(torusMesh(1, 0.3F, 8, 5), 50), hollowBall()}) {
    const DenseField field = denseFromLevelSet(level_set);
    const auto sampleAt = [&](const std::array<float, 3>& p) {
      int cell[3], brick[3];
      float part[3];
      for (size_t a = 0; a < 3; ++a)
        cell[a] = int(std::floor(p[a])), part[a] = p[a] - float(cell[a]), brick[a] = cell[a] / kBrick, cell[a] %= kBrick;
      const size_t b = (size_t(brick[2]) * size_t(field.bricks[1]) + size_t(brick[1])) * size_t(field.bricks[0]) + size_t(brick[0]);
      float sum = 0;
      for (int n = 0; n < 8; ++n) {
        const int i = n & 1, j = n >> 1 & 1, k = n >> 2;
        sum += cornerValues(field, b, cell[0] + i, cell[1] + j, cell[2] + k)[0] * (i ? part[0] : 1 - part[0]) *
               (j ? part[1] : 1 - part[1]) * (k ? part[2] : 1 - part[2]);
      }
      return sum;
    };
    uint64_t state = 1;
    const auto draw = [&] { return float((state = state * 6364136223846793005ULL + 1442695040888963407ULL) >> 40) / 16777216.0F; };
    int broken = 0, checked = 0;
    while (checked < 200000) {
      std::array<float, 3> p, q;
      for (size_t a = 0; a < 3; ++a) p[a] = draw() * float(kBrick * field.bricks[a] - 1);
      const float phi = sampleAt(p);
      const auto w = normalized(Vec3{draw() - 0.5F, draw() - 0.5F, draw() - 0.5F}).value_or(Vec3{1, 0, 0});
      const float reach = kSafeShare * std::fabs(phi) * (0.5F + 0.5F * draw()), step[3] = {w.x * reach, w.y * reach, w.z * reach};
      bool in_box = true;
      for (size_t a = 0; a < 3; ++a) q[a] = p[a] + step[a], in_box = in_box && q[a] >= 0 && q[a] < float(kBrick * field.bricks[a] - 1);
      if (!in_box) continue;
      broken += (sampleAt(q) < 0) != (phi < 0);
      ++checked;
    }
    EXPECT_LT(broken, 20) << "of " << checked;  // one in ten thousand
  }
}

// The smallest grids: a cloud of one voxel, of two, and none at all.
TEST(DenseField, TinyAndEmptyGrids) {
  for (const int voxels : {1, 2, 3, 5}) {
    const LevelSet level_set = levelSetOfMesh(ballMesh(1, 3), voxels);
    const DenseField field = denseFromLevelSet(level_set);
    const Counts counts = checkAgainstGrid(field, level_set);
    EXPECT_EQ(counts.wrong_values + counts.wrong_signs, 0U) << voxels;
    EXPECT_GT(counts.band_corners, 0U);
    expectBorderOutside(field);
  }
  const LevelSet empty{std::make_shared<LevelSetGrid>(LevelSetGrid{openvdb::FloatGrid::create(kBandHalfWidth_voxels)}), {}};
  const DenseField field = denseFromLevelSet(empty);
  EXPECT_EQ(field.offsets.size(), brickCount(field));
  EXPECT_GE(*std::min_element(field.values.begin(), field.values.end()), kBandHalfWidth_voxels);
  expectBorderOutside(field);
}

// Constant bricks are shared, so that memory goes with the surface: doubling the resolution does not multiply it by eight.
TEST(DenseField, MemoryGoesWithTheSurface) {
  const auto bytes = [](int voxels) { return double(denseFromLevelSet(levelSetOfSpheres({{{0, 0, 0}, 1}}, voxels)).values.size()); };
  EXPECT_LT(bytes(240) / bytes(120), 5);
}
