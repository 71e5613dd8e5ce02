// Measures the seconds of the stages of a run.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

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
  void lap(StageSeconds& seconds, const std::string& stage);
  /// Seconds since construction.
  double elapsed() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::function<void(const std::string&)> on_lap_;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

}  // namespace cloudbake
