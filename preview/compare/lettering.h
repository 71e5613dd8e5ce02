// Draws antialiased text into pictures.
#pragma once

#include <string>
#include <string_view>

#include "core/image.h"

namespace cloudbake {

/// How letters are drawn.
struct Lettering {
  float size_px = 16;  ///< of the em square, pixels, > 0: capitals are 0.73 of it high
  bool bold = false;
};

/// From line to line, pixels.
int lineHeight(const Lettering& lettering);

/// The width of a text as drawText draws it, pixels: that of its longest line.
int textWidth(std::string_view text, const Lettering& lettering);

/// Draws a text with its upper left corner at (x, y), clipped to the image, whose colours are display-referred. The text is UTF-8 with line
/// ends. A character that the typeface lacks appears as '?', and so does each byte that is not UTF-8. The same text gives the same values.
void drawText(Image& image, int x, int y, std::string_view text, const Lettering& lettering, Vec3 color);

/// Replaces spaces of the text by line ends where a line would be wider than `width` pixels. A longer word is not split.
std::string wrapText(std::string_view text, int width, const Lettering& lettering);

}  // namespace cloudbake
