// Counter-based random numbers. Every draw is a hash of its purpose, so the order of work, its split and the number of threads
// cannot change it. The mixer is splitmix64's finaliser (Steele, Lea, Flood, OOPSLA 2014; constants by D. Stafford, mix 13).
#pragma once

#include <bit>
#include <cstdint>

#include "core/vec3.h"

namespace cloudbake {

constexpr uint64_t kGolden64 = 0x9E3779B97F4A7C15ULL;

/// A bijection on 64 bits in which every input bit affects all output bits.
constexpr uint64_t mix64(uint64_t z) {
  z ^= z >> 30;
  z *= 0xBF58476D1CE4E5B9ULL;
  z ^= z >> 27;
  z *= 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/// The random stream of one point. It depends only on the seed and on the bits of the position (−0 counts as 0).
/// `position` is in the shape's own frame, so that moving or doubling a shape changes no draw.
inline uint64_t pointStream(uint64_t seed, Vec3 position) {
  uint64_t key = mix64((seed + 1) * kGolden64);
  for (const float f : {position.x, position.y, position.z}) key = mix64(key ^ std::bit_cast<uint32_t>(f + 0.0F)) + kGolden64;
  return key;
}

/// Hash of one draw: stream, ray and dimension (0, 1, …).
constexpr uint64_t hashDraw(uint64_t stream, uint32_t ray, uint32_t dimension) {
  return mix64(stream + ((uint64_t(dimension) << 32) + ray + 1) * kGolden64);
}

/// Uniform in [0, 1): the top 24 bits, so that 1 is never reached in float.
constexpr float uniformFloat(uint64_t hash) { return float(hash >> 40) * 0x1p-24F; }
/// Uniform in [0, 1): the top 53 bits.
constexpr double uniformDouble(uint64_t hash) { return double(hash >> 11) * 0x1p-53; }

}  // namespace cloudbake
