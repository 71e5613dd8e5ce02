// Collects the images that the materials of a sculpt name. Only for io/sculpt/*.cpp.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// Reads each image once and appends it to `images`, with its file's bytes unchanged.
struct ImageCollector {
  const std::filesystem::path& file;  ///< the sculpt
  const ReadSettings& settings;
  std::vector<SculptImage>& images;
  Warnings& warnings;
  std::map<std::string, int> known{};

  /// The index of the image that is named so; −1 if it cannot be stored. Counts kImageNotEmbedded if it lies outside the folder, cannot be
  /// read, or is neither PNG nor JPEG, which are the types of glTF.
  /// `named_by` is the file that has the name, if it is not the sculpt.
  int fromFile(const std::string& written, const std::string& owner, const std::filesystem::path& named_by = {});
  /// The same for an image whose bytes are stored in the sculpt.
  int fromBytes(const std::string& name, std::string_view bytes, const std::string& owner);
};

/// Whether the colours of a PNG or JPEG are those of a normal map in tangent space: on average bluish, with red and green near a half. A
/// height map is grey.
bool looksLikeNormalMap(std::string_view bytes);

}  // namespace cloudbake
