// Whole numbers in binary files.
#pragma once

#include <cstdint>
#include <string_view>

namespace cloudbake {

/// The number that at most eight bytes hold, the least significant first.
constexpr uint64_t fromLittleEndian(std::string_view bytes) {
  uint64_t value = 0;
  for (size_t i = bytes.size(); i-- > 0;) value = value << 8 | uint8_t(bytes[i]);
  return value;
}

}  // namespace cloudbake
