#include "io/file/file_watch.h"

#include "io/file/system_file.h"

namespace cloudbake {

FileWatch::FileWatch(List list) : list_(std::move(list)), known_(stateOf(list_())), seen_(known_) {}

bool FileWatch::changed() {
  State state = now();
  calls_with_same_state_ = state == seen_ ? calls_with_same_state_ + 1 : 1;
  seen_ = std::move(state);
  if (seen_ == known_ || calls_with_same_state_ < (lacksBytes() ? kPatience : 2)) return false;
  known_ = seen_ = stateOf(list_());
  return true;
}

FileWatch::State FileWatch::stateOf(const std::vector<std::filesystem::path>& files) {
  State state;
  for (const std::filesystem::path& file : files) {
    Stamp stamp;
    if (const auto status = statusOf(file)) stamp = {status->device, status->number, int64_t(status->size), status->changed};
    state.emplace_back(file, stamp);
  }
  return state;
}

FileWatch::State FileWatch::now() const {
  std::vector<std::filesystem::path> files;
  for (const auto& [file, stamp] : known_) files.push_back(file);
  return stateOf(files);
}

bool FileWatch::lacksBytes() const {
  for (size_t i = 0; i < known_.size(); ++i)
    if (known_[i].second.size > 0 && seen_[i].second.size == 0) return true;
  return false;
}

}  // namespace cloudbake
