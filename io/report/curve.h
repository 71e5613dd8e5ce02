// The speed–error curve of `measure` as a table: CSV, JSON, Markdown.
#pragma once

#include <string>
#include <vector>

#include "core/figures.h"

namespace cloudbake {

/// One setting, what it cost and how far it was from the truth.
struct CurveRow {
  std::string method;                         ///< "rays", "sweep" or a peer's name
  std::string sampler, quadrature, field;     ///< field: "level set", "coverage"; empty: does not apply
  int directions = 0, steps = 0, voxels = 0;  ///< N, S, along the longest side; 0: does not apply
  double seconds_field = 0, seconds_bake = 0;
  BakeFigures figures;
  double speedup_bake = 0, speedup_with_field = 0;  ///< seconds of the plain port / seconds of this row
  bool pareto = false;                              ///< no other row is as fast and as near, and better in one of them

  double seconds() const { return seconds_field + seconds_bake; }
};

/// Fills the last three fields: ratios to the row of the plain port (N and S of both rows as they are: compare at equal error), and
/// the front of seconds() against the rms error of direction.
void rankCurve(std::vector<CurveRow>& rows, const CurveRow& plain);

/// A header line of the keys and a line per row, ends of "\n", quoted as in RFC 4180. What does not apply or is not finite is empty.
/// Numbers read back to the same double.
std::string curveCsv(const std::vector<CurveRow>& rows);

/// {"schema": "cloudbake-curve-1", "rows": [{the same keys}, …]}, indented by two blanks, with a line end; null where CSV is empty.
std::string curveJson(const std::vector<CurveRow>& rows);

/// A Markdown table, padded so that it reads well in a terminal too.
std::string curveMarkdown(const std::vector<CurveRow>& rows);

}  // namespace cloudbake
