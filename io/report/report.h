// The report of a run: JSON for build systems, a few lines for people, and a JSON object for an error.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/figures.h"
#include "core/types.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

/// The target error of a bake and the error that was measured, on some vertices, compared with exact chords.
struct TargetReport {
  std::string quantity;  ///< "direction rms, degrees" or "transmittance rms"
  double target = 0, measured = 0;
  std::string truth;  ///< how the truth was computed
  uint64_t vertices = 0;
  int voxels = 0;  ///< chosen number along the longest side
};

/// The results of one run, for people and for the JSON report.
struct BakeReport {
  std::string command, input, output;
  AssetInfo info;
  std::vector<FitError> fit;  ///< one per σ; empty without a fit
  std::optional<TargetReport> target;
  std::optional<SurfaceError> surface_error;  ///< set if --vertices or --remesh gave a sculpt a new mesh
  std::optional<RepairSummary> repair;
  std::optional<RefineSummary> refine;
  std::vector<LevelFigures> levels;
  std::string volume_note;  ///< what closes the volume of an open sculpt
  std::optional<GrowthSummary> growth;
  uint64_t vertices = 0, triangles = 0, undefined_directions = 0;
  std::vector<std::pair<std::string, double>> seconds;  ///< per stage, in order
  std::string frame_note;                               ///< unit and up axis of a sculpt, and whether they were found, given or assumed
  Warnings warnings;
  Warnings findings;  ///< of --inspect; none of them harms a bake
};

/// [{"kind", "count", "first"}, …]
Json warningsJson(const Warnings& warnings);

/// One JSON object, "schema": "cloudbake-report-1", with keys in a fixed order, indented by two blanks, with a line end. Bytes that are
/// not valid UTF-8 (file names may contain any bytes) are replaced by U+FFFD.
std::string reportJson(const BakeReport& report);

/// If `strict` (--strict), throws InputError if there is any warning. Call this before anything is written.
void enforceStrict(bool strict, const BakeReport& report);
/// One line for stderr per kind of warning.
std::string warningLines(const BakeReport& report);
/// One line per kind of finding.
std::string findingLines(const BakeReport& report);

/// A report as text. A number that is not finite is undefined, and its key is left out.
std::string reportJsonText(Json json);
/// A few aligned lines, each with a line end. They do not include warnings.
std::string reportText(const BakeReport& report);

/// {"schema": "cloudbake-error-1", "code", "file", "line", "column", "message"} and a line end. `line` and `column` are 0 if unknown.
std::string errorJson(const Error& error);

}  // namespace cloudbake
