#include "io/report/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <regex>

#include "core/random.h"
#include "tests/io/report/report_helpers.h"

using namespace cloudbake;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// Well-formed as far as our output goes: every tag is closed in order, no bare & or <, no quote left open.
void expectWellFormed(const std::string& svg) {
  static const std::regex token("<(/?)([a-z]+)((?: [a-zA-Z-]+=\"[^\"<]*\")*)(/?)>|&(?:amp|lt|gt|quot|#39|#10);|[^<>&]");
  std::vector<std::string> open;
  auto end = svg.cbegin();
  for (std::sregex_iterator it(svg.begin(), svg.end(), token), last; it != last; ++it) {
    ASSERT_EQ((*it)[0].first, end) << "stray text: " << std::string(end, std::min(end + 60, svg.cend()));
    end = (*it)[0].second;
    if (!(*it)[2].matched) continue;
    if ((*it)[1].length() > 0) {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), (*it)[2]);
      open.pop_back();
    } else if ((*it)[4].length() == 0) {
      open.push_back((*it)[2]);
    }
  }
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(end, svg.cend());
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

ScatterPlot onePoint() { return {"title", "seconds", "degrees", {{"rays", {{0.5, 2, "N=100"}}, 1}}, 900, 600}; }

// Time ~ N, error ~ 1/√N over eight methods of unlike constants: 80 points.
ScatterPlot manyPoints() {
  ScatterPlot plot{"bear.off, 13,826 vertices, 2 threads: error of direction against time of the bake",
                   "seconds of field and bake",
                   "rms error of direction, degrees",
                   {},
                   900,
                   600};
  const std::pair<const char*, double> methods[] = {{"sweep, coverage", 0.002}, {"sweep, level set", 0.006}, {"rays, fibonacci", 0.02},
                                                    {"rays, stratified", 0.03}, {"rays, uniform", 0.03},     {"plain port", 0.5},
                                                    {"OpenVDB HDDA", 0.2},      {"Embree, all hits", 0.15}};
  for (const auto& [name, scale] : methods) {
    PlotSeries series{name, {}, plot.series.size()};
    const double level = std::string(name) == "rays, uniform" ? 90 : std::string(name) == "rays, stratified" ? 46 : 18;
    for (int k = 0; k < 10; ++k) {
      const int n = 16 << (k / 2);
      const double steps = k % 2 ? 200 : 50;
      series.points.push_back({scale * n / 100 * (0.3 + steps / 100), level / std::sqrt(n) + 20 / steps, "N=" + std::to_string(n)});
    }
    plot.series.push_back(series);
  }
  return plot;
}

struct LabelBox {
  double x0, y0, x1, y1;
};

// The labels of points, which alone stand in the group of their font size, as rectangles of a narrow font.
std::vector<LabelBox> labelBoxes(const std::string& svg) {
  const size_t begin = svg.find("<g font-size=\"12\"");
  const std::string group = svg.substr(begin, svg.find("</g>", begin) - begin);
  static const std::regex text("<text x=\"([-0-9.]+)\" y=\"([-0-9.]+)\"[^>]*>([^<]*)</text>");
  std::vector<LabelBox> boxes;
  for (std::sregex_iterator it(group.begin(), group.end(), text), last; it != last; ++it) {
    const double x = std::stod((*it)[1]), y = std::stod((*it)[2]);
    boxes.push_back({x, y - 9, x + 6 * double((*it)[3].length()), y});
  }
  return boxes;
}

void expectApart(const std::vector<LabelBox>& boxes) {
  for (size_t i = 0; i < boxes.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      EXPECT_FALSE(boxes[i].x0 < boxes[j].x1 && boxes[j].x0 < boxes[i].x1 && boxes[i].y0 < boxes[j].y1 && boxes[j].y0 < boxes[i].y1);
}

}  // namespace

// Against the definition, on lattices so small that equal coordinates and equal points are common.
TEST(Plot, ParetoFrontIsWhatNothingDominates) {
  for (uint64_t set = 0; set < 300; ++set) {
    std::vector<PlotPoint> points;
    for (uint32_t i = 0; i < set % 40; ++i)
      points.push_back({double(hashDraw(set, i, 0) % (3 + set % 17)), double(hashDraw(set, i, 1) % (3 + set % 13)), ""});
    if (set % 3 == 0) points.push_back({kNaN, -1, ""}), points.push_back({-1, kNaN, ""});
    std::vector<size_t> expected;
    for (size_t i = 0; i < points.size(); ++i) {
      const PlotPoint& p = points[i];
      const bool dominated = std::any_of(points.begin(), points.end(),
                                         [&](const PlotPoint& q) { return q.x <= p.x && q.y <= p.y && (q.x < p.x || q.y < p.y); });
      if (!dominated && p.x == p.x && p.y == p.y) expected.push_back(i);
    }
    auto front = paretoFront(points);
    for (size_t i = 1; i < front.size(); ++i) ASSERT_LE(points[front[i - 1]].x, points[front[i]].x);
    std::sort(front.begin(), front.end());
    ASSERT_EQ(front, expected) << set;
  }
  EXPECT_TRUE(paretoFront({}).empty());
  EXPECT_EQ(paretoFront(std::vector<PlotPoint>{{kInf, 0, ""}, {1, 1, ""}, {kInf, 2, ""}}), (std::vector<size_t>{1, 0}));
}

TEST(Plot, SmallestPlots) {
  ScatterPlot equal = onePoint();
  equal.series[0].points.assign(5, {3, 3, "same"});
  for (const ScatterPlot& plot : {ScatterPlot{}, ScatterPlot{"t", "x", "y", {{"empty", {}}}, 400, 300}, onePoint(), equal})
    expectWellFormed(scatterSvg(plot));
  EXPECT_EQ(count(scatterSvg(ScatterPlot{}), "no points"), 1U);
  EXPECT_EQ(count(scatterSvg(onePoint()), ">N=100</text>"), 1U);
  EXPECT_EQ(count(scatterSvg(onePoint()), "rays, N=100: 0.5, 2</title>"), 1U);
  EXPECT_GE(labelBoxes(scatterSvg(equal)).size(), 1U);
  expectApart(labelBoxes(scatterSvg(equal)));
}

TEST(Plot, WhatHasNoLogarithmIsLeftOutAndCounted) {
  ScatterPlot plot = onePoint();
  EXPECT_EQ(count(scatterSvg(plot), "left out"), 0U);
  for (const double bad : {0.0, -1.0, kInf, -kInf, kNaN})
    plot.series[0].points.push_back({bad, 1, "bad"}), plot.series[0].points.push_back({1, bad, "bad"});
  const std::string svg = scatterSvg(plot);
  expectWellFormed(svg);
  EXPECT_EQ(count(svg, "10 points left out"), 1U);
  EXPECT_EQ(count(svg, "bad"), 0U);
}

TEST(Plot, ExtremesOfDouble) {
  ScatterPlot plot = onePoint();
  plot.series[0].points.push_back({5e-324, 1e300, "far"});
  plot.series[0].points.push_back({1e300, 5e-324, "far"});
  const std::string svg = scatterSvg(plot);
  expectWellFormed(svg);
  EXPECT_LT(svg.size(), 20000U);
}

TEST(Plot, TextIsEscaped) {
  ScatterPlot plot = onePoint();
  plot.title = "a<b> & \"c\"\n\x01 bad\xFF";
  plot.series[0].name = "</svg>";
  const std::string svg = scatterSvg(plot);
  expectWellFormed(svg);
  EXPECT_EQ(count(svg, "a&lt;b&gt; &amp; &quot;c&quot;&#10; bad\xEF\xBF\xBD"), 2U);
  EXPECT_EQ(count(svg, "</svg>"), 1U);
}

// On two decades per axis a known point lands where arithmetic puts it: grid lines at 0.1, 1 and 10.
TEST(Plot, PointsLieOnTheirGridLines) {
  ScatterPlot plot = onePoint();
  plot.series[0].points = {{0.1, 10, "a"}, {1, 1, "b"}, {10, 0.1, "c"}};
  const std::string svg = scatterSvg(plot);
  static const std::regex mark("<path transform=\"translate\\(([-0-9.]+) ([-0-9.]+)\\)[^>]*><title>rays, b");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(svg, match, mark));
  const size_t begin = svg.find("#CCCCCC");
  const std::string grid = svg.substr(begin, svg.find("</g>", begin) - begin);
  EXPECT_EQ(count(grid, "<path"), 6U);
  EXPECT_EQ(count(grid, "M" + match[1].str() + " "), 1U);
  EXPECT_EQ(count(grid, " " + match[2].str() + "L"), 1U);
  for (const char* label : {">0.1</text>", ">1</text>", ">10</text>"}) EXPECT_EQ(count(svg, label), 2U) << label;
}

// Every mark is drawn and told apart; labels are few and none lies over another.
TEST(Plot, ManyPointsStayLegible) {
  const ScatterPlot plot = manyPoints();
  const std::string svg = scatterSvg(plot);
  expectWellFormed(svg);
  EXPECT_EQ(svg, scatterSvg(plot));
  EXPECT_EQ(count(svg, "translate("), 80U + plot.series.size());
  std::vector<PlotPoint> all;
  for (const PlotSeries& s : plot.series) all.insert(all.end(), s.points.begin(), s.points.end());
  EXPECT_EQ(count(svg, "r=\"9.0\""), paretoFront(all).size() + 1);
  const std::vector<LabelBox> boxes = labelBoxes(svg);
  EXPECT_GE(boxes.size(), 12U);
  EXPECT_LE(boxes.size(), 32U);
  expectApart(boxes);
}

// A label of 30 characters goes to the left of a mark at the right edge: the frame ends at 749, where the legend begins.
TEST(Plot, LabelsStayInTheFrame) {
  ScatterPlot plot = onePoint();
  plot.series[0].points = {{0.01, 1, std::string(30, 'w')}, {10, 0.1, std::string(30, 'w')}};
  const std::vector<LabelBox> boxes = labelBoxes(scatterSvg(plot));
  EXPECT_EQ(boxes.size(), 2U);
  for (const LabelBox& box : boxes) EXPECT_TRUE(box.x0 >= 84 && box.x1 <= 749.2 && box.y0 >= 46 && box.y1 <= 518);
}

// A wide legend takes at most 35 % of the plot, a narrow one as much as it needs.
TEST(Plot, TheLegendLeavesRoomForPoints) {
  const auto rightmost = [](const std::string& name, int width) {
    ScatterPlot plot = onePoint();
    plot.width = width;
    plot.series[0].name = name;
    plot.series[0].points = {{0.01, 1, ""}, {10, 0.1, ""}};
    static const std::regex mark("d=\"M([-0-9.]+)");
    const std::string svg = scatterSvg(plot);
    double most = 0;
    for (std::sregex_iterator it(svg.begin(), svg.end(), mark), last; it != last; ++it) most = std::max(most, std::stod((*it)[1]));
    return most;
  };
  EXPECT_GT(rightmost("rays", 1800), 0.8 * 1800);
  EXPECT_LT(rightmost(std::string(34, 'w'), 1800), 1800 - 34 * 0.6 * 14) << "no letter of the legend lies outside";
  EXPECT_GT(rightmost(std::string(60, 'w'), 600), 0.5 * 600);
}

// Series of one name look alike and are one entry of the legend; what each line is for is written at its end.
TEST(Plot, LinesOfOneMethodAreOneEntry) {
  ScatterPlot plot = onePoint();
  plot.series = {{"sweep", {{0.1, 3, "N=16"}, {1, 1, "N=100"}}, 0, "35 voxels"},
                 {"sweep", {{0.2, 2, "N=16"}, {2, 0.5, "N=100"}}, 0, "100 voxels"}};
  const std::string svg = scatterSvg(plot);
  expectWellFormed(svg);
  EXPECT_EQ(count(svg, ">sweep</text>"), 1U);
  EXPECT_EQ(count(svg, "font-weight=\"bold\">35 voxels</text>"), 1U);
  EXPECT_EQ(count(svg, "font-weight=\"bold\">100 voxels</text>"), 1U);
  EXPECT_EQ(count(svg, "<path stroke=\"#0072B2\""), 2U);
  EXPECT_EQ(count(svg, "<title>sweep, 35 voxels, N=16: 0.1, 3</title>"), 1U);
  plot.series[1].line_label.clear();
  EXPECT_EQ(count(scatterSvg(plot), "<path stroke=\"#0072B2\""), 1U) << "points without a line";
}

TEST(Plot, TheDefaultIsMarked) {
  ScatterPlot plot = manyPoints();
  EXPECT_EQ(count(scatterSvg(plot), "default"), 0U);
  plot.series[1].points[4].is_default = true;
  const std::string svg = scatterSvg(plot);
  expectWellFormed(svg);
  EXPECT_EQ(count(svg, "r=\"13.0\""), 1U);
  EXPECT_EQ(count(svg, ">default</text>"), 1U) << "in the legend";
  EXPECT_EQ(count(svg, "font-weight=\"bold\">default, N=64</text>"), 1U);
  expectApart(labelBoxes(svg));
}

// Colours and shapes repeat, their pairs do not.
TEST(Plot, SeriesAreToldApart) {
  ScatterPlot plot = onePoint();
  plot.series.assign(kPlotStyles, plot.series[0]);
  for (size_t i = 0; i < kPlotStyles; ++i) plot.series[i].style = i, plot.series[i].name += std::to_string(i);
  const std::string svg = scatterSvg(plot);
  static const std::regex look("fill=\"(#[0-9A-F]+)\" d=\"([^\"]+)\"><title>");
  std::vector<std::string> looks;
  for (std::sregex_iterator it(svg.begin(), svg.end(), look), last; it != last; ++it) looks.push_back((*it)[1].str() + (*it)[2].str());
  EXPECT_EQ(looks.size(), kPlotStyles);
  std::sort(looks.begin(), looks.end());
  EXPECT_EQ(std::unique(looks.begin(), looks.end()), looks.end());
}
