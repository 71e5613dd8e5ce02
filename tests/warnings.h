// What tests ask of warnings.
#pragma once

#include "core/error.h"

namespace cloudbake {

/// How often a kind was added.
inline uint64_t countOf(const Warnings& warnings, WarningKind kind) {
  const auto found = warnings.entries().find(kind);
  return found == warnings.entries().end() ? 0 : found->second.count;
}

}  // namespace cloudbake
