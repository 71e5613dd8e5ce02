// The keys of a sequence as the texels of a picture. Only for io/gltf/sequence.
#pragma once

#include <vector>

#include "core/image.h"
#include "core/sequence.h"

namespace cloudbake {

/// What the texels' numbers stand for.
struct KeyTextureScale {
  Box box;            ///< of all positions: 0 … 65535 of each axis is its low … its high corner
  float densest = 0;  ///< the largest d: 0 … 65535 is the root of d / densest
};

/// Where the picture has the keys of a segment: texel (v mod columns, first_row + (block · rows + v / columns) · keys + key) for vertex v,
/// with `rows` = the rows that its vertices need, and blocks 0 to 3: the high bytes of x, y and z; their low bytes; o as a point of the
/// octahedron's map (core/lobe_packing.h), 255 · (u/2 + ½), and the high byte of d; the normal likewise, and the low byte of d.
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
