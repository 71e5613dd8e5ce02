// The words that a file of cloudbake has, so that cloudbake knows it again.
#pragma once

#include <string_view>

namespace cloudbake {

/// They are in every file that is written under a name which the user did not spell out: "cloudbake 1.2.3".
inline constexpr std::string_view kMaker = "cloudbake " CLOUDBAKE_VERSION;

/// Whether a text or the bytes of a file have these words, of any version.
bool namesMaker(std::string_view bytes);

}  // namespace cloudbake
