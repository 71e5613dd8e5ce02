#include "core/lobe_packing.h"

#include <gtest/gtest.h>

using namespace cloudbake;

namespace {
const Affine kMaps[] = {
    {},
    {{{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}}, {1, 2, 3}},
    {{{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 0}},          // mirrored
    {{{{0.5, 0.25, 0}, {0, 3, 0.5}, {-1, 0, 1.5}}}, {9, 9, 9}}  // sheared, non-uniform
};
}

TEST(LobePacking, RoundTripsUnderEveryMap) {
  for (const Affine& to_scene : kMaps) {
    const Lobe lobe{*normalized({0.3F, -0.8F, 0.5F}), 1.75F};
    const Lobe back = unpackLobe(packLobe(lobe, *inverted(to_scene)), to_scene);
    EXPECT_LT(angleDegrees(back.direction, lobe.direction), 1e-4);
    EXPECT_NEAR(back.thickness, lobe.thickness, 1e-6 * lobe.thickness);
  }
}

// Without thickness there is no vector o·d; the direction alone must survive.
TEST(LobePacking, KeepsTheDirectionOfAThinVertex) {
  for (const Affine& to_scene : kMaps) {
    const Lobe lobe{*normalized({-0.6F, 0.1F, 0.7F}), 0};
    const Lobe back = unpackLobe(packLobe(lobe, *inverted(to_scene)), to_scene);
    EXPECT_LT(angleDegrees(back.direction, lobe.direction), 1e-4);
    EXPECT_EQ(back.thickness, 0);
  }
}

// A chord from p to q maps to the chord between the mapped points: v is a difference of points.
TEST(LobePacking, TransformsLikeAChord) {
  const Vec3 p{1, 2, 3}, q{2, 0, 4};
  for (const Affine& to_scene : kMaps) {
    const Vec3 chord = transformPoint(to_scene, q) - transformPoint(to_scene, p);
    const LobeUvs uvs = packLobe({*normalized(chord), length(chord)}, *inverted(to_scene));
    const Vec3 stored = Vec3{uvs.first.x, uvs.first.y, uvs.second.x} * uvs.second.y;
    EXPECT_NEAR(length(stored - (q - p)), 0, 1e-5);
  }
}
