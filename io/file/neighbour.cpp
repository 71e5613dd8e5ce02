#include "io/file/neighbour.h"

#include <algorithm>

#include "core/error.h"

namespace cloudbake {

namespace fs = std::filesystem;

std::optional<std::string> refusalOfNeighbour(const fs::path& file, const fs::path& named, bool allow_outside) {
  if (!allow_outside && !liesBeside(file, named)) return "it lies outside the file's folder: move it there, or give --allow-outside";
  std::error_code error;
  const fs::file_status status = fs::status(named, error);
  if (error || !fs::exists(status)) return std::nullopt;
  if (!fs::is_regular_file(status)) return "it is a folder, a pipe or a device: name a regular file";
  const uint64_t size = fs::file_size(named, error);
  if (!error && size > kLargestNeighbour)
    return "it has " + std::to_string(size) + " bytes, but a GLB holds at most 4 GiB: name a smaller file";
  return std::nullopt;
}

std::string readNeighbour(const fs::path& file, const fs::path& named, const ReadSettings& settings) {
  if (const auto refusal = refusalOfNeighbour(file, named, settings.allow_outside))
    throw InputError(file.string(), "it refers to '" + named.string() + "', but " + *refusal);
  return settings.read_file(named);
}

fs::path neighbourNamed(const fs::path& file, const std::string& written, bool allow_outside, const fs::path& named_by) {
  std::string name = written;
  std::replace(name.begin(), name.end(), '\\', '/');
  if (name.starts_with("file://")) name.erase(0, 7);
  const fs::path folder = file.parent_path(), first = (named_by.empty() ? folder : named_by.parent_path()) / name;
  for (const fs::path& path : {first, folder / name, folder / fs::path(name).filename()}) {
    std::error_code error;
    if ((allow_outside || liesBeside(file, path)) && fs::exists(path, error)) return path.lexically_normal();
  }
  return first.lexically_normal();
}

}  // namespace cloudbake
