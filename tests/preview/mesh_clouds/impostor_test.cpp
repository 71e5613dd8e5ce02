// Impostors as they are drawn, on one whose texels are known: a ball.
#include "preview/mesh_clouds/impostor.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "core/lobe_lighting.h"
#include "preview/mesh_clouds/mesh_clouds.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

// A ball of radius 1 around `center`, opaque, whose lobes point down; every texel has the depth of the ball's surface.
BakedMesh ballImpostor(Vec3 center = {}) {
  ImpostorInfo info;
  info.views = 9, info.frame = 64;
  info.center = center;
  info.radius = 1.1F;
  info.box.add(center - Vec3{1, 1, 1});
  info.box.add(center + Vec3{1, 1, 1});
  info.exponent = 2;
  info.extinction = 1;
  info.thickest = 4;
  Impostor impostor = blankImpostor(info);
  for (int j = 0; j < info.views * info.frame; ++j)
    for (int i = 0; i < info.views * info.frame; ++i) {
      const auto place = [&](int at) { return (2 * (float(at % info.frame) + 0.5F) / float(info.frame) - 1) * info.radius; };
      const float x = place(i), y = -place(j), square = x * x + y * y;
      const FrameAxes axes = frameAxes(frameDirection(i / info.frame, j / info.frame, info.views));
      const Vec2 o = encodedDirection({0, -1, 0}, axes);
      const float height = std::sqrt(std::max(0.0F, 1 - square));
      impostor.lobe[0].at(i, j) = {o.x, o.y, 0.5F};  // d = 1
      impostor.rest[0].at(i, j) = {0.8F, square < 1 ? 1.0F : 0.0F, 0.5F - height / (2 * info.radius)};
    }
  addMipLevels(impostor);
  return boxWithImpostor(std::move(impostor));
}

Camera impostorCamera(Vec3 place, Vec3 target = {}) {
  Camera camera{place, target, 30};
  camera.width = 120, camera.height = 90;
  return camera;
}

Image4 drawn(const BakedMesh& mesh, const Affine& to_world, const Camera& camera) {
  const Instance instance{&mesh, to_world};
  Image4 image = filledImage4(camera.width, camera.height, kNoCloud);
  addImpostors(image, {&instance, 1}, camera, lightForSun(40, 50), {0, 20});
  return image;
}

TEST(ImpostorView, SeesABallAsABallFromEverywhere) {
  const BakedMesh ball = ballImpostor();
  for (const Vec3 to_eye : {Vec3{0, 0, 1}, Vec3{0.6F, 0.3F, -0.74F}, Vec3{0.1F, -0.99F, 0.1F}, Vec3{0, 1, 0}, Vec3{-0.7F, 0.1F, 0.7F}}) {
    const Vec3 eye = to_eye / length(to_eye) * 6;
    const ImpostorView view(*ball.impostor, eye);
    const FrameAxes axes = frameAxes(eye / 6);
    for (const float away : {0.0F, 0.3F, 0.6F, 0.8F}) {
      const Vec3 ray = axes.right * away - eye, direction = ray / length(ray);
      const ImpostorPoint seen = view.at(direction, 0.5F);
      EXPECT_NEAR(seen.opacity, 1, 0.02F) << away;
      // Where the ray meets the ball.
      const float along = -dot(eye, direction), distance = along - std::sqrt(along * along - 35);
      EXPECT_NEAR(seen.distance, distance, 0.1F) << away;  // frames are up to 30 degrees off, and their depths are corrected once
      EXPECT_GT(dot(seen.texel.lobe.direction, Vec3{0, -1, 0}), 0.999F);
      EXPECT_NEAR(seen.texel.lobe.thickness, 1, 0.01F);
      EXPECT_NEAR(seen.texel.lit, 0.8F, 0.01F);
    }
    const Vec3 past = axes.right * 1.2F - eye;
    EXPECT_LT(view.at(past / length(past), 0.5F).opacity, 0.02F);
  }
}

TEST(AddImpostors, DrawsTheFormulaAndTheDepth) {
  const BakedMesh ball = ballImpostor();
  const Image4 image = drawn(ball, {}, impostorCamera({0, 0, 6}));
  const auto [sun, sky, opacity, depth] = image.at(60, 45);
  const LightSettings light = lightForSun(40, 50);
  const TexelLobe texel{{{0, -1, 0}, 1}, 0.8F};
  EXPECT_NEAR(sun, texelLight(texel, light.sky.to_sun, 2, 1), 0.01F);
  EXPECT_NEAR(sky, texelLight(texel, {0, 1, 0}, 2, 1), 0.01F);
  EXPECT_NEAR(opacity, 1, 0.01F);
  EXPECT_NEAR(depth, 5.0F / 20, 0.003F);
  EXPECT_EQ(image.at(2, 2), kNoCloud);
}

// The same view of a turned, mirrored, stretched and moved world.
TEST(AddImpostors, FollowsTheTransform) {
  const BakedMesh ball = ballImpostor();
  Affine large;
  large.linear = {{{3, 0, 0}, {0, 3, 0}, {0, 0, 3}}};
  large.offset = {10, 0, 0};
  const Image4 plain = drawn(ball, {}, impostorCamera({0, 0, 6}));
  Image4 far = drawn(ball, large, impostorCamera({10, 0, 18}, {10, 0, 0}));
  for (size_t i = 0; i < plain.pixels.size(); ++i) {
    EXPECT_NEAR(far.pixels[i][0], plain.pixels[i][0], 2e-3F);
    EXPECT_NEAR(far.pixels[i][2], plain.pixels[i][2], 2e-3F);
  }
  Affine mirrored;
  mirrored.linear = {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 2}}};
  const Image4 stretched = drawn(ball, mirrored, impostorCamera({8, 0, 0}));
  EXPECT_NEAR(stretched.at(60, 45)[2], 1, 0.01F);
  EXPECT_NEAR(stretched.at(60 + 30, 45)[2], 1, 0.1F) << "as wide as twice the ball, 1.6 units off";
  EXPECT_EQ(stretched.at(60, 45 - 30)[2], 0) << "but no higher";
}

TEST(AddImpostors, ComposesByDepth) {
  const BakedMesh ball = ballImpostor();
  const Instance instance{&ball, {}};
  const Camera camera = impostorCamera({0, 0, 6});
  const LightSettings light = lightForSun(40, 50);
  const Rgba near{0.1F, 0.2F, 1, 0.1F}, far{0.1F, 0.2F, 1, 0.9F}, half{0.5F, 0.6F, 0.5F, 0.1F};
  for (const Rgba& before : {near, far, half}) {
    Image4 image = filledImage4(camera.width, camera.height, before);
    addImpostors(image, {&instance, 1}, camera, light, {0, 20});
    const Rgba alone = drawn(ball, {}, camera).at(60, 45), both = image.at(60, 45);
    EXPECT_NEAR(both[2], 1, 1e-3F);
    const float own = before[3] > 0.5F ? 1 : before[2] < 1 ? 0.5F : 0;  // what is seen of the ball
    for (const size_t c : {size_t(0), size_t(1), size_t(3)}) EXPECT_NEAR(both[c], before[c] * (1 - own) + alone[c] * own, 0.01F);
    EXPECT_EQ(image.at(2, 2), before);
  }
}

TEST(AddImpostors, IsNotSeenFromInsideAndHasNoLightOfLamps) {
  const BakedMesh ball = ballImpostor();
  const Image4 inside = drawn(ball, {}, impostorCamera({0, 0, 0.5F}, {0, 0, -5}));
  for (const Rgba& pixel : inside.pixels) EXPECT_EQ(pixel, kNoCloud);
  const Instance instance{&ball, {}};
  const Camera camera = impostorCamera({0, 0, 6});
  LightSettings light = lightForSun(40, 50);
  light.shown = ShownLight::kLampsRedGreen;
  Image4 image = filledImage4(camera.width, camera.height, kNoCloud);
  addImpostors(image, {&instance, 1}, camera, light, {0, 20});
  EXPECT_EQ(image.at(60, 45)[0], 0);
  EXPECT_NEAR(image.at(60, 45)[2], 1, 0.01F);
}

TEST(AddImpostors, HasTheSameBitsForAnyNumberOfThreads) {
  const BakedMesh ball = ballImpostor();
  const Image4 many = drawn(ball, {}, impostorCamera({3, 2, 5}));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many.pixels, drawn(ball, {}, impostorCamera({3, 2, 5})).pixels);
}

// In all looks, beside a mesh.
TEST(MeshClouds, DrawImpostorsAndMeshes) {
  const BakedMesh ball = ballImpostor({2, 0, 0}), mesh = bakedBall(1, {-2, 0, 0}, 3);
  const Instance instances[] = {{&ball, {}}, {&mesh, {}}};
  const Camera camera = impostorCamera({0, 0, 12});
  for (const PostSettings& post : {PostSettings{}, publishedPost()}) {
    const auto steps = drawMeshClouds(instances, camera, lightForSun(40, 50), post);
    const Image4& first = steps.front().channels;
    const int width = first.width, height = first.height;
    EXPECT_NEAR(first.at(width * 81 / 120, height / 2)[2], 1, 0.05F) << "the impostor";
    EXPECT_NEAR(first.at(width * 39 / 120, height / 2)[2], 1, 0.05F) << "the mesh";
    EXPECT_EQ(first.at(width / 2, height / 2)[2], 0);
  }
}

}  // namespace
}  // namespace cloudbake
