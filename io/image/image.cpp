// stb_image_write chooses a filter per row, and zlib compresses. Neither has threads or state that changes between calls, so equal pixels
// give equal bytes.
#include "io/image/image.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>

#include "core/error.h"
#include "core/text/maker.h"
#include "io/file/deflate.h"
#include "io/image/png_chunk.h"

namespace {

// For stb_image_write, which frees the result. Its own deflate takes as long for 1.2 to 1.9 times as many bytes.
unsigned char* zlibCompressed(unsigned char* data, int count, int* size, int) {
  const std::string zlib = cloudbake::deflated({reinterpret_cast<const char*>(data), size_t(count)}, cloudbake::kUsual);
  auto* result = static_cast<unsigned char*>(std::malloc(zlib.size()));
  if (!result) return nullptr;
  std::copy(zlib.begin(), zlib.end(), result);
  *size = int(zlib.size());
  return result;
}

}  // namespace

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STBIW_ZLIB_COMPRESS zlibCompressed
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace cloudbake {

namespace {

constexpr int64_t kMaxPixels = int64_t(1) << 28;

// round(255·v). The comparisons are false for NaN.
uint8_t quantize(float v) {
  if (!(v > 0)) return 0;
  return v < 1 ? uint8_t(std::lround(v * 255)) : uint8_t(255);
}

void appendBytes(void* context, void* data, int size) {
  static_cast<std::string*>(context)->append(static_cast<const char*>(data), size_t(size));
}

constexpr size_t kAfterHeader = 33;

std::string pngOf(int width, int height, int channels, const std::vector<uint8_t>& bytes) {
  std::string png;
  if (!stbi_write_png_to_func(appendBytes, &png, width, height, channels, bytes.data(), width * channels)) throw std::bad_alloc();
  png.insert(kAfterHeader, pngChunk("tEXt", std::string("Software") + '\0' + std::string(kMaker)));
  return png;
}

// `kinds` is "PNG", or "PNG or JPEG", for messages.
Image decoded(std::string_view bytes, const std::string& name, const std::string& kinds, uint64_t memory_limit) {
  // Read only the header first, so that a hostile size is rejected before memory is allocated for it.
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  int width = 0, height = 0, channels = 0;
  if (bytes.size() > size_t(std::numeric_limits<int>::max()) || !stbi_info_from_memory(data, int(bytes.size()), &width, &height, &channels))
    throw InputError(name, "is not a " + kinds + " picture");
  if (int64_t(width) * height > kMaxPixels)
    throw InputError(name, "has " + std::to_string(width) + " × " + std::to_string(height) + " pixels; the limit is 2^28 in all");
  requireMemory({"its " + std::to_string(width) + " × " + std::to_string(height) + " pixels",
                 double(width) * height * double(sizeof(Vec3) + 4), "use a smaller picture"},
                memory_limit, name);

  const std::unique_ptr<stbi_uc, void (*)(void*)> rgb(stbi_load_from_memory(data, int(bytes.size()), &width, &height, &channels, 3),
                                                      stbi_image_free);
  if (!rgb) throw InputError(name, "is a damaged " + kinds + " picture");
  Image image = blankImage(width, height);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {float(rgb.get()[3 * i]) / 255, float(rgb.get()[3 * i + 1]) / 255, float(rgb.get()[3 * i + 2]) / 255};
  return image;
}

}  // namespace

std::vector<uint8_t> rgbBytes(const Image& image) {
  if (image.width < 1 || image.height < 1 || image.pixels.size() != size_t(image.width) * size_t(image.height))
    throw std::invalid_argument("encodePng: a picture needs width·height pixels, and at least one");
  std::vector<uint8_t> bytes;
  bytes.reserve(image.pixels.size() * 3);
  for (const Vec3& p : image.pixels)
    for (const float v : {p.x, p.y, p.z}) bytes.push_back(quantize(v));
  return bytes;
}

std::string encodePng(const Image& image) { return pngOf(image.width, image.height, 3, rgbBytes(image)); }

std::string encodeGreyPng(int width, int height, const std::vector<uint8_t>& grey, std::string_view keyword, std::string_view text) {
  if (width < 1 || height < 1 || grey.size() != size_t(width) * size_t(height))
    throw std::invalid_argument("encodeGreyPng: a picture needs width·height pixels, and at least one");
  std::string png = pngOf(width, height, 1, grey);
  png.insert(kAfterHeader, pngChunk("tEXt", std::string(keyword) + '\0' + std::string(text)));
  return png;
}

std::string encodeRgbaPng(int width, int height, const std::vector<uint8_t>& rgba) {
  if (width < 1 || height < 1 || rgba.size() != 4 * size_t(width) * size_t(height))
    throw std::invalid_argument("encodeRgbaPng: a picture needs width·height pixels, and at least one");
  return pngOf(width, height, 4, rgba);
}

std::string encodeJpeg(const Image& image, int quality) {
  const std::vector<uint8_t> bytes = rgbBytes(image);
  std::string jpeg;
  if (!stbi_write_jpg_to_func(appendBytes, &jpeg, image.width, image.height, 3, bytes.data(), quality)) throw std::bad_alloc();
  return jpeg;
}

Image decodePng(std::string_view bytes, const std::string& name, uint64_t memory_limit) {
  if (!bytes.starts_with("\x89PNG\r\n\x1A\n")) throw InputError(name, "is not a PNG picture");
  return decoded(bytes, name, "PNG", memory_limit);
}

Image decodeImage(std::string_view bytes, const std::string& name, uint64_t memory_limit) {
  return decoded(bytes, name, "PNG or JPEG", memory_limit);
}

}  // namespace cloudbake
