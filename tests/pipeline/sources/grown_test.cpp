// Clouds that grow, from a recipe of few spheres.
#include "pipeline/sources/grown.h"

#include <algorithm>

#include "io/file/write_file.h"
#include "io/volume/spheres.h"
#include "pipeline/options/presets.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/option_samples.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

// A stem of four and branches at random angles; radii about 0.7.
const std::string kRecipe = R"(premise = 'FFF~(40)[+F]~(40)[-F]'
generations = 0
seed = 5
[turtle]
step = 0.7
thickness = 1
random_scale = 0.2
[spheres]
size = 0.7
)";

struct Grown {
  Cloud cloud;
  BakeReport report;
  Settings settings;
};

Grown growFrom(const SourceSettings& from, std::vector<std::string> texts, const std::optional<SceneNeeds>& scene = std::nullopt) {
  Grown grown;
  GrownSource source = readGrownSource(from);
  std::vector<Given> given = source.given;
  texts.push_back("voxels=24");
  for (const Given& one : options(texts, kGrow)) given.push_back(one);
  grown.settings = resolve(from, given, scene);
  Stopwatch watch;
  grown.cloud = growCloud(std::move(source), grown.settings, scene, grown.report, watch);
  return grown;
}
Grown grow(const TestFolder& folder, const std::string& recipe, const std::vector<std::string>& texts = {},
           const std::optional<SceneNeeds>& scene = std::nullopt) {
  return growFrom(sourceOf(SourceKind::kRecipe, folder.write("r.toml", recipe)), texts, scene);
}

std::string bytesOf(const std::vector<Sphere>& spheres) { return encodeSpheres(spheres, SphereFormat::kCsv); }

TEST(Grown, TheSeedDecidesTheShape) {
  const TestFolder folder;
  const std::string own = bytesOf(grow(folder, kRecipe, {"dry-run"}).cloud.spheres);
  EXPECT_EQ(own, bytesOf(grow(folder, kRecipe, {"dry-run"}).cloud.spheres));
  EXPECT_EQ(own, bytesOf(grow(folder, kRecipe, {"dry-run", "seed=5"}).cloud.spheres)) << "the recipe's seed is 5";
  EXPECT_NE(own, bytesOf(grow(folder, kRecipe, {"dry-run", "seed=6"}).cloud.spheres));
  EXPECT_EQ(grow(folder, kRecipe, {"dry-run"}).settings.lobe.bake.seed, 5U);
}

TEST(Grown, ARecipesOptionsGoUnderTheCommandLines) {
  const TestFolder folder;
  const std::string recipe = kRecipe + "[bake]\nrays = 36\nvertices = 300\nblend = \"2%\"\n";
  const Settings own = grow(folder, recipe, {"dry-run"}).settings, over = grow(folder, recipe, {"dry-run", "rays=64"}).settings;
  EXPECT_EQ(own.lobe.bake.rays, 36);
  EXPECT_EQ(own.mesh.vertices, 300U);
  EXPECT_TRUE(own.field.blend.relative);
  EXPECT_EQ(over.lobe.bake.rays, 64);
  EXPECT_EQ(over.mesh.vertices, 300U);
}

TEST(Grown, KeysOfTheCommandLineGoOverTheRecipes) {
  const TestFolder folder;
  const Grown own = grow(folder, kRecipe, {"dry-run"}), large = grow(folder, kRecipe, {"dry-run", "size=1.4"});
  ASSERT_EQ(own.cloud.spheres.size(), large.cloud.spheres.size());
  for (size_t i = 0; i < own.cloud.spheres.size(); ++i) EXPECT_FLOAT_EQ(large.cloud.spheres[i].radius, 2 * own.cloud.spheres[i].radius);
}

TEST(Grown, TheHashIsThatOfTheRecipeAndOfTheKeysOverIt) {
  const TestFolder folder;
  const auto hash = [&](const std::string& recipe, std::vector<std::string> texts) {
    texts.push_back("dry-run");
    return grow(folder, recipe, texts).report.info.input_hash;
  };
  EXPECT_EQ(hash(kRecipe, {}), hashBytes(kRecipe));
  EXPECT_EQ(hash(kRecipe, {"rays=36", "seed=9"}), hashBytes(kRecipe)) << "settings of the bake are told on their own";
  EXPECT_NE(hash(kRecipe, {"size=0.8"}), hashBytes(kRecipe));
  EXPECT_NE(hash(kRecipe, {"size=0.8"}), hash(kRecipe, {"size=0.9"}));
  EXPECT_NE(hash(kRecipe, {"size=0.8"}), hash(kRecipe, {"leaf-size=0.8"}));
  EXPECT_NE(hash(kRecipe + "\n", {}), hashBytes(kRecipe));
}

// The hash of a recipe tells apart what grows another cloud: every option that sets a key of the recipe counts, with its value, and no
// other. Which options these are follows from what they set.
TEST(Grown, TheHashCountsEveryKeyOfTheRecipeAndNothingElse) {
  const TestFolder folder;
  const SourceSettings from = sourceOf(SourceKind::kRecipe, folder.write("r.toml", "premise = 'FFJ[+FJ]'\ngenerations = 0\n"));
  const auto hashWith = [&](const Option& option, const std::string& value) {
    GrownSource source = readGrownSource(from);
    std::vector<Given> given = source.given;
    given.push_back({&option, value, "", 0, 0});
    if (std::string_view(option.name) != "dry-run") given.push_back(cloudbake::option("dry-run", kGrow));
    BakeReport report;
    Stopwatch watch;
    try {
      growCloud(std::move(source), resolve(from, given), std::nullopt, report, watch);
    } catch (const UsageError&) {
      return std::string("refused");
    } catch (const InputError&) {  // nothing grows with this value; the hash is there before
    }
    return report.info.input_hash;
  };
  const std::string own = hashWith(*findOption("dry-run", kGrow), "true");
  ASSERT_EQ(own.size(), 32U);
  size_t keys = 0;
  for (const Option& option : optionTable()) {
    const std::string_view name = option.name;
    if (!(option.commands & kGrow) || !(option.inputs & kFromRules) || !option.value.set || option.files.kind == FileUse::kRead) continue;
    const Samples samples = samplesOf(option);
    Settings alone;
    option.value.set(alone, option, samples.one);
    const std::string one = hashWith(option, samples.one), other = hashWith(option, samples.other);
    if (alone.source.recipe_keys.empty()) {  // one that needs another is refused
      for (const std::string& hash : {one, other})
        EXPECT_TRUE(hash == own || hash == "refused") << "--" << name << " is no key of the recipe";
      continue;
    }
    for (const std::string& hash : {one, other}) EXPECT_EQ(hash.size(), 32U) << "--" << name << ": " << hash;
    ++keys;
    EXPECT_NE(one, own) << "--" << name << " " << samples.one;
    EXPECT_NE(other, own) << "--" << name << " " << samples.other;
    EXPECT_NE(one, other) << "--" << name;
    for (const std::string& value : withOneNumberChanged(samples.one))
      EXPECT_NE(hashWith(option, value), one) << "--" << name << " " << value;
  }
  EXPECT_GE(keys, 45U);
}

TEST(Grown, TheSurfaceIsThatOfTheSpheres) {
  const TestFolder folder;
  const Grown grown = grow(folder, kRecipe);
  const float voxel = float(grown.cloud.level_set->frame.voxel_size);
  EXPECT_TRUE(grown.cloud.closed && grown.cloud.exact_spheres);
  for (const Vec3& p : grown.cloud.surface.positions) {
    float distance = 1e9F;
    for (const Sphere& s : grown.cloud.spheres) distance = std::min(distance, length(p - s.center) - s.radius);
    ASSERT_NEAR(distance, 0, voxel);
  }
  ASSERT_EQ(grown.cloud.sculpt.parts.size(), 1U);
  EXPECT_EQ(grown.cloud.sculpt.parts[0].name, "r") << "named after the file";
  EXPECT_EQ(grown.cloud.sculpt.parts[0].positions.size(), grown.cloud.surface.positions.size());
}

// What blends or bumps the spheres makes them a poor truth.
TEST(Grown, SpheresAreExactUnlessSomethingChangesTheirUnion) {
  const TestFolder folder;
  EXPECT_TRUE(grow(folder, kRecipe, {"blend=0", "noise=0"}).cloud.exact_spheres);
  for (const char* text : {"blend=2%", "noise=3%", "flat-base=0", "vertices=200"})
    EXPECT_FALSE(grow(folder, kRecipe, {text}).cloud.exact_spheres) << text;
}

TEST(Grown, AFlatBaseCutsTheCloud) {
  const TestFolder folder;
  const Grown whole = grow(folder, kRecipe), cut = grow(folder, kRecipe, {"flat-base=0.2"});
  EXPECT_LT(boundingBox(whole.cloud.surface).low.y, -0.4F);
  EXPECT_NEAR(boundingBox(cut.cloud.surface).low.y, 0.2F, float(cut.cloud.level_set->frame.voxel_size));
  EXPECT_NEAR(boundingBox(cut.cloud.surface).high.y, boundingBox(whole.cloud.surface).high.y, 0.1F);
}

// The surface, noise and all, is what fits the box; a flat base is its floor.
TEST(Grown, TheSurfaceFillsItsDomain) {
  const TestFolder folder;
  for (const std::vector<std::string>& texts :
       {std::vector<std::string>{}, std::vector<std::string>{"noise=6%"}, std::vector<std::string>{"blend=5%", "flat-base=0.5"}}) {
    std::vector<std::string> all = texts;
    all.push_back("domain=6x4x3");
    const Vec3 size = boundingBox(grow(folder, kRecipe, all).cloud.surface).size();
    for (const auto& [side, wanted] : {std::pair(size.x, 6.0F), std::pair(size.y, 4.0F), std::pair(size.z, 3.0F)}) {
      EXPECT_LT(side, 1.004F * wanted) << texts.size();
      EXPECT_GT(side, 0.93F * wanted) << texts.size();
    }
  }
}

TEST(Grown, ASceneGivesTheBudgetUnlessOneIsGiven) {
  const TestFolder folder;
  const size_t natural = grow(folder, kRecipe).cloud.surface.positions.size();
  SceneNeeds far;
  far.camera_distance = 200;
  far.view.height = 1080;
  const Grown own = grow(folder, kRecipe, {}, far);
  const size_t budget = vertexBudget(far, own.cloud.surface);
  ASSERT_LT(budget, natural / 2);
  EXPECT_NEAR(double(own.cloud.surface.positions.size()), double(budget), 0.15 * double(budget));
  EXPECT_FALSE(own.cloud.exact_spheres);
  const Grown given = grow(folder, kRecipe, {"vertices=400"}, far);
  EXPECT_LE(given.cloud.surface.positions.size(), 400U);
  EXPECT_GT(given.cloud.surface.positions.size(), 300U);
  SceneNeeds near = far;
  near.camera_distance = 2;
  EXPECT_EQ(grow(folder, kRecipe, {}, near).cloud.surface.positions.size(), natural) << "no vertices are made for a near camera";
}

TEST(Grown, ADryRunStopsAfterTheSpheres) {
  const TestFolder folder;
  const Grown dry = grow(folder, kRecipe, {"dry-run"});
  EXPECT_FALSE(dry.cloud.spheres.empty());
  EXPECT_TRUE(dry.cloud.surface.positions.empty() && !dry.cloud.level_set);
  ASSERT_TRUE(dry.report.growth) << "it tells how the cloud grew";
  EXPECT_EQ(dry.report.growth->radii.size(), dry.cloud.spheres.size());
  EXPECT_FALSE(grow(folder, kRecipe).report.growth);
  EXPECT_TRUE(grow(folder, kRecipe, {"explain"}).report.growth);
}

TEST(Grown, ASphereFileIsTheCloud) {
  const TestFolder folder;
  const std::string csv = "x,y,z,radius\n0,0,0,1\n1.5,0,0,0.8\n";
  const Grown grown = growFrom(sourceOf(SourceKind::kSpheres, folder.write("s.csv", csv)), {});
  EXPECT_EQ(bytesOf(grown.cloud.spheres), csv);
  EXPECT_EQ(grown.report.info.input_hash, hashBytes(csv));
  EXPECT_EQ(grown.cloud.sculpt.parts[0].name, "s");
  EXPECT_TRUE(grown.cloud.exact_spheres && grown.report.warnings.empty());
  EXPECT_NEAR(boundingBox(grown.cloud.surface).longestSide(), 3.3F, 0.1F);
  const Grown apart = growFrom(sourceOf(SourceKind::kSpheres, folder.write("t.csv", "0,0,0,1\n5,0,0,1\n0,5,0,1\n")), {});
  ASSERT_TRUE(apart.report.warnings.entries().contains(WarningKind::kGrammar));
  EXPECT_TRUE(contains(apart.report.warnings.entries().at(WarningKind::kGrammar).first, "the cloud has 3 separate parts"));
}

TEST(Grown, APlainListOfRules) {
  const TestFolder folder;
  const fs::path file = folder.write("r.txt", "premise: F\nF=FF\n");
  const Grown grown = growFrom(sourceOf(SourceKind::kRules, file), {"generations=2", "step=1", "thickness=1", "size=0.8", "dry-run"});
  EXPECT_EQ(grown.cloud.spheres.size(), 5U) << "F → FF → FFFF: five points";
  EXPECT_EQ(grown.report.input, file.string());
}

TEST(Grown, FaultsOfASourceAreTold) {
  const TestFolder folder;
  const auto read = [&](SourceKind kind, const fs::path& file) { return [=] { readGrownSource(sourceOf(kind, file)); }; };
  expectError<InputError>(read(SourceKind::kPreset, "nimbus"), "the presets are " + presetNames());
  const fs::path recipe = folder.write("r.toml", "premise = 'F'\nrules = ['F=FF']\n[bake]\nrays = 36\nraise = 3\n");
  expectError<InputError>(read(SourceKind::kRecipe, recipe), recipe.string() + ":5: unknown key 'raise' in [bake]");
  const fs::path sculpts = folder.write("s.toml", "premise = 'F'\nrules = ['F=FF']\n[bake]\nclose = 'wrap'\n");
  expectError<InputError>(read(SourceKind::kRecipe, sculpts), "unknown key 'close' in [bake]");
  EXPECT_FALSE(refusalOf<IoError>(read(SourceKind::kRecipe, folder.path / "no.toml")).empty());
  EXPECT_FALSE(refusalOf<UsageError>(read(SourceKind::kSpheres, folder.path / "no.txt")).empty())
      << "a name that is no format, before the file";
  expectError<InputError>([&] { grow(folder, kRecipe, {"max-points=2"}); }, (folder.path / "r.toml").string());
}

}  // namespace
}  // namespace cloudbake
