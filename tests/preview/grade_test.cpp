// The image pass against its formulas: blur along the camera's way, vignette, contrast, gamma.
#include "preview/grade.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "core/random.h"

namespace cloudbake {
namespace {

Image randomImage(int width, int height) {
  Image image = blankImage(width, height);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const auto draw = [i](uint32_t what) { return 3 * uniformFloat(hashDraw(3, uint32_t(i), what)); };
    image.pixels[i] = {draw(0), draw(1), draw(2)};
  }
  return image;
}

bool sameBytes(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Vec3)) == 0;
}

Velocities uniformVelocities(int width, int height, Vec2 velocity) {
  return {width, height, std::vector<Vec2>(size_t(width) * size_t(height), velocity)};
}

std::vector<float> someDistances(int width, int height) {
  std::vector<float> distances;
  for (int i = 0; i < width * height; ++i) distances.push_back(i % 5 == 0 ? INFINITY : 1 + 100 * uniformFloat(hashDraw(4, uint32_t(i), 0)));
  return distances;
}

TEST(Grade, StillCameraChangesNothing) {
  const Camera camera{{1000, 20, 3}, {1003, 21, -5}, 37, 31, 17, 0.17F};
  const Velocities still = cameraVelocity(camera, camera, someDistances(31, 17));
  for (const Vec2 velocity : still.pixels) ASSERT_EQ(velocity, Vec2{});
  const Image image = randomImage(31, 17);
  EXPECT_TRUE(sameBytes(motionBlur(image, still), image));
}

// A point at a known place before the previous camera and before the present one.
TEST(Grade, VelocityIsThePresentPlaceLessTheFormerOne) {
  const Camera now{{0, 0, 0}, {0, 0, -1}, 90, 40, 20, 0}, aside{{-1, 0, 0}, {-1, 0, -1}, 90, 40, 20, 0};
  const std::vector<float> distances(800, 10);
  const Velocities velocities = cameraVelocity(now, aside, distances);
  for (const Vec2 place : {Vec2{3, 4}, Vec2{20, 10}, Vec2{39, 19}}) {
    const Vec3 point = cameraRay(now, place.x + 0.5F, place.y + 0.5F).direction * 10;
    // Half the height is 1 at depth 1; the picture is two heights wide. The camera went right by 1: things go left.
    const Vec2 velocity = velocities.pixels[size_t(place.y) * 40 + size_t(place.x)];
    EXPECT_NEAR(velocity.x, -1 / -point.z / 2 / 2, 1e-6);
    EXPECT_NEAR(velocity.y, 0, 1e-6);
  }
  // Up by 1: things go down, y grows.
  const Camera below{{0, -1, 0}, {0, -1, -1}, 90, 40, 20, 0};
  EXPECT_NEAR(cameraVelocity(now, below, distances).pixels[10 * 40 + 20].y, 0.05, 1e-3);
  // At infinity moving aside does nothing; a turn by the angle a moves the centre by tan(a), whatever the distance.
  const std::vector<float> far(800, INFINITY);
  for (const Vec2 velocity : cameraVelocity(now, aside, far).pixels) ASSERT_LT(std::abs(velocity.x) + std::abs(velocity.y), 1e-7F);
  const Camera turned{{0, 0, 0}, {0.1F, 0, -1}, 90, 40, 20, 0};
  // The ray through the centre (20, 10), between pixels; the place of pixel (20, 10) is off by half a pixel.
  const double per_pixel = 2.0 / 20, x = 0.5 * per_pixel, norm = std::sqrt(1.01);
  const double before = (x / norm - 0.1 / norm) / ((x * 0.1 + 1) / norm);
  for (const auto& field : {far, distances}) EXPECT_NEAR(cameraVelocity(now, turned, field).pixels[10 * 40 + 20].x, (x - before) / 4, 1e-5);
  // A roll turns the picture about its centre.
  const Velocities rolled = cameraVelocity({now.look_from, now.look_at, 90, 40, 20, 0.1F}, now, far);
  const double dx = 19.5, dy = 9.5, c = std::cos(0.1), s = std::sin(0.1);
  EXPECT_NEAR(rolled.pixels.back().x, (dx - (dx * c - dy * s)) / 40, 1e-5);
  EXPECT_NEAR(rolled.pixels.back().y, (dy - (dx * s + dy * c)) / 20, 1e-5);
  // What lay behind the former camera stands still.
  const Camera passed{{0, 0, -20}, {0, 0, -21}, 90, 40, 20, 0};
  for (const Vec2 velocity : cameraVelocity(now, passed, distances).pixels) ASSERT_EQ(velocity, Vec2{});
  EXPECT_THROW(cameraVelocity(now, aside, std::vector<float>(799)), std::invalid_argument);
  EXPECT_THROW(cameraVelocity(now, Camera{{0, 0, 0}, {0, 0, -1}, 90, 20, 40}, distances), std::invalid_argument);
}

TEST(Grade, PanDrawsAPointOutAlongThePan) {
  Image image = blankImage(100, 40);
  image.at(50, 20) = {1, 2, 3};
  // Over 31 pixels to the right and 0 down: 32 taps, one per pixel.
  const Image blurred = motionBlur(image, uniformVelocities(100, 40, {0.31F, 0}), {.limit = 0.5F});
  for (int x = 0; x < 100; ++x) {
    const bool inside = x >= 50 && x <= 81;
    EXPECT_NEAR(blurred.at(x, 20).y, inside ? 2.0 / 32 : 0, 1e-3) << x;
    EXPECT_EQ(blurred.at(x, 19), Vec3{});
  }
  // Clamped to a quarter of the picture.
  const Image clamped = motionBlur(image, uniformVelocities(100, 40, {-3, 0}));
  for (int x = 0; x < 100; ++x) EXPECT_EQ(clamped.at(x, 20).x > 1e-3F, x >= 25 && x <= 50) << x;
  const Image down = motionBlur(image, uniformVelocities(100, 40, {0, 0.2F}));
  double moment = 0, total = 0;
  for (int y = 0; y < 40; ++y) moment += y * down.at(50, y).z, total += down.at(50, y).z;
  EXPECT_NEAR(moment / total, 20 + 0.5 * 0.2 * 40, 0.1);
  EXPECT_NEAR(total, 3, 0.15);
  // Even ground stays even, also at the border.
  Image even = blankImage(30, 20);
  for (Vec3& pixel : even.pixels) pixel = {0.25F, 0.5F, 0.75F};
  for (const Vec3 pixel : motionBlur(even, uniformVelocities(30, 20, {0.2F, -0.1F})).pixels)
    ASSERT_LT(length(pixel - Vec3{0.25F, 0.5F, 0.75F}), 1e-6F);
  EXPECT_THROW(motionBlur(even, uniformVelocities(20, 30, {})), std::invalid_argument);
}

TEST(Grade, TapsAreThirtyTwo) {
  // At v = 31 pixels of a ramp the mean is the ramp 15.5 pixels back; with two taps as well, so count the distinct places on one bright
  // pixel.
  EXPECT_EQ(MotionBlurSettings{}.taps, 32);
  EXPECT_EQ(MotionBlurSettings{}.limit, 0.25F);
  Image image = blankImage(400, 1);
  image.at(200, 0) = {1, 1, 1};
  const Image blurred = motionBlur(image, uniformVelocities(400, 1, {0.155F, 0}));  // 62 pixels: every other one
  int lit = 0;
  for (int x = 0; x < 400; ++x) lit += blurred.at(x, 0).x > 0.5F / 32;
  EXPECT_EQ(lit, 32);
  EXPECT_TRUE(sameBytes(motionBlur(image, uniformVelocities(400, 1, {0.1F, 0}), {.taps = 1}), image));
}

TEST(Grade, VignetteIsOneInTheCentreAndHalfInTheCorners) {
  EXPECT_EQ(vignetteFactor(0.5F, 0.5F), 1);
  for (const float u : {0.0F, 1.0F})
    for (const float v : {0.0F, 0.3F, 1.0F}) {
      EXPECT_EQ(vignetteFactor(u, v), 0.5F);
      EXPECT_EQ(vignetteFactor(v, u), 0.5F);
    }
  EXPECT_NEAR(vignetteFactor(0.25F, 0.5F), 0.5 + 0.5 * std::pow(0.75, 0.1), 1e-6);
  EXPECT_NEAR(vignetteFactor(0.9F, 0.2F), 0.5 + 0.5 * std::pow(16 * 0.9 * 0.1 * 0.2 * 0.8, 0.1), 1e-6);
  Image white = blankImage(5, 3);
  for (Vec3& pixel : white.pixels) pixel = {1, 2, 3};
  const Image darkened = vignette(white);
  EXPECT_EQ(darkened.at(2, 1), (Vec3{1, 2, 3}));
  EXPECT_NEAR(darkened.at(0, 0).y, 2 * vignetteFactor(0.1F, 1.0F / 6), 1e-6);
  EXPECT_NEAR(darkened.at(4, 1).x, vignetteFactor(0.9F, 0.5F), 1e-6);
}

TEST(Grade, ContrastIsTheFormula) {
  EXPECT_EQ(contrastColor({0, 0, 0}), (Vec3{0, 0, 0.04F}));
  const Vec3 middle = contrastColor({0.5F, 0.5F, 0.5F}), top = contrastColor({1, 1, 1});
  EXPECT_NEAR(middle.x, 0.5, 1e-6);
  EXPECT_NEAR(middle.z, 0.54, 1e-6);
  EXPECT_NEAR(top.y, 1, 1e-6);
  EXPECT_NEAR(top.z, 1.04, 1e-6);
  const double c = 0.2;
  EXPECT_NEAR(contrastColor({0.2F, 0, 0}).x, 0.6 * c + 0.4 * c * c * (3 - 2 * c), 1e-6);
  // Beyond the display's range: its ends.
  EXPECT_EQ(contrastColor({7, -3, 2}), contrastColor({1, 0, 1}));
  const Image image = randomImage(7, 5);
  EXPECT_EQ(contrast(image).at(3, 2), contrastColor(image.at(3, 2)));
}

TEST(Grade, GammaIsTheRoot) {
  Image image = blankImage(2, 1);
  image.at(0, 0) = {0.25F, 4, 0};
  image.at(1, 0) = {-1, 0.01F, 1};
  const Image result = gammaBySqrt(image);
  EXPECT_EQ(result.at(0, 0), (Vec3{0.5F, 2, 0}));
  EXPECT_EQ(result.at(1, 0), (Vec3{0, 0.1F, 1}));
}

TEST(Grade, IsFiniteAndTheSameForAnyNumberOfThreads) {
  const Camera now{{0, 5, 0}, {3, 4, -9}, 37, 53, 29, 0.1F}, before{{0.1F, 5, 0.4F}, {3, 4.2F, -9}, 37, 53, 29, 0.12F};
  const Image image = randomImage(53, 29);
  std::vector<float> distances = someDistances(53, 29);
  distances[7] = 0;
  distances[8] = 3e38F;
  const auto graded = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return contrast(vignette(motionBlur(gammaBySqrt(image), cameraVelocity(now, before, distances))));
  };
  const Image one = graded(1);
  for (const Vec3 pixel : one.pixels) ASSERT_TRUE(isFinite(pixel));
  EXPECT_FALSE(sameBytes(one, contrast(vignette(gammaBySqrt(image)))));
  EXPECT_TRUE(sameBytes(one, graded(7)));
}

}  // namespace
}  // namespace cloudbake
