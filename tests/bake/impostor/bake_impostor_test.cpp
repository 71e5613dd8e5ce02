// Texels of impostors against what is known of a ball.
#include "bake/impostor/bake_impostor.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "bake/field/coverage.h"
#include "bake/lobe/sweep.h"
#include "core/lobe_lighting.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

constexpr float kExtinction = 1.3F;

ImpostorInfo infoOfBall() {
  ImpostorInfo info;
  info.views = 3, info.frame = 17;  // the middle texel's rays pass near the centre
  info.radius = 1.2F;
  info.extinction = kExtinction;
  return info;
}

std::vector<float> ones(std::span<const Vec3> axes) { return std::vector<float>(2 * axes.size(), 1.0F); }

// The texel in the middle of a frame.
size_t middleOf(const SeenTexels& seen, const ImpostorInfo& info, int i, int j) {
  const auto row = uint32_t(info.views * info.frame);
  const uint32_t wanted = uint32_t(j * info.frame + info.frame / 2) * row + uint32_t(i * info.frame + info.frame / 2);
  return size_t(std::find(seen.texels.begin(), seen.texels.end(), wanted) - seen.texels.begin());
}

// Straight through a ball of radius 1: opacity 1 − e^{−2σ}; light from the eye is weakened by the way that the view takes, from behind by
// the rest of the chord, from the side by a chord that is nearly 1 where most is seen.
TEST(SeenOfVolume, IsThatOfABall) {
  const ImpostorInfo info = infoOfBall();
  const CoverageField field = *coverageFromMesh(bakedBall(1, {}, 6).surface, {{0, 0, 0}, 0.02});
  const SweepField swept(field);
  const Vec3 axis = frameDirection(1, 1, info.views);  // from above
  const SeenTexels seen = seenOfVolume(info, 4, 1, {swept, {}, 4, 16}, {&axis, 1});
  const size_t middle = middleOf(seen, info, 1, 1);
  ASSERT_LT(middle, seen.texels.size());
  const float s = kExtinction, opacity = 1 - std::exp(-2 * s);
  EXPECT_NEAR(seen.opacity[middle], opacity, 0.01F);
  EXPECT_NEAR(seen.light[2 * middle], (1 - std::exp(-4 * s)) / (2 * opacity), 0.01F) << "from the eye";
  EXPECT_NEAR(seen.light[2 * middle + 1], std::exp(-2 * s) * 2 * s / opacity, 0.01F) << "from behind";
  // The mean way into the ball, from where the ball of the frame begins, 0.2 before.
  const float way = 1 / s - 2 * std::exp(-2 * s) / opacity;
  EXPECT_NEAR(seen.depth[middle], (0.2F + way) / (2 * info.radius), 0.01F);
  const float share = float(seen.texels.size()) / float(info.frame * info.frame);
  EXPECT_NEAR(share, kPi / 4 / (1.2F * 1.2F), 0.08F) << "of the frame's square";
}

TEST(SeenOfMesh, IsItsLobesWhereTheEyeMeetsThem) {
  const ImpostorInfo info = infoOfBall();
  BakedMesh ball = bakedBall(1, {}, 5);
  const std::vector<Vec3> axes = sweepAxes(8);
  for (const float half_lambert : {1.0F, 0.3F}) {
    const SeenTexels seen = seenOfMesh(info, 4, 1, MeshFrames(ball, half_lambert, info), axes);
    const size_t middle = middleOf(seen, info, 1, 1);
    ASSERT_LT(middle, seen.texels.size());
    EXPECT_EQ(seen.opacity[middle], 1);
    EXPECT_NEAR(seen.depth[middle], 0.2F / 2.4F, 0.005F);
    const std::vector<Vec3> lights = bothSenses(axes);
    for (size_t l = 0; l < lights.size(); ++l) {
      const float wanted = lobeTransmittance({{0, -1, 0}, ball.lobes[0].thickness}, lights[l], ball.info.shape, kExtinction) *
                           surfaceFactor({0, 1, 0}, lights[l], half_lambert);
      EXPECT_NEAR(seen.light[middle * lights.size() + l], wanted, 0.02F);
    }
  }
}

TEST(SeenTexels, AreTheSameForAnyNumberOfThreads) {
  const ImpostorInfo info = infoOfBall();
  const CoverageField field = *coverageFromMesh(bakedBall(1, {}, 4).surface, {{0, 0, 0}, 0.05});
  const SweepField swept(field);
  const std::vector<Vec3> axes = sweepAxes(12);
  const auto all = [&] { return seenOfVolume(info, 0, 9, {swept, {}, 4}, axes); };
  const SeenTexels many = all();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SeenTexels few = all();
  EXPECT_EQ(many.texels, few.texels);
  EXPECT_EQ(many.light, few.light);
  EXPECT_EQ(many.depth, few.depth);
}

TEST(FitTexels, FindsLobesThatExplainTheLight) {
  const std::vector<Vec3> axes = sweepAxes(60), lights = bothSenses(axes);
  const std::vector<float> weights = ones(axes);
  const std::vector<TexelLobe> texels{{{{0, -1, 0}, 3}, 0.9F}, {{{0.6F, 0, -0.8F}, 1}, 0.5F}, {{{0, 0, 1}, 6}, 0.7F}};
  std::vector<float> light;
  for (const TexelLobe& texel : texels)
    for (const Vec3& l : lights) light.push_back(texelLight(texel, l, 2.5F, kExtinction));
  const std::vector<TexelLobe> fitted = fitTexels(light, {axes, weights}, 2.5F, kExtinction);
  SeenTexels seen;
  seen.texels = {0, 1, 2}, seen.opacity = {1, 1, 1}, seen.light = light;
  TexelError error;
  addTexelError(seen, {axes, weights}, error, [&](size_t t, size_t l) { return texelLight(fitted[t], lights[l], 2.5F, kExtinction); });
  EXPECT_LT(error.rms(), 0.01);
  for (size_t t = 0; t < texels.size(); ++t) EXPECT_GT(dot(fitted[t].lobe.direction, texels[t].lobe.direction), 0.995F) << t;
}

TEST(SixWay, IsExactForLightOfItsOwnForm) {
  const ImpostorInfo info = infoOfBall();
  const std::vector<Vec3> axes = sweepAxes(40), lights = bothSenses(axes);
  const std::vector<float> weights = ones(axes), maps{0.1F, 0.9F, 0.5F, 0.3F, 0.2F, 0.7F};
  SeenTexels seen;
  seen.texels = {uint32_t(info.frame / 2)};
  seen.opacity = {1};
  const FrameAxes frame = axesOfTexel(info, seen.texels[0]);
  for (const Vec3& l : lights) seen.light.push_back(sixWayLight(maps, inView(frame, l)));
  const std::vector<float> found = fitSixWay(seen, info, {axes, weights});
  for (size_t i = 0; i < maps.size(); ++i) EXPECT_NEAR(found[i], maps[i], 0.5F / 255 + 1e-4F) << i;
}

TEST(BallAround, IsTheSmallestOne) {
  std::vector<Vec3> points{{-1, 0, 0}, {1, 0, 0}, {0, 0.5F, 0}, {0, 0, -0.9F}};
  const auto [center, radius] = ballAround(points);
  EXPECT_LT(length(center), 0.01F);
  EXPECT_NEAR(radius, 1, 0.01F);
  for (const Vec3& p : points) EXPECT_LE(length(p - center), radius);
}

TEST(StoreTexels, KeepsLobesWithinAStepAndFillsWhatIsEmpty) {
  ImpostorInfo info = infoOfBall();
  info.views = 2, info.frame = 8;
  info.thickest = 4;
  Impostor impostor = blankImpostor(info);
  SeenTexels seen;
  seen.texels = {3 + 3 * 16};
  seen.opacity = {0.5F};
  seen.depth = {0.25F};
  const std::vector<TexelLobe> lobes{{{{0.6F, -0.8F, 0}, 1}, 0.8F}};
  storeTexels(seen, lobes, impostor);
  fillEmptyTexels(impostor);
  const TexelLobe stored = storedTexel(impostor, seen.texels[0]);
  EXPECT_GT(dot(stored.lobe.direction, lobes[0].lobe.direction), std::cos(0.02F));
  EXPECT_NEAR(stored.lobe.thickness, 1, 0.01F);
  EXPECT_NEAR(stored.lit, 0.8F, 0.003F);
  EXPECT_EQ(impostor.rest[0].at(0, 0).y, 0);
  EXPECT_EQ(impostor.lobe[0].at(0, 0).x, impostor.lobe[0].at(3, 3).x) << "filled from the only texel of the frame";
  EXPECT_EQ(impostor.rest[0].at(0, 0).z, impostor.rest[0].at(3, 3).z);
}

}  // namespace
}  // namespace cloudbake
