// What an input may cost: as much processor time as a loop of kMostTurns takes on the same machine, so that no bound is in seconds.
#pragma once

#include <ctime>

#include "tests/wait.h"

namespace cloudbake {

constexpr double kMostTurns = 5e8;
constexpr double kSanitizerCost = 8;  // times slower

/// Processor seconds of this process.
inline double cpuSeconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// Whether this is more processor time than an input may take.
inline bool isTooLong(double cpu_seconds, bool is_sanitized) {
  static const double seconds_per_turn = [] {
    constexpr int kTurns = 20'000'000;
    const double start = cpuSeconds();
    spin(kTurns);
    return (cpuSeconds() - start) / kTurns;
  }();
  return cpu_seconds > kMostTurns * seconds_per_turn * (is_sanitized ? kSanitizerCost : 1);
}

}  // namespace cloudbake
