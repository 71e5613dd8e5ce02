// Plans of scenes: their files draw what they promise.
#include "pipeline/plan/plan.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "io/gltf/impostor/impostor_file.h"
#include "io/image/image.h"
#include "pipeline/library/cloudbake.h"
#include "pipeline/picture/picture.h"
#include "preview/compare/image_error.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

constexpr const char* kView = "[picture]\nwidth = 240\nheight = 160\n[camera]\nposition = [0, 2, 14]\ntarget = [0, 2, 0]\nfov = 50\n";

// The assets, and what the cache keeps of them, are the same for all tests.
class PlanTest : public testing::Test {
 protected:
  PlanTest() {
    static const TestFolder shared;
    cache_ = shared.path / "cache";
    setenv("XDG_CACHE_HOME", cache_.c_str(), 1);
    for (const char* name : {"humilis", "hero"}) {
      const fs::path asset = shared.path / (std::string(name) + ".glb");
      if (!fs::exists(asset)) writeFileAtomically(asset, grow(name, {{"vertices", "1000"}}).glb);
      fs::copy_file(asset, file(asset.filename()));
    }
  }
  ~PlanTest() override { unsetenv("XDG_CACHE_HOME"); }

  fs::path file(const std::string& name) const { return folder_.path / name; }

  // Clouds at growing distances.
  std::string clouds(int count) const {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += std::string("[[cloud]]\nfile = \"") + (i % 2 ? "hero" : "humilis") + ".glb\"\nposition = [" +
              std::to_string(3 * (i % 5) - 6) + ", " + std::to_string(1 + i % 3) + ", " + std::to_string(4 - 6 * i) + "]\nrotation = [0, " +
              std::to_string(40 * i) + ", 0]\n";
    return text;
  }

  ScenePlan planned(const std::string& scene, const std::vector<std::string>& texts = {}) {
    writeFileAtomically(file("scene.toml"), scene);
    const std::vector<Given> given = options(texts, kPlan);
    Settings settings = resolve(sourceOf(SourceKind::kRecipe, file("scene.toml")), given);
    settings.scene = file("scene.toml");
    settings.output.file = file("planned");
    BakeReport report;
    Stopwatch watch;
    return planScene(settings, given, report, watch);
  }

  static void write(const ScenePlan& plan) {
    for (const ScenePlan::File& one : plan.files) {
      createFolder(one.file.parent_path());
      writeFileAtomically(one.file, one.bytes);
    }
    for (const fs::path& stale : plan.stale) fs::remove(stale);
  }

  static Image drawn(const fs::path& scene) {
    const std::vector<Given> given = options({"scene=" + scene.string()}, kPreview);
    BakeReport report;
    StageSeconds seconds;
    return stillPicture(readScenery(resolve(sourceOf(SourceKind::kSculpt), given), given, report), seconds);
  }

  TestFolder folder_;
  fs::path cache_;
};

TEST_F(PlanTest, TheWrittenSceneDrawsWhatWasMeasured) {
  for (const std::string look : {"", "[chain]\nas_published = true\n"}) {
    const ScenePlan plan = planned(kView + look + clouds(8), {"budget=change=3"});
    write(plan);
    const Image full = drawn(file("scene.toml")), less = drawn(file("planned/scene.toml"));
    const Json& json = plan.json;
    const double measured = json.at("change_measured");
    EXPECT_LE(measured, 3);
    EXPECT_GT(measured, 0);
    EXPECT_LT(json.at("planned").at("vertices"), 0.7 * json.at("full").at("vertices").get<double>());
    // Over all pixels the change is smaller than over those that show clouds, and nothing else differs.
    const double whole = 255 * imageRms(full, less);
    EXPECT_LE(whole, measured + 0.3);
    EXPECT_GT(whole, 0.1 * measured);
    EXPECT_EQ(json.at("clouds").size(), 8U);
  }
}

TEST_F(PlanTest, AFramedCameraAndAFieldStayWhereTheyAre) {
  const std::string field =
      "[picture]\nwidth = 200\nheight = 120\n[[cloud]]\nfiles = ['humilis.glb', 'hero.glb']\n[cloud.scatter]\n"
      "low = [-20, 0, -20]\nhigh = [20, 2, 20]\ncount = 20\n";
  const ScenePlan plan = planned(field, {"budget=change=3"});
  write(plan);
  EXPECT_LE(255 * imageRms(drawn(file("scene.toml")), drawn(file("planned/scene.toml"))), 3);
  EXPECT_LT(plan.json.at("planned").at("vertices"), plan.json.at("full").at("vertices").get<double>());
}

TEST_F(PlanTest, AskedForMoreChangeItTakesImpostors) {
  const ScenePlan plan = planned(kView + clouds(60), {"budget=change=20"});
  write(plan);
  size_t impostors = 0;
  for (const ScenePlan::File& one : plan.files) {
    if (!isImpostor(one.bytes)) continue;
    ++impostors;
    const ImpostorInfo info = decodeImpostor(one.file, one.bytes).info;
    EXPECT_GT(info.level, 0);
    EXPECT_GT(info.switch_pixels, 0);
  }
  EXPECT_GT(impostors, 0U);
  EXPECT_LE(255 * imageRms(drawn(file("scene.toml")), drawn(file("planned/scene.toml"))), 20);
}

TEST_F(PlanTest, MeasuresAllPicturesOfARegionAndHours) {
  const ScenePlan plan = planned(kView + clouds(4), {"region=-1,1,8:1,2,10", "hours=8,12", "measure"});
  EXPECT_GT(plan.json.at("pictures"), 9);
  EXPECT_EQ(plan.json.at("pictures"), plan.json.at("pictures_measured"));
  EXPECT_LE(plan.json.at("change_measured"), 2);
  const ScenePlan path = planned(kView + clouds(4), {"path=0,1,20:0,1,-20", "hours=9"});
  EXPECT_LE(path.json.at("change_measured"), 2);
}

TEST_F(PlanTest, HasTheSameBytesForAnyNumberOfThreadsAndFromTheCache) {
  const auto bytes = [&] {
    std::string all;
    for (const ScenePlan::File& one : planned(kView + clouds(4)).files) all += one.bytes;
    return all;
  };
  const std::string first = bytes();
  EXPECT_EQ(bytes(), first) << "from the cache";
  fs::remove_all(cache_);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(bytes(), first);
}

TEST_F(PlanTest, RemovesLevelsOfAnEarlierPlan) {
  write(planned(kView + clouds(2)));
  writeFileAtomically(file("planned/hero_lod6.glb"), encodeImpostor(blankImpostor({}), {2, std::vector<uint8_t>(16)}).glb);
  fs::copy_file(file("planned/hero.glb"), file("planned/hero_lod7.glb"));
  writeFileAtomically(file("planned/hero_lod8.glb"), "somebody else's");
  const ScenePlan again = planned(kView + clouds(2));
  EXPECT_EQ(again.stale, (std::vector<fs::path>{file("planned/hero_lod6.glb"), file("planned/hero_lod7.glb")}));
}

TEST_F(PlanTest, RefusesWhatItCannotKeep) {
  const auto refusal = [&](const std::string& scene, const std::vector<std::string>& texts) {
    return refusalOf([&] { planned(scene, texts); });
  };
  EXPECT_TRUE(contains(refusal(kView + clouds(4), {"budget=change=0.5,vertices=10"}), "and --budget allows 10"));
  EXPECT_TRUE(contains(refusal(std::string(kView) + "[[slab]]\n", {}), "no baked clouds to plan"));
  EXPECT_TRUE(contains(refusal("[camera]\nposition = [0, 2, 14]\ntarget = [0, 2, 30]\n" + clouds(1), {}), "no cloud is in any picture"));
}

TEST_F(PlanTest, DoesNotReplaceWhatItIsMadeFrom) {
  writeFileAtomically(file("scene.toml"), kView + clouds(2));
  Settings settings = resolve(sourceOf(SourceKind::kRecipe, file("scene.toml")), {});
  settings.scene = file("scene.toml");
  settings.output.file = folder_.path;
  BakeReport report;
  Stopwatch watch;
  EXPECT_TRUE(contains(refusalOf([&] { planScene(settings, {}, report, watch); }), "which it is made from: choose another folder"));
}

}  // namespace
}  // namespace cloudbake
