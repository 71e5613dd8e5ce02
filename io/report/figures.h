// Error figures in reports: how each is named, stored, printed and bounded.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>

#include "core/figures.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

/// A line of a report: a label, and from column 15 the formatted text.
template <typename... Values>
std::string figureLine(const std::string& label, fmt::format_string<Values...> pattern, Values&&... values) {
  std::string line = label;
  line.resize(std::max<size_t>(15, line.size() + 1), ' ');
  return line + fmt::format(pattern, std::forward<Values>(values)...) + "\n";
}

/// Directions are in degrees, d in per cent of the mean thickness.
inline std::string lobeErrorLines(const LobeError& e) {
  return figureLine("direction", "rms {:.3f}°, median {:.3f}°, p95 {:.3f}°, max {:.2f}° (left out: {} with concentration < 0.1)",
                    e.angle_rms_degrees, e.angle_median_degrees, e.angle_p95_degrees, e.angle_max_degrees, e.left_out) +
         figureLine("density", "rms {:.3f} %, bias {:+.3f} % of the mean thickness", 100 * e.density_rms, 100 * e.density_bias);
}

/// The same as keys of an object: "left_out", "direction_degrees", "density" (a fraction of the mean thickness).
inline void addLobeError(Json& json, const LobeError& e) {
  json["left_out"] = e.left_out;
  json["direction_degrees"] = {
      {"rms", e.angle_rms_degrees}, {"median", e.angle_median_degrees}, {"p95", e.angle_p95_degrees}, {"max", e.angle_max_degrees}};
  json["density"] = {{"rms", e.density_rms}, {"bias", e.density_bias}};
}

/// One error figure of a bake.
struct FigureField {
  const char* key;      ///< key in JSON
  const char* subject;  ///< for people, the quantity: "direction"
  const char* what;     ///< and the kind of error: "rms"
  const char* unit;
  double scale;  ///< factor from the stored value to the unit
  bool may_be_negative;
  bool of_mean_lobe;  ///< does not apply to a fitted lobe
  double& (*value)(BakeFigures& figures);
  double of(const BakeFigures& figures) const { return value(const_cast<BakeFigures&>(figures)); }
};
std::span<const FigureField> figureFields();
/// The field with that key, which must exist.
const FigureField& figureField(std::string_view key);

/// "direction rms".
std::string figureName(const FigureField& field);
/// Three significant digits and the unit; "undefined" for a value that is not finite.
std::string figureText(const FigureField& field, double value);

/// An upper bound for the magnitude of a figure.
struct FigureBound {
  const FigureField* field;
  double most;
};
/// The first figure over its bound, as "direction is off by 12.3° rms, over 10°" (`verb`: "is off"); empty if no bound is exceeded. A NaN
/// is over its bound. Figures of the mean lobe are skipped if the bake is a fit.
std::string overBound(const BakeFigures& figures, std::span<const FigureBound> bounds, const std::string& verb = "is off");

}  // namespace cloudbake
