#include "pipeline/batch/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/parallel.h"
#include "core/text/json.h"
#include "core/text/markup.h"
#include "io/file/input_files.h"
#include "io/file/own_file.h"
#include "io/file/process.h"
#include "io/gltf/sequence/sequence_file.h"
#include "io/report/figures.h"
#include "io/report/report.h"
#include "pipeline/asset/asset.h"
#include "pipeline/asset/levels.h"
#include "pipeline/batch/make_assets.h"
#include "pipeline/measure/oracle.h"
#include "pipeline/options/resolve.h"
#include "pipeline/options/run_files.h"
#include "pipeline/sequence/sequence.h"
#include "pipeline/sources/grown.h"

namespace cloudbake {

namespace {

constexpr size_t kTruthVertices = 200;
constexpr uint64_t kProgramMemory = 50'000'000;  // of the program and its libraries, before any asset
constexpr uint64_t kSlack = 256'000'000;         // of memory beyond an asset's plan
constexpr uint64_t kAllMemory = 1ULL << 60;      // of a job that nothing may run beside
constexpr int kStages = 6;                       // stages of a grown cloud and of a sculpt, as Stopwatch counts them

size_t truthVertices(const Settings& of_run) { return of_run.judge.truth_vertices.value_or(kTruthVertices); }

// Why the known figures cannot answer the bounds, or nothing if they can.
std::string unmeasured(const AssetRecord& known, const Settings& of_run) {
  const bool is_sequence = known.report.is_object() && known.report.value("command", "") == "sequence";
  if (!of_run.judge.bounds.any() || is_sequence) return "";  // `check` judges sequences
  if (!known.figures) return "error not measured yet";
  const size_t vertices = known.report.is_object() ? known.report.value("vertices", size_t(0)) : 0;
  return known.figures->vertices < std::min(truthVertices(of_run), vertices) ? "error measured at fewer vertices" : "";
}

BakeFigures figuresOf(const Cloud& cloud, const std::vector<Lobe>& lobes, const Settings& settings, const BakeParameters& parameters,
                      const BakeReport& report, const Settings& of_run) {
  const Oracle oracle = askOracle(cloud, settings.field, truthVertices(of_run),
                                  {.extinction = parameters.extinction,
                                   .volume = report.info.volume,
                                   .ray_length = *parameters.bake.ray_length,
                                   .over_surface = true,
                                   .is_check = report.info.volume.has_value()});
  BakeFigures figures = figuresAgainst(oracle, lobes, settings.lobe.fit, report.info.shape, parameters.extinction);
  for (const FigureField& field : figureFields())
    if (figures.is_fit && field.of_mean_lobe) field.value(figures) = NAN;
  return figures;
}

// All frames of a sequence, as `cloudbake sequence` bakes them.
AssetBytes bakeFrames(const PlannedAsset& asset, const SourceSettings& from, Stopwatch& watch, AssetRecord& record) {
  BakeReport report;
  report.command = "sequence";
  report.input = asset.source;
  std::vector<Given> given = asset.given;
  std::vector<FrameInput> frames = asset.frames;
  std::optional<GrownSource> source;
  if (isGrown(from.kind)) given = withRecipe(source.emplace(readGrownSource(from)), asset.given);
  Settings settings = resolve(from, given);
  if (frames.empty()) frames = madeFrames(settings, source);
  const BakedSequence baked = bakeSequence(frames, settings, given, report, watch);
  const auto form = settings.sequence.output == SequenceOutput::kMorph ? SequenceForm::kMorph : SequenceForm::kTexture;
  AssetBytes bytes{encodeSequence(baked.sequence, form), {}};
  watch.lap(report.seconds, "encode");
  report.output = record.name;
  record.report = parseJson(reportJson(report)).value();
  return bytes;
}

// Grows or reads an asset, bakes it within this memory, and measures it if there are bounds. Returns what is to be written.
AssetBytes bake(const PlannedAsset& asset, uint64_t memory, const AssetRun& run, AssetRecord& record) {
  BakeReport report;
  Stopwatch watch([&](const std::string& stage) { run.listener.stage(asset.name, stage); });
  const bool grown = isGrown(asset.from.kind);
  report.command = grown ? "grow" : "bake";
  const std::optional<SceneNeeds> scene = sceneOf(asset, run.plan);
  SourceSettings from = asset.from;
  from.memory_limit = memory;
  if (asset.is_sequence) return bakeFrames(asset, from, watch, record);
  std::optional<GrownSource> source;
  std::vector<Given> given;
  if (grown) given = source.emplace(readGrownSource(from)).given;
  given.insert(given.end(), asset.given.begin(), asset.given.end());
  Settings settings = resolve(from, given, scene);
  settings.output.file = record.name;

  const Cloud cloud = grown ? growCloud(std::move(*source), settings, scene, report, watch) : readCloud(settings, report, watch);
  const BakeParameters parameters = resolveParameters(cloud, settings, report, watch);
  BakedAsset baked = bakeAsset(cloud, settings, parameters, report, watch);
  if (run.settings.judge.bounds.any()) {
    record.figures = figuresOf(cloud, baked.lobes, settings, parameters, report, run.settings);
    watch.lap(report.seconds, "truth");
  }
  report.output = record.name;
  record.report = parseJson(reportJson(report)).value();
  AssetBytes bytes{std::move(baked.glb), {}};
  for (LevelAsset& level : baked.levels) bytes.levels.push_back(std::move(level.glb));
  return bytes;
}

void fail(AssetRecord& record, ExitCode code, const std::string& what) {
  record.state = AssetState::kFailed;
  record.code = int(code);
  record.error = what;
}

void failByFault(const std::string& source, const std::string& fault, AssetRecord& record) {
  fail(record, ExitCode::kInternal,
       source + ": it crashed the program (" + fault + "); please report it, and export it again or leave it out");
}

// A signal from outside is no fault of the asset.
void failByCrash(const std::string& source, int signal, AssetRecord& record) {
  const std::string name = " (" + signalText(signal) + ")";
  if (isFault(signal))
    failByFault(source, signalText(signal), record);
  else
    fail(record, ExitCode::kSystem,
         source + ": the program was killed while this was baked" + name +
             "; run the batch again, with a lower --memory or fewer --voxels if the system had no memory left");
}

// An error of a shared cache costs time, but does not end the batch.
void addToCache(const AssetCache& cache, const AssetRecord& record, const AssetBytes& bytes, BatchListener& listener) {
  try {
    cache.add(record, bytes);
  } catch (const Error& error) {
    listener.tell(std::string("cloudbake: warning: not kept in the cache: ") + error.what() + "\n");
  }
}

// An output that another program has put there stays.
void refuseForeignOutputs(const PlannedAsset& asset, const Settings& of_run) {
  if (of_run.run.force) return;
  std::vector<std::string> names = levelNames(asset.name, asset.levels);
  names.push_back(asset.name);
  for (const std::string& name : names)
    if (const std::filesystem::path file = of_run.output.file / name; isForeignFile(file)) throw UsageError(foreignFile(file));
}

// Levels of an earlier output that stay, because somebody has changed them or no record says whose they are.
void tellOfStaleLevels(const std::filesystem::path& output, const std::string& name, size_t levels, BatchListener& listener) {
  std::vector<std::filesystem::path> stale = staleLevels(output / name, levels);
  for (const std::string& removed : levelsToRemove(output, name, levels)) std::erase(stale, output / removed);
  for (const std::filesystem::path& file : stale)
    listener.tell("cloudbake: warning: " + file.string() + ": this level of detail is of an earlier bake: remove it\n");
}

// Takes the asset from the cache or bakes it, then writes it. An asset that exceeds a bound is written too; judgeBounds reports it.
void make(const PlannedAsset& planned, uint64_t memory, const AssetRun& run, AssetInputs& inputs, AssetRecord& record) {
  refuseForeignOutputs(planned, run.settings);
  InputFiles files(planned.from.read.read_file, planned.frames.empty());
  PlannedAsset asset = planned;
  asset.from.read.read_file = [&files](const std::filesystem::path& file) { return files.read(file); };
  inputs = inputsOf({asset}, run.plan, asset.from.read.read_file).front();
  record.key = inputs.key;
  files.seal();

  const auto& folder = run.settings.batch.cache;
  AssetBytes bytes;
  if (folder && !record.key.empty() && !run.settings.run.force) {
    const std::optional<AssetRecord> kept = AssetCache{*folder}.find(record.key, bytes);
    if (kept && unmeasured(*kept, run.settings).empty()) {
      record.state = AssetState::kFromCache;
      record.report = kept->report;
      record.report["input"] = asset.source;
      record.report["output"] = record.name;
      for (size_t i = 0; i < bytes.levels.size(); ++i)
        record.report["levels"][i]["output"] = levelFile(record.name, i + 1).generic_string();
      record.figures = kept->figures;
    }
  }
  if (record.state == AssetState::kNotRun) {
    bytes = bake(asset, memory, run, record);
    record.state = AssetState::kBaked;
  }
  // A key that does not cover all that was read is not kept, so that the asset is baked in the next run again.
  if (const auto late = files.late(); !late.empty()) {
    inputs.files.insert(inputs.files.end(), late.begin(), late.end());
    record.key.clear();
  }
  record.bytes = bytes.glb.size();
  record.output_hash = hashBytes(bytes.glb);
  record.level_hashes.clear();
  for (const std::string& level : bytes.levels) record.level_hashes.push_back(hashBytes(level));
  if (folder && record.state == AssetState::kBaked && !record.key.empty()) addToCache({*folder}, record, bytes, run.listener);
  tellOfStaleLevels(run.settings.output.file, record.name, bytes.levels.size(), run.listener);
  writeOutput(run.settings.output.file, record, bytes);
}

// The memory of each job: what its plan says and as much again, because sizes of files say little about what is in them, but no more than
// its part of all memory if as many ran as can, unless its plan is larger.
uint64_t shareOf(uint64_t planned, uint64_t all, size_t at_once) {
  return std::max(planned, std::min(2 * planned + kSlack, all / at_once));
}

void judgeBounds(AssetRecord& record, const ErrorBounds& bounds) {
  if (!record.figures || record.state == AssetState::kFailed) return;
  const auto over = [&](const char* key, const std::optional<double>& most, const char* option, const char* cure) {
    if (!most || record.state == AssetState::kFailed) return;
    const FigureBound bound{&figureField(key), *most};
    if (const std::string what = overBound(*record.figures, {&bound, 1}); !what.empty())
      fail(record, ExitCode::kBound, fmt::format("{}: {} ({}): {}", record.name, what, option, cure));
  };
  if (bounds.angle_degrees && record.figures->is_fit && !bounds.transmittance_rms && !bounds.surface_rms)
    fail(record, ExitCode::kBound,
         record.name + ": the direction of a fitted lobe cannot be judged (--max-angle): use --max-transmittance-rms, or --lobe mean");
  over("direction_rms_degrees", bounds.angle_degrees, "--max-angle", "use more --rays or --voxels");
  over("transmittance_rms", bounds.transmittance_rms, "--max-transmittance-rms", "use --lobe fit, which comes closer");
  for (const char* key : kSurfaceRmsKeys) over(key, bounds.surface_rms, "--max-surface-rms", "use a finer mesh, or --lobe fit");
}

std::string lineOf(const AssetRecord& record) {
  return fmt::format("{}  {}  {:.2f} s{}", stateName(record.state), record.name, record.seconds,
                     record.reason.empty() ? "" : "  (" + record.reason + ")");
}

std::string failureLine(const AssetRecord& record) {
  return record.state == AssetState::kFailed ? "cloudbake: " + record.error + "\n" : "";
}

// The warnings of all assets that this batch has baked: a line per kind, because one cause often repeats in every seed or sculpt. The
// reports have those of each asset.
std::string warningsOf(const std::vector<AssetRecord>& records, const BatchOrders& orders) {
  struct Told {
    std::string input, first;
    size_t assets = 0;
    uint64_t count = 0;
  };
  std::map<std::string, Told> kinds;
  for (const AssetRecord& record : records) {
    const bool is_baked = record.state != AssetState::kFromCache && (!record.reason.empty() || orders.done.contains(record.name));
    if (!is_baked || !record.report.is_object()) continue;
    for (const Json& warning : record.report.value("warnings", Json::array())) {
      Told& told = kinds[warning.value("kind", "")];
      if (told.assets++ == 0) told.input = record.report.value("input", ""), told.first = warning.value("first", "");
      told.count += warning.value("count", uint64_t(1));
    }
  }
  std::string lines;
  for (const auto& [kind, told] : kinds) {
    const std::string times = told.count > 1 ? fmt::format(" ({} in all)", told.count) : "";
    lines += told.assets == 1 ? fmt::format("cloudbake: {}: warning: {}: {}{}\n", onOneLine(told.input), kind, onOneLine(told.first), times)
                              : fmt::format("cloudbake: warning: {}: {} assets, the first is {}: {}{}\n", kind, told.assets,
                                            onOneLine(told.input), onOneLine(told.first), times);
  }
  return lines;
}

}  // namespace

bool makeAsset(const PlannedAsset& asset, uint64_t memory, bool may_have_more, const AssetRun& run, AssetInputs& inputs,
               AssetRecord& record) {
  const Stopwatch watch;
  try {
    namingFile(asset.source,
               [&] { inStage("this asset", "use fewer --voxels, or a smaller input", [&] { make(asset, memory, run, inputs, record); }); });
  } catch (const MemoryError& error) {
    if (may_have_more) return false;
    fail(record, error.code, error.what());
  } catch (const Error& error) {
    fail(record, error.code, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    fail(record, ExitCode::kSystem, error.path1().string() + ": " + error.code().message());
  } catch (const std::exception& error) {
    fail(record, ExitCode::kInternal, asset.source + ": internal error: " + error.what());
  }
  record.seconds = watch.elapsed();
  return true;
}

std::vector<AssetRecord> judgeAssets(const std::vector<PlannedAsset>& assets, const std::vector<AssetInputs>& inputs,
                                     const Settings& settings) {
  std::vector<AssetRecord> records(assets.size());
  parallelFor(assets.size(), [&](size_t i) {
    AssetRecord& record = records[i];
    const std::optional<AssetRecord> known = readRecord(recordFile(settings.output.file, assets[i].name));
    std::string reason =
        inputs[i].key.empty() ? "input cannot be read" : staleness(settings.output.file, assets[i].name, inputs[i].key, known);
    if (reason.empty() && settings.run.force && !settings.batch.orders.done.contains(assets[i].name)) reason = "forced";
    if (reason.empty()) reason = unmeasured(*known, settings);
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

void runAssets(const std::vector<PlannedAsset>& assets, std::vector<AssetInputs>& inputs, const BatchPlan& plan, const Settings& settings,
               std::atomic<int>& stop, BatchListener& listener, std::vector<AssetRecord>& records) {
  const uint64_t limit = settings.source.memory_limit, memory = limit > kProgramMemory ? limit - kProgramMemory : 0;
  std::vector<size_t> stale;
  std::vector<Job> jobs;
  double total_cost = 0;
  for (size_t i = 0; i < assets.size(); ++i) {
    if (records[i].state == AssetState::kFresh) {
      judgeBounds(records[i], settings.judge.bounds);
      listener.tell(failureLine(records[i]));
      continue;
    }
    const BatchOrders& orders = settings.batch.orders;
    if (const auto crashed = orders.crashed.find(assets[i].name); crashed != orders.crashed.end()) {
      failByCrash(assets[i].source, crashed->second, records[i]);
      listener.tell(failureLine(records[i]));
      continue;
    }
    stale.push_back(i);
    jobs.push_back({assets[i].cost_seconds,
                    orders.alone.contains(assets[i].name) ? kAllMemory : shareOf(assets[i].memory, memory, assetsAtOnce(settings))});
    total_cost += assets[i].cost_seconds;
  }
  const AssetRun run{plan, settings, listener};
  listener.begin(stale.size(), total_cost);
  std::vector<std::atomic<bool>> postponed(jobs.size());
  const auto end = [&](size_t job, const std::string& crash) {
    const PlannedAsset& asset = assets[stale[job]];
    AssetRecord& record = records[stale[job]];
    if (!crash.empty()) failByFault(asset.source, crash, record);
    judgeBounds(record, settings.judge.bounds);
    int none = 0;
    if (record.state == AssetState::kFailed && settings.batch.fail_fast) stop.compare_exchange_strong(none, -1);
    listener.finish(asset.name, asset.cost_seconds, lineOf(record));
    listener.tell(failureLine(record));
  };
  const auto postpone = [&](size_t job) {
    postponed[job] = true;
    listener.postpone(assets[stale[job]].name);
  };
  const auto start = [&](size_t job) {
    listener.start(assets[stale[job]].name, kStages);
    return AssetSlot{assets[stale[job]], inputs[stale[job]], records[stale[job]]};
  };
  makeAssets(jobs, memory, stop, run, {start, postpone, end});

  // What needed more than its share may have all of it, one after the other.
  std::vector<size_t> again;
  for (size_t job = 0; job < jobs.size(); ++job)
    if (postponed[job]) again.push_back(job), jobs[job].memory = kAllMemory;
  for (const size_t job : again)
    makeAssets({&jobs[job], 1}, memory, stop, run,
               {[&](size_t) { return start(job); }, [](size_t) {}, [&](size_t, const std::string& crash) { end(job, crash); }});
  listener.tell(warningsOf(records, settings.batch.orders));
}

}  // namespace cloudbake
