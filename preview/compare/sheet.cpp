// Text uses Sean Barrett's stb_easy_font: capitals are 7 dots high, and lines are 12 dots apart. Each letter is a few vertical and
// horizontal strokes, which the font returns as rectangles of whole dots.
#include "preview/compare/sheet.h"

#include <stb_easy_font.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

namespace cloudbake {

namespace {

constexpr int kLineDots = 12;

/// What stb_easy_font writes per corner of a rectangle.
struct Corner {
  float x, y, z;
  unsigned char color[4];
};
constexpr size_t kMostStrokes = 32;  // of one letter

// The font's table ends where printable ASCII does.
std::string printable(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c != '\n' && (c < ' ' || c > '~')) c = '?';
  return result;
}

int textHeight(std::string_view text, int scale) {
  return text.empty() ? 0 : int(1 + std::count(text.begin(), text.end(), '\n')) * kLineDots * scale;
}

void fill(Image& image, int left, int top, int right, int bottom, Vec3 color) {
  for (int y = std::max(0, top); y < std::min(image.height, bottom); ++y)
    for (int x = std::max(0, left); x < std::min(image.width, right); ++x) image.at(x, y) = color;
}

void paste(Image& image, const Image& part, int left, int top) {
  for (int y = 0; y < part.height; ++y) std::copy_n(&part.pixels[size_t(y) * size_t(part.width)], part.width, &image.at(left, top + y));
}

/// A row of panels whose texts are wrapped.
struct Row {
  std::vector<Panel> panels;
  int title_height = 0, image_height = 0, caption_height = 0;
};

int columnWidth(std::span<const Panel> panels, int scale) {
  int width = 0;
  for (const Panel& panel : panels)
    width = std::max(
        {width, panel.image.width, textWidth(wrapText(panel.title, 0, scale), scale), textWidth(wrapText(panel.caption, 0, scale), scale)});
  return width;
}

std::vector<Row> rowsOf(std::span<const Panel> panels, size_t columns, int width, int scale) {
  std::vector<Row> rows((panels.size() + columns - 1) / columns);
  for (size_t i = 0; i < panels.size(); ++i) {
    Row& row = rows[i / columns];
    row.panels.push_back({wrapText(panels[i].title, width, scale), wrapText(panels[i].caption, width, scale), panels[i].image});
    const Panel& panel = row.panels.back();
    row.title_height = std::max(row.title_height, textHeight(panel.title, scale));
    row.image_height = std::max(row.image_height, panel.image.height);
    row.caption_height = std::max(row.caption_height, textHeight(panel.caption, scale));
  }
  return rows;
}

}  // namespace

int textWidth(std::string_view text, int scale) { return stb_easy_font_width(printable(text).data()) * scale; }

void drawText(Image& image, int x, int y, std::string_view text, int scale, Vec3 color) {
  std::string dots = printable(text);
  std::vector<std::array<Corner, 4>> strokes(dots.size() * kMostStrokes + 1);
  const int count = stb_easy_font_print(0, 0, dots.data(), nullptr, strokes.data(), int(strokes.size() * sizeof(strokes[0])));
  for (int i = 0; i < count; ++i) {
    const Corner &low = strokes[size_t(i)][0], &high = strokes[size_t(i)][2];
    fill(image, x + int(low.x) * scale, y + int(low.y) * scale, x + int(high.x) * scale, y + int(high.y) * scale, color);
  }
}

std::string wrapText(std::string_view text, int width, int scale) {
  std::string result, line;
  size_t at = 0;
  while (at < text.size()) {
    // A word and the character that ends it.
    const size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string word(text.substr(at, end - at)), longer = line.empty() ? word : line + ' ' + word;
    if (!line.empty() && textWidth(longer, scale) > width) {
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

Image sheet(std::span<const Panel> panels, int columns, const SheetSettings& settings) {
  if (columns < 1) throw std::invalid_argument("sheet: at least one column");
  const int scale = settings.text_scale, gap = settings.gap, width = columnWidth(panels, scale);
  const std::vector<Row> rows = rowsOf(panels, size_t(columns), width, scale);
  const int used = std::min(columns, int(panels.size()));
  int height = gap;
  for (const Row& row : rows) height += row.title_height + row.image_height + row.caption_height + gap;

  Image image{gap + used * (width + gap), height, {}};
  image.pixels.assign(size_t(image.width) * size_t(image.height), settings.paper);
  int y = gap;
  for (const Row& row : rows) {
    int x = gap;
    for (const Panel& panel : row.panels) {
      const int image_top = y + row.title_height, caption_top = image_top + row.image_height;
      drawText(image, x, y, panel.title, scale, settings.title_color);
      paste(image, panel.image, x, image_top);
      drawText(image, x, caption_top + 2 * scale, panel.caption, scale, settings.caption_color);
      x += width + gap;
    }
    y += row.title_height + row.image_height + row.caption_height + gap;
  }
  return image;
}

}  // namespace cloudbake
