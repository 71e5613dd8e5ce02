#include "lsystem/spheres.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/random.h"
#include "lsystem/keys.h"
#include "tests/lsystem/lsystem_cases.h"

using namespace cloudbake;

namespace {

// No chance, no hidden spheres' shrinkage: radius = size.
SphereSettings plainSettings() {
  SphereSettings settings;
  settings.radius_min = settings.radius_max = 1;
  return settings;
}

std::vector<Sphere> spheresOf(Case c, const SphereSettings& settings, double generations = 0) {
  Warnings warnings;
  return spheresFromPath(c.path(generations), settings, warnings);
}

TurtlePath pathOf(const std::vector<Double3>& positions) {
  TurtlePath path;
  for (const Double3& position : positions) {
    TurtlePoint point;
    point.position = position;
    point.width = 1;
    path.points.push_back(point);
  }
  return path;
}

}  // namespace

TEST(Spheres, RadiusIsTheProductOfItsFactors) {
  SphereSettings settings = plainSettings();
  settings.size = 0.5;
  settings.width_power = 2;
  settings.generation_power = 1;
  Case c("f!(3)A", {"A=B", "B=FB"});
  c.turtle.thickness = 0.2;
  // One F of birth 2 and width 3·0.2: 0.5 · 3² · 2/4
  for (const Sphere& sphere : spheresOf(c, settings, 2)) EXPECT_FLOAT_EQ(sphere.radius, 2.25F);
  // Growth multiplies: half a generation, half the radius
  EXPECT_FLOAT_EQ(spheresOf(c, settings, 1.5).at(0).radius, 1.125F);
}

TEST(Spheres, RandomFactorIsADrawBetweenItsBounds) {
  SphereSettings settings = plainSettings();
  settings.radius_min = 1;
  settings.radius_max = 2;
  const TurtlePath path = Case("fF", {}).path(0);
  const double u = drawUniform(premiseKey(rootKey(1), 1), DrawChannel::kRadius, 0);
  Warnings warnings;
  settings.size = 0.2;
  const auto spheres = spheresFromPath(path, settings, warnings);
  ASSERT_EQ(spheres.size(), 2U);
  EXPECT_FLOAT_EQ(spheres[1].radius, float(0.2 * (1 + u)));
}

TEST(Spheres, EmitChoosesPointsOrLeaves) {
  SphereSettings settings = plainSettings();
  settings.size = 0.3;
  settings.leaf_size = 0.25;
  Case c("FF[fJ(2)]", {});
  EXPECT_EQ(spheresOf(c, settings).size(), 4U);
  settings.emit = Emit::kPoints;
  EXPECT_EQ(spheresOf(c, settings).size(), 3U);
  settings.emit = Emit::kLeaves;
  const auto leaves = spheresOf(c, settings);
  ASSERT_EQ(leaves.size(), 1U);
  EXPECT_FLOAT_EQ(leaves[0].radius, 0.5F);
  EXPECT_EQ(leaves[0].center, (Vec3{0, 3, 0}));
}

TEST(Spheres, PscaleReplacesSizeWidthAndGeneration) {
  SphereSettings settings = plainSettings();
  settings.size = 7;
  const auto spheres = spheresOf(Case(R"(a("pscale",0.25)!(3)F)", {}), settings);
  ASSERT_EQ(spheres.size(), 2U);
  EXPECT_FLOAT_EQ(spheres[0].radius, 0.25F);
}

TEST(Spheres, SectionsBecomeSpheresWithTheirOwnDraws) {
  SphereSettings settings;
  settings.size = 0.1;
  const auto spheres = spheresOf(Case("F(1,,4)", {}), settings);
  ASSERT_EQ(spheres.size(), 5U);
  EXPECT_EQ(spheres[0].radius, spheres[1].radius);
  EXPECT_NE(spheres[1].radius, spheres[2].radius);
  EXPECT_NE(spheres[2].radius, spheres[3].radius);
}

TEST(Spheres, HeightsAreShaped) {
  SphereSettings settings = plainSettings();
  settings.size = 0.5;
  settings.base = 0;
  settings.squash = 0.1;
  settings.ceiling = 4;
  Warnings warnings;
  const TurtlePath path = pathOf({{0, -2, 0}, {0, 2, 0}, {0, 6, 0}});
  auto spheres = spheresFromPath(path, settings, warnings);
  ASSERT_EQ(spheres.size(), 3U);
  EXPECT_FLOAT_EQ(spheres[0].center.y, -0.2F);
  EXPECT_FLOAT_EQ(spheres[1].center.y, 2);
  EXPECT_FLOAT_EQ(spheres[2].center.y, 4.6F);
  settings.flat = 0.42;
  spheres = spheresFromPath(path, settings, warnings);
  EXPECT_FLOAT_EQ(spheres[0].center.y, 0.21F);
  // smoothstep(0, 6, 2) = 7/27
  settings.top_falloff = 0.5;
  spheres = spheresFromPath(path, settings, warnings);
  EXPECT_FLOAT_EQ(spheres[1].radius, float(0.5 * (1 - 0.5 * 7 / 27.0)));
  EXPECT_FLOAT_EQ(spheres[2].radius, 0.25F);
}

// The fall-off runs up to the highest sphere and, without a base, from the lowest one. A leaf can be either, unless leaves are not emitted.
TEST(Spheres, TheFalloffSpansLeavesAsWell) {
  SphereSettings settings = plainSettings();
  settings.size = settings.leaf_size = 0.5;
  settings.top_falloff = 0.5;
  settings.connect = false;
  const auto radii = [&](const std::vector<double>& points, double leaf) {
    TurtlePath path;
    for (const double height : points) path.points.emplace_back().position = {0, height, 0}, path.points.back().width = 1;
    path.leaves.emplace_back().point.position = {0, leaf, 0};
    path.leaves.back().scale = 1;
    Warnings warnings;
    std::vector<float> result;
    for (const Sphere& sphere : spheresFromPath(path, settings, warnings)) result.push_back(sphere.radius);
    return result;
  };
  // smoothstep(0, 6, 2) = 7/27
  std::vector<float> high = radii({0, 2}, 6);
  ASSERT_EQ(high.size(), 3U);
  EXPECT_FLOAT_EQ(high[0], 0.5F);
  EXPECT_FLOAT_EQ(high[1], float(0.5 * (1 - 0.5 * 7 / 27)));
  EXPECT_FLOAT_EQ(high[2], 0.25F);
  // smoothstep(−6, 3, 0) = 20/27
  const std::vector<float> low = radii({0, 3}, -6);
  ASSERT_EQ(low.size(), 3U);
  EXPECT_FLOAT_EQ(low[0], float(0.5 * (1 - 0.5 * 20 / 27)));
  EXPECT_FLOAT_EQ(low[1], 0.25F);
  EXPECT_FLOAT_EQ(low[2], 0.5F);
  settings.emit = Emit::kPoints;
  EXPECT_EQ(radii({0, 2}, 6), (std::vector<float>{0.5F, 0.25F}));
}

TEST(Spheres, JitterStaysWithinItsBox) {
  SphereSettings settings = plainSettings();
  settings.size = 0.2;
  settings.jitter = 0.5;
  const auto spheres = spheresOf(Case(std::string(500, 'F'), {}), settings);
  ASSERT_EQ(spheres.size(), 501U);
  float largest = 0;
  for (size_t i = 0; i < spheres.size(); ++i) {
    const Vec3 offset = spheres[i].center - Vec3{0, float(i), 0};
    for (const float d : {offset.x, offset.y, offset.z}) {
      EXPECT_LE(std::fabs(d), 0.1F + 1e-4F);
      largest = std::max(largest, std::fabs(d));
    }
  }
  EXPECT_GT(largest, 0.095F);
}

// Against the definition, tried on all pairs.
TEST(Spheres, HiddenOnesGoAsByBruteForce) {
  TurtlePath path;
  for (uint64_t i = 0; i < 600; ++i) {
    TurtlePoint point;
    const auto u = [&](uint64_t n) { return drawUniform(i + 1, DrawChannel::kJitter, n); };
    point.position = {3 * u(0), 3 * u(1), 3 * u(2)};
    point.width = 0.02 + 0.9 * u(3) * u(4) * u(5);
    path.points.push_back(point);
  }
  Warnings warnings;
  const auto spheres = spheresFromPath(path, plainSettings(), warnings);

  std::vector<size_t> order(path.points.size()), kept;
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return path.points[a].width > path.points[b].width; });
  for (const size_t i : order) {
    const bool hidden = std::any_of(kept.begin(), kept.end(), [&](size_t j) {
      return length(path.points[i].position - path.points[j].position) + 0.95 * path.points[i].width <= path.points[j].width;
    });
    if (!hidden) kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end());
  ASSERT_LT(kept.size(), path.points.size());
  ASSERT_EQ(spheres.size(), kept.size());
  for (size_t k = 0; k < kept.size(); ++k) EXPECT_EQ(spheres[k].center, toFloat(path.points[kept[k]].position));

  // Parts, by flooding over all pairs
  std::vector<int> part(spheres.size(), -1);
  int count = 0;
  for (size_t s = 0; s < spheres.size(); ++s) {
    if (part[s] >= 0) continue;
    std::vector<size_t> front{s};
    part[s] = count;
    while (!front.empty()) {
      const size_t i = front.back();
      front.pop_back();
      for (size_t j = 0; j < spheres.size(); ++j) {
        const double ri = spheres[i].radius, rj = spheres[j].radius;
        const Vec3 a = spheres[i].center, b = spheres[j].center;
        const double d = std::sqrt(std::pow(double(a.x) - b.x, 2) + std::pow(double(a.y) - b.y, 2) + std::pow(double(a.z) - b.z, 2));
        if (part[j] < 0 && d < ri + rj - 0.1 * std::min(ri, rj)) {
          part[j] = count;
          front.push_back(j);
        }
      }
    }
    ++count;
  }
  EXPECT_GT(count, 1);
  EXPECT_EQ(findParts(spheres), part);
}

// Without a size the spheres are as large as the steps between them, so that pasted rules give one body.
TEST(Spheres, SizeIsTheStepUnlessGiven) {
  Case c("FF\"(3)F", {});
  c.turtle.step = -0.2;
  SphereSettings settings;
  settings.radius_min = settings.radius_max = 1;
  const auto spheres = spheresOf(c, settings);
  ASSERT_EQ(spheres.size(), 4U);
  for (const Sphere& sphere : spheres) EXPECT_EQ(sphere.radius, 0.2F);
}

std::vector<Sphere> spheresFrom(const TurtlePath& path, const SphereSettings& settings) {
  Warnings warnings;
  return spheresFromPath(path, settings, warnings);
}

// The largest are kept, in their order.
TEST(Spheres, CountKeepsTheLargest) {
  const TurtlePath path = pathOf({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {30, 0, 0}});
  SphereSettings settings;
  settings.size = 1;
  const auto all = spheresFrom(path, settings);
  std::vector<float> radii;
  for (const Sphere& sphere : all) radii.push_back(sphere.radius);
  std::sort(radii.begin(), radii.end());
  settings.count = 2;
  const auto kept = spheresFrom(path, settings);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_LT(kept[0].center.x, kept[1].center.x);
  EXPECT_EQ(std::min(kept[0].radius, kept[1].radius), radii[2]);
  settings.count = 4;
  EXPECT_EQ(spheresFrom(path, settings).size(), 4U);
}

// A joined cloud is inside its domain, and fills it where joining moved nothing.
TEST(Spheres, DomainHoldsTheCloud) {
  const TurtlePath path = pathOf({{0, 0, 0}, {1, 2, 0}, {1.5, 0, 1}, {9, 1, 0}});
  SphereSettings settings = plainSettings();
  settings.domain = Double3{8, 2, 5};
  for (const bool connect : {false, true}) {
    settings.connect = connect;
    Box box;
    const auto spheres = spheresFrom(path, settings);
    for (const Sphere& s : spheres) {
      box.add(s.center - Vec3{s.radius, s.radius, s.radius});
      box.add(s.center + Vec3{s.radius, s.radius, s.radius});
    }
    EXPECT_LE(box.size().x, 8.00001F);
    EXPECT_LE(box.size().y, 2.00001F);
    EXPECT_LE(box.size().z, 5.00001F);
    if (connect) {
      EXPECT_EQ(findParts(spheres), std::vector<int>(spheres.size(), 0));
    } else {
      EXPECT_NEAR(box.size().x, 8, 1e-5);
    }
  }
}

// Against every pair: spheres of a part are joined by overlaps of a tenth of the smaller radius.
TEST(Spheres, PartsAreThoseOfAllPairs) {
  for (uint32_t set = 0; set < 20; ++set) {
    std::vector<Sphere> spheres;
    for (uint32_t i = 0; i < 200; ++i) {
      const auto draw = [&](uint32_t dimension) { return uniformFloat(hashDraw(set, i, dimension)); };
      spheres.push_back({{24 * draw(0), 24 * draw(1), draw(2)}, draw(3) < 0.3F ? 1 : 0.02F + 0.3F * draw(4)});
    }
    std::vector<int> parts(spheres.size());
    std::iota(parts.begin(), parts.end(), 0);
    for (size_t i = 0; i < spheres.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const Sphere &a = spheres[i], &b = spheres[j];
        const double smaller = std::min(a.radius, b.radius);
        const auto [low, high] = std::minmax({parts[i], parts[j]});  // copies: the next line changes both
        if (length(a.center - b.center) < double(a.radius) + b.radius - 0.1 * smaller) std::replace(parts.begin(), parts.end(), high, low);
      }
    std::map<int, int> numbers;  // in order of first appearance
    for (int& part : parts) part = numbers.try_emplace(part, int(numbers.size())).first->second;
    EXPECT_GT(numbers.size(), 5U);
    EXPECT_EQ(findParts(spheres), parts) << set;
  }
}

TEST(Spheres, ConnectPullsPartsIn) {
  // Radii 1: {0, 1.5} touch; 5 and -9 stand apart.
  const TurtlePath path = pathOf({{5, 0, 0}, {0, 0, 0}, {1.5, 0, 0}, {-9, 0, 0}});
  SphereSettings settings = plainSettings();
  Warnings warnings;
  auto spheres = spheresFromPath(path, settings, warnings);
  EXPECT_EQ(findParts(spheres), (std::vector<int>{0, 1, 1, 2}));
  EXPECT_NE(warnings.entries().at(WarningKind::kGrammar).first.find("3 parts"), std::string::npos);
  settings.connect = true;
  Warnings quiet;
  spheres = spheresFromPath(path, settings, quiet);
  EXPECT_TRUE(quiet.empty());
  EXPECT_EQ(findParts(spheres), (std::vector<int>{0, 0, 0, 0}));
  EXPECT_FLOAT_EQ(spheres[0].center.x, 3.25F);  // 1.5 + 1 + 1 - 0.25
  EXPECT_FLOAT_EQ(spheres[3].center.x, -1.75F);
}

// The part of the largest volume stays in its place, and the others come to it: one sphere of radius 3 holds more than ten of radius 1.
TEST(Spheres, ConnectLeavesTheLargestVolumeInPlace) {
  std::vector<Double3> positions;
  for (int i = 0; i < 10; ++i) positions.push_back({20 + 1.5 * i, 0, 0});
  positions.push_back({0, 0, 0});
  TurtlePath path = pathOf(positions);
  path.points.back().width = 3;
  SphereSettings settings = plainSettings();
  settings.connect = true;
  const auto spheres = spheresFrom(path, settings);
  ASSERT_EQ(spheres.size(), 11U);
  EXPECT_EQ(spheres[10].center, (Vec3{0, 0, 0}));
  EXPECT_EQ(spheres[10].radius, 3);
  for (int i = 0; i < 10; ++i) EXPECT_FLOAT_EQ(spheres[size_t(i)].center.x, 3.75F + 1.5F * float(i));  // 3 + 1 − 0.25
}

// Against the definition: larger parts first, each along the smallest gap to what is joined.
TEST(Spheres, ConnectTakesTheSmallestGapAsByBruteForce) {
  std::vector<Double3> positions;
  for (uint64_t i = 0; i < 300; ++i) {
    const auto u = [&](uint64_t n) { return drawUniform(i + 1, DrawChannel::kJitter, n); };
    positions.push_back({40 * u(0), 40 * u(1), 40 * u(2)});
  }
  const TurtlePath path = pathOf(positions);
  SphereSettings settings = plainSettings();
  Warnings warnings;
  const std::vector<int> parts = findParts(spheresFromPath(path, settings, warnings));
  ASSERT_EQ(parts.size(), positions.size());
  std::vector<std::vector<size_t>> members(size_t(*std::max_element(parts.begin(), parts.end())) + 1);
  ASSERT_GT(members.size(), 100U);
  for (size_t i = 0; i < parts.size(); ++i) members[size_t(parts[i])].push_back(i);
  std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<size_t> joined = members[0];
  for (size_t k = 1; k < members.size(); ++k) {
    double best = INFINITY;
    Double3 shift;
    for (const size_t i : members[k])
      for (const size_t j : joined) {
        const Double3 way = positions[j] - positions[i];
        const double distance = length(way);
        if (distance >= best) continue;
        best = distance;
        shift = distance > 1.75 ? way * ((distance - 1.75) / distance) : Double3{};
      }
    for (const size_t i : members[k]) positions[i] = positions[i] + shift;
    joined.insert(joined.end(), members[k].begin(), members[k].end());
  }

  settings.connect = true;
  const auto spheres = spheresFromPath(path, settings, warnings);
  ASSERT_EQ(spheres.size(), positions.size());
  for (size_t i = 0; i < spheres.size(); ++i) {
    const Double3 center{spheres[i].center.x, spheres[i].center.y, spheres[i].center.z};
    EXPECT_LT(length(center - positions[i]), 1e-4) << i;
  }
}

// Many spheres in one place, of sizes far apart, or in many parts.
TEST(Spheres, CrowdsAreQuickOrRefused) {
  TurtlePath path;
  for (uint64_t i = 0; i < 60000; ++i) {
    TurtlePoint point;
    const auto u = [&](uint64_t n) { return drawUniform(i + 1, DrawChannel::kJitter, n); };
    point.position = {u(0), u(1), u(2)};
    point.width = i % 2 == 0 ? 1 + 0.5 * u(3) : std::exp2(-100 * u(3));
    path.points.push_back(point);
  }
  Warnings warnings;
  EXPECT_LT(spheresFromPath(path, plainSettings(), warnings).size(), 1000U);
  for (size_t i = 0; i < path.points.size(); ++i) {
    path.points[i].position = {9.0 * double(i), 0, 0};
    path.points[i].width = 1;
  }
  SphereSettings settings = plainSettings();
  settings.connect = true;
  expectInputError([&] { spheresFromPath(path, settings, warnings); }, "connect joins at most 10000 parts, not 60000");
  path.points.resize(10000);
  EXPECT_EQ(spheresFromPath(path, settings, warnings).size(), 10000U);
}

TEST(Spheres, RefusesWhatGivesNoCloud) {
  EXPECT_EQ(expectInputError([] { spheresOf(Case("ABC", {}), {}); }, "gives no sphere").code, ExitCode::kInput);
  SphereSettings few;
  few.max_spheres = 2;
  expectInputError([&] { spheresOf(Case("FF", {}), few); }, "3 spheres exceed the limit of 2");
  SphereSettings flat;
  flat.flat = 0.4;
  expectInputError([&] { spheresOf(Case("F", {}), flat); }, "flat needs base");
  SphereSettings size;
  size.size = 0;
  expectInputError([&] { spheresOf(Case("F", {}), size); }, "size must be positive");
  SphereSettings broken;
  broken.width_power = 0.5;
  expectInputError([&] { spheresOf(Case("!(0-2)F", {}), broken); }, "not a finite number");
  Case thin("F!(0)F", {});
  Warnings warnings;
  EXPECT_EQ(spheresFromPath(thin.path(0), plainSettings(), warnings).size(), 2U);
  EXPECT_EQ(warnings.entries().at(WarningKind::kGrammar).count, 1U);
}
