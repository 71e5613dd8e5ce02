// Chunks of a PNG (its third edition, section 5.3): length, kind, data and a checksum.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace cloudbake {

/// Appends a number in `count` bytes, the most significant one first.
inline void appendBigEndian(std::string& bytes, uint32_t value, int count = 4) {
  for (int shift = 8 * (count - 1); shift >= 0; shift -= 8) bytes += char(value >> shift & 0xFF);
}

/// A chunk as it is stored. `kind` has four letters.
std::string pngChunk(std::string_view kind, std::string_view data);

}  // namespace cloudbake
