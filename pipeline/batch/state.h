// What is already made: keys of assets, the records beside outputs, and the shared cache.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/report/batch_report.h"
#include "pipeline/batch/plan.h"

namespace cloudbake {

/// What an asset is made of. `key` is hexadecimal: 16 digits of the build, 16 of the settings, 32 of the inputs' names and bytes; empty
/// where the input cannot be read. `files` are all that is read for it, in order.
struct AssetInputs {
  std::string key;
  std::vector<std::filesystem::path> files;
};

/// Of every asset; each file is read once.
std::vector<AssetInputs> inputsOf(const std::vector<PlannedAsset>& assets, const BatchPlan& plan);

/// The folder in an output folder that holds records, thumbnails, the last report and the lock.
std::filesystem::path stateFolder(const std::filesystem::path& output);
std::filesystem::path recordFile(const std::filesystem::path& output, const std::string& name);
std::filesystem::path thumbnailFile(const std::filesystem::path& output, const std::string& name);

/// Writes the record, then the output: a run that is killed between them leaves an output that does not match its record.
void writeOutput(const std::filesystem::path& output, const AssetRecord& record, std::string_view glb);

/// The record of an output; nothing where there is none, or it is damaged.
std::optional<AssetRecord> readRecord(const std::filesystem::path& file);

/// Why an asset has to be baked, in words; empty where its output is what it should be. `record` is what lies beside it.
std::string staleness(const std::filesystem::path& output, const std::string& name, const std::string& key,
                      const std::optional<AssetRecord>& record);

/// Bakes kept by their key, in a folder that several machines may share: FOLDER/KK/KEY.glb and .json, the latter written last.
struct AssetCache {
  std::filesystem::path folder;
  /// A whole entry with its bytes in `glb`; nothing where there is none, or it is damaged.
  std::optional<AssetRecord> find(const std::string& key, std::string& glb) const;
  void add(const AssetRecord& record, std::string_view glb) const;
};

/// Keeps others from writing into an output folder, or from baking the same shard of it, for as long as it lives. Throws Error with
/// ExitCode::kTryAgain where another does.
class OutputLock {
 public:
  OutputLock(const std::filesystem::path& output, int shard, int shards);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  std::vector<int> files_;
};

/// Removes outputs that earlier batches wrote and `kept` does not name, with their records; what somebody else has changed since stays.
/// Returns their names.
std::vector<std::string> pruneOutputs(const std::filesystem::path& output, const std::vector<PlannedAsset>& kept);

}  // namespace cloudbake
