// Hashes of lattice points, in 32 bits so that shaders compute the same (shaders/functions/noise.glsl).
#pragma once

#include <cstdint>

namespace cloudbake {

/// C. Wellons, "Prospecting for Hash Functions" (2018), lowbias32.
inline uint32_t mix32(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

/// The hash of a lattice point, one coordinate after the other, so that all points of a row share the first hash.
inline uint32_t hashAlong(uint32_t hash, uint32_t coordinate) { return mix32(hash ^ (coordinate * 0x9E3779B9U + 0x7F4A7C15U)); }

/// 0 … 1, 1 not included.
inline float unitFloat(uint32_t hash) { return float(hash >> 8) * 0x1p-24F; }

}  // namespace cloudbake
