// Finds out that files have changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

namespace cloudbake {

/// Watches a file and those that it refers to, by their time of modification, size and identity (device and inode). Call `changed` every
/// few tens of milliseconds.
class FileWatch {
 public:
  using List = std::function<std::vector<std::filesystem::path>()>;

  /// `list` names the files, the first one included. It is called now and before a change is reported, because a change of one file can
  /// make it refer to others. It must not throw.
  explicit FileWatch(List list);

  /// Whether a file has changed since the watch began or last reported a change, and all files have come to rest. A file that is being
  /// written, or has vanished or is empty for a moment because it is being replaced, is not at rest: a change is reported in the second
  /// call that finds the same state, and one that lacks a file or all its bytes in call kPatience.
  bool changed();
  static constexpr int kPatience = 20;

 private:
  // What stat(2) says: device, inode, size in bytes, time in nanoseconds; only zeros for a file that is not there.
  struct Stamp {
    uint64_t device = 0, inode = 0;
    int64_t size = 0, nanoseconds = 0;
    bool operator==(const Stamp&) const = default;
  };
  using State = std::vector<std::pair<std::filesystem::path, Stamp>>;
  static State stateOf(const std::vector<std::filesystem::path>& files);
  State now() const;
  bool lacksBytes() const;

  List list_;
  State known_, seen_;
  int calls_with_same_state_ = 0;
};

}  // namespace cloudbake
