// Colours: M. Okabe, K. Ito, "Color Universal Design", 2008. They can be distinguished with every common colour blindness; grey replaces
// yellow, which is faint on white. Shapes differ as well. Logarithms are computed in float, because the last bits of glibc's double
// logarithms differ between CPUs.
#include "io/report/plot.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/portable_math.h"
#include "core/text/maker.h"
#include "core/text/markup.h"
#include "core/text/utf8.h"

namespace cloudbake {

namespace {

constexpr std::array<const char*, 8> kColors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9", "#808080"};
constexpr const char* kInk = "#222222";
constexpr const char* kDefaultRing = "fill=\"none\" stroke=\"#222222\" stroke-width=\"3\"";
constexpr const char* kBetter = "\u2199 better";
constexpr size_t kMostLabels = 32;
constexpr double kLabelSize_px = 12, kTextSize_px = 14, kMarkScale = 1.2, kFrontRing_px = 9, kDefaultRing_px = 13;

std::string brief(double value) { return numberText(value, std::chars_format::general, 4); }

// An upper estimate of the width in sans-serif fonts.
double textWidth(const std::string& text, double size) { return 0.6 * size * double(codePoints(text)); }

// At most `most` characters; text that is cut off ends in "…".
std::string shortened(const std::string& text, size_t most) {
  if (codePoints(text) <= most) return text;
  size_t end = 0;
  for (size_t kept = 0; end < text.size(); ++end)
    if ((static_cast<unsigned char>(text[end]) & 0xC0) != 0x80 && ++kept == most) break;
  return text.substr(0, end) + "…";
}

double logTen(double value) { return portableLog(value) * 0.43429448190325183; }

bool drawable(const PlotPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0 && p.y > 0; }

/// Maps log10 of a quantity to pixels.
struct Axis {
  double low = -1, high = 1;     // decades
  double begin = 0, length = 0;  // pixels; length < 0 for an axis that points upwards
  double at(double decades) const { return begin + length * (decades - low) / (high - low); }
};

// The range of the values with a margin, at least one decade.
Axis axisFor(const std::vector<double>& decades, double begin, double length) {
  Axis axis{-1, 1, begin, length};
  if (decades.empty()) return axis;
  const auto [least, most] = std::minmax_element(decades.begin(), decades.end());
  const double air = std::max(0.06 * (*most - *least) + 0.08, (1 - (*most - *least)) / 2);
  axis.low = *least - air, axis.high = *most + air;
  return axis;
}

struct Tick {
  double decades;
  bool strong;
  std::string label;
};

// Lines are drawn at the decades and between them. Labels are at the decades, and also at 2 and 5 if there are few decades. If there are
// many decades, only some get lines and labels.
std::vector<Tick> ticksOf(const Axis& axis) {
  const double span = axis.high - axis.low;
  const int every = std::max(1, int(span / 10)), first = int(std::floor(axis.low));
  std::vector<Tick> ticks;
  for (int k = first; k <= axis.high; k += every)
    for (int m = 1; m <= (span > 7 ? 1 : 9); ++m) {
      const double decades = k + logTen(m);
      if (decades < axis.low || decades > axis.high) continue;
      const bool labelled = m == 1 || (span < 2.5 && (m == 2 || m == 5));
      double value = 0;
      const std::string text = std::to_string(m) + "e" + std::to_string(k);
      std::from_chars(text.data(), text.data() + text.size(), value);
      ticks.push_back({decades, m == 1, labelled ? brief(value) : ""});
    }
  return ticks;
}

struct Rect {
  double x0, y0, x1, y1;
  bool overlaps(const Rect& r) const { return x0 < r.x1 && r.x0 < x1 && y0 < r.y1 && r.y0 < y1; }
  bool holds(const Rect& r) const { return r.x0 >= x0 && r.x1 <= x1 && r.y0 >= y0 && r.y1 <= y1; }
};

/// A point that is drawn, in pixels.
struct Mark {
  size_t series, index;
  double x, y;
  bool front = false;
};

struct Layout {
  Rect frame;
  Axis x_axis, y_axis;
  double legend_x = 0;
  size_t left_out = 0;
  std::vector<Mark> marks;
  std::vector<size_t> front;  // indices of marks, by ascending x
};

const PlotPoint& pointOf(const ScatterPlot& plot, const Mark& mark) { return plot.series[mark.series].points[mark.index]; }

constexpr size_t kLegendCharacters = 34;

Layout layOut(const ScatterPlot& plot) {
  double legend_width = textWidth("Pareto front", kTextSize_px);
  for (const PlotSeries& s : plot.series)
    legend_width = std::max(legend_width, textWidth(shortened(s.name, kLegendCharacters), kTextSize_px));
  Layout layout;
  layout.frame = {84, 46, plot.width - std::min(legend_width + 50, 0.35 * plot.width), plot.height - 82.0};
  layout.legend_x = layout.frame.x1 + 16;

  // Points that have a logarithm.
  std::vector<PlotPoint> points;
  std::vector<double> xs, ys;
  for (size_t s = 0; s < plot.series.size(); ++s)
    for (size_t i = 0; i < plot.series[s].points.size(); ++i) {
      const PlotPoint& p = plot.series[s].points[i];
      if (!drawable(p)) {
        ++layout.left_out;
        continue;
      }
      layout.marks.push_back({s, i, 0, 0});
      points.push_back({p.x, p.y, {}}), xs.push_back(logTen(p.x)), ys.push_back(logTen(p.y));
    }

  const Rect& f = layout.frame;
  layout.x_axis = axisFor(xs, f.x0, f.x1 - f.x0), layout.y_axis = axisFor(ys, f.y1, f.y0 - f.y1);
  for (size_t i = 0; i < points.size(); ++i) layout.marks[i].x = layout.x_axis.at(xs[i]), layout.marks[i].y = layout.y_axis.at(ys[i]);
  layout.front = paretoFront(points);
  for (const size_t i : layout.front) layout.marks[i].front = true;
  return layout;
}

std::string line(double x0, double y0, double x1, double y1) {
  return "<path d=\"M" + numberText(x0) + " " + numberText(y0) + "L" + numberText(x1) + " " + numberText(y1) + "\"/>\n";
}

std::string text(double x, double y, const std::string& content, const std::string& attributes = {}) {
  return "<text x=\"" + numberText(x) + "\" y=\"" + numberText(y) + "\"" + (attributes.empty() ? "" : " " + attributes) + ">" +
         escapedMarkup(content) + "</text>\n";
}

// Seven shapes of about equal visual weight and eight colours give 7 · 8 series before a pair repeats.
std::string marker(size_t style, double x, double y, const std::string& tooltip) {
  constexpr std::array<const char*, 7> kShapes = {"M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z",
                                                  "M-4 -4H4V4H-4Z",
                                                  "M0 -5.4L5.2 3.8H-5.2Z",
                                                  "M0 -5.8L5.8 0L0 5.8L-5.8 0Z",
                                                  "M-1.6 -5.2H1.6V-1.6H5.2V1.6H1.6V5.2H-1.6V1.6H-5.2V-1.6H-1.6Z",
                                                  "M0 5.4L5.2 -3.8H-5.2Z",
                                                  "M0 -5.6L5.3 -1.7L3.3 4.5H-3.3L-5.3 -1.7Z"};
  return "<path transform=\"translate(" + numberText(x) + " " + numberText(y) + ") scale(" + numberText(kMarkScale) + ")\" fill=\"" +
         kColors[style % kColors.size()] + "\" d=\"" + kShapes[style % kShapes.size()] + "\">" +
         (tooltip.empty() ? "" : "<title>" + escapedMarkup(tooltip) + "</title>") + "</path>\n";
}

std::string drawGrid(const Layout& layout) {
  const Rect& f = layout.frame;
  std::string weak, strong, labels_x, labels_y;
  for (const Tick& tick : ticksOf(layout.x_axis)) {
    const double x = layout.x_axis.at(tick.decades);
    (tick.strong ? strong : weak) += line(x, f.y0, x, f.y1);
    if (!tick.label.empty()) labels_x += text(x, f.y1 + 20, tick.label);
  }
  for (const Tick& tick : ticksOf(layout.y_axis)) {
    const double y = layout.y_axis.at(tick.decades);
    (tick.strong ? strong : weak) += line(f.x0, y, f.x1, y);
    if (!tick.label.empty()) labels_y += text(f.x0 - 8, y + 5, tick.label);
  }
  return "<g stroke=\"#EEEEEE\">\n" + weak + "</g>\n<g stroke=\"#CCCCCC\">\n" + strong + "</g>\n<g text-anchor=\"middle\">\n" + labels_x +
         "</g>\n<g text-anchor=\"end\">\n" + labels_y + "</g>\n";
}

std::string drawTitles(const ScatterPlot& plot, const Layout& layout) {
  const Rect& f = layout.frame;
  const double middle_x = (f.x0 + f.x1) / 2, middle_y = (f.y0 + f.y1) / 2;
  // A long title is set smaller, down to 12 pixels, and then cut off. Bold letters are a little wider.
  const double room = (plot.width - 24) / 1.1, title_size = std::clamp(room / textWidth(plot.title, 1), 12.0, 18.0);
  std::string svg = text(plot.width / 2.0, 27, shortened(plot.title, size_t(room / textWidth(".", title_size))),
                         "text-anchor=\"middle\" font-weight=\"bold\" font-size=\"" + numberText(title_size) + "\"");
  svg += text(middle_x, f.y1 + 46, plot.x_title, "text-anchor=\"middle\"");
  svg += text(20, middle_y, plot.y_title, "text-anchor=\"middle\" transform=\"rotate(-90 20 " + numberText(middle_y) + ")\"");
  svg += text(f.x0 + 12, f.y1 - 14, kBetter, "fill=\"#595959\"");
  if (layout.marks.empty()) svg += text(middle_x, middle_y, "no points", "text-anchor=\"middle\"");
  if (layout.left_out > 0)
    svg += text(middle_x, f.y1 + 68,
                std::to_string(layout.left_out) + (layout.left_out == 1 ? " point" : " points") + " left out: zero, negative or not finite",
                "text-anchor=\"middle\" font-size=\"12\" fill=\"#595959\"");
  return svg;
}

std::string ring(double x, double y, double radius, const std::string& attributes = {}) {
  return "<circle cx=\"" + numberText(x) + "\" cy=\"" + numberText(y) + "\" r=\"" + numberText(radius) + "\"" +
         (attributes.empty() ? "" : " " + attributes) + "/>\n";
}

std::string drawLegend(const ScatterPlot& plot, const Layout& layout) {
  double y = layout.frame.y0 + 10;
  std::string svg;
  const auto entry = [&](const std::string& sign, const std::string& name) {
    svg += sign + text(layout.legend_x + 22, y + 5, shortened(name, kLegendCharacters));
    y += 25;
  };
  std::vector<std::string> names;
  for (const PlotSeries& s : plot.series) {
    if (std::find(names.begin(), names.end(), s.name) != names.end()) continue;
    names.push_back(s.name);
    entry(marker(s.style, layout.legend_x + 5, y, ""), s.name);
  }
  const auto has_default = [&](const Mark& m) { return pointOf(plot, m).is_default; };
  if (std::any_of(layout.marks.begin(), layout.marks.end(), has_default))
    entry(ring(layout.legend_x + 5, y, kFrontRing_px, kDefaultRing), "default");
  if (!layout.front.empty())
    entry("<g fill=\"none\" stroke=\"" + std::string(kInk) + "\">" + line(layout.legend_x - 7, y, layout.legend_x + 17, y) +
              ring(layout.legend_x + 5, y, kFrontRing_px) + "</g>\n",
          "Pareto front");
  return svg;
}

// The line goes from the top edge through the points to the right edge. It shows the least y that is available for at most x.
std::string drawFront(const Layout& layout) {
  if (layout.front.empty()) return {};
  std::string path, rings;
  for (const size_t i : layout.front) {
    const Mark& m = layout.marks[i];
    path += path.empty() ? "M" + numberText(m.x) + " " + numberText(layout.frame.y0) : "H" + numberText(m.x);
    path += "V" + numberText(m.y);
    rings += ring(m.x, m.y, kFrontRing_px);
  }
  return "<g fill=\"none\" stroke=\"" + std::string(kInk) + "\">\n<path stroke-dasharray=\"5 3\" d=\"" + path + "H" +
         numberText(layout.frame.x1) + "\"/>\n" + rings + "</g>\n";
}

// Lines that join the marks of a series.
std::string drawLines(const ScatterPlot& plot, const Layout& layout) {
  std::string svg = "<g fill=\"none\" stroke-width=\"1.5\" stroke-opacity=\"0.55\">\n";
  for (size_t s = 0; s < plot.series.size(); ++s) {
    if (plot.series[s].line_label.empty()) continue;
    std::string path;
    for (const Mark& m : layout.marks)
      if (m.series == s) path += (path.empty() ? "M" : "L") + numberText(m.x) + " " + numberText(m.y);
    if (!path.empty()) svg += "<path stroke=\"" + std::string(kColors[plot.series[s].style % kColors.size()]) + "\" d=\"" + path + "\"/>\n";
  }
  return svg + "</g>\n";
}

std::string drawMarks(const ScatterPlot& plot, const Layout& layout) {
  std::string svg = "<g stroke=\"#FFFFFF\" stroke-width=\"0.7\">\n", rings;
  for (const Mark& m : layout.marks) {
    const PlotPoint& p = pointOf(plot, m);
    const PlotSeries& series = plot.series[m.series];
    const std::string line_label = series.line_label.empty() ? "" : ", " + series.line_label;
    svg += marker(series.style, m.x, m.y, series.name + line_label + ", " + p.label + ": " + brief(p.x) + ", " + brief(p.y));
    if (p.is_default) rings += ring(m.x, m.y, kDefaultRing_px, kDefaultRing);
  }
  return svg + "</g>\n" + rings;
}

/// A text that wants to be beside a mark.
struct Wish {
  size_t mark;
  std::string label;
  bool bold = false;
};

// In the order in which they are placed: the default, the names of lines, the front, the ends of each series, and the rest.
std::vector<Wish> wishesOf(const ScatterPlot& plot, const Layout& layout) {
  std::array<std::vector<Wish>, 5> ranked;
  for (size_t i = 0; i < layout.marks.size(); ++i) {
    const Mark& m = layout.marks[i];
    const PlotSeries& series = plot.series[m.series];
    const PlotPoint& p = series.points[m.index];
    const bool is_last = m.index + 1 == series.points.size(), is_end = m.index == 0 || is_last;
    if (is_last && !series.line_label.empty()) ranked[1].push_back({i, series.line_label, true});
    if (p.is_default)
      ranked[0].push_back({i, "default" + (p.label.empty() ? "" : ", " + p.label), true});
    else if (!p.label.empty() && !(is_last && !series.line_label.empty()))
      ranked[m.front ? 2 : is_end ? 3 : 4].push_back({i, p.label});
  }
  std::vector<Wish> wishes;
  for (const auto& rank : ranked) wishes.insert(wishes.end(), rank.begin(), rank.end());
  return wishes;
}

// Greedy: a label gets the first of twelve places around its mark that is free of marks and labels. If none is free, there is no label.
std::string drawLabels(const ScatterPlot& plot, const Layout& layout) {
  std::vector<Rect> taken;
  for (const Mark& m : layout.marks) taken.push_back({m.x - 7, m.y - 7, m.x + 7, m.y + 7});
  taken.push_back({layout.frame.x0, layout.frame.y1 - 30, layout.frame.x0 + 20 + textWidth(kBetter, kTextSize_px), layout.frame.y1});
  std::string svg = "<g font-size=\"" + numberText(kLabelSize_px, std::chars_format::general, 3) +
                    "\" stroke=\"#FFFFFF\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\">\n";
  size_t drawn = 0;
  for (const Wish& wish : wishesOf(plot, layout)) {
    if (drawn == kMostLabels) break;
    const Mark& m = layout.marks[wish.mark];
    const double w = textWidth(wish.label, kLabelSize_px * (wish.bold ? 1.08 : 1)), h = kLabelSize_px;
    const double away = pointOf(plot, m).is_default ? kDefaultRing_px + 5 : 12, right = m.x + away, left = m.x - away - w,
                 center = m.x - w / 2;
    const std::array<std::array<double, 2>, 12> places = {{{right, m.y - h - 3},
                                                           {left, m.y + 4},
                                                           {right, m.y - h / 2},
                                                           {left, m.y - h / 2},
                                                           {center, m.y - h - away},
                                                           {center, m.y + away},
                                                           {left, m.y - h - 3},
                                                           {right, m.y + 4},
                                                           {right, m.y - h - 14},
                                                           {left, m.y + 14},
                                                           {right, m.y + 14},
                                                           {left, m.y - h - 14}}};
    for (const auto& [x, y] : places) {
      const Rect box{x - 2, y - 1, x + w + 2, y + h + 1};
      if (!layout.frame.holds(box) || std::any_of(taken.begin(), taken.end(), [&](const Rect& r) { return r.overlaps(box); })) continue;
      taken.push_back(box);
      svg += text(x, y + h - 2, wish.label, wish.bold ? "font-weight=\"bold\"" : "");
      ++drawn;
      break;
    }
  }
  return svg + "</g>\n";
}

}  // namespace

std::vector<size_t> paretoFront(std::span<const PlotPoint> points) {
  std::vector<size_t> order;
  for (size_t i = 0; i < points.size(); ++i)
    if (!std::isnan(points[i].x) && !std::isnan(points[i].y)) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return points[a].x != points[b].x ? points[a].x < points[b].x : points[a].y < points[b].y; });
  std::vector<size_t> front;
  for (const size_t i : order) {
    const PlotPoint& p = points[i];
    if (front.empty() || p.y < points[front.back()].y || (p.x == points[front.back()].x && p.y == points[front.back()].y))
      front.push_back(i);
  }
  return front;
}

std::string scatterSvg(const ScatterPlot& plot) {
  const Layout layout = layOut(plot);
  const Rect& f = layout.frame;
  const std::string width = std::to_string(plot.width), height = std::to_string(plot.height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " +
         height + "\" font-family=\"sans-serif\" font-size=\"14\" fill=\"" + kInk + "\">\n<desc>" + std::string(kMaker) +
         "</desc>\n<title>" + escapedMarkup(plot.title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n" +
         drawGrid(layout) + "<path fill=\"none\" stroke=\"" + kInk + "\" d=\"M" + numberText(f.x0) + " " + numberText(f.y0) + "V" +
         numberText(f.y1) + "H" + numberText(f.x1) + "\"/>\n" + drawTitles(plot, layout) + drawLines(plot, layout) + drawFront(layout) +
         drawMarks(plot, layout) + drawLabels(plot, layout) + drawLegend(plot, layout) + "</svg>\n";
}

}  // namespace cloudbake
