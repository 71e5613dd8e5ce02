// Letters of sheets.
#include "preview/compare/lettering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>
#include <string>

namespace cloudbake {
namespace {

constexpr Vec3 kInk{1, 1, 1};

Image drawn(const std::string& text, const Lettering& lettering, int width = 400, int height = 80, int x = 0) {
  Image image = blankImage(width, height);
  drawText(image, x, 0, text, lettering, kInk);
  return image;
}

std::vector<float> shapeOf(const Image& image) {
  std::vector<float> shape;
  for (const Vec3& p : image.pixels) shape.push_back(p.x);
  return shape;
}

float inkOf(const Image& image) {
  const std::vector<float> shape = shapeOf(image);
  return std::accumulate(shape.begin(), shape.end(), 0.0F);
}

// Rows from the first to the last that have ink.
std::pair<int, int> rowsOf(const Image& image) {
  std::pair<int, int> rows{-1, -1};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (image.at(x, y).x > 0.3F) rows = {rows.first < 0 ? y : rows.first, y};
  return rows;
}

TEST(Lettering, EveryCharacterHasAShapeOfItsOwn) {
  for (const bool bold : {false, true}) {
    std::set<std::vector<float>> shapes;
    for (char c = '!'; c <= '~'; ++c) {
      const Image image = drawn(std::string(1, c), {32, bold}, 60, 60, 10);
      EXPECT_GT(inkOf(image), 1) << c;
      EXPECT_GT(textWidth(std::string(1, c), {32, bold}), 4) << c;
      EXPECT_TRUE(shapes.insert(shapeOf(image)).second) << c;
    }
    for (const char* sign : {"\u00b0", "\u00d7", "\u2212", "\u03c3", "\u2264", "\u00fc", "\u2026"})
      EXPECT_TRUE(shapes.insert(shapeOf(drawn(sign, {32, bold}, 60, 60, 10))).second) << sign;
  }
  EXPECT_EQ(inkOf(drawn(" ", {32})), 0);
}

// Inter's capitals are 1490 of 2048 units high, and every edge lies on the baseline.
TEST(Lettering, ACapitalHasTheHeightOfTheSize) {
  for (const float size : {16.0F, 40.0F}) {
    const auto [top, bottom] = rowsOf(drawn("H", {size}));
    EXPECT_EQ(bottom, int(size) - 1) << "the baseline";
    EXPECT_NEAR(bottom + 1 - top, 0.7275 * double(size), 1);
  }
}

// The stem of an "l" lies between pixels: a hard edge would have two values.
TEST(Lettering, EdgesAreSmooth) {
  std::set<float> values;
  const Image image = drawn("Oo", {24});
  for (const Vec3& p : image.pixels) values.insert(p.x);
  EXPECT_GT(values.size(), 20U);
}

TEST(Lettering, InkIsBlendedWithThePicture) {
  Image paper = blankImage(200, 60);
  for (Vec3& p : paper.pixels) p = {0.5F, 0.25F, 0};
  const Image black = drawn("rms", {24}, 200, 60);
  drawText(paper, 0, 0, "rms", {24}, {1, 0, 0});
  for (size_t i = 0; i < paper.pixels.size(); ++i) {
    const float share = black.pixels[i].x;
    ASSERT_NEAR(paper.pixels[i].x, 0.5F + 0.5F * share, 1e-6) << i;
    ASSERT_NEAR(paper.pixels[i].y, 0.25F * (1 - share), 1e-6) << i;
  }
}

TEST(Lettering, WidthsGrowWithTheSize) {
  const std::string text = "rms 0.03, SSIM 0.951";
  EXPECT_NEAR(textWidth(text, {40}), 2 * textWidth(text, {20}), 2);
  EXPECT_GT(textWidth(text, {20, true}), textWidth(text, {20}));
  EXPECT_LT(textWidth("AV", {40}), textWidth("A", {40}) + textWidth("V", {40}) - 1) << "a pair is kerned";
  EXPECT_EQ(textWidth("wide line\nw", {20}), textWidth("wide line", {20}));
  EXPECT_EQ(textWidth("", {20}), 0);
}

TEST(Lettering, LinesAreOneHeightApart) {
  const Lettering lettering{20};
  const int height = lineHeight(lettering);
  EXPECT_EQ(height, 26);
  const Image both = drawn("A\nB", lettering), first = drawn("A", lettering), second = drawn("B", lettering);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 40; ++x) {
      ASSERT_EQ(both.at(x, y), first.at(x, y));
      ASSERT_EQ(both.at(x, y + height), second.at(x, y));
    }
}

TEST(Lettering, WhatTheTypefaceLacksIsAQuestionMark) {
  const Lettering lettering{20};
  EXPECT_EQ(drawn("\t", lettering).pixels, drawn("?", lettering).pixels);
  EXPECT_EQ(drawn("\u96f2", lettering).pixels, drawn("?", lettering).pixels) << "a character of three bytes";
  EXPECT_EQ(drawn("\xff\xc3(", lettering).pixels, drawn("\?\?(", lettering).pixels);
  EXPECT_EQ(textWidth("\xff", lettering), textWidth("?", lettering));
  EXPECT_EQ(textWidth("\xe9\x9b", lettering), textWidth("??", lettering)) << "a character that ends too early";
}

TEST(Lettering, TextBeyondTheImageIsLeftOut) {
  const Lettering lettering{20};
  Image image = blankImage(10, 12), whole = blankImage(200, 60);
  drawText(image, -3, -4, "WWWWWW", lettering, kInk);
  drawText(whole, 20 - 3, 20 - 4, "WWWWWW", lettering, kInk);
  EXPECT_GT(inkOf(image), 1);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 10; ++x) ASSERT_EQ(image.at(x, y), whole.at(20 + x, 20 + y)) << x << ' ' << y;
  Image untouched = blankImage(10, 6);
  drawText(untouched, 50, 50, "W", lettering, kInk);
  EXPECT_EQ(inkOf(untouched), 0);
}

TEST(Lettering, TextIsWrappedAtWords) {
  const Lettering lettering{20};
  const int width = textWidth("one two", lettering);
  EXPECT_EQ(wrapText("one two six", width, lettering), "one two\nsix");
  EXPECT_EQ(wrapText("one two", width, lettering), "one two");
  EXPECT_EQ(wrapText("one two", width - 1, lettering), "one\ntwo");
  EXPECT_EQ(wrapText("one\ntwo six", width, lettering), "one\ntwo six");
  EXPECT_EQ(wrapText("extraordinarily x", 5, lettering), "extraordinarily\nx");
  EXPECT_EQ(wrapText("", 5, lettering), "");
}

}  // namespace
}  // namespace cloudbake
