#include "pipeline/batch/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "core/sculpt.h"
#include "core/text/scan.h"
#include "io/file/own_file.h"
#include "io/file/process.h"
#include "io/file/write_file.h"
#include "io/report/batch_parts.h"
#include "pipeline/batch/make_assets.h"
#include "pipeline/batch/thumbnail.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/run_files.h"
#include "pipeline/options/version.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

std::string workText(const std::vector<PlannedAsset>& assets, const std::vector<AssetRecord>& records) {
  std::string text;
  size_t stale = 0;
  for (size_t i = 0; i < assets.size(); ++i) {
    const bool fresh = records[i].state == AssetState::kFresh;
    stale += fresh ? 0 : 1;
    text += fmt::format("{:5}  {}  <- {}{}\n", fresh ? "fresh" : "bake", assets[i].name, assets[i].source,
                        fresh ? "" : "  (" + records[i].reason + ")");
  }
  return text + fmt::format("{} assets, {} to bake\n", assets.size(), stale);
}

fs::path lastReport(const Settings& settings) {
  const BatchSettings& batch = settings.batch;
  const std::string shard = batch.shards > 0 ? "-" + std::to_string(batch.shard) + "-of-" + std::to_string(batch.shards) : "";
  return stateFolder(settings.output.file) / ("last_report" + shard + ".json");
}

std::vector<BatchChange> changesSinceLast(const BatchReport& report, const fs::path& last) {
  if (!fs::exists(last)) return {{"this is the first run"}};
  try {
    return batchChanges(readBatchJson(readFileBytes(last), last.string()), report);
  } catch (const Error& error) {
    return {{std::string("the last report cannot be read: ") + error.what()}};
  }
}

// Calls `draw` for these assets, in parallel.
void drawEach(const std::vector<size_t>& which, const BatchReport& report, BatchListener& listener,
              const std::function<void(size_t)>& draw) {
  if (!which.empty()) listener.begin(which.size(), double(which.size()));
  parallelFor(which.size(), [&](size_t w) {
    const std::string& name = report.assets[which[w]].name;
    listener.start(name, 1);
    draw(which[w]);
    listener.finish(name, 1, "");
  });
}

// The thumbnail of each asset that has one. What is not there yet is drawn.
void addThumbnails(const BatchReport& report, const fs::path& output, const BatchSettings& batch, uint64_t memory_limit,
                   BatchListener& listener, std::vector<AssetPicture>& pictures) {
  std::vector<size_t> missing;
  const auto fileOf = [&](size_t i) { return thumbnailFile(output, report.assets[i].name); };
  for (size_t i = 0; i < pictures.size(); ++i) try {
      if (fs::exists(fileOf(i)))
        pictures[i].jpeg = readFileBytes(fileOf(i));
      else if (fs::exists(output / report.assets[i].name) && !batch.orders.crashed.contains(report.assets[i].name))
        missing.push_back(i);
    } catch (const Error&) {  // the asset has no picture
    }
  drawEach(missing, report, listener, [&](size_t i) {
    try {
      pictures[i].jpeg = thumbnailOf(output / report.assets[i].name, memory_limit);
      writeFileAtomically(fileOf(i), pictures[i].jpeg);
    } catch (const Error&) {  // nor here
    }
  });
}

// The live view of each asset that is as it should be. What is not there yet, or out of date, is written.
void addLiveViews(const BatchReport& report, const fs::path& output, const Settings& settings, BatchListener& listener,
                  std::vector<AssetPicture>& pictures) {
  const BatchSettings& batch = settings.batch;
  const fs::path here = fs::absolute(*batch.html).lexically_normal().parent_path();
  const auto link = [&](size_t i) {
    const fs::path there = fs::absolute(output / liveViewName(report.assets[i].name)).lexically_normal();
    pictures[i].live_view = there.lexically_relative(here).generic_string();
  };
  std::vector<size_t> missing;
  for (size_t i = 0; i < pictures.size(); ++i) {
    const AssetRecord& asset = report.assets[i];
    if (asset.state == AssetState::kFailed || asset.state == AssetState::kNotRun || batch.orders.crashed.contains(asset.name)) continue;
    if (hasLiveView(output, asset.name))
      link(i);
    else
      missing.push_back(i);
  }
  drawEach(missing, report, listener, [&](size_t i) {
    const std::string& name = report.assets[i].name;
    try {
      const fs::path page = output / liveViewName(name);
      if (!settings.run.force && isForeignFile(page)) throw UsageError(foreignFile(page));
      writeLiveView(output, name, liveViewOf(output / name, settings.source.memory_limit));
      link(i);
    } catch (const std::exception& error) {
      listener.tell("cloudbake: warning: no live view of " + name + ": " + error.what() + "\n");
    }
  });
}

std::vector<AssetPicture> picturesOf(const BatchReport& report, const fs::path& output, const Settings& settings, BatchListener& listener) {
  const BatchSettings& batch = settings.batch;
  if (!batch.html || output.empty()) return {};
  std::vector<AssetPicture> pictures(report.assets.size());
  addThumbnails(report, output, batch, settings.source.memory_limit, listener, pictures);
  if (batch.live) addLiveViews(report, output, settings, listener, pictures);
  return pictures;
}

// Writes a report. It may lie in a folder of the output that no asset has needed.
void writeReport(const fs::path& file, const fs::path& output, std::string_view text) {
  if (liesIn(output, file)) createFolder(file.parent_path());
  writeFileAtomically(file, text);
}

void writeReports(const BatchReport& report, const Settings& settings, const std::vector<BatchChange>& changes,
                  const std::vector<AssetPicture>& pictures) {
  const BatchSettings& batch = settings.batch;
  const fs::path& output = settings.output.file;
  if (settings.run.json) writeReport(*settings.run.json, output, batchJson(report));
  if (batch.junit) writeReport(*batch.junit, output, batchJunit(report));
  if (batch.html) writeReport(*batch.html, output, batchHtml(report, changes, pictures));
}

// A file, or the folder where it would appear if it is missing: build tools run again and again for an input that does not exist.
fs::path watchable(fs::path file) {
  std::error_code error;
  while (!file.empty() && !fs::exists(file, error)) file = file.parent_path();
  return file.empty() ? "." : file;
}

// The text of --depfile. Throws InputError for a name that it cannot contain.
std::optional<std::string> depfileOf(const Settings& settings, const BatchPlan& plan, const std::vector<AssetInputs>& inputs) {
  if (!settings.batch.depfile) return std::nullopt;
  std::vector<fs::path> files = bakeLibraries();
  files.insert(files.end(), plan.watched.begin(), plan.watched.end());
  for (const AssetInputs& asset : inputs) files.insert(files.end(), asset.files.begin(), asset.files.end());
  for (fs::path& file : files) file = watchable(std::move(file));
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return depfileText(settings.batch.depfile_target.value_or(settings.output.file), files);
}

// Removes what killed batches left in the folders of the output, and in those of its records.
void removeLeftovers(const std::vector<PlannedAsset>& assets, const fs::path& output) {
  std::set<fs::path> folders{output, stateFolder(output)};
  for (const PlannedAsset& asset : assets)
    for (const fs::path& file : {output / asset.name, recordFile(output, asset.name)}) folders.insert(file.parent_path());
  for (const fs::path& folder : folders) removeAbandonedFiles(folder);
}

// Which assets --units and --up were for, by the formats of their sculpts. Those that were not baked or read are left out.
std::string framesText(const std::vector<PlannedAsset>& assets, const std::vector<AssetRecord>& records) {
  std::map<std::string, size_t> given, kept;
  size_t given_count = 0, kept_count = 0;
  for (size_t i = 0; i < assets.size(); ++i) {
    if (!assets[i].from.read.frame_if_unstated || !records[i].report.is_object() || !records[i].report.contains("frame")) continue;
    const bool is_given = isFrameGiven(records[i].report["frame"].get<std::string>());
    ++(is_given ? given : kept)[lowerCase(assets[i].from.input.extension().string())];
    ++(is_given ? given_count : kept_count);
  }
  const auto formats = [](const std::map<std::string, size_t>& of) {
    std::string text;
    for (const auto& [extension, count] : of) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, extension);
    return text;
  };
  if (given_count + kept_count == 0) return "";
  std::string text = fmt::format("--units and --up are for {} of {} sculpts", given_count, given_count + kept_count);
  if (given_count > 0) text += fmt::format(" ({})", formats(given));
  if (kept_count > 0) text += fmt::format("; {} state their own ({})", kept_count, formats(kept));
  return text;
}

BatchReport reportOf(const Settings& settings, const BatchPlan& plan) {
  BatchReport report;
  report.source = plan.source;
  report.output = settings.output.file.string();
  report.shard = settings.batch.shard;
  report.shards = settings.batch.shards;
  report.threads = int(assetsAtOnce(settings));
  return report;
}

// The plan, with the assets of this shard and their inputs.
struct Work {
  BatchPlan plan;
  std::vector<PlannedAsset> assets;
  std::vector<AssetInputs> inputs;
};

void addReports(const Settings& settings, RunFiles& files) {
  const auto add = [&](const std::optional<fs::path>& file, const char* role) {
    if (file) files.outputs.push_back({*file, role});
  };
  const BatchSettings& batch = settings.batch;
  add(settings.run.json, "--json"), add(batch.junit, "--junit"), add(batch.html, "--html"), add(batch.depfile, "--depfile");
}

// Adds what is written for an asset of this name.
void addOutputs(const std::string& name, size_t levels, const fs::path& output, const BatchSettings& batch, RunFiles& files) {
  files.outputs.push_back({output / name, name});
  for (const std::string& level : levelNames(name, levels)) files.outputs.push_back({output / level, level});
  if (batch.live) files.outputs.push_back({output / liveViewName(name), "the live view of " + name});
}

RunFiles filesOf(const Work& work, const Settings& settings) {
  RunFiles files;
  for (const fs::path& watched : work.plan.watched) files.inputs.push_back({watched, "the manifest"});
  for (size_t i = 0; i < work.assets.size(); ++i)
    for (const fs::path& input : work.inputs[i].files) files.inputs.push_back({input, "an input of " + work.assets[i].name});
  for (const PlannedAsset& asset : work.plan.assets) addOutputs(asset.name, asset.levels, settings.output.file, settings.batch, files);
  addReports(settings, files);
  return files;
}

Work planWork(const Settings& settings, std::span<const Given> given) {
  Work work;
  work.plan = planBatch(settings, given);
  const BatchSettings& batch = settings.batch;
  work.assets = batch.shards > 0 ? shardOf(work.plan.assets, batch.shard, batch.shards) : work.plan.assets;
  work.inputs = inputsOf(work.assets, work.plan, settings.source.read.read_file);
  const RunFiles files = filesOf(work, settings);
  refuseSharedFiles(files);
  refuseRecords(files, settings.output.file, settings.batch.cache.value_or(fs::path()));
  return work;
}

}  // namespace

BatchReport bakeBatch(const Settings& settings, std::span<const Given> given, std::atomic<int>& stop, BatchListener& listener) {
  helpIfHelper(settings, given);
  const BatchSettings& batch = settings.batch;
  const Stopwatch watch;
  const double processor_seconds_before = usageOfProcesses().processor_seconds;
  Work work = planWork(settings, given);
  const BatchPlan& plan = work.plan;

  const fs::path& output = settings.output.file;
  depfileOf(settings, plan, work.inputs);  // what it cannot contain is found before any bake
  const OutputLock lock(output, batch.shard, batch.shards);
  removeLeftovers(plan.assets, output);
  BatchReport report = reportOf(settings, plan);
  report.assets = judgeAssets(work.assets, work.inputs, settings);
  if (const BatchOrders& orders = batch.orders; orders.done.empty() && orders.alone.empty() && orders.crashed.empty())
    for (const std::string& note : plan.notes) listener.tell("cloudbake: " + note + "\n");
  runAssets(work.assets, work.inputs, plan, settings, stop, listener, report.assets);
  report.frames = framesText(work.assets, report.assets);
  const int signal = stop;
  report.interrupted = signal > 0;
  if (batch.prune && signal == 0) report.removed = pruneOutputs(output, plan.assets);
  const std::vector<AssetPicture> pictures = picturesOf(report, output, settings, listener);
  report.seconds = watch.elapsed();
  const ProcessUsage usage = usageOfProcesses();
  report.processor_seconds = usage.processor_seconds - processor_seconds_before;
  report.peak_memory = usage.peak_memory;

  const fs::path last = lastReport(settings);
  writeReports(report, settings, changesSinceLast(report, last), pictures);
  writeFileAtomically(last, batchJson(report));
  if (const auto depfile = depfileOf(settings, plan, work.inputs)) writeReport(*batch.depfile, output, *depfile);
  return report;
}

std::string listWork(const Settings& settings, std::span<const Given> given) {
  const Work work = planWork(settings, given);
  const std::vector<AssetRecord> records = judgeAssets(work.assets, work.inputs, settings);
  const fs::path& output = settings.output.file;
  std::string text = workText(work.assets, records);
  for (const std::string& note : work.plan.notes) text += "note   " + note + "\n";
  if (settings.batch.live)
    for (const AssetRecord& asset : records)
      if (asset.state != AssetState::kFresh || !hasLiveView(output, asset.name)) text += "write   " + liveViewName(asset.name) + "\n";
  if (settings.batch.prune)
    for (const std::string& name : outputsToPrune(output, work.plan.assets)) text += "remove  " + name + "\n";
  return text;
}

BatchReport mergeShards(const Settings& settings, BatchListener& listener) {
  if (settings.batch.inputs.empty())
    throw UsageError("--merge needs the reports of the shards: cloudbake batch --merge shard*.json --html page.html");
  BatchReport merged;
  std::map<std::string, std::string> seen;
  std::map<int, std::string> shards;
  for (const fs::path& file : settings.batch.inputs) {
    BatchReport part = readBatchJson(readFileBytes(file), file.string());
    if (part.shards > 0 && !shards.emplace(part.shard, file.string()).second)
      throw InputError(file.string(),
                       "this is shard " + std::to_string(part.shard) + ", and so is " + shards[part.shard] + ": leave one out");
    if (merged.shards > 0 && part.shards != merged.shards)
      throw InputError(file.string(), "a shard of " + std::to_string(part.shards) + " among shards of " + std::to_string(merged.shards) +
                                          ": they are from different batches");
    for (AssetRecord& asset : part.assets) {
      if (const auto [found, is_new] = seen.emplace(asset.name, file.string()); !is_new)
        throw InputError(file.string(), "'" + asset.name + "' is also in " + found->second + ": the shards are from different batches");
      merged.assets.push_back(std::move(asset));
    }
    merged.source = part.source;
    merged.output = part.output;
    merged.shards = part.shards;
    merged.seconds = std::max(merged.seconds, part.seconds);
    merged.processor_seconds += part.processor_seconds;
    merged.peak_memory = std::max(merged.peak_memory, part.peak_memory);
    merged.threads += part.threads;
    merged.interrupted = merged.interrupted || part.interrupted;
    merged.removed.insert(merged.removed.end(), part.removed.begin(), part.removed.end());
  }
  std::string missing;
  for (int shard = 1; shard <= merged.shards; ++shard)
    if (!shards.contains(shard)) missing += (missing.empty() ? "" : ", ") + std::to_string(shard);
  if (!missing.empty())
    throw InputError(merged.source, "no report of shard " + missing + " of " + std::to_string(merged.shards) + ": run it, or wait for it");
  merged.shards = 0;
  std::sort(merged.assets.begin(), merged.assets.end(), [](const AssetRecord& a, const AssetRecord& b) { return a.name < b.name; });
  const fs::path output = settings.output.file.empty() ? fs::path(merged.output) : settings.output.file;
  RunFiles files;
  for (const fs::path& file : settings.batch.inputs) files.inputs.push_back({file, "the report of a shard"});
  for (const AssetRecord& asset : merged.assets) addOutputs(asset.name, asset.level_hashes.size(), output, settings.batch, files);
  addReports(settings, files);
  refuseSharedFiles(files);
  refuseRecords(files, output, {});
  writeReports(merged, settings, {{"merged shards are not compared with an earlier report: see the report of each shard"}},
               picturesOf(merged, output, settings, listener));
  return merged;
}

}  // namespace cloudbake
