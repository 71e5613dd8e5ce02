// Sean Barrett's stb_truetype fills the outlines with exact coverage per pixel, which is blended in display-referred colours. Letters lie
// between whole pixels, and pairs are kerned as the font says.
#include "preview/compare/lettering.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/text/utf8.h"
#include "preview/compare/fonts.h"

#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_truetype.h>
#pragma GCC diagnostic pop

namespace cloudbake {

namespace {

constexpr float kLinePerEm = 1.32F, kBaselinePerEm = 1.0F;

stbtt_fontinfo openFont(const char* name) {
  const auto files = fontFiles();
  const auto file = std::find_if(files.begin(), files.end(), [&](const FontFile& one) { return one.name == name; });
  stbtt_fontinfo font{};
  stbtt_InitFont(&font, file->bytes.data(), 0);
  return font;
}

const stbtt_fontinfo& fontOf(const Lettering& lettering) {
  static const stbtt_fontinfo medium = openFont("inter_medium"), semibold = openFont("inter_semibold");
  return lettering.bold ? semibold : medium;
}

struct Letter {
  int glyph;
  float x;  // of its origin, pixels
};

struct Line {
  std::vector<Letter> letters;
  float width = 0;
};

// Takes a character from the front. A byte that does not begin one is a character that no font has.
int takeCharacter(std::string_view& text) {
  for (size_t length = 1; length <= std::min<size_t>(4, text.size()); ++length) {
    if (!isUtf8(text.substr(0, length))) continue;
    int code = static_cast<unsigned char>(text[0]) & (length == 1 ? 0x7F : 0xFF >> (length + 1));
    for (size_t i = 1; i < length; ++i) code = code << 6 | (text[i] & 0x3F);
    text.remove_prefix(length);
    return code;
  }
  text.remove_prefix(1);
  return -1;
}

// A text without line ends.
Line layOut(std::string_view text, const Lettering& lettering) {
  const stbtt_fontinfo& font = fontOf(lettering);
  const float scale = stbtt_ScaleForMappingEmToPixels(&font, lettering.size_px);
  Line line;
  while (!text.empty()) {
    const int code = takeCharacter(text);
    int glyph = code < ' ' ? 0 : stbtt_FindGlyphIndex(&font, code), advance = 0, bearing = 0;
    if (glyph == 0) glyph = stbtt_FindGlyphIndex(&font, '?');
    if (!line.letters.empty()) line.width += scale * float(stbtt_GetGlyphKernAdvance(&font, line.letters.back().glyph, glyph));
    stbtt_GetGlyphHMetrics(&font, glyph, &advance, &bearing);
    line.letters.push_back({glyph, line.width});
    line.width += scale * float(advance);
  }
  return line;
}

// Calls work(line) for each line of a text.
template <typename Work>
void forLines(std::string_view text, const Work& work) {
  for (size_t at = 0; at <= text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    work(text.substr(at, end - at));
    at = end + 1;
  }
}

// A glyph whose origin is at (x, y).
void drawGlyph(Image& image, float x, int y, int glyph, const Lettering& lettering, Vec3 color) {
  const stbtt_fontinfo& font = fontOf(lettering);
  const float scale = stbtt_ScaleForMappingEmToPixels(&font, lettering.size_px), whole = std::floor(x), shift = x - whole;
  int left = 0, top = 0, right = 0, bottom = 0;
  stbtt_GetGlyphBitmapBoxSubpixel(&font, glyph, scale, scale, shift, 0, &left, &top, &right, &bottom);
  const int width = right - left, height = bottom - top;
  if (width <= 0 || height <= 0) return;
  std::vector<unsigned char> covered(size_t(width) * size_t(height));
  stbtt_MakeGlyphBitmapSubpixel(&font, covered.data(), width, height, width, scale, scale, shift, 0, glyph);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const int to_x = int(whole) + left + column, to_y = y + top + row;
      if (to_x < 0 || to_y < 0 || to_x >= image.width || to_y >= image.height) continue;
      const float share = float(covered[size_t(row) * size_t(width) + size_t(column)]) / 255;
      Vec3& pixel = image.at(to_x, to_y);
      pixel = pixel * (1 - share) + color * share;
    }
}

}  // namespace

int lineHeight(const Lettering& lettering) { return int(std::lround(kLinePerEm * lettering.size_px)); }

int textWidth(std::string_view text, const Lettering& lettering) {
  float width = 0;
  forLines(text, [&](std::string_view line) { width = std::max(width, layOut(line, lettering).width); });
  return int(std::ceil(width));
}

void drawText(Image& image, int x, int y, std::string_view text, const Lettering& lettering, Vec3 color) {
  int baseline = y + int(std::lround(kBaselinePerEm * lettering.size_px));
  forLines(text, [&](std::string_view line) {
    for (const Letter& letter : layOut(line, lettering).letters)
      drawGlyph(image, float(x) + letter.x, baseline, letter.glyph, lettering, color);
    baseline += lineHeight(lettering);
  });
}

std::string wrapText(std::string_view text, int width, const Lettering& lettering) {
  std::string result, line;
  size_t at = 0;
  while (at < text.size()) {
    // A word and the character that ends it.
    const size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string word(text.substr(at, end - at)), longer = line.empty() ? word : line + ' ' + word;
    if (!line.empty() && textWidth(longer, lettering) > width) {
      result += line + '\n';
      line = word;
    } else {
      line = longer;
    }
    if (end < text.size() && text[end] == '\n') {
      result += line + '\n';
      line.clear();
    }
    at = end + 1;
  }
  return result + line;
}

}  // namespace cloudbake
