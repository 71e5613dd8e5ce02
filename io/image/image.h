// PNG, to and from memory. Files are written by io/write_file alone.
#pragma once

#include <string>
#include <string_view>

#include "core/image.h"

namespace cloudbake {

/// PNG bytes, 8 bits per channel, of a picture whose values are display-referred sRGB in [0, 1] (preview's toneMap makes them).
/// The encoding holds round(255·v); by its definition values outside [0, 1] become its ends, and what is not a number becomes 0.
/// The same picture gives the same bytes. Throws std::invalid_argument for a picture without pixels or of a wrong pixel count.
std::string encodePng(const Image& tone_mapped_srgb);

/// The RGB values v = byte/255 of a PNG, still sRGB-encoded; alpha is dropped. `name` stands in the message.
/// Throws InputError where the bytes are no PNG or have more than 2^28 pixels.
Image decodePng(std::string_view bytes, const std::string& name = "PNG");

}  // namespace cloudbake
