// OpenEXR there and back, by the library's own reader.
#include "io/image/exr.h"

#include <gtest/gtest.h>
#include <tinyexr.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>

namespace cloudbake {
namespace {

Image4 channels(int width, int height) {
  Image4 image = filledImage4(width, height, {});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at(x, y) = {0.1F + float(x), 1e-6F * float(y), -3.5F, float(x * y) / 7};
  return image;
}

TEST(Exr, KeepsEveryValueAsItIs) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 23}, std::pair{5, 100}}) {
    const Image4 image = channels(width, height);
    const std::string exr = encodeExr(image);
    float* values = nullptr;
    int read_width = 0, read_height = 0;
    ASSERT_EQ(
        LoadEXRFromMemory(&values, &read_width, &read_height, reinterpret_cast<const unsigned char*>(exr.data()), exr.size(), nullptr),
        TINYEXR_SUCCESS);
    const std::unique_ptr<float, void (*)(void*)> owner(values, std::free);
    ASSERT_EQ(read_width, width);
    ASSERT_EQ(read_height, height);
    for (size_t i = 0; i < image.pixels.size(); ++i)
      for (size_t c = 0; c < 4; ++c) ASSERT_EQ(values[4 * i + c], image.pixels[i][c]) << i << " " << c;
    EXPECT_EQ(encodeExr(channels(width, height)), exr);
  }
}

TEST(Exr, RefusesWhatIsNoPicture) {
  EXPECT_THROW(encodeExr(Image4{}), std::invalid_argument);
  EXPECT_THROW(encodeExr(Image4{4, 4, std::vector<Rgba>(15)}), std::invalid_argument);
  EXPECT_THROW(encodeExr(Image4{-1, -1, std::vector<Rgba>(1)}), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
