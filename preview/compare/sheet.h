// Pictures side by side, with words.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/image.h"

namespace cloudbake {

/// One picture of a sheet. Display-referred colours; text is printable ASCII with line ends, anything else shows as '?'.
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

/// How wide a text is that drawText draws, pixels: its longest line.
int textWidth(std::string_view text, int scale);

/// Draws a text with its upper left corner at (x, y); what lies outside the image is left out.
void drawText(Image& image, int x, int y, std::string_view text, int scale, Vec3 color);

/// The text with line ends in place of spaces where a line would be wider than `width` pixels. A longer word stays whole.
std::string wrapText(std::string_view text, int width, int scale);

/// Lays panels out in rows of `columns` ≥ 1, columns as wide as the widest picture or word, rows as high as they must be; texts are
/// wrapped. No panels: an image of the margins. Throws std::invalid_argument for no column.
Image sheet(std::span<const Panel> panels, int columns, const SheetSettings& settings = {});

}  // namespace cloudbake
