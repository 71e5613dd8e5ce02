// What the tests of sculpts share.
#pragma once

#include <string>

#include "core/error.h"

namespace cloudbake {

/// The first bytes of a PNG are enough where nobody decodes it.
inline const std::string kPng = std::string("\x89PNG\r\n\x1A\n") + "rest";

inline uint64_t countOf(const Warnings& warnings, WarningKind kind) {
  const auto found = warnings.entries().find(kind);
  return found == warnings.entries().end() ? 0 : found->second.count;
}

}  // namespace cloudbake
