// What this program is: its version, and the bytes of its build.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cloudbake {

/// "cloudbake VERSION", then a line per library with its name and the version that it was built with. If a library of the system was
/// replaced since and reports another version at run time, the line has that version too.
std::string versionText();

/// The libraries of ours that take part in a bake, as far as the program does not contain them (late/).
std::vector<std::filesystem::path> bakeLibraries();

/// The hash of the program file, of bakeLibraries() and of the versions of other libraries. What two builds make may differ if theirs do.
const std::string& buildHash();

}  // namespace cloudbake
