// Volumes written by OpenVDB itself come back with their shape and place; damaged ones come back as errors.
#include "io/volume/vdb.h"

#include <openvdb/tools/LevelSetUtil.h>

#include <cmath>
#include <random>

#include "tests/io/volume/vdb_helpers.h"

using namespace cloudbake;

namespace {

namespace vdb = openvdb;

vdb::FloatGrid::Ptr fogBall(double radius, double voxel_size) {
  auto grid = ballGrid(radius, {1, 2, 3}, voxel_size);
  vdb::tools::sdfToFogVolume(*grid);
  grid->setName("density");
  return grid;
}

std::string bytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Farthest that a vertex lies off the ball, voxels.
double worstOffset(const LevelSet& level_set, double radius, Vec3 center) {
  double worst = 0;
  for (const Vec3& p : surfaceOf(level_set).positions)
    worst = std::fmax(worst, std::fabs(length(p - center) - radius) / level_set.frame.voxel_size);
  return worst;
}

double valueAt(const LevelSet& level_set, Vec3 world) {
  const Vec3 i = level_set.frame.toIndex(world);
  return level_set.grid->vdb->tree().getValue({int(std::lround(i.x)), int(std::lround(i.y)), int(std::lround(i.z))});
}

double ballVolume(double radius) { return 4.0 / 3 * kPi * radius * radius * radius; }

// The distance of every voxel of a band of three, and its sign everywhere. Beyond 1.5 voxels openvdb::tools::meshToVolume misses the
// nearest polygon of some voxels (0.4 % of a ball's, by up to 0.8 voxels, whatever its flags): a share of those may be off by more.
void expectBall(const LevelSet& level_set, double radius, Vec3 center, double tolerance, double share_off = 0) {
  EXPECT_FLOAT_EQ(level_set.grid->vdb->background(), kBandHalfWidth_voxels);
  EXPECT_EQ(level_set.grid->vdb->getGridClass(), vdb::GRID_LEVEL_SET);
  EXPECT_EQ(level_set.grid->vdb->transform().voxelSize().x(), 1);
  size_t count = 0, off = 0;
  for (auto value = level_set.grid->vdb->cbeginValueOn(); value; ++value, ++count) {
    const vdb::Coord ijk = value.getCoord();
    const Vec3 world = level_set.frame.toWorld({float(ijk.x()), float(ijk.y()), float(ijk.z())});
    const double phi = (length(world - center) - radius) / level_set.frame.voxel_size;
    if (std::fabs(phi) > 1.5 && share_off > 0)
      off += std::fabs(*value - phi) > 1.5 * tolerance;
    else
      ASSERT_NEAR(*value, phi, tolerance);
    ASSERT_LT(std::fabs(*value), kBandHalfWidth_voxels);
  }
  EXPECT_LE(double(off), share_off * double(count));
  const double in_voxels = radius / level_set.frame.voxel_size;
  EXPECT_NEAR(double(count), 6 * 4 * kPi * in_voxels * in_voxels, 0.1 * double(count));
  EXPECT_EQ(valueAt(level_set, center), -kBandHalfWidth_voxels);
  EXPECT_EQ(valueAt(level_set, center + Vec3{float(2 * radius), 0, 0}), kBandHalfWidth_voxels);
  EXPECT_NEAR(insideVolume(level_set), ballVolume(radius), 0.02 * ballVolume(radius));
}

TEST(VdbTest, LevelSetsOfAnyVoxelSizeAndPlace) {
  for (const double h : {1e-3, 0.1, 0.25, 1.0, 30.0})
    for (const Vec3 place : {Vec3{}, Vec3{1.25F, -7.5F, 300}, Vec3{-1e4F, 0, 5e3F}}) {
      const TestFolder folder;
      const double radius = 20 * h;
      const Vec3 center = float(h) * place;
      const auto file = writeVdb(folder, {ballGrid(radius, center, h)});
      const VdbVolume volume = readVdb(file);
      EXPECT_EQ(volume.grid, "ball");
      EXPECT_FALSE(volume.iso);
      EXPECT_NEAR(volume.level_set.frame.voxel_size, h, 1e-6 * h);
      EXPECT_TRUE(warningsOfVdb(file).empty());
      const double float_step_voxels = 1e-3 + 2e-7 * length(place);
      expectBall(volume.level_set, radius, center, 2 * float_step_voxels);
      const vdb::CoordBBox box = volume.level_set.grid->vdb->evalActiveVoxelBoundingBox();
      EXPECT_LE(std::abs(box.min().x() + box.max().x()), 9) << "the middle of the shape is near index 0";
    }
}

// φ is exact, its trilinear interpolation off by up to 1/8 of its second derivatives, 2/R: 1/(4 R) voxels. The frame adds nothing.
TEST(VdbTest, TheSurfaceIsInPlace) {
  const TestFolder folder;
  const Vec3 center{50, -20, 7};
  const auto file = writeVdb(folder, {ballGrid(40, center, 0.5)});
  EXPECT_LT(worstOffset(readVdb(file).level_set, 40, center), 0.25 / 80 + 1e-3);

  // A translation of the transform that is no whole number of voxels.
  auto grid = ballGrid(10, {}, 0.5);
  grid->transform().postTranslate({0.123, 4.567, -8.9});
  EXPECT_LT(worstOffset(readVdb(writeVdb(folder, {grid})).level_set, 10, {0.123F, 4.567F, -8.9F}), 0.25 / 20 + 1e-3);
}

TEST(VdbTest, AnotherAxisIsUp) {
  const TestFolder folder;
  const auto turnedBall = [&](const vdb::FloatGrid::Ptr& grid, UpAxis up) {
    const auto file = writeVdb(folder, {grid});
    VdbSettings settings;
    settings.up_axis = up;
    Warnings warnings;
    return decodeVdb(file, bytesOf(file), settings, warnings).level_set;
  };
  expectBall(turnedBall(ballGrid(10, {1, 2, 3}, 0.5), UpAxis::kZ), 10, {1, 3, -2}, 1e-4);
  expectBall(turnedBall(ballGrid(10, {1, 2, 3}, 0.5), UpAxis::kX), 10, {-2, 1, 3}, 1e-4);
  expectBall(turnedBall(ballGrid(40, {1, 2, 3}, 0.5), UpAxis::kZ), 40, {1, 3, -2}, 1e-4);
  EXPECT_LT(worstOffset(turnedBall(fogBall(10, 0.4), UpAxis::kZ), 10, {1, 3, -2}), 0.6);
}

TEST(VdbTest, HalvesAndDoubles) {
  const TestFolder folder;
  auto halves = ballGrid(10, {1, 2, 3}, 0.5);
  halves->setSaveFloatAsHalf(true);
  expectBall(readVdb(writeVdb(folder, {halves})).level_set, 10, {1, 2, 3}, 3e-3);

  const auto floats = ballGrid(10, {1, 2, 3}, 0.5);
  auto doubles = vdb::DoubleGrid::create(std::make_shared<vdb::DoubleTree>(floats->tree()));
  doubles->insertMeta(*floats);
  doubles->setTransform(floats->transformPtr());
  const auto file = writeVdb(folder, {doubles});
  EXPECT_EQ(readVdb(file).grid, "ball");
  expectBall(readVdb(file).level_set, 10, {1, 2, 3}, 1e-4);
}

TEST(VdbTest, AWideBandIsCutAndANarrowOneWidened) {
  const TestFolder folder;
  const auto wide = writeVdb(folder, {ballGrid(10, {1, 2, 3}, 0.5, 8)});
  expectBall(readVdb(wide).level_set, 10, {1, 2, 3}, 1e-4);
  EXPECT_TRUE(warningsOfVdb(wide).empty());

  for (const double band : {1.01, 1.5, 2.5}) {
    const auto narrow = writeVdb(folder, {ballGrid(10, {1, 2, 3}, 0.5, band)});
    const LevelSet level_set = readVdb(narrow).level_set;
    expectBall(level_set, 10, {1, 2, 3}, 0.1, 0.01);
    EXPECT_LT(worstOffset(level_set, 10, {1, 2, 3}), 0.25 / 20 + 1e-3) << "what the file knew is kept";
    EXPECT_EQ(warningsOfVdb(narrow).entries().at(WarningKind::kVolumeRebuilt).count, 1);
  }
}

// The interior as active voxels with distances all the way, as some tools write it.
TEST(VdbTest, DenseInteriors) {
  const TestFolder folder;
  const auto grid = ballGrid(10, {1, 2, 3}, 0.5, 25);
  const auto file = writeVdb(folder, {grid});
  expectBall(readVdb(file).level_set, 10, {1, 2, 3}, 1e-4);

  const auto tiled = ballGrid(40, {1, 2, 3}, 0.5);
  for (auto tile = tiled->beginValueOff(); tile; ++tile)
    if (*tile < 0) tile.setActiveState(true);
  expectBall(readVdb(writeVdb(folder, {tiled})).level_set, 40, {1, 2, 3}, 1e-4);
}

TEST(VdbTest, FogKeepsItsVolume) {
  const TestFolder folder;
  for (const double voxels : {12.0, 25.0, 60.0}) {
    const auto file = writeVdb(folder, {fogBall(10, 10 / voxels)});
    const VdbVolume volume = readVdb(file);
    EXPECT_TRUE(volume.iso);
    EXPECT_EQ(volume.grid, "density");
    EXPECT_NEAR(insideVolume(volume.level_set), ballVolume(10), 0.03 * ballVolume(10));
    EXPECT_LT(worstOffset(volume.level_set, 10, {1, 2, 3}), 0.9);
    EXPECT_EQ(valueAt(volume.level_set, {1, 2, 3}), -kBandHalfWidth_voxels);
    EXPECT_EQ(warningsOfVdb(file).entries().at(WarningKind::kVolumeRebuilt).count, 1);
  }
  // At half of the inside value the surface lies 1.5 voxels deeper; who gives a value is not warned.
  const auto file = writeVdb(folder, {fogBall(10, 0.4)});
  EXPECT_TRUE(warningsOfVdb(file, {{}, 0.5}).empty());
  const LevelSet half = readVdb(file, {{}, 0.5}).level_set;
  expectBall(half, 10 - 1.5 * 0.4, {1, 2, 3}, 0.1, 0.01);
  EXPECT_LT(worstOffset(half, 10 - 1.5 * 0.4, {1, 2, 3}), 0.06);
  EXPECT_LT(insideVolume(readVdb(file, {{}, 0.9}).level_set), insideVolume(readVdb(file, {{}, 0.1}).level_set));
  // A density of another unit.
  auto dense = fogBall(10, 0.4);
  for (auto value = dense->beginValueAll(); value; ++value) value.setValue(1000 * *value);
  EXPECT_NEAR(insideVolume(readVdb(writeVdb(folder, {dense})).level_set), ballVolume(10), 0.03 * ballVolume(10));
  expectError<InputError>(
      [&] {
        readVdb(writeVdb(folder, {fogBall(10, 0.4)}), {{}, 7.0});
      },
      "'density' has no surface at 7, because its values are from");
}

// A shell, and the same with a band that must be widened: what is hollow stays hollow.
TEST(VdbTest, CavitiesStay) {
  const TestFolder folder;
  for (const double band : {3.0, 1.5}) {
    auto shell = ballGrid(10, {}, 0.25, band);
    const auto hole = ballGrid(6, {}, 0.25, band);
    const auto inner = hole->getConstAccessor();
    for (auto leaf = hole->tree().cbeginLeaf(); leaf; ++leaf) shell->tree().touchLeaf(leaf->origin());
    for (auto value = shell->beginValueAll(); value; ++value) {
      const float other = -inner.getValue(value.getCoord());
      if (other > *value) value.setValue(other);
      value.setActiveState(std::fabs(*value) < band * 0.25);
    }
    const LevelSet level_set = readVdb(writeVdb(folder, {shell})).level_set;
    const double expected = ballVolume(10) - ballVolume(6);
    EXPECT_NEAR(insideVolume(level_set), expected, 0.02 * expected);
    EXPECT_EQ(valueAt(level_set, {}), kBandHalfWidth_voxels);
    EXPECT_EQ(valueAt(level_set, {8, 0, 0}), -kBandHalfWidth_voxels);
  }
}

// An empty grid of another type of value, made by its name: to compile these types here takes as long as the rest of the file.
vdb::GridBase::Ptr gridOf(const std::string& value_type) { return vdb::GridBase::createGrid("Tree_" + value_type + "_5_4_3"); }

TEST(VdbTest, GridsByName) {
  const TestFolder folder;
  auto first = ballGrid(1, {}, 0.1), second = ballGrid(2, {}, 0.1), surface = ballGrid(3, {}, 0.1);
  first->setName("first"), second->setName("density"), surface->setName("surface");
  const auto vectors = gridOf("vec3s");
  vectors->setName("v");
  const auto points = gridOf("ptdataidx32");
  points->setName("particles");
  const auto ids = gridOf("int32");
  ids->setName("ids");

  auto file = writeVdb(folder, {vectors, first, second, surface, points, ids});
  EXPECT_EQ(readVdb(file).grid, "surface");
  EXPECT_NE(warningsOfVdb(file).entries().at(WarningKind::kGridChosen).first.find("'v', 'first', 'density', 'surface', 'particles', 'ids'"),
            std::string::npos);
  EXPECT_EQ(readVdb(file, {"first", {}}).grid, "first");
  EXPECT_TRUE(warningsOfVdb(file, {"first", {}}).empty());
  EXPECT_NEAR(insideVolume(readVdb(file, {"density", {}}).level_set), ballVolume(2), 0.02 * ballVolume(2));
  expectError<InputError>([&] { readVdb(file, {"smoke", {}}); }, "no grid is named 'smoke': there are 'v', 'first'");
  expectError<InputError>([&] { readVdb(file, {"v", {}}); }, "'v' holds vectors");
  expectError<InputError>([&] { readVdb(file, {"particles", {}}); }, "'particles' holds points");
  expectError<InputError>([&] { readVdb(file, {"ids", {}}); }, "'ids' holds whole numbers");
  EXPECT_EQ(readVdb(writeVdb(folder, {first, second})).grid, "density");
  EXPECT_EQ(readVdb(writeVdb(folder, {vectors, first})).grid, "first");
  EXPECT_EQ(readVdb(writeVdb(folder, {vectors, first, ballGrid(2, {}, 0.1)})).grid, "first");
  EXPECT_TRUE(warningsOfVdb(writeVdb(folder, {vectors, first})).empty());
  expectError<InputError>([&] { readVdb(writeVdb(folder, {points})); }, "'particles' holds points");
  expectError<InputError>([&] { readVdb(writeVdb(folder, {})); }, "no grid");
  // A stream does not say where its grids lie.
  file = folder.write("b.vdb", streamedVdb({vectors, first, second}));
  EXPECT_NEAR(insideVolume(readVdb(file, {"first", {}}).level_set), ballVolume(1), 0.02 * ballVolume(1));
  EXPECT_EQ(readVdb(file).grid, "density");
  // Two grids that share one tree.
  auto shared = vdb::FloatGrid::create(*second);
  shared->setTree(second->baseTreePtr());
  shared->setName("twin");
  for (const auto& twins : {writeVdb(folder, {second, shared}), folder.write("b.vdb", streamedVdb({second, shared}))})
    EXPECT_NEAR(insideVolume(readVdb(twins, {"twin", {}}).level_set), ballVolume(2), 0.02 * ballVolume(2));
}

// OpenVDB numbers the grids of one name. Its tools print these names, and --grid takes them.
TEST(VdbTest, GridsOfOneName) {
  const TestFolder folder;
  auto first = ballGrid(1, {}, 0.1), second = ballGrid(2, {}, 0.1), other = ballGrid(3, {}, 0.1);
  first->setName("density"), second->setName("density"), other->setName("heat");
  for (const auto& file : {writeVdb(folder, {other, first, second}), folder.write("b.vdb", streamedVdb({other, first, second}))}) {
    const auto volumeOf = [&](const char* name) { return insideVolume(readVdb(file, {name, {}}).level_set); };
    EXPECT_NEAR(volumeOf("density[0]"), ballVolume(1), 0.02 * ballVolume(1));
    EXPECT_NEAR(volumeOf("density[1]"), ballVolume(2), 0.02 * ballVolume(2));
    EXPECT_NEAR(volumeOf("heat"), ballVolume(3), 0.02 * ballVolume(3));
    EXPECT_NEAR(volumeOf("density"), ballVolume(1), 0.02 * ballVolume(1));
    EXPECT_EQ(readVdb(file, {"density[1]", {}}).grid, "density[1]");
    EXPECT_TRUE(warningsOfVdb(file, {"density[1]", {}}).empty());
    EXPECT_TRUE(warningsOfVdb(file, {"heat", {}}).empty());
    const std::string listed = "'heat', 'density[0]', 'density[1]'";
    for (const VdbSettings& settings : {VdbSettings{}, VdbSettings{"density", {}}}) {
      const std::string text = warningsOfVdb(file, settings).entries().at(WarningKind::kGridChosen).first;
      EXPECT_NE(text.find("grid 'density[0]' was chosen from " + listed), std::string::npos) << text;
    }
    expectError<InputError>([&] { readVdb(file, {"density[2]", {}}); }, "no grid is named 'density[2]': there are " + listed);
  }
  // A vector of the same name is passed over.
  const auto motion = gridOf("vec3s");
  motion->setName("density");
  const auto file = writeVdb(folder, {motion, second});
  EXPECT_NEAR(insideVolume(readVdb(file, {"density", {}}).level_set), ballVolume(2), 0.02 * ballVolume(2));
  expectError<InputError>([&] { readVdb(file, {"density[0]", {}}); }, "'density[0]' holds vectors");
}

TEST(VdbTest, WhatIsRefused) {
  const TestFolder folder;
  const auto refuse = [&](const vdb::GridBase::Ptr& grid, const std::string& text, const VdbSettings& settings = {}) {
    expectError<InputError>([&] { readVdb(writeVdb(folder, {grid}), settings); }, text);
  };
  const auto changed = [](const auto& change) {
    auto grid = ballGrid(3, {}, 0.1);
    change(*grid);
    return grid;
  };
  refuse(changed([](auto& g) { g.setGridClass(vdb::GRID_UNKNOWN); }), "grid 'ball' is of class 'unknown'");
  refuse(changed([](auto& g) { g.setGridClass(vdb::GRID_STAGGERED); }), "grid 'ball' is of class 'staggered'");
  refuse(changed([](auto& g) { g.clear(); }), "'ball' is empty");
  refuse(changed([](auto& g) { g.transform().preRotate(0.3); }), "'ball' is rotated");
  for (const double shear : {0.3, -0.3}) {
    refuse(changed([&](auto& g) { g.transform().preShear(shear, vdb::math::X_AXIS, vdb::math::Y_AXIS); }), "'ball' is sheared");
    refuse(changed([&](auto& g) { g.transform().preShear(shear, vdb::math::Z_AXIS, vdb::math::X_AXIS); }), "'ball' is sheared");
  }
  refuse(changed([](auto& g) { g.transform().preScale({1, 2, 1}); }), "'ball' has voxels of 0.1 × 0.2 × 0.1");
  refuse(changed([](auto& g) { g.transform().preScale({1, 0.5, 1}); }), "'ball' has voxels of 0.1 × 0.05 × 0.1");
  refuse(changed([](auto& g) { g.transform().preScale({1, 1, 0.5}); }), "'ball' has voxels of 0.1 × 0.1 × 0.05");
  refuse(changed([](auto& g) { g.transform().preScale({-1, 1, 1}); }), "'ball' is mirrored");
  refuse(changed([](auto& g) {
           const vdb::BBoxd box({0, 0, 0}, {10, 10, 10});
           g.setTransform(vdb::math::Transform::createFrustumTransform(box, 0.5, 10, 1));
         }),
         "'ball' lies in a frustum");
  refuse(changed([](auto& g) { g.tree().setValue({3, 0, 0}, NAN); }), "'ball' has values that are not finite");
  refuse(changed([](auto& g) {
           g.setGridClass(vdb::GRID_FOG_VOLUME);
           g.tree().root().setBackground(INFINITY, true);
         }),
         "'ball' has values that are not finite");
  refuse(changed([](auto& g) {
           for (auto value = g.beginValueAll(); value; ++value) value.setValue(std::fabs(*value) + 0.01F);
         }),
         "'ball' has no surface");
  refuse(changed([](auto& g) { g.tree().setValue({9000, 0, 0}, 0.1F); }), "more than the limit of 8000");
  refuse(changed([](auto& g) {
           g.tree().setValue({2000000000, 0, 0}, 0.1F), g.tree().setValue({-2000000000, 0, 0}, 0.1F);
         }),
         "more than the limit");
  for (const int far : {2000000000, -2000000000})
    refuse(changed([&](auto& g) {
             g.tree().clear();
             g.tree().setValue({0, far, 0}, 0.1F), g.tree().setValue({0, far + 1, 0}, -0.1F);
           }),
           "'ball' lies too far from its origin");
  refuse(changed([](auto&) {}), "grid 'ball' with 345 blocks of 8×8×8 voxels would take about 5 MiB of memory", {{}, {}, 1 << 20});
  // Active tiles stand for their voxels: 4096³ of them.
  refuse(changed([](auto& g) {
           g.setGridClass(vdb::GRID_FOG_VOLUME);
           g.tree().addTile(3, {0, 0, 0}, 1, true);
         }),
         "GiB");
  const auto file = writeVdb(folder, {ballGrid(3, {}, 0.1)});
  expectError<InputError>([&] { readVdb(file, {{}, {}, 100}); }, "bytes would take about");
  expectError<UsageError>([&] { readVdb(file, {{}, 0.5}); }, "--iso is for fog volumes: grid 'ball'");
  expectError<IoError>([&] { readVdb(folder.path / "no.vdb"); }, "no.vdb");
  expectError<InputError>([&] { readVdb(folder.write("b.vdb", "")); }, "damaged or truncated");
  expectError<InputError>([&] { readVdb(folder.write("b.vdb", "nonsense")); }, "damaged or truncated");
}

LevelSet grown(float scale = 1) {
  Warnings warnings;
  const std::vector<Sphere> spheres{{{0, 0, 0}, scale}, {{0.8F * scale, 0.3F * scale, 0}, 0.6F * scale}};
  return levelSetFromSpheres(spheres, {.voxels = 40, .voxel_size = {}, .blend = 0.1F * scale, .flat_base = {}, .noise = {}}, warnings);
}

TEST(VdbTest, RoundTrip) {
  const TestFolder folder;
  for (const float scale : {1.0F, 1e-2F, 1e4F}) {
    const LevelSet before = grown(scale);
    const auto file = folder.write("a.vdb", encodeVdb(before));
    EXPECT_TRUE(warningsOfVdb(file).empty());
    const VdbVolume volume = readVdb(file);
    EXPECT_EQ(volume.grid, "surface");
    const LevelSet& after = volume.level_set;
    EXPECT_NEAR(after.frame.voxel_size, before.frame.voxel_size, 1e-12 * before.frame.voxel_size);
    vdb::Coord shift;
    for (size_t a = 0; a < 3; ++a)
      shift[int(a)] = int(std::lround((after.frame.origin[a] - before.frame.origin[a]) / after.frame.voxel_size));
    EXPECT_EQ(before.grid->vdb->activeVoxelCount(), after.grid->vdb->activeVoxelCount());
    for (auto value = before.grid->vdb->cbeginValueAll(); value; ++value) {
      const vdb::Coord there = value.getCoord() - shift;
      ASSERT_NEAR(*value, after.grid->vdb->tree().getValue(there), 1e-6);
      ASSERT_EQ(value.isValueOn(), after.grid->vdb->tree().isValueOn(there));
    }
  }
}

TEST(VdbTest, OtherToolsFindTheSurface) {
  const TestFolder folder;
  const LevelSet level_set = grown();
  vdb::io::File file(folder.write("a.vdb", encodeVdb(level_set)).string());
  file.open();
  const auto grid = vdb::gridPtrCast<vdb::FloatGrid>(file.readGrid("surface"));
  EXPECT_EQ(grid->getGridClass(), vdb::GRID_LEVEL_SET);
  const double h = level_set.frame.voxel_size;
  EXPECT_NEAR(grid->voxelSize().y(), h, 1e-12);
  EXPECT_NEAR(grid->background(), 3 * h, 1e-6);
  // World distance to the first ball, on the side that faces away from the second.
  const vdb::Coord at = grid->transform().worldToIndexCellCentered({-1, 0, 0});
  const vdb::Vec3d world = grid->indexToWorld(at);
  EXPECT_NEAR(grid->tree().getValue(at), world.length() - 1, 0.15 * h);
}

TEST(VdbTest, TheSameBytesEveryTime) {
  const std::string bytes = encodeVdb(grown());
  EXPECT_EQ(bytes, encodeVdb(grown()));
  EXPECT_NE(bytes, encodeVdb(grown(2)));
  EXPECT_NE(bytes.substr(21, 36), encodeVdb(grown(2)).substr(21, 36)) << "each content has an identity of its own";
  expectError<InputError>([] { encodeVdb(grown(1e-4F)); }, "too small for a VDB");
}

// Anything but a result or an error of ours ends the test program.
void expectErrorOrVolume(const std::filesystem::path& file) {
  try {
    readVdb(file);
  } catch (const InputError&) {
  } catch (const IoError&) {
  }
}

TEST(VdbTest, TruncatedFiles) {
  const TestFolder folder;
  const std::string file = bytesOf(writeVdb(folder, {ballGrid(3, {}, 0.3), fogBall(3, 0.5)})), stream = streamedVdb({ballGrid(3, {}, 0.3)});
  for (const std::string& bytes : {file, stream}) {
    for (size_t length = 0; length < bytes.size(); length += length < 2000 ? 1 : 97)
      expectError<InputError>([&] { readVdb(folder.write("b.vdb", bytes.substr(0, length)), {"ball", {}}); }, "damaged or truncated");
  }
}

// OpenVDB reads such a scale, and throws where it is asked for the matrix.
TEST(VdbTest, TransformsNearlySingular) {
  const TestFolder folder;
  const std::string map = "UniformScaleMap";
  const double scale[] = {1e-6, 1e-6, 1e-6};
  std::string bytes = streamedVdb({ballGrid(3, {}, 0.1)});
  const size_t at = bytes.find(map) + map.size();
  bytes.replace(at, sizeof scale, reinterpret_cast<const char*>(scale), sizeof scale);
  expectError<InputError>([&] { readVdb(folder.write("a.vdb", bytes)); }, "'ball' has a transform that is singular, or voxels too small");
}

// A number as long as the next text would have it: name, type, length, value.
TEST(VdbTest, LengthsOfMetadata) {
  const TestFolder folder;
  auto grid = ballGrid(3, {}, 0.3);
  grid->insertMeta("answer", vdb::Int32Metadata(42));
  std::string bytes = streamedVdb({grid});
  const size_t at = bytes.find("answer") + 6 + 4 + 5;  // behind the length and the letters of "int32"
  ASSERT_EQ(bytes.at(at), 4);
  EXPECT_NO_THROW(readVdb(folder.write("a.vdb", bytes)));
  bytes[at] = 0;
  expectError<InputError>([&] { readVdb(folder.write("a.vdb", bytes)); }, "metadata of type int32 with 0 bytes");
}

// The root's only tile: three coordinates, a value, and a flag of one byte, which is 1.
TEST(VdbTest, TileFlags) {
  const TestFolder folder;
  const float value = 0.123F;
  auto tile = vdb::FloatGrid::create(0);
  tile->setGridClass(vdb::GRID_FOG_VOLUME);
  tile->tree().addTile(vdb::FloatTree::DEPTH - 1, {0, 0, 0}, value, true);
  std::string bytes = streamedVdb({tile});
  const size_t at = bytes.rfind(std::string(reinterpret_cast<const char*>(&value), sizeof value)) + sizeof value;
  ASSERT_EQ(bytes.at(at), 1);
  expectError<InputError>([&] { readVdb(folder.write("a.vdb", bytes)); }, "would take about");
  bytes[at] = 'o';
  expectError<InputError>([&] { readVdb(folder.write("a.vdb", bytes)); }, "a tile is neither active nor inactive");
}

TEST(VdbTest, FlippedBytes) {
  const TestFolder folder;
  const std::string file = bytesOf(writeVdb(folder, {ballGrid(3, {}, 0.3)})), stream = streamedVdb({fogBall(3, 0.5)});
  std::mt19937 random(1);
  for (int variant = 0; variant < 300; ++variant) {
    std::string bytes = variant % 2 ? file : stream;
    for (int flips = 1 + variant % 3; flips > 0; --flips) {
      const size_t range = variant % 4 < 2 ? 1200 : bytes.size();  // half of them in the header
      bytes[random() % range] ^= char(1 << random() % 8);
    }
    expectErrorOrVolume(folder.write("b.vdb", bytes));
  }
}

}  // namespace
