// Whole batches: what is written beside the assets, and reports of shards as one.
#include "pipeline/batch/batch.h"

#include <fmt/format.h>

#include <cstdlib>

#include "core/sequence.h"
#include "io/gltf/sequence/sequence_file.h"
#include "pipeline/batch/thumbnail.h"
#include "tests/pipeline/batch/batch_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

BatchReport bakeAll(const Settings& settings, int stop_at_once = 0) {
  Listener listener;
  std::atomic<int> stop{stop_at_once};
  return bakeBatch(settings, fewRays(), stop, listener);
}
std::vector<AssetState> assetStates(const BatchReport& report) {
  std::vector<AssetState> states;
  for (const AssetRecord& asset : report.assets) states.push_back(asset.state);
  return states;
}

TEST(Batch, WritesTheReportsThatAreAskedFor) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("b.obj");
  Settings settings = folder.settings();
  EXPECT_EQ(assetStates(bakeAll(settings)), (std::vector{AssetState::kBaked, AssetState::kBaked}));
  EXPECT_TRUE(fs::exists(folder.out / ".cloudbake/last_report.json"));
  EXPECT_FALSE(fs::exists(thumbnailFile(folder.out, "a.glb"))) << "only a page has pictures";
  settings.run.json = folder.path / "r.json";
  settings.batch.junit = folder.path / "r.xml";
  settings.batch.html = folder.path / "r.html";
  settings.batch.depfile = folder.path / "r.d";
  folder.box("b.obj", 2);
  const BatchReport report = bakeAll(settings);
  EXPECT_EQ(assetStates(report), (std::vector{AssetState::kFresh, AssetState::kBaked}));
  EXPECT_EQ(report.source, folder.in.string());
  EXPECT_EQ(report.output, folder.out.string());
  EXPECT_FALSE(report.interrupted);
  EXPECT_GT(report.seconds, 0);
  EXPECT_GT(report.peak_memory, 1'000'000U);
  const std::string json = readFileBytes(folder.path / "r.json");
  EXPECT_EQ(json, batchJson(report));
  EXPECT_EQ(json, readFileBytes(folder.out / ".cloudbake/last_report.json"));
  EXPECT_EQ(readFileBytes(folder.path / "r.xml"), batchJunit(report));
  EXPECT_TRUE(contains(readFileBytes(folder.path / "r.html"), "b.glb"));
  EXPECT_TRUE(fs::exists(thumbnailFile(folder.out, "a.glb")) && fs::exists(thumbnailFile(folder.out, "b.glb")));
  EXPECT_EQ(readFileBytes(folder.path / "r.d"), depfileText(folder.out, {folder.in, folder.in / "a.obj", folder.in / "b.obj"}));
  settings.batch.depfile_target = "all";
  bakeAll(settings);
  EXPECT_EQ(readFileBytes(folder.path / "r.d").find("all:"), 0U);
}

TEST(Batch, ASequenceIsOneAsset) {
  const BatchFolder folder;
  fs::create_directories(folder.in / "f");
  for (int i = 1; i <= 3; ++i) folder.write(fmt::format("in/f/ball.{:04}.obj", i), objText(ballMesh(1 + 0.02F * float(i), 3)));
  const Settings settings = folder.manifest(
      "[defaults]\nrays = 16\nvoxels = 30\nvertices = 300\n"
      "[[cloud]]\nsequence = 'f/ball.####.obj'\nfps = 12\nas = 'picture'\n"
      "[[cloud]]\nsequence = 'fairweather'\nframe_count = 2\nvary = ['life=0.2:0.21', 'size=1:1.02']\nseeds = [3]\n");
  setenv("XDG_CACHE_HOME", (folder.path / "cache").c_str(), 1);
  const BatchReport first = bakeAll(settings);
  ASSERT_EQ(assetStates(first), (std::vector{AssetState::kBaked, AssetState::kBaked})) << first.assets[0].error << first.assets[1].error;
  const fs::path file = folder.out / "ball.glb";
  const CloudSequence sequence = decodeSequence(file, readFileBytes(file));
  EXPECT_EQ(sequence.frames_per_second, 12);
  EXPECT_EQ(sequence.period, 2);
  EXPECT_TRUE(isSequence(readFileBytes(folder.out / "fairweather_3.glb")));
  EXPECT_EQ(drawThumbnail(file, kMemoryLimit).width, kThumbnailWidth);
  EXPECT_EQ(assetStates(bakeAll(settings)), (std::vector{AssetState::kFresh, AssetState::kFresh}));
  folder.write("in/f/ball.0003.obj", objText(ballMesh(1.2F, 3)));
  EXPECT_EQ(assetStates(bakeAll(settings)), (std::vector{AssetState::kBaked, AssetState::kFresh})) << "one frame has changed";
  unsetenv("XDG_CACHE_HOME");
}

// A build tool would run for ever for a file that does not exist. The folder where it would appear tells of it.
TEST(Batch, TheDepfileListsWhatExists) {
  const BatchFolder folder;
  fs::create_directories(folder.in / "t");
  folder.write("in/a.obj", "mtllib m.mtl\nmtllib gone.mtl\nusemtl a\n" + objText(boxMesh({0, 0, 0}, {1, 1, 1})));
  folder.write("in/m.mtl", "newmtl a\nmap_Kd t/skin.png\nnewmtl b\nmap_Kd t/gone.png\nmap_Ke no/folder/gone.png\n");
  folder.write("in/t/skin.png", "p");
  Settings settings = folder.settings();
  settings.batch.depfile = folder.path / "r.d";
  const std::vector<fs::path> expected{folder.in, folder.in / "a.obj", folder.in / "m.mtl", folder.in / "t", folder.in / "t/skin.png"};
  for (const char* run : {"first", "fresh"}) {
    bakeAll(settings);
    EXPECT_EQ(readFileBytes(folder.path / "r.d"), depfileText(folder.out, expected)) << run;
  }
}

// The asset is made of a file that was saved after the batch had begun, and of the files that this one names.
TEST(Batch, TheDepfileListsWhatWasRead) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.write("in/new.mtl", "newmtl a\n");
  Settings settings = folder.settings();
  settings.batch.depfile = folder.path / "r.d";
  std::atomic<int> reads{0};
  settings.source.read.read_file = [&](const fs::path& file) {
    std::string bytes = readFileBytes(file);
    if (++reads == 1) folder.write("in/a.obj", "mtllib new.mtl\nusemtl a\n" + bytes);
    return bytes;
  };
  bakeAll(settings);
  EXPECT_EQ(readFileBytes(folder.path / "r.d"), depfileText(folder.out, {folder.in, folder.in / "a.obj", folder.in / "new.mtl"}));
}

TEST(Batch, ThePageTellsWhatChangedSinceTheLastRun) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.batch.html = folder.path / "r.html";
  const auto page = [&] {
    bakeAll(settings);
    return readFileBytes(*settings.batch.html);
  };
  EXPECT_TRUE(contains(page(), "this is the first run"));
  EXPECT_FALSE(contains(page(), "this is the first run"));
  folder.write("out/.cloudbake/last_report.json", "{");
  EXPECT_TRUE(contains(page(), "the last report cannot be read"));
}

TEST(Batch, ThePageReportsRemovedOutputs) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("b.obj");
  Settings settings = folder.settings();
  settings.batch.html = folder.path / "r.html";
  bakeAll(settings);
  fs::remove(folder.in / "b.obj");
  bakeAll(settings);
  const std::string kept = readFileBytes(*settings.batch.html);
  EXPECT_TRUE(contains(kept, "gone: b.glb") && !contains(kept, "removed")) << "its output is still there";
  settings.batch.prune = true;
  bakeAll(settings);
  const std::string pruned = readFileBytes(*settings.batch.html);
  EXPECT_TRUE(contains(pruned, "<li>removed: b.glb</li>")) << "the last report had no b.glb";
}

// The picture that is there is used; one that is missing is made.
TEST(Batch, PicturesAreKept) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = folder.settings();
  settings.batch.html = folder.path / "r.html";
  bakeAll(settings);
  EXPECT_LT(readFileBytes(thumbnailFile(folder.out, "a.glb")).size(), 3500U) << "500 of them are in a page of 2 MB";
  folder.write("out/.cloudbake/a.glb.jpg", "kept");
  bakeAll(settings);
  EXPECT_EQ(readFileBytes(thumbnailFile(folder.out, "a.glb")), "kept");
  EXPECT_TRUE(contains(readFileBytes(*settings.batch.html), "a2VwdA==")) << "\"kept\" in base64";
}

// --- Live views ---

// A batch of the folder with live views, reported to r.html beside `out`.
Settings withLiveViews(const BatchFolder& folder) {
  Settings settings = folder.settings();
  settings.batch.html = folder.path / "r.html";
  settings.batch.live = true;
  return settings;
}
std::string bytesIn(const BatchFolder& folder, const std::string& name) { return readFileBytes(folder.path / name); }
bool links(const BatchFolder& folder, const std::string& url, const std::string& report = "r.html") {
  return contains(bytesIn(folder, report), "href=\"" + url + "\"");
}

TEST(Batch, LiveViewsLieBesideTheirAssets) {
  const BatchFolder folder;
  for (const char* name : {"a b.obj", "sub/c.obj"}) folder.box(name);
  Settings settings = withLiveViews(folder);
  settings.batch.live = false;
  bakeAll(settings);
  EXPECT_FALSE(fs::exists(folder.out / "a b.html") || contains(bytesIn(folder, "r.html"), "href=")) << "only where they are asked for";
  settings.batch.live = true;
  EXPECT_EQ(assetStates(bakeAll(settings)), (std::vector{AssetState::kFresh, AssetState::kFresh}));
  EXPECT_EQ(bytesIn(folder, "out/a b.html"), liveViewOf(folder.out / "a b.glb"));
  EXPECT_EQ(bytesIn(folder, "out/sub/c.html"), liveViewOf(folder.out / "sub/c.glb"));
  EXPECT_TRUE(links(folder, "out/a%20b.html") && links(folder, "out/sub/c.html"));
  settings.batch.html = folder.out / "." / "sub" / "r.html";
  bakeAll(settings);
  EXPECT_TRUE(links(folder, "../a%20b.html", "out/sub/r.html") && links(folder, "c.html", "out/sub/r.html"));
}

TEST(Batch, LiveViewsAreThoseOfTheirAssets) {
  const BatchFolder folder;
  folder.box("a.obj");
  const Settings settings = withLiveViews(folder);
  Settings without = settings;
  without.batch.live = false;
  bakeAll(settings);
  const fs::path page = folder.out / "a.html";
  const std::string first = readFileBytes(page);
  const auto long_ago = fs::last_write_time(page) - std::chrono::hours(1000);
  fs::last_write_time(page, long_ago);
  bakeAll(settings);
  EXPECT_EQ(fs::last_write_time(page), long_ago) << "what is there is kept";
  EXPECT_TRUE(links(folder, "out/a.html"));
  for (const bool is_there : {false, true}) {  // one that is missing, one that is damaged
    fs::remove(page);
    if (is_there) folder.write("out/a.html", first.substr(1));
    EXPECT_EQ(assetStates(bakeAll(settings)), std::vector{AssetState::kFresh}) << "no new bake";
    EXPECT_EQ(readFileBytes(page), first);
  }
  folder.box("a.obj", 2);
  bakeAll(without);
  EXPECT_EQ(readFileBytes(page), first) << "nobody asked for a new one";
  EXPECT_FALSE(links(folder, "out/a.html"));
  bakeAll(settings);
  EXPECT_NE(readFileBytes(page), first);
  EXPECT_EQ(readFileBytes(page), liveViewOf(folder.out / "a.glb"));
}

// The batch goes on without it, and says why. What failed keeps its page, but the report does not show it.
TEST(Batch, AssetsWithoutALiveView) {
  const BatchFolder folder;
  for (const char* name : {"a.obj", "b.obj", "c.obj"}) folder.box(name);
  const Settings settings = withLiveViews(folder);
  bakeAll(settings);
  fs::remove(folder.out / "a.html");
  fs::create_directory(folder.out / "a.html");
  folder.write("in/b.obj", "nonsense");
  Listener listener;
  std::atomic<int> stop{0};
  const BatchReport report = bakeBatch(settings, fewRays(), stop, listener);
  EXPECT_EQ(assetStates(report), (std::vector{AssetState::kFresh, AssetState::kFailed, AssetState::kFresh}));
  EXPECT_TRUE(contains(listener.told, "cloudbake: warning: no live view of a.glb: ")) << listener.told;
  EXPECT_EQ(listener.assets, 1U) << "only a.glb lacked one";
  EXPECT_TRUE(fs::exists(folder.out / "b.html"));
  EXPECT_FALSE(links(folder, "out/a.html") || links(folder, "out/b.html"));
  EXPECT_TRUE(links(folder, "out/c.html"));
}

TEST(Batch, NoLiveViewOfWhatCrashedOrDidNotRun) {
  const BatchFolder folder;
  for (const char* name : {"a.obj", "b.obj"}) folder.box(name);
  Settings settings = withLiveViews(folder);
  bakeAll(folder.settings());
  settings.batch.orders.crashed["a.glb"] = SIGABRT;
  bakeAll(settings);
  EXPECT_FALSE(fs::exists(folder.out / "a.html") || links(folder, "out/a.html"));
  EXPECT_TRUE(links(folder, "out/b.html"));
  folder.box("b.obj", 2);
  bakeAll(settings, 2);
  EXPECT_FALSE(links(folder, "out/b.html")) << "it shows the asset of before";
}

TEST(Batch, LiveViewsAreTheSameForAnyNumberOfThreads) {
  std::map<std::string, std::string> first;
  for (const int threads : {1, 4}) {
    const BatchFolder folder;
    for (const char* name : {"a.obj", "b.obj", "c.obj"}) folder.box(name, name[0] - 'a' + 1.0F);
    withThreads(threads, [&] { bakeAll(withLiveViews(folder)); });
    std::map<std::string, std::string> pages;
    for (const char* name : {"out/a.html", "out/b.html", "out/c.html"}) pages[name] = bytesIn(folder, name);
    EXPECT_NE(pages["out/a.html"], pages["out/b.html"]);
    if (first.empty()) first = pages;
    EXPECT_TRUE(pages == first);
  }
}

// --- What would be done ---

TEST(Batch, ListsTheWorkAndTouchesNothing) {
  const BatchFolder folder;
  const std::string a = folder.box("a.obj").string(), b = folder.box("b.obj").string();
  Settings settings = folder.settings();
  EXPECT_EQ(listWork(settings, fewRays()), "bake   a.glb  <- " + a + "  (new)\nbake   b.glb  <- " + b + "  (new)\n2 assets, 2 to bake\n");
  EXPECT_FALSE(fs::exists(folder.out));
  bakeAll(settings);
  folder.box("b.obj", 2);
  EXPECT_EQ(listWork(settings, fewRays()),
            "fresh  a.glb  <- " + a + "\nbake   b.glb  <- " + b + "  (input changed)\n2 assets, 1 to bake\n");
  fs::remove(b);
  EXPECT_EQ(listWork(settings, fewRays()), "fresh  a.glb  <- " + a + "\n1 assets, 0 to bake\n");
  settings.batch.prune = true;
  EXPECT_EQ(listWork(settings, fewRays()), "fresh  a.glb  <- " + a + "\n1 assets, 0 to bake\nremove  b.glb\n");
  EXPECT_TRUE(fs::exists(folder.out / "b.glb"));
}

TEST(Batch, ListsTheLiveViewsThatItWouldWrite) {
  const BatchFolder folder;
  const std::string a = folder.box("a.obj").string();
  const Settings settings = withLiveViews(folder);
  EXPECT_EQ(listWork(settings, fewRays()), "bake   a.glb  <- " + a + "  (new)\n1 assets, 1 to bake\nwrite   a.html\n");
  EXPECT_FALSE(fs::exists(folder.out));
  bakeAll(settings);
  EXPECT_EQ(listWork(settings, fewRays()), "fresh  a.glb  <- " + a + "\n1 assets, 0 to bake\n");
  fs::remove(folder.out / "a.html");
  EXPECT_EQ(listWork(settings, fewRays()), "fresh  a.glb  <- " + a + "\n1 assets, 0 to bake\nwrite   a.html\n");
  bakeAll(settings);
  folder.box("a.obj", 2);
  EXPECT_EQ(listWork(settings, fewRays()), "bake   a.glb  <- " + a + "  (input changed)\n1 assets, 1 to bake\nwrite   a.html\n");
}

// --- Prune ---

TEST(Batch, PrunesOnlyWhereItIsAskedTo) {
  const BatchFolder folder;
  folder.box("a.obj");
  fs::path gone = folder.box("b.obj");
  Settings settings = folder.settings();
  bakeAll(settings);
  fs::remove(gone);
  EXPECT_EQ(bakeAll(settings).removed, Names{});
  EXPECT_TRUE(fs::exists(folder.out / "b.glb"));
  settings.batch.prune = true;
  const BatchReport interrupted = bakeAll(settings, 2);
  EXPECT_TRUE(interrupted.interrupted);
  EXPECT_EQ(interrupted.removed, Names{});
  EXPECT_EQ(bakeAll(settings).removed, Names{"b.glb"});
  EXPECT_FALSE(fs::exists(folder.out / "b.glb"));
  EXPECT_TRUE(fs::exists(folder.out / "a.glb"));
}

// A shard does not own the folder: the assets of the others stay.
TEST(Batch, AShardKeepsTheAssetsOfTheOthers) {
  const BatchFolder folder;
  for (const char* name : {"a.obj", "b.obj"}) folder.box(name);
  bakeAll(folder.settings());
  Settings settings = folder.settings();
  settings.batch.prune = true;
  settings.batch.shard = 1, settings.batch.shards = 2;
  const BatchReport report = bakeAll(settings);
  EXPECT_EQ(report.assets.size(), 1U);
  EXPECT_EQ(report.removed, Names{});
  EXPECT_TRUE(fs::exists(folder.out / "a.glb") && fs::exists(folder.out / "b.glb"));
}

// --- What is refused ---

TEST(Batch, ReportsReplaceNoInput) {
  const BatchFolder folder;
  const fs::path a = folder.box("a.obj");
  const std::string before = readFileBytes(a);
  const auto refuse = [&](auto change, const std::string& role) {
    Settings settings = folder.manifest("[[cloud]]\nsculpt = 'a.obj'\n");
    change(settings);
    const std::string told = refusalOf<UsageError>([&] { bakeAll(settings); });
    EXPECT_TRUE(contains(told, role)) << told;
  };
  refuse([&](Settings& s) { s.run.json = a; }, "--json");
  refuse([&](Settings& s) { s.batch.junit = a; }, "--junit");
  refuse([&](Settings& s) { s.batch.html = folder.in / "m.toml"; }, "--html");
  refuse([&](Settings& s) { s.batch.depfile = folder.in / "m.toml"; }, "--depfile");
  refuse([&](Settings& s) { s.run.json = s.batch.html = folder.path / "same"; }, "--html");
  refuse([&](Settings& s) { s.run.json = folder.out / "a.glb"; }, "--json");
  EXPECT_EQ(readFileBytes(a), before);
}

TEST(Batch, LiveViewsReplaceNeitherInputNorReport) {
  const BatchFolder folder;
  folder.box("a.obj");
  Settings settings = withLiveViews(folder);
  settings.batch.html = folder.out / "A.html";
  const auto told = [&] { return refusalOf<UsageError>([&] { bakeAll(settings); }); };
  EXPECT_TRUE(contains(told(), "the live view of a.glb and --html would write the same file")) << told();
  fs::create_directory(folder.out);
  folder.write("out/a.html", "[camera]\ndistance = 5\n");
  settings = folder.manifest("[[cloud]]\nsculpt = 'a.obj'\nscene = '../out/a.html'\n");
  settings.batch.html = folder.path / "r.html";
  settings.batch.live = true;
  EXPECT_TRUE(contains(told(), "the live view of a.glb would replace an input of a.glb")) << told();
  EXPECT_FALSE(fs::exists(folder.out / "a.glb") || fs::exists(folder.path / "r.html"));
}

TEST(Batch, WaitsForNoOtherBatch) {
  const BatchFolder folder;
  folder.box("a.obj");
  const OutputLock other(folder.out, 0, 0);
  expectError<Error>([&] { bakeAll(folder.settings()); }, "another batch is writing to this folder");
  EXPECT_FALSE(fs::exists(folder.out / "a.glb"));
}

// --- Shards ---

struct Shards : BatchFolder {
  std::vector<fs::path> reports;
  Shards() {
    for (const char* name : {"a.obj", "b.obj", "c.obj"}) box(name);
    for (const int shard : {1, 2}) {
      Settings all = settings();
      all.batch.shard = shard, all.batch.shards = 2;
      all.run.json = path / (std::to_string(shard) + ".json");
      bakeAll(all);
      reports.push_back(*all.run.json);
    }
  }
  Settings merge(const std::vector<fs::path>& files) const {
    Settings all;
    all.batch.merge = true;
    all.batch.inputs = files;
    return all;
  }
};

TEST(Batch, ShardsTogetherAreTheBatch) {
  const Shards folder;
  for (const char* name : {"a.glb", "b.glb", "c.glb", ".cloudbake/last_report-1-of-2.json", ".cloudbake/last_report-2-of-2.json"})
    EXPECT_TRUE(fs::exists(folder.out / name)) << name;
  Settings settings = folder.merge({folder.reports[1], folder.reports[0]});
  settings.run.json = folder.path / "all.json";
  settings.batch.html = folder.path / "all.html";
  Listener listener;
  const BatchReport merged = mergeShards(settings, listener);
  Names names;
  for (const AssetRecord& asset : merged.assets) names.push_back(asset.name);
  EXPECT_EQ(names, (Names{"a.glb", "b.glb", "c.glb"}));
  EXPECT_EQ(merged.shards, 0);
  EXPECT_EQ(merged.output, folder.out.string());
  EXPECT_EQ(merged.source, folder.in.string());
  EXPECT_EQ(readFileBytes(*settings.run.json), batchJson(merged));
  EXPECT_TRUE(fs::exists(thumbnailFile(folder.out, "b.glb"))) << "pictures are made of the assets in the shards' folder";
  EXPECT_EQ(assetStates(bakeAll(folder.settings())), (std::vector{AssetState::kFresh, AssetState::kFresh, AssetState::kFresh}));
}

TEST(Batch, LiveViewsOfShards) {
  const Shards folder;
  Settings shard = withLiveViews(folder);
  shard.batch.shard = 1, shard.batch.shards = 2;
  EXPECT_EQ(bakeAll(shard).assets.size(), 2U);
  EXPECT_TRUE(fs::exists(folder.out / "a.html") && !fs::exists(folder.out / "b.html") && fs::exists(folder.out / "c.html"));
  Settings settings = folder.merge(folder.reports);
  settings.batch.html = folder.path / "r.html";
  settings.batch.live = true;
  Listener listener;
  mergeShards(settings, listener);
  EXPECT_TRUE(fs::exists(folder.out / "b.html")) << "the merge makes those that are missing";
  for (const char* url : {"out/a.html", "out/b.html", "out/c.html"}) EXPECT_TRUE(links(folder, url)) << url;
  for (const char* name : {"out/b.glb", "out/b.html"}) fs::remove(folder.path / name);
  mergeShards(settings, listener);
  EXPECT_FALSE(links(folder, "out/b.html"));
  EXPECT_TRUE(contains(listener.told, "no live view of b.glb: ")) << listener.told;
  settings.batch.html = folder.out / "b.html";
  expectError<UsageError>([&] { mergeShards(settings, listener); }, "the live view of b.glb and --html would write the same file");
  settings.batch.html = folder.reports[0];
  expectError<UsageError>([&] { mergeShards(settings, listener); }, "--html would replace the report of a shard");
}

// The longest time, the whole work, the largest memory.
TEST(Batch, MergedFigures) {
  const TestFolder folder;
  const auto shard = [&](int number, double seconds, double work, uint64_t memory, bool interrupted) {
    BatchReport part;
    part.shard = number, part.shards = 2;
    part.seconds = seconds, part.processor_seconds = work, part.peak_memory = memory, part.threads = 4;
    part.interrupted = interrupted;
    part.removed = {std::to_string(number) + ".glb"};
    return folder.write(std::to_string(number) + ".json", batchJson(part));
  };
  Settings settings;
  settings.batch.inputs = {shard(1, 3, 10, 500, true), shard(2, 2, 7, 900, false)};
  Listener listener;
  const BatchReport merged = mergeShards(settings, listener);
  EXPECT_EQ(merged.seconds, 3);
  EXPECT_EQ(merged.processor_seconds, 17);
  EXPECT_EQ(merged.peak_memory, 900U);
  EXPECT_EQ(merged.threads, 8);
  EXPECT_TRUE(merged.interrupted);
  EXPECT_EQ(merged.removed, (Names{"1.glb", "2.glb"}));
}

TEST(Batch, ShardsThatDoNotBelongTogether) {
  const TestFolder folder;
  const auto shard = [&](int number, int count, const std::string& asset) {
    BatchReport part;
    part.shard = number, part.shards = count;
    part.assets.emplace_back().name = asset;
    return folder.write(std::to_string(number) + "of" + std::to_string(count) + asset + ".json", batchJson(part));
  };
  const auto merge = [](const std::vector<fs::path>& files) {
    return [files] {
      Settings settings;
      settings.batch.inputs = files;
      Listener listener;
      mergeShards(settings, listener);
    };
  };
  expectError<UsageError>(merge({}), "--merge needs the reports");
  expectError<InputError>(merge({shard(1, 2, "a"), shard(1, 2, "b")}), "1of2b.json: this is shard 1, and so is ");
  expectError<InputError>(merge({shard(1, 2, "a"), shard(2, 3, "b")}), "2of3b.json: a shard of 3 among shards of 2");
  expectError<InputError>(merge({shard(1, 1, "a"), shard(2, 3, "b")}), "2of3b.json: a shard of 3 among shards of 1");
  expectError<InputError>(merge({shard(1, 2, "a"), shard(2, 2, "a")}), "'a' is also in ");
  expectError<InputError>(merge({shard(2, 3, "a")}), "no report of shard 1, 3 of 3");
  expectError<InputError>(merge({folder.write("x.json", "{}")}), "x.json");
  expectError<IoError>(merge({folder.path / "no.json"}), "no.json");
  EXPECT_TRUE(refusalOf([&] { merge({shard(1, 2, "a"), shard(2, 2, "b")})(); }).empty());
}

}  // namespace
}  // namespace cloudbake
