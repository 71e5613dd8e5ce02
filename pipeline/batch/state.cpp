// Freshness depends on content only. Timestamps are ignored, so a fresh clone, another machine or a touched file causes no new bake.
#include "pipeline/batch/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "io/file/system_file.h"
#include "io/sculpt/referenced_files.h"
#include "pipeline/asset/levels.h"
#include "pipeline/options/presets.h"
#include "pipeline/options/run_files.h"
#include "pipeline/options/version.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr const char* kAbsent = "absent";

struct InputFile {
  std::string hash;  ///< of its bytes; empty: cannot be read
  std::vector<fs::path> named;
};

std::string sceneText(const std::optional<SceneNeeds>& scene) {
  if (!scene) return "";
  const PictureSettings& view = scene->view;
  std::string text = fmt::format("scene {} {} {} {} {} {}", scene->camera_distance.value_or(0), view.field_of_view_degrees, view.width,
                                 view.height, view.camera_azimuth_degrees, view.camera_elevation_degrees);
  if (const auto& arc = scene->sun_arc)
    text += fmt::format(" {} {} {} {}", arc->elevation_low_degrees, arc->elevation_high_degrees, arc->azimuth_low_degrees,
                        arc->azimuth_high_degrees);
  const VolumeLight volume = scene->volume.over({});
  return text + fmt::format(" {} {} {} {} {}", volume.view_extinction, volume.asymmetry, volume.octaves.count, volume.octaves.extinction,
                            volume.octaves.contribution);
}

// The path of a scene file is left out. Its bytes count among the inputs.
std::string settingsText(const PlannedAsset& asset, const BatchPlan& plan) {
  std::string text = std::to_string(int(asset.from.kind)) + (asset.is_sequence ? " sequence\n" : "\n");
  for (const Given& given : asset.given)
    text += given.option->name + ("=" + (std::string_view(given.option->name) == "scene" ? "" : given.value)) + "\n";
  if (asset.from.read.frame_if_unstated) text += "frame if unstated\n";
  return text + sceneText(plan.scene);
}

using Files = std::map<fs::path, InputFile>;

// A sculpt whose neighbours are read too, and whether it may name files outside its folder.
using Sculpts = std::map<fs::path, bool>;

void readAll(Files& files, const std::set<fs::path>& wanted, const Sculpts& sculpts, const FileReader& read_file) {
  std::vector<std::pair<const fs::path, InputFile>*> fresh;
  for (const fs::path& file : wanted)
    if (const auto [entry, is_new] = files.try_emplace(file); is_new) fresh.push_back(&*entry);
  parallelFor(fresh.size(), [&](size_t i) {
    auto& [file, input] = *fresh[i];
    try {
      const std::string bytes = read_file(file);
      if (const auto sculpt = sculpts.find(file); sculpt != sculpts.end())
        input.named = referencedFiles(file, bytes, {.allow_outside = sculpt->second, .read_file = read_file});
      input.hash = hashBytes(bytes);
    } catch (const Error&) {  // the bake reports what is wrong
    }
  });
}

std::string hashOr(const Files& files, const fs::path& file, const char* fallback) {
  const auto found = files.find(file);
  return found == files.end() || found->second.hash.empty() ? fallback : found->second.hash;
}

// Holds the hash of the live view, for as long as that shows the output.
fs::path liveViewHashFile(const fs::path& output, const std::string& name) { return stateFolder(output) / (name + ".live"); }

// Also that of earlier versions, which was a PNG.
void removeThumbnail(const fs::path& output, const std::string& name) {
  std::error_code ignored;
  for (const char* end : {".jpg", ".png"}) fs::remove(stateFolder(output) / (name + end), ignored);
}

std::string recordText(const AssetRecord& record) {
  BatchReport report;
  report.assets.push_back(record);
  return batchJson(report);
}

// The asset whose level has this name, and the number of the level: "a/b.glb" and 2 of "a/b_lod2.glb"; 0 if it is no level.
std::pair<std::string, size_t> assetOfLevel(const std::string& name) {
  const fs::path path = name;
  const std::string stem = path.stem().string();
  for (size_t level = 1; level <= kMostLevels; ++level) {
    const std::string ending = "_lod" + std::to_string(level);
    if (!stem.ends_with(ending)) continue;
    const std::string asset = stem.substr(0, stem.size() - ending.size()) + path.extension().string();
    return {(path.parent_path() / asset).generic_string(), level};
  }
  return {"", 0};
}

// Whether a file is there with the bytes of this hash.
bool isAsWritten(const fs::path& file, const std::string& hash) {
  std::error_code error;
  return fs::exists(file, error) && hashBytes(readFileBytes(file)) == hash;
}

// The levels of an output that are there as they were written, from `first` on, counted from 0. A record that was read may have another
// name than the asset, because JSON does not hold all bytes of file names.
std::vector<std::string> ownedLevels(const fs::path& output, const std::string& name, const AssetRecord& record, size_t first = 0) {
  const std::vector<std::string> names = levelNames(name, record.level_hashes.size());
  std::vector<std::string> owned;
  for (size_t i = first; i < names.size(); ++i)
    if (isAsWritten(output / names[i], record.level_hashes[i])) owned.push_back(names[i]);
  return owned;
}

void lockFile(const fs::path& file, LockKind kind, Descriptor& lock) {
  lock.number = openLockFile(file);
  if (lock.number < 0)
    throw IoError(file.string(), std::string("cannot write: ") + std::strerror(errno) + "; choose another output folder");
  const int error = lockNow(lock.number, kind);
  if (error == 0) return;
  if (error != EWOULDBLOCK) throw IoError(file.string(), std::string("cannot lock: ") + std::strerror(error) + "; choose another disk");
  throw Error(ExitCode::kTryAgain, file.parent_path().parent_path().string(), 0, 0,
              "another batch is writing to this folder: try again when it has ended, or choose another -o");
}

}  // namespace

std::vector<AssetInputs> inputsOf(const std::vector<PlannedAsset>& assets, const BatchPlan& plan, const FileReader& read_file) {
  std::set<fs::path> mains, others;
  Sculpts sculpts;
  for (const PlannedAsset& asset : assets) {
    if (asset.from.kind != SourceKind::kPreset) mains.insert(asset.from.input);
    for (const FrameInput& frame : asset.frames) mains.insert(frame.file);
    if (asset.from.kind != SourceKind::kSculpt) continue;
    sculpts[asset.from.input] |= asset.from.read.allow_outside;
    for (const FrameInput& frame : asset.frames) sculpts[frame.file] |= asset.from.read.allow_outside;
  }
  Files files;
  readAll(files, mains, sculpts, read_file);
  for (const auto& [file, input] : files) others.insert(input.named.begin(), input.named.end());
  for (const PlannedAsset& asset : assets)
    if (const auto scene = sceneFileOf(asset)) others.insert(*scene);
  readAll(files, others, {}, read_file);

  const std::string build = buildHash().substr(0, 16);
  std::vector<AssetInputs> all;
  for (const PlannedAsset& asset : assets) {
    AssetInputs& inputs = all.emplace_back();
    std::string text = asset.from.input.stem().string() + "\n";  // becomes the name of a part
    bool readable = true;
    if (asset.from.kind == SourceKind::kPreset) {
      text += *findPreset(asset.from.input.string());
    } else {
      text += asset.from.input.extension().string() + "\n";
      const auto add = [&](const fs::path& file) {
        const InputFile& input = files.at(file);
        inputs.files.push_back(file);
        readable = readable && !input.hash.empty();
        text += input.hash + "\n";
        for (const fs::path& named : input.named) {
          text += hashOr(files, named, kAbsent) + "\n";
          inputs.files.push_back(named);
        }
      };
      if (asset.frames.empty()) add(asset.from.input);
      for (const FrameInput& frame : asset.frames) {
        text += fmt::format("{} ", frame.frame);
        add(frame.file);
      }
    }
    if (const auto scene = sceneFileOf(asset)) {
      text += hashOr(files, *scene, kAbsent);
      inputs.files.push_back(*scene);
    }
    if (readable) inputs.key = build + hashBytes(settingsText(asset, plan)).substr(0, 16) + hashBytes(text);
  }
  return all;
}

fs::path stateFolder(const fs::path& output) { return output / kRecordsFolder; }
fs::path recordFile(const fs::path& output, const std::string& name) { return stateFolder(output) / (name + ".json"); }
fs::path thumbnailFile(const fs::path& output, const std::string& name) { return stateFolder(output) / (name + ".jpg"); }

bool isBatchOutput(const fs::path& file) {
  std::error_code error;
  const fs::path path = fs::absolute(file).lexically_normal();
  if (std::find(path.begin(), path.end(), kRecordsFolder) != path.end()) return true;
  for (fs::path output = path.parent_path();; output = output.parent_path()) {
    if (fs::exists(stateFolder(output), error)) {
      const std::string name = path.lexically_relative(output).generic_string();
      const auto [asset, level] = assetOfLevel(name);
      const std::string page_of = fs::path(name).replace_extension(".glb").generic_string();
      if (fs::exists(recordFile(output, name), error) ||
          (liveViewName(page_of) == name && fs::exists(liveViewHashFile(output, page_of), error)))
        return true;
      if (const auto record = level > 0 ? readRecord(recordFile(output, asset)) : std::nullopt;
          record && level <= record->level_hashes.size())
        return true;
    }
    if (output == output.parent_path()) return false;
  }
}

std::string liveViewName(const std::string& name) { return fs::path(name).replace_extension(".html").generic_string(); }

bool hasLiveView(const fs::path& output, const std::string& name) {
  try {
    return hashBytes(readFileBytes(output / liveViewName(name))) == readFileBytes(liveViewHashFile(output, name));
  } catch (const Error&) {
    return false;
  }
}

void writeLiveView(const fs::path& output, const std::string& name, std::string_view page) {
  writeFileAtomically(output / liveViewName(name), page);
  writeFileAtomically(liveViewHashFile(output, name), hashBytes(page));
}

std::vector<std::string> levelsToRemove(const fs::path& output, const std::string& name, size_t levels) {
  const auto before = readRecord(recordFile(output, name));
  return before ? ownedLevels(output, name, *before, levels) : std::vector<std::string>{};
}

void writeOutput(const fs::path& output, const AssetRecord& record, const AssetBytes& bytes) {
  const fs::path target = output / record.name, beside = recordFile(output, record.name);
  createFolder(target.parent_path());
  createFolder(beside.parent_path());
  std::error_code ignored;
  removeThumbnail(output, record.name);
  fs::remove(liveViewHashFile(output, record.name), ignored);
  for (const std::string& name : levelsToRemove(output, record.name, bytes.levels.size())) fs::remove(output / name, ignored);
  writeFileAtomically(beside, recordText(record));
  for (size_t i = 0; i < bytes.levels.size(); ++i) writeFileAtomically(levelFile(target, i + 1), bytes.levels[i]);
  writeFileAtomically(target, bytes.glb);
}

std::optional<AssetRecord> readRecord(const fs::path& file) {
  try {
    BatchReport report = readBatchJson(readFileBytes(file), file.string());
    if (report.assets.size() == 1) return std::move(report.assets.front());
  } catch (const Error&) {
  }
  return std::nullopt;
}

std::string staleness(const fs::path& output, const std::string& name, const std::string& key, const std::optional<AssetRecord>& record) {
  std::error_code error;
  if (!fs::exists(output / name, error)) return "new";
  if (!record || record->key.size() != key.size()) return "no record of its bake";
  if (record->key.substr(0, 16) != key.substr(0, 16)) return "another build";
  if (record->key.substr(16, 16) != key.substr(16, 16)) return "settings changed";
  if (record->key != key) return "input changed";
  try {
    const bool as_written =
        isAsWritten(output / name, record->output_hash) && ownedLevels(output, name, *record).size() == record->level_hashes.size();
    return as_written ? "" : "output is not what was written";
  } catch (const IoError&) {
    return "output cannot be read";
  }
}

std::optional<AssetRecord> AssetCache::find(const std::string& key, AssetBytes& bytes) const {
  const fs::path stem = folder / key.substr(32, 2) / key;
  std::optional<AssetRecord> record = readRecord(stem.string() + ".json");
  if (!record || record->key != key) return std::nullopt;
  try {
    const fs::path file = stem.string() + ".glb";
    bytes.glb = readFileBytes(file);
    bytes.levels.clear();
    for (const std::string& hash : record->level_hashes) {
      bytes.levels.push_back(readFileBytes(levelFile(file, bytes.levels.size() + 1)));
      if (hashBytes(bytes.levels.back()) != hash) return std::nullopt;
    }
  } catch (const IoError&) {
    return std::nullopt;
  }
  if (hashBytes(bytes.glb) != record->output_hash) return std::nullopt;
  return record;
}

void AssetCache::add(const AssetRecord& record, const AssetBytes& bytes) const {
  const fs::path stem = folder / record.key.substr(32, 2) / record.key;
  createFolder(stem.parent_path());
  removeAbandonedFiles(stem.parent_path());
  const fs::path file = stem.string() + ".glb";
  for (size_t i = 0; i < bytes.levels.size(); ++i) writeFileAtomically(levelFile(file, i + 1), bytes.levels[i]);
  writeFileAtomically(file, bytes.glb);
  writeFileAtomically(stem.string() + ".json", recordText(record));
}

// Shards share the folder, each with its own lock; a whole batch locks it exclusively.
OutputLock::OutputLock(const fs::path& output, int shard, int shards) {
  const fs::path folder = stateFolder(output);
  createFolder(folder);
  lockFile(folder / kBatchLock, shards > 0 ? LockKind::kShared : LockKind::kExclusive, of_all_);
  if (shards == 0) return;
  lockFile(folder / ("lock-" + std::to_string(shard) + "-of-" + std::to_string(shards)), LockKind::kExclusive, of_shard_);
}

namespace {

// A record of an asset that is not in the batch any more.
struct StaleRecord {
  fs::path file;
  std::string name;                // of the asset
  std::vector<std::string> owned;  // its output, its levels and its live view, if they are there as they were written
};

std::vector<StaleRecord> staleRecords(const fs::path& output, const std::vector<PlannedAsset>& kept) {
  std::set<std::string> names;
  for (const PlannedAsset& asset : kept) names.insert(asset.name);
  std::vector<StaleRecord> stale;
  const fs::path state = stateFolder(output);
  std::error_code error;
  for (fs::recursive_directory_iterator entry(state, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (!entry->is_regular_file(error) || !file.filename().string().ends_with(".glb.json")) continue;
    const std::string name = file.lexically_relative(state).replace_extension().generic_string();
    if (names.contains(name)) continue;
    StaleRecord& one = stale.emplace_back();
    one.file = file;
    one.name = name;
    if (const auto old = readRecord(file)) {
      if (isAsWritten(output / name, old->output_hash)) one.owned.push_back(name);
      const std::vector<std::string> levels = ownedLevels(output, name, *old);
      one.owned.insert(one.owned.end(), levels.begin(), levels.end());
    }
    if (hasLiveView(output, name)) one.owned.push_back(liveViewName(name));
  }
  std::sort(stale.begin(), stale.end(), [](const StaleRecord& a, const StaleRecord& b) { return a.name < b.name; });
  return stale;
}

}  // namespace

std::vector<std::string> outputsToPrune(const fs::path& output, const std::vector<PlannedAsset>& kept) {
  std::vector<std::string> names;
  for (const StaleRecord& stale : staleRecords(output, kept)) names.insert(names.end(), stale.owned.begin(), stale.owned.end());
  return names;
}

std::vector<std::string> pruneOutputs(const fs::path& output, const std::vector<PlannedAsset>& kept) {
  std::vector<std::string> removed;
  const fs::path state = stateFolder(output);
  for (const StaleRecord& stale : staleRecords(output, kept)) {
    std::error_code error;
    for (const std::string& name : stale.owned) {
      fs::remove(output / name, error);
      if (error) throw IoError((output / name).string(), "cannot remove: " + error.message());
      removed.push_back(name);
    }
    removeThumbnail(output, stale.name);
    fs::remove(liveViewHashFile(output, stale.name), error);
    fs::remove(stale.file, error);
    for (const fs::path& base : {output, state})  // folders that are now empty
      for (fs::path folder = (base / stale.name).parent_path(); folder != base && fs::is_empty(folder, error) && !error;
           folder = folder.parent_path())
        fs::remove(folder, error);
  }
  return removed;
}

}  // namespace cloudbake
