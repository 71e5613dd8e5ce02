// Lobe impostors as GLB (docs/impostors.md): the two pictures of the atlas, and a quad with a picture that was lit once, for programs that
// know nothing of lobes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/impostor.h"
#include "core/memory_budget.h"

namespace cloudbake {

/// A picture of the cloud from +Z, as wide as its ball, rows from the top: sRGB and alpha, 8 bits each.
struct Billboard {
  int size = 0;
  std::vector<uint8_t> rgba;
};

/// What `cloudbake impostor` writes.
struct ImpostorFiles {
  std::string glb, lobe_png, rest_png;
};
/// The same input gives the same bytes.
ImpostorFiles encodeImpostor(const Impostor& impostor, const Billboard& billboard);

/// Whether the bytes are an impostor, as far as their metadata show; false for a damaged file.
bool isImpostor(std::string_view bytes);

/// Reads a GLB of encodeImpostor, with mip levels. Throws InputError if it is damaged or no impostor.
Impostor decodeImpostor(const std::filesystem::path& file, std::string_view bytes, uint64_t memory_limit = kMemoryLimit);

}  // namespace cloudbake
