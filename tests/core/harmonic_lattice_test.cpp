// Light from a lattice: linear between cells, and right outside it.
#include "core/harmonic_lattice.h"

#include <gtest/gtest.h>

#include "core/harmonics.h"

namespace cloudbake {
namespace {

// Coefficients that are linear in the place, of a T that stays between 0 and 1.
HarmonicLattice linearLattice(int order) {
  HarmonicLattice lattice{{-1, 2, 0.5F}, 0.25F, {5, 3, 4}, order, 1, {}};
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 5; ++i)
        for (size_t c = 0; c < harmonicCount(order); ++c)
          lattice.coefficients.push_back(c == 0 ? 1.5F + 0.1F * float(i) - 0.2F * float(j) + 0.05F * float(k)
                                                : 0.01F * float(c) * float(i + j - k));
  return lattice;
}

TEST(HarmonicLattice, IsLinearBetweenCells) {
  for (const int order : {1, 2, 3}) {
    const HarmonicLattice lattice = linearLattice(order);
    for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{4, 2, 3}, Vec3{1.3F, 0.7F, 2.2F}, Vec3{3.99F, 1.01F, 0.5F}})
      for (const Vec3 l : {Vec3{0, 1, 0}, *normalized(Vec3{1, -2, 0.5F})}) {
        std::array<float, kMaxHarmonics> expected{};
        for (size_t c = 0; c < harmonicCount(order); ++c)
          expected[c] = c == 0 ? 1.5F + 0.1F * at.x - 0.2F * at.y + 0.05F * at.z : 0.01F * float(c) * (at.x + at.y - at.z);
        EXPECT_NEAR(latticeTransmittance(lattice, lattice.origin + at * lattice.cell_size, l),
                    harmonicTransmittance(std::span(expected).first(harmonicCount(order)), l), 1e-5);
      }
  }
}

TEST(HarmonicLattice, OutsideItIsThePlaceWhereTheWayComesIn) {
  const HarmonicLattice lattice = linearLattice(2);
  const Box box = lattice.box();
  EXPECT_EQ(box.low, (Vec3{-1, 2, 0.5F}));
  EXPECT_EQ(box.high, (Vec3{0, 2.5F, 1.25F}));
  const Vec3 up{0, 1, 0}, slanting = *normalized(Vec3{0.2F, 1, 0.1F});
  EXPECT_NEAR(latticeTransmittance(lattice, {-0.6F, -30, 0.8F}, up), latticeTransmittance(lattice, {-0.6F, 2, 0.8F}, up), 1e-5);
  const Vec3 entry{-0.6F, 2, 0.8F};
  EXPECT_NEAR(latticeTransmittance(lattice, entry - slanting * 7, slanting), latticeTransmittance(lattice, entry, slanting), 1e-4);
  EXPECT_EQ(latticeTransmittance(lattice, {-0.6F, 3, 0.8F}, up), 1) << "the light does not pass the cloud";
  EXPECT_EQ(latticeTransmittance(lattice, {5, 0, 0.8F}, up), 1);
  EXPECT_EQ(latticeTransmittance(lattice, {5, 2.2F, 0.8F}, {1, 0, 0}), 1);
  EXPECT_LT(latticeTransmittance(lattice, {5, 2.2F, 0.8F}, {-1, 0, 0}), 1);
}

}  // namespace
}  // namespace cloudbake
