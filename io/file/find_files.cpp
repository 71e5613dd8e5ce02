// Patterns are matched component by component as POSIX.1-2017, XCU 2.13, says. `**` has the meaning of Bash's globstar and gitignore.
#include "io/file/find_files.h"

#include <algorithm>
#include <optional>
#include <utility>

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
    if (hidden || !iterator->path().filename().string().starts_with('.')) entries.push_back(*iterator);
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

// How many characters of a pattern, which does not begin with a star, stand for this one; 0 if they do not.
size_t matchOne(std::string_view pattern, char character) {
  if (pattern.empty()) return 0;
  const auto code = [](char one) { return static_cast<unsigned char>(one); };
  if (pattern[0] == '?') return 1;
  if (pattern[0] == '\\' && pattern.size() > 1) return pattern[1] == character ? 2 : 0;
  const size_t begin = pattern.size() > 1 && (pattern[1] == '!' || pattern[1] == '^') ? 2 : 1;
  const size_t end = pattern[0] == '[' ? pattern.find(']', begin + 1) : pattern.npos;
  if (end == pattern.npos) return pattern[0] == character ? 1 : 0;
  bool is_listed = false;
  for (size_t i = begin; i < end; ++i) {
    const bool is_range = i + 2 < end && pattern[i + 1] == '-';
    is_listed |= code(pattern[i]) <= code(character) && code(character) <= code(pattern[is_range ? i + 2 : i]);
    if (is_range) i += 2;
  }
  return is_listed == (begin == 1) ? end + 1 : 0;
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
  const std::string text = pattern.string();
  if (!isPattern(text)) return take(folder / pattern);
  for (const auto& entry : entriesOf(here, true, folders)) {
    const std::string name = entry.path().filename().string();
    const bool may_be_hidden = text.starts_with('.') || text.starts_with("\\.");
    if ((may_be_hidden || !name.starts_with('.')) && matchesPattern(text, name)) take(folder / entry.path().filename());
  }
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
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) { return a.generic_string() < b.generic_string(); });
  paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
  return paths;
}

}  // namespace

bool matchesPattern(std::string_view pattern, std::string_view name) {
  // Only the last star is tried again: what an earlier one took can stay, because the later one takes the rest.
  size_t at = 0, in_pattern = 0;
  std::optional<std::pair<size_t, size_t>> star;  // behind it in the pattern, and where its text ends for now
  while (at < name.size() || in_pattern < pattern.size()) {
    if (in_pattern < pattern.size() && pattern[in_pattern] == '*') {
      star = {++in_pattern, at};
      continue;
    }
    if (const size_t taken = at < name.size() ? matchOne(pattern.substr(in_pattern), name[at]) : 0; taken > 0) {
      in_pattern += taken;
      ++at;
      continue;
    }
    if (!star || star->second == name.size()) return false;
    in_pattern = star->first;
    at = ++star->second;
  }
  return true;
}

bool isPattern(std::string_view text) { return text.find_first_of("*?[") != text.npos; }

std::vector<fs::path> filesMatching(const fs::path& pattern, std::set<fs::path>& folders) {
  if (!isPattern(pattern.string()) || isFile(pattern)) return isFile(pattern) ? std::vector{pattern} : std::vector<fs::path>{};
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
    if (isPattern(component.string())) break;
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
