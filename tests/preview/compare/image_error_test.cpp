// Figures computed by hand, and identities.
#include "preview/compare/image_error.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <stdexcept>

#include "core/random.h"

namespace cloudbake {
namespace {

Image greyImage(int width, int height, float value) {
  Image image = blankImage(width, height);
  for (Vec3& p : image.pixels) p = Vec3{value, value, value};
  return image;
}

Image noise(int width, int height, uint64_t seed) {
  Image image = blankImage(width, height);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const auto draw = [&](uint32_t channel) { return uniformFloat(hashDraw(mix64(seed), uint32_t(i), channel)); };
    image.pixels[i] = {draw(0), draw(1), draw(2)};
  }
  return image;
}

TEST(ImageError, RmsAndPsnrByHand) {
  const Image a{2, 1, {{0, 0, 0}, {1, 1, 1}}}, b{2, 1, {{0.5F, 0.5F, 0.5F}, {1, 1, 1}}}, c{2, 1, {{0.6F, 0, 0}, {1, 1, 1}}};
  EXPECT_NEAR(imageRms(a, b), 0.353553, 1e-6);         // √(0.25/2)
  EXPECT_NEAR(imageRms(a, c), 0.244949, 1e-6);         // √(0.36/6)
  EXPECT_NEAR(imagePsnr(a, b), 9.0309, 1e-4);          // 20 log₁₀ √8
  EXPECT_NEAR(imagePsnr(a, b, {}, 2), 15.0515, 1e-4);  // + 20 log₁₀ 2
  EXPECT_EQ(imageRms(a, b), imageRms(b, a));
  EXPECT_EQ(imageRms(a, a), 0);
  EXPECT_EQ(imagePsnr(a, a), INFINITY);
}

TEST(ImageError, OnlyPixelsOfTheMaskCount) {
  const Image a{2, 1, {{0, 0, 0}, {1, 1, 1}}}, b{2, 1, {{0.5F, 0.5F, 0.5F}, {1, 1, 1}}};
  EXPECT_NEAR(imageRms(a, b, PixelMask{1, 0}), 0.5, 1e-6);
  EXPECT_NEAR(imagePsnr(a, b, PixelMask{1, 0}), 6.0206, 1e-4);
  EXPECT_EQ(imageRms(a, b, PixelMask{0, 1}), 0);
  EXPECT_EQ(imageRms(a, b, PixelMask{0, 0}), 0);
  EXPECT_EQ(imageSsim(a, b, PixelMask{0, 0}), 1);

  // Two pictures that differ in the left half alone; windows reach five pixels far.
  Image left = noise(40, 20, 1), changed = left;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) changed.at(x, y) = Vec3{1, 1, 1} - changed.at(x, y);
  PixelMask mask(800, 0);
  for (int y = 0; y < 20; ++y)
    for (int x = 25; x < 40; ++x) mask[size_t(y * 40 + x)] = 1;
  EXPECT_NEAR(imageSsim(left, changed, mask), 1, 1e-12);
  mask[10 * 40 + 24] = 1;
  EXPECT_LT(imageSsim(left, changed, mask), 1 - 1e-6);
  EXPECT_LT(imageSsim(left, changed), 0.6);
}

TEST(ImageError, SsimOfEvenPicturesIsItsLuminanceTerm) {
  // (2·½·¼ + 10⁻⁴)/(¼ + 1/16 + 10⁻⁴) = 0.2501/0.3126
  EXPECT_NEAR(imageSsim(greyImage(16, 13, 0.5F), greyImage(16, 13, 0.25F)), 0.800064, 1e-6);
  // White of 2 makes C₁ four times as large: 0.2504/0.3129.
  EXPECT_NEAR(imageSsim(greyImage(16, 13, 0.5F), greyImage(16, 13, 0.25F), {}, 2), 0.800256, 1e-6);
}

TEST(ImageError, SsimOfTwoDotsByHand) {
  // One window. Σ exp(−i²/4.5) = 3.75923 for i = −5 … 5: a dot in the middle has the weight 1/3.75923² = 0.0707623, one beside it
  // exp(−1/4.5) = 0.800737 of that, 0.0566620. Two dots never meet: the covariance is −μ_a μ_b = −0.00400953.
  //   (0.00801906 + 0.0001)(−0.00801906 + 0.0009)
  //   / ((0.00500730 + 0.00321058 + 0.0001)(0.0657550 + 0.0534514 + 0.0009)) = −0.00578005/0.00099903…
  Image a = blankImage(11, 11), b = a;
  a.at(5, 5) = b.at(6, 5) = {1, 1, 1};
  const double w = 0.0707623, v = 0.0566620;
  const double expected = (2 * w * v + 1e-4) * (-2 * w * v + 9e-4) / ((w * w + v * v + 1e-4) * (w - w * w + v - v * v + 9e-4));
  EXPECT_NEAR(expected, -0.057856, 1e-6);
  EXPECT_NEAR(imageSsim(a, b), expected, 1e-5);
  // Up or aside is the same.
  Image c = blankImage(11, 11);
  c.at(5, 4) = {1, 1, 1};
  EXPECT_NEAR(imageSsim(a, c), expected, 1e-5);
}

TEST(ImageError, SsimSeesLuminanceAlone) {
  Image green = blankImage(11, 11), grey = green;
  green.at(5, 5) = {0, 1, 0};
  grey.at(5, 5) = Vec3{1, 1, 1} * 0.7152F;
  EXPECT_NEAR(imageSsim(green, grey), 1, 1e-6);
  green.at(5, 5) = {1, 0, 0};
  EXPECT_LT(imageSsim(green, grey), 0.8);
}

// ITU-R BT.709 weighs the primaries by 0.2126, 0.7152 and 0.0722: a dot of one primary equals a grey dot of that brightness, and no grey
// dot of another one.
TEST(ImageError, SsimWeighsThePrimariesAsBt709) {
  const std::pair<Vec3, float> primaries[] = {{{1, 0, 0}, 0.2126F}, {{0, 1, 0}, 0.7152F}, {{0, 0, 1}, 0.0722F}};
  for (const auto& [color, brightness] : primaries)
    for (const auto& [other, grey] : primaries) {
      Image a = blankImage(11, 11), b = a;
      a.at(5, 5) = color;
      b.at(5, 5) = Vec3{1, 1, 1} * grey;
      if (grey == brightness)
        EXPECT_NEAR(imageSsim(a, b), 1, 1e-6) << brightness;
      else
        EXPECT_LT(imageSsim(a, b), 0.99) << brightness << ' ' << grey;
    }
}

TEST(ImageError, SsimIdentities) {
  const Image a = noise(30, 24, 3), b = noise(30, 24, 4);
  EXPECT_NEAR(imageSsim(a, a), 1, 1e-12);
  EXPECT_EQ(imageSsim(a, b), imageSsim(b, a));
  EXPECT_LT(std::abs(imageSsim(a, b)), 0.2);
  Image inverse = a, dim = a;
  for (Vec3& p : inverse.pixels) p = Vec3{1, 1, 1} - p;
  for (Vec3& p : dim.pixels) p = p * 0.8F;
  EXPECT_LT(imageSsim(a, inverse), -0.5);
  EXPECT_GT(imageSsim(a, dim), 0.85);
  EXPECT_LT(imageSsim(a, dim), 0.99);
  // No window fits.
  EXPECT_EQ(imageSsim(noise(10, 30, 1), noise(10, 30, 2)), 1);
}

TEST(ImageError, SpreadOfTheLuminancesThatCount) {
  Image image = blankImage(4, 1);
  image.pixels = {{0.25F, 0.25F, 0.25F}, {0.75F, 0.75F, 0.75F}, {0.25F, 0.25F, 0.25F}, {9, 9, 9}};
  EXPECT_NEAR(luminanceSpread(image, std::vector<uint8_t>{1, 1, 0, 0}), 0.25, 1e-7);
  EXPECT_NEAR(luminanceSpread(image, std::vector<uint8_t>{1, 0, 1, 0}), 0, 1e-7);
  EXPECT_EQ(luminanceSpread(image, std::vector<uint8_t>{0, 0, 0, 0}), 0);
  EXPECT_GT(luminanceSpread(image), 3);
}

TEST(ImageError, SameFiguresForAnyNumberOfThreads) {
  const Image a = noise(64, 48, 5), b = noise(64, 48, 6);
  const auto figure = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return imageSsim(a, b);
  };
  EXPECT_EQ(figure(1), figure(2));
  EXPECT_EQ(figure(1), figure(7));
}

TEST(ImageError, CloudMaskIsWhereEitherDiffersFromTheBackground) {
  const Image sky = greyImage(4, 1, 0.5F);
  Image a = sky, b = sky;
  a.pixels[0].x = 0.6F;
  b.pixels[1].z = 0.4F;
  a.pixels[2].y = b.pixels[2].y = 0.503F;
  EXPECT_EQ(cloudMask(a, b, sky), (PixelMask{1, 1, 0, 0}));
  EXPECT_EQ(cloudMask(a, b, sky, 0.001F), (PixelMask{1, 1, 1, 0}));
  for (const Vec3 change : {Vec3{0.1F, 0, 0}, Vec3{0, 0.1F, 0}, Vec3{0, 0, 0.1F}})  // in either direction in any channel
    for (const Vec3 other : {sky.pixels[3] + change, sky.pixels[3] - change}) {
      Image changed = sky;
      changed.pixels[3] = other;
      EXPECT_EQ(cloudMask(changed, sky, sky), (PixelMask{0, 0, 0, 1}));
    }
}

TEST(ImageError, MapRunsFromGreyToRed) {
  Image a = blankImage(5, 1), b = a;
  const float errors[] = {0, 0.1F, 0.2F, 5, 0.2F};
  for (int i = 0; i < 5; ++i) b.at(i, 0) = Vec3{1, 1, 1} * errors[i];
  const Image map = errorMap(a, b, 0.2F, PixelMask{1, 1, 1, 1, 0});
  const Vec3 none = map.at(0, 0), half = map.at(1, 0), full = map.at(2, 0);
  EXPECT_EQ(none.x, none.y);
  EXPECT_EQ(none.y, none.z);
  EXPECT_GT(none.x, 0);
  EXPECT_GT(half.y, 2 * half.z);
  EXPECT_GT(half.x, half.y);
  EXPECT_GT(full.x, 4 * full.y);
  EXPECT_EQ(map.at(3, 0), full);
  EXPECT_EQ(map.at(4, 0), Vec3{});
  // The sign does not count, and three channels count as their rms.
  EXPECT_EQ(errorMap(b, a, 0.2F).pixels[1], half);
  b.at(1, 0) = {0, 0.1F * std::sqrt(3.0F), 0};
  EXPECT_LT(length(errorMap(a, b, 0.2F).at(1, 0) - half), 1e-5F);
  EXPECT_EQ(errorColor(0.5F), half);
}

TEST(ImageError, RefusesPicturesThatDoNotFit) {
  const Image a = blankImage(12, 12), b = blankImage(12, 13);
  EXPECT_THROW(imageRms(a, b), std::invalid_argument);
  EXPECT_THROW(imagePsnr(a, b), std::invalid_argument);
  EXPECT_THROW(imageSsim(a, b), std::invalid_argument);
  EXPECT_THROW(errorMap(a, b), std::invalid_argument);
  EXPECT_THROW(cloudMask(a, a, b), std::invalid_argument);
  EXPECT_THROW(imageRms(a, a, PixelMask(143)), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
