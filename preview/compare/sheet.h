// Sheets of pictures side by side, with texts.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/image.h"

namespace cloudbake {

/// One picture of a sheet. Display-referred colours; text is printable ASCII with line ends, and anything else appears as '?'.
struct Panel {
  std::string title;    ///< above the picture
  std::string caption;  ///< below it
  Image image;
};

struct SheetSettings {
  int text_scale = 2;  ///< pixels per dot of the font, which is 12 dots from line to line, ≥ 1
  int gap = 16;        ///< between panels and around the sheet, pixels, ≥ 0
  Vec3 paper{0.13F, 0.14F, 0.16F}, title_color{1, 1, 1}, caption_color{0.75F, 0.78F, 0.82F};
};

/// The width of a text as drawText draws it, pixels: that of its longest line.
int textWidth(std::string_view text, int scale);

/// Draws a text with its upper left corner at (x, y), clipped to the image.
void drawText(Image& image, int x, int y, std::string_view text, int scale, Vec3 color);

/// Replaces spaces of the text by line ends where a line would be wider than `width` pixels. A longer word is not split.
std::string wrapText(std::string_view text, int width, int scale);

/// Lays panels out in rows of `columns` ≥ 1. Columns are as wide as the widest picture or word, rows are as high as necessary, and texts
/// are wrapped. Without panels the image only has margins. Throws std::invalid_argument if columns < 1.
Image sheet(std::span<const Panel> panels, int columns, const SheetSettings& settings = {});

}  // namespace cloudbake
