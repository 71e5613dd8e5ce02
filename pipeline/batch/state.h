// What has already been made: keys of assets, the records of outputs, and the shared cache.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/file/descriptor.h"
#include "io/file/write_file.h"
#include "io/report/batch_report.h"
#include "pipeline/batch/plan.h"

namespace cloudbake {

/// The inputs of an asset. `key` is hexadecimal: 16 digits of the build, 16 of the settings, 32 of the inputs' names and bytes; empty if
/// the input cannot be read. `files` are all files that the asset needs, in order, whether they exist or not.
struct AssetInputs {
  std::string key;
  std::vector<std::filesystem::path> files;
};

/// The inputs of every asset. Files that several assets share are hashed once. `read_file` is called by several threads.
std::vector<AssetInputs> inputsOf(const std::vector<PlannedAsset>& assets, const BatchPlan& plan,
                                  const FileReader& read_file = readFileBytes);

/// The folder inside an output folder that holds records, thumbnails, the last report and the lock.
std::filesystem::path stateFolder(const std::filesystem::path& output);
std::filesystem::path recordFile(const std::filesystem::path& output, const std::string& name);
std::filesystem::path thumbnailFile(const std::filesystem::path& output, const std::string& name);

/// Whether a batch has written this file: it lies in an output folder that has a record of it, or of the asset whose level or live view it
/// is. Also what is in a stateFolder. Looks at all folders above the file.
bool isBatchOutput(const std::filesystem::path& file);

/// The live view of an asset is a page beside its output: NAME.html for NAME.glb, relative to the output folder.
std::string liveViewName(const std::string& name);
/// Whether the live view is there as writeLiveView wrote it, and the output has not been written since.
bool hasLiveView(const std::filesystem::path& output, const std::string& name);
void writeLiveView(const std::filesystem::path& output, const std::string& name, std::string_view page);

/// What is written for an asset.
struct AssetBytes {
  std::string glb;
  std::vector<std::string> levels;  ///< of detail, each a GLB
};

/// The levels of the earlier output that one with `levels` levels does not have, and that nobody has changed; writeOutput removes them.
std::vector<std::string> levelsToRemove(const std::filesystem::path& output, const std::string& name, size_t levels);

/// Writes the record, then the levels of detail and the output, so that a run that is killed in between leaves an output that does not
/// match its record. The thumbnail is removed, and so are levels of the earlier output that this one does not have, unless somebody else
/// has changed them. The live view stays, but it is out of date.
void writeOutput(const std::filesystem::path& output, const AssetRecord& record, const AssetBytes& bytes);

/// The record of an output; none if it is missing or damaged.
std::optional<AssetRecord> readRecord(const std::filesystem::path& file);

/// Why an asset has to be baked, in words; empty if its output is up to date. `record` is the record of that output.
std::string staleness(const std::filesystem::path& output, const std::string& name, const std::string& key,
                      const std::optional<AssetRecord>& record);

/// Keeps bakes by their key in a folder that several machines may share: FOLDER/KK/KEY.glb, KEY_lod1.glb, … and KEY.json, with the .json
/// written last.
struct AssetCache {
  std::filesystem::path folder;
  /// The record of an entry, with its bytes in `bytes`; none if the entry is missing or damaged.
  std::optional<AssetRecord> find(const std::string& key, AssetBytes& bytes) const;
  void add(const AssetRecord& record, const AssetBytes& bytes) const;
};

/// While it exists, other processes cannot write to the output folder, or bake the same shard of it. Throws Error with ExitCode::kTryAgain
/// if another process holds the lock.
class OutputLock {
 public:
  OutputLock(const std::filesystem::path& output, int shard, int shards);

 private:
  Descriptor of_all_, of_shard_;
};

/// Removes outputs that earlier batches wrote and `kept` does not name, with their levels, live views and records. Files that were changed
/// since stay. Returns the names of the removed outputs and live views.
std::vector<std::string> pruneOutputs(const std::filesystem::path& output, const std::vector<PlannedAsset>& kept);
/// What pruneOutputs would remove.
std::vector<std::string> outputsToPrune(const std::filesystem::path& output, const std::vector<PlannedAsset>& kept);

}  // namespace cloudbake
