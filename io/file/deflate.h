// Bytes in the zlib format (RFC 1950), which browsers read as "deflate", and zlib's checksum.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cloudbake {

inline constexpr int kFastest = 1, kUsual = 6, kSmallest = 9;  ///< zlib's levels

/// Throws std::bad_alloc.
std::string deflated(std::string_view bytes, int level = kFastest);

/// The bytes of a DEFLATE stream without header (RFC 1951), as in a ZIP. Nothing if it is damaged or gives another number than `size` of
/// them. Throws std::bad_alloc.
std::optional<std::string> inflated(std::string_view stream, uint64_t size);

/// The CRC-32 that PNG and gzip use (ISO 3309).
uint32_t checksum(std::string_view bytes);

}  // namespace cloudbake
