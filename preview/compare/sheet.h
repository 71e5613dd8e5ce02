// Sheets of pictures side by side, with texts.
#pragma once

#include <span>
#include <string>

#include "core/image.h"

namespace cloudbake {

/// One picture of a sheet. Display-referred colours; texts are UTF-8 with line ends (preview/compare/lettering.h).
struct Panel {
  std::string title{};    ///< above the picture
  std::string caption{};  ///< below it
  Image image{};          ///< may be empty
};

struct SheetSettings {
  float text_px = 0;  ///< size of captions, pixels; titles are a sixth larger; 0: as sheetTextSize says
  int gap = 16;       ///< between panels and around the sheet, pixels, ≥ 0
  Vec3 paper{0.13F, 0.14F, 0.16F}, title_color{1, 1, 1}, caption_color{0.8F, 0.83F, 0.87F};
};

/// The size of captions that can be read when a sheet of this width is shown 900 pixels wide, as pages show it; ≥ 13 pixels.
float sheetTextSize(int width);

/// Lays panels out in rows of `columns` ≥ 1. Columns are as wide as the widest picture or word, rows are as high as necessary, and texts
/// are wrapped. Without panels the image only has margins. Throws std::invalid_argument if columns < 1.
Image sheet(std::span<const Panel> panels, int columns, const SheetSettings& settings = {});

}  // namespace cloudbake
