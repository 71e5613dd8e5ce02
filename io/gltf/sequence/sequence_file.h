// Sequences as GLB (docs/sequences.md): a mesh per segment whose keys are morph targets, or rows of a picture.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/memory_budget.h"
#include "core/sequence.h"

namespace cloudbake {

/// How a file stores the keys of a sequence.
enum class SequenceForm {
  kMorph,   ///< morph targets of float positions, normals and UVs, with an animation of their weights
  kTexture  ///< a picture whose texels hold positions, normals and lobes, 12 bytes per vertex and key
};

/// The columns of the picture, and the largest that GPUs take.
inline constexpr int kSequenceColumns = 1024, kMostSequenceRows = 16384;

/// The bytes of a GLB. The same sequence gives the same bytes. Throws InputError if the picture would have more than kMostSequenceRows.
std::string encodeSequence(const CloudSequence& sequence, SequenceForm form);

/// A hash of what a decoded sequence shows: triangles, frames, positions, normals, lobes, k, b and the extinction. The file records it.
std::string sealOf(const CloudSequence& sequence);

/// Whether the bytes are a sequence, as far as their metadata show; false for a damaged file.
bool isSequence(std::string_view bytes);

/// Reads a GLB of encodeSequence. Throws InputError if it is damaged or no sequence.
CloudSequence decodeSequence(const std::filesystem::path& file, std::string_view bytes, uint64_t memory_limit = kMemoryLimit);

}  // namespace cloudbake
