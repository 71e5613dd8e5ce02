#include "pipeline/options/run_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "core/error.h"
#include "core/text/scan.h"
#include "core/text/toml.h"
#include "io/file/find_files.h"
#include "io/file/own_file.h"
#include "io/file/system_file.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/referenced_files.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// What makes two paths the same file: device and inode of the file, with no name; or those of its folder, with its name.
using Identity = std::tuple<uint64_t, uint64_t, std::string>;

std::optional<Identity> identityOf(const fs::path& path) {
  const fs::path target = followLinks(path);
  if (const auto status = statusOf(target)) {
    if (status->kind != FileKind::kFile) return std::nullopt;
    return Identity{status->device, status->number, ""};
  }
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const std::string name = lowerCase(target.filename().string());
  if (const auto status = statusOf(folder)) return Identity{status->device, status->number, name};
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
    if (name.starts_with(stem) && matchesPattern(output.ending, std::string_view(name).substr(stem.size()))) found.push_back(entry->path());
  }
  return found;
}

// A path that an output may write: its own, or one that has 0 for every digit of the pattern.
fs::path exampleOf(const RunFile& output) {
  std::string name = output.path.string() + output.ending;
  constexpr std::string_view kDigit = "[0-9]";
  for (size_t at = output.path.string().size(); (at = name.find(kDigit, at)) != name.npos;) name.replace(at, kDigit.size(), "0");
  return name;
}

// Whether an output of this pattern may have this name.
bool mayWrite(const RunFile& output, const fs::path& path) {
  if (output.ending.empty()) return false;
  const fs::path target = followLinks(path);
  const fs::path there = target.has_parent_path() ? target.parent_path() : fs::path("."),
                 here = output.path.has_parent_path() ? output.path.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::equivalent(here, there, error)) return false;
  const std::string stem = lowerCase(output.path.filename().string()), name = lowerCase(target.filename().string());
  return name.starts_with(stem) && matchesPattern(output.ending, std::string_view(name).substr(stem.size()));
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
      files.outputs.push_back({stem, file.role, ending, true});
    else
      files.outputs.push_back({stem.string() + ending, file.role, "", true});
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
      throw UsageError(fmt::format("{} and {} would write the same file ({}): give each a different name", found->second->role, output.role,
                                   path.string()));
  };
  for (const RunFile& output : files.outputs)
    for (const fs::path& path : filesOf(output)) check(output, path);
  for (const RunFile& several : files.outputs)
    for (const RunFile& one : files.outputs)
      if (one.ending.empty() && mayWrite(several, one.path))
        throw UsageError(
            fmt::format("{} and {} would write the same file ({}): give each a different name", several.role, one.role, one.path.string()));
}

void refuseRecords(const RunFiles& files, const fs::path& output, const fs::path& cache) {
  std::error_code error;
  const auto real = [&](const fs::path& path) {
    return path.empty() ? path : fs::weakly_canonical(fs::absolute(followLinks(path)), error);
  };
  const fs::path records = output.empty() ? output : real(output / kRecordsFolder), cached = real(cache);
  for (const RunFile& file : files.outputs)
    for (fs::path folder = real(file.path).parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
      const bool is_of_batch = folder == records || (folder.filename() == kRecordsFolder && fs::exists(folder / kBatchLock, error));
      if (is_of_batch || folder == cached)
        throw UsageError(fmt::format("{}: {} lies {}: choose another folder", file.role, file.path.string(),
                                     is_of_batch ? "among the records of a batch" : "in the folder of --cache"));
    }
}

std::string foreignFile(const fs::path& file) {
  return file.string() + " would be replaced, but cloudbake has not written it: move it, choose another name, or give --force";
}

void refuseForeignFiles(const RunFiles& files) {
  for (const RunFile& output : files.outputs)
    for (const fs::path& path : filesOf(output))
      if (output.is_of_set && isForeignFile(path)) throw UsageError(output.role + ": " + foreignFile(path));
}

bool liesIn(const fs::path& folder, const fs::path& path) {
  if (folder.empty()) return false;
  const fs::path relative = fs::absolute(path).lexically_normal().lexically_relative(fs::absolute(folder).lexically_normal());
  return !relative.empty() && *relative.begin() != "..";
}

void probeOutputs(const RunFiles& files, const fs::path& folder) {
  std::vector<fs::path> targets;
  for (const RunFile& output : files.outputs) {
    std::error_code error;
    if (liesIn(folder, output.path) && !fs::exists(output.path, error))
      probeFolder(output.path.parent_path());
    else
      targets.push_back(exampleOf(output));
    if (!output.ending.empty())
      for (const fs::path& path : filesOf(output)) targets.push_back(path);
  }
  probeTargets(targets);
  if (!folder.empty()) probeFolder(folder);
}

void refuseOtherFormat(const RunFile& output, std::string_view extensions) {
  if (output.path == "-") throw UsageError(output.role + ": '-' is not a file: give a name, or /dev/stdout");
  const std::string ending = lowerCase(output.path.extension().string());
  if (ending.empty() || extensions.empty() || fmt::format(" {} ", extensions).find(fmt::format(" {} ", ending)) != std::string::npos)
    return;
  constexpr std::string_view kOthers =
      " .png .apng .jpg .jpeg .exr .json .html .htm .xml .svg .csv .toml .vdb .ktx2 .zip .blend .usd .usda .usdc .usdz .abc ";
  if (!isSculptFile(output.path) && kOthers.find(fmt::format(" {} ", ending)) == std::string_view::npos) return;
  throw UsageError(fmt::format("{}: '{}' has the ending of another format: end the name in {}", output.role, output.path.string(),
                               extensions.substr(0, extensions.find(' '))));
}

}  // namespace cloudbake
