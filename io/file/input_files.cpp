#include "io/file/input_files.h"

namespace cloudbake {

namespace fs = std::filesystem;

Error changedWhileRead(const fs::path& file) {
  return {ExitCode::kTryAgain, file.string(), 0, 0, "the file was changed while it was read: run again"};
}

std::string InputFiles::read(const fs::path& file) {
  const std::lock_guard lock(mutex_);
  const auto [entry, is_new] = seen_.try_emplace(file.lexically_normal());
  Seen& seen = entry->second;
  if (is_new) try {
      seen.bytes = reader_(file);
      seen.hash = hashBytes(*seen.bytes);
      seen.is_late = is_sealed_;
    } catch (const Error&) {
      seen.error = std::current_exception();
    }
  if (seen.error) std::rethrow_exception(seen.error);
  if (!seen.bytes) try {
      seen.bytes = reader_(file);
      if (hashBytes(*seen.bytes) != seen.hash) throw changedWhileRead(file);
    } catch (const IoError&) {
      throw changedWhileRead(file);
    }
  if (!is_sealed_ && keeps_bytes_) return *seen.bytes;
  std::string bytes = std::move(*seen.bytes);
  seen.bytes.reset();
  return bytes;
}

std::vector<fs::path> InputFiles::late() const {
  const std::lock_guard lock(mutex_);
  std::vector<fs::path> files;
  for (const auto& [file, seen] : seen_)
    if (seen.is_late) files.push_back(file);
  return files;
}

}  // namespace cloudbake
