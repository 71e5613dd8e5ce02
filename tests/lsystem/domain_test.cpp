#include "lsystem/domain.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

using namespace cloudbake;

namespace {

std::vector<Puff> randomPuffs(int count, uint64_t seed) {
  std::vector<Puff> puffs;
  const auto draw = [&](int k, int part) { return uniformDouble(mix64(seed * 1000003 + uint64_t(k * 4 + part))); };
  for (int k = 0; k < count; ++k) puffs.push_back({{7 + 4 * draw(k, 0), 3 + 2 * draw(k, 1), -5 + 3 * draw(k, 2)}, 0.1 + 0.5 * draw(k, 3)});
  return puffs;
}

Span coverOf(const std::vector<Puff>& puffs, double Double3::*axis) {
  Span span;
  for (const Puff& p : puffs) span = {std::min(span.low, p.center.*axis - p.radius), std::max(span.high, p.center.*axis + p.radius)};
  return span;
}
double lengthOf(const Span& span) { return span.high - span.low; }

constexpr double Double3::*kX = &Double3::x, Double3::*kY = &Double3::y, Double3::*kZ = &Double3::z;

}  // namespace

// Every axis is filled to its length, whatever the proportions; the footprint's middle and the lowest point stay.
TEST(Domain, IsFilled) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const std::vector<Puff> before = randomPuffs(20, seed);
    const Double3 size{std::ldexp(1, int(seed % 5)), std::ldexp(1, int(seed % 3)), 3};
    std::vector<Puff> puffs = before;
    fitDomain(puffs, {size, {}, {}});
    EXPECT_NEAR(lengthOf(coverOf(puffs, kX)), size.x, 1e-9);
    EXPECT_NEAR(lengthOf(coverOf(puffs, kY)), size.y, 1e-9);
    EXPECT_NEAR(lengthOf(coverOf(puffs, kZ)), size.z, 1e-9);
    EXPECT_NEAR(coverOf(puffs, kX).low + coverOf(puffs, kX).high, coverOf(before, kX).low + coverOf(before, kX).high, 1e-9);
    EXPECT_NEAR(coverOf(puffs, kY).low, coverOf(before, kY).low, 1e-9);
    for (size_t i = 1; i < puffs.size(); ++i)  // one factor for all radii
      EXPECT_NEAR(puffs[i].radius / puffs[0].radius, before[i].radius / before[0].radius, 1e-9);
  }
}

// In its own proportions the cloud is only scaled; axes that are free then follow.
TEST(Domain, OwnProportionsScale) {
  const std::vector<Puff> before = randomPuffs(20, 3);
  const Double3 own{lengthOf(coverOf(before, kX)), lengthOf(coverOf(before, kY)), lengthOf(coverOf(before, kZ))};
  for (const Double3 size : {own * 2.5, Double3{own.x * 2.5, 0, 0}, Double3{0, own.y * 2.5, own.z * 2.5}}) {
    std::vector<Puff> puffs = before;
    fitDomain(puffs, {size, {}, {}});
    for (size_t i = 0; i < puffs.size(); ++i) {
      EXPECT_NEAR(puffs[i].radius, 2.5 * before[i].radius, 1e-9);
      EXPECT_NEAR(length(puffs[i].center - puffs[0].center), 2.5 * length(before[i].center - before[0].center), 1e-8);
    }
  }
}

// With a floor the height counts from it, it stays where it is, and centres keep their height over it.
TEST(Domain, StandsOnItsFloor) {
  std::vector<Puff> puffs = randomPuffs(30, 9);
  for (Puff& p : puffs) p.center.y = std::max(p.center.y, 3 + 0.4 * p.radius);
  fitDomain(puffs, {{6, 0.7, 6}, 3.0, 0.4});
  EXPECT_NEAR(coverOf(puffs, kY).high, 3.7, 1e-9);
  for (const Puff& p : puffs) EXPECT_GE(p.center.y, 3 + 0.4 * p.radius - 1e-12);
}

// A box too thin for the spheres shrinks them until they fit.
TEST(Domain, ThinnerThanItsSpheres) {
  std::vector<Puff> puffs = randomPuffs(20, 5);
  fitDomain(puffs, {{100, 0.5, 100}, {}, {}});
  EXPECT_NEAR(lengthOf(coverOf(puffs, kX)), 100, 1e-8);
  EXPECT_NEAR(lengthOf(coverOf(puffs, kY)), 0.5, 1e-9);
}

TEST(Domain, NothingAboveTheFloor) {
  std::vector<Puff> puffs = randomPuffs(20, 5);
  EXPECT_THROW(fitDomain(puffs, {{4, 4, 4}, 100.0, {}}), InputError);
}

TEST(Domain, ShrinksAsOne) {
  const std::vector<Puff> before = randomPuffs(20, 7);
  std::vector<Puff> puffs = before;
  shrinkIntoDomain(puffs, {{1000, 1000, 0}, {}, {}});
  EXPECT_EQ(puffs[3].center, before[3].center);  // inside: nothing moves
  const double height = lengthOf(coverOf(before, kY)) / 2;
  shrinkIntoDomain(puffs, {{1000, height, 0}, {}, {}});
  EXPECT_NEAR(lengthOf(coverOf(puffs, kY)), height, 1e-9);
  EXPECT_NEAR(lengthOf(coverOf(puffs, kX)), lengthOf(coverOf(before, kX)) / 2, 1e-9);
  EXPECT_NEAR(puffs[4].radius, before[4].radius / 2, 1e-9);
}
