// Measures the seconds of the stages of a run, and announces long stages.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/fields/work.h"

namespace cloudbake {

using StageSeconds = std::vector<std::pair<std::string, double>>;

/// Adds to the sum of this name, or appends a new sum.
void addSeconds(StageSeconds& sums, const std::string& name, double seconds);

/// Measures stages: each lap adds the seconds since the last lap, or since construction, to its stage.
class Stopwatch {
 public:
  Stopwatch() = default;
  /// `on_lap` is called at the end of every stage.
  explicit Stopwatch(std::function<void(const std::string& stage)> on_lap) : on_lap_(std::move(on_lap)) {}
  /// `on_work` is called before a stage of which something is known.
  Stopwatch(std::function<void(const std::string& stage)> on_lap, std::function<void(const StageWork& work)> on_work)
      : on_lap_(std::move(on_lap)), on_work_(std::move(on_work)) {}
  void lap(StageSeconds& seconds, const std::string& stage);
  void announce(const StageWork& work) const {
    if (on_work_) on_work_(work);
  }
  /// Seconds since construction.
  double elapsed() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::function<void(const std::string&)> on_lap_;
  std::function<void(const StageWork&)> on_work_;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

}  // namespace cloudbake
