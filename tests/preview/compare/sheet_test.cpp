// Where panels and texts of a sheet come out.
#include "preview/compare/sheet.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "preview/compare/lettering.h"

namespace cloudbake {
namespace {

Image evenImage(int width, int height, Vec3 color) {
  Image image = blankImage(width, height);
  for (Vec3& p : image.pixels) p = color;
  return image;
}

// Pixels that letters cover by more than half.
int inkedPixels(const Image& image, int left, int top, int right, int bottom) {
  int count = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) count += image.at(x, y).x > 0.6F && image.at(x, y).y > 0.6F && image.at(x, y).z > 0.6F;
  return count;
}

TEST(Sheet, LayoutHoldsEveryPanel) {
  const Vec3 red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1};
  const Panel panels[] = {
      {"Red", "a", evenImage(100, 50, red)}, {"Green", "", evenImage(80, 70, green)}, {"Blue", "c", evenImage(60, 40, blue)}};
  SheetSettings settings;
  settings.text_px = 18;
  settings.gap = 10;
  settings.title_color = settings.caption_color = {1, 1, 1};
  const Image image = sheet(panels, 2, settings);
  // Columns of 100 between gaps of 10. A row: a title of 28 + 5, the higher picture, a caption of 5 + 24.
  ASSERT_EQ(lineHeight({21, true}), 28);
  ASSERT_EQ(lineHeight({18}), 24);
  ASSERT_EQ(image.width, 10 + 2 * 110);
  ASSERT_EQ(image.height, 10 + (33 + 70 + 29 + 10) + (33 + 40 + 29 + 10));
  const auto is = [&](int left, int top, int width, int height, Vec3 color) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (!(image.at(left + x, top + y) == color)) return false;
    return true;
  };
  EXPECT_TRUE(is(10, 43, 100, 50, red));
  EXPECT_TRUE(is(120, 43, 80, 70, green));
  EXPECT_TRUE(is(10, 185, 60, 40, blue));
  EXPECT_TRUE(is(0, 0, 10, image.height, settings.paper));
  EXPECT_TRUE(is(120, 152, 110, image.height - 152, settings.paper)) << "the place without a panel";
  EXPECT_GT(inkedPixels(image, 10, 10, 110, 43), 50) << "titles";
  EXPECT_GT(inkedPixels(image, 120, 10, 220, 43), 50);
  EXPECT_GT(inkedPixels(image, 10, 93, 110, 122), 10) << "a caption is below its own picture";
  EXPECT_EQ(inkedPixels(image, 120, 113, 220, 142), 0);
  EXPECT_GT(inkedPixels(image, 10, 225, 110, 254), 10);
}

// A page shows a sheet 900 pixels wide: letters of the caption are then 13 pixels.
TEST(Sheet, TextCanBeReadInAPage) {
  EXPECT_EQ(sheetTextSize(900), 13);
  EXPECT_EQ(sheetTextSize(1800), 26);
  EXPECT_EQ(sheetTextSize(300), 13) << "a small sheet is shown as it is";
  const Panel wide[] = {{"", "rms", evenImage(884, 10, {1, 0, 0})}, {"", "rms", evenImage(884, 10, {1, 0, 0})}};
  EXPECT_EQ(sheet(wide, 2).height, 16 + 10 + 7 + lineHeight({26}) + 16) << "1816 pixels wide";
}

TEST(Sheet, LongTextsMakeRowsHigherAndColumnsNoNarrowerThanAWord) {
  SheetSettings settings;
  settings.text_px = 12;
  settings.gap = 4;
  const Lettering caption{12}, title{14, true};
  const Panel wrapped[] = {{"T", "one two six", evenImage(textWidth("one two", caption), 20, {1, 0, 0})}};
  EXPECT_EQ(sheet(wrapped, 1, settings).height, 4 + (lineHeight(title) + 3) + 20 + (3 + 2 * lineHeight(caption)) + 4);
  const Panel narrow[] = {{"extraordinarily", "", evenImage(5, 5, {1, 0, 0})}};
  EXPECT_EQ(sheet(narrow, 1, settings).width, 4 + textWidth("extraordinarily", title) + 4);
}

TEST(Sheet, AnEmptyPanelIsPaper) {
  const Panel panels[] = {{"", "", evenImage(20, 20, {1, 0, 0})}, {}};
  const Image image = sheet(panels, 2);
  EXPECT_EQ(image.width, 3 * 16 + 2 * 20);
  for (int y = 0; y < image.height; ++y) ASSERT_EQ(image.at(70, y), SheetSettings{}.paper);
}

TEST(Sheet, NoPanelsAndNoColumns) {
  EXPECT_EQ(sheet({}, 3).height, SheetSettings{}.gap);
  EXPECT_THROW(sheet({}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
