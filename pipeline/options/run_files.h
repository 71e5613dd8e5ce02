// The files that a run reads and writes: none may be both, and no two outputs may be one file.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pipeline/options/options.h"

namespace cloudbake {

/// A file, and its role in messages: "-o", "--json", "the input".
struct RunFile {
  std::filesystem::path path;
  std::string role;
  std::string ending{};    ///< of the names of several files, after `path`: a pattern of fnmatch(3), such as "_[0-9][0-9][0-9][0-9].png"
  bool is_of_set = false;  ///< an output whose name cloudbake makes, beside others
};

/// The folder that a batch keeps its records in, inside its output folder.
inline constexpr const char* kRecordsFolder = ".cloudbake";
/// The file in it that a running batch locks.
inline constexpr const char* kBatchLock = "lock";

/// The files that a command line names.
struct RunFiles {
  std::vector<RunFile> inputs, outputs;
};

/// Adds the files that an option of this value reads and writes.
void addFilesOf(const Given& given, RunFiles& files);

/// Adds the files that inputs name and that exist: buffers, images and material libraries of sculpts, and every path in a TOML file
/// (recipe, scene, manifest). Reads the inputs only if an output exists, because nothing can be lost otherwise. Inputs that cannot be read
/// or parsed name nothing.
void addNamedFiles(RunFiles& files);

/// Throws UsageError if an output is, or may become, the same regular file as an input or as another output. Files that exist are compared
/// by device and inode, through links; others by folder and name, in any case of letters. Devices and pipes lose nothing.
void refuseSharedFiles(const RunFiles& files);

/// Throws UsageError if an output lies among the records of this or another batch, or in the cache of this one. `output` and `cache` are
/// its folders; empty: it has none.
void refuseRecords(const RunFiles& files, const std::filesystem::path& output, const std::filesystem::path& cache);

/// Says that a file would be replaced which cloudbake has not written, and the cure.
std::string foreignFile(const std::filesystem::path& file);

/// Throws UsageError if an output of a set would replace a file that cloudbake has not written (isForeignFile).
void refuseForeignFiles(const RunFiles& files);

/// Whether a path lies in a folder or below it, by name. Nothing lies in an empty path.
bool liesIn(const std::filesystem::path& folder, const std::filesystem::path& path);

/// Throws IoError if an output cannot be written (probeTargets). Files below `folder` may lie in folders that are still to be created; an
/// empty path stands for none.
void probeOutputs(const RunFiles& files, const std::filesystem::path& folder);

/// Throws UsageError if the name ends as another known format does (`-o cloud.obj`), or is "-". `extensions` are those of the format that
/// is written, joined by spaces; `role` is for the message.
void refuseOtherFormat(const RunFile& output, std::string_view extensions);

}  // namespace cloudbake
