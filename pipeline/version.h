// What this program is made of.
#pragma once

#include <string>

namespace cloudbake {

/// "cloudbake VERSION", then a line per library: its name and the version that it was built with; where the system's own, which may have
/// been replaced since, can tell its version and it differs, that too.
std::string versionText();

}  // namespace cloudbake
