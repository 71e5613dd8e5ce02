// Node has no locks. The name of a temporary file has the number of its process, and the launcher removes what exists when a signal ends
// that (web/cli/cloudbake.mjs).
#include "io/file/temporary_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <random>
#include <string>

#include "core/wasm/host.h"
#include "io/file/system_file.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr int kMostTries = 100;

// What the names of this machine's temporary files begin with, other than those of the native program.
std::string namePrefix() { return ".cloudbake-" + hashBytes("a temporary file of Node on " + hostName()).substr(0, 8) + "-"; }

std::string newName() {
  std::random_device draw;
  return namePrefix() + fmt::format("{:08x}{:08x}", cloudbake_process_number(), draw());
}

// Whether a file has such a name, of a process that has ended.
bool isAbandoned(const std::string& name, const std::string& prefix) {
  if (name.size() != prefix.size() + 16 || !name.starts_with(prefix) ||
      name.find_first_not_of("0123456789abcdef", prefix.size()) != name.npos)
    return false;
  return cloudbake_is_running(int(std::strtoul(name.substr(prefix.size(), 8).c_str(), nullptr, 16))) == 0;
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& folder, uint32_t permissions) {
  for (int i = 0; i < kMostTries; ++i) {
    path_ = folder / newName();
    file_.number = openNew(path_, permissions);
    error_ = file_.number < 0 ? errno : 0;
    if (error_ == EEXIST) continue;
    if (error_ == 0) cloudbake_temporary(path_.c_str(), 1);
    return;
  }
}

TemporaryFile::~TemporaryFile() { forget(); }

void TemporaryFile::forget() {
  if (file_.number < 0) return;
  file_.close();
  removeName(path_.c_str());
  cloudbake_temporary(path_.c_str(), 0);
}

int TemporaryFile::renameTo(const fs::path& target) {
  if (const int failure = renameFile(path_, target); failure != 0) return failure;
  file_.close();
  cloudbake_temporary(path_.c_str(), 0);
  return 0;
}

void removeAbandonedFiles(const fs::path& folder) {
  const std::string prefix = namePrefix();
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (isAbandoned(entry->path().filename().string(), prefix)) removeName(entry->path().c_str());
}

void removeTemporaryFiles() noexcept {}

}  // namespace cloudbake
