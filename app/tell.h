// Prints and writes the report of a run.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "io/report/report.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Prints lines. Names in them may come from any file, so control characters become blanks (onOneLine).
void say(std::FILE* stream, std::string_view lines);

/// Prints warnings (stderr) and, unless -q, the report (stdout), and writes --json.
void tellReport(const RunSettings& settings, const BakeReport& report);
/// The same, with the members of `more` added to the JSON and `text` after the report.
void tellReport(const RunSettings& settings, const BakeReport& report, const Json& more, const std::string& text);

}  // namespace cloudbake
