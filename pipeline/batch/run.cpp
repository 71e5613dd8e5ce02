#include "pipeline/batch/run.h"

#include <tbb/parallel_for.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <new>

#include "pipeline/sources/grown.h"
#include "pipeline/measure/curve.h"
#include "pipeline/asset.h"
#include "app/progress.h"
#include "pipeline/batch/schedule.h"
#include "pipeline/sources/volume.h"
#include "bake/truth/error_metrics.h"
#include "io/report/report.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

constexpr size_t kTruthVertices = 200;
constexpr uint64_t kProgramMemory = 50'000'000;  // of the program and its libraries, before any asset
constexpr int kStages = 6;                       // of a grown cloud and of a sculpt, as Stopwatch counts them

// What one run shares.
struct Run {
  const BatchPlan& plan;
  const Settings& settings;
  Progress progress;
};

AssetFigures figuresOf(const Scene& scene, const std::vector<Lobe>& all_lobes, const Settings& settings, const BakeReport& report) {
  const Oracle oracle = askOracle(scene, settings);
  const std::vector<Lobe> lobes = pick(all_lobes, oracle.vertices);
  const LobeError lobe = compareLobes(lobes, oracle.truth);
  const TransmittanceError formula =
      compareTransmittance(lobes, report.info.shape, bothSenses(oracle.axes), oracle.lengths, report.info.extinction);
  AssetFigures figures;
  figures.truth = oracle.name;
  figures.vertices = lobes.size();
  const bool is_mean = !settings.fit;  // a fitted o is no mean direction, a fitted d no thickness
  figures.direction_rms_degrees = is_mean ? lobe.angle_rms_degrees : NAN;
  figures.direction_median_degrees = is_mean ? lobe.angle_median_degrees : NAN;
  figures.direction_p95_degrees = is_mean ? lobe.angle_p95_degrees : NAN;
  figures.direction_max_degrees = is_mean ? lobe.angle_max_degrees : NAN;
  figures.density_rms = is_mean ? lobe.density_rms : NAN;
  figures.density_bias = is_mean ? lobe.density_bias : NAN;
  figures.transmittance_rms = formula.rms;
  figures.transmittance_bias = formula.bias;
  return figures;
}

// Grows or reads, bakes, and measures if that is asked for; the bytes of the GLB.
std::string bake(const PlannedAsset& asset, Run& run, AssetRecord& record) {
  Settings settings = settingsOf(asset, run.plan, run.settings);
  BakeReport report;
  Stopwatch watch([&](const std::string& stage) { run.progress.stage(asset.name, stage); });
  const bool grown = isGrown(asset);
  report.command = grown ? "grow" : "bake";
  if (!grown) checkVolumeOptions(settings);
  const Scene scene = grown ? growScene(
                                  settings, [&](Settings& again) { applyOptions(asset, again); }, report, watch)
                            : readScene(settings, report, watch);
  resolveInfo(settings, scene, report, watch);
  EncodedAsset encoded = encodeAsset(scene, settings, report, watch);
  if (run.settings.bounds.any()) {
    settings.truth_vertices = run.settings.truth_vertices.value_or(kTruthVertices);
    record.figures = figuresOf(scene, encoded.lobes, settings, report);
    watch.lap(report, "truth");
  }
  report.output = record.name;
  record.report = Json::parse(reportJson(report));
  run.progress.tell(warningLines(report));
  return std::move(encoded.glb);
}

void fail(AssetRecord& record, ExitCode code, const std::string& what) {
  record.state = AssetState::kFailed;
  record.code = int(code);
  record.error = what;
}

// A shared cache that fails costs time, not the batch.
void addToCache(const AssetCache& cache, const AssetRecord& record, const std::string& glb, Progress& progress) {
  try {
    cache.add(record, glb);
  } catch (const Error& error) {
    progress.tell(std::string("cloudbake: warning: not kept in the cache: ") + error.what() + "\n");
  }
}

// From the cache, or baked; then written. What is over a bound is written all the same: judgeBounds tells.
void make(const PlannedAsset& asset, Run& run, AssetRecord& record) {
  const auto& folder = run.settings.batch.cache;
  const bool needs_figures = run.settings.bounds.any();
  std::string glb;
  if (folder && !record.key.empty() && !run.settings.batch.force) {
    const std::optional<AssetRecord> kept = AssetCache{*folder}.find(record.key, glb);
    if (kept && (kept->figures || !needs_figures)) {
      record.state = AssetState::kFromCache;
      record.report = kept->report;
      record.report["input"] = asset.source;
      record.report["output"] = record.name;
      record.figures = kept->figures;
    }
  }
  if (record.state == AssetState::kNotRun) {
    glb = bake(asset, run, record);
    record.state = AssetState::kBaked;
  }
  record.bytes = glb.size();
  record.output_hash = hashBytes(glb);
  if (folder && record.state == AssetState::kBaked && !record.key.empty()) addToCache({*folder}, record, glb, run.progress);
  writeOutput(run.settings.output, record, glb);
}

void makeOrFail(const PlannedAsset& asset, Run& run, AssetRecord& record) {
  const auto start = std::chrono::steady_clock::now();
  try {
    make(asset, run, record);
  } catch (const Error& error) {
    fail(record, error.code, error.what());
  } catch (const std::bad_alloc&) {
    fail(record, ExitCode::kInput, asset.source + ": not enough memory: fewer --voxels, a smaller input, or less at once (--memory)");
  } catch (const std::exception& error) {
    fail(record, ExitCode::kInternal, asset.source + ": internal error: " + error.what());
  }
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void judgeBounds(AssetRecord& record, const ErrorBounds& bounds) {
  if (!record.figures || record.state == AssetState::kFailed) return;
  const AssetFigures& f = *record.figures;
  char text[160];
  if (bounds.angle_degrees && f.direction_rms_degrees > *bounds.angle_degrees) {
    std::snprintf(text, sizeof text, ": direction off by %.3g degrees rms, over --max-angle %g: more --rays or --voxels",
                  f.direction_rms_degrees, *bounds.angle_degrees);
    fail(record, ExitCode::kBound, record.name + text);
  } else if (bounds.transmittance_rms && !(f.transmittance_rms <= *bounds.transmittance_rms)) {
    std::snprintf(text, sizeof text, ": transmittance off by %.3g rms, over --max-transmittance-rms %g: --lobe fit comes nearer",
                  f.transmittance_rms, *bounds.transmittance_rms);
    fail(record, ExitCode::kBound, record.name + text);
  }
}

std::string lineOf(const AssetRecord& record) {
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "  %.2f s", record.seconds);
  const std::string why = record.reason.empty() ? "" : "  (" + record.reason + ")";
  return std::string(stateName(record.state)) + "  " + record.name + seconds + why;
}

std::string failureLine(const AssetRecord& record) {
  return record.state == AssetState::kFailed ? "cloudbake: " + record.error + "\n" : "";
}

}  // namespace

std::vector<AssetRecord> judgeAssets(const std::vector<PlannedAsset>& assets, const std::vector<AssetInputs>& inputs,
                                     const Settings& settings) {
  std::vector<AssetRecord> records(assets.size());
  tbb::parallel_for(size_t(0), assets.size(), [&](size_t i) {
    AssetRecord& record = records[i];
    const std::optional<AssetRecord> known = readRecord(recordFile(settings.output, assets[i].name));
    std::string reason = inputs[i].key.empty() ? "input cannot be read" : staleness(settings.output, assets[i].name, inputs[i].key, known);
    if (reason.empty() && settings.batch.force) reason = "forced";
    if (reason.empty() && settings.bounds.any() && !known->figures) reason = "error not measured yet";
    if (reason.empty()) {
      record = *known;
      record.state = AssetState::kFresh;
      record.seconds = 0;
    }
    record.name = assets[i].name;
    record.source = assets[i].source;
    record.key = inputs[i].key;
    record.reason = reason;
    record.code = 0;
    record.error.clear();
  });
  return records;
}

void runAssets(const std::vector<PlannedAsset>& assets, const BatchPlan& plan, const Settings& settings, std::atomic<int>& stop,
               std::vector<AssetRecord>& records) {
  std::vector<size_t> stale;
  std::vector<Job> jobs;
  double total_cost = 0;
  for (size_t i = 0; i < assets.size(); ++i) {
    if (records[i].state == AssetState::kFresh) {
      judgeBounds(records[i], settings.bounds);
      std::fputs(failureLine(records[i]).c_str(), stderr);
      continue;
    }
    stale.push_back(i);
    jobs.push_back({assets[i].cost_seconds, assets[i].memory});
    total_cost += assets[i].cost_seconds;
  }
  Run run{plan, settings, Progress(stale.size(), total_cost, settings.quiet)};
  const auto memory = settings.batch.memory.value_or(uint64_t(::sysconf(_SC_PHYS_PAGES)) / 4 * 3 * uint64_t(::sysconf(_SC_PAGESIZE)));
  runJobs(jobs, memory > kProgramMemory ? memory - kProgramMemory : 0, stop, [&](size_t job) {
    const PlannedAsset& asset = assets[stale[job]];
    AssetRecord& record = records[stale[job]];
    run.progress.start(asset.name, kStages);
    makeOrFail(asset, run, record);
    judgeBounds(record, settings.bounds);
    int none = 0;
    if (record.state == AssetState::kFailed && settings.batch.fail_fast) stop.compare_exchange_strong(none, -1);
    run.progress.finish(asset.name, asset.cost_seconds, lineOf(record));
    run.progress.tell(failureLine(record));
  });
}

}  // namespace cloudbake
