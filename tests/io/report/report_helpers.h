// What the tests of reports share.
#pragma once

#include <limits>
#include <string>

namespace cloudbake {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// How often `piece` is in `text`.
inline size_t count(const std::string& text, const std::string& piece) {
  size_t n = 0;
  for (size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + piece.size())) ++n;
  return n;
}

}  // namespace cloudbake
