// The typeface of sheets: Inter, of the letters that scripts/docs/subset_font keeps.
#pragma once

#include <span>
#include <string_view>

namespace cloudbake {

/// An OpenType font with outlines in cubic curves.
struct FontFile {
  std::string_view name;  ///< "inter_medium", "inter_semibold"
  std::span<const unsigned char> bytes;
};
std::span<const FontFile> fontFiles();

}  // namespace cloudbake
