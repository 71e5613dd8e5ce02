// Shows the progress of a batch (bars on a terminal, lines elsewhere), and announces long stages of a single bake.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

#include "pipeline/batch/run.h"
#include "pipeline/fields/stopwatch.h"

namespace cloudbake {

/// A stopwatch that announces a long stage on a terminal, with its expected seconds and memory.
Stopwatch watchOnTerminal(bool quiet);

class Progress : public BatchListener {
 public:
  /// With `quiet` only the lines given to `tell` are shown.
  explicit Progress(bool quiet);
  ~Progress() override;
  void begin(size_t assets, double cost_seconds) override;
  void start(const std::string& name, int stages) override;
  void stage(const std::string& name, const std::string& finished) override;
  /// `line` is shown if there are no bars.
  void finish(const std::string& name, double cost_seconds, const std::string& line) override;
  void postpone(const std::string& name) override;
  /// Writes lines to stderr, above the bars.
  void tell(const std::string& lines) override;
  /// Removes the bars.
  void clear();

 private:
  struct Running {
    int stages = 0, done = 0;
    std::string last;
  };
  void draw(bool now);
  std::string overallBar() const;
  std::string barOf(const std::string& name, const Running& running) const;

  const bool quiet_, bars_, colours_;
  size_t total_ = 0;
  double total_cost_ = 0;
  std::mutex mutex_;
  std::map<std::string, Running> running_;
  size_t done_ = 0, lines_ = 0;
  double done_cost_ = 0;
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), drawn_{};
};

}  // namespace cloudbake
