// Keeps grown clouds between runs, because it takes longer to grow the clouds of a scene than to draw them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace cloudbake {

/// Where the grown clouds of this user are kept: $XDG_CACHE_HOME/cloudbake/clouds, or $HOME/.cache/cloudbake/clouds. None if neither
/// variable is an absolute path (XDG Base Directory Specification 0.8).
std::optional<std::filesystem::path> cloudCacheFolder();

/// Assets in a folder by the hash of all that they are made from. Nothing here throws: what cannot be read, is damaged or cannot be written
/// costs the time to make it again.
class CloudCache {
 public:
  static constexpr uint64_t kMostBytes = 256 << 20;
  /// Without a folder, nothing is kept. Beyond `most_bytes`, the assets go that were not asked for longest.
  explicit CloudCache(std::optional<std::filesystem::path> folder, uint64_t most_bytes = kMostBytes);
  std::optional<std::string> find(const std::string& key) const;
  void add(const std::string& key, const std::string& asset) const;

 private:
  std::filesystem::path fileOf(const std::string& key) const;

  std::optional<std::filesystem::path> folder_;
  uint64_t most_bytes_;
};

}  // namespace cloudbake
