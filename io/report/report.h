// What a run tells: JSON for build systems, a few lines for people, an object for an error.
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

/// What was asked of a bake and what it was measured to keep, on some vertices against exact chords.
struct TargetReport {
  std::string quantity;  ///< "direction rms, degrees" or "transmittance rms"
  double target = 0, measured = 0;
  std::string truth;  ///< how it was found
  uint64_t vertices = 0;
  int voxels = 0;  ///< chosen, along the longest side
};

/// What one run did, for people and for the JSON report.
struct BakeReport {
  std::string command, input, output;
  AssetInfo info;
  std::vector<FitError> fit;  ///< one per σ; empty without a fit
  std::optional<TargetReport> target;
  std::optional<SurfaceError> surface_error;  ///< where --vertices or --remesh gave a sculpt a new mesh
  std::optional<RepairSummary> repair;
  std::string volume_note;  ///< what bounds the volume of an open sculpt
  std::optional<GrowthSummary> growth;
  uint64_t vertices = 0, triangles = 0, undefined_directions = 0;
  std::vector<std::pair<std::string, double>> seconds;  ///< per stage, in order
  std::string frame_note;                               ///< unit and up axis of a sculpt: found, given or assumed
  Warnings warnings;
  Warnings findings;  ///< of --inspect: nothing that spoils a bake
};

/// [{"kind", "count", "first"}, …]
Json warningsJson(const Warnings& warnings);

/// One JSON object, "schema": "cloudbake-report-1", keys in a fixed order, indented by two blanks, with a line end. Text that is
/// no UTF-8 (a file name may be anything) has its wrong bytes replaced by U+FFFD.
std::string reportJson(const BakeReport& report);

/// With --strict (`strict`), throws InputError if anything was warned of. To be called before anything is written.
void enforceStrict(bool strict, const BakeReport& report);
/// A line for stderr per kind of warning.
std::string warningLines(const BakeReport& report);
/// A line per kind of finding.
std::string findingLines(const BakeReport& report);

/// A few aligned lines with a line end each; warnings are not among them.
std::string reportText(const BakeReport& report);

/// {"schema": "cloudbake-error-1", "code", "file", "line", "column", "message"} and a line end. `line` and `column` are 0 where unknown.
std::string errorJson(const Error& error);

}  // namespace cloudbake
