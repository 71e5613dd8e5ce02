// The steps of the painted chain against plain references in double, and against what must hold for any picture.
#include "preview/mesh_clouds/paint.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "core/random.h"
#include "preview/mesh_clouds/post.h"

namespace cloudbake {
namespace {

// Clouds of any opacity and depth, with holes between them.
Image4 randomClouds(int width, int height) {
  Image4 image = filledImage4(width, height, kNoCloud);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const auto draw = [&](uint32_t what) { return uniformFloat(hashDraw(5, uint32_t(i), what)); };
    if (draw(0) < 0.3F) continue;
    image.pixels[i] = {draw(1), draw(2), draw(0) < 0.6F ? draw(3) : 1, draw(4)};
  }
  return image;
}

/// Values in double, for a reference.
struct Plane {
  int width, height;
  std::vector<double> values;
  double& at(int x, int y) { return values[size_t(y) * size_t(width) + size_t(x)]; }
};

// The mean over the part of [center − half, center + half] inside the line, pixel by pixel.
double meanAlong(int count, double center, double half, const std::function<double(int)>& value) {
  double sum = 0, length = 0;
  for (int i = 0; i < count; ++i) {
    const double part = std::min(center + half, i + 1.0) - std::max(center - half, double(i));
    if (part > 0) sum += part * value(i), length += part;
  }
  return sum / length;
}

Plane boxBlurred(Plane plane, const std::function<double(int, int)>& half) {
  Plane rows = plane;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      rows.at(x, y) = meanAlong(plane.width, x + 0.5, half(x, y), [&](int i) { return plane.at(i, y); });
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      plane.at(x, y) = meanAlong(plane.height, y + 0.5, half(x, y), [&](int j) { return rows.at(x, j); });
  return plane;
}

Plane planeOf(const Image4& image, const std::function<double(const Rgba&)>& value) {
  Plane plane{image.width, image.height, {}};
  for (const Rgba& p : image.pixels) plane.values.push_back(value(p));
  return plane;
}

TEST(Paint, SpreadDepthIsTheCoveredMeanOfASquare) {
  const Image4 image = randomClouds(23, 17);
  const Image4 spread = spreadDepth(image, 3.3F / 17);
  const auto half = [](int, int) { return 3.3; };
  Plane depth = boxBlurred(planeOf(image, [](const Rgba&p) { return double(p[2]) * p[3]; }), half),
        covered = boxBlurred(planeOf(image, [](const Rgba&p) { return double(p[2]); }), half);
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 23; ++x) {
      EXPECT_NEAR(spread.at(x, y)[3], depth.at(x, y) / covered.at(x, y), 1e-5);
      for (size_t c = 0; c < 3; ++c) EXPECT_EQ(spread.at(x, y)[c], image.at(x, y)[c]);
    }
}

TEST(Paint, DepthIsSpreadAsFarAsTheRadius) {
  Image4 image = filledImage4(40, 20, kNoCloud);
  image.at(20, 10) = {1, 1, 1, 0.25F};
  const Image4 spread = spreadDepth(image, 0.25F);  // 5 pixels
  for (int x = 0; x < 40; ++x) EXPECT_NEAR(spread.at(x, 10)[3], std::abs(x - 20) <= 5 ? 0.25 : 1, 1e-4) << x;
  EXPECT_EQ(spreadDepth(image, 0).pixels, image.pixels);
}

TEST(Paint, SoftenIsTwoBoxesOfTheDepthsWidth) {
  const Image4 image = randomClouds(31, 19);
  const SoftenSettings settings{.near_width = 0.2F, .far_width = 0.05F};
  const Image4 softened = soften(image, settings);
  const auto half = [&](int x, int y) { return std::max(0.5, 19 * (0.2 + (0.05 - 0.2) * image.at(x, y)[3])); };
  const auto blurred = [&](const std::function<double(const Rgba&)>& value) {
    return boxBlurred(boxBlurred(planeOf(image, value), half), half);
  };
  Plane red = blurred([](const Rgba&p) { return double(p[0]) * p[2]; }), green = blurred([](const Rgba&p) { return double(p[1]) * p[2]; }),
        opacity = blurred([](const Rgba&p) { return double(p[2]); });
  for (int y = 0; y < 19; ++y)
    for (int x = 0; x < 31; ++x) {
      const Rgba& p = softened.at(x, y);
      ASSERT_NEAR(p[0], red.at(x, y) / opacity.at(x, y), 1e-4);
      ASSERT_NEAR(p[1], green.at(x, y) / opacity.at(x, y), 1e-4);
      ASSERT_NEAR(p[2], opacity.at(x, y), 1e-5);
      ASSERT_EQ(p[3], image.at(x, y)[3]);
    }
}

TEST(Paint, SoftenKeepsWhatIsEvenAndWhatIsEmpty) {
  const Image4 even = filledImage4(20, 12, {0.25F, 0.5F, 1, 0.5F}), empty = filledImage4(20, 12, kNoCloud);
  for (const Rgba& p : soften(even, {.near_width = 0.3F}).pixels)
    for (size_t c = 0; c < 4; ++c) EXPECT_NEAR(p[c], even.pixels[0][c], 1e-5);
  EXPECT_EQ(soften(empty, {.near_width = 0.3F}).pixels, empty.pixels);
  // A width under a pixel changes nothing.
  const Image4 image = randomClouds(20, 12), same = soften(image, {.near_width = 0, .far_width = 0});
  for (size_t i = 0; i < image.pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(same.pixels[i][c], image.pixels[i][2] > 0 ? image.pixels[i][c] : 0, 1e-4);
}

// A plane across the view at the distance 4 that is half opaque everywhere.
const Camera kPlaneCamera{{0, 0, 4}, {0, 0, 0}, 40, 64, 48};
constexpr DepthRange kRange{2, 6};

TEST(Paint, ErosionTakesOpacityFromRimsAlone) {
  Image4 image = filledImage4(64, 48, {0.8F, 0.6F, 0.5F, 0.5F});
  for (int x = 0; x < 64; ++x) image.at(x, 0) = {0.8F, 0.6F, 1, 0.5F}, image.at(x, 1) = {0.8F, 0.6F, 0, 0.5F};
  const Image4 eroded = erode(image, kPlaneCamera, kRange, {{}, 0.3F}, {.shrink = 0.7F, .darkening = 0.4F});
  float least = 1, most = 0;
  int worn = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const Rgba &before = image.at(x, y), &after = eroded.at(x, y);
      if (y < 2) {
        EXPECT_EQ(after, before);
        continue;
      }
      EXPECT_LE(after[2], before[2]);
      EXPECT_LE(after[0], before[0]);
      EXPECT_GE(after[0], before[0] * (1 - 0.4F));
      EXPECT_NEAR(after[1] / before[1], after[0] / before[0], 1e-5);
      EXPECT_EQ(after[3], before[3]);
      least = std::min(least, after[2]), most = std::max(most, after[2]);
      worn += after[2] < 0.4F;
    }
  EXPECT_EQ(least, 0) << "holes";
  EXPECT_GT(worn, 64 * 48 / 2) << "everywhere";
  EXPECT_GT(most, 0.45F);
  EXPECT_EQ(erode(image, kPlaneCamera, kRange, {{}, 0.3F}, {.shrink = 0, .darkening = 0}).pixels, image.pixels);
}

// The camera moves to the right by three pixels of the plane: its picture moves to the left by three.
// A step looks only at the box around the clouds. It reaches far enough: specks in the corners, which make the box the whole picture,
// change nothing about a cloud in the middle.
TEST(Paint, StepsReachAsFarAsTheyChangeSomething) {
  const auto withSpecks = [](bool specks) {
    Image4 image = filledImage4(96, 80, kNoCloud);
    for (int y = 35; y < 43; ++y)
      for (int x = 44; x < 50; ++x) image.at(x, y) = {0.7F, 0.4F, 0.9F, 0.2F};
    if (specks) image.at(0, 0) = image.at(95, 79) = {1, 1, 1, 0.5F};
    return image;
  };
  const std::function<Image4(const Image4&)> steps[] = {
      [](const Image4& image) { return spreadDepth(image, 0.1F); },
      [](const Image4& image) { return soften(image, {.near_width = 0.02F, .far_width = 0.08F}); },
      [](const Image4& image) { return distort(image, {.tile_size = 0.2F, .swirl_strength = 0.1F, .time_seconds = 7}); }};
  for (const auto& step : steps) {
    const Image4 small = step(withSpecks(false)), whole = step(withSpecks(true));
    int touched = 0;
    for (int y = 20; y < 58; ++y)
      for (int x = 24; x < 70; ++x) {
        for (size_t c = 0; c < 4; ++c) ASSERT_NEAR(small.at(x, y)[c], whole.at(x, y)[c], 2e-6) << &step - steps << ' ' << x << ' ' << y;
        touched += small.at(x, y) != kNoCloud;
      }
    EXPECT_GT(touched, 8 * 6);
    EXPECT_EQ(small.at(20, 16), kNoCloud);
  }
}

// Noise that is too fine for the pixels would be bristles and dots: far away, or where the depth falls steeply in either direction.
TEST(Paint, TheNoiseFadesWhereItsCellsAreTooSmall) {
  const auto spread = [](float slope_x, float slope_y, float size) {
    Image4 image = filledImage4(64, 48, {0.5F, 0.5F, 0.6F, 0});
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) image.at(x, y)[3] = 0.5F + slope_x * float(x - 32) + slope_y * float(y - 24);
    const Image4 worn = erode(image, kPlaneCamera, kRange, {{}, size}, {});
    float least = 1, most = 0;
    for (const Rgba& p : worn.pixels) least = std::min(least, p[2]), most = std::max(most, p[2]);
    return most - least;
  };
  EXPECT_GT(spread(0, 0, 0.3F), 0.3F);
  const float steep = 0.6F * 0.3F / (kRange.far - kRange.near);  // 0.6 cells per pixel
  EXPECT_LT(spread(steep, 0, 0.3F), 1e-3F);
  EXPECT_LT(spread(0, steep, 0.3F), 1e-3F);
  EXPECT_LT(spread(0, 0, 0.001F), 1e-5F);
}

TEST(Paint, ErosionStaysInTheWorld) {
  const Image4 image = filledImage4(64, 48, {0.8F, 0.6F, 0.5F, 0.5F});
  const float pixel = 2 * 4 * std::tan(float(20 * kPi / 180)) / 48;
  Camera moved = kPlaneCamera;
  moved.look_from.x += 3 * pixel, moved.look_at.x += 3 * pixel;
  const Image4 here = erode(image, kPlaneCamera, kRange, {{}, 0.3F}, {}), there = erode(image, moved, kRange, {{}, 0.3F}, {});
  float change = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x + 3 < 64; ++x) {
      ASSERT_NEAR(there.at(x, y)[2], here.at(x + 3, y)[2], 1e-3) << x << ' ' << y;
      change = std::max(change, std::abs(there.at(x, y)[2] - here.at(x, y)[2]));
    }
  EXPECT_GT(change, 0.05F);
  // So does the noise with its frame.
  const Image4 with_frame = erode(image, moved, kRange, {{3 * pixel, 0, 0}, 0.3F}, {});
  for (size_t i = 0; i < here.pixels.size(); ++i) ASSERT_NEAR(with_frame.pixels[i][2], here.pixels[i][2], 1e-3);
  EXPECT_NE(erode(image, kPlaneCamera, kRange, {{}, 0.3F}, {.seed = 1}).pixels, here.pixels);
  EXPECT_NE(erode(image, kPlaneCamera, kRange, {{}, 0.2F}, {}).pixels, here.pixels);
}

TEST(Paint, SameBytesForAnyNumberOfThreads) {
  const Image4 image = randomClouds(67, 45);
  const auto chain = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return erode(soften(spreadDepth(image, 0.1F), {}), kPlaneCamera, kRange, {{}, 0.2F}, {});
  };
  const Image4 one = chain(1);
  EXPECT_EQ(std::memcmp(one.pixels.data(), chain(6).pixels.data(), one.pixels.size() * sizeof(Rgba)), 0);
}

}  // namespace
}  // namespace cloudbake
