// What the kit writes for an engine: shared functions and the constants of an asset.
#include "pipeline/kit/engine_kit.h"
#include "core/text/maker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <regex>
#include <set>

#include "core/error.h"
#include "pipeline/kit/kit_files.h"
#include "tests/folders.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

AssetInfo someInfo() {
  AssetInfo info;
  info.shape = {4, -0.25F};
  info.extinction = 1e-9F;
  info.first_uv_set = 2;
  return info;
}

bool holds(const std::string& text, std::string_view piece) { return text.find(piece) != std::string::npos; }

TEST(EngineKit, NamesEachEngineOnce) {
  const std::vector<std::string> names = engineNames();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  std::vector<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(sourceFolder() / "engines"))
    if (entry.is_directory()) folders.push_back(entry.path().filename().string());
  std::sort(folders.begin(), folders.end());
  EXPECT_EQ(names, folders);
}

TEST(EngineKit, KnowsTheTitleOfEachEngine) {
  std::set<std::string> titles;
  for (const std::string& name : engineNames()) EXPECT_TRUE(titles.insert(engineTitle(name)).second) << name << ": " << engineTitle(name);
  EXPECT_FALSE(titles.contains(""));
  EXPECT_EQ(engineTitle("npm"), "three.js, Babylon.js");
}

TEST(EngineKit, KnowsWhichEnginesPlaySequences) {
  EXPECT_TRUE(playsSequences("npm"));
  EXPECT_TRUE(playsSequences("godot3"));
  EXPECT_FALSE(playsSequences("blender"));
  EXPECT_FALSE(playsSequences("nonsense"));
}

TEST(EngineKit, FillsInTheConstantsOfAnAsset) {
  const std::vector<EngineFile> files = engineFiles("glsl", someInfo());
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].name, "cloudbake.glsl");
  EXPECT_TRUE(holds(files[0].text, "CLOUDBAKE_SHAPE = vec2(4.0, -0.25);")) << files[0].text;
  EXPECT_TRUE(holds(files[0].text, "CLOUDBAKE_EXTINCTION = 1e-09;"));
  EXPECT_TRUE(holds(files[0].text, "TEXCOORD_2 and TEXCOORD_3"));
  EXPECT_TRUE(holds(files[0].text, CLOUDBAKE_VERSION));
}

std::vector<std::string> matchesIn(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match) found.push_back((*match)[1]);
  return found;
}

// HLSL has no constructor that repeats one number; GLSL has.
TEST(EngineKit, RepeatsNoNumberInVectorsOfHlsl) {
  for (const std::string& engine : engineNames())
    for (const EngineFile& file : engineFiles(engine, defaultAssetInfo()))
      if (file.name.ends_with(".hlsl") || file.name.ends_with(".shader")) {
        EXPECT_EQ(matchesIn(file.text, "(float[234]\\([a-z_0-9.]*\\))"), std::vector<std::string>{}) << engine << "/" << file.name;
      }
}

// No placeholder and no shared file is left out, in any engine, nor one that does not exist. Unity has packages.
TEST(EngineKit, LeavesNothingToFillIn) {
  size_t count = 0;
  for (const std::string& engine : engineNames()) {
    const std::vector<EngineFile> files = engineFiles(engine, defaultAssetInfo());
    count += files.size();
    for (const EngineFile& file : files) {
      EXPECT_TRUE(namesMaker(file.text)) << engine << "/" << file.name << " may not be replaced by the next kit";
      EXPECT_EQ(matchesIn(file.text, "(@[a-z_]+@)"), std::vector<std::string>{}) << engine << "/" << file.name;
      for (const std::string& included : matchesIn(file.text, "#include \"([^\"]*)\"")) {
        const auto is_own = [&](const EngineFile& other) { return other.name == included; };
        EXPECT_TRUE(included.starts_with("Packages/") || included.ends_with(".cginc") || std::any_of(files.begin(), files.end(), is_own))
            << engine << "/" << file.name << " includes " << included;
      }
    }
  }
  const auto belongs = [](const KitFile& file) {
    const std::string_view name = file.name;
    return name.find('/') != name.npos && !name.ends_with("/engine.json");
  };
  EXPECT_EQ(count, size_t(std::count_if(kitFiles().begin(), kitFiles().end(), belongs)));
}

TEST(EngineKit, IncludesTheFunctions) {
  for (const char* engine : {"glsl", "hlsl"}) {
    const std::string text = engineFiles(engine, defaultAssetInfo())[0].text;
    for (const char* function : {" lobeTransmittance(", " lobeInWorld(", " cloudColor(", " phaseFactor("})
      EXPECT_TRUE(holds(text, function)) << function;
  }
}

// Every kind of value: a real number, a whole one, a switch, a vector, one that is not set, and a key of the other chain.
TEST(EngineKit, HasTheConstantsOfAScene) {
  auto constants = sceneConstants(defaultScene());
  for (const auto& [mark, value] :
       {std::pair("@chain_near_width@", "0.008"), std::pair("@chain_far_tiles@", "4.0"), std::pair("@chain_near_drift@", "1.0, 0.0"),
        std::pair("@chain_near_drift_x@", "1.0"), std::pair("@chain_seed@", "0"), std::pair("@chain_far_distance@", "0.0"),
        std::pair("@chain_as_published@", "false"), std::pair("@chain_divisor@", "4"), std::pair("@chain_blur_as_quoted@", "false"),
        std::pair("@light_half_lambert@", "0.3"), std::pair("@fog_density@", "0.1"), std::pair("@swirl_octaves@", "2")})
    EXPECT_EQ(constants.at(mark), value) << mark;
  const SceneFile scene = readSceneFile("a.toml",
                                        "[chain]\nas_published = true\nnear_sigma = 6\nseed = 5\n[light]\nextinction = 2\n"
                                        "[fog]\ncolor = [0.5, 1, 2]\n[[cloud]]\nfile = 'a.glb'\n",
                                        [](const PictureSettings& view) { return view; });
  constants = sceneConstants(scene);
  for (const auto& [mark, value] :
       {std::pair("@chain_as_published@", "true"), std::pair("@chain_near_sigma@", "6.0"), std::pair("@chain_seed@", "5"),
        std::pair("@fog_color@", "0.5, 1.0, 2.0"), std::pair("@fog_color_z@", "2.0"), std::pair("@chain_near_width@", "0.008")})
    EXPECT_EQ(constants.at(mark), value) << mark;
  EXPECT_TRUE(holds(engineFiles("glsl", someInfo(), scene)[0].text, "CLOUDBAKE_EXTINCTION = 2.0;"));
}

TEST(EngineKit, RefusesUnknownEngines) {
  for (const char* name : {"", "quake", "lobe.hlsl", "unity/"})
    EXPECT_TRUE(holds(refusalOf<UsageError>([&] { engineFiles(name, {}); }), "the engines are ")) << name;
}

TEST(EngineKit, RefusesConstantsThatNoShaderCanHave) {
  for (const float wrong :
       {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    AssetInfo exponent = someInfo(), bias = someInfo(), extinction = someInfo();
    exponent.shape.exponent = bias.shape.bias = extinction.extinction = wrong;
    for (const auto& [info, name] : {std::pair(exponent, "exponent"), std::pair(bias, "bias"), std::pair(extinction, "extinction")})
      EXPECT_TRUE(
          holds(refusalOf<InputError>([&, &own = info] { engineFiles("glsl", own); }), std::string("the ") + name + " of the asset is"))
          << name;
  }
}

}  // namespace
}  // namespace cloudbake
