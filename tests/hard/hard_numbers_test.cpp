// Numbers that float32 holds badly, through the whole pipeline. docs/numerics.md lists every hard case.
#include <gtest/gtest.h>

#include <cfloat>
#include <numeric>
#include <random>

#include "bake/truth/error_metrics.h"
#include "bake/truth/reference.h"
#include "core/lobe_lighting.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/write.h"
#include "tests/bake/both_bakes.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

std::vector<Vec3> randomDirections(size_t count) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::vector<Vec3> directions;
  while (directions.size() < count)
    if (const auto unit = normalized({normal(random), normal(random), normal(random)})) directions.push_back(*unit);
  return directions;
}

// Coordinates in steps of 2⁻¹², so that moving and scaling the torus can be exact.
SurfaceMesh roundedTorus() {
  SurfaceMesh torus = torusMesh(1, 0.4F, 48, 24);
  for (Vec3& p : torus.positions) p = {std::round(p.x * 4096) / 4096, std::round(p.y * 4096) / 4096, std::round(p.z * 4096) / 4096};
  return torus;
}

SurfaceMesh moved(SurfaceMesh mesh, float scale, Vec3 shift) {
  for (Vec3& p : mesh.positions) p = p * scale + shift;
  return mesh;
}

void expectBall(std::span<const Lobe> lobes, const SurfaceMesh& ball, float radius, const char* method) {
  std::vector<Lobe> truth;
  for (const Vec3& n : ball.normals) truth.push_back({-n, 2 * radius});
  EXPECT_LT(anglesBetween(lobes, truth).median, 1) << method;
  for (const Lobe& lobe : lobes) ASSERT_NEAR(lobe.thickness / (2 * radius), 1, 0.04) << method;
}

std::vector<Lobe> throughGlb(const SurfaceMesh& mesh, const std::vector<Lobe>& lobes) {
  const Sculpt sculpt{{SculptPart{"part", mesh.positions, mesh.normals, {}, mesh.triangles, {}}}, nullptr};
  Warnings warnings;
  return decodeGlb("a.glb", encodeGlb(sculpt, std::vector<std::vector<Lobe>>{lobes}, {}, {}, warnings), warnings).lobes;
}

}  // namespace

// The cosine of a rounded unit vector with itself passes 1, where acos is not a number: angles come from atan2.
TEST(HardNumbers, CosinesBeyondOne) {
  size_t beyond = 0;
  std::vector<Lobe> lobes;
  for (const Vec3& d : randomDirections(10000)) {
    beyond += dot(d, d) > 1;
    ASSERT_EQ(angleDegrees(d, d), 0);
    ASSERT_NEAR(angleDegrees(d, -1.0000004F * d), 180, 1e-5);
    lobes.push_back({d, 1});
  }
  EXPECT_GT(beyond, 100U);
  const LobeError error = compareLobes(lobes, {lobes, std::vector<double>(lobes.size(), 1)});
  EXPECT_EQ(error.angle_rms_degrees, 0);
  EXPECT_EQ(error.angle_max_degrees, 0);
}

// l·o/2 + 1/2 falls under 0 by rounding at l = −o, and pow of a negative base with a broken exponent is not a number: there the bulk counts
// nothing, and T is that of the bias alone.
TEST(HardNumbers, PowerOfASlightlyNegativeBase) {
  size_t negative = 0;
  for (const Vec3& o : randomDirections(10000)) {
    negative += dot(-o, o) * 0.5F + 0.5F < 0;
    for (const float exponent : {0.5F, 2.5F, 3.0F}) {
      ASSERT_EQ(lobeTransmittance({o, 4}, -o, {exponent, -0.01F}, 3), 1);
      ASSERT_NEAR(lobeTransmittance({o, 4}, -o, {exponent, 0.1F}, 3), std::exp(-0.3), exponent == 0.5F ? 0.01 : 1e-6);
    }
  }
  EXPECT_GT(negative, 100U);
}

// Products and squares of coordinates leave float's range at either end of it; a bake works in a frame of the shape, where they are near 1.
TEST(HardNumbers, BallsAtTheEndsOfFloat) {
  for (const float radius : {1e-40F, 1e-37F, 1e-6F, 1e6F, 1e37F}) {
    SCOPED_TRACE(radius);
    const SurfaceMesh ball = ballMesh(radius, 4);
    const BothBakes bakes = bakedBothWays(ball, 60);
    expectBall(bakes.sweep, ball, radius, "sweep");
    expectBall(bakes.rays, ball, radius, "rays");
    EXPECT_TRUE(bakes.sweep_warnings.empty());
    EXPECT_TRUE(bakes.rays_warnings.empty());
    const std::vector<Lobe> decoded = throughGlb(ball, bakes.sweep);
    for (size_t v = 0; v < decoded.size(); ++v) {
      ASSERT_LT(angleDegrees(decoded[v].direction, bakes.sweep[v].direction), 1e-3);
      ASSERT_NEAR(decoded[v].thickness / bakes.sweep[v].thickness, 1, 1e-4);
    }
  }
}

// A box whose size is beyond float has no length that could be written: it is refused, not turned into infinite lobes.
TEST(HardNumbers, ShapesBeyondFloatAreRefused) {
  const SurfaceMesh ball = ballMesh(3e38F, 2);
  Warnings warnings;
  EXPECT_EQ(refusalOf([&] { coverageFromClosedMesh(ball, {}, warnings); }),
            "the bounding box is beyond the range of float: scale the shape down");
  EXPECT_EQ(refusalOf([&] { levelSetFromMesh(ball, {}, warnings); }),
            "the bounding box is beyond the range of float: scale the shape down");
}

// Absolute tolerances break at sizes of 1e-6 and 1e6 of anything but a ball, where symmetry hides them: a torus keeps its lobes.
TEST(HardNumbers, SizesDoNotMatter) {
  const SurfaceMesh torus = roundedTorus();
  const BothBakes unit = bakedBothWays(torus, 60);
  for (const float scale : {1e-6F, 1e6F}) {
    const BothBakes other = bakedBothWays(moved(torus, scale, {}), 60);
    EXPECT_LT(anglesBetween(unit.sweep, other.sweep).p95, 0.05) << scale;
    EXPECT_LT(anglesBetween(unit.rays, other.rays).p95, 0.05) << scale;
    for (size_t v = 0; v < torus.positions.size(); ++v) {
      ASSERT_NEAR(other.sweep[v].thickness / scale, unit.sweep[v].thickness, 0.01);
      ASSERT_NEAR(other.rays[v].thickness / scale, unit.rays[v].thickness, 0.01);
    }
  }
}

// A scale by a power of two or a shift that float holds changes no bit of a coordinate in the frame, so it may change no bit of a lobe.
TEST(HardNumbers, ExactScalesAndShiftsKeepEveryBit) {
  const SurfaceMesh torus = roundedTorus();
  const BothBakes unit = bakedBothWays(torus, 50);
  const std::pair<float, Vec3> maps[] = {{0x1p20F, {}}, {0x1p-20F, {}}, {1, {1000, -500, 250}}, {2, {-1024, 0, 64}}};
  for (const auto& [scale, shift] : maps) {
    const BothBakes other = bakedBothWays(moved(torus, scale, shift), 50);
    for (size_t v = 0; v < torus.positions.size(); ++v) {
      ASSERT_EQ(unit.sweep[v].direction, other.sweep[v].direction) << scale;
      ASSERT_EQ(unit.sweep[v].thickness * scale, other.sweep[v].thickness) << scale;
      ASSERT_EQ(unit.rays[v].direction, other.rays[v].direction) << scale;
      ASSERT_EQ(unit.rays[v].thickness * scale, other.rays[v].thickness) << scale;
    }
  }
}

// Vertices and triangles come in any order, and sums of floats depend on theirs: a shuffled mesh gives the same bits, field included.
TEST(HardNumbers, OrderOfVerticesAndTriangles) {
  const SurfaceMesh torus = roundedTorus();
  std::vector<uint32_t> place(torus.positions.size());
  std::iota(place.begin(), place.end(), 0U);
  std::mt19937 random(3);
  std::shuffle(place.begin(), place.end(), random);
  SurfaceMesh shuffled = torus;
  for (size_t v = 0; v < place.size(); ++v) {
    shuffled.positions[place[v]] = torus.positions[v];
    shuffled.normals[place[v]] = torus.normals[v];
  }
  for (Triangle& t : shuffled.triangles) t = {place[t[1]], place[t[2]], place[t[0]]};
  std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
  Warnings warnings;
  EXPECT_EQ(denseFromLevelSet(levelSetFromMesh(torus, latticeOf(50), warnings)).values,
            denseFromLevelSet(levelSetFromMesh(shuffled, latticeOf(50), warnings)).values);
  const BothBakes straight = bakedBothWays(torus, 50), other = bakedBothWays(shuffled, 50);
  for (size_t v = 0; v < place.size(); ++v) {
    ASSERT_EQ(bitsOf(straight.sweep[v]), bitsOf(other.sweep[place[v]])) << v;
    ASSERT_EQ(bitsOf(straight.rays[v]), bitsOf(other.rays[place[v]])) << v;
  }
}

// The lattice and the directions stand still while a shape turns: a turned torus has turned lobes, up to the spacing of both.
TEST(HardNumbers, RotationTurnsTheLobes) {
  const SurfaceMesh torus = roundedTorus();
  const auto turned = [](Vec3 p) {  // by (0.8, 0.6) about z, then x
    const Vec3 q{0.8F * p.x - 0.6F * p.y, 0.6F * p.x + 0.8F * p.y, p.z};
    return Vec3{q.x, 0.8F * q.y - 0.6F * q.z, 0.6F * q.y + 0.8F * q.z};
  };
  SurfaceMesh other = torus;
  for (Vec3& p : other.positions) p = turned(p);
  for (Vec3& n : other.normals) n = turned(n);
  BothBakes straight = bakedBothWays(torus, 100, 1000);
  const BothBakes bakes = bakedBothWays(other, 100, 1000);
  for (auto* lobes : {&straight.sweep, &straight.rays})
    for (Lobe& lobe : *lobes) lobe.direction = turned(lobe.direction);
  const AngleFigures sweep = anglesBetween(straight.sweep, bakes.sweep), rays = anglesBetween(straight.rays, bakes.rays);
  std::printf("[figures] turned torus, 1000 directions: sweep median %.3f deg, p95 %.3f deg; rays median %.3f deg, p95 %.3f deg\n",
              sweep.median, sweep.p95, rays.median, rays.p95);
  EXPECT_LT(sweep.median, 1);
  EXPECT_LT(sweep.p95, 2.5);
  EXPECT_LT(rays.median, 1);
  EXPECT_LT(rays.p95, 2.5);
}

// A million sizes from the origin float32 steps are 6 % of the size: said, and the lobes are those of the mesh that is left of it.
TEST(HardNumbers, AMillionSizesAway) {
  const SurfaceMesh ball = ballMesh(1, 3, {1e6F, 0, 0});
  const BothBakes bakes = bakedBothWays(ball, 60);
  EXPECT_EQ(countOf(bakes.sweep_warnings, WarningKind::kCoarseCoordinates), 1U);
  EXPECT_EQ(countOf(bakes.rays_warnings, WarningKind::kCoarseCoordinates), 1U);
  const SurfaceMesh left = moved(ball, 1, {-1e6F, 0, 0});  // exact: what float kept of the positions
  const BothBakes at_origin = bakedBothWays(left, 60);
  EXPECT_EQ(anglesBetween(bakes.sweep, at_origin.sweep).largest, 0);
  EXPECT_EQ(anglesBetween(bakes.rays, at_origin.rays).largest, 0);
  EXPECT_EQ(countOf(at_origin.sweep_warnings, WarningKind::kCoarseCoordinates), 0U);
}

// One coordinate that is not finite spreads through every sum: the mesh is refused by the vertex, even one that no triangle uses.
TEST(HardNumbers, PositionsThatAreNotFinite) {
  for (const float bad : {NAN, INFINITY, -INFINITY})
    for (const bool is_used : {false, true}) {
      SurfaceMesh ball = ballMesh(1, 1);
      const size_t vertex = is_used ? 7 : ball.positions.size();
      if (!is_used) ball.positions.emplace_back();
      ball.positions[vertex].z = bad;
      Warnings warnings;
      const std::string message = "vertex " + std::to_string(vertex) + " is not finite: repair the mesh";
      EXPECT_EQ(refusalOf([&] { coverageFromClosedMesh(ball, {}, warnings); }), message);
      EXPECT_EQ(refusalOf([&] { levelSetFromMesh(ball, {}, warnings); }), message);
      EXPECT_EQ(refusalOf([&] { levelSetFromOpenMesh(ball, {}, warnings); }), message);
    }
}

// No triangles, or all positions equal: there is no length to measure a voxel by, and a division by it would give NaN.
TEST(HardNumbers, NothingToMeasure) {
  const SurfaceMesh point{std::vector<Vec3>(4, {1, 2, 3}), {}, {{0, 1, 2}, {1, 2, 3}}};
  const SurfaceMesh vertices_only{{{0, 0, 0}, {1, 0, 0}}, {}, {}};
  Warnings warnings;
  for (const auto& [mesh, message] : {std::pair{SurfaceMesh{}, "the mesh has no triangles"},
                                      {vertices_only, "the mesh has no triangles"},
                                      {point, "the shape has no extent: all its points coincide"}}) {
    EXPECT_EQ(refusalOf([&, m = mesh] { coverageFromClosedMesh(m, {}, warnings); }), message);
    EXPECT_EQ(refusalOf([&, m = mesh] { levelSetFromMesh(m, {}, warnings); }), message);
  }
  EXPECT_EQ(refusalOf([&] { levelSetFromSpheres({}, {}, warnings); }), "there are no spheres to make a cloud from");
}

// A voxel count is one digit too many away from taking all memory: estimated first, refused with the number and the limit.
TEST(HardNumbers, MemoryIsEstimatedFirst) {
  const SurfaceMesh ball = ballMesh(1, 2);
  Warnings warnings;
  const std::string message = refusalOf([&] { coverageFromClosedMesh(ball, latticeOf(4000), warnings); });
  double told = 0;
  const size_t about = message.find("about ");
  ASSERT_NE(about, std::string::npos) << message;
  ASSERT_EQ(
      std::sscanf(message.c_str() + about, "about %lf GiB of memory, over the limit of 8.0 GiB (--memory): use fewer --voxels", &told), 1)
      << message;
  EXPECT_GE(told, 0.999 * 16 * std::pow(4006.0, 3) / (1 << 30));  // a field of floats and a copy of it per axis
  EXPECT_LE(told, 1.5 * 16 * std::pow(4006.0, 3) / (1 << 30));
  EXPECT_NE(refusalOf([&] { levelSetFromMesh(ball, latticeOf(7000), warnings); }).find("GiB of memory, over the limit of 8.0 GiB"),
            std::string::npos);
  LevelSetSettings wide = latticeOf(1000000);
  wide.memory_limit = ~0ULL;
  EXPECT_NE(refusalOf([&] {
              coverageFromClosedMesh(ball, wide, warnings);
            }).find("1000000 voxels along the longest side exceed the limit of 8000"),
            std::string::npos);
}

// A needle has few cells, but a sweep across it shears planes of its length squared: they count, for every thread.
TEST(HardNumbers, MemoryOfANeedle) {
  const Box needle{{-0.5F, -500, -0.5F}, {0.5F, 500, 0.5F}};
  EXPECT_GT(estimateCoverageBytes(needle, 0.125), 2 * 4 * 8000.0 * 8000);
  EXPECT_LT(estimateCoverageBytes(needle, 10), 1e7);
}

// A ray through the middle of a face, an edge or a corner may count no triangle, one or several: a cube's chords are 1, √2 and √3 sides.
TEST(HardNumbers, RaysThroughFacesEdgesAndCorners) {
  const SurfaceMesh cube = boxMesh({-1, -1, -1}, {1, 1, 1});
  std::vector<Vec3> directions;
  for (const float z : {-1.0F, 0.0F, 1.0F})
    for (const float y : {-1.0F, 0.0F, 1.0F})
      for (const float x : {-1.0F, 0.0F, 1.0F})
        if (x != 0 || y != 0 || z != 0) directions.push_back(*normalized(Vec3{x, y, z}));
  const auto chord = [](Vec3 d) { return 1 / double(std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)})); };
  const Vec3 centre{};
  const auto reference = meshReference(cube);
  Warnings warnings;
  const DenseField dense = denseFromLevelSet(levelSetFromMesh(cube, latticeOf(60), warnings));
  BakeSettings settings;
  settings.steps = 400;
  settings.ray_length = 4;
  const auto marched = marchedLengths({&centre, 1}, directions, dense, settings);
  const auto swept = sweptLengths({&centre, 1}, directions, coverageFromClosedMesh(cube, latticeOf(60), warnings).value(), 10);
  for (size_t i = 0; i < directions.size(); ++i) {
    EXPECT_NEAR(reference->insideLength({centre, directions[i]}, INFINITY), chord(directions[i]), 1e-6) << i;
    // A voxel is 1/30; the box filter of a cell rounds a corner by as much.
    EXPECT_NEAR(marched[i], chord(directions[i]), 0.01) << i;
    EXPECT_NEAR(swept[2 * i], chord(directions[i]), 0.034) << i;
    EXPECT_NEAR(swept[2 * i + 1], chord(directions[i]), 0.034) << i;
  }
}

// Every vertex and every edge's middle of a ball, seen from its centre and across it: the triangles that share it count as one crossing, or
// the truth that all figures are measured against would be wrong where meshes are regular. Embree misses a vertex now and then.
TEST(HardNumbers, ReferenceRaysThroughEveryVertex) {
  const SurfaceMesh ball = ballMesh(1, 3);
  const auto reference = meshReference(ball);
  std::vector<Vec3> targets = ball.positions;
  for (const auto& [a, b, c] : ball.triangles) targets.push_back(0.5F * (ball.positions[a] + ball.positions[b]));
  size_t missed = 0;
  for (const Vec3& p : targets) {
    const Vec3 outwards = *normalized(p);
    ASSERT_NEAR(reference->insideLength({{}, outwards}, INFINITY), length(p), 1e-5);
    ASSERT_EQ(reference->insideLength({3.0F * outwards, outwards}, INFINITY), 0);
    // The ball is its own image at the centre.
    missed += std::fabs(reference->insideLength({1.2F * outwards, -outwards}, INFINITY) - 2 * double(length(p))) > 1e-5;
  }
  std::printf("[figures] exact chords through the vertices and edges of a ball: %zu of %zu are wrong\n", missed, targets.size());
  EXPECT_LE(missed, targets.size() / 100);
}

// A tangent ray runs through the half-filled voxels of the surface: from a ball's vertex it may see √(8 R h) of them, never the inside.
TEST(HardNumbers, TangentRaysSeeNoInside) {
  const SurfaceMesh ball = ballMesh(1, 5);
  Warnings warnings;
  for (const int voxels : {25, 100}) {
    const CoverageField field = coverageFromClosedMesh(ball, latticeOf(voxels), warnings).value();
    const DenseField dense = denseFromLevelSet(levelSetFromMesh(ball, latticeOf(voxels), warnings));
    BakeSettings settings;
    settings.steps = 300;
    settings.ray_length = 3;
    const double most = std::sqrt(8.0 * 2 / voxels);
    double mean = 0;
    size_t count = 0;
    for (size_t v = 0; v < ball.positions.size(); v += 97) {
      const Vec3 p = ball.positions[v], tangent = frameAround(ball.normals[v]).tangent;
      for (const float length :
           {sweptLengths({&p, 1}, {&tangent, 1}, field, 10)[0], marchedLengths({&p, 1}, {&tangent, 1}, dense, settings)[0]}) {
        EXPECT_LT(length, most) << voxels;
        mean += length, ++count;
      }
    }
    EXPECT_LT(mean / double(count), 0.6 * most);
  }
}

// Corners of a box on corners of voxels, or on their centres, lie on every side of every tie: their lobes still look at the middle, and see
// what there is to see.
TEST(HardNumbers, VerticesOnVoxelCorners) {
  for (const float half : {20.0F, 20.5F}) {
    const SurfaceMesh cube = boxMesh({-half, -half, -half}, {half, half, half});
    const auto reference = meshReference(cube);
    LevelSetSettings lattice;
    lattice.voxel_size = 1.0F;
    const BothBakes bakes = bakedBothWays(cube, {cube.positions, {}}, lattice);
    for (size_t v = 0; v < 8; ++v)
      for (const Lobe& lobe : {bakes.sweep[v], bakes.rays[v]}) {
        EXPECT_LT(angleDegrees(lobe.direction, *normalized(-cube.positions[v])), 4) << half;
        EXPECT_NEAR(lobe.thickness, reference->insideLength({cube.positions[v], lobe.direction}, INFINITY), 2.5) << half;
      }
  }
}

// At the centre of a symmetric cloud the weighted directions cancel to rounding: no direction is made of that rounding, it is counted.
TEST(HardNumbers, CentreOfSymmetry) {
  const SurfaceMesh cube = boxMesh({-8.5F, -8.5F, -8.5F}, {8.5F, 8.5F, 8.5F});
  const std::vector<Vec3> centre{{0, 0, 0}}, normal{{0.6F, 0, 0.8F}};
  LevelSetSettings lattice;
  lattice.voxel_size = 1.0F;
  Warnings warnings;
  BakeSettings settings;
  settings.ray_length = 40.0F;
  const Lobe swept = sweptLobes(cube, {centre, normal}, lattice, warnings).front();
  const Lobe marched =
      bakeSphereRays({centre, normal}, denseFromLevelSet(levelSetFromMesh(cube, lattice, warnings)), settings, warnings)[0];
  EXPECT_EQ(countOf(warnings, WarningKind::kUndefinedDirection), 2U);
  for (const Lobe& lobe : {swept, marched}) {
    EXPECT_EQ(lobe.direction, -normal[0]);
    EXPECT_NEAR(lobe.thickness, 8.5 / 0.8, 0.6);
  }
}
