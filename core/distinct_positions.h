// Merges equal positions.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// Equal positions have the same hash, −0 and 0 too. Its low bits are good enough for a table.
inline uint64_t hashOfPosition(const Vec3& p) {
  uint64_t hash = 0;
  for (const float f : {p.x, p.y, p.z}) hash = (hash ^ std::bit_cast<uint32_t>(f + 0.0F)) * 0x9E3779B97F4A7C15ULL;
  return hash ^ (hash >> 29);
}

/// Distinct positions in order of their first use, found by a hash table with linear probing. −0 equals 0; the first of them is kept.
class DistinctPositions {
 public:
  /// `expected`: how many there may be. It only saves time.
  explicit DistinctPositions(size_t expected = 0) { resizeTable(std::bit_ceil(2 * expected + 16)); }

  /// The index of p in positions, where it is added if it is new.
  uint32_t add(const Vec3& p) {
    if (2 * positions.size() >= table_.size()) resizeTable(2 * table_.size());
    uint32_t& entry = table_[slotOf(p)];
    if (entry == kFree) {
      entry = uint32_t(positions.size());
      positions.push_back(p);
    }
    return entry;
  }

  std::vector<Vec3> positions{};

 private:
  static constexpr uint32_t kFree = UINT32_MAX;

  // The slot of p, or the free one where it belongs.
  size_t slotOf(const Vec3& p) const {
    const size_t mask = table_.size() - 1;
    size_t slot = hashOfPosition(p) & mask;
    while (table_[slot] != kFree && !(positions[table_[slot]] == p)) slot = (slot + 1) & mask;
    return slot;
  }

  void resizeTable(size_t size) {
    table_.assign(size, kFree);
    for (size_t i = 0; i < positions.size(); ++i) table_[slotOf(positions[i])] = uint32_t(i);
  }

  std::vector<uint32_t> table_{};  // a power of two, at most half full
};

}  // namespace cloudbake
