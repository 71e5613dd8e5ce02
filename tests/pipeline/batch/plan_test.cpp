// From a manifest, a folder or a list to assets: their names, options and order, and what is refused where.
#include "pipeline/batch/plan.h"

#include "tests/pipeline/batch/batch_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

const PlannedAsset& assetNamed(const BatchPlan& plan, const std::string& name) {
  for (const PlannedAsset& asset : plan.assets)
    if (asset.name == name) return asset;
  throw std::invalid_argument("no asset " + name);
}
Settings resolved(const PlannedAsset& asset) { return resolve(asset.from, asset.given); }

// --- Names ---

TEST(Plan, NamesOfGrownClouds) {
  const BatchFolder folder;
  folder.write("in/bubbles.csv", "0,0,0,1\n");
  const BatchPlan plan = planBatch(folder.manifest("[[cloud]]\npreset = 'hero'\n"
                                                   "[[cloud]]\npreset = 'humilis'\nseeds = [7, 2]\n"
                                                   "[[cloud]]\nfrom_spheres = 'bubbles.csv'\nname = '{ext}/{stem}-x.GLB'\n"),
                                   {});
  EXPECT_EQ(namesOf(plan.assets), (Names{"hero.glb", "humilis_7.glb", "humilis_2.glb", "csv/bubbles-x.GLB"}));
  EXPECT_EQ(plan.assets[0].source, "preset hero");
  EXPECT_EQ(plan.assets[1].source, "preset humilis, seed 7");
  EXPECT_EQ(plan.assets[3].source, (folder.in / "bubbles.csv").string());
  EXPECT_EQ(resolved(plan.assets[2]).lobe.bake.seed, 2U);
  EXPECT_EQ(plan.assets[1].from.kind, SourceKind::kPreset);
  EXPECT_EQ(plan.assets[3].from.kind, SourceKind::kSpheres);
}

TEST(Plan, NamesOfSculpts) {
  const BatchFolder folder;
  for (const char* name : {"b.obj", "deep/er/a.OBJ", "deep/c.obj", "deep/note.txt"}) folder.box(name);
  const std::string glob = "[[cloud]]\nsculpt = '**/*.[oO][bB][jJ]'\n";
  EXPECT_EQ(namesOf(planBatch(folder.manifest(glob), {}).assets), (Names{"b.glb", "deep/c.glb", "deep/er/a.glb"}));
  EXPECT_EQ(namesOf(planBatch(folder.settings(), {}).assets), (Names{"b.glb", "deep/c.glb", "deep/er/a.glb"}));
  EXPECT_EQ(namesOf(planBatch(folder.manifest("[[cloud]]\nsculpt = 'deep/c.obj'\n"), {}).assets), Names{"c.glb"});
  EXPECT_EQ(namesOf(planBatch(folder.manifest("[[cloud]]\nsculpt = 'deep/**/*.OBJ'\n"), {}).assets), Names{"er/a.glb"});
  EXPECT_EQ(namesOf(planBatch(folder.manifest("[[cloud]]\nsculpt = '**/*.OBJ'\nname = '{folder}/x/../{stem}_{ext}.glb'\n"), {}).assets),
            Names{"deep/er/a_obj.glb"});
  EXPECT_EQ(namesOf(planBatch(folder.manifest("[[cloud]]\nsculpt = 'b.obj'\nname = '{folder}/{stem}.glb'\n"), {}).assets), Names{"b.glb"});
}

TEST(Plan, NamesOfSequences) {
  const BatchFolder folder;
  for (const char* name : {"f/smoke_0001.obj", "f/smoke_0002.obj", "g/1.obj", "g/2.obj", "h/walk.1.fbx"}) folder.box(name);
  const BatchPlan plan = planBatch(folder.manifest("[[cloud]]\nsequence = 'f/smoke_####.obj'\nloop = true\n"
                                                   "[[cloud]]\nsequence = 'f'\n[[cloud]]\nsequence = 'g/*.obj'\n"
                                                   "[[cloud]]\nsequence = 'h/walk.1.fbx'\nanimation = 'Walk'\n"
                                                   "[[cloud]]\nsequence = 'sprouting'\nseeds = [1, 2]\n"),
                                   {});
  EXPECT_EQ(namesOf(plan.assets), (Names{"smoke.glb", "f.glb", "sequence.glb", "walk.1.glb", "sprouting_1.glb", "sprouting_2.glb"}));
  EXPECT_TRUE(plan.assets[3].is_sequence && plan.assets[3].frames.empty()) << "its frames are in the file";
  EXPECT_EQ(plan.assets[0].frames.size(), 2U);
  EXPECT_TRUE(resolved(plan.assets[0]).sequence.loops);
  for (const auto& [text, message] :
       {std::pair("fps = 12\npreset = 'hero'", "unknown key 'fps': give an option of `cloudbake grow` or `bake`"),
        std::pair("sequence = 'f'\nsh = 3", "unknown key 'sh': give an option of `cloudbake sequence`"),
        std::pair("sequence = 'f'\nseeds = [1]", "'seeds' are for clouds that grow from rules"),
        std::pair("sequence = 'f'\nas = 'keys'", "a batch writes a sequence to one file"), std::pair("sequence = 'none/#.vdb'", "none")}) {
    SCOPED_TRACE(text);
    const Settings settings = folder.manifest(std::string("[[cloud]]\n") + text + "\n");
    EXPECT_TRUE(contains(refusalOf<Error>([&] { planBatch(settings, {}); }), message));
  }
}

// The name of the command line, of the manifest and of the cloud: the nearest to the cloud is used.
TEST(Plan, WhichNameIsUsed) {
  const BatchFolder folder;
  Settings settings = folder.manifest("name = 'm/{stem}.glb'\n[[cloud]]\npreset = 'hero'\n[[cloud]]\npreset = 'toon'\nname = 'c.glb'\n");
  EXPECT_EQ(namesOf(planBatch(settings, {}).assets), (Names{"m/hero.glb", "c.glb"}));
  settings.batch.name = "line/{stem}.glb";
  EXPECT_EQ(namesOf(planBatch(settings, {}).assets), (Names{"line/hero.glb", "c.glb"}));
}

TEST(Plan, NamesOutsideTheOutputFolderAreRefused) {
  const BatchFolder folder;
  folder.box("a.obj");
  const std::pair<const char*, const char*> refusals[] = {
      {"{colour}.glb", "the words in braces are"},
      {"{seed}.glb", "the words in braces are"},
      {"{stem.glb", "the words in braces are"},
      {"../a.glb", "must be inside the output folder"},
      {"b/../../a.glb", "must be inside the output folder"},
      {"/a.glb", "must be inside the output folder"},
      {".cloudbake/a.glb", "must be inside the output folder"},
      {"{stem}.obj", "outputs are GLB files"},
      {"{stem}", "outputs are GLB files"},
  };
  for (const auto& [name, message] : refusals) {
    SCOPED_TRACE(name);
    const Settings settings = folder.manifest("[[cloud]]\nsculpt = 'a.obj'\nname = '" + std::string(name) + "'\n");
    const std::string told = refusalOf<InputError>([&] { planBatch(settings, {}); });
    EXPECT_TRUE(contains(told, "m.toml:3:8: name '")) << told;
    EXPECT_TRUE(contains(told, message)) << told;
    Settings of_line = folder.settings();
    of_line.batch.name = name;
    expectError<UsageError>([&] { planBatch(of_line, {}); }, message);
  }
}

TEST(Plan, NoTwoAssetsHaveOneName) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("A.ply");
  const Settings twice = folder.manifest("[[cloud]]\npreset = 'hero'\n\n[[cloud]]\npreset = 'hero'\n");
  expectError<InputError>([&] { planBatch(twice, {}); }, "m.toml:5:10: 'hero.glb' is the output of preset hero and of preset hero");
  Settings apart = folder.settings();
  apart.batch.name = "{stem}_{ext}.glb";
  EXPECT_EQ(namesOf(planBatch(apart, {}).assets), (Names{"A_ply.glb", "a_obj.glb"}));
}

TEST(Plan, FilesOfOneStemGetNamesOfTheirOwn) {
  const BatchFolder folder;
  for (const char* name : {"a.obj", "A.ply", "b.obj", "deep/a.obj", "deep/a_obj.stl", "deep/a.stl"}) folder.box(name);
  const BatchPlan plan = planBatch(folder.settings(), {});
  // a_obj is taken below deep/, so that both of its a are numbered
  EXPECT_EQ(namesOf(plan.assets), (Names{"A_ply.glb", "a_obj.glb", "b.glb", "deep/a_1.glb", "deep/a_2.glb", "deep/a_obj.glb"}));
  ASSERT_EQ(plan.notes.size(), 2U);
  EXPECT_EQ(plan.notes[0].find("2 files are named 'a': A_ply.glb <- "), 0U) << plan.notes[0];

  Settings flat = folder.settings();
  flat.batch.name = "{stem}.glb";
  EXPECT_EQ(namesOf(planBatch(flat, {}).assets), (Names{"A_1.glb", "a_2.glb", "b.glb", "a_3.glb", "a_4.glb", "a_obj.glb"}));
}

TEST(Plan, WordsOfANameAreNotRepeated) {
  const BatchFolder folder;
  folder.write("in/list.txt", folder.box("x/a.obj").string() + "\n" + folder.box("y/a.obj").string() + "\n");
  folder.box("y/c.OBJ");
  Settings settings = folder.settings();
  settings.batch.name = "{stem}_{ext}.glb";
  EXPECT_EQ(namesOf(planBatch(settings, {}).assets), (Names{"a_obj_x.glb", "a_obj_y.glb", "c_obj.glb"}));
  settings = folder.settings();
  settings.batch.inputs.clear();
  settings.batch.input_list = folder.in / "list.txt";
  const std::vector<PlannedAsset> assets = planBatch(settings, {}).assets;
  EXPECT_TRUE(assets[0].name.ends_with("_in_x.glb")) << assets[0].name;
  EXPECT_TRUE(assets[1].name.ends_with("_in_y.glb")) << assets[1].name;
}

// A record in the output folder holds a name for the file that it came from, whatever is added or removed beside it.
TEST(Plan, AFileKeepsTheNameOfItsRecord) {
  const BatchFolder folder;
  const auto record = [&](const std::string& name, const fs::path& source) {
    AssetRecord asset;
    asset.name = name, asset.source = source.string();
    writeOutput(folder.out, asset, {"glb", {}});
  };
  const fs::path obj = folder.box("a.obj");
  record("a.glb", obj);
  const fs::path stl = folder.box("a.stl");
  EXPECT_EQ(namesOf(planBatch(folder.settings(), {}).assets), (Names{"a.glb", "a_stl.glb"}));
  record("a_stl.glb", stl);
  fs::remove(obj);
  EXPECT_EQ(namesOf(planBatch(folder.settings(), {}).assets), Names{"a_stl.glb"});
  folder.box("a.obj", 2);
  EXPECT_EQ(namesOf(planBatch(folder.settings(), {}).assets), (Names{"a.glb", "a_stl.glb"}));
  // a record of another folder of the same batch, seen from another working folder
  const BatchFolder other;
  const fs::path x = other.box("x/a.obj"), y = other.box("y/a.obj");
  AssetRecord asset;
  asset.name = "a.glb", asset.source = "in/y/a.obj";
  writeOutput(other.out, asset, {"glb", {}});
  Settings flat = other.settings();
  flat.batch.name = "{stem}.glb";
  EXPECT_EQ(namesOf(planBatch(flat, {}).assets), (Names{"a_x.glb", "a.glb"}));  // as a_obj would not tell all apart
}

TEST(Plan, AFrameForAllIsForFilesThatStateNone) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.write("in/m.toml", "[[cloud]]\nsculpt = 'a.obj'\nunits = 1\n");
  const std::vector<Given> given = options({"units=0.01"});
  EXPECT_TRUE(planBatch(folder.settings(), given).assets[0].from.read.frame_if_unstated);
  EXPECT_FALSE(planBatch(folder.settings(), {}).assets[0].from.read.frame_if_unstated);
  EXPECT_FALSE(planBatch(folder.settings(folder.in / "m.toml"), given).assets[0].from.read.frame_if_unstated);
}

TEST(Plan, NoAssetReplacesASculpt) {
  const BatchFolder folder;
  folder.box("a.glb");
  Settings settings = folder.manifest("[[cloud]]\nsculpt = 'a.glb'\n");
  settings.output.file = folder.in;
  expectError<InputError>([&] { planBatch(settings, {}); }, "m.toml:2:10: 'a.glb' would replace the sculpt ");
  settings.output.file = folder.path / "link";
  fs::create_directory_symlink(folder.in, settings.output.file);
  expectError<InputError>([&] { planBatch(settings, {}); }, "would replace the sculpt ");
}

// --- Options ---

TEST(Plan, LaterOptionsWin) {
  const BatchFolder folder;
  folder.box("a.obj");
  const Settings settings = folder.manifest(
      "[defaults]\nrays = 10\nvoxels = 11\nseed = 12\n[[cloud]]\nsculpt = 'a.obj'\nvoxels = 21\nseed = 22\n"
      "[[cloud]]\npreset = 'hero'\nseeds = [32]\n");
  const BatchPlan plan = planBatch(settings, options({"extinction=2"}));
  const Settings sculpt = resolved(assetNamed(plan, "a.glb")), grown = resolved(assetNamed(plan, "hero_32.glb"));
  EXPECT_EQ(sculpt.lobe.bake.rays, 10);
  EXPECT_EQ(sculpt.field.voxels, 21);
  EXPECT_EQ(sculpt.lobe.bake.seed, 22U);
  EXPECT_EQ(grown.field.voxels, 11);
  EXPECT_EQ(grown.lobe.bake.seed, 32U) << "the seeds of a cloud are nearer to it than the defaults";
  ASSERT_TRUE(sculpt.lobe.extinction_range);
  EXPECT_EQ(sculpt.lobe.extinction_range->first, 2);
  const BatchPlan line = planBatch(settings, options({"voxels=31"}));
  for (const PlannedAsset& asset : line.assets) EXPECT_EQ(resolved(asset).field.voxels, 31) << asset.name;
}

// A default or an option of the command line is for the assets that it suits; a cloud's own must suit it.
TEST(Plan, OptionsThatDoNotApply) {
  const BatchFolder folder;
  folder.box("a.obj");
  const BatchPlan plan = planBatch(folder.manifest("[defaults]\nblend = 0.25\nrepair = 'orient'\n"
                                                   "[[cloud]]\nsculpt = 'a.obj'\n[[cloud]]\npreset = 'hero'\n"),
                                   {});
  const auto given = [](const PlannedAsset& asset) {
    Names names;
    for (const Given& one : asset.given) names.push_back(one.option->name);
    return names;
  };
  EXPECT_EQ(given(assetNamed(plan, "a.glb")), Names{"repair"});
  EXPECT_EQ(given(assetNamed(plan, "hero.glb")), Names{"blend"});
  const std::pair<const char*, const char*> refusals[] = {
      {"[[cloud]]\nsculpt = 'a.obj'\nblend = 1\n", "m.toml:3:9: 'blend' does not apply to a sculpt"},
      {"[[cloud]]\npreset = 'hero'\nrepair = 'orient'\n", "m.toml:3:10: 'repair' does not apply to a grown cloud"},
      {"[[cloud]]\npreset = 'hero'\nfrob = 1\n", "m.toml:3:8: unknown key 'frob'"},
      {"[defaults]\nthreads = 1\n[[cloud]]\npreset = 'hero'\n", "m.toml:2:11: unknown key 'threads'"},
      {"[[cloud]]\npreset = 'hero'\nrays = 0\n", "m.toml:3:8: "},
      {"[[cloud]]\nsculpt = 'no.obj'\n", "m.toml:2:10: no file '"},
      {"[[cloud]]\nsculpt = ['a.obj',\n 'no*.obj']\n", "m.toml:3:2: no file matches '"},
      {"[[cloud]]\nrules = 'no.txt'\n", "m.toml:2:9: no file '"},
      {"[[cloud]]\npreset = 'nimbus'\n", "m.toml:2:10: no preset 'nimbus': the presets are anvil, "},
  };
  for (const auto& [text, message] : refusals) {
    SCOPED_TRACE(text);
    const Settings settings = folder.manifest(text);
    expectError<InputError>([&] { planBatch(settings, {}); }, message);
  }
}

// --- Scenes ---

TEST(Plan, AnAssetsOwnSceneIsUsedBeforeTheManifests) {
  const BatchFolder folder;
  const fs::path scene = folder.write("in/near.toml", "[camera]\ndistance = 5\n");
  const BatchPlan plan = planBatch(
      folder.manifest("[scene.camera]\ndistance = 200\n[[cloud]]\npreset = 'hero'\n[[cloud]]\npreset = 'toon'\nscene = 'near.toml'\n"), {});
  EXPECT_FALSE(sceneFileOf(plan.assets[0]));
  EXPECT_EQ(sceneOf(plan.assets[0], plan)->camera_distance, 200);
  EXPECT_EQ(sceneFileOf(plan.assets[1]), scene) << "relative to the manifest";
  EXPECT_EQ(sceneOf(plan.assets[1], plan)->camera_distance, 5);
  const BatchPlan none = planBatch(folder.manifest("[[cloud]]\npreset = 'hero'\n"), {});
  EXPECT_FALSE(sceneOf(none.assets[0], none));
}

// --- Where assets come from ---

TEST(Plan, ListsNameAFilePerLine) {
  const BatchFolder folder;
  const std::string a = folder.box("a.obj").string(), b = folder.box("deep/b.obj").string();
  Settings settings = folder.settings();
  settings.batch.inputs.clear();
  settings.batch.input_list = folder.write("list.txt", b + "\n\n" + a + "\n");
  const BatchPlan plan = planBatch(settings, {});
  EXPECT_EQ(namesOf(plan.assets), (Names{"b.glb", "a.glb"}));
  EXPECT_EQ(plan.watched, std::vector<fs::path>{*settings.batch.input_list});
  EXPECT_EQ(plan.source, settings.batch.input_list->string());
  folder.write("list.txt", a + "\n" + a + "x\n");
  expectError<InputError>([&] { planBatch(settings, {}); }, "list.txt:2: no file '" + a + "x'");
  folder.write("list.txt", "\n");
  expectError<InputError>([&] { planBatch(settings, {}); }, "the list names no file");
  settings.batch.inputs = {folder.in};
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] { planBatch(settings, {}); }), "not several"));
}

TEST(Plan, WatchesWhatItSearched) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("deep/b.obj");
  folder.write("out", "");
  const auto has = [](const BatchPlan& plan, const fs::path& path) {
    return std::find(plan.watched.begin(), plan.watched.end(), path) != plan.watched.end();
  };
  const BatchPlan whole = planBatch(folder.settings(), {});
  EXPECT_TRUE(has(whole, folder.in) && has(whole, folder.in / "deep"));
  const BatchPlan manifest = planBatch(folder.manifest("[[cloud]]\nsculpt = 'deep/*.obj'\n"), {});
  EXPECT_TRUE(has(manifest, folder.in / "m.toml") && has(manifest, folder.in / "deep"));
}

TEST(Plan, WhatIsNoBatch) {
  const BatchFolder folder;
  const fs::path sculpt = folder.box("a.obj");
  const auto plan = [&](const Settings& settings) { return [settings] { planBatch(settings, {}); }; };
  expectError<InputError>(plan(folder.settings(sculpt)), "a.obj: a manifest (.toml) or a folder is needed");
  expectError<IoError>(plan(folder.settings(folder.path / "no")), "no such manifest");
  fs::create_directory(folder.path / "empty");
  expectError<InputError>(plan(folder.settings(folder.path / "empty")), "no sculpt in this folder");
  Settings settings = folder.settings();
  settings.output.file = folder.in;
  expectError<UsageError>(plan(settings), "-o is the folder of the sculpts");
  settings.batch.inputs.clear();
  expectError<UsageError>(plan(settings), "what to bake");
  settings.batch.inputs = {folder.in, folder.in};
  EXPECT_TRUE(contains(refusalOf<UsageError>(plan(settings)), "not several"));
}

// The assets of the last run are no sculpts of the next.
TEST(Plan, TheOutputFolderIsNotSearched) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("out/b.obj");
  Settings settings = folder.settings();
  settings.output.file = folder.in / "out";
  EXPECT_EQ(namesOf(planBatch(settings, {}).assets), Names{"a.glb"});
}

// What this batch or another one has written is no sculpt, wherever it lies: outputs, levels, live views, reports and records.
TEST(Plan, OutputsOfBatchesAreNoSculpts) {
  const BatchFolder folder;
  folder.box("a.obj");
  const auto made = [&](const fs::path& output, const std::string& name, size_t levels) {
    AssetRecord record;
    record.name = name;
    AssetBytes bytes{"glb", {}};
    for (size_t i = 0; i < levels; ++i) bytes.levels.push_back("level"), record.level_hashes.push_back(hashBytes("level"));
    writeOutput(output, record, bytes);
    writeLiveView(output, name, "page");
  };
  made(folder.in, "a_baked.glb", 2), made(folder.in / "earlier", "d/b.glb", 0);
  for (const char* own : {"a_baked_lod3.glb", "c_lod1.glb", "d.glb", "note.html", "earlier/b.glb"})
    folder.write(std::string("in/") + own, "x");
  folder.write("in/r.json", "{}");
  const Names artists{"a.glb", "a_baked_lod3.glb", "c_lod1.glb", "d.glb", "earlier/b.glb"};
  EXPECT_EQ(namesOf(planBatch(folder.settings(), {}).assets), artists);

  Settings settings = folder.manifest("[[cloud]]\nsculpt = ['**/*.glb', 'a.obj']\n");
  settings.run.json = folder.in / "x/../r.json";
  EXPECT_EQ(namesOf(planBatch(settings, {}).assets), (Names{"a_baked_lod3.glb", "c_lod1.glb", "d.glb", "earlier/b.glb", "a.glb"}));
  settings.batch.inputs = {folder.write("in/m.toml", "name = '{stem}_{ext}.glb'\n[[cloud]]\nsculpt = '*'\n")};
  const Names all = namesOf(planBatch(settings, {}).assets);
  for (const char* written : {"r_json.glb", "a_baked_html.glb", "a_baked_glb.glb", "a_baked_lod1_glb.glb"})
    EXPECT_EQ(std::count(all.begin(), all.end(), written), 0) << written;
  for (const char* other : {"note_html.glb", "a_baked_lod3_glb.glb", "m_toml.glb"})
    EXPECT_EQ(std::count(all.begin(), all.end(), other), 1) << other;
  settings.batch.inputs = {folder.write("in/m.toml", "[[cloud]]\nsculpt = '.cloudbake/*'\n")};
  EXPECT_TRUE(
      contains(refusalOf<InputError>([&] { planBatch(settings, {}); }), "m.toml:2:10: only files that a batch has written match '"));
  // Whoever names it means it.
  settings.batch.inputs = {folder.write("in/m.toml", "[[cloud]]\nsculpt = 'a_baked.glb'\n")};
  EXPECT_EQ(namesOf(planBatch(settings, {}).assets), Names{"a_baked.glb"});
}

TEST(Plan, TheExampleIsABatch) {
  const BatchFolder folder;
  const BatchPlan plan = planBatch(folder.manifest(exampleManifest()), {});
  ASSERT_EQ(plan.assets.size(), 13U);
  EXPECT_EQ(plan.assets[0].name, "humilis/1.glb");
  EXPECT_EQ(plan.assets[11].name, "humilis/12.glb");
  EXPECT_EQ(plan.assets[12].name, "hero.glb");
  EXPECT_EQ(resolved(plan.assets[0]).mesh.vertices, 8000U);
  EXPECT_TRUE(resolved(plan.assets[12]).lobe.fit);
}

// --- Cost and shards ---

TEST(Plan, MoreWorkCostsMore) {
  const BatchFolder folder;
  folder.box("a.obj");
  const auto planned = [&](const std::vector<std::string>& texts) { return planBatch(folder.settings(), options(texts)).assets[0]; };
  const PlannedAsset plain = planned({"lobe=mean", "rays=100", "voxels=100"});
  EXPECT_GT(plain.cost_seconds, 0);
  for (const char* more : {"rays=1000", "voxels=200", "lobe=fit", "target-error=0.5", "method=rays", "bake-voxels=200"})
    EXPECT_GT(planned({"lobe=mean", more}).cost_seconds, plain.cost_seconds) << more;
  EXPECT_GT(planned({"voxels=200"}).memory, plain.memory);
  EXPECT_EQ(planned({"bake-voxels=200"}).memory, planned({"voxels=200"}).memory);
}

// By hand: 5, 4, then 3 to the second, 3 to the first, 3 to the second.
TEST(Plan, ShardsHaveAboutEqualCost) {
  std::vector<PlannedAsset> assets;
  for (const auto& [name, cost] :
       {std::pair("a", 3.0), std::pair("b", 5.0), std::pair("c", 3.0), std::pair("d", 4.0), std::pair("e", 3.0)}) {
    assets.emplace_back();
    assets.back().name = name;
    assets.back().cost_seconds = cost;
  }
  EXPECT_EQ(namesOf(shardOf(assets, 1, 2)), (Names{"b", "c"}));
  EXPECT_EQ(namesOf(shardOf(assets, 2, 2)), (Names{"a", "d", "e"}));
  EXPECT_EQ(namesOf(shardOf(assets, 1, 1)), (Names{"a", "b", "c", "d", "e"}));
  EXPECT_EQ(namesOf(shardOf(assets, 6, 7)), Names{}) << "more shards than assets";
}

}  // namespace
}  // namespace cloudbake
