// Level sets whose band is not closed: clipped, in tiles, half of the band. Each must be what openvdb::tools::volumeToMesh makes of it,
// closed where inactive values change sign.
#include <openvdb/tools/Clip.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <unordered_map>

#include "bake/field/coverage.h"
#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/shells.h"
#include "io/volume/vdb_signs.h"
#include "tests/folders.h"
#include "tests/io/volume/vdb_helpers.h"

namespace cloudbake {
namespace {

using openvdb::FloatGrid;

constexpr double kFar = 100;

FloatGrid::Ptr clipped(const FloatGrid& grid, const openvdb::BBoxd& box) {
  FloatGrid::Ptr result = openvdb::tools::clip(grid, box);
  result->setGridClass(openvdb::GRID_LEVEL_SET);
  result->setName("surface");
  return result;
}

FloatGrid::Ptr emptyLevelSet() {
  auto grid = FloatGrid::create(3);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

openvdb::BBoxd everything(double reach = kFar) { return {openvdb::Vec3d(-reach), openvdb::Vec3d(reach)}; }

/// All on one side of a plane through an axis: below `at` if `is_upper`.
openvdb::BBoxd halfSpace(int axis, bool is_upper, double at, double reach = kFar) {
  openvdb::BBoxd box = everything(reach);
  (is_upper ? box.max() : box.min())[axis] = at;
  return box;
}

/// The volume of all voxels inside, by the file alone.
double volumeOf(const FloatGrid& grid) {
  double voxels = 0;
  for (auto value = grid.cbeginValueAll(); value; ++value)
    if (*value <= 0) voxels += (*value < 0 ? 1 : 0.5) * double(value.getVoxelCount());
  return voxels * std::pow(grid.voxelSize().x(), 3);
}

struct Read {
  SurfaceMesh mesh;
  LevelSet level_set;
  Warnings warnings;
};
Read readBack(const openvdb::GridBase::Ptr& grid, const VdbSettings& settings = {}) {
  const TestFolder folder;
  Read read;
  read.level_set = decodeVdb("a.vdb", readFileBytes(writeVdb(folder, {grid})), settings, read.warnings).level_set;
  read.mesh = surfaceOf(read.level_set);
  return read;
}

void expectOneClosedBody(const SurfaceMesh& mesh) {
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
  EXPECT_EQ(shellsOf(weldedByPosition(mesh)).size(), 1U);
  EXPECT_EQ(int(mesh.positions.size()) - int(mesh.triangles.size()) / 2, 2) << "it has handles, or hangs together by a thread";
}

void expectWarning(const Warnings& warnings) {
  ASSERT_EQ(warnings.entries().size(), 1U);
  const Warnings::Entry& entry = warnings.entries().at(WarningKind::kVolumeRebuilt);
  EXPECT_EQ(entry.count, 1U);
  EXPECT_NE(entry.first.find("has a band that is not closed"), std::string::npos) << entry.first;
}

double component(Vec3 p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

double farthest(const SurfaceMesh& mesh, Vec3 center = {}) {
  double most = 0;
  for (const Vec3& p : mesh.positions) most = std::fmax(most, length(p - center));
  return most;
}

double capVolume(double radius, double from_center) {
  const double height = radius - from_center;
  return kPi * height * height * (3 * radius - height) / 3;
}

// The clip goes through voxels at z = −0.4: the cap is between the last voxel inside and the next one.
TEST(VdbOpenBandTest, ABallCutByAPlane) {
  const FloatGrid::Ptr grid = clipped(*ballGrid(2, {}, 0.1), halfSpace(2, false, -0.39, 10));
  const Read read = readBack(grid);
  expectOneClosedBody(read.mesh);
  expectWarning(read.warnings);
  EXPECT_LT(farthest(read.mesh), 2.02);
  EXPECT_NEAR(signedVolume(read.mesh), 21.75, 0.75);
  EXPECT_NEAR(insideVolume(read.level_set), volumeOf(*grid), 1e-3);
}

TEST(VdbOpenBandTest, AllSixSidesOnBordersOfLeavesAndInsideThem) {
  constexpr double kRadius = 25;  // voxels of 1
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_upper : {false, true})
      for (const int last : {-16, -9, -8, 0, 3, 7}) {  // the last voxel that is kept
        if (!runsWhole() && axis > 0 && last != -8 && last != 3) continue;
        SCOPED_TRACE(testing::Message() << "axis " << axis << " upper " << is_upper << " last " << last);
        const Read read = readBack(clipped(*ballGrid(kRadius, {}, 1), halfSpace(axis, is_upper, last)));
        expectOneClosedBody(read.mesh);
        expectWarning(read.warnings);
        const double sign = is_upper ? 1 : -1, cut = sign * last + 0.5;
        EXPECT_LT(farthest(read.mesh), kRadius + 0.1);
        EXPECT_NEAR(signedVolume(read.mesh), capVolume(kRadius, -cut), 0.03 * capVolume(kRadius, -cut));
        double beyond = -kFar;
        for (const Vec3& p : read.mesh.positions) beyond = std::fmax(beyond, sign * component(p, axis) - cut);
        EXPECT_NEAR(beyond, 0, 0.02) << "the middle of the cap lies between two layers of voxels";
        // Distances. Near the rim, the cap meets the ball between the last voxel inside and the middle, as in OpenVDB's mesh.
        for (auto value = read.level_set.grid->vdb->cbeginValueOn(); value; ++value) {
          const openvdb::Coord at = value.getCoord();
          const Vec3 p = read.level_set.frame.toWorld({float(at.x()), float(at.y()), float(at.z())});
          const double of_ball = length(p) - kRadius, of_plane = sign * component(p, axis) - cut, exact = std::fmax(of_ball, of_plane);
          const bool is_at_rim = std::fabs(of_ball) < 5 && std::fabs(of_plane) < 5;
          if (!is_at_rim && std::fabs(exact) < 1.2) {
            ASSERT_NEAR(*value, exact, 0.1);
          }
        }
      }
}

// A corner of a box in a ball, a frustum's stepped border, and a torus that is cut into a horseshoe.
TEST(VdbOpenBandTest, OtherCuts) {
  const auto ball = ballGrid(25, {3, -2, 1}, 1);
  openvdb::BBoxd corner = everything();
  corner.min() = {-4.0, -8.0, 2.0};
  const Read of_corner = readBack(clipped(*ball, corner));
  expectOneClosedBody(of_corner.mesh);
  EXPECT_NEAR(signedVolume(of_corner.mesh), volumeOf(*clipped(*ball, corner)), 0.03 * volumeOf(*clipped(*ball, corner)));
  EXPECT_LT(farthest(of_corner.mesh, {3, -2, 1}), 25.1);

  // As a frustum crops it: the border moves by a voxel every other layer.
  const auto whole = ball->getConstAccessor();
  auto wedge = emptyLevelSet();
  for (int z = -35; z <= 35; ++z)
    for (int y = -35; y <= 35; ++y)
      for (int x = -35; x <= z / 2 + 3; ++x) {
        float value = 0;
        const bool is_on = whole.probeValue({x, y, z}, value);
        if (is_on || value < 0) wedge->tree().setValue({x, y, z}, value);
        if (!is_on && value < 0) wedge->tree().setValueOff({x, y, z});
      }
  const Read of_wedge = readBack(wedge);
  expectOneClosedBody(of_wedge.mesh);
  expectWarning(of_wedge.warnings);
  EXPECT_NEAR(signedVolume(of_wedge.mesh), volumeOf(*wedge), 0.03 * volumeOf(*wedge));
  EXPECT_LT(farthest(of_wedge.mesh, {3, -2, 1}), 25.1);

  constexpr double kBig = 20, kSmall = 8;
  auto torus = emptyLevelSet();
  for (int x = -32; x < 32; ++x)
    for (int y = -12; y < 12; ++y)
      for (int z = -32; z < 32; ++z) {
        const double phi = std::hypot(std::hypot(x, z) - kBig, y) - kSmall;
        if (phi < 3) torus->tree().setValue({x, y, z}, float(std::fmax(phi, -3)));
        if (phi <= -3) torus->tree().setValueOff({x, y, z});
      }
  const Read of_torus = readBack(clipped(*torus, halfSpace(0, true, 5)));
  expectOneClosedBody(of_torus.mesh);  // no handle: it is cut through on one side
  EXPECT_NEAR(signedVolume(of_torus.mesh), volumeOf(*clipped(*torus, halfSpace(0, true, 5))), 0.02 * signedVolume(of_torus.mesh));
}

// Only one half is active. The other half has its distances, or the background: then the surface is what OpenVDB makes of it.
TEST(VdbOpenBandTest, HalfOfTheBand) {
  const auto whole = ballGrid(25, {}, 1);
  for (const bool is_inner : {false, true})
    for (const bool has_distances : {false, true}) {
      SCOPED_TRACE(testing::Message() << "inner " << is_inner << " distances " << has_distances);
      const FloatGrid::Ptr half = whole->deepCopy();
      for (auto value = half->beginValueOn(); value; ++value) {
        if ((*value < 0) == is_inner) continue;
        if (!has_distances) value.setValue(*value < 0 ? -3 : 3);
        value.setValueOff();
      }
      const Read read = readBack(half);
      expectOneClosedBody(read.mesh);
      expectWarning(read.warnings);
      std::vector<openvdb::Vec3s> points;
      std::vector<openvdb::Vec4I> quads;
      openvdb::tools::volumeToMesh(*half, points, quads);
      double low = kFar, high = 0;
      for (const auto& p : points) low = std::fmin(low, p.length()), high = std::fmax(high, p.length());
      for (const Vec3& p : read.mesh.positions) {
        ASSERT_GT(length(p), low - 0.1);
        ASSERT_LT(length(p), high + 0.1);
        if (has_distances) {
          ASSERT_NEAR(length(p), 25, 0.02);
        }
      }
    }
}

// Two halves of a cut ball have the volume of the whole one.
TEST(VdbOpenBandTest, TilesOfALargerLevelSetAddUp) {
  const auto ball = ballGrid(40, {}, 1);
  for (const double at : {-9.0, 0.0, 7.0}) {
    if (!runsWhole() && at == 0) continue;
    const Read upper = readBack(clipped(*ball, halfSpace(1, false, at))), lower = readBack(clipped(*ball, halfSpace(1, true, at - 1)));
    const double whole = 4.0 / 3 * kPi * 40 * 40 * 40;
    EXPECT_NEAR(signedVolume(upper.mesh) + signedVolume(lower.mesh), whole, 0.003 * whole);
  }
}

// A box within a ball has no active voxel. It is the box of its voxels, half a voxel wider, with rounded edges.
void expectBox(const openvdb::GridBase::Ptr& grid, Vec3 low, Vec3 high, const char* what) {
  SCOPED_TRACE(what);
  const Read read = readBack(grid);
  expectOneClosedBody(read.mesh);
  const Vec3 side = high - low + Vec3{1, 1, 1};
  EXPECT_NEAR(signedVolume(read.mesh), double(side.x) * side.y * side.z, 0.01 * double(side.x) * side.y * side.z);
  const Box box = boundingBox(read.mesh);
  EXPECT_LT(length(box.low - (low - Vec3{0.5F, 0.5F, 0.5F})), 0.02);
  EXPECT_LT(length(box.high - (high + Vec3{0.5F, 0.5F, 0.5F})), 0.02);
}
TEST(VdbOpenBandTest, InsideTilesWithoutABand) {
  expectBox(clipped(*ballGrid(60, {}, 1), {openvdb::Vec3d(-9, -20, -14), openvdb::Vec3d(20, 11, 17)}), {-9, -20, -14}, {20, 11, 17},
            "a box in a ball");
  for (const bool is_active : {false, true}) {
    auto small = emptyLevelSet();
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 3; ++y)
        for (int z = 0; z < 3; ++z) small->tree().addTile(1, {8 * x, 8 * y - 8, 8 * z + 1000}, -3, is_active);
    expectBox(small, {0, -8, 1000}, {23, 15, 1023}, "tiles of 8³ voxels");
  }
  if (runsWhole()) {
    auto large = emptyLevelSet();
    large->tree().addTile(2, {0, -128, 128}, -3, false);
    expectBox(large, {0, -128, 128}, {127, -1, 255}, "a tile of 128³ voxels");
  }
  // Beside a leaf, some of whose voxels are inside, and an inside tile that is larger than its neighbour.
  auto mixed = emptyLevelSet();
  mixed->tree().addTile(2, {0, 0, 0}, -3, false);
  mixed->fill({{128, 0, 0}, {147, 127, 127}}, -3, false);
  expectBox(mixed, {0, 0, 0}, {147, 127, 127}, "a tile and voxels");
}

// A hole in the band where leaves are missing: the background there is outside.
TEST(VdbOpenBandTest, MissingLeaves) {
  const auto grid = ballGrid(25, {}, 1);
  const openvdb::Coord gone(24, 0, 0);
  grid->tree().addTile(1, gone, grid->background(), false);
  const Read read = readBack(grid);
  expectOneClosedBody(read.mesh);
  expectWarning(read.warnings);
  EXPECT_NEAR(signedVolume(read.mesh), volumeOf(*grid), 0.01 * volumeOf(*grid));
  for (const Vec3& p : read.mesh.positions) ASSERT_LT(length(p), 25.1);
}

// Doubles, half floats, active tiles inside, other places and sizes of voxels: the same shape.
TEST(VdbOpenBandTest, TheSameHoweverItIsStored) {
  const auto grid = clipped(*ballGrid(31.7, {}, 1), halfSpace(2, false, -10.9));
  const Read read = readBack(grid);
  expectOneClosedBody(read.mesh);
  const auto expectSame = [&](const openvdb::GridBase::Ptr& other, double scale, Vec3 shift, double tolerance) {
    const Read again = readBack(other);
    expectOneClosedBody(again.mesh);
    expectWarning(again.warnings);
    ASSERT_EQ(again.mesh.positions.size(), read.mesh.positions.size());
    EXPECT_NEAR(signedVolume(again.mesh), std::pow(scale, 3) * signedVolume(read.mesh), tolerance * signedVolume(again.mesh));
    const Box expected = boundingBox(read.mesh), box = boundingBox(again.mesh);
    EXPECT_LT(length(box.low - float(scale) * (expected.low + shift)), 0.1 * scale);
    EXPECT_LT(length(box.high - float(scale) * (expected.high + shift)), 0.1 * scale);
  };
  auto doubles = openvdb::DoubleGrid::create(std::make_shared<openvdb::DoubleTree>(grid->tree()));
  doubles->insertMeta(*grid);
  doubles->setTransform(grid->transformPtr());
  expectSame(doubles, 1, {}, 1e-9);
  const FloatGrid::Ptr halves = grid->deepCopy();
  halves->setSaveFloatAsHalf(true);
  expectSame(halves, 1, {}, 1e-3);
  const FloatGrid::Ptr active = grid->deepCopy();
  for (auto tile = active->beginValueOff(); tile; ++tile)
    if (*tile < 0) tile.setActiveState(true);
  EXPECT_GT(active->activeVoxelCount(), grid->activeVoxelCount());
  expectSame(active, 1, {}, 0.002);
  const auto small = clipped(*ballGrid(31.7e-4, {}, 1e-4), halfSpace(2, false, -10.9e-4, 0.01));
  expectSame(small, 1e-4, {}, 1e-3);
  // As tiles of a set far from the origin lie: whole leaves, so that the same blocks are cut.
  const FloatGrid::Ptr moved = grid->deepCopy();
  moved->clear();
  for (auto value = grid->cbeginValueAll(); value; ++value) {
    if (value.isTileValue() && *value >= 0) continue;
    openvdb::CoordBBox box;
    value.getBoundingBox(box);
    box.translate({16000, -32000, 800});
    moved->fill(box, *value, value.isValueOn());
  }
  expectSame(moved, 1, {16000, -32000, 800}, 1e-3);
}

// Values that are no distances, or none at all, beside the band.
TEST(VdbOpenBandTest, InactiveValues) {
  const auto grid = clipped(*ballGrid(25, {}, 1), halfSpace(0, true, 2));
  const FloatGrid::Ptr huge = grid->deepCopy();
  for (auto value = huge->beginValueOff(); value; ++value) value.setValue(*value < 0 ? -1e38F : 1e38F);
  huge->tree().root().setBackground(1e38F, true);
  expectOneClosedBody(readBack(huge).mesh);
  const FloatGrid::Ptr bad = grid->deepCopy();
  for (auto value = bad->beginValueOff(); value; ++value)
    if (*value < 0) value.setValue(-INFINITY);
  expectError<InputError>([&] { readBack(bad); }, "has values that are not finite");
}

// Inactive inside tiles cost what their surface costs. They are refused before it is made.
TEST(VdbOpenBandTest, LargeTilesAreRefused) {
  const auto refused = [](const FloatGrid::Ptr& grid, const std::string& text) {
    VdbSettings settings;
    settings.memory_limit = 1ULL << 30;
    expectError<InputError>([&] { readBack(grid, settings); }, text);
  };
  auto large = emptyLevelSet();
  large->tree().addTile(3, {0, 0, 0}, -3, false);
  refused(large, "grid '[0]' with 3145728 blocks of 8×8×8 voxels would take about 48");
  auto many = emptyLevelSet();
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 16; ++y)
      for (int z = 0; z < 16; ++z)
        if ((x + y + z) % 2) many->tree().addTile(2, {128 * x, 128 * y, 128 * z}, -3, false);
  refused(many, "GiB");
  auto two = emptyLevelSet();
  two->tree().addTile(3, {0, 0, 0}, -3, false);
  two->tree().addTile(3, {8192, 0, 0}, -3, false);
  refused(two, "is 12288 voxels long, more than the limit of 8000");
  for (const int far : {2000000000, -2000000000}) {
    auto distant = emptyLevelSet();
    distant->tree().addTile(3, {0, far, 0}, -3, false);
    refused(distant, "lies too far from its origin");
  }
}

// Fog ends where its active voxels end, also where it was clipped. openvdb::tools::clip leaves its inner tiles inactive: they are inside.
TEST(VdbOpenBandTest, Fog) {
  auto fog = ballGrid(25, {}, 1);
  openvdb::tools::sdfToFogVolume(*fog);
  const auto expectCap = [](const FloatGrid::Ptr& grid, bool is_rebuilt) {
    const Read read = readBack(grid, {{}, 0.5});
    expectOneClosedBody(read.mesh);
    EXPECT_NEAR(signedVolume(read.mesh), capVolume(25 - 1.5, 3.5), 0.01 * capVolume(23.5, 3.5));
    ASSERT_EQ(read.warnings.entries().size(), is_rebuilt ? 1U : 0U);
    if (!is_rebuilt) return;
    const std::string& text = read.warnings.entries().at(WarningKind::kVolumeRebuilt).first;
    EXPECT_NE(text.find("has inactive voxels above its surface's value"), std::string::npos) << text;
  };
  const FloatGrid::Ptr cut = openvdb::tools::clip(*fog, halfSpace(2, false, 4));
  cut->setGridClass(openvdb::GRID_FOG_VOLUME);
  expectCap(cut, true);
  const FloatGrid::Ptr active = fog->deepCopy();
  active->tree().clip({{-100, -100, 4}, {100, 100, 100}});
  expectCap(active, false);
  for (auto value = active->beginValueOn(); value; ++value)
    if (*value >= 1) value.setValueOff();
  expectCap(active, true);  // a core that reaches the cut
}

// Each pair of neighbours of opposite sign is found once, whatever holds its voxels.
TEST(VdbOpenBandTest, PairsOfOppositeSign) {
  for (const int side : {8, 128}) {
    auto grid = emptyLevelSet();
    grid->tree().addTile(side == 8 ? 1 : 2, {0, 0, 0}, -3, false);
    const SignChanges alone = countSignChanges(*grid, {});
    EXPECT_EQ(alone.none_active, 6U * unsigned(side * side));
    EXPECT_EQ(alone.all(), alone.none_active);
    EXPECT_EQ(alone.blocks, 2.0 * 6 * side * side / 64);
    grid->tree().setValue({-1, 3, 5}, 0.5F);  // the leaf beside it has voxels outside: active is one of them
    const SignChanges beside = countSignChanges(*grid, {});
    EXPECT_EQ(beside.one_active, 1U);
    EXPECT_EQ(beside.all(), alone.all());
    grid->tree().setValue({-2, 3, 5}, -0.5F);
    grid->tree().setValue({-1, 3, 5}, -0.5F);
    const SignChanges grown = countSignChanges(*grid, {});
    EXPECT_EQ(grown.all(), alone.all() - 1 + 9);
    EXPECT_EQ(grown.one_active, 9U);
    grid->tree().setValue({-3, 3, 5}, 0.5F);
    EXPECT_EQ(countSignChanges(*grid, {}).both_active, 1U);
  }
}

// --- the table in docs/numerics.md ---

/// The distance from a point to a triangle.
double distanceTo(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const auto toSegment = [&](Vec3 from, Vec3 to) {
    const Vec3 side = to - from;
    const float squared = dot(side, side), t = squared > 0 ? std::clamp(dot(p - from, side) / squared, 0.0F, 1.0F) : 0;
    return double(length(p - from - t * side));
  };
  const double of_sides = std::min({toSegment(a, b), toSegment(b, c), toSegment(c, a)});
  const std::optional<Vec3> normal = normalized(cross(b - a, c - a));
  if (!normal) return of_sides;
  const float height = dot(p - a, *normal);
  const Vec3 foot = p - height * *normal;
  const bool is_within =
      dot(cross(b - a, foot - a), *normal) >= 0 && dot(cross(c - b, foot - b), *normal) >= 0 && dot(cross(a - c, foot - c), *normal) >= 0;
  return is_within ? std::fabs(double(height)) : of_sides;
}

/// OpenVDB's own mesh of a grid, in boxes of two voxels.
class OpenVdbMesh {
 public:
  explicit OpenVdbMesh(const FloatGrid& grid) : cell_(2 * float(grid.voxelSize().x())) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(grid, points, quads);
    for (const auto& p : points) points_.push_back({p.x(), p.y(), p.z()});
    for (const auto& q : quads)
      for (const Triangle& t : {Triangle{q[0], q[1], q[2]}, Triangle{q[0], q[2], q[3]}}) cells_[cellOf(points_[t[0]])].push_back(t);
  }
  double distance(Vec3 p) const {
    double least = cell_;
    for (int n = 0; n < 27; ++n) {
      const int x = n % 3 - 1, y = n / 3 % 3 - 1, z = n / 9 - 1;
      const auto found = cells_.find(cellOf(p + cell_ * Vec3{float(x), float(y), float(z)}));
      if (found == cells_.end()) continue;
      for (const Triangle& t : found->second) least = std::fmin(least, distanceTo(p, points_[t[0]], points_[t[1]], points_[t[2]]));
    }
    return least;
  }

 private:
  int64_t cellOf(Vec3 p) const {
    const auto index = [&](float x) { return int64_t(std::floor(x / cell_)) + (1 << 19); };
    return (index(p.x) << 40) + (index(p.y) << 20) + index(p.z);
  }
  float cell_;
  std::vector<Vec3> points_;
  std::unordered_map<int64_t, std::vector<Triangle>> cells_;
};

struct Cut {
  const char* name;
  double radius, voxel_size;
  int axis;
  bool is_upper;
  double at;  // the last layer of voxels that is kept
};

/// The chord of the cut ball along a unit direction, from a point at its surface. `plane` is where sign · x ends.
double exactChord(const Cut& cut, double sign, double plane, Vec3 p, Vec3 direction) {
  const double b = dot(p, direction), c = double(dot(p, p)) - cut.radius * cut.radius, root = b * b - c;
  if (root <= 0) return 0;
  double first = std::fmax(0, -b - std::sqrt(root)), last = -b + std::sqrt(root);
  const double slope = sign * component(direction, cut.axis), room = plane - sign * component(p, cut.axis);
  if (slope > 0) last = std::fmin(last, room / slope);
  if (slope < 0) first = std::fmax(first, room / slope);
  if (slope == 0 && room < 0) return 0;
  return std::fmax(0, last - first);
}

TEST(VdbOpenBandTest, SixCutBallsBesideOpenVdb) {
  for (const Cut& cut :
       {Cut{"x > -0.4", 2, 0.1, 0, false, -0.4}, Cut{"x < 0.7", 2, 0.1, 0, true, 0.7}, Cut{"y > 0", 2, 0.1, 1, false, 0},
        Cut{"y < -0.8", 2, 0.1, 1, true, -0.8}, Cut{"z > -1.5", 2, 0.05, 2, false, -1.5}, Cut{"z < 1.2", 2, 0.05, 2, true, 1.2}}) {
    SCOPED_TRACE(cut.name);
    const double h = cut.voxel_size, sign = cut.is_upper ? 1 : -1, plane = sign * cut.at + 0.5 * h;
    const auto grid = clipped(*ballGrid(cut.radius, {}, h), halfSpace(cut.axis, cut.is_upper, cut.at + 0.1 * h, 10));
    const Read read = readBack(grid);
    expectOneClosedBody(read.mesh);

    const OpenVdbMesh peer(*grid);
    double off = 0;
    for (const Vec3& p : read.mesh.positions)
      if (sign * component(p, cut.axis) < plane - 1.5 * h) off = std::fmax(off, peer.distance(p) / h);

    const double volume = signedVolume(read.mesh), exact = capVolume(cut.radius, -plane);
    Warnings warnings;
    BakeSettings settings;
    settings.rays = 100;
    settings.ray_length = 8;
    const std::vector<Lobe> lobes =
        bakeSweep({read.mesh.positions, read.mesh.normals}, coverageFromLevelSet(read.level_set), settings, warnings);
    double squared = 0, mean = 0;
    for (size_t v = 0; v < lobes.size(); ++v) {
      const double chord = exactChord(cut, sign, plane, read.mesh.positions[v], lobes[v].direction);
      squared += std::pow(lobes[v].thickness - chord, 2) / double(lobes.size());
      mean += chord / double(lobes.size());
    }
    const double rms = std::sqrt(squared) / mean;
    std::printf("figures: | ball of %.0f voxels, %s | %.3f voxels | %.2f, %.2f (%+.2f %%) | %.2f %% |\n", cut.radius / h, cut.name, off,
                volume, exact, 100 * (volume / exact - 1), 100 * rms);
    EXPECT_LT(off, 0.1);
    EXPECT_NEAR(volume, exact, 0.02 * exact);
    EXPECT_LT(rms, 0.03);
  }
}

}  // namespace
}  // namespace cloudbake
