// cloudbake batch MANIFEST.toml|FOLDER -o DIR: all of a manifest, in parallel; only what is not fresh.
#include "pipeline/batch/plan.h"

#include <sys/resource.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>

#include "pipeline/batch/run.h"
#include "pipeline/batch/state.h"
#include "app/commands.h"
#include "pipeline/batch/schedule.h"
#include "pipeline/batch/thumbnail.h"
#include "io/report/batch_parts.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The number of the signal that came. The first one lets the running assets end; the handler is gone then, so the second ends all at once,
// which harms no output either.
std::atomic<int> stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

void takeSignals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) {
    int none = 0;
    stop_signal.compare_exchange_strong(none, signal);
  };
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &action, nullptr);
}

double secondsOf(const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); }

// Of this process and of the readers that it started.
struct Usage {
  double processor_seconds = 0;
  uint64_t peak_memory = 0;  // bytes
};

Usage usageSoFar() {
  Usage all;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    all.processor_seconds += secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime);
    all.peak_memory = std::max(all.peak_memory, uint64_t(usage.ru_maxrss) * 1024);
  }
  return all;
}

ExitCode writeExample(const fs::path& file) {
  if (fs::exists(file)) throw UsageError("--init: " + file.string() + " is there already: remove it, or choose another name");
  writeFileAtomically(file, exampleManifest());
  std::printf("wrote %s: cloudbake batch %s -o baked\n", file.c_str(), file.c_str());
  return ExitCode::kDone;
}

void listWork(const std::vector<PlannedAsset>& assets, const std::vector<AssetRecord>& records) {
  size_t stale = 0;
  for (size_t i = 0; i < assets.size(); ++i) {
    const bool fresh = records[i].state == AssetState::kFresh;
    stale += fresh ? 0 : 1;
    std::printf("%-5s  %s  <- %s%s\n", fresh ? "fresh" : "bake", assets[i].name.c_str(), assets[i].source.c_str(),
                fresh ? "" : ("  (" + records[i].reason + ")").c_str());
  }
  std::printf("%zu assets, %zu to bake\n", assets.size(), stale);
}

// --- Reports ---

fs::path lastReport(const Settings& settings) {
  const BatchSettings& batch = settings.batch;
  const std::string shard = batch.shards > 0 ? "-" + std::to_string(batch.shard) + "-of-" + std::to_string(batch.shards) : "";
  return stateFolder(settings.output) / ("last_report" + shard + ".json");
}

std::vector<std::string> changesSinceLast(const BatchReport& report, const fs::path& last) {
  if (!fs::exists(last)) return {};
  try {
    return batchChanges(readBatchJson(readFileBytes(last), last.string()), report);
  } catch (const Error& error) {
    return {std::string("the last report cannot be read: ") + error.what()};
  }
}

std::vector<std::string> thumbnails(const BatchReport& report, const fs::path& output) {
  std::vector<std::string> pictures(report.assets.size());
  tbb::parallel_for(size_t(0), pictures.size(), [&](size_t i) {
    const std::string& name = report.assets[i].name;
    const fs::path file = thumbnailFile(output, name), asset = output / name;
    if (output.empty() || !fs::exists(asset)) return;
    try {
      pictures[i] = fs::exists(file) ? readFileBytes(file) : thumbnailOf(asset);
      if (!fs::exists(file)) writeFileAtomically(file, pictures[i]);
    } catch (const Error&) {  // an asset without a picture
    }
  });
  return pictures;
}

void writeReports(const BatchReport& report, const Settings& settings, const std::vector<std::string>& changes) {
  const BatchSettings& batch = settings.batch;
  if (settings.json) writeFileAtomically(*settings.json, batchJson(report));
  if (batch.junit) writeFileAtomically(*batch.junit, batchJunit(report));
  if (batch.html) writeFileAtomically(*batch.html, batchHtml(report, changes, thumbnails(report, settings.output)));
}

void writeDepfile(const Settings& settings, const BatchPlan& plan, const std::vector<AssetInputs>& inputs) {
  if (!settings.batch.depfile) return;
  std::vector<fs::path> files = plan.watched;
  for (const AssetInputs& asset : inputs) files.insert(files.end(), asset.files.begin(), asset.files.end());
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  writeFileAtomically(*settings.batch.depfile, depfileText(settings.batch.depfile_target.value_or(settings.output), files));
}

// "3 baked, 1 failed" and the exit code.
ExitCode summarize(const BatchReport& report, bool quiet) {
  std::string text;
  for (const AssetState state : kAssetStates)
    if (const size_t count = assetsIn(report, state); count > 0)
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(stateName(state));
  if (!quiet)
    std::printf("batch       %s%s\nseconds     %.2f, %.2f of %d processors busy\nmemory      %.0f MiB at most\n", text.c_str(),
                report.removed.empty() ? "" : (", " + std::to_string(report.removed.size()) + " removed").c_str(), report.seconds,
                report.processor_seconds / std::max(report.seconds, 1e-9), report.threads, double(report.peak_memory) / (1 << 20));
  const auto tell = [&](AssetState state, const char* what) {
    const size_t count = assetsIn(report, state);
    if (count > 0) std::fprintf(stderr, "cloudbake: %zu of %zu assets %s\n", count, report.assets.size(), what);
    return count > 0;
  };
  const bool failed = tell(AssetState::kFailed, "failed"), missing = tell(AssetState::kNotRun, "were not run");
  return failed || missing ? ExitCode::kBound : ExitCode::kDone;
}

// --- The reports of shards ---

ExitCode mergeReports(const Settings& settings) {
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
                                          ": they are of different batches");
    for (AssetRecord& asset : part.assets) {
      if (const auto [found, is_new] = seen.emplace(asset.name, file.string()); !is_new)
        throw InputError(file.string(), "'" + asset.name + "' stands in " + found->second + " too: the shards are of different batches");
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
  Settings writing = settings;
  if (writing.output.empty()) writing.output = merged.output;
  writeReports(merged, writing, {});
  return summarize(merged, settings.quiet);
}

BatchReport reportOf(const Settings& settings, const BatchPlan& plan) {
  BatchReport report;
  report.source = plan.source;
  report.output = settings.output.string();
  report.shard = settings.batch.shard;
  report.shards = settings.batch.shards;
  report.threads = int(threadCount());
  return report;
}

}  // namespace

ExitCode runBatch(Settings settings, const std::vector<AssetOption>& given) {
  const BatchSettings& batch = settings.batch;
  if (batch.merge) return mergeReports(settings);
  if (batch.init) return writeExample(batch.inputs.size() == 1 ? batch.inputs.front() : fs::path("clouds.toml"));
  if (settings.output.empty()) throw UsageError("-o DIR is needed: where to write");
  if (batch.prune && batch.shards > 0) throw UsageError("--prune looks at a whole batch: leave out --shard");
  const auto start = std::chrono::steady_clock::now();
  const double processor_seconds_before = usageSoFar().processor_seconds;
  const BatchPlan plan = planBatch(settings, given);
  const std::vector<PlannedAsset> assets = batch.shards > 0 ? shardOf(plan.assets, batch.shard, batch.shards) : plan.assets;
  const std::vector<AssetInputs> inputs = inputsOf(assets, plan);
  if (settings.dry_run) {
    listWork(assets, judgeAssets(assets, inputs, settings));
    return ExitCode::kDone;
  }

  const OutputLock lock(settings.output, batch.shard, batch.shards);
  takeSignals();
  BatchReport report = reportOf(settings, plan);
  report.assets = judgeAssets(assets, inputs, settings);
  runAssets(assets, plan, settings, stop_signal, report.assets);
  const int signal = stop_signal;
  report.interrupted = signal > 0;
  if (batch.prune && signal == 0) report.removed = pruneOutputs(settings.output, plan.assets);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Usage usage = usageSoFar();
  report.processor_seconds = usage.processor_seconds - processor_seconds_before;
  report.peak_memory = usage.peak_memory;

  const fs::path last = lastReport(settings);
  writeReports(report, settings, changesSinceLast(report, last));
  writeFileAtomically(last, batchJson(report));
  writeDepfile(settings, plan, inputs);
  const ExitCode code = summarize(report, settings.quiet);
  if (signal > 0) {
    std::fprintf(stderr, "cloudbake: stopped by a signal: the same command goes on from here\n");
    return ExitCode(128 + signal);
  }
  return code;
}

}  // namespace cloudbake
