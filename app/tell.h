// Prints and writes the report of a run.
#pragma once

#include <string>

#include "io/report/report.h"
#include "pipeline/settings.h"

namespace cloudbake {

/// Prints warnings (stderr) and, unless -q, the report (stdout), and writes --json.
void tellReport(const RunSettings& settings, const BakeReport& report);
/// The same, with `more` under a key of the JSON and `text` after the report.
void tellReport(const RunSettings& settings, const BakeReport& report, const char* key, const Json& more, const std::string& text);

}  // namespace cloudbake
