// Bytes as text (RFC 4648).
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

std::string encodeBase64(std::string_view bytes);

}  // namespace cloudbake
