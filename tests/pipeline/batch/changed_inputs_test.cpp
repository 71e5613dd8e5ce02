// Files that somebody saves while a batch runs. Whenever that happens, an asset is made of one version of its inputs, and recorded as such.
#include <functional>

#include "bake/field/level_set.h"
#include "io/sculpt/referenced_files.h"
#include "io/volume/vdb.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/pipeline/batch/batch_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

struct Made {
  AssetRecord record;
  AssetInputs inputs;
  std::string glb;
};

// A whole run of a batch of one asset, which reads its files so.
Made make(const Settings& settings, const FileReader& read_file = readFileBytes) {
  Settings own = settings;
  own.source.read.read_file = read_file;
  const BatchPlan plan = planBatch(own, fewRays());
  auto inputs = inputsOf(plan.assets, plan, read_file);
  auto records = judgeAssets(plan.assets, inputs, own);
  std::atomic<int> stop{0};
  Listener listener;
  runAssets(plan.assets, inputs, plan, own, stop, listener, records);
  EXPECT_EQ(records.size(), 1U);
  const fs::path file = own.output.file / records[0].name;
  return {records[0], inputs[0], fs::exists(file) ? readFileBytes(file) : ""};
}

std::string stateOf(const AssetRecord& record) { return std::string(stateName(record.state)) + " " + record.reason; }

// An asset with a file that is saved meanwhile.
struct Case {
  std::string name;
  std::string manifest;
  std::vector<std::pair<std::string, std::string>> others{};  // files that stay
  std::string file, old_bytes, new_bytes;
  int reads_to_judge = 1;  // before the asset is made
};

std::string gltfOf(const std::string& buffer) {
  return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "buffers": [{"uri": ")" + buffer +
         R"(", "byteLength": 72}], "images": [{"uri": "t.png"}], "textures": [{"source": 0}],
    "materials": [{"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}}}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [9, 9, 9]},
                  {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}]})";
}

// The buffer of such a document: a tetrahedron of this height.
std::string bufferOf(float height) {
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, height, 0}, {0, 0, 1}};
  const std::vector<uint16_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  return std::string(reinterpret_cast<const char*>(positions.data()), 48) + std::string(reinterpret_cast<const char*>(indices.data()), 24);
}

std::string objOf(float height) { return "mtllib m.mtl\nusemtl a\n" + objText(boxMesh({0, 0, 0}, {1, height, 1})); }

std::string volumeOf(float radius) {
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxels = 16;
  return encodeVdb(levelSetFromMesh(ballMesh(radius, 2), settings, warnings));
}

std::string recipeOf(const std::string& premise) { return "premise = '" + premise + "'\n[spheres]\nsize = 0.7\n"; }

std::vector<Case> cases() {
  const std::string gltf = "[[cloud]]\nsculpt = 's.gltf'\n", obj = "[[cloud]]\nsculpt = 's.obj'\n";
  const std::vector<std::pair<std::string, std::string>> of_gltf{
      {"s.gltf", gltfOf("b.bin")}, {"b.bin", bufferOf(1)}, {"new.bin", bufferOf(2)}, {"t.png", kPng}};
  const std::vector<std::pair<std::string, std::string>> of_obj{
      {"s.obj", objOf(1)}, {"m.mtl", "newmtl a\nmap_Kd t.png\n"}, {"t.png", kPng}, {"new.png", kPng + "new"}};
  return {
      {"sculpt", obj, of_obj, "s.obj", objOf(1), objOf(2)},
      {"sculpt that names another buffer", gltf, of_gltf, "s.gltf", gltfOf("b.bin"), gltfOf("new.bin")},
      {"buffer", gltf, of_gltf, "b.bin", bufferOf(1), bufferOf(3)},
      {"texture of a glTF", gltf, of_gltf, "t.png", kPng, kPng + "new"},
      {"texture of an OBJ", obj, of_obj, "t.png", kPng, kPng + "new"},
      {"texture that is removed", obj, of_obj, "t.png", kPng, ""},
      {"texture that appears", obj, of_obj, "t.png", "", kPng},
      {"texture of a foreign sculpt", "[[cloud]]\nsculpt = 's.dae'\n", {{"s.dae", texturedDae()}}, "skin.png", kPng, kPng + "new"},
      {"material library", obj, of_obj, "m.mtl", "newmtl a\nmap_Kd t.png\n", "newmtl a\nmap_Kd new.png\n", 2},
      {"recipe", "[[cloud]]\nrecipe = 'r.toml'\n", {}, "r.toml", recipeOf("F"), recipeOf("FF")},
      {"rules", "[[cloud]]\nrules = 'r.txt'\n", {}, "r.txt", "premise: F\n", "premise: FF\n"},
      {"spheres", "[[cloud]]\nfrom_spheres = 's.csv'\n", {}, "s.csv", "0,0,0,1\n", "0,0,0,1\n1,0,0,1\n"},
      {"volume", "[[cloud]]\nsculpt = 'v.vdb'\n", {}, "v.vdb", volumeOf(1), volumeOf(2)},
      {"scene", "[[cloud]]\nsculpt = 's.obj'\nscene = 'view.toml'\nlobe = 'fit'\n", of_obj, "view.toml",
       "[camera]\ndistance = 5\n[sun]\nelevation = [5, 60]\n", "[camera]\ndistance = 5\n[sun]\nelevation = [70, 80]\n", 2},
  };
}

// No bytes: no file.
void save(const BatchFolder& folder, const std::string& name, const std::string& bytes) {
  if (bytes.empty())
    fs::remove(folder.in / name);
  else
    folder.write("in/" + name, bytes);
}

// The file is saved after each of its reads in turn. The asset is that of the last save before it was made, in all its bytes and by its
// key; the next run finds it fresh if that was the last save of all.
TEST(ChangedInputs, AnAssetIsMadeOfOneVersion) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const BatchFolder folder;
    for (const auto& [name, bytes] : one.others) folder.write("in/" + name, bytes);
    const Settings settings = folder.manifest(one.manifest);
    const auto clean = [&](const std::string& bytes) {
      save(folder, one.file, bytes);
      fs::remove_all(folder.out);
      Made made = make(settings);
      EXPECT_EQ(stateOf(made.record), "baked new") << made.record.error;
      return made;
    };
    const Made of_old = clean(one.old_bytes), of_new = clean(one.new_bytes);
    ASSERT_NE(of_old.glb, of_new.glb);
    ASSERT_NE(of_old.record.key, of_new.record.key);
    ASSERT_EQ(of_new.record.key.size(), 64U) << "all that was read is in the key";

    for (int after = 1;; ++after) {
      SCOPED_TRACE(after);
      save(folder, one.file, one.old_bytes);
      fs::remove_all(folder.out);
      std::atomic<int> reads{0};
      const Made made = make(settings, [&](const fs::path& file) {
        const bool is_target = file.filename() == one.file;
        const auto saved = [&] {
          if (is_target && ++reads == after) save(folder, one.file, one.new_bytes);
        };
        try {
          std::string bytes = readFileBytes(file);
          saved();
          return bytes;
        } catch (const IoError&) {
          saved();
          throw;
        }
      });
      if (reads < after) {
        EXPECT_EQ(after, one.reads_to_judge + 2) << "an asset reads each file once, after it was judged";
        break;
      }
      const bool is_new = after <= one.reads_to_judge;
      const Made& expected = is_new ? of_new : of_old;
      EXPECT_EQ(stateOf(made.record), "baked new") << made.record.error;
      EXPECT_EQ(made.glb == expected.glb, true);
      EXPECT_EQ(made.record.key, expected.record.key);
      EXPECT_EQ(made.inputs.files, expected.inputs.files);
      EXPECT_EQ(readRecord(recordFile(folder.out, made.record.name))->key, expected.record.key);
      const Made next = make(settings);
      EXPECT_EQ(stateOf(next.record), is_new ? "fresh " : "baked input changed");
      EXPECT_EQ(next.glb == of_new.glb, true);
    }
  }
}

// A sculpt that is gone when it is to be baked fails; one that goes after it was read is baked.
TEST(ChangedInputs, ASculptThatIsRemoved) {
  for (int after = 1; after <= 2; ++after) {
    const BatchFolder folder;
    folder.box("a.obj");
    int reads = 0;
    const Made made = make(folder.settings(), [&](const fs::path& file) {
      std::string bytes = readFileBytes(file);
      if (++reads == after) fs::remove(file);
      return bytes;
    });
    EXPECT_EQ(stateOf(made.record), after == 1 ? "failed new" : "baked new");
    EXPECT_EQ(made.record.code, int(after == 1 ? ExitCode::kSystem : ExitCode::kDone));
  }
}

// What the key does not cover makes no record that would count as fresh, and no entry of the cache.
TEST(ChangedInputs, AFileThatNothingListsIsNotKept) {
  const BatchFolder folder;
  std::string dae = texturedDae();
  dae.replace(dae.find("skin.png"), 8, "sk&#105;n.png");  // only a parser of XML sees the name
  folder.write("in/s.dae", dae);
  const fs::path skin = folder.write("in/skin.png", kPng);
  ASSERT_TRUE(referencedFiles(folder.in / "s.dae", dae, {}).empty());
  Settings settings = folder.settings();
  settings.batch.cache = folder.path / "cache";
  const Made first = make(settings);
  EXPECT_EQ(stateOf(first.record), "baked new") << first.record.error;
  EXPECT_EQ(first.record.key, "");
  EXPECT_EQ(first.inputs.files, (std::vector<fs::path>{folder.in / "s.dae", skin})) << "the depfile has it";
  EXPECT_FALSE(fs::exists(folder.path / "cache"));
  folder.write("in/skin.png", kPng + "new");
  const Made second = make(settings);
  EXPECT_EQ(stateOf(second.record), "baked no record of its bake");
  EXPECT_NE(second.glb, first.glb);
}

}  // namespace
}  // namespace cloudbake
