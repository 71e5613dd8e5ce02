// The versions of this program and of its libraries.
#pragma once

#include <string>

namespace cloudbake {

/// "cloudbake VERSION", then a line per library with its name and the version that it was built with. If a library of the system was
/// replaced since and reports another version at run time, the line has that version too.
std::string versionText();

}  // namespace cloudbake
