// What the tests of sculpts share.
#pragma once

#include <string>

namespace cloudbake {

/// The first bytes of a PNG are enough where nobody decodes it.
inline const std::string kPng = std::string("\x89PNG\r\n\x1A\n") + "rest";

}  // namespace cloudbake
