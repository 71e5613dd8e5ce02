#include "pipeline/fields/stopwatch.h"

#include <algorithm>

namespace cloudbake {

void addSeconds(StageSeconds& sums, const std::string& name, double seconds) {
  const auto found = std::find_if(sums.begin(), sums.end(), [&name](const auto& sum) { return sum.first == name; });
  if (found != sums.end())
    found->second += seconds;
  else
    sums.emplace_back(name, seconds);
}

void Stopwatch::lap(StageSeconds& seconds, const std::string& stage) {
  const auto now = Clock::now();
  const double passed = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  if (on_lap_) on_lap_(stage);
  addSeconds(seconds, stage, passed);
}

double Stopwatch::elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

}  // namespace cloudbake
