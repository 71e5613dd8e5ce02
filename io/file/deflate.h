// Bytes in the zlib format (RFC 1950), which browsers read as "deflate".
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

std::string deflated(std::string_view bytes);

}  // namespace cloudbake
