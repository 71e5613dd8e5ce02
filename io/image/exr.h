// Encodes pictures as OpenEXR in memory. Their values are not changed.
#pragma once

#include <string>

#include "core/image.h"

namespace cloudbake {

/// The bytes of an OpenEXR file with the channels R, G, B and A as 32-bit floats, deflated. The same picture gives the same bytes. Throws
/// std::invalid_argument for a picture without pixels or with a wrong pixel count.
std::string encodeExr(const Image4& image);

}  // namespace cloudbake
