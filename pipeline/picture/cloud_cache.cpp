#include "pipeline/picture/cloud_cache.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "core/error.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".cloud";
constexpr size_t kHashDigits = 32;

// Removes the files that were not used longest until the others have at most so many bytes.
void removeOldest(const fs::path& folder, uint64_t most_bytes) {
  struct Kept {
    fs::file_time_type used;
    uint64_t bytes;
    fs::path file;
  };
  std::vector<Kept> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == kEnding) all.push_back({entry.last_write_time(), entry.file_size(), entry.path()});
  std::sort(all.begin(), all.end(), [](const Kept& a, const Kept& b) { return a.used > b.used; });
  uint64_t sum = 0;
  for (const Kept& one : all)
    if (sum += one.bytes; sum > most_bytes) fs::remove(one.file);
}

std::optional<fs::path> absolutePathIn(const char* variable) {
  const char* value = std::getenv(variable);
  if (!value || !fs::path(value).is_absolute()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<fs::path> cloudCacheFolder() {
  if (const auto caches = absolutePathIn("XDG_CACHE_HOME")) return *caches / "cloudbake" / "clouds";
  if (const auto home = absolutePathIn("HOME")) return *home / ".cache" / "cloudbake" / "clouds";
  return std::nullopt;
}

CloudCache::CloudCache(std::optional<fs::path> folder, uint64_t most_bytes) : folder_(std::move(folder)), most_bytes_(most_bytes) {}

fs::path CloudCache::fileOf(const std::string& key) const { return *folder_ / (key + kEnding); }

// A file is the asset and its hash.
std::optional<std::string> CloudCache::find(const std::string& key) const {
  if (!folder_) return std::nullopt;
  try {
    std::string bytes = readFileBytes(fileOf(key));
    if (bytes.size() < kHashDigits) return std::nullopt;
    const std::string hash = bytes.substr(bytes.size() - kHashDigits);
    bytes.resize(bytes.size() - kHashDigits);
    if (hashBytes(bytes) != hash) return std::nullopt;
    std::error_code of_a_folder_that_is_only_read;
    fs::last_write_time(fileOf(key), fs::file_time_type::clock::now(), of_a_folder_that_is_only_read);
    return bytes;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void CloudCache::add(const std::string& key, const std::string& asset) const {
  if (!folder_ || asset.size() > most_bytes_) return;
  try {
    createFolder(*folder_);
    removeAbandonedFiles(*folder_);
    writeFileAtomically(fileOf(key), asset + hashBytes(asset));
    removeOldest(*folder_, most_bytes_);
  } catch (const Error&) {
  } catch (const fs::filesystem_error&) {  // another process has removed the file meanwhile
  }
}

}  // namespace cloudbake
