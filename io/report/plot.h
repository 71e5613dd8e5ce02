// Scatter plots on logarithmic axes, as SVG text.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace cloudbake {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  ///< short, e.g. "N=100"; shown where there is room, and as a tooltip in any case
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
};

struct ScatterPlot {
  std::string title, x_title, y_title;  ///< axis titles with their units; UTF-8, wrong bytes become U+FFFD
  std::vector<PlotSeries>
      series;                     ///< in the order of the legend; 56 pairs of colour and shape, a series keeps its own whatever is left out
  int width = 900, height = 600;  ///< pixels, ≥ 400 × 300
};

/// Which points no other one dominates (one that is nowhere greater and somewhere less), by ascending x. Equal points all stay; one
/// that is not a number in x or y is not part of it.
std::vector<size_t> paretoFront(std::span<const PlotPoint> points);

/// One SVG document, the same text for the same plot on any machine. Less is better on both axes: the Pareto front of all series is a
/// stepped line and its points are ringed. Points that are not finite or not > 0 are left out, and counted below the axis.
/// At most 24 labels are drawn, those of the front first, and none over another.
std::string scatterSvg(const ScatterPlot& plot);

}  // namespace cloudbake
