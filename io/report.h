// What a run tells: JSON for build systems, a few lines for people, an object for an error.
#pragma once

#include <string>

#include "core/error.h"
#include "core/types.h"
#include "io/asset_info.h"

namespace cloudbake {

/// [{"kind", "count", "first"}, …]
Json warningsJson(const Warnings& warnings);

/// One JSON object, "schema": "cloudbake-report-1", keys in a fixed order, indented by two blanks, with a line end. Text that is
/// no UTF-8 (a file name may be anything) has its wrong bytes replaced by U+FFFD.
std::string reportJson(const BakeReport& report);

/// A few aligned lines with a line end each; warnings are not among them.
std::string reportText(const BakeReport& report);

/// {"schema": "cloudbake-error-1", "code", "file", "line", "column", "message"} and a line end. `line` and `column` are 0 where unknown.
std::string errorJson(const Error& error);

}  // namespace cloudbake
