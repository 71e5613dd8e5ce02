// Colours: M. Okabe, K. Ito, "Color Universal Design", 2008. They can be distinguished with every common colour blindness; grey replaces
// yellow, which is faint on white. Shapes differ as well. Logarithms are computed in float, because the last bits of glibc's double
// logarithms differ between CPUs.
#include "io/report/plot.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/text/maker.h"
#include "core/text/markup.h"
#include "core/text/utf8.h"

namespace cloudbake {

namespace {

constexpr std::array<const char*, 8> kColors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9", "#808080"};
constexpr const char* kInk = "#333333";
constexpr size_t kMostLabels = 24;
constexpr double kLabelSize_px = 11, kTextSize_px = 12.5;

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

double logTen(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return (exponent + double(std::log2(float(mantissa)))) * 0.30102999566398120;
}

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
  layout.frame = {76, 46, plot.width - std::min(legend_width + 50, 0.35 * plot.width), plot.height - 78.0};
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
std::string marker(size_t series, double x, double y, const std::string& tooltip) {
  constexpr std::array<const char*, 7> kShapes = {"M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z",
                                                  "M-4 -4H4V4H-4Z",
                                                  "M0 -5.4L5.2 3.8H-5.2Z",
                                                  "M0 -5.8L5.8 0L0 5.8L-5.8 0Z",
                                                  "M-1.6 -5.2H1.6V-1.6H5.2V1.6H1.6V5.2H-1.6V1.6H-5.2V-1.6H-1.6Z",
                                                  "M0 5.4L5.2 -3.8H-5.2Z",
                                                  "M0 -5.6L5.3 -1.7L3.3 4.5H-3.3L-5.3 -1.7Z"};
  return "<path transform=\"translate(" + numberText(x) + " " + numberText(y) + ")\" fill=\"" + kColors[series % kColors.size()] +
         "\" d=\"" + kShapes[series % kShapes.size()] + "\">" + (tooltip.empty() ? "" : "<title>" + escapedMarkup(tooltip) + "</title>") +
         "</path>\n";
}

std::string drawGrid(const Layout& layout) {
  const Rect& f = layout.frame;
  std::string weak, strong, labels_x, labels_y;
  for (const Tick& tick : ticksOf(layout.x_axis)) {
    const double x = layout.x_axis.at(tick.decades);
    (tick.strong ? strong : weak) += line(x, f.y0, x, f.y1);
    if (!tick.label.empty()) labels_x += text(x, f.y1 + 18, tick.label);
  }
  for (const Tick& tick : ticksOf(layout.y_axis)) {
    const double y = layout.y_axis.at(tick.decades);
    (tick.strong ? strong : weak) += line(f.x0, y, f.x1, y);
    if (!tick.label.empty()) labels_y += text(f.x0 - 8, y + 4, tick.label);
  }
  return "<g stroke=\"#EEEEEE\">\n" + weak + "</g>\n<g stroke=\"#CCCCCC\">\n" + strong + "</g>\n<g text-anchor=\"middle\">\n" + labels_x +
         "</g>\n<g text-anchor=\"end\">\n" + labels_y + "</g>\n";
}

std::string drawTitles(const ScatterPlot& plot, const Layout& layout) {
  const Rect& f = layout.frame;
  const double middle_x = (f.x0 + f.x1) / 2, middle_y = (f.y0 + f.y1) / 2;
  // A long title is set smaller, down to 11 pixels, and then cut off. Bold letters are a little wider.
  const double room = (plot.width - 24) / 1.1, title_size = std::clamp(room / textWidth(plot.title, 1), 11.0, 16.0);
  std::string svg = text(plot.width / 2.0, 27, shortened(plot.title, size_t(room / textWidth(".", title_size))),
                         "text-anchor=\"middle\" font-weight=\"bold\" font-size=\"" + numberText(title_size) + "\"");
  svg += text(middle_x, f.y1 + 42, plot.x_title, "text-anchor=\"middle\"");
  svg += text(20, middle_y, plot.y_title, "text-anchor=\"middle\" transform=\"rotate(-90 20 " + numberText(middle_y) + ")\"");
  if (layout.marks.empty()) svg += text(middle_x, middle_y, "no points", "text-anchor=\"middle\"");
  if (layout.left_out > 0)
    svg += text(middle_x, f.y1 + 63,
                std::to_string(layout.left_out) + (layout.left_out == 1 ? " point" : " points") + " left out: zero, negative or not finite",
                "text-anchor=\"middle\" font-size=\"11\" fill=\"#666666\"");
  return svg;
}

std::string drawLegend(const ScatterPlot& plot, const Layout& layout) {
  double y = layout.frame.y0 + 10;
  std::string svg;
  const auto entry = [&](const std::string& sign, const std::string& name) {
    svg += sign + text(layout.legend_x + 20, y + 4, shortened(name, kLegendCharacters));
    y += 21;
  };
  for (size_t s = 0; s < plot.series.size(); ++s) entry(marker(s, layout.legend_x + 5, y, ""), plot.series[s].name);
  if (layout.front.empty()) return svg;
  entry("<g fill=\"none\" stroke=\"" + std::string(kInk) + "\">" + line(layout.legend_x - 7, y, layout.legend_x + 17, y) + "<circle cx=\"" +
            numberText(layout.legend_x + 5) + "\" cy=\"" + numberText(y) + "\" r=\"8\"/></g>\n",
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
    rings += "<circle cx=\"" + numberText(m.x) + "\" cy=\"" + numberText(m.y) + "\" r=\"8\"/>\n";
  }
  return "<g fill=\"none\" stroke=\"" + std::string(kInk) + "\">\n<path stroke-dasharray=\"5 3\" d=\"" + path + "H" +
         numberText(layout.frame.x1) + "\"/>\n" + rings + "</g>\n";
}

std::string drawMarks(const ScatterPlot& plot, const Layout& layout) {
  std::string svg = "<g stroke=\"#FFFFFF\" stroke-width=\"0.7\">\n";
  for (const Mark& m : layout.marks) {
    const PlotPoint& p = pointOf(plot, m);
    svg += marker(m.series, m.x, m.y, plot.series[m.series].name + ", " + p.label + ": " + brief(p.x) + ", " + brief(p.y));
  }
  return svg + "</g>\n";
}

// Marks in the order in which they get a label: the front, then the ends of each series, then the rest.
std::vector<size_t> labelOrder(const ScatterPlot& plot, const Layout& layout) {
  const auto rank = [&](size_t i) {
    const Mark& m = layout.marks[i];
    return m.front ? 0 : m.index == 0 || m.index + 1 == plot.series[m.series].points.size() ? 1 : 2;
  };
  std::vector<size_t> order(layout.marks.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return rank(a) < rank(b); });
  return order;
}

// Greedy: a label gets the first of eight places around its mark that is free of marks and labels. If none is free, there is no label.
std::string drawLabels(const ScatterPlot& plot, const Layout& layout) {
  std::vector<Rect> taken;
  for (const Mark& m : layout.marks) taken.push_back({m.x - 6, m.y - 6, m.x + 6, m.y + 6});
  std::string svg = "<g font-size=\"11\" stroke=\"#FFFFFF\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\">\n";
  size_t drawn = 0;
  for (const size_t i : labelOrder(plot, layout)) {
    const Mark& m = layout.marks[i];
    const std::string& label = pointOf(plot, m).label;
    if (label.empty()) continue;
    if (drawn == kMostLabels) break;
    const double w = textWidth(label, kLabelSize_px), h = kLabelSize_px, right = m.x + 10, left = m.x - 10 - w, center = m.x - w / 2;
    const std::array<std::array<double, 2>, 8> places = {{{right, m.y - h - 3},
                                                          {left, m.y + 4},
                                                          {right, m.y - h / 2},
                                                          {left, m.y - h / 2},
                                                          {center, m.y - h - 10},
                                                          {center, m.y + 10},
                                                          {left, m.y - h - 3},
                                                          {right, m.y + 4}}};
    for (const auto& [x, y] : places) {
      const Rect box{x - 2, y - 1, x + w + 2, y + h + 1};
      if (!layout.frame.holds(box) || std::any_of(taken.begin(), taken.end(), [&](const Rect& r) { return r.overlaps(box); })) continue;
      taken.push_back(box);
      svg += text(x, y + h - 2, label);
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
         height + "\" font-family=\"sans-serif\" font-size=\"12.5\" fill=\"" + kInk + "\">\n<desc>" + std::string(kMaker) +
         "</desc>\n<title>" + escapedMarkup(plot.title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n" +
         drawGrid(layout) + "<path fill=\"none\" stroke=\"" + kInk + "\" d=\"M" + numberText(f.x0) + " " + numberText(f.y0) + "V" +
         numberText(f.y1) + "H" + numberText(f.x1) + "\"/>\n" + drawTitles(plot, layout) + drawFront(layout) + drawMarks(plot, layout) +
         drawLabels(plot, layout) + drawLegend(plot, layout) + "</svg>\n";
}

}  // namespace cloudbake
