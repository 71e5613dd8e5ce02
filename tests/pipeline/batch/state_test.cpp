// What decides whether an asset is baked again, and what is kept of it.
#include "pipeline/batch/state.h"

#include <map>

#include "bake/mesh/repair.h"
#include "tests/pipeline/batch/batch_helpers.h"
#include "tests/pipeline/option_samples.h"
#include "tests/pipeline/settings_text.h"

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

// A batch with a cloud of every kind. The volume is no volume: a key needs its bytes only.
Settings everyKind(const BatchFolder& folder) {
  folder.box("a.obj");
  folder.write("in/b.csv", "0,0,0,1\n");
  folder.write("in/v.vdb", "volume");
  return folder.manifest("[[cloud]]\npreset = 'puffball'\n[[cloud]]\nfrom_spheres = 'b.csv'\n[[cloud]]\nsculpt = ['a.obj', 'v.vdb']\n");
}

// The key of every asset, with the bits of its kind.
std::map<std::string, std::pair<unsigned, Key>> keysOf(const Settings& settings, const std::vector<Given>& given) {
  const BatchPlan plan = planBatch(settings, given);
  const std::vector<AssetInputs> inputs = inputsOf(plan.assets, plan);
  std::map<std::string, std::pair<unsigned, Key>> keys;
  for (size_t i = 0; i < inputs.size(); ++i)
    keys[plan.assets[i].name] = {unsigned(inputBit(plan.assets[i].from.kind)), split(inputs[i].key)};
  return keys;
}

// What the settings say about the asset alone, and about the run around it.
std::string assetText(const Settings& s) {
  return textOf(s.source) + textOf(s.mesh) + textOf(s.field) + textOf(s.lobe) + textOf(s.output) + textOf(s.scene);
}
std::string runText(const Settings& s) { return textOf(s.judge) + textOf(s.batch) + textOf(s.run); }

// Options that are accepted only beside another one.
std::vector<Given> companionsOf(const Option& option) {
  const std::vector<std::string> rays{"method=rays"}, fit{"lobe=fit"}, volume{"lobe=fit", "fit-to=volume"};
  const std::map<std::string_view, std::vector<std::string>> companions{{"sampler", rays},
                                                                        {"fixed-directions", rays},
                                                                        {"quadrature", rays},
                                                                        {"steps", rays},
                                                                        {"exponent", fit},
                                                                        {"bias", fit},
                                                                        {"extinction", fit},
                                                                        {"sun-arc", fit},
                                                                        {"fit-to", fit},
                                                                        {"octaves", volume},
                                                                        {"view-extinction", volume},
                                                                        {"phase", volume},
                                                                        {"noise-size", {"noise=3%"}},
                                                                        {"pack-as", {"pack=8"}}};
  const auto found = companions.find(option.name);
  return found == companions.end() ? std::vector<Given>{} : options(found->second, kBatch);
}

// Every option that says something about an asset is part of the key of each asset that it applies to, with its value. --strict is as well,
// because a batch that demands it must not take an asset that was made with warnings. Which options these are follows from what they set.
TEST(State, KeysChangeWithEveryOptionOfAnAsset) {
  const BatchFolder folder;
  const Settings settings = everyKind(folder);
  folder.write("view.toml", "[camera]\ndistance = 5\n");
  folder.write("other.toml", "[camera]\ndistance = 6\n");
  const std::string unset = assetText(Settings());
  size_t found = 0, parts = 0;
  for (const Option& option : optionTable()) {
    const std::string_view name = option.name;
    if (!(option.commands & kBatch) || name == "dry-run") continue;  // --dry-run bakes nothing
    if (!hasCgal() && (name == "remesh" || name == "repair" || name == "inspect" || name == "close")) continue;
    const Samples samples = samplesOf(option);
    if (option.value.set) {
      Settings alone;
      option.value.set(alone, option, samples.one);
      if (assetText(alone) == unset && name != "strict") continue;
    }
    ++found;
    EXPECT_EQ(findAssetOption(name), &option) << "--" << name << " is about an asset, but it is not passed on to the assets of a batch";
    const auto keysWith = [&](const std::string& value) {
      std::vector<Given> given = companionsOf(option);
      if (!value.empty()) given.push_back({&option, name == "scene" ? (folder.path / value).string() : value, "", 0, 0});
      return keysOf(settings, given);
    };
    const auto without = keysWith(""), one = keysWith(samples.one), other = keysWith(samples.other);
    ASSERT_EQ(one.size(), 4U);
    for (const auto& [asset, kind_and_key] : without) {
      const auto& [kind, key] = kind_and_key;
      const Key &with_one = one.at(asset).second, &with_other = other.at(asset).second;
      const std::string label = "--" + std::string(name) + " for " + asset;
      if (!(option.inputs & kind)) {
        EXPECT_TRUE(with_one.settings == key.settings && with_one.input == key.input) << label << " has no effect";
      } else if (name == "scene") {  // its bytes count as an input
        EXPECT_NE(with_one.input, with_other.input) << label;
        EXPECT_NE(with_one.input, key.input) << label;
      } else {
        EXPECT_NE(with_one.settings, key.settings) << label << " " << samples.one;
        EXPECT_NE(with_one.settings, with_other.settings) << label << " " << samples.other;
        EXPECT_EQ(with_one.input, key.input) << label;
      }
    }
    for (const std::string& value : withOneNumberChanged(samples.one)) {
      ++parts;
      for (const auto& [asset, kind_and_key] : keysWith(value))
        if (option.inputs & kind_and_key.first) {
          EXPECT_NE(kind_and_key.second.settings, one.at(asset).second.settings) << "--" << name << " " << value << " for " << asset;
        }
    }
  }
  EXPECT_EQ(parts, 17U) << "sun-arc, extinction, lods, start-position, start-rotation and domain";
  EXPECT_GT(found, 80U);
}

// What an option says about the run alone, such as threads, memory, reports and bounds, leaves every asset as fresh as it was.
TEST(State, KeysStayWithEveryOptionOfTheRun) {
  const BatchFolder folder;
  const Settings settings = everyKind(folder);
  const auto before = keysOf(settings, {});
  const std::set<std::string_view> others{"input-list"};  // another batch
  const std::string no_asset = assetText(Settings()), no_run = runText(Settings());
  std::set<std::string_view> met;
  for (const Option& option : optionTable()) {
    const std::string_view name = option.name;
    if (!(option.commands & kBatch) || !option.value.set || others.contains(name) || name == "strict") continue;
    Settings alone;
    option.value.set(alone, option, samplesOf(option).one);
    const bool of_asset = assetText(alone) != no_asset && name != "dry-run";
    EXPECT_TRUE(of_asset || runText(alone) != no_run) << "--" << name << " sets nothing that a batch knows: these tests need a rule for it";
    if (of_asset) continue;
    met.insert(name);
    EXPECT_EQ(findAssetOption(name), nullptr) << "--" << name << " is about the run, but it is passed on to the assets of a batch";
    for (const std::string& value : {samplesOf(option).one, samplesOf(option).other}) {
      Settings changed = settings;
      option.value.set(changed, option, name == "name" ? "{stem}.glb" : value);
      const auto after = keysOf(changed, {});
      ASSERT_EQ(after.size(), before.size()) << name;
      for (const auto& [asset, kind_and_key] : before) {
        EXPECT_EQ(after.at(asset).second.settings, kind_and_key.second.settings) << "--" << name << " " << value;
        EXPECT_EQ(after.at(asset).second.input, kind_and_key.second.input) << "--" << name << " " << value;
      }
    }
  }
  for (const char* name : {"threads", "json", "memory", "cache", "html", "junit", "max-angle", "truth-vertices", "force", "shard"})
    EXPECT_TRUE(met.contains(name)) << name;
}

// What a bake takes from the scene of a manifest: the size of a pixel and the sun. Each of them counts, one at a time.
TEST(State, KeysChangeWithWhatABakeTakesFromTheScene) {
  const BatchFolder folder;
  folder.box("a.obj");
  BatchPlan plan = planBatch(folder.settings(), {});
  const auto keyOf = [&](const SceneNeeds& scene) {
    plan.scene = scene;
    return split(inputsOf(plan.assets, plan).at(0).key);
  };
  const Box box = boundingBox(boxMesh({0, 0, 0}, {1, 2, 3}));
  SceneNeeds framed;
  framed.sun_arc = SunArc{5, 60, 80, 100};
  const Key before = keyOf(framed);

  // Options of the previewer, because a scene has the same camera: those that change the size of a pixel.
  std::set<std::string_view> counted;
  for (const Option& option : optionTable()) {
    if (!(option.commands & kPreview) || !option.value.set) continue;
    Settings settings;
    option.value.set(settings, option, samplesOf(option).one);
    SceneNeeds changed = framed;
    changed.view = settings.picture;
    if (pixelSize(changed, box) == pixelSize(framed, box)) continue;
    counted.insert(option.name);
    expectOnlySettingsDiffer(before, keyOf(changed));
  }
  EXPECT_EQ(counted, (std::set<std::string_view>{"camera", "size", "fov"}));

  using Change = void (*)(SceneNeeds & scene);
  const std::map<std::string, Change> changes{
      {"no sun", [](SceneNeeds& s) { s.sun_arc.reset(); }},
      {"lowest elevation", [](SceneNeeds& s) { s.sun_arc->elevation_low_degrees = 6; }},
      {"highest elevation", [](SceneNeeds& s) { s.sun_arc->elevation_high_degrees = 61; }},
      {"first azimuth", [](SceneNeeds& s) { s.sun_arc->azimuth_low_degrees = 81; }},
      {"last azimuth", [](SceneNeeds& s) { s.sun_arc->azimuth_high_degrees = 101; }},
      {"distance", [](SceneNeeds& s) { s.camera_distance = 7; }},
      {"field of view", [](SceneNeeds& s) { s.view.field_of_view_degrees = 36; }},
      {"width", [](SceneNeeds& s) { s.view.width = 400; }},
      {"height", [](SceneNeeds& s) { s.view.height = 400; }},
      {"azimuth of the camera", [](SceneNeeds& s) { s.view.camera_azimuth_degrees = 40; }},
      {"elevation of the camera", [](SceneNeeds& s) { s.view.camera_elevation_degrees = 40; }},
      {"extinction along the view", [](SceneNeeds& s) { s.volume.view_extinction = 2; }},
      {"phase", [](SceneNeeds& s) { s.volume.asymmetry = 0.5F; }},
      {"octaves", [](SceneNeeds& s) { s.volume.octaves = OctaveSettings{3}; }},
      {"extinction of octaves",
       [](SceneNeeds& s) {
         s.volume.octaves = OctaveSettings{3, 0.4F};
       }},
      {"contribution of octaves",
       [](SceneNeeds& s) {
         s.volume.octaves = OctaveSettings{3, 0.4F, 0.3F};
       }},
  };
  std::map<std::string, std::string> seen{{before.settings, "the scene as it was"}};
  for (const auto& [name, change] : changes) {
    SceneNeeds changed = framed;
    change(changed);
    const Key after = keyOf(changed);
    EXPECT_EQ(after.input, before.input);
    const auto [at, is_new] = seen.emplace(after.settings, name);
    EXPECT_TRUE(is_new) << name << " has the key of " << at->second;
  }
  // A new field of the scene or of its sun needs a row above.
  [[maybe_unused]] const auto& [view, camera_distance, sun_arc, volume] = framed;
  [[maybe_unused]] const auto& [low, high, first, last] = *sun_arc;
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

// With --allow-outside, a sculpt may name files outside its own folder. They count then, and only then.
TEST(State, KeysChangeWithFilesOutsideTheFolderWhereTheyAreAllowed) {
  const BatchFolder folder;
  folder.write("in/a.obj", "mtllib ../outside.mtl\n" + kTetrahedronObj);
  folder.write("outside.mtl", "newmtl red\nKd 1 0 0\n");
  const auto keys = [&] { return std::pair(keyFor(folder.settings()), keyFor(folder.settings(), options({"allow-outside"}))); };
  const auto [shut, open] = keys();
  folder.write("outside.mtl", "newmtl red\nKd 0 0 1\n");
  const auto [shut_later, open_later] = keys();
  EXPECT_EQ(shut.input, shut_later.input);
  expectOnlyInputDiffers(open, open_later);
  const std::string cloud = "[[cloud]]\nsculpt = 'a.obj'\n";
  EXPECT_EQ(inputsFor(folder.manifest(cloud)).at(0).files.size(), 1U);
  EXPECT_EQ(inputsFor(folder.manifest(cloud + "allow_outside = true\n")).at(0).files.size(), 2U);
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
  writeOutput(folder.out, recordOf("d/a.glb", "bytes"), {"bytes", {}});
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
  writeOutput(folder.out, record, {"bytes", {}});
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
  writeOutput(folder.out, recordOf("d/a.glb", "1"), {"1", {}});
  folder.write("out/.cloudbake/d/a.glb.jpg", "picture");
  folder.write("out/.cloudbake/d/a.glb.png", "picture of an earlier version");
  ASSERT_TRUE(fs::exists(thumbnailFile(folder.out, "d/a.glb")));
  writeOutput(folder.out, recordOf("d/a.glb", "2"), {"2", {}});
  EXPECT_FALSE(fs::exists(thumbnailFile(folder.out, "d/a.glb")));
  EXPECT_FALSE(fs::exists(folder.out / ".cloudbake/d/a.glb.png"));
}

// --- Cache ---

TEST(State, TheCacheGivesBackWhatWasAdded) {
  const BatchFolder folder;
  const AssetCache cache{folder.path / "cache"};
  AssetBytes bytes;
  EXPECT_FALSE(cache.find(kKey, bytes));
  cache.add(recordOf("a.glb", "bytes"), {"bytes", {}});
  const fs::path stem = folder.path / "cache/11" / kKey;
  EXPECT_TRUE(fs::exists(stem.string() + ".glb") && fs::exists(stem.string() + ".json"));
  const auto found = cache.find(kKey, bytes);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->source, "a.obj");
  EXPECT_EQ(bytes.glb, "bytes");
  const std::string other = kKey.substr(0, 63) + "2";
  EXPECT_FALSE(cache.find(other, bytes));
}

TEST(State, DamagedEntriesOfTheCacheAreNone) {
  const BatchFolder folder;
  const AssetCache cache{folder.path / "cache"};
  AssetBytes bytes;
  const std::string stem = "cache/11/" + kKey;
  const auto add = [&] { cache.add(recordOf("a.glb", "bytes"), {"bytes", {}}); };
  add();
  folder.write(stem + ".glb", "Bytes");
  EXPECT_FALSE(cache.find(kKey, bytes));
  add();
  fs::remove(folder.path / (stem + ".glb"));
  EXPECT_FALSE(cache.find(kKey, bytes));
  add();
  fs::remove(folder.path / (stem + ".json"));
  EXPECT_FALSE(cache.find(kKey, bytes));
  add();
  const std::string other = kKey.substr(0, 63) + "2";  // a record that was copied to the wrong place
  fs::copy(folder.path / (stem + ".json"), folder.path / "cache/11" / (other + ".json"));
  fs::copy(folder.path / (stem + ".glb"), folder.path / "cache/11" / (other + ".glb"));
  EXPECT_FALSE(cache.find(other, bytes));
  EXPECT_TRUE(cache.find(kKey, bytes));
}

// --- Outputs of earlier batches ---

// A live view is one of the output only until that is written again, and only as it was written.
TEST(State, LiveViewsOfOutputs) {
  const BatchFolder folder;
  EXPECT_EQ(liveViewName("deep.er/a.b.GLB"), "deep.er/a.b.html");
  writeOutput(folder.out, recordOf("a.glb", "a"), {"a", {}});
  EXPECT_FALSE(hasLiveView(folder.out, "a.glb"));
  writeLiveView(folder.out, "a.glb", "page");
  EXPECT_TRUE(hasLiveView(folder.out, "a.glb"));
  folder.write("out/a.html", "pag");
  EXPECT_FALSE(hasLiveView(folder.out, "a.glb"));
  folder.write("out/a.html", "page");
  EXPECT_TRUE(hasLiveView(folder.out, "a.glb"));
  writeOutput(folder.out, recordOf("a.glb", "a"), {"a", {}});
  EXPECT_FALSE(hasLiveView(folder.out, "a.glb"));
  EXPECT_EQ(readFileBytes(folder.out / "a.html"), "page") << "until there is a new one";
}

TEST(State, PrunesWhatNoBatchAsksForAnyMore) {
  const BatchFolder folder;
  for (const char* name : {"kept.glb", "gone.glb", "deep/er/gone.glb", "changed.glb"})
    writeOutput(folder.out, recordOf(name, name), {name, {}});
  folder.write("out/.cloudbake/gone.glb.jpg", "picture");
  for (const char* name : {"kept.glb", "gone.glb", "changed.glb"}) writeLiveView(folder.out, name, "page");
  folder.write("out/changed.glb", "by an artist");
  folder.write("out/changed.html", "by an artist");
  folder.write("out/theirs.glb", "never baked here");
  std::vector<PlannedAsset> kept(1);
  kept[0].name = "kept.glb";
  const Names gone{"deep/er/gone.glb", "gone.glb", "gone.html"};
  EXPECT_EQ(outputsToPrune(folder.out, kept), gone);
  EXPECT_TRUE(fs::exists(folder.out / "gone.glb")) << "it only lists";
  EXPECT_EQ(pruneOutputs(folder.out, kept), gone);
  for (const char* name : {"kept.glb", "kept.html", "changed.glb", "changed.html", "theirs.glb", ".cloudbake/kept.glb.json"})
    EXPECT_TRUE(fs::exists(folder.out / name)) << name;
  EXPECT_TRUE(hasLiveView(folder.out, "kept.glb"));
  for (const char* name : {"gone.glb", "gone.html", "deep", ".cloudbake/deep", ".cloudbake/gone.glb.json", ".cloudbake/gone.glb.jpg",
                           ".cloudbake/gone.glb.live", ".cloudbake/changed.glb.json", ".cloudbake/changed.glb.live"})
    EXPECT_FALSE(fs::exists(folder.out / name)) << name;
  EXPECT_EQ(outputsToPrune(folder.out, kept), Names{});
  EXPECT_EQ(pruneOutputs(folder.path / "no", kept), Names{});
}

// --- Levels of detail ---

const AssetBytes kLeveled{"full", {"half", "tenth"}};

AssetRecord leveledRecord(const std::string& name = "d/a.glb") {
  AssetRecord record = recordOf(name, kLeveled.glb);
  for (const std::string& level : kLeveled.levels) record.level_hashes.push_back(hashBytes(level));
  return record;
}

TEST(StateLevels, AreOutputsLikeTheAsset) {
  const BatchFolder folder;
  const auto reason = [&] { return staleness(folder.out, "d/a.glb", kKey, readRecord(recordFile(folder.out, "d/a.glb"))); };
  writeOutput(folder.out, leveledRecord(), kLeveled);
  EXPECT_EQ(readFileBytes(folder.out / "d/a_lod1.glb"), "half");
  EXPECT_EQ(readFileBytes(folder.out / "d/a_lod2.glb"), "tenth");
  EXPECT_EQ(reason(), "");
  folder.write("out/d/a_lod2.glb", "other");
  EXPECT_EQ(reason(), "output is not what was written");
  writeOutput(folder.out, leveledRecord(), kLeveled);
  EXPECT_EQ(reason(), "");
  fs::remove(folder.out / "d/a_lod1.glb");
  EXPECT_EQ(reason(), "output is not what was written");
}

TEST(StateLevels, ThatAnAssetHasNoMoreAreRemoved) {
  const BatchFolder folder;
  writeOutput(folder.out, leveledRecord(), kLeveled);
  AssetRecord one = leveledRecord();
  one.level_hashes.pop_back();
  writeOutput(folder.out, one, {"full", {"half"}});
  EXPECT_TRUE(fs::exists(folder.out / "d/a_lod1.glb"));
  EXPECT_FALSE(fs::exists(folder.out / "d/a_lod2.glb"));
  folder.write("out/d/a_lod1.glb", "by an artist");
  writeOutput(folder.out, recordOf("d/a.glb", "full"), {"full", {}});
  EXPECT_TRUE(fs::exists(folder.out / "d/a_lod1.glb"));
}

TEST(StateLevels, ArePrunedWithTheAsset) {
  const BatchFolder folder;
  writeOutput(folder.out, leveledRecord("a.glb"), kLeveled);
  writeOutput(folder.out, leveledRecord("b.glb"), kLeveled);
  folder.write("out/b_lod1.glb", "by an artist");
  const Names gone{"a.glb", "a_lod1.glb", "a_lod2.glb", "b.glb", "b_lod2.glb"};
  EXPECT_EQ(outputsToPrune(folder.out, {}), gone);
  EXPECT_EQ(pruneOutputs(folder.out, {}), gone);
  EXPECT_TRUE(fs::exists(folder.out / "b_lod1.glb"));
  EXPECT_FALSE(fs::exists(folder.out / "a_lod2.glb"));
}

// JSON holds another name than the file system if that is not UTF-8.
TEST(StateLevels, OfNamesThatAreNotUtf8) {
  const BatchFolder folder;
  const std::string name = "w\xE4lk.glb";
  writeOutput(folder.out, leveledRecord(name), kLeveled);
  const auto record = readRecord(recordFile(folder.out, name));
  ASSERT_TRUE(record);
  EXPECT_EQ(staleness(folder.out, name, kKey, record), "");
  writeOutput(folder.out, recordOf(name, "full"), {"full", {}});
  EXPECT_FALSE(fs::exists(folder.out / "w\xE4lk_lod2.glb")) << "a level that the asset has no more";
  writeOutput(folder.out, leveledRecord(name), kLeveled);
  EXPECT_EQ(pruneOutputs(folder.out, {}), (Names{name, "w\xE4lk_lod1.glb", "w\xE4lk_lod2.glb"}));
  EXPECT_FALSE(fs::exists(folder.out / "w\xE4lk_lod1.glb"));
}

TEST(StateLevels, AreInTheCache) {
  const BatchFolder folder;
  const AssetCache cache{folder.path / "cache"};
  AssetBytes bytes;
  cache.add(leveledRecord(), kLeveled);
  ASSERT_TRUE(cache.find(kKey, bytes));
  EXPECT_EQ(bytes.glb, kLeveled.glb);
  EXPECT_EQ(bytes.levels, kLeveled.levels);
  folder.write("cache/11/" + kKey + "_lod2.glb", "other");
  EXPECT_FALSE(cache.find(kKey, bytes));
  cache.add(leveledRecord(), kLeveled);
  fs::remove(folder.path / ("cache/11/" + kKey + "_lod1.glb"));
  EXPECT_FALSE(cache.find(kKey, bytes));
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
