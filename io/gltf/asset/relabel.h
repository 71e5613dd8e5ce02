// Gives a level of detail another number and size in the metadata of its file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace cloudbake {

/// The metadata that change.
struct LevelLabel {
  int level = 0;          ///< 0: the file is a full asset
  int switch_pixels = 0;  ///< of a level
  std::string level_of;   ///< of a level that is an impostor: input_hash of the asset
};

/// The GLB of a baked asset or of an impostor with this label. Everything else stays as it is. Throws InputError if it is damaged or has no
/// metadata.
std::string relabelled(const std::filesystem::path& file, std::string_view glb, const LevelLabel& label);

}  // namespace cloudbake
