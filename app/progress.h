// How far a batch is: bars on a terminal, lines elsewhere.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace cloudbake {

/// May be called from any thread.
class Progress {
 public:
  /// `total` assets of `total_cost` seconds, roughly, are to come. With `quiet` nothing is shown.
  Progress(size_t total, double total_cost, bool quiet);
  ~Progress();
  void start(const std::string& name, int stages);
  void stage(const std::string& name, const std::string& finished);
  /// One asset is done; `line` is shown where there are no bars.
  void finish(const std::string& name, double cost, const std::string& line);
  /// Whole lines for stderr, above the bars; also with `quiet`.
  void tell(const std::string& lines);

 private:
  struct Running {
    int stages = 0, done = 0;
    std::string last;
  };
  void draw(bool now);
  void clear();
  std::string overallBar() const;
  std::string barOf(const std::string& name, const Running& running) const;

  const size_t total_;
  const double total_cost_;
  const bool quiet_, bars_, colours_;
  std::mutex mutex_;
  std::map<std::string, Running> running_;
  size_t done_ = 0, lines_ = 0;
  double done_cost_ = 0;
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), drawn_{};
};

}  // namespace cloudbake
