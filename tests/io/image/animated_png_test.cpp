// Animated PNGs, read by a decoder of their own: chunks with their checksums, filters, and how frames are put over each other.
#include "io/image/animated_png.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <stdexcept>
#include <string>

#include "io/image/image.h"

namespace cloudbake {
namespace {

using Bytes = std::vector<uint8_t>;

uint32_t bigAt(const std::string& bytes, size_t at, int count = 4) {
  uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | uint8_t(bytes[at + size_t(i)]);
  return value;
}

struct Chunk {
  std::string kind, data;
};

std::vector<Chunk> chunksOf(const std::string& png) {
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  std::vector<Chunk> chunks;
  for (size_t at = 8; at < png.size();) {
    const size_t size = bigAt(png, at);
    const std::string kind_and_data = png.substr(at + 4, size + 4);
    EXPECT_EQ(bigAt(png, at + 8 + size), crc32(0, reinterpret_cast<const Bytef*>(kind_and_data.data()), uInt(size + 4)));
    chunks.push_back({kind_and_data.substr(0, 4), kind_and_data.substr(4)});
    at += size + 12;
  }
  return chunks;
}

// The RGBA bytes of packed, filtered rows.
Bytes unpacked(const std::string& data, size_t width, size_t height) {
  const size_t row = 4 * width;
  Bytes filtered((row + 1) * height), rgba(row * height);
  uLongf size = filtered.size();
  EXPECT_EQ(uncompress(filtered.data(), &size, reinterpret_cast<const Bytef*>(data.data()), data.size()), Z_OK);
  EXPECT_EQ(size, filtered.size());
  for (size_t y = 0; y < height; ++y)
    for (size_t i = 0; i < row; ++i) {
      const int a = i >= 4 ? rgba[y * row + i - 4] : 0, b = y > 0 ? rgba[(y - 1) * row + i] : 0,
                c = i >= 4 && y > 0 ? rgba[(y - 1) * row + i - 4] : 0, p = a + b - c;
      const int paeth = std::abs(p - a) <= std::abs(p - b) && std::abs(p - a) <= std::abs(p - c) ? a
                        : std::abs(p - b) <= std::abs(p - c)                                     ? b
                                                                                                 : c;
      const int guesses[] = {0, a, b, (a + b) / 2, paeth};
      rgba[y * row + i] = uint8_t(filtered[y * (row + 1) + 1 + i] + guesses[filtered[y * (row + 1)]]);
    }
  return rgba;
}

struct Decoded {
  uint32_t announced = 0, plays = 1;
  std::vector<Bytes> frames;  // RGB
  std::vector<uint32_t> delays, denominators, areas;
};

Decoded decodeAnimation(const std::string& png) {
  Decoded decoded;
  size_t width = 0, height = 0, sequence = 0, left = 0, top = 0, part_width = 0, part_height = 0;
  bool over = false;
  Bytes canvas;
  for (const auto& [kind, data] : chunksOf(png)) {
    if (kind == "IHDR") {
      width = bigAt(data, 0), height = bigAt(data, 4);
      EXPECT_EQ(data.substr(8), std::string("\x08\x06\0\0\0", 5));
      canvas.resize(3 * width * height);
    } else if (kind == "acTL") {
      decoded.announced = bigAt(data, 0), decoded.plays = bigAt(data, 4);
    } else if (kind == "fcTL") {
      EXPECT_EQ(bigAt(data, 0), sequence++);
      part_width = bigAt(data, 4), part_height = bigAt(data, 8), left = bigAt(data, 12), top = bigAt(data, 16);
      EXPECT_TRUE(part_width > 0 && part_height > 0 && left + part_width <= width && top + part_height <= height);
      decoded.areas.push_back(uint32_t(part_width * part_height));
      decoded.delays.push_back(bigAt(data, 20, 2)), decoded.denominators.push_back(bigAt(data, 22, 2));
      EXPECT_EQ(data[24], 0);
      over = data[25] == 1;
    } else if (kind == "IDAT" || kind == "fdAT") {
      EXPECT_EQ(kind == "IDAT", decoded.frames.empty());
      EXPECT_TRUE(kind == "IDAT" || bigAt(data, 0) == sequence++);
      const Bytes rgba = unpacked(kind == "IDAT" ? data : data.substr(4), part_width, part_height);
      for (size_t i = 0; i < part_width * part_height; ++i) {
        const size_t at = 3 * ((top + i / part_width) * width + left + i % part_width);
        EXPECT_TRUE(rgba[4 * i + 3] == 255 || (over && rgba[4 * i + 3] == 0)) << "half a pixel";
        if (rgba[4 * i + 3] == 255) std::copy_n(&rgba[4 * i], 3, &canvas[at]);
      }
      decoded.frames.push_back(canvas);
    }
  }
  return decoded;
}

std::string encode(const std::vector<Image>& frames, double frames_per_second = 12) {
  std::string png;
  AnimatedPng animation(frames.size(), frames_per_second, [&](std::string_view bytes) { png += bytes; });
  for (const Image& frame : frames) animation.add(frame);
  animation.end();
  return png;
}

Image noisy(int width, int height) {
  Image image = blankImage(width, height);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {float(i * 37 % 256) / 255, float(i * i % 251) / 255, float(i % 7) / 7};
  return image;
}

void expectFrames(const std::vector<Image>& frames, const std::string& png) {
  const Decoded decoded = decodeAnimation(png);
  EXPECT_EQ(decoded.announced, frames.size());
  EXPECT_EQ(decoded.plays, 0U) << "it loops for ever";
  ASSERT_EQ(decoded.frames.size(), frames.size());
  for (size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(decoded.frames[i], rgbBytes(frames[i])) << "frame " << i;
}

TEST(AnimatedPng, ShowsEveryFrameAsItIs) {
  std::vector<Image> frames{noisy(37, 23), noisy(37, 23)};  // the second frame is the same
  frames.push_back(frames.back());
  frames.back().at(36, 22) = {0, 0, 0};  // one pixel, in a corner, and black
  frames.push_back(frames.back());
  for (int x = 3; x < 30; x += 3) frames.back().at(x, 5 + x / 3) = {1, 0, 1};  // few in a large part
  frames.push_back(blankImage(37, 23));                                        // all
  frames.push_back(noisy(37, 23));
  expectFrames(frames, encode(frames));
  const Decoded decoded = decodeAnimation(encode(frames));
  EXPECT_EQ(decoded.areas[0], 37U * 23);
  EXPECT_EQ(decoded.areas[1], 1U) << "nothing has changed";
  EXPECT_EQ(decoded.areas[2], 1U);
  EXPECT_LT(decoded.areas[3], 37U * 23);
}

TEST(AnimatedPng, OfOneFrameOrOnePixel) {
  expectFrames({noisy(5, 4)}, encode({noisy(5, 4)}));
  expectFrames({noisy(1, 1), blankImage(1, 1)}, encode({noisy(1, 1), blankImage(1, 1)}));
}

TEST(AnimatedPng, ShowsThemForTheirTime) {
  for (const double frames_per_second : {0.1, 12.0, 23.98, 100.0}) {
    const Decoded decoded = decodeAnimation(encode({noisy(2, 2), blankImage(2, 2)}, frames_per_second));
    for (size_t i = 0; i < 2; ++i) EXPECT_NEAR(double(decoded.denominators[i]) / decoded.delays[i], frames_per_second, 1e-9);
  }
}

TEST(AnimatedPng, StoresOnlyWhatChanges) {
  std::vector<Image> frames(20, noisy(100, 80));
  for (size_t i = 0; i < frames.size(); ++i) frames[i].at(int(i), 7) = {float(i) / 20, 0, 0};
  EXPECT_LT(encode(frames).size(), encode({frames[0]}).size() + 20 * 200);
  EXPECT_EQ(encode(frames), encode(frames));
}

TEST(AnimatedPng, RefusesOtherFramesThanAnnounced) {
  AnimatedPng animation(2, 12, [](std::string_view) {});
  animation.add(noisy(4, 4));
  EXPECT_THROW(animation.add(noisy(4, 5)), std::invalid_argument);
  EXPECT_THROW(animation.end(), std::logic_error);
  animation.add(noisy(4, 4));
  EXPECT_THROW(animation.add(noisy(4, 4)), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
