// cloudbake batch MANIFEST.toml|FOLDER -o DIR: bakes what is not fresh in a manifest or a folder, in parallel.
#include <fmt/format.h>

#include <atomic>
#include <csignal>

#include "app/commands.h"
#include "app/progress.h"
#include "app/signals.h"
#include "app/supervise.h"
#include "app/tell.h"
#include "io/file/process.h"
#include "io/file/write_file.h"
#include "io/report/batch_parts.h"
#include "pipeline/batch/batch.h"

namespace cloudbake {

namespace {

// The number of the signal that came. The first one lets the running assets end; the second ends all at once, which harms no output either.
std::atomic<int> stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

void takeSignals() {
  for (const auto& [one, sent] : workerSignals()) {
    handleSignal(sent, [](int signal) {
      for (const auto& [original, passed_on] : workerSignals()) {
        int none = 0;
        if (signal == passed_on && !stop_signal.compare_exchange_strong(none, original)) endBySignal(signal);
      }
    });
    if (one != sent) std::signal(one, SIG_IGN);
  }
}

ExitCode writeExample(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) throw UsageError("--init: " + file.string() + " already exists: remove it, or choose another name");
  writeFileAtomically(file, exampleManifest());
  say(stdout, fmt::format("wrote {0}: cloudbake batch {0} -o baked\n", file.string()));
  return ExitCode::kDone;
}

// "3 baked, 1 failed" and the exit code.
ExitCode summarize(const BatchReport& report, bool quiet) {
  std::string text;
  for (const AssetState state : kAssetStates)
    if (const size_t count = assetsIn(report, state); count > 0)
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(stateName(state));
  if (!quiet && !report.frames.empty()) say(stdout, "frame       " + report.frames + "\n");
  if (!quiet)
    fmt::print("batch       {}{}\nseconds     {:.2f}, {:.2f} of {} processors busy\nmemory      {:.0f} MiB at most\n", text,
               report.removed.empty() ? "" : fmt::format(", {} removed", report.removed.size()), report.seconds,
               report.processor_seconds / std::max(report.seconds, 1e-9), report.threads, double(report.peak_memory) / (1 << 20));
  const auto tell = [&](AssetState state, const char* what) {
    const size_t count = assetsIn(report, state);
    if (count > 0) fmt::print(stderr, "cloudbake: {} of {} assets {}\n", count, report.assets.size(), what);
    return count > 0;
  };
  const bool failed = tell(AssetState::kFailed, "failed"), missing = tell(AssetState::kNotRun, "were not run");
  return failed || missing ? ExitCode::kBound : ExitCode::kDone;
}

}  // namespace

ExitCode runBatch(const CommandLine& line) {
  // Options of the run are for the batch itself; options of assets go to every asset that they apply to.
  std::vector<Given> of_run, of_assets;
  for (const Given& given : line.given) {
    const bool of_asset = findAssetOption(given.option->name) != nullptr;
    if (of_asset) of_assets.push_back(given);
    if (!of_asset || std::string_view(given.option->name) == "strict") of_run.push_back(given);
  }
  Settings asked = settingsOf(line, of_run);
  if (line.is_worker) asked.batch.orders = takeOrders();
  const Settings settings = asked;
  const BatchSettings& batch = settings.batch;
  Progress progress(settings.run.quiet);
  if (batch.merge) {
    const BatchReport merged = mergeShards(settings, progress);
    progress.clear();
    return summarize(merged, settings.run.quiet);
  }
  if (batch.init) return writeExample(batch.inputs.size() == 1 ? batch.inputs.front() : "clouds.toml");
  if (settings.output.file.empty()) throw UsageError("-o DIR is needed: where to write");
  if (batch.dry_run) {
    say(stdout, listWork(settings, of_assets));
    return ExitCode::kDone;
  }
  if (!line.is_worker) return superviseBatch(line.words, batch.input_list == "-");
  takeSignals();
  endWithParent();  // nobody waits for a worker whose supervisor was killed
  JournalListener journal(progress);
  const BatchReport report = bakeBatch(settings, of_assets, stop_signal, journal);
  progress.clear();
  const ExitCode code = summarize(report, settings.run.quiet);
  if (!report.interrupted) return code;
  fmt::print(stderr, "cloudbake: stopped by a signal: the same command continues from here\n");
  return ExitCode(128 + stop_signal);
}

}  // namespace cloudbake
