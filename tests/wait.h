// Waiting for events, however slow or busy the machine is: only what hangs takes as long as kHangs.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace cloudbake {

inline constexpr std::chrono::seconds kHangs{600};

/// Whether `holds()` becomes true. For what no other thread reports.
template <class Holds>
bool comesTrue(const Holds& holds) {
  for (const auto end = std::chrono::steady_clock::now() + kHangs; !holds(); std::this_thread::sleep_for(std::chrono::milliseconds(10)))
    if (std::chrono::steady_clock::now() > end) return false;
  return true;
}

/// Threads that come here wait until `count` have come. Those that come later do not wait.
class Meeting {
 public:
  explicit Meeting(size_t count) : count_(count) {}
  /// Whether enough have come.
  bool come() {
    std::unique_lock lock(mutex_);
    ++come_;
    met_.notify_all();
    return met_.wait_for(lock, kHangs, [&] { return come_ >= count_; });
  }

 private:
  const size_t count_;
  size_t come_ = 0;
  std::mutex mutex_;
  std::condition_variable met_;
};

/// Works without a result, so that others may do what they must not do meanwhile. A turn takes about a nanosecond.
inline void spin(int turns) {
  for (volatile int i = 0; i < turns;) i = i + 1;
}

}  // namespace cloudbake
