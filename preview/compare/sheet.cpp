#include "preview/compare/sheet.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "preview/compare/lettering.h"

namespace cloudbake {

namespace {

constexpr float kShownWidth_px = 900, kReadable_px = 13, kTitleToCaption = 7.0F / 6;

/// How the texts of a sheet are drawn.
struct Style {
  Lettering title, caption;
  int air = 0;  // between a text and the picture, pixels
};

Style styleOf(std::span<const Panel> panels, int columns, const SheetSettings& settings) {
  int width = 0;
  for (const Panel& panel : panels) width = std::max(width, panel.image.width);
  const float size = settings.text_px > 0 ? settings.text_px : sheetTextSize(settings.gap + columns * (width + settings.gap));
  return {{std::round(size * kTitleToCaption), true}, {size, false}, int(std::lround(size / 4))};
}

int textHeight(std::string_view text, const Lettering& lettering) {
  return text.empty() ? 0 : int(1 + std::count(text.begin(), text.end(), '\n')) * lineHeight(lettering);
}

void paste(Image& image, const Image& part, int left, int top) {
  for (int y = 0; y < part.height; ++y) std::copy_n(&part.pixels[size_t(y) * size_t(part.width)], part.width, &image.at(left, top + y));
}

/// A row of panels whose texts are wrapped. Heights contain the air beside the picture.
struct Row {
  std::vector<Panel> panels;
  int title_height = 0, image_height = 0, caption_height = 0;
  int height() const { return title_height + image_height + caption_height; }
};

int columnWidth(std::span<const Panel> panels, const Style& style) {
  int width = 0;
  for (const Panel& panel : panels)
    width = std::max({width, panel.image.width, textWidth(wrapText(panel.title, 0, style.title), style.title),
                      textWidth(wrapText(panel.caption, 0, style.caption), style.caption)});
  return width;
}

std::vector<Row> rowsOf(std::span<const Panel> panels, size_t columns, int width, const Style& style) {
  std::vector<Row> rows((panels.size() + columns - 1) / columns);
  const auto heightOf = [&](std::string_view text, const Lettering& lettering) {
    return text.empty() ? 0 : textHeight(text, lettering) + style.air;
  };
  for (size_t i = 0; i < panels.size(); ++i) {
    Row& row = rows[i / columns];
    row.panels.push_back(
        {wrapText(panels[i].title, width, style.title), wrapText(panels[i].caption, width, style.caption), panels[i].image});
    const Panel& panel = row.panels.back();
    row.title_height = std::max(row.title_height, heightOf(panel.title, style.title));
    row.image_height = std::max(row.image_height, panel.image.height);
    row.caption_height = std::max(row.caption_height, heightOf(panel.caption, style.caption));
  }
  return rows;
}

}  // namespace

float sheetTextSize(int width) { return std::max(kReadable_px, std::round(kReadable_px * float(width) / kShownWidth_px)); }

Image sheet(std::span<const Panel> panels, int columns, const SheetSettings& settings) {
  if (columns < 1) throw std::invalid_argument("sheet: at least one column");
  const int used = std::min(columns, int(panels.size())), gap = settings.gap;
  const Style style = styleOf(panels, used, settings);
  const int width = columnWidth(panels, style);
  const std::vector<Row> rows = rowsOf(panels, size_t(columns), width, style);
  int height = gap;
  for (const Row& row : rows) height += row.height() + gap;

  Image image{gap + used * (width + gap), height, {}};
  image.pixels.assign(size_t(image.width) * size_t(image.height), settings.paper);
  int y = gap;
  for (const Row& row : rows) {
    int x = gap;
    for (const Panel& panel : row.panels) {
      // A title of fewer lines than its neighbour's stays with its picture.
      const int image_top = y + row.title_height, title_top = image_top - style.air - textHeight(panel.title, style.title);
      drawText(image, x, title_top, panel.title, style.title, settings.title_color);
      paste(image, panel.image, x, image_top);
      drawText(image, x, image_top + panel.image.height + style.air, panel.caption, style.caption, settings.caption_color);
      x += width + gap;
    }
    y += row.height() + gap;
  }
  return image;
}

}  // namespace cloudbake
