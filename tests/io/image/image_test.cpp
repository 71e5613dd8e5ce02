// PNG there and back.
#include "io/image/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/error.h"

namespace cloudbake {
namespace {

Image rampImage(int width, int height) {
  Image image = blankImage(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at(x, y) = {float(x) / float(width), float(y) / float(height), float((x * 7 + y * 3) % 11) / 10};
  return image;
}

TEST(Image, PngHoldsThePictureToHalfAStep) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 23}, std::pair{3, 200}}) {
    const Image image = rampImage(width, height), back = decodePng(encodePng(image));
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.height, height);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
      EXPECT_NEAR(back.pixels[i].x, image.pixels[i].x, 0.501 / 255);
      EXPECT_NEAR(back.pixels[i].y, image.pixels[i].y, 0.501 / 255);
      EXPECT_NEAR(back.pixels[i].z, image.pixels[i].z, 0.501 / 255);
    }
  }
}

TEST(Image, EqualPicturesGiveEqualBytes) {
  const std::string first = encodePng(rampImage(64, 48));
  EXPECT_EQ(encodePng(rampImage(64, 48)), first);
  EXPECT_EQ(first.substr(0, 8), "\x89PNG\r\n\x1a\n");
  // Bytes that decode to the same values encode to the same bytes again.
  EXPECT_EQ(encodePng(decodePng(first)), first);
}

TEST(Image, ValuesOutsideTheRangeBecomeItsEnds) {
  Image image = blankImage(2, 1);
  image.at(0, 0) = {-3, 17, std::numeric_limits<float>::quiet_NaN()};
  image.at(1, 0) = {INFINITY, -INFINITY, 1};
  const Image back = decodePng(encodePng(image));
  EXPECT_EQ(back.at(0, 0), (Vec3{0, 1, 0}));
  EXPECT_EQ(back.at(1, 0), (Vec3{1, 0, 1}));
}

TEST(Image, AJpegIsReadWhereItMayBeOne) {
  const Image grey{16, 8, std::vector<Vec3>(128, {0.5F, 0.5F, 0.5F})};
  const std::string jpeg = encodeJpeg(grey, 90), png = encodePng(grey);
  for (const std::string& bytes : {jpeg, png}) {
    const Image back = decodeImage(bytes, "a picture");
    ASSERT_EQ(back.width, 16);
    ASSERT_EQ(back.height, 8);
    for (const Vec3& p : back.pixels) EXPECT_NEAR(p.y, 0.5F, 2.0F / 255);
  }
  EXPECT_THROW(decodePng(jpeg), InputError);
  EXPECT_THROW(decodeImage("no picture", "a picture"), InputError);
  EXPECT_THROW(decodeImage(jpeg, "a picture", 1000), InputError);
}

TEST(Image, RefusesWhatIsNoPicture) {
  EXPECT_THROW(encodePng(Image{}), std::invalid_argument);
  EXPECT_THROW(encodePng(Image{4, 4, std::vector<Vec3>(15)}), std::invalid_argument);
  EXPECT_THROW(decodePng(""), InputError);
  EXPECT_THROW(decodePng("not a picture"), InputError);
  const std::string png = encodePng(rampImage(40, 40));
  EXPECT_THROW(decodePng(std::string_view(png).substr(0, png.size() / 2)), InputError);
  // A header that claims 2^31−1 × 2^31−1 pixels.
  std::string hostile = png;
  for (const size_t at : {size_t(16), size_t(20)}) hostile.replace(at, 4, std::string("\x7f\xff\xff\xff", 4));
  EXPECT_THROW(decodePng(hostile), InputError);
  try {
    decodePng("not a picture", "sky.png");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "sky.png: is not a PNG picture");
  }
}

}  // namespace
}  // namespace cloudbake
