// Where panels and letters of a sheet come out.
#include "preview/compare/sheet.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

namespace cloudbake {
namespace {

constexpr Vec3 kInk{1, 1, 1};

Image evenImage(int width, int height, Vec3 color) {
  Image image = blankImage(width, height);
  for (Vec3& p : image.pixels) p = color;
  return image;
}

Image drawn(const std::string& text, int scale, int width = 400, int height = 80) {
  Image image = blankImage(width, height);
  drawText(image, 0, 0, text, scale, kInk);
  return image;
}

int inkedPixels(const Image& image, int left, int top, int right, int bottom) {
  int count = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) count += image.at(x, y) == kInk;
  return count;
}

int inkedPixels(const Image& image) { return inkedPixels(image, 0, 0, image.width, image.height); }

TEST(Sheet, EveryLetterHasAShapeOfItsOwn) {
  std::set<std::vector<float>> shapes;
  for (char c = '!'; c <= '~'; ++c) {
    const Image image = drawn(std::string(1, c), 1, 12, 16);
    const int width = textWidth(std::string(1, c), 1);
    EXPECT_GT(inkedPixels(image), 0) << c;
    EXPECT_GE(width, 2) << c;
    EXPECT_EQ(inkedPixels(image, 0, 0, std::min(width + 1, 12), 12), inkedPixels(image)) << c;  // in its line and advance
    std::vector<float> shape;
    for (const Vec3& p : image.pixels) shape.push_back(p.x);
    EXPECT_TRUE(shapes.insert(shape).second || c == '|') << c;  // as l
  }
  EXPECT_EQ(inkedPixels(drawn(" ", 1)), 0);
}

TEST(Sheet, CapitalIIsAnUprightWithSerifs) {
  const Image image = drawn("I", 1);
  // Seven dots high, its foot and head level strokes.
  int rows = 0;
  for (int y = 0; y < 12; ++y) rows += inkedPixels(image, 0, y, 8, y + 1) > 0;
  EXPECT_EQ(rows, 7);
}

TEST(Sheet, ScaleMakesDotsLarger) {
  const Image one = drawn("rms 0.03 g=-0.5", 1), two = drawn("rms 0.03 g=-0.5", 2);
  EXPECT_EQ(textWidth("rms 0.03 g=-0.5", 2), 2 * textWidth("rms 0.03 g=-0.5", 1));
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 200; ++x) ASSERT_EQ(two.at(2 * x + 1, 2 * y), one.at(x, y)) << x << ' ' << y;
}

TEST(Sheet, LinesAreTwelveDotsApart) {
  const Image both = drawn("A\nB", 1), first = drawn("A", 1), second = drawn("B", 1);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 10; ++x) {
      EXPECT_EQ(both.at(x, y), first.at(x, y));
      EXPECT_EQ(both.at(x, y + 12), second.at(x, y));
    }
  EXPECT_EQ(textWidth("wide line\nw", 1), textWidth("wide line", 1));
}

TEST(Sheet, WhatTheFontLacksIsAQuestionMark) {
  EXPECT_EQ(drawn("\t", 1).pixels, drawn("?", 1).pixels);
  EXPECT_EQ(drawn("\xcf\x83", 1).pixels, drawn("??", 1).pixels);
  EXPECT_EQ(textWidth("\xff", 1), textWidth("?", 1));
}

TEST(Sheet, TextBeyondTheImageIsLeftOut) {
  Image image = blankImage(10, 6), whole = blankImage(200, 60);
  drawText(image, -3, -4, "WWWWWW", 2, kInk);
  drawText(whole, 20 - 3, 20 - 4, "WWWWWW", 2, kInk);
  EXPECT_GT(inkedPixels(image), 0);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 10; ++x) EXPECT_EQ(image.at(x, y), whole.at(20 + x, 20 + y)) << x << ' ' << y;
  Image untouched = blankImage(10, 6);
  drawText(untouched, 50, 50, "W", 1, kInk);
  EXPECT_EQ(inkedPixels(untouched), 0);
}

TEST(Sheet, TextIsWrappedAtWords) {
  const int width = textWidth("one two", 1);
  EXPECT_EQ(wrapText("one two six", width, 1), "one two\nsix");
  EXPECT_EQ(wrapText("one two", width, 1), "one two");
  EXPECT_EQ(wrapText("one two", 2 * width - 1, 2), "one\ntwo");
  EXPECT_EQ(wrapText("one\ntwo six", width, 1), "one\ntwo six");
  EXPECT_EQ(wrapText("extraordinarily x", 5, 1), "extraordinarily\nx");
  EXPECT_EQ(wrapText("", 5, 1), "");
}

TEST(Sheet, LayoutHoldsEveryPanel) {
  const Vec3 red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1};
  const Panel panels[] = {
      {"Red", "a", evenImage(100, 50, red)}, {"Green", "", evenImage(80, 70, green)}, {"Blue", "c", evenImage(60, 40, blue)}};
  SheetSettings settings;
  settings.text_scale = 2;
  settings.gap = 10;
  settings.title_color = settings.caption_color = kInk;
  const Image image = sheet(panels, 2, settings);
  // Columns of 100 between gaps of 10; rows: a title of 24, the higher picture, a caption of 24.
  ASSERT_EQ(image.width, 10 + 2 * 110);
  ASSERT_EQ(image.height, 10 + (24 + 70 + 24 + 10) + (24 + 40 + 24 + 10));
  const auto is = [&](int left, int top, int width, int height, Vec3 color) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (!(image.at(left + x, top + y) == color)) return false;
    return true;
  };
  EXPECT_TRUE(is(10, 34, 100, 50, red));
  EXPECT_TRUE(is(120, 34, 80, 70, green));
  EXPECT_TRUE(is(10, 162, 60, 40, blue));
  EXPECT_TRUE(is(0, 0, 10, image.height, settings.paper));
  EXPECT_TRUE(is(120, 138, 110, 98, settings.paper));  // the place without a panel
  EXPECT_GT(inkedPixels(image, 10, 10, 110, 34), 50);  // titles and captions
  EXPECT_GT(inkedPixels(image, 120, 10, 220, 34), 50);
  EXPECT_GT(inkedPixels(image, 10, 104, 110, 128), 10);
  EXPECT_EQ(inkedPixels(image, 120, 104, 220, 128), 0);
  EXPECT_GT(inkedPixels(image, 10, 202, 110, 226), 10);
}

TEST(Sheet, LongTextsMakeRowsHigherAndColumnsNoNarrowerThanAWord) {
  SheetSettings settings;
  settings.text_scale = 1;
  settings.gap = 4;
  const Panel wrapped[] = {{"T", "one two six", evenImage(textWidth("one two", 1), 20, {1, 0, 0})}};
  EXPECT_EQ(sheet(wrapped, 1, settings).height, 4 + 12 + 20 + 24 + 4);
  const Panel narrow[] = {{"extraordinarily", "", evenImage(5, 5, {1, 0, 0})}};
  EXPECT_EQ(sheet(narrow, 1, settings).width, 4 + textWidth("extraordinarily", 1) + 4);
}

TEST(Sheet, NoPanelsAndNoColumns) {
  EXPECT_EQ(sheet({}, 3).height, SheetSettings{}.gap);
  EXPECT_THROW(sheet({}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
