// Text of unknown encoding as UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cloudbake {

/// Whether a text is valid UTF-8 (RFC 3629: shortest forms, no surrogates).
bool isUtf8(std::string_view text);

/// The text itself if it is valid UTF-8, else its bytes read as Latin-1. JSON holds UTF-8 alone,
/// and names in files of other formats may be in any encoding.
std::string asUtf8(std::string_view text);

/// The number of code points of valid UTF-8.
size_t codePoints(std::string_view text);

}  // namespace cloudbake
