// Draws scatter plots on logarithmic axes as SVG text.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace cloudbake {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label{};      ///< short, e.g. "N=100"; shown if there is room, and always in the tooltip
  bool is_default = false;  ///< has a ring and the label "default"
};

/// Points of one kind. Series of one name have one entry of the legend.
struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
  size_t style = 0;          ///< of kPlotStyles pairs of colour and shape
  std::string line_label{};  ///< if not empty, a line joins the points in their order, and this is at its end; also in the tooltip
};
inline constexpr size_t kPlotStyles = 56;

struct ScatterPlot {
  std::string title, x_title, y_title;  ///< axis titles include the unit; UTF-8, invalid bytes become U+FFFD
  std::vector<PlotSeries> series;       ///< in the order of the legend
  int width = 900, height = 600;        ///< pixels, ≥ 400 × 300; texts are for a page that shows it 900 wide
};

/// The points that no other point dominates, by ascending x. A point dominates another if it is not greater in x or y and less in one of
/// them. Equal points are all included; a point with a NaN is not.
std::vector<size_t> paretoFront(std::span<const PlotPoint> points);

/// One SVG document. The same plot gives the same text on any machine. Less is better on both axes: the Pareto front of all series is a
/// stepped line, and its points are ringed. Points that are not finite or not > 0 are left out, and their number is shown below the axis.
/// At most 32 labels are drawn, the default's, those of lines and of the front first, and labels never overlap.
std::string scatterSvg(const ScatterPlot& plot);

}  // namespace cloudbake
