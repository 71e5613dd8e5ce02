// Random numbers of an L-system. Every draw is a function of the seed, the place in the derivation and the purpose (core/random.h),
// so that growth, threads and order do not change it.
#pragma once

#include <cstdint>

#include "core/random.h"

namespace cloudbake {

/// The purpose of a draw. The comment behind each value gives the meaning of the draw's number n.
enum class DrawChannel : uint64_t {
  kRule = 0,      ///< choice of a rule; n = pass
  kTumble = 1,    ///< `~`; n = 0 pitch, 1 roll, 2 turn
  kLength = 2,    ///< random scale of lengths
  kFunction = 3,  ///< rand(); n = call
  kRadius = 4,    ///< radius of a sphere
  kJitter = 5,    ///< centre of a sphere; n = axis
  kAngle = 6,     ///< random scale of angles
  kWidth = 7      ///< random scale of widths
};

/// The key that all keys of one seed descend from.
constexpr uint64_t rootKey(uint64_t seed) { return mix64((seed + 1) * kGolden64); }
/// Key of module k of the premise.
constexpr uint64_t premiseKey(uint64_t root, uint64_t k) { return mix64(root + (k + 1) * kGolden64); }
/// Key of module j of a replacement.
constexpr uint64_t childKey(uint64_t parent, uint64_t j) { return mix64(parent ^ mix64((j + 1) * kGolden64)); }
/// Draw number n of a channel, uniform in [0, 1).
constexpr double drawUniform(uint64_t key, DrawChannel channel, uint64_t n) {
  return uniformDouble(mix64(key + (((uint64_t(channel) + 1) << 32) + n) * kGolden64));
}

}  // namespace cloudbake
