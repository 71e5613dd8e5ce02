// The keys of a sequence as whole numbers, and as the texels of a picture. Only for io/gltf/sequence and the page of `view`.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/sequence.h"

namespace cloudbake {

/// What the texels' numbers stand for.
struct KeyTextureScale {
  Box box;                                 ///< of all positions: 0 … 65535 of each axis is its low … its high corner
  float densest = 0;                       ///< the largest d: 0 … 65535 is the root of d / densest
  int position_bits = 16, root_bits = 16;  ///< that are kept; the others of the 16 are 0, for which PNG takes next to nothing
};

/// A vertex of a key.
struct KeyNumbers {
  std::array<uint16_t, 3> position{};
  uint16_t root = 0;                        ///< of d
  std::array<uint8_t, 2> lobe{}, normal{};  ///< points of the octahedron's map (core/lobe_packing.h), 255 · (u/2 + ½)
};
std::vector<KeyNumbers> numbersOfKey(const SequenceKey& key, const KeyTextureScale& scale);

/// Where the picture has the keys of a segment: texel (v mod columns, first_row + (block · rows + v / columns) · keys + key) for vertex v,
/// with `rows` = the rows that its vertices need, and blocks 0 to 3: the high bytes of x, y and z; their low bytes; o and the high byte of
/// d's root; the normal and the low byte of d's root.
struct KeyTexturePlace {
  int first_row = 0, keys = 0;
  size_t vertices = 0;
  int rowsPerBlock() const;
  int rows() const { return 4 * rowsPerBlock() * keys; }
};

/// Appends the places of all segments. The picture has as many rows as they need, and `columns` columns.
std::vector<KeyTexturePlace> placesInTexture(const CloudSequence& sequence);
int rowsOfTexture(const std::vector<KeyTexturePlace>& places);

KeyTextureScale scaleOfTexture(const CloudSequence& sequence);
Image keyTexture(const CloudSequence& sequence, const std::vector<KeyTexturePlace>& places, const KeyTextureScale& scale);

/// The key as the picture has it, without its frame.
SequenceKey keyOfTexture(const Image& texture, const KeyTexturePlace& place, int key, const KeyTextureScale& scale);

}  // namespace cloudbake
