#include "io/sculpt/sculpt_images.h"

#include <gtest/gtest.h>

#include "io/image/image.h"

using namespace cloudbake;

namespace {

// A picture with one colour in its upper quarter and another below.
std::string pngOf(Vec3 upper, Vec3 lower) {
  Image image = blankImage(8, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 8; ++x) image.at(x, y) = y < 16 ? upper : lower;
  return encodePng(image);
}

}  // namespace

// A tangent-space normal map is (0.5, 0.5, 1) on the whole; the whole picture counts.
TEST(SculptImages, NormalMapsAreBlueOnTheWhole) {
  const Vec3 flat{0.5F, 0.5F, 1}, grey{0.5F, 0.5F, 0.5F}, red{1, 0, 0};
  EXPECT_TRUE(looksLikeNormalMap(pngOf(flat, flat)));
  EXPECT_TRUE(looksLikeNormalMap(pngOf({0.6F, 0.4F, 0.9F}, {0.4F, 0.6F, 1})));
  EXPECT_FALSE(looksLikeNormalMap(pngOf(grey, grey))) << "a height map";
  EXPECT_FALSE(looksLikeNormalMap(pngOf(flat, grey)));
  EXPECT_FALSE(looksLikeNormalMap(pngOf(flat, red)));
  EXPECT_TRUE(looksLikeNormalMap(pngOf(grey, flat))) << "a quarter of it is something else";
  EXPECT_FALSE(looksLikeNormalMap("no picture"));
}
