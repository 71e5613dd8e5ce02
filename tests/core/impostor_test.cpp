// The directions, axes and codes of lobe impostors.
#include "core/impostor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/lobe_lighting.h"

namespace cloudbake {
namespace {

// Directions in all octants, on axes and near the folds of the map.
std::vector<Vec3> directions() {
  std::vector<Vec3> all{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < 400; ++i) {
    const float y = 1 - (2 * float(i) + 1) / 400, around = 2.399963F * float(i), flat = std::sqrt(1 - y * y);
    all.push_back({flat * std::cos(around), y, flat * std::sin(around)});
  }
  return all;
}

TEST(Impostor, FramesAreSeenFromTheirOwnDirections) {
  for (const int views : {2, 5, 8})
    for (int i = 0; i < views; ++i)
      for (int j = 0; j < views; ++j) {
        Vec3 sum;
        for (const auto& [u, v, weight] : framesAround(frameDirection(i, j, views), views)) sum += frameDirection(u, v, views) * weight;
        EXPECT_LT(length(sum - frameDirection(i, j, views)), 1e-5F) << i << ", " << j << " of " << views;
      }
  EXPECT_LT(length(frameDirection(2, 2, 5) - Vec3{0, 1, 0}), 1e-6F);
  EXPECT_LT(length(frameDirection(0, 0, 5) - Vec3{0, -1, 0}), 1e-6F);
  EXPECT_LT(length(frameDirection(4, 2, 5) - Vec3{1, 0, 0}), 1e-6F);
}

TEST(Impostor, ThreeFramesAroundADirectionAreNearItAndCountAsOne) {
  for (const Vec3 d : directions()) {
    float sum = 0;
    for (const auto& [i, j, weight] : framesAround(d, 9)) {
      EXPECT_GE(weight, 0);
      EXPECT_TRUE(i >= 0 && i < 9 && j >= 0 && j < 9);
      sum += weight;
      if (weight > 0.01F) {
        EXPECT_GT(dot(frameDirection(i, j, 9), d), std::cos(0.6F));  // 34 degrees
      }
    }
    EXPECT_NEAR(sum, 1, 1e-5F);
  }
}

TEST(Impostor, AxesAreAnOrthonormalRightHandedFrame) {
  for (const Vec3 d : directions()) {
    const FrameAxes axes = frameAxes(d);
    EXPECT_NEAR(length(axes.right), 1, 1e-5F);
    EXPECT_NEAR(length(axes.up), 1, 1e-5F);
    EXPECT_NEAR(dot(axes.right, d), 0, 1e-5F);
    EXPECT_LT(length(cross(axes.right, axes.up) - d), 1e-5F);
    EXPECT_GE(axes.up.y, -1e-6F) << "the picture is upright";
  }
}

TEST(Impostor, DirectionsComeBackFromTheirCode) {
  for (const Vec3 eye : {Vec3{0, 0, 1}, Vec3{0, 1, 0}, Vec3{0.6F, -0.48F, 0.64F}}) {
    const FrameAxes axes = frameAxes(eye);
    for (const Vec3 d : directions()) {
      const Vec2 code = encodedDirection(d, axes);
      EXPECT_TRUE(code.x >= 0 && code.x <= 1 && code.y >= 0 && code.y <= 1);
      EXPECT_LT(length(decodedDirection(code, axes) - d), 1e-5F);
    }
    EXPECT_NEAR(encodedDirection(-eye, axes).x, 0.5F, 1e-6F) << "the middle is away from the eye";
  }
}

TEST(Impostor, ATexelShowsTheLobeFormulaWithABiasOfItsOwn) {
  const TexelLobe texel{{{0, 0, -1}, 2}, 0.7F};
  const float extinction = 1.5F, bias = -std::log(texel.lit) / extinction;
  for (const Vec3 l : directions())
    EXPECT_NEAR(texelLight(texel, l, 2.5F, extinction), lobeTransmittance(texel.lobe, l, {2.5F, bias}, extinction), 1e-6F);
}

TEST(Impostor, MipLevelsAreMeansAndEndAtSmallFrames) {
  ImpostorInfo info;
  info.views = 2, info.frame = 16;
  Impostor impostor = blankImpostor(info);
  for (size_t i = 0; i < impostor.rest[0].pixels.size(); ++i) impostor.rest[0].pixels[i] = {float(i % 7), float(i % 5), float(i % 3)};
  addMipLevels(impostor);
  ASSERT_EQ(impostor.rest.size(), 3U);
  EXPECT_EQ(impostor.rest[2].width, 2 * kLeastFrame);
  Vec3 fine, coarse;
  for (const Vec3& p : impostor.rest[0].pixels) fine += p / float(impostor.rest[0].pixels.size());
  for (const Vec3& p : impostor.rest[2].pixels) coarse += p / float(impostor.rest[2].pixels.size());
  EXPECT_LT(length(fine - coarse), 1e-3F);
}

}  // namespace
}  // namespace cloudbake
