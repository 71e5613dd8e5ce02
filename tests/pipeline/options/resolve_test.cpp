// From options to settings: what goes over what, what does not go together, and where an error is told to be.
#include "pipeline/options/resolve.h"

#include <array>
#include <set>

#include "bake/mesh/repair.h"
#include "tests/pipeline/option_samples.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/pipeline/settings_text.h"

namespace cloudbake {
namespace {

using Texts = std::vector<std::string>;

std::string refusal(const Texts& texts, SourceKind kind = SourceKind::kSculpt, Command command = kBake,
                    const std::filesystem::path& input = {}) {
  return refusalOf<UsageError>([&] { resolve(sourceOf(kind, input), options(texts, command)); });
}

SceneNeeds sceneNeeds() {
  SceneNeeds scene;
  scene.camera_distance = 20;
  scene.sun_arc = SunArc{5, 60, 80, 100};
  return scene;
}

TEST(Resolve, LaterOptionsGoOverEarlierOnes) {
  EXPECT_EQ(settingsFor({"rays=36", "voxels=20", "rays=64"}).lobe.bake.rays, 64);
  EXPECT_FALSE(settingsFor({"lobe=fit", "lobe=mean"}).lobe.fit);
  EXPECT_FALSE(settingsFor({"separate=true", "separate=false"}).mesh.separate);
  // A number in place of a search, and back.
  const LobeSettings number = settingsFor({"lobe=fit", "exponent=fit", "exponent=2"}).lobe;
  EXPECT_TRUE(!number.fit_exponent && number.exponent == 2);
  EXPECT_TRUE(settingsFor({"lobe=fit", "bias=0", "bias=fit"}).lobe.fit_bias);
}

// The painted look has a view and a sun of its own; what is given goes over both.
TEST(Resolve, ViewsOfTheLooks) {
  const auto view = [](const Texts& texts) {
    const PictureSettings p = resolve(sourceOf(SourceKind::kSculpt), options(texts, kPreview)).picture;
    return std::array{p.sun_azimuth_degrees, p.sun_elevation_degrees, p.camera_azimuth_degrees, p.camera_elevation_degrees};
  };
  const std::array painted{kPaintedView.sun_azimuth, kPaintedView.sun_elevation, kPaintedView.camera_azimuth,
                           kPaintedView.camera_elevation},
      plain{kPlainView.sun_azimuth, kPlainView.sun_elevation, kPlainView.camera_azimuth, kPlainView.camera_elevation};
  EXPECT_EQ(view({}), painted);
  EXPECT_EQ(view({"look=painted"}), painted);
  EXPECT_EQ(view({"look=plain"}), plain);
  EXPECT_EQ(view({"compare"}), plain);
  for (const char* look : {"look=painted", "look=plain"}) {
    const auto sun = view({look, "sun=1,2"}), camera = view({look, "camera=3,4"});
    EXPECT_EQ(std::pair(sun[0], sun[1]), std::pair(1.0F, 2.0F));
    EXPECT_EQ(std::pair(sun[2], sun[3]), std::pair(view({look})[2], view({look})[3]));
    EXPECT_EQ(std::pair(camera[2], camera[3]), std::pair(3.0F, 4.0F));
    EXPECT_EQ(std::pair(camera[0], camera[1]), std::pair(view({look})[0], view({look})[1]));
  }
}

TEST(Resolve, TheSourceIsKept) {
  SourceSettings source = sourceOf(SourceKind::kVolume, "a.vdb");
  source.read.child_program = "/bin/reader";
  const Settings settings = resolve(source, options({"grid=density"}));
  EXPECT_EQ(settings.source.kind, SourceKind::kVolume);
  EXPECT_EQ(settings.source.input, "a.vdb");
  EXPECT_EQ(settings.source.read.child_program, "/bin/reader");
  EXPECT_EQ(settings.source.volume.grid, "density");
}

// docs and DESIGN: uniform draws, 100 × 100, end, L = 10, k = 3, b = −0.01.
TEST(Resolve, AsPublishedIsWhatItSays) {
  const Texts published{"method=rays", "sampler=uniform", "quadrature=end", "rays=100",
                        "steps=100",   "ray-length=10",   "exponent=3",     "bias=-0.01"};
  EXPECT_EQ(textOf(settingsFor({"as-published"})), textOf(settingsFor(published)));
  EXPECT_EQ(textOf(settingsFor({"as-published=false"})), textOf(settingsFor({})));
  EXPECT_EQ(settingsFor({"as-published", "rays=7"}).lobe.bake.rays, 7);
  EXPECT_EQ(settingsFor({"rays=7", "as-published"}).lobe.bake.rays, 100);
  EXPECT_TRUE(contains(refusal({"as-published=maybe"}), "--as-published: 'maybe' is not true or false"));
  // What it stands for is refused where it would be.
  EXPECT_TRUE(contains(refusal({"as-published", "field=coverage"}), "--field is an option of the sweep"));
}

// A sweep has the Fibonacci set of its own; rays are stratified unless told otherwise.
TEST(Resolve, TheSamplerThatAMethodHas) {
  EXPECT_EQ(settingsFor({}).lobe.bake.sampler, Sampler::kFibonacci);
  EXPECT_EQ(settingsFor({"sampler=fibonacci"}).lobe.bake.sampler, Sampler::kFibonacci);
  EXPECT_EQ(settingsFor({"method=rays"}).lobe.bake.sampler, Sampler::kStratified);
  EXPECT_EQ(settingsFor({"sampler=stratified", "method=rays"}).lobe.bake.sampler, Sampler::kStratified);
  EXPECT_EQ(settingsFor({"sampler=uniform", "method=rays"}).lobe.bake.sampler, Sampler::kUniform);
}

TEST(Resolve, TheSeedIsAlsoThatOfTheNoise) {
  const Settings settings = settingsFor({"seed=9", "noise=3%"}, SourceKind::kPreset);
  EXPECT_EQ(settings.lobe.bake.seed, 9U);
  EXPECT_EQ(settings.field.noise_seed, 9U);
}

// --- What does not go together ---

// A rule of an option: options that break it, and others, as near as can be, that keep it. `rule` counts from 0 in the option's row.
struct RuleCase {
  const char* name;
  size_t rule;
  const char* message;  // after --NAME
  Texts broken;
  std::vector<Texts> kept;
  Command command = kBake;
  SourceKind kind = SourceKind::kSculpt;
};

const Texts kRays{"method=rays"};

const std::vector<RuleCase>& ruleCases() {
  static const std::vector<RuleCase> cases{
      {"pack", 0, ": --attribute writes the lobes a second time", {"pack=8", "attribute"}, {{"pack=8"}, {"pack=16", "attribute"}}},
      {"frame", 0, " times --views is more than 16384", {"frame=1024", "views=17"}, {{"frame=1024", "views=16"}}, kImpostor},
      {"path", 0, " and --region both place the camera", {"path=0,1,2:3,4,5", "region=0,0,0:1,1,1"}, {{"path=0,1,2:3,4,5"}}, kPlan},
      {"pack-as", 0, " needs --pack 8", {"pack-as=strip"}, {{"pack=8", "pack-as=strip"}}},
      {"method",
       0,
       " rays cannot be combined with --target-error",
       {"method=rays", "target-error=1"},
       {{"method=rays"}, {"method=sweep", "target-error=1"}}},
      {"field", 0, " is an option of the sweep", {"field=coverage", "method=rays"}, {{"field=levelset"}, {"field=auto", "method=rays"}}},
      {"rays", 0, ": a sweep uses both senses of an axis", {"rays=7"}, {{"rays=8"}, {"rays=7", "method=rays"}}},
      {"rays",
       1,
       ": spherical harmonics need 8 (sh1), 18 (sh2) or 32 (sh3)",
       {"rays=16", "basis=sh2"},
       {{"rays=18", "basis=sh2"}, {"rays=16", "basis=sh1"}}},
      {"rays", 1, ": spherical harmonics need", {"rays=30", "basis=sh3"}, {{"rays=32", "basis=sh3"}, {"rays=2", "basis=lobe"}}},
      {"rays", 1, ": spherical harmonics need", {"rays=6", "basis=sh1"}, {{"rays=8", "basis=sh1"}}},
      {"rays", 2, " is chosen by --target-error", {"rays=36", "target-error=1"}, {{"rays=36"}, {"target-error=1"}}},
      {"sampler", 0, " needs --method rays", {"sampler=stratified"}, {{"sampler=fibonacci"}, {"sampler=stratified", "method=rays"}}},
      {"sampler", 0, " needs --method rays", {"sampler=uniform"}, {{"sampler=uniform", "method=rays"}}},
      {"fixed-directions", 0, " needs --method rays", {"fixed-directions"}, {{"fixed-directions", "method=rays"}}},
      {"quadrature", 0, " needs --method rays", {"quadrature=end"}, {{"quadrature=end", "method=rays"}}},
      {"steps", 0, " needs --method rays", {"steps=50"}, {{"steps=50", "method=rays"}}},
      {"voxels", 0, ": a VDB has voxels of its own", {"voxels=50"}, {{"bake-voxels=50"}}, kBake, SourceKind::kVolume},
      {"voxel-size", 0, ": a VDB has voxels of its own", {"voxel-size=0.5"}, {{"bake-voxels=50"}}, kBake, SourceKind::kVolume},
      {"bake-voxels",
       0,
       " is chosen by --target-error",
       {"bake-voxels=50", "target-error=1"},
       {{"bake-voxels=50"}, {"voxels=50", "target-error=1"}}},
      {"fit-to", 0, " volume needs --lobe fit", {"fit-to=volume", "lobe=mean"}, {{"fit-to=volume"}, {"fit-to=transmittance", "lobe=mean"}}},
      {"fit-to", 1, " volume needs --method sweep", {"lobe=fit", "fit-to=volume", "method=rays"}, {{"lobe=fit", "method=rays"}}},
      {"view-extinction", 0, " needs --fit-to volume", {"fit-to=transmittance", "view-extinction=2"}, {{"view-extinction=2"}}},
      {"octaves", 0, " needs --fit-to volume", {"lobe=mean", "octaves=2"}, {{"octaves=2"}}},
      {"phase", 0, " needs --fit-to volume", {"method=rays", "phase=0.2"}, {{"phase=0.2"}}},
      {"exponent", 0, " fit needs --lobe fit", {"exponent=fit", "lobe=mean"}, {{"exponent=fit"}, {"exponent=2", "lobe=mean"}}},
      {"bias", 0, " fit needs --lobe fit", {"bias=fit", "lobe=mean"}, {{"bias=fit"}, {"bias=0", "lobe=mean"}}},
      {"extinction",
       0,
       " LO:HI needs --lobe fit",
       {"extinction=2:9", "lobe=mean"},
       {{"extinction=2:9"}, {"extinction=2", "lobe=mean"}, {"extinction=2:2", "lobe=mean"}}},
      {"sun-arc", 0, " needs --lobe fit", {"sun-arc=5:60,90", "lobe=mean"}, {{"sun-arc=5:60,90"}}},
      {"lattice", 0, " needs --basis", {"lattice=a.json"}, {{"lattice=a.json", "basis=sh1"}}},
      {"smooth",
       0,
       " changes the lobes that --target-error",
       {"smooth=2", "target-error=1"},
       {{"smooth=2"}, {"smooth=0", "target-error=1"}}},
      {"remesh", 0, " and --vertices both give a sculpt a new mesh", {"remesh=2%", "vertices=100"}, {{"remesh=2%"}, {"vertices=100"}}},
      {"refine",
       0,
       " measures the whole sculpt",
       {"refine=auto", "separate"},
       {{"refine=auto"}, {"separate"}, {"refine=0.1", "vertices=100"}}},
      {"lods", 0, " and --refine change the mesh in opposite ways", {"lods=50%", "refine=auto"}, {{"lods=50%"}, {"refine=auto"}}},
      {"repair",
       0,
       " remesh and --vertices both give a sculpt a new mesh",
       {"repair=remesh", "vertices=100"},
       {{"repair=fill", "vertices=100"}, {"repair=remesh"}}},
      {"separate", 0, " bakes lobes only", {"separate", "basis=sh1"}, {{"separate=false", "basis=sh1"}, {"separate", "basis=lobe"}}},
      {"separate",
       1,
       " cannot be combined with --target-error, which measures the whole",
       {"separate", "target-error=1"},
       {{"separate"}, {"separate=false", "target-error=1"}}},
      {"separate", 2, " bakes mean lobes", {"separate", "lobe=fit"}, {{"separate", "lobe=mean"}, {"separate=false", "lobe=fit"}}},
      {"noise-size", 0, " needs --noise", {"noise-size=20%"}, {{"noise-size=20%", "noise=3%"}}, kGrow, SourceKind::kPreset},
      {"channels", 0, " is an option of the painted look", {"channels=c", "look=plain"}, {{"channels=c"}}, kPreview},
      {"channels", 1, " is for a single picture", {"channels=c", "turntable=8"}, {{"turntable=8"}}, kPreview},
      {"channels", 2, " cannot be combined with --compare", {"channels=c", "compare"}, {{"compare"}}, kPreview},
      {"steps", 0, " is an option of the painted look", {"steps=c", "look=plain"}, {{"steps=c"}}, kPreview},
      {"steps", 1, " is for a single picture", {"steps=c", "animate=8"}, {{"animate=8"}}, kPreview},
      {"steps", 2, " cannot be combined with --compare", {"steps=c", "compare"}, {{"compare"}}, kPreview},
      {"scene", 0, " draws the painted look", {"scene=a.toml", "look=plain"}, {{"scene=a.toml"}}, kPreview},
      {"scene", 1, " cannot be combined with --compare", {"scene=a.toml", "compare"}, {{"scene=a.toml"}}, kPreview},
      {"turntable", 0, " cannot be combined with --compare", {"turntable=8", "compare"}, {{"turntable=8", "look=plain"}}, kPreview},
      {"sun-sweep", 0, " cannot be combined with --compare", {"sun-sweep=8", "compare"}, {{"sun-sweep=8", "look=plain"}}, kPreview},
      {"animate", 0, " cannot be combined with --compare", {"animate=8", "compare"}, {{"animate=8", "scene=a.toml"}}, kPreview},
      {"frames",
       0,
       " needs --turntable, --sun-sweep or --animate",
       {"frames=f"},
       {{"frames=f", "turntable=8"}, {"frames=f", "sun-sweep=8"}},
       kPreview},
      {"suns", 0, " needs --compare", {"suns=4"}, {{"suns=4", "compare"}}, kPreview},
      {"view-extinction", 0, " needs --compare", {"view-extinction=2"}, {{"view-extinction=2", "compare"}}, kPreview},
      {"octaves", 0, " needs --compare", {"octaves=4"}, {{"octaves=4", "compare"}}, kPreview},
      {"phase", 0, " needs --compare", {"phase=0.5"}, {{"phase=0.5", "compare"}}, kPreview},
      {"max-surface-rms",
       0,
       " is measured against exact chords",
       {"max-surface-rms=0.1", "against=a.glb"},
       {{"max-surface-rms=0.1"}, {"against=a.glb"}},
       kCheck},
      {"watch", 0, " shows a single bake", {"watch=a.obj", "compare"}, {{"watch=a.obj"}, {"compare"}}, kView},
      {"prune", 0, " needs the whole batch", {"prune", "shard=1/2"}, {{"prune"}, {"shard=1/2"}}, kBatch},
      {"live", 0, " needs --html FILE", {"live"}, {{"live", "html=a.html"}, {"live=false"}}, kBatch},
  };
  return cases;
}

// The best look is the default; rays and separate objects have the lobes that they can have.
TEST(Resolve, LobesAreFittedToTheVolumeUnlessAskedOtherwise) {
  const auto kindOf = [](const std::vector<std::string>& texts) {
    const LobeSettings lobe = settingsFor(texts).lobe;
    return std::pair(lobe.fit, lobe.fit_to_volume);
  };
  EXPECT_EQ(kindOf({}), std::pair(true, true));
  EXPECT_EQ(kindOf({"lobe=fit"}), std::pair(true, true));
  EXPECT_EQ(kindOf({"fit-to=transmittance"}), std::pair(true, false));
  for (const char* mean : {"lobe=mean", "method=rays", "as-published", "separate"})
    EXPECT_EQ(kindOf({mean}), std::pair(false, false)) << mean;
  EXPECT_EQ(kindOf({"method=rays", "lobe=fit"}), std::pair(true, false));
}

// k and b are searched, unless they are given: a fit to a volume needs a b above 0.
TEST(Resolve, AFitToAVolumeSearchesItsShape) {
  const auto shapeOf = [](const std::vector<std::string>& texts) {
    const LobeSettings lobe = settingsFor(texts).lobe;
    return std::pair(lobe.fit_exponent, lobe.fit_bias);
  };
  EXPECT_EQ(shapeOf({"lobe=fit", "fit-to=volume"}), std::pair(true, true));
  EXPECT_EQ(shapeOf({"lobe=fit", "fit-to=volume", "exponent=2"}), std::pair(false, true));
  EXPECT_EQ(shapeOf({"lobe=fit", "fit-to=volume", "bias=1%"}), std::pair(true, false));
  EXPECT_EQ(shapeOf({"lobe=fit", "fit-to=transmittance"}), std::pair(false, false));
}

// What the command line says of the volume wins over the scene.
TEST(Resolve, ASceneTellsItsVolume) {
  SceneNeeds scene;
  scene.volume.octaves = OctaveSettings{4};
  scene.volume.asymmetry = 0.25F;
  scene.volume.view_extinction = 2;
  const std::vector<std::string> texts{"lobe=fit", "fit-to=volume", "phase=0.5", "rays=36"};
  const VolumeLight volume = resolve(sourceOf(SourceKind::kSculpt), options(texts), scene).lobe.volume.over({});
  EXPECT_EQ(volume.octaves.count, 4);
  EXPECT_EQ(volume.asymmetry, 0.5F);
  EXPECT_EQ(volume.view_extinction, 2);
  EXPECT_FALSE(resolve(sourceOf(SourceKind::kSculpt), options({"fit-to=transmittance", "rays=36"}), scene).lobe.volume.octaves);
}

TEST(Resolve, RulesRefuseWhatTheySayAndNothingElse) {
  for (const RuleCase& one : ruleCases()) {
    const std::string told = refusal(one.broken, one.kind, one.command);
    EXPECT_EQ(told.find("--" + std::string(one.name) + one.message), 0U) << one.name << ": " << told;
    for (const Texts& kept : one.kept) EXPECT_EQ(refusal(kept, one.kind, one.command), "") << one.name;
    // Told wherever the option stands among the others.
    const Texts turned(one.broken.rbegin(), one.broken.rend());
    EXPECT_NE(refusal(turned, one.kind, one.command), "") << one.name;
  }
}

TEST(Resolve, EveryRuleHasACase) {
  for (const Option& option : optionTable())
    for (size_t i = 0; i < option.rules.size(); ++i) {
      const OptionRule& rule = option.rules[i];
      if (!rule.broken || (hasCgal() && contains(rule.message, "needs CGAL"))) continue;
      if (std::string_view(option.name) == "scene" && contains(rule.message, "an asset")) continue;  // the test below
      const auto& cases = ruleCases();
      EXPECT_TRUE(std::any_of(cases.begin(), cases.end(),
                              [&](const RuleCase& one) {
                                return findOption(one.name, one.command) == &option && one.rule == i && contains(rule.message, one.message);
                              }))
          << option.name << rule.message;
    }
}

TEST(Resolve, ASceneIsInPlaceOfAnAsset) {
  EXPECT_TRUE(contains(refusal({"scene=a.toml"}, SourceKind::kSculpt, kPreview, "a.glb"), "--scene and an asset: give one of the two"));
  EXPECT_TRUE(contains(refusal({"scene=a.toml"}, SourceKind::kSculpt, kShadow, "a.glb"), "--scene and an asset: give one of the two"));
  EXPECT_EQ(refusal({"scene=a.toml"}, SourceKind::kSculpt, kShadow), "");
  EXPECT_EQ(refusal({"scene=a.toml"}, SourceKind::kSculpt, kPreview), "");
  EXPECT_EQ(refusal({"scene=a.toml"}, SourceKind::kSculpt, kBake, "a.obj"), "");
}

TEST(Resolve, OptionsThatMeanNothingToTheSource) {
  const std::set<std::string> of_sculpts{"remesh",  "refine",        "repair",      "close", "separate",
                                         "inspect", "allow-outside", "scene-index", "units", "animation"},
      of_volumes{"grid", "iso"},
      of_grown{"blend", "flat-base", "base-softness", "base-bumps", "base-bump-size", "noise", "noise-size", "noise-octaves", "vary"},
      no_volume{"voxels", "voxel-size", "frame-count"};
  const auto means = [&](const Option& option, SourceKind kind) {
    const bool grown = isGrown(kind), of_rules = std::string_view(option.group).find("as the recipe says") != std::string_view::npos;
    if (of_sculpts.contains(option.name)) return kind == SourceKind::kSculpt;
    if (of_volumes.contains(option.name)) return kind == SourceKind::kVolume;
    if (of_grown.contains(option.name)) return grown;
    if (std::string_view(option.name) == "up") return !grown;
    if (no_volume.contains(option.name)) return kind != SourceKind::kVolume;
    // The file itself is an option of a cloud that grows, too.
    return !of_rules || std::string_view(option.name) == "rules" || (grown && kind != SourceKind::kSpheres);
  };
  const std::pair<SourceKind, const char*> kinds[] = {{SourceKind::kPreset, "a grown cloud"}, {SourceKind::kRecipe, "a grown cloud"},
                                                      {SourceKind::kRules, "a grown cloud"},  {SourceKind::kSpheres, "a file of spheres"},
                                                      {SourceKind::kSculpt, "a sculpt"},      {SourceKind::kVolume, "a VDB"}};
  for (const Option& option : optionTable())
    for (const auto& [kind, text] : kinds) {
      std::vector<Given> given{{&option, samplesOf(option).one, "", 0, 0}};
      if (std::string_view(option.name) == "noise-size") given.push_back(cloudbake::option("noise=3%", kGrow));
      const std::string told = refusalOf<UsageError>([&, k = kind] { resolve(sourceOf(k), given); });
      const bool is_told =
          contains(told, std::string("--") + option.name + " does not apply to " + text) || contains(told, "a VDB has voxels of its own");
      EXPECT_EQ(is_told, !means(option, kind)) << option.name << " of " << text << ": " << told;
      EXPECT_STREQ(kindText(kind), text);
    }
}

// --- Where an error is ---

TEST(Resolve, ErrorsFromAFileNameTheirPlace) {
  const auto errorAt = [](const Texts& texts, int line, SourceKind kind = SourceKind::kSculpt) {
    try {
      resolve(sourceOf(kind), optionsInFile(texts));
      ADD_FAILURE() << "nothing was thrown";
    } catch (const InputError& error) {
      EXPECT_EQ(error.file, "bake.toml");
      EXPECT_EQ(error.line, line);
      EXPECT_EQ(error.column, 3);
      EXPECT_EQ(error.code, ExitCode::kInput);
    }
  };
  errorAt({"voxels=20", "rays=0"}, 2);                         // a value out of range
  errorAt({"voxels=20", "voxels=20", "rays=7"}, 3);            // a rule
  errorAt({"rays=36", "close=wrap"}, 2, SourceKind::kVolume);  // does not apply to a VDB
  errorAt({"rays=36", "as-published=maybe"}, 2);               // a shorthand
  errorAt({"as-published", "field=levelset"}, 2);              // what it stands for, against another
  errorAt({"lattice-cells=16", "as-published", "target-error=1"}, 2);

  try {
    resolve(sourceOf(SourceKind::kSculpt), options({"rays=0"}));
    ADD_FAILURE() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_EQ(error.code, ExitCode::kUsage);
    EXPECT_EQ(error.file, "");
  }
  // The place is that of the option that is refused, not of the one that it does not go with.
  std::vector<Given> mixed = optionsInFile({"rays=36"});
  mixed.push_back(option("target-error=1"));
  EXPECT_TRUE(contains(refusalOf<InputError>([&] { resolve(sourceOf(SourceKind::kSculpt), mixed); }), "bake.toml:1:3: --rays is chosen"));
}

// --- What a scene asks for ---

TEST(Resolve, ASceneSetsTheErrorOfAnEightBitStep) {
  const auto targetOf = [](const Texts& texts) {
    return resolve(sourceOf(SourceKind::kSculpt), options(texts), sceneNeeds()).lobe.target_error;
  };
  const auto chosen = targetOf({});
  ASSERT_TRUE(chosen);
  EXPECT_TRUE(chosen->is_transmittance);
  EXPECT_DOUBLE_EQ(chosen->value, 1.0 / 255);
  EXPECT_TRUE(targetOf({"voxels=50", "vertices=1000"})) << "the surface's voxels and the budget choose no error";
  const auto own = targetOf({"target-error=2"});
  EXPECT_TRUE(own && own->value == 2 && !own->is_transmittance);
  for (const Texts& by_hand : {Texts{"rays=36"}, Texts{"bake-voxels=40"}, Texts{"method=rays"}, Texts{"as-published"}})
    EXPECT_FALSE(targetOf(by_hand)) << by_hand[0];
  EXPECT_FALSE(settingsFor({}).lobe.target_error) << "no scene, no target";
}

TEST(Resolve, ASceneGivesAFitItsSun) {
  const auto arcOf = [](const Texts& texts) { return resolve(sourceOf(SourceKind::kSculpt), options(texts), sceneNeeds()).lobe.sun_arc; };
  EXPECT_EQ(textOf(arcOf({"lobe=fit"})), textOf(sceneNeeds().sun_arc));
  EXPECT_EQ(textOf(arcOf({"lobe=fit", "sun-arc=10:20,30:40"})), textOf(std::optional(SunArc{10, 20, 30, 40})));
  EXPECT_EQ(textOf(arcOf({})), textOf(sceneNeeds().sun_arc)) << "a fit is the default";
  EXPECT_FALSE(arcOf({"lobe=mean"})) << "a mean lobe is for no sun";
}

// The scene's target is one like any other: what does not go with it is refused.
TEST(Resolve, RulesSeeWhatTheSceneChose) {
  const auto told = [](const Texts& texts) {
    return refusalOf<UsageError>([&] { resolve(sourceOf(SourceKind::kSculpt), options(texts), sceneNeeds()); });
  };
  EXPECT_TRUE(contains(told({"smooth=2"}), "--smooth changes the lobes"));
  EXPECT_TRUE(contains(told({"separate"}), "--separate cannot be combined with --target-error"));
  EXPECT_EQ(told({"smooth=2", "rays=36"}), "");
}

// --- The picture ---

TEST(Resolve, APictureGoesOverTheScenes) {
  PictureSettings base;
  base.width = 320;
  base.exposure = 2;
  base.sun_azimuth_degrees = 7;
  const PictureSettings view = resolvePicture(base, options({"exposure=3", "camera=1,2", "strict"}, kPreview));
  PictureSettings expected = base;
  expected.exposure = 3;
  expected.camera_azimuth_degrees = 1, expected.camera_elevation_degrees = 2;
  EXPECT_EQ(textOf(view), textOf(expected));
  EXPECT_EQ(textOf(resolvePicture(base, {})), textOf(base));
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] { resolvePicture(base, options({"fov=151"}, kPreview)); }), "--fov: '151'"));
}

TEST(Resolve, KindsOfSourcesByName) {
  const std::pair<const char*, SourceKind> kinds[] = {{"humilis", SourceKind::kPreset},     {"puffball", SourceKind::kPreset},
                                                      {"nonsense", SourceKind::kSculpt},    {"humilis.toml", SourceKind::kRecipe},
                                                      {"a/b.toml", SourceKind::kRecipe},    {"a.vdb", SourceKind::kVolume},
                                                      {"a.VDB", SourceKind::kVolume},       {"a.obj", SourceKind::kSculpt},
                                                      {"dir/humilis", SourceKind::kSculpt}, {"", SourceKind::kSculpt}};
  for (const auto& [name, kind] : kinds) EXPECT_EQ(sourceKindOf(name), kind) << name;
}

}  // namespace
}  // namespace cloudbake
