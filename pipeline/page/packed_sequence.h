// A cloud that changes for the page of `view`, rounded as in a picture of keys (docs/sequences.md). viewer/packed_mesh.js unpacks it.
#pragma once

#include "core/sequence.h"
#include "pipeline/page/packed_mesh.h"

namespace cloudbake {

/// Packs each segment: its triangles, then the positions, the roots of d, and the directions of all keys, each number as its difference
/// from that of the key before. Returns the rest, named as in a file, and how many vertices and corners a segment has.
Json packedSequence(const CloudSequence& sequence, MeshPacker& packer);

}  // namespace cloudbake
