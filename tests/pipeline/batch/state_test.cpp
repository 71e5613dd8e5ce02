// What decides whether an asset is baked again, and what is kept of it.
#include "pipeline/batch/state.h"

#include "tests/pipeline/batch/batch_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// --- Keys ---

// The parts of a key.
struct Key {
  std::string build, settings, input;
};
Key split(const std::string& key) {
  EXPECT_EQ(key.size(), 64U);
  EXPECT_EQ(key.find_first_not_of("0123456789abcdef"), std::string::npos) << key;
  return {key.substr(0, 16), key.substr(16, 16), key.substr(32)};
}
std::vector<AssetInputs> inputsFor(const Settings& settings, const std::vector<Given>& given = {}) {
  const BatchPlan plan = planBatch(settings, given);
  return inputsOf(plan.assets, plan);
}
Key keyFor(const Settings& settings, const std::vector<Given>& given = {}) { return split(inputsFor(settings, given).at(0).key); }

void expectOnlySettingsDiffer(const Key& a, const Key& b) {
  EXPECT_EQ(a.build, b.build);
  EXPECT_NE(a.settings, b.settings);
  EXPECT_EQ(a.input, b.input);
}
void expectOnlyInputDiffers(const Key& a, const Key& b) {
  EXPECT_EQ(a.build, b.build);
  EXPECT_EQ(a.settings, b.settings);
  EXPECT_NE(a.input, b.input);
}

TEST(State, KeysChangeWithTheSettings) {
  const BatchFolder folder;
  folder.box("a.obj");
  const Key plain = keyFor(folder.settings());
  expectOnlySettingsDiffer(plain, keyFor(folder.settings(), options({"rays=16"})));
  expectOnlySettingsDiffer(keyFor(folder.settings(), options({"rays=18"})), keyFor(folder.settings(), options({"rays=16"})));
  const std::string cloud = "[[cloud]]\nsculpt = 'a.obj'\n";
  EXPECT_EQ(keyFor(folder.manifest(cloud)).settings, plain.settings);
  const Key far = keyFor(folder.manifest("[scene.camera]\ndistance = 200\n" + cloud));
  expectOnlySettingsDiffer(plain, far);
  expectOnlySettingsDiffer(far, keyFor(folder.manifest("[scene.camera]\ndistance = 100\n" + cloud)));
  const auto sun = [&](const std::string& arc) {
    return keyFor(folder.manifest("[scene.camera]\ndistance = 200\n[scene.sun]\nelevation = " + arc + "\n" + cloud));
  };
  expectOnlySettingsDiffer(far, sun("[5, 60]"));
  expectOnlySettingsDiffer(sun("[5, 50]"), sun("[5, 60]"));
}

// Neither the name of the output, nor the time of the file, nor the folder that it lies in.
TEST(State, KeysDependOnContentOnly) {
  const BatchFolder folder;
  const fs::path sculpt = folder.box("a.obj");
  const Settings settings = folder.settings();
  const std::string key = inputsFor(settings)[0].key;
  fs::last_write_time(sculpt, fs::file_time_type::clock::now() - std::chrono::hours(1000));
  EXPECT_EQ(inputsFor(settings)[0].key, key);
  Settings named = settings;
  named.batch.name = "other.glb";
  EXPECT_EQ(inputsFor(named)[0].key, key);
  fs::create_directory(folder.path / "there");
  fs::rename(sculpt, folder.path / "there/a.obj");
  EXPECT_EQ(inputsFor(folder.settings(folder.path / "there"))[0].key, key);
}

TEST(State, KeysChangeWithTheInput) {
  const BatchFolder folder;
  folder.box("a.obj");
  const Key before = keyFor(folder.settings());
  folder.box("a.obj", 2);
  expectOnlyInputDiffers(before, keyFor(folder.settings()));
  folder.box("a.obj");
  fs::rename(folder.in / "a.obj", folder.in / "b.obj");
  expectOnlyInputDiffers(before, keyFor(folder.settings()));  // the stem names a part
}

// A material library that a sculpt names counts, whether it is there or not.
TEST(State, KeysChangeWithTheFilesThatASculptNames) {
  const BatchFolder folder;
  folder.write("in/a.obj", "mtllib a.mtl\n" + kTetrahedronObj);
  const Key absent = keyFor(folder.settings());
  folder.write("in/a.mtl", "newmtl red\nKd 1 0 0\n");
  const Key red = keyFor(folder.settings());
  expectOnlyInputDiffers(absent, red);
  folder.write("in/a.mtl", "newmtl red\nKd 0 0 1\n");
  expectOnlyInputDiffers(red, keyFor(folder.settings()));
  EXPECT_EQ(inputsFor(folder.settings())[0].files, (std::vector<fs::path>{folder.in / "a.obj", folder.in / "a.mtl"}));
}

// Of a scene file the bytes count, not the path.
TEST(State, KeysChangeWithTheBytesOfAScene) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.write("in/s.toml", "[camera]\ndistance = 5\n");
  folder.write("in/t.toml", "[camera]\ndistance = 5\n");
  const auto with = [&](const std::string& scene) { return folder.manifest("[[cloud]]\nsculpt = 'a.obj'\nscene = '" + scene + "'\n"); };
  const AssetInputs inputs = inputsFor(with("s.toml"))[0];
  EXPECT_EQ(inputsFor(with("t.toml"))[0].key, inputs.key);
  EXPECT_EQ(inputs.files, (std::vector<fs::path>{folder.in / "a.obj", folder.in / "s.toml"}));
  folder.write("in/s.toml", "[camera]\ndistance = 6\n");
  expectOnlyInputDiffers(split(inputs.key), keyFor(with("s.toml")));
}

TEST(State, KeysOfGrownClouds) {
  const BatchFolder folder;
  folder.write("in/b.csv", "0,0,0,1\n");
  const auto inputs = inputsFor(folder.manifest(
      "[[cloud]]\npreset = 'hero'\nseeds = [1, 2]\n[[cloud]]\npreset = 'toon'\nseeds = [1]\n[[cloud]]\nfrom_spheres = 'b.csv'\n"));
  ASSERT_EQ(inputs.size(), 4U);
  expectOnlySettingsDiffer(split(inputs[0].key), split(inputs[1].key));
  expectOnlyInputDiffers(split(inputs[0].key), split(inputs[2].key));
  EXPECT_TRUE(inputs[0].files.empty());
  EXPECT_EQ(inputs[3].files, std::vector<fs::path>{folder.in / "b.csv"});
}

TEST(State, UnreadableInputsHaveNoKey) {
  const BatchFolder folder;
  folder.box("a.obj");
  folder.box("b.obj");
  const BatchPlan plan = planBatch(folder.settings(), {});
  fs::remove(folder.in / "a.obj");
  const auto inputs = inputsOf(plan.assets, plan);
  EXPECT_EQ(inputs[0].key, "");
  EXPECT_EQ(inputs[1].key.size(), 64U);
}

// --- Records ---

const std::string kKey = std::string(16, 'b') + std::string(16, '5') + std::string(32, '1');

AssetRecord recordOf(const std::string& name, const std::string& glb, const std::string& key = kKey) {
  AssetRecord record;
  record.name = name;
  record.source = "a.obj";
  record.state = AssetState::kBaked;
  record.key = key;
  record.bytes = glb.size();
  record.output_hash = hashBytes(glb);
  return record;
}

TEST(State, StaleForTheFirstReasonThatHolds) {
  const BatchFolder folder;
  const auto reason = [&](const std::string& key) {
    return staleness(folder.out, "d/a.glb", key, readRecord(recordFile(folder.out, "d/a.glb")));
  };
  EXPECT_EQ(reason(kKey), "new");
  writeOutput(folder.out, recordOf("d/a.glb", "bytes"), "bytes");
  EXPECT_EQ(readFileBytes(folder.out / "d/a.glb"), "bytes");
  EXPECT_EQ(reason(kKey), "");
  const auto changed = [&](size_t at) {
    std::string key = kKey;
    key[at] = '0';
    return reason(key);
  };
  for (const size_t at : {0, 15}) EXPECT_EQ(changed(at), "another build");
  for (const size_t at : {16, 31}) EXPECT_EQ(changed(at), "settings changed");
  for (const size_t at : {32, 63}) EXPECT_EQ(changed(at), "input changed");
  EXPECT_EQ(reason("b"), "no record of its bake");
  folder.write("out/d/a.glb", "other");
  EXPECT_EQ(reason(kKey), "output is not what was written");
  fs::remove(folder.out / "d/a.glb");
  fs::create_directory(folder.out / "d/a.glb");
  EXPECT_EQ(reason(kKey), "output cannot be read");
  fs::remove(folder.out / "d/a.glb");
  EXPECT_EQ(reason(kKey), "new");
  folder.write("out/d/a.glb", "bytes");
  fs::remove(recordFile(folder.out, "d/a.glb"));
  EXPECT_EQ(reason(kKey), "no record of its bake");
}

TEST(State, RecordsReadBack) {
  const BatchFolder folder;
  AssetRecord record = recordOf("a.glb", "bytes");
  record.reason = "new";
  record.figures.emplace();
  record.figures->vertices = 12;
  writeOutput(folder.out, record, "bytes");
  EXPECT_EQ(recordFile(folder.out, "a.glb"), folder.out / ".cloudbake/a.glb.json");
  const auto back = readRecord(recordFile(folder.out, "a.glb"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->name + back->source + back->reason + back->key + back->output_hash,
            "a.glb"
            "a.obj"
            "new" +
                kKey + hashBytes("bytes"));
  EXPECT_EQ(back->bytes, 5U);
  ASSERT_TRUE(back->figures);
  EXPECT_EQ(back->figures->vertices, 12U);
}

TEST(State, DamagedRecordsAreNone) {
  const BatchFolder folder;
  BatchReport two;
  two.assets = {recordOf("a.glb", "a"), recordOf("b.glb", "b")};
  EXPECT_FALSE(readRecord(folder.write("r.json", batchJson(two))));
  two.assets.pop_back();
  const std::string one = batchJson(two);
  EXPECT_TRUE(readRecord(folder.write("r.json", one)));
  EXPECT_FALSE(readRecord(folder.write("r.json", one.substr(0, one.size() / 2))));
  EXPECT_FALSE(readRecord(folder.write("r.json", "")));
  EXPECT_FALSE(readRecord(folder.path / "no.json"));
}

// A picture of the asset before.
TEST(State, ANewOutputHasNoOldThumbnail) {
  const BatchFolder folder;
  writeOutput(folder.out, recordOf("d/a.glb", "1"), "1");
  folder.write("out/.cloudbake/d/a.glb.png", "picture");
  ASSERT_TRUE(fs::exists(thumbnailFile(folder.out, "d/a.glb")));
  writeOutput(folder.out, recordOf("d/a.glb", "2"), "2");
  EXPECT_FALSE(fs::exists(thumbnailFile(folder.out, "d/a.glb")));
}

// --- Cache ---

TEST(State, TheCacheGivesBackWhatWasAdded) {
  const BatchFolder folder;
  const AssetCache cache{folder.path / "cache"};
  std::string glb;
  EXPECT_FALSE(cache.find(kKey, glb));
  cache.add(recordOf("a.glb", "bytes"), "bytes");
  const fs::path stem = folder.path / "cache/11" / kKey;
  EXPECT_TRUE(fs::exists(stem.string() + ".glb") && fs::exists(stem.string() + ".json"));
  const auto found = cache.find(kKey, glb);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->source, "a.obj");
  EXPECT_EQ(glb, "bytes");
  const std::string other = kKey.substr(0, 63) + "2";
  EXPECT_FALSE(cache.find(other, glb));
}

TEST(State, DamagedEntriesOfTheCacheAreNone) {
  const BatchFolder folder;
  const AssetCache cache{folder.path / "cache"};
  std::string glb;
  const std::string stem = "cache/11/" + kKey;
  const auto add = [&] { cache.add(recordOf("a.glb", "bytes"), "bytes"); };
  add();
  folder.write(stem + ".glb", "Bytes");
  EXPECT_FALSE(cache.find(kKey, glb));
  add();
  fs::remove(folder.path / (stem + ".glb"));
  EXPECT_FALSE(cache.find(kKey, glb));
  add();
  fs::remove(folder.path / (stem + ".json"));
  EXPECT_FALSE(cache.find(kKey, glb));
  add();
  const std::string other = kKey.substr(0, 63) + "2";  // a record that was copied to the wrong place
  fs::copy(folder.path / (stem + ".json"), folder.path / "cache/11" / (other + ".json"));
  fs::copy(folder.path / (stem + ".glb"), folder.path / "cache/11" / (other + ".glb"));
  EXPECT_FALSE(cache.find(other, glb));
  EXPECT_TRUE(cache.find(kKey, glb));
}

// --- Outputs of earlier batches ---

TEST(State, PrunesWhatNoBatchAsksForAnyMore) {
  const BatchFolder folder;
  for (const char* name : {"kept.glb", "gone.glb", "deep/er/gone.glb", "changed.glb"}) writeOutput(folder.out, recordOf(name, name), name);
  folder.write("out/.cloudbake/gone.glb.png", "picture");
  folder.write("out/changed.glb", "by an artist");
  folder.write("out/theirs.glb", "never baked here");
  std::vector<PlannedAsset> kept(1);
  kept[0].name = "kept.glb";
  const Names gone{"deep/er/gone.glb", "gone.glb"};
  EXPECT_EQ(outputsToPrune(folder.out, kept), gone);
  EXPECT_TRUE(fs::exists(folder.out / "gone.glb")) << "it only lists";
  EXPECT_EQ(pruneOutputs(folder.out, kept), gone);
  for (const char* name : {"kept.glb", "changed.glb", "theirs.glb", ".cloudbake/kept.glb.json"})
    EXPECT_TRUE(fs::exists(folder.out / name)) << name;
  for (const char* name :
       {"gone.glb", "deep", ".cloudbake/deep", ".cloudbake/gone.glb.json", ".cloudbake/gone.glb.png", ".cloudbake/changed.glb.json"})
    EXPECT_FALSE(fs::exists(folder.out / name)) << name;
  EXPECT_EQ(outputsToPrune(folder.out, kept), Names{});
  EXPECT_EQ(pruneOutputs(folder.path / "no", kept), Names{});
}

// --- The lock ---

int codeOfLock(const fs::path& output, int shard, int shards) {
  try {
    const OutputLock lock(output, shard, shards);
  } catch (const Error& error) {
    return int(error.code);
  }
  return 0;
}

TEST(State, OneBatchAtATime) {
  const BatchFolder folder;
  {
    const OutputLock lock(folder.out, 0, 0);
    expectError<Error>([&] { const OutputLock second(folder.out, 0, 0); },
                       folder.out.string() + ": another batch is writing to this folder");
    EXPECT_EQ(codeOfLock(folder.out, 0, 0), int(ExitCode::kTryAgain));
    EXPECT_EQ(codeOfLock(folder.out, 1, 2), int(ExitCode::kTryAgain));
    EXPECT_EQ(codeOfLock(folder.path / "other", 0, 0), 0);
  }
  EXPECT_EQ(codeOfLock(folder.out, 0, 0), 0);
}

TEST(State, ShardsShareAFolder) {
  const BatchFolder folder;
  {
    const OutputLock first(folder.out, 1, 2);
    EXPECT_EQ(codeOfLock(folder.out, 2, 2), 0);
    EXPECT_EQ(codeOfLock(folder.out, 1, 2), int(ExitCode::kTryAgain));
    EXPECT_EQ(codeOfLock(folder.out, 0, 0), int(ExitCode::kTryAgain));
  }
  EXPECT_EQ(codeOfLock(folder.out, 0, 0), 0) << "the shard that was refused has let go too";
}

TEST(State, ALockThatCannotBeWritten) {
  const BatchFolder folder;
  fs::create_directories(folder.out / ".cloudbake/lock");
  expectError<IoError>([&] { const OutputLock lock(folder.out, 0, 0); }, "cannot write: ");
}

}  // namespace
}  // namespace cloudbake
