// Which assets are made, how each ends, and that one that fails ends only itself.
#include "pipeline/batch/run.h"

#include <csignal>

#include "io/gltf/asset/decode.h"
#include "tests/pipeline/batch/batch_helpers.h"
#include "tests/wait.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

struct Ran {
  BatchPlan plan;
  std::vector<AssetRecord> records;
  int stop = 0;
};
// Bounds of angles are for mean lobes.
std::vector<Given> meanLobes() { return options({"rays=16", "voxels=16", "lobe=mean"}); }

// Plans, judges and runs; `change` may change the plan before.
template <class Change>
Ran run(const Settings& settings, Listener& listener, const Change& change, int stop_at_once = 0) {
  Ran ran;
  ran.plan = planBatch(settings, meanLobes());
  change(ran.plan);
  std::vector<AssetInputs> inputs = inputsOf(ran.plan.assets, ran.plan);
  ran.records = judgeAssets(ran.plan.assets, inputs, settings);
  std::atomic<int> stop{stop_at_once};
  runAssets(ran.plan.assets, inputs, ran.plan, settings, stop, listener, ran.records);
  ran.stop = stop;
  return ran;
}
Ran run(const Settings& settings, Listener& listener) {
  return run(settings, listener, [](BatchPlan&) {});
}
Ran run(const Settings& settings) {
  Listener listener;
  return run(settings, listener);
}

// "baked new", one for each asset.
Names statesOf(const std::vector<AssetRecord>& records) {
  Names states;
  for (const AssetRecord& record : records)
    states.push_back(std::string(stateName(record.state)) + (record.reason.empty() ? "" : " " + record.reason));
  return states;
}

// --- Judging ---

TEST(Run, JudgesByWhatIsKnown) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("b.obj");
  Settings settings = folder.settings();
  const auto judge = [&] {
    const BatchPlan plan = planBatch(settings, meanLobes());
    return judgeAssets(plan.assets, inputsOf(plan.assets, plan), settings);
  };
  EXPECT_EQ(statesOf(judge()), (Names{"not-run new", "not-run new"}));
  run(settings);
  const auto records = judge();
  EXPECT_EQ(statesOf(records), (Names{"fresh", "fresh"}));
  EXPECT_EQ(records[1].name, "b.glb");
  EXPECT_EQ(records[1].source, (folder.in / "b.obj").string());
  EXPECT_EQ(records[1].seconds, 0) << "no time in this run";
  EXPECT_EQ(records[1].bytes, fs::file_size(folder.out / "b.glb"));
  EXPECT_EQ(records[1].report["output"], "b.glb");
  folder.box("b.obj", 2);
  EXPECT_EQ(statesOf(judge()), (Names{"fresh", "not-run input changed"}));
  folder.box("b.obj");
  settings.run.force = true;
  EXPECT_EQ(statesOf(judge()), (Names{"not-run forced", "not-run forced"}));
  settings.batch.orders.done = {"a.glb"};
  EXPECT_EQ(statesOf(judge()), (Names{"fresh", "not-run forced"})) << "it was done before the program crashed";
  settings.run.force = false;
  settings.judge.bounds.angle_degrees = 90;
  EXPECT_EQ(statesOf(judge()), (Names{"not-run error not measured yet", "not-run error not measured yet"}));
}

TEST(Run, AFailureOfBeforeIsForgotten) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.judge.bounds.angle_degrees = 1e-6;
  const Ran failed = run(settings);
  ASSERT_EQ(statesOf(failed.records), Names{"failed new"});
  const auto records = judgeAssets(failed.plan.assets, inputsOf(failed.plan.assets, failed.plan), settings);
  EXPECT_EQ(statesOf(records), Names{"fresh"});
  EXPECT_EQ(records[0].code, 0);
  EXPECT_EQ(records[0].error, "");
  // It is measured already, so that a later run judges it without a bake.
  EXPECT_EQ(run(settings).records[0].code, int(ExitCode::kBound));
  settings.judge.bounds.angle_degrees = 90;
  EXPECT_EQ(statesOf(run(settings).records), Names{"fresh"});
}

TEST(Run, InputsThatCannotBeRead) {
  const BatchFolder folder;
  folder.box("a.obj");
  Listener listener;
  const Ran ran = run(folder.settings(), listener, [&](BatchPlan&) { fs::remove(folder.in / "a.obj"); });
  EXPECT_EQ(statesOf(ran.records), Names{"failed input cannot be read"});
  EXPECT_EQ(ran.records[0].code, int(ExitCode::kSystem));
  EXPECT_TRUE(contains(ran.records[0].error, "a.obj")) << ran.records[0].error;
  EXPECT_FALSE(fs::exists(folder.out / "a.glb"));
}

// --- Baking ---

TEST(Run, BakesAndRecords) {
  const BatchFolder folder;
  folder.box("d/a.obj");
  Listener listener;
  const Ran ran = run(folder.settings(), listener);
  const std::string glb = readFileBytes(folder.out / "d/a.glb");
  const AssetRecord& record = ran.records.at(0);
  EXPECT_EQ(statesOf(ran.records), Names{"baked new"});
  EXPECT_EQ(record.output_hash, hashBytes(glb));
  EXPECT_EQ(record.bytes, glb.size());
  EXPECT_EQ(record.report["command"], "bake");
  EXPECT_EQ(record.report["output"], "d/a.glb");
  EXPECT_GT(record.seconds, 0);
  EXPECT_FALSE(record.figures) << "nothing asks for them";
  Warnings warnings;
  EXPECT_EQ(decodeGlb("a.glb", glb, warnings).info.rays, 16);
  EXPECT_EQ(listener.assets, 1U);
  EXPECT_EQ(listener.cost_seconds, ran.plan.assets[0].cost_seconds);
  EXPECT_EQ(listener.events, (Names{"start d/a.glb", "finish d/a.glb"}));
  EXPECT_TRUE(contains(listener.lines, "baked  d/a.glb  ") && contains(listener.lines, "  (new)")) << listener.lines;
  const auto kept = readRecord(recordFile(folder.out, "d/a.glb"));
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->key, record.key);
}

TEST(Run, BakesOnlyWhatIsStale) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("b.obj");
  run(folder.settings());
  folder.box("a.obj", 2);
  Listener listener;
  EXPECT_EQ(statesOf(run(folder.settings(), listener).records), (Names{"baked input changed", "fresh"}));
  EXPECT_EQ(listener.events, (Names{"start a.glb", "finish a.glb"}));
  Listener idle;
  run(folder.settings(), idle);
  EXPECT_EQ(idle.assets, 0U);
  EXPECT_EQ(idle.cost_seconds, 0);
}

TEST(Run, GrowsACloudWithItsOptions) {
  const BatchFolder folder;
  folder.write("in/b.csv", "0,0,0,1\n");
  const Settings settings = folder.manifest("[[cloud]]\nfrom_spheres = 'b.csv'\nseed = 5\n");
  const Ran ran = run(settings);
  ASSERT_EQ(statesOf(ran.records), Names{"baked new"}) << ran.records[0].error;
  EXPECT_EQ(ran.records[0].report["command"], "grow");
  Warnings warnings;
  EXPECT_EQ(decodeGlb("b.glb", readFileBytes(folder.out / "b.glb"), warnings).info.seed, 5U);
}

TEST(Run, WarningsOfAnAssetAreTold) {
  const BatchFolder folder;
  SurfaceMesh open = boxMesh({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  folder.write("in/open.obj", objText(open));
  Listener listener;
  run(folder.settings(), listener);
  EXPECT_TRUE(contains(listener.told, "open.obj: warning: open-edges: ")) << listener.told;
}

// A warning that several assets have is one line with a count.
TEST(Run, AWarningOfSeveralAssetsIsToldOnce) {
  const BatchFolder folder;
  SurfaceMesh open = boxMesh({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  for (const char* name : {"in/a.obj", "in/b.obj", "in/c.obj"}) folder.write(name, objText(open));
  folder.box("d.obj");
  Listener listener;
  run(folder.settings(), listener);
  EXPECT_TRUE(contains(listener.told, "cloudbake: warning: open-edges: 3 assets, the first is ")) << listener.told;
  EXPECT_TRUE(contains(listener.told, "cloudbake: warning: units-assumed: 4 assets, the first is ")) << listener.told;
  EXPECT_EQ(std::count(listener.told.begin(), listener.told.end(), '\n'), 2) << listener.told;
}

// A level that an earlier bake has left is told of, unless it is known to be ours: then it is removed.
TEST(Run, LevelsOfAnEarlierBakeAreToldOf) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.manifest("[[cloud]]\nsculpt = 'a.obj'\nlods = '7,6'\n");
  run(settings);
  const fs::path first = folder.out / "a_lod1.glb", second = folder.out / "a_lod2.glb";
  ASSERT_TRUE(fs::exists(second));
  fs::copy_file(second, folder.out / "a_lod3.glb");
  folder.write("out/a_lod4.glb", "by an artist");
  settings = folder.manifest("[[cloud]]\nsculpt = 'a.obj'\n");
  Listener listener;
  run(settings, listener);
  EXPECT_FALSE(fs::exists(first) || fs::exists(second)) << "the record says that they are ours";
  EXPECT_TRUE(contains(listener.told, "cloudbake: warning: " + (folder.out / "a_lod3.glb").string() +
                                          ": this level of detail is of an earlier bake: remove it\n"));
  for (const char* silent : {"a_lod1", "a_lod2", "a_lod4"}) EXPECT_FALSE(contains(listener.told, silent)) << listener.told;
}

// --- Failures ---

TEST(Run, AFailureEndsOnlyItself) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.write("in/bad.obj", "f 1 2 3\n");
  folder.box("c.obj");
  Listener listener;
  const Ran ran = run(folder.settings(), listener);
  EXPECT_EQ(statesOf(ran.records), (Names{"baked new", "failed new", "baked new"}));
  EXPECT_EQ(ran.records[1].code, int(ExitCode::kInput));
  EXPECT_TRUE(contains(listener.told, "cloudbake: " + ran.records[1].error + "\n")) << listener.told;
  EXPECT_FALSE(fs::exists(folder.out / "bad.glb"));
  EXPECT_EQ(ran.stop, 0);
}

TEST(Run, AnOutputThatCannotBeWrittenIsAFailureOfTheSystem) {
  const BatchFolder folder;
  folder.box("a.obj");
  fs::create_directories(folder.out / "a.glb/x");
  EXPECT_EQ(run(folder.settings()).records[0].code, int(ExitCode::kSystem));
}

// The most expensive goes first, and on one thread nothing is under way beside it.
TEST(Run, FailFastStartsNothingNew) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.write("in/bad.obj", "f 1 2 3\n");
  folder.box("c.obj");
  Settings settings = folder.settings();
  const auto go = [&] {
    Ran ran;
    withThreads(1, [&] {
      Listener listener;
      ran = run(settings, listener, [](BatchPlan& plan) { plan.assets[1].cost_seconds = 1000; });
    });
    return ran;
  };
  settings.batch.fail_fast = true;
  const Ran fast = go();
  EXPECT_EQ(statesOf(fast.records), (Names{"not-run new", "failed new", "not-run new"}));
  EXPECT_EQ(fast.stop, -1);
  settings.batch.fail_fast = false;
  EXPECT_EQ(statesOf(go().records), (Names{"baked new", "failed new", "baked new"}));
}

TEST(Run, NothingStartsAfterASignal) {
  const BatchFolder folder;
  folder.box("a.obj");
  Listener listener;
  const Ran ran = run(
      folder.settings(), listener, [](BatchPlan&) {}, 15);
  EXPECT_EQ(statesOf(ran.records), Names{"not-run new"});
  EXPECT_EQ(ran.stop, 15);
  EXPECT_EQ(listener.events, Names{});
}

// --- Bounds ---

TEST(Run, AnAssetBeyondABoundFailsAndIsKept) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.judge.truth_vertices = 5;
  settings.judge.bounds = {1e-6, std::nullopt};
  AssetRecord record = run(settings).records[0];
  EXPECT_EQ(record.code, int(ExitCode::kBound));
  EXPECT_EQ(record.error.find("a.glb: "), 0U) << record.error;
  EXPECT_TRUE(contains(record.error, "(--max-angle)")) << record.error;
  EXPECT_TRUE(fs::exists(folder.out / "a.glb"));
  ASSERT_TRUE(record.figures);
  EXPECT_EQ(record.figures->vertices, 5U);
  settings.judge.bounds = {std::nullopt, 1e-9};
  record = run(settings).records[0];
  EXPECT_EQ(record.code, int(ExitCode::kBound));
  EXPECT_TRUE(contains(record.error, "(--max-transmittance-rms)")) << record.error;
  settings.judge.bounds = {std::nullopt, std::nullopt, 1e-9};
  record = run(settings).records[0];
  EXPECT_EQ(record.code, int(ExitCode::kBound));
  EXPECT_TRUE(contains(record.error, "transmittance per vertex is off by") && contains(record.error, "(--max-surface-rms)"))
      << record.error;
  settings.judge.bounds = {180, 1};
  record = run(settings).records[0];
  EXPECT_EQ(record.state, AssetState::kFresh) << record.error;
}

// What was made while nothing asked for its error has no figures. A later bound holds for it all the same, wherever it comes from.
TEST(Run, ABoundHoldsForWhatWasMadeWithoutOne) {
  using Bounds = ErrorBounds;
  for (const auto& [bounds, option] :
       {std::pair(Bounds{0.001, std::nullopt}, "(--max-angle)"), std::pair(Bounds{std::nullopt, 1e-6}, "(--max-transmittance-rms)")}) {
    const BatchFolder folder;
    folder.box("a.obj");
    folder.box("b.obj", 2);
    Settings settings = folder.settings();
    settings.batch.cache = folder.path / "cache";
    settings.judge.truth_vertices = 5;
    ASSERT_EQ(statesOf(run(settings).records), (Names{"baked new", "baked new"}));
    const auto expectFailed = [&, option = option](const char* what) {
      Listener listener;
      for (const AssetRecord& record : run(settings, listener).records) {
        EXPECT_EQ(record.state, AssetState::kFailed) << what << ": " << record.name << " is " << stateName(record.state);
        EXPECT_EQ(record.code, int(ExitCode::kBound)) << what;
        EXPECT_EQ(record.error.find(record.name + ": "), 0U) << what << ": " << record.error;
        EXPECT_TRUE(contains(record.error, option)) << what << ": " << record.error;
        EXPECT_TRUE(contains(listener.told, "cloudbake: " + record.error + "\n")) << what << ": " << listener.told;
      }
    };
    settings.judge.bounds = bounds;
    expectFailed("fresh");
    settings.output.file = folder.path / "other";
    expectFailed("in the cache");
    settings.batch.cache.reset();
    settings.judge.bounds = {180, 1};
    EXPECT_EQ(statesOf(run(settings).records), (Names{"fresh", "fresh"})) << "they are measured now";
  }
}

// Figures of a few vertices do not answer for more of them; a mesh has no more than all of its own.
TEST(Run, FiguresOfFewerVerticesAreMeasuredAgain) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.batch.cache = folder.path / "cache";
  settings.judge.bounds = {180, 1};
  const auto runWith = [&](std::optional<size_t> vertices) {
    settings.judge.truth_vertices = vertices;
    const std::vector<AssetRecord> records = run(settings).records;
    return std::pair(statesOf(records).at(0), records.at(0).figures->vertices);
  };
  EXPECT_EQ(runWith(3), std::pair(std::string("baked new"), uint64_t(3)));
  EXPECT_EQ(runWith(5), std::pair(std::string("baked error measured at fewer vertices"), uint64_t(5)));
  EXPECT_EQ(runWith(4), std::pair(std::string("fresh"), uint64_t(5)));
  const auto [state, all] = runWith(std::nullopt);
  EXPECT_EQ(state, "baked error measured at fewer vertices");
  EXPECT_GT(all, 5U);
  EXPECT_EQ(runWith(100000), std::pair(std::string("fresh"), all));
}

// --- After a crash ---

TEST(Run, WhatCrashedIsNotTriedAgain) {
  const BatchFolder folder;
  const std::string a = folder.box("a.obj").string();
  folder.box("b.obj");
  Settings settings = folder.settings();
  settings.batch.orders.crashed["a.glb"] = SIGSEGV;
  Listener listener;
  const Ran ran = run(settings, listener);
  EXPECT_EQ(statesOf(ran.records), (Names{"failed new", "baked new"}));
  EXPECT_EQ(ran.records[0].code, int(ExitCode::kInternal));
  EXPECT_EQ(ran.records[0].error.find(a + ": it crashed the program (Segmentation fault); please report it"), 0U) << ran.records[0].error;
  EXPECT_EQ(listener.events, (Names{"start b.glb", "finish b.glb"}));
  EXPECT_TRUE(contains(listener.told, "cloudbake: " + ran.records[0].error + "\n")) << listener.told;
}

// The system may have had no memory left, or someone had no patience: nobody knows, and it is no bug of the program.
TEST(Run, WhatWasKilledIsNoCrash) {
  const BatchFolder folder;
  const std::string a = folder.box("a.obj").string();
  Settings settings = folder.settings();
  settings.batch.orders.crashed["a.glb"] = SIGKILL;
  Listener listener;
  const Ran ran = run(settings, listener);
  EXPECT_EQ(ran.records[0].code, int(ExitCode::kSystem));
  EXPECT_EQ(ran.records[0].error.find(a + ": the program was killed while this was baked (Killed); run the batch again"), 0U)
      << ran.records[0].error;
}

// Assets that begin wait for `together` of them, and then let others begin.
struct SlowListener : Listener {
  explicit SlowListener(size_t together) : meeting(together) {}
  void start(const std::string& name, int stages) override {
    Listener::start(name, stages);
    EXPECT_TRUE(meeting.come()) << name << " stays alone";
    spin(20'000'000);
  }
  Meeting meeting;
};

TEST(Run, SomeRunAlone) {
  const BatchFolder folder;
  for (const char* name : {"a.obj", "b.obj", "c.obj", "d.obj"}) folder.box(name);
  const auto eventsOf = [&](const Settings& settings, size_t together) {
    SlowListener listener(together);
    withThreads(4, [&] { run(settings, listener); });
    return listener.events;
  };
  const auto isAlone = [](const Names& events, const std::string& name) {
    const auto start = std::find(events.begin(), events.end(), "start " + name);
    return start != events.end() && start + 1 != events.end() && start[1] == "finish " + name;
  };
  Settings settings = folder.settings();
  settings.run.force = true;
  settings.batch.orders.alone = {"a.glb", "c.glb"};
  const Names events = eventsOf(settings, 1);
  EXPECT_EQ(events.size(), 8U);
  EXPECT_TRUE(isAlone(events, "a.glb") && isAlone(events, "c.glb"));
  settings.batch.orders.alone = {};
  settings.source.memory_limit = 70'000'000;  // more than the program and one of them, less than two
  const Names scarce = eventsOf(settings, 1);
  for (const char* name : {"a.glb", "b.glb", "c.glb", "d.glb"}) EXPECT_TRUE(isAlone(scarce, name)) << name;
  settings.source.memory_limit = uint64_t(1) << 40;
  const Names plenty = eventsOf(settings, 2);
  EXPECT_FALSE(isAlone(plenty, "a.glb") && isAlone(plenty, "b.glb") && isAlone(plenty, "c.glb") && isAlone(plenty, "d.glb"));
}

// What a plan says too little about stops and has all memory to itself, after the others.
TEST(Run, WhatNeedsMoreThanItsShareRunsAgainAlone) {
  const BatchFolder folder;
  for (const char* name : {"a.obj", "b.obj", "c.obj", "d.obj"}) folder.box(name);
  Settings settings = folder.settings();
  settings.source.memory_limit = 50'000'000 + 400'000;  // more than one of them needs, and less than four
  Listener listener;
  Ran ran;
  withThreads(4, [&] {
    ran = run(settings, listener, [](BatchPlan& plan) {
      for (PlannedAsset& asset : plan.assets) asset.memory = 1;
    });
  });
  EXPECT_EQ(statesOf(ran.records), Names(4, "baked new")) << ran.records[0].error;
  ASSERT_EQ(listener.events.size(), 16U);
  EXPECT_EQ(std::count(listener.events.begin(), listener.events.begin() + 8, "postpone a.glb"), 1);
  for (size_t i = 8; i < 16; i += 2) EXPECT_EQ("finish" + listener.events[i].substr(5), listener.events[i + 1]) << "alone";
  EXPECT_EQ(std::count(listener.told.begin(), listener.told.end(), '\n'), 1) << listener.told;
  EXPECT_TRUE(contains(listener.told, "units-assumed: 4 assets, ") && contains(listener.told, "(4 in all)"))
      << "units-assumed of each, once: nobody is told of the first try: " << listener.told;
  EXPECT_FALSE(contains(listener.told, "memory")) << listener.told;
}

TEST(Run, WhatNeedsMoreThanAllMemoryIsRefusedByName) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.source.memory_limit = 50'000'000 + 20'000;
  const Ran ran = run(settings);
  ASSERT_EQ(statesOf(ran.records), Names{"failed new"});
  EXPECT_EQ(ran.records[0].code, int(ExitCode::kInput));
  EXPECT_TRUE(contains(ran.records[0].error, "a.obj: a field of 16 voxels along the longest side would take about "))
      << ran.records[0].error;
  EXPECT_TRUE(contains(ran.records[0].error, " of memory, over the limit of 20 kB (--memory): use fewer --voxels")) << ran.records[0].error;
}

// --- The cache ---

TEST(Run, AnotherFolderTakesItFromTheCache) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.batch.cache = folder.path / "cache";
  run(settings);
  const std::string baked = readFileBytes(folder.out / "a.glb");
  settings.output.file = folder.path / "other";
  fs::create_directory(folder.path / "moved");
  fs::rename(folder.in / "a.obj", folder.path / "moved/a.obj");
  settings.batch.inputs = {folder.path / "moved"};
  settings.batch.name = "x/{stem}.glb";
  const Ran ran = run(settings);
  EXPECT_EQ(statesOf(ran.records), Names{"from-cache new"});
  EXPECT_EQ(readFileBytes(folder.path / "other/x/a.glb"), baked);
  EXPECT_EQ(ran.records[0].output_hash, hashBytes(baked));
  EXPECT_EQ(ran.records[0].bytes, baked.size());
  EXPECT_EQ(ran.records[0].report["input"], (folder.path / "moved/a.obj").string());
  EXPECT_EQ(ran.records[0].report["output"], "x/a.glb");
  EXPECT_EQ(statesOf(run(settings).records), Names{"fresh"});
  settings.run.force = true;
  EXPECT_EQ(statesOf(run(settings).records), Names{"baked forced"}) << "--force bakes";
}

TEST(Run, TheCacheIsOfNoUseWithoutItsFigures) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.batch.cache = folder.path / "cache";
  run(settings);
  settings.judge.bounds.angle_degrees = 180;
  settings.output.file = folder.path / "2";
  EXPECT_EQ(statesOf(run(settings).records), Names{"baked new"});
  settings.output.file = folder.path / "3";
  const Ran third = run(settings);
  EXPECT_EQ(statesOf(third.records), Names{"from-cache new"});
  EXPECT_TRUE(third.records[0].figures);
}

TEST(Run, ABrokenCacheEndsNothing) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.batch.cache = folder.write("cache", "a file");
  Listener listener;
  EXPECT_EQ(statesOf(run(settings, listener).records), Names{"baked new"});
  EXPECT_TRUE(contains(listener.told, "warning: not kept in the cache: ")) << listener.told;
}

// --- Levels of detail ---

// Levels that are missing come from the cache, with the bytes that the bake wrote, and the report names the files of the asset.
TEST(RunLevels, AreBakedWithTheAssetAndCached) {
  const BatchFolder folder;
  folder.write("in/a.obj", objText(ballMesh(1, 3)));
  Settings settings = folder.manifest("[[cloud]]\nsculpt = 'a.obj'\nname = 'd/{stem}.glb'\nlods = '50%,30%'\n");
  settings.batch.cache = folder.path / "cache";
  const Ran first = run(settings);
  EXPECT_EQ(statesOf(first.records), Names{"baked new"});
  ASSERT_EQ(first.records[0].level_hashes.size(), 2U);
  const std::string level = readFileBytes(folder.out / "d/a_lod2.glb");
  EXPECT_EQ(hashBytes(level), first.records[0].level_hashes[1]);
  EXPECT_EQ(first.records[0].report["levels"][1]["output"], "d/a_lod2.glb");
  EXPECT_EQ(statesOf(run(settings).records), Names{"fresh"});
  fs::remove(folder.out / "d/a_lod2.glb");
  const Ran again = run(settings);
  EXPECT_EQ(statesOf(again.records), Names{"from-cache output is not what was written"});
  EXPECT_EQ(readFileBytes(folder.out / "d/a_lod2.glb"), level);
  EXPECT_EQ(again.records[0].report["levels"], first.records[0].report["levels"]);
}

}  // namespace
}  // namespace cloudbake
