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

/// One error figure of a bake.
struct FigureField {
  const char* key;      ///< key in JSON
  const char* subject;  ///< for people, the quantity: "direction"
  const char* what;     ///< and the kind of error: "rms"
  const char* unit;
  double scale;  ///< factor from the stored value to the unit
  int decimals;  ///< in a line of a report
  bool may_be_negative;
  bool of_mean_lobe;  ///< does not apply to a fitted lobe
  double& (*value)(BakeFigures& figures);
  double of(const BakeFigures& figures) const { return value(const_cast<BakeFigures&>(figures)); }
};
std::span<const FigureField> figureFields();
/// The keys that --max-surface-rms bounds.
inline constexpr const char* kSurfaceRmsKeys[] = {"surface_vertex_rms", "surface_pixel_rms"};
/// The field with that key, which must exist.
const FigureField& figureField(std::string_view key);

/// "direction rms".
std::string figureName(const FigureField& field);
/// Three significant digits and the unit; "undefined" for a value that is not finite.
std::string figureText(const FigureField& field, double value);

/// What the lobes of an asset are judged by, for people: "T", or "the volume's light".
inline const char* judgedLight(const AssetInfo& info) { return info.volume ? "the volume's light" : "T"; }

/// A line for the direction in degrees, and one for d in per cent of the mean thickness.
std::string lobeErrorLines(const LobeError& error);
/// The same as keys of an object: "left_out", "direction_degrees", "density" (a fraction of the mean thickness).
void addLobeError(Json& json, const LobeError& error);

/// A line for the light between the vertices. `what` is what lobes are judged by: judgedLight.
std::string surfaceErrorLine(const SurfaceLightError& error, const std::string& what);
/// The same as key "surface" of an object, if it was measured.
void addSurfaceError(Json& json, const SurfaceLightError& error);

/// An upper bound for the magnitude of a figure.
struct FigureBound {
  const FigureField* field;
  double most;
};
/// The first figure over its bound, as "direction is off by 12.3° rms, over 10°" (`verb`: "is off"); empty if no bound is exceeded. A NaN
/// is over its bound. Figures of the mean lobe are skipped if the bake is a fit.
std::string overBound(const BakeFigures& figures, std::span<const FigureBound> bounds, const std::string& verb = "is off");

}  // namespace cloudbake
