// Patterns are matched component by component with fnmatch(3) (POSIX.1-2017, XCU 2.13). `**` has the meaning of Bash's globstar and
// gitignore.
#include "io/file/find_files.h"

#include <fnmatch.h>

#include <algorithm>

#include "core/error.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The entries of a folder, sorted; hidden ones only if `hidden`.
std::vector<fs::directory_entry> entriesOf(const fs::path& folder, bool hidden, std::set<fs::path>& folders) {
  std::error_code error;
  fs::directory_iterator iterator(folder, error);
  if (error) throw IoError(folder.string(), "cannot read the folder: " + error.message() + "; check its name and permissions");
  folders.insert(folder);
  std::vector<fs::directory_entry> entries;
  for (; iterator != fs::directory_iterator(); iterator.increment(error)) {
    if (hidden || !iterator->path().filename().native().starts_with('.')) entries.push_back(*iterator);
    if (error) break;  // what a running system removes meanwhile, as in /proc, is not there
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

// A name that is too long or lies in a locked folder is not a file.
bool isFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}
bool isFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}
bool isRealFolder(const fs::directory_entry& entry) {
  std::error_code error;
  return entry.is_directory(error) && !entry.is_symlink(error);
}

using Component = fs::path::const_iterator;

void match(const fs::path& folder, Component component, Component end, std::vector<fs::path>& found, std::set<fs::path>& folders) {
  const fs::path& pattern = *component;
  const Component next = std::next(component);
  const fs::path here = folder.empty() ? fs::path(".") : folder;
  if (pattern == "**") {
    if (next != end) match(folder, next, end, found, folders);
    for (const auto& entry : entriesOf(here, false, folders)) {
      const fs::path path = folder / entry.path().filename();
      if (isRealFolder(entry)) match(path, component, end, found, folders);
      if (next == end && isFile(entry.path())) found.push_back(path);
    }
    return;
  }
  const auto take = [&](const fs::path& path) {
    if (next == end) {
      if (isFile(path)) found.push_back(path);
    } else if (isFolder(path)) {
      match(path, next, end, found, folders);
    }
  };
  if (!isPattern(pattern.native())) return take(folder / pattern);
  for (const auto& entry : entriesOf(here, true, folders))
    if (::fnmatch(pattern.c_str(), entry.path().filename().c_str(), FNM_PERIOD) == 0) take(folder / entry.path().filename());
}

void listBelow(const fs::path& folder, const fs::path& excluded, std::vector<fs::path>& found, std::set<fs::path>& folders) {
  for (const auto& entry : entriesOf(folder, false, folders)) {
    std::error_code error;
    if (isRealFolder(entry) && !fs::equivalent(entry.path(), excluded, error))
      listBelow(entry.path(), excluded, found, folders);
    else if (isFile(entry.path()))
      found.push_back(entry.path());
  }
}

std::vector<fs::path> sorted(std::vector<fs::path> paths) {
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
  paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
  return paths;
}

}  // namespace

bool isPattern(std::string_view text) { return text.find_first_of("*?[") != text.npos; }

std::vector<fs::path> filesMatching(const fs::path& pattern, std::set<fs::path>& folders) {
  if (!isPattern(pattern.native()) || isFile(pattern)) return isFile(pattern) ? std::vector{pattern} : std::vector<fs::path>{};
  std::vector<fs::path> found;
  const fs::path fixed = fixedFolder(pattern);
  if (fixed.empty() || isFolder(fixed)) {
    const auto below = std::next(pattern.begin(), std::distance(fixed.begin(), fixed.end()));
    match(fixed, below, pattern.end(), found, folders);
  }
  return sorted(std::move(found));
}

fs::path fixedFolder(const fs::path& pattern) {
  fs::path fixed;
  for (const fs::path& component : pattern) {
    if (isPattern(component.native())) break;
    fixed /= component;
  }
  return fixed;
}

std::vector<fs::path> filesBelow(const fs::path& folder, const fs::path& excluded, std::set<fs::path>& folders) {
  std::vector<fs::path> found;
  listBelow(folder, excluded, found, folders);
  return sorted(std::move(found));
}

}  // namespace cloudbake
