// The speed–error curve of `measure` as a table in CSV, JSON and Markdown.
#pragma once

#include <string>
#include <vector>

#include "core/figures.h"

namespace cloudbake {

/// One setting, with its cost and its error.
struct CurveRow {
  std::string method;                         ///< "rays", "sweep" or a peer's name
  std::string sampler, quadrature, field;     ///< field: "level set" or "coverage"; empty = does not apply
  int directions = 0, steps = 0, voxels = 0;  ///< N, S, voxels along the longest side; 0 = does not apply
  double seconds_field = 0, seconds_bake = 0;
  BakeFigures figures;
  double speedup_bake = 0, speedup_with_field = 0;  ///< seconds of the plain port / seconds of this row
  bool pareto = false;                              ///< no other row is at least as fast and as accurate, and better in one of the two

  double seconds() const { return seconds_field + seconds_bake; }
};

/// Fills the last three fields: the speedups relative to the row of the plain port (N and S of the rows may differ, so compare at equal
/// error), and the Pareto front of seconds() and the rms error of direction.
void rankCurve(std::vector<CurveRow>& rows, const CurveRow& plain);

/// A header line with the keys and a line per row, separated by "\n" and quoted as in RFC 4180. Values that do not apply or are not finite
/// are empty. Numbers read back as the same double.
std::string curveCsv(const std::vector<CurveRow>& rows);

/// {"schema": "cloudbake-curve-1", "rows": [{the same keys}, …]}, indented by two blanks, with a line end. Values that are empty in CSV are
/// null.
std::string curveJson(const std::vector<CurveRow>& rows);

/// A Markdown table, padded so that it is also readable in a terminal.
std::string curveMarkdown(const std::vector<CurveRow>& rows);

}  // namespace cloudbake
