// Rows of the table in the L-system notes: measured in Houdini, from the literature, or in closed form.
#include "lsystem/turtle.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "lsystem/keys.h"
#include "tests/lsystem/lsystem_cases.h"

using namespace cloudbake;

namespace {

struct Extent {
  double low = INFINITY, high = -INFINITY;
};
Extent extentOf(const TurtlePath& path, double Double3::*axis) {
  Extent extent;
  for (const TurtlePoint& point : path.points)
    extent = {std::min(extent.low, point.position.*axis), std::max(extent.high, point.position.*axis)};
  return extent;
}

double pathLength(const TurtlePath& path) {
  double sum = 0;
  for (const TurtlePoint& point : path.points)
    if (point.previous >= 0) sum += length(point.position - path.points[size_t(point.previous)].position);
  return sum;
}

void expectPoints(const TurtlePath& path, const std::vector<Double3>& expected) {
  ASSERT_EQ(path.points.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) expectNear(path.points[i].position, expected[i]);
}

void expectHeights(const TurtlePath& path, const std::vector<double>& expected) {
  ASSERT_EQ(path.points.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(path.points[i].position.y, expected[i], 1e-6);
}

Double3 lastPoint(const std::string& premise, double angle = 90) { return Case(premise, {}, angle).path(0).points.back().position; }

// Distinct lattice points, rounded.
std::set<std::tuple<int, int, int>> latticeOf(const TurtlePath& path) {
  std::set<std::tuple<int, int, int>> lattice;
  for (const TurtlePoint& p : path.points) {
    const Double3 r{std::round(p.position.x), std::round(p.position.y), std::round(p.position.z)};
    expectNear(p.position, r);
    lattice.insert({int(r.x), int(r.y), int(r.z)});
  }
  return lattice;
}

}  // namespace

TEST(Turtle, Row3Koch) {
  Case c("F", {"F=F+F--F+F"}, 60);
  size_t edges = 1;
  for (int n = 0; n <= 4; ++n, edges *= 4) EXPECT_EQ(c.path(n).points.size(), edges + 1);
  const TurtlePath path = c.path(3);
  expectNear(path.points.back().position, {0, 27, 0});
  const Extent x = extentOf(path, &Double3::x);
  EXPECT_NEAR(x.high - x.low, 7.794229, 1e-6);
}

TEST(Turtle, Row4FractionalKoch) {
  const TurtlePath path = Case("F", {"F=F+F--F+F"}, 60).path(2.5);
  EXPECT_EQ(path.points.size(), 65U);
  EXPECT_NEAR(pathLength(path), 40, 1e-9);
  expectNear(path.points.back().position, {0, 21.294229, 0});
  const Extent x = extentOf(path, &Double3::x);
  EXPECT_NEAR(x.high - x.low, 6.147114, 1e-6);
}

TEST(Turtle, Row5QuadraticIsland) {
  Case c("F-F-F-F", {"F=F-F+F+FF-F-F+F"});
  size_t edges = 4;
  for (int n = 0; n <= 3; ++n, edges *= 8) {
    const TurtlePath path = c.path(n);
    EXPECT_EQ(path.points.size(), edges + 1);
    expectNear(path.points.back().position, {0, 0, 0});
  }
  const TurtlePath path = c.path(2);
  EXPECT_NEAR(extentOf(path, &Double3::x).low, -21, 1e-6);
  EXPECT_NEAR(extentOf(path, &Double3::x).high, 5, 1e-6);
  EXPECT_NEAR(extentOf(path, &Double3::y).low, -5, 1e-6);
  EXPECT_NEAR(extentOf(path, &Double3::y).high, 21, 1e-6);
}

TEST(Turtle, Row6Dragon) {
  Case c("F(1,1,1,3,0)", {"F(i,j,k,l,m):m=0=F(i,j,k,l,0)+F(i,j,k,l,1)+", "F(i,j,k,l,m):m=1=-F(i,j,k,l,0)-F(i,j,k,l,1)"});
  const Double3 ends[] = {{1, 1, 0}, {2, 0, 0}, {2, -2, 0}, {0, -4, 0}};
  for (int n = 1; n <= 4; ++n) expectNear(c.end(n), ends[n - 1]);
  expectNear(c.end(10), {32, 0, 0});
}

TEST(Turtle, Row7Arrowhead) {
  Case c("F", {"F=G-F-G", "G=F+G+F"}, 60);
  const Double3 ends[] = {{-1.732051, 1, 0}, {0, 4, 0}, {-6.928203, 4, 0}};
  size_t edges = 3;
  for (int n = 1; n <= 3; ++n, edges *= 3) {
    expectNear(c.end(n), ends[n - 1]);
    EXPECT_EQ(countSymbol(c.grow(n), 'F') + countSymbol(c.grow(n), 'G'), edges);
  }
}

TEST(Turtle, Row8HilbertFillsTheSquare) {
  Case c("L", {"L=+RF-LFL-FR+", "R=-LF+RFR+FL-"});
  for (int n = 1; n <= 4; ++n) {
    const int side = 1 << n;
    const TurtlePath path = c.path(n);
    const auto lattice = latticeOf(path);
    EXPECT_EQ(path.points.size(), size_t(side) * size_t(side));
    EXPECT_EQ(lattice.size(), path.points.size());
    for (const auto& [x, y, z] : lattice) EXPECT_TRUE(x >= 0 && x < side && y >= 0 && y < side && z == 0);
    // One pass by hand: right to (1,0), up to (1,1), left to (0,1). Every level repeats that figure: the end is the corner above.
    expectNear(path.points.back().position, {0, side - 1.0, 0});
  }
}

TEST(Turtle, Row9HilbertFillsTheCube) {
  Case c("A", {"A=B-F+CFC+F-D&F^D-F+&&CFC+F+B//", "B=A&F^CFB^F^D^^-F-D^|F^B|FC^F^A//", "C=|D^|F^B-F+C^F^A&&FA&F^C+F+B^F^D//",
               "D=|CFB-F+B|FA&F^A&&FB-F+B|FC//"});
  for (int n = 1; n <= 3; ++n) {
    const double side = std::exp2(n) - 1;
    const TurtlePath path = c.path(n);
    EXPECT_EQ(path.points.size(), size_t(1) << (3 * n));
    EXPECT_EQ(latticeOf(path).size(), path.points.size());
    for (double Double3::*axis : {&Double3::x, &Double3::y, &Double3::z}) {
      const Extent extent = extentOf(path, axis);
      EXPECT_NEAR(extent.high - extent.low, side, 1e-6);
    }
    expectNear(path.points.back().position, {0, 0, -side});
  }
}

TEST(Turtle, Row10Plants) {
  Case a("F", {"F=F[+F]F[-F]F"}, 25.7);
  const TurtlePath path = a.path(2);
  EXPECT_EQ(path.points.size(), 26U);
  expectNear(a.end(2), {0, 9, 0});
  EXPECT_NEAR(extentOf(path, &Double3::x).low, -1.6488, 1e-4);
  EXPECT_NEAR(extentOf(path, &Double3::x).high, 1.3010, 1e-4);
  Case f("X", {"X=F-[[X]+X]+F[+FX]-X", "F=FF"}, 22.5);
  EXPECT_EQ(f.path(2).points.size(), 19U);
  expectNear(f.end(2), {-0.765367, 5.847759, 0});
}

TEST(Turtle, Row14RightIsRight) {
  expectPoints(Case("+(90)F", {"F=F+F-F-F+F"}).path(1), {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {2, -1, 0}, {2, 0, 0}, {3, 0, 0}});
  expectNear(Case("+(90)F", {"F=F+F-F-F+F"}).end(3), {27, 0, 0});
  Case c("F", {"F=FF[-FF]F[-FF]FF-"});
  size_t edges = 9;
  for (int n = 1; n <= 3; ++n, edges *= 9) EXPECT_EQ(countSymbol(c.grow(n), 'F'), edges);
}

TEST(Turtle, Row16ArgumentsOverrideSettings) {
  Case c("F(1) +(90) F(1) +(90) F(1) +(90) F(1)", {}, 13);
  c.turtle.step = 7;
  expectPoints(c.path(0), {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 0, 0}});
}

TEST(Turtle, Row23MovesAndPoints) {
  expectHeights(Case("FfFHhGF", {}).path(0), {0, 1, 2, 3, 3.5, 5, 6});
  const TurtlePath fork = Case("F[+F][-F]F", {}).path(0);
  expectPoints(fork, {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 2, 0}});
  const double arcs[] = {0, 1, 2, 2, 2};
  const int previous[] = {-1, 0, 1, 1, 1}, depths[] = {0, 0, 1, 1, 0};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(fork.points[i].arc, arcs[i], 1e-12);
    EXPECT_NEAR(fork.points[i].lage, arcs[i], 1e-12);
    EXPECT_EQ(fork.points[i].previous, previous[i]);
    EXPECT_EQ(fork.points[i].depth, depths[i]);
  }
  const TurtlePath back = Case("F(-1)F(-2)", {}).path(0);
  expectHeights(back, {0, -1, -3});
  EXPECT_EQ(back.points[2].arc, 3) << "a way back is a way too";
  expectHeights(Case("F(1,,4)", {}).path(0), {0, .25, .5, .75, 1});
  // G adds no vertex: its edge runs on to the next point of the curve.
  const TurtlePath run_on = Case("FGF", {}).path(0);
  expectHeights(run_on, {0, 1, 3});
  EXPECT_EQ(run_on.points[2].previous, 1);
}

TEST(Turtle, Row24Rotations) {
  expectNear(lastPoint("&(90)F"), {0, 0, -1});
  expectNear(lastPoint(R"(\(90)&(90)F)"), {-1, 0, 0});
  expectNear(lastPoint("/(90)&(90)F"), {1, 0, 0});
  expectNear(lastPoint(R"(\\&(90)F)", 45), {-1, 0, 0});
  expectNear(lastPoint("&(90)F$^(90)F"), {0, 1, -1});
  expectNear(lastPoint("+(90)*&(90)F"), {0, 0, 1});
  expectNear(lastPoint("|F"), {0, -1, 0});
  expectNear(lastPoint("F$(5,1,0)F"), {1, 1, 0});
  expectNear(lastPoint("F$(0,-7,0)F"), {0, 0, 0});                  // straight behind
  expectNear(lastPoint("$(0,0,0)F"), {0, 1, 0});                    // no direction: nothing
  expectNear(lastPoint("/(33)$^(90)F"), lastPoint("/(33)^(90)F"));  // vertical: nothing
}

TEST(Turtle, PitchUpSwapsTheTwo) {
  Case c("&(90)F", {});
  c.turtle.pitch_up = true;
  expectNear(c.end(0), {0, 0, 1});
}

TEST(Turtle, StartFrame) {
  Case c("F", {});
  c.turtle.start_position = {1, 2, 3};
  c.turtle.start_rotation = {0, 0, 90};
  expectNear(c.end(0), {0, 2, 3});
  c.turtle.start_rotation = {90, 0, 0};
  expectNear(c.end(0), {1, 2, 4});
}

TEST(Turtle, Row25Gravity) {
  expectNear(lastPoint("+(90)T(30)F"), {.866025, -.5, 0});
  expectNear(lastPoint("+(90)T(-30)F"), {.866025, .5, 0});
  expectNear(lastPoint("+(90)T(200)F"), {0, -1, 0});
  expectNear(lastPoint("+(90)T(-200)F"), {0, 1, 0});
  expectNear(lastPoint("TF"), {0, 1, 0});
  expectNear(lastPoint("+(90)TF"), {.991445, -.130526, 0});
}

TEST(Turtle, Row26Scales) {
  Case step("F\"F\"F", {});
  step.turtle.step_scale = 0.5;
  EXPECT_NEAR(step.end(0).y, 1.75, 1e-12);
  Case explicit_step("F\"(3)F_(2)F", {});
  EXPECT_NEAR(explicit_step.end(0).y, 5.5, 1e-12);
  Case angle(";+F", {}, 40);
  angle.turtle.angle_scale = 0.5;
  expectNear(angle.end(0), {.342020, .939693, 0});
  angle.text.premise.text = "@+F";
  expectNear(angle.end(0), {.984808, .173648, 0});

  const auto widthsOf = [](const char* premise) {
    std::vector<double> widths;
    for (const TurtlePoint& point : Case(premise, {}).path(0).points) widths.push_back(point.width);
    return widths;
  };
  const std::vector<double> expected{.1, .1, .09, .045, .05}, widths = widthsOf("F!F!(0.5)F?F");
  ASSERT_EQ(widths.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(widths[i], expected[i], 1e-12);
  EXPECT_EQ(widthsOf("F(1,0.5)F"), (std::vector<double>{.5, .5, .1}));
}

TEST(Turtle, Row27Growth) {
  Case line("A", {"A=FA"});
  EXPECT_NEAR(line.end(2.5).y, 2.5, 1e-12);
  line.turtle.continuous_length = false;
  EXPECT_NEAR(line.end(2.5).y, 3, 1e-12);
  EXPECT_NEAR(Case("F", {"F=FF"}).end(1.25).y, 2.5, 1e-12);
  Case bend("A", {"A=+FA"});
  expectNear(bend.end(1.5), {1.353553, -.353553, 0});
  bend.turtle.continuous_angles = false;
  expectNear(bend.end(1.5), {1, -.5, 0});

  const int births[] = {0, 0, 1, 2, 3};
  const TurtlePath path = Case("FA", {"A=FA"}).path(3);
  ASSERT_EQ(path.points.size(), 5U);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(path.points[i].gen, births[i]);

  Case width("A", {"A=FA"});
  EXPECT_FLOAT_EQ(width.path(2.25).points.back().growth, 0.25F);
  EXPECT_EQ(width.path(2.25).points[1].growth, 1);
  width.turtle.continuous_width = false;
  EXPECT_EQ(width.path(2.25).points.back().growth, 1);
}

TEST(Turtle, Row32Tumble) {
  Case c("~(30)F", {});
  expectNear(c.end(0), {.256390, .827988, -.498698});
  c.settings.seed = 2;
  expectNear(c.end(0), {.422217, .895120, .143154});
}

TEST(Turtle, RandomScaleStaysInItsRange) {
  Case c(std::string(2000, 'F'), {});
  c.turtle.random_scale = 0.25;
  const TurtlePath path = c.path(0);
  double low = 1, high = 1, sum = 0;
  for (size_t i = 1; i < path.points.size(); ++i) {
    const double step = path.points[i].position.y - path.points[i - 1].position.y;
    low = std::min(low, step);
    high = std::max(high, step);
    sum += step;
    EXPECT_EQ(path.points[i].width, 0.1);
  }
  EXPECT_GE(low, 0.75 - 1e-9);
  EXPECT_LT(low, 0.76);
  EXPECT_LE(high, 1.25 + 1e-9);
  EXPECT_GT(high, 1.24);
  EXPECT_NEAR(sum / 2000, 1, 5 * 0.25 / std::sqrt(3.0 * 2000));
  c.turtle.random_scale_all = true;
  EXPECT_NE(c.path(0).points.back().width, 0.1);
}

// The notes give each purpose a channel of its own: u(key, 2, 0) for lengths, 6 for angles, 7 for widths. So a long segment is no thicker
// than others.
TEST(Turtle, RandomScaleDrawsLengthsAnglesAndWidthsApart) {
  std::string premise;
  constexpr size_t kSteps = 2000;
  for (size_t i = 0; i < kSteps; ++i) premise += "+F";
  Case c(premise, {}, 10);
  c.turtle.random_scale = 0.25;
  c.turtle.random_scale_all = true;
  const TurtlePath path = c.path(0);
  ASSERT_EQ(path.points.size(), kSteps + 1);
  const auto factor = [](uint64_t module, uint64_t channel) {
    return 1 + 0.25 * (2 * drawUniform(premiseKey(rootKey(1), module), DrawChannel(channel), 0) - 1);
  };
  double direction = 0, products = 0;
  for (size_t i = 0; i < kSteps; ++i) {
    const TurtlePoint &from = path.points[i], &to = path.points[i + 1];
    const double distance = length(to.position - from.position);
    direction += 10 * factor(2 * i, 6) * kPi / 180;
    ASSERT_NEAR(distance, factor(2 * i + 1, 2), 1e-9) << i;
    ASSERT_NEAR(to.width, 0.1 * factor(2 * i + 1, 7), 1e-12) << i;
    ASSERT_NEAR(to.heading.x, std::sin(direction), 1e-5) << i;
    ASSERT_NEAR(to.heading.y, std::cos(direction), 1e-5) << i;
    products += (distance - 1) / 0.25 * (to.width / 0.1 - 1) / 0.25;
  }
  // Two draws that are independent and uniform in ±1 have a mean product of 0, with a standard deviation of 1/3 for one pair.
  EXPECT_NEAR(products / kSteps, 0, 5 / (3 * std::sqrt(double(kSteps))));
}

// `g` without a number opens a group that no other branch has: one more than the largest so far, not one more than the last.
TEST(Turtle, NewGroupsAreNumberedAfterTheLargest) {
  const TurtlePath path = Case("g(5)Fg(2)FgFgF", {}).path(0);
  const int groups[] = {5, 5, 2, 6, 7};
  ASSERT_EQ(path.points.size(), 5U);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(path.points[i].group, groups[i]) << i;
}

TEST(Turtle, LeavesGroupsAttributesPolygons) {
  const TurtlePath path = Case(R"(FJ(2,9,3,4,5)[g(4)F[gF]a("pscale",0.5,6)Fa("pscale",0.7)FK]{.F.F.}gFg(-1)FM)", {}).path(0);
  ASSERT_EQ(path.leaves.size(), 3U);
  EXPECT_EQ(path.leaves[0].scale, 2);
  EXPECT_EQ(path.leaves[0].values, (std::array<double, 3>{3, 4, 5}));
  EXPECT_EQ(path.leaves[0].point.previous, 1);
  EXPECT_EQ(path.leaves[1].symbol, 'K');
  EXPECT_EQ(path.leaves[1].scale, 1);  // the step
  expectNear(path.leaves[1].point.position, {0, 4, 0});

  // Points: 0 1 | 2 in the branch | 3 in its branch | 4 5 | 6 7 of the polygon | 8 | 9
  const int groups[] = {-1, -1, 4, 5, 4, 4, -1, -1, 6, -1};
  ASSERT_EQ(path.points.size(), 10U);
  for (size_t i = 0; i < 10; ++i) EXPECT_EQ(path.points[i].group, groups[i]) << i;
  EXPECT_EQ(findAttribute(path, path.points[3], "pscale"), nullptr);
  ASSERT_NE(findAttribute(path, path.points[4], "pscale"), nullptr);
  EXPECT_EQ(findAttribute(path, path.points[4], "pscale")->values[1], 6);
  EXPECT_EQ(findAttribute(path, path.points[5], "pscale")->values[0], 0.7);
  EXPECT_EQ(findAttribute(path, path.points[6], "pscale"), nullptr);  // pushed with the state
  ASSERT_EQ(path.polygons.size(), 1U);
  ASSERT_EQ(path.polygons[0].size(), 3U);
  expectNear(path.polygons[0][2], {0, 3, 0});
}

// Row 34: a bracket too much is a warning, one too few is fine.
TEST(Turtle, WarnsOfWhatMatchesNothing) {
  const auto warningOf = [](const char* premise) {
    Case c(premise, {});
    c.path(0);
    return c.warning();
  };
  EXPECT_NE(warningOf("F]F").find("closes no branch"), std::string::npos);
  EXPECT_EQ(warningOf("[[F"), "");
  EXPECT_NE(warningOf("F}").find("outside a polygon"), std::string::npos);
  EXPECT_NE(warningOf("{F").find("never closed"), std::string::npos);
  EXPECT_NE(warningOf("F_(0)F").find("divides by 0"), std::string::npos);
  EXPECT_NEAR(lastPoint("F_(0)F").y, 2, 1e-12);
}

TEST(Turtle, RefusesWhatCannotBeHeld) {
  Case deep(std::string(1001, '['), {});
  expectInputError([&] { deep.path(0); }, "1000 open brackets");
  Case many("F(1,,5000)F(1,,5000)", {});
  many.turtle.max_points = 9000;
  expectInputError([&] { many.path(0); }, "more than 9000 points");
  Case few("FFF", {});
  few.turtle.max_points = 4;
  EXPECT_EQ(few.path(0).points.size(), 4U);
  few.turtle.max_points = 3;
  expectInputError([&] { few.path(0); }, "more than 3 points");
  // Each a(…) copies what the branch carries already.
  std::string attributes;
  for (int k = 0; k < 90; ++k) attributes += "a(\"n" + std::to_string(k) + "\",1)";
  Case carried(attributes + "F" + std::string(10, 'X'), {"X=X[a(\"n0\",2)F]"});
  EXPECT_EQ(carried.path(9).points.size(), 92U);
  carried.turtle.max_points = 9000;
  expectInputError([&] { carried.path(9); }, "9000 points, leaves and attributes");
  expectInputError([] { Case("F(1e300)", {}).path(0); }, "range of numbers");
  expectInputError([] { Case("F(1,,0)", {}).path(0); }, "segments");
  Case scales("\"(1e200)\"(1e200)F", {});
  expectInputError([&] { scales.path(0); }, "range of numbers");
  Case thin("F", {});
  thin.turtle.thickness = 0;
  expectInputError([&] { thin.path(0); }, "thickness");
}

// A long walk does not drift: 10⁵ turns by 1 degree bring the polygon back to its start.
TEST(Turtle, DoesNotDrift) {
  std::string premise;
  for (int i = 0; i < 36000; ++i) premise += "F+";
  EXPECT_LT(length(Case(premise, {}, 1).end(0)), 1e-7);
}

// Nor does its frame, however the axes are mixed: rounding alone would bend and stretch it within a few hundred rotations.
TEST(Turtle, FrameStaysOrthonormal) {
  for (const char* unit : {"~(30)F", "+(20)&(20)F", "&(60)/(60)F", "+(20)&(31)\\(12)^T$F"}) {
    std::string premise;
    for (int i = 0; i < 5000; ++i) premise += unit;
    const TurtlePath path = Case(premise, {}, 30).path(0);
    for (size_t i = 1; i < path.points.size(); ++i)
      ASSERT_NEAR(length(path.points[i].position - path.points[i - 1].position), 1, 1e-9) << unit << i;
    EXPECT_NEAR(dot(path.points.back().heading, path.points.back().up), 0, 1e-6F);
  }
}
