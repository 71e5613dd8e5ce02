#include "pipeline/run_files.h"

#include <fmt/format.h>

#include <fnmatch.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "core/error.h"
#include "core/text/scan.h"
#include "core/text/toml.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/referenced_files.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// What makes two paths the same file: device and inode of the file, with no name; or those of its folder, with its name.
using Identity = std::tuple<uint64_t, uint64_t, std::string>;

std::optional<Identity> identityOf(const fs::path& path) {
  struct stat status {};
  const fs::path target = followLinks(path);
  if (::stat(target.c_str(), &status) == 0) {
    if (!S_ISREG(status.st_mode)) return std::nullopt;
    return Identity{status.st_dev, status.st_ino, ""};
  }
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const std::string name = lowerCase(target.filename().string());
  if (::stat(folder.c_str(), &status) == 0) return Identity{status.st_dev, status.st_ino, name};
  return Identity{0, 0, lowerCase(fs::absolute(target).lexically_normal().string())};
}

// The files that an output writes as far as they are known: itself, or the existing ones of its pattern.
std::vector<fs::path> filesOf(const RunFile& output) {
  if (output.ending.empty()) return {output.path};
  const std::string stem = output.path.filename().string();
  std::vector<fs::path> found;
  std::error_code error;
  const fs::path folder = output.path.has_parent_path() ? output.path.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(stem) && ::fnmatch(output.ending.c_str(), name.c_str() + stem.size(), 0) == 0) found.push_back(entry->path());
  }
  return found;
}

void addStrings(const toml::node& node, const fs::path& folder, std::vector<fs::path>& named) {
  if (const auto* text = node.as_string()) {
    const fs::path path = folder / text->get();
    std::error_code error;
    if (!text->get().empty() && fs::is_regular_file(path, error)) named.push_back(path);
  } else if (const auto* table = node.as_table()) {
    for (const auto& [key, value] : *table) addStrings(value, folder, named);
  } else if (const auto* array = node.as_array()) {
    for (const auto& value : *array) addStrings(value, folder, named);
  }
}

std::vector<fs::path> namedBy(const fs::path& file) {
  std::vector<fs::path> named;
  try {
    const bool is_toml = lowerCase(file.extension().string()) == ".toml";
    if (!is_toml && !canReferToFiles(file)) return named;
    const std::string bytes = readFileBytes(file);
    if (!is_toml) return referencedFiles(file, bytes, {.allow_outside = true});
    addStrings(parseTomlTable(bytes, file.string()), file.parent_path(), named);
  } catch (const Error&) {  // its reader reports what is wrong
  }
  return named;
}

}  // namespace

void addFilesOf(const Given& given, RunFiles& files) {
  const FileUse& use = given.option->files;
  const RunFile file{given.value, "--" + std::string(given.option->name)};
  if (use.kind == FileUse::kRead && given.value != "-") files.inputs.push_back(file);
  if (use.kind != FileUse::kWritten && use.kind != FileUse::kStem) return;
  refuseOtherFormat(file, use.extensions);
  const bool is_file = use.kind == FileUse::kWritten || (*use.extensions && lowerCase(file.path.extension().string()) == use.extensions);
  if (is_file) files.outputs.push_back(file);
  if (is_file && use.kind == FileUse::kStem) return;
  const fs::path stem = is_file ? fs::path(file.path).replace_extension() : file.path;
  std::istringstream endings(use.endings);
  for (std::string ending; endings >> ending;) {
    if (ending.find('[') != ending.npos)
      files.outputs.push_back({stem, file.role, ending});
    else
      files.outputs.push_back({stem.string() + ending, file.role});
  }
}

void addNamedFiles(RunFiles& files) {
  std::error_code error;
  if (std::none_of(files.outputs.begin(), files.outputs.end(),
                   [&](const RunFile& output) { return !output.ending.empty() || fs::exists(output.path, error); }))
    return;
  std::set<fs::path> met;
  for (size_t i = 0; i < files.inputs.size(); ++i) {
    const RunFile input = files.inputs[i];
    if (!met.insert(input.path).second) continue;
    for (const fs::path& named : namedBy(input.path)) files.inputs.push_back({named, "a file that " + input.path.string() + " names"});
  }
}

void refuseSharedFiles(const RunFiles& files) {
  std::map<Identity, const RunFile*> inputs, outputs;
  for (const RunFile& input : files.inputs)
    if (const auto identity = identityOf(input.path)) inputs.emplace(*identity, &input);
  const auto check = [&](const RunFile& output, const fs::path& path) {
    const auto identity = identityOf(path);
    if (!identity) return;
    if (const auto found = inputs.find(*identity); found != inputs.end())
      throw UsageError(fmt::format("{} would replace {} ({}): choose another name", output.role, found->second->role, path.string()));
    if (const auto [found, is_new] = outputs.emplace(*identity, &output); !is_new)
      throw UsageError(fmt::format("{} and {} would write the same file ({}): give each a name of its own", found->second->role,
                                   output.role, path.string()));
  };
  for (const RunFile& output : files.outputs)
    for (const fs::path& path : filesOf(output)) check(output, path);
}

void refuseOtherFormat(const RunFile& output, std::string_view extensions) {
  if (output.path == "-") throw UsageError(output.role + ": '-' is not a file: give a name, or /dev/stdout");
  const std::string ending = lowerCase(output.path.extension().string());
  if (ending.empty() || extensions.empty() || fmt::format(" {} ", extensions).find(fmt::format(" {} ", ending)) != std::string::npos)
    return;
  constexpr std::string_view kOthers =
      " .png .apng .jpg .jpeg .exr .json .html .htm .xml .svg .csv .toml .vdb .ktx2 .zip .blend .usd .usda .usdc .usdz .abc ";
  if (!isSculptFile(output.path) && kOthers.find(fmt::format(" {} ", ending)) == std::string_view::npos) return;
  throw UsageError(fmt::format("{}: '{}' would not hold what its name says: end the name in {}", output.role, output.path.string(),
                               extensions.substr(0, extensions.find(' '))));
}

}  // namespace cloudbake
