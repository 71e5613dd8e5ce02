// Encodes and decodes PNG, and encodes JPEG, in memory. Only io/file/write_file writes files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "core/memory_budget.h"

namespace cloudbake {

/// The bytes of a PNG with 8 bits per channel. The picture's values are display-referred sRGB in [0, 1], as made by preview's toneMap.
/// The PNG stores round(255·v); values outside [0, 1] are clamped, and NaN becomes 0.
/// The file says that cloudbake has made it. The same picture gives the same bytes. Throws std::invalid_argument for a picture without
/// pixels or with a wrong pixel count.
std::string encodePng(const Image& tone_mapped_srgb);

/// The bytes of a grey PNG with 8 bits per pixel: width × height bytes, row by row from the top. `text` is kept in it under this keyword of
/// Latin letters. Throws as encodePng does.
std::string encodeGreyPng(int width, int height, const std::vector<uint8_t>& grey, std::string_view keyword, std::string_view text);

/// The bytes of a PNG with 8 bits per channel of R, G, B and A, row by row from the top. Throws as encodePng does.
std::string encodeRgbaPng(int width, int height, const std::vector<uint8_t>& rgba);

/// The bytes of a baseline JPEG of the same values, for pages where size counts. `quality` is 1 to 100; up to 90, colours have half the
/// resolution. Throws as encodePng does.
std::string encodeJpeg(const Image& tone_mapped_srgb, int quality);

/// The bytes of the pixels that encodePng stores: R, G, B of each. Throws as it does.
std::vector<uint8_t> rgbBytes(const Image& tone_mapped_srgb);

/// The RGB values v = byte/255 of a PNG, still sRGB-encoded; alpha is dropped. `name` is the file name in messages.
/// Throws InputError if the bytes are not a PNG or have more than 2^28 pixels.
Image decodePng(std::string_view bytes, const std::string& name = "PNG", uint64_t memory_limit = kMemoryLimit);

/// The same of a PNG or a JPEG.
Image decodeImage(std::string_view bytes, const std::string& name, uint64_t memory_limit = kMemoryLimit);

}  // namespace cloudbake
