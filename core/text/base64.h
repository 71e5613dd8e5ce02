// Bytes as text (RFC 4648).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cloudbake {

std::string encodeBase64(std::string_view bytes);

/// The bytes of a text, which may lack the padding at its end. Nothing if a character is not of base64, or if the end is cut off.
std::optional<std::string> decodeBase64(std::string_view text);

}  // namespace cloudbake
