// The table row by row: what each option takes, refuses and sets.
#include "pipeline/options/options.h"

#include <cmath>
#include <set>

#include "tests/pipeline/option_samples.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/pipeline/settings_text.h"

namespace cloudbake {
namespace {

constexpr Command kCommands[] = {kGrow, kBake, kPreview, kMeasure, kBatch, kCheck, kView, kShader, kShadow, kImpostor, kPlan, kSequence};

const Option& row(const std::string& name) {
  const size_t at = name.find('@');
  const Command command = at == std::string::npos ? kBake : name.ends_with("@view") ? kView : kPreview;
  for (const Option& option : optionTable())
    if (name.substr(0, at) == option.name && (at == std::string::npos || option.commands == unsigned(command))) return option;
  throw std::invalid_argument("no option " + name);
}

// What an option makes of a value alone.
Settings setAlone(const Option& option, const std::string& value) {
  Settings settings;
  option.value.set(settings, option, value);
  return settings;
}
bool takes(const Option& option, const std::string& value) {
  return refusalOf<UsageError>([&] { setAlone(option, value); }).empty();
}

std::string labelOf(const Option& option) { return std::string("--") + option.name + " " + defaultOf(option); }

TEST(Options, EachNameMeansOneOptionPerCommand) {
  for (const Command command : kCommands) {
    std::set<std::string> names;
    for (const Option& option : optionTable()) {
      if (!(option.commands & command)) continue;
      EXPECT_TRUE(names.insert(option.name).second) << option.name << " is there twice";
      std::string underscored = option.name;
      for (char& c : underscored) c = c == '-' ? '_' : c;
      EXPECT_EQ(findOption(option.name, command), &option);
      EXPECT_EQ(findOption(underscored, command), &option);
    }
    EXPECT_EQ(findOption("colour", command), nullptr);
  }
  EXPECT_EQ(findOption("rays", kPreview), nullptr);
  EXPECT_EQ(findOption("sun", kBake), nullptr);
  EXPECT_NE(findOption("size", kPreview), findOption("size", kGrow));
}

TEST(Options, RowsAreWhole) {
  for (const Option& option : optionTable()) {
    EXPECT_NE(option.commands, 0U) << option.name;
    EXPECT_EQ(option.common & ~option.commands, 0U) << option.name << " is shown by a command that does not take it";
    EXPECT_NE(option.inputs & kAnyInput, 0U) << option.name;
    EXPECT_STRNE(option.help, "") << option.name;
    EXPECT_STRNE(option.group, "") << option.name;
    EXPECT_EQ(option.value.set == nullptr, *option.stands_for != 0) << option.name << " sets something, or stands for what does";
    EXPECT_TRUE(*option.unit || option.value.form.kind == ValueForm::kFlag) << option.name << " has no unit";
    EXPECT_TRUE(*option.unit || defaultOf(option).empty()) << option.name << ": a flag is off";
    const bool has_initial = option.value.initial && !option.value.initial(Settings(), option).empty();
    EXPECT_FALSE(has_initial && *option.fallback) << option.name << " has two defaults";
    for (const char* c = option.name; *c; ++c) EXPECT_TRUE((*c >= 'a' && *c <= 'z') || *c == '-') << option.name;
  }
}

TEST(Options, EachSetsSomething) {
  const std::string untouched = textOf(Settings());
  for (const Option& option : optionTable()) {
    const auto [one, other] = samplesOf(option);
    ASSERT_NE(one, other) << option.name << ": the row needs two examples";
    if (!option.value.set) continue;
    EXPECT_NE(textOf(setAlone(option, one)), untouched) << option.name << " " << one;
    EXPECT_NE(textOf(setAlone(option, one)), textOf(setAlone(option, other))) << option.name;
  }
}

// The help has a heading per group, and the completions keep its order.
TEST(Options, GroupsStayTogether) {
  for (const Command command : kCommands) {
    std::set<std::string> closed;
    std::string open;
    for (const Option& option : optionTable()) {
      if (!(option.commands & command)) continue;
      if (const std::string group = groupOf(option, command); group != open) {
        EXPECT_TRUE(closed.insert(open).second && !closed.contains(group)) << option.name << " is apart from its group";
        open = group;
      }
    }
  }
}

// Limits, words and percent signs that the row has are those of the parser, so that pages and schemas may go by them.
TEST(Options, FormsAreWhatIsTaken) {
  for (const Option& option : optionTable()) {
    const ValueForm& form = option.value.form;
    if (!option.value.set) continue;
    for (const auto& [text, value] : form.words)
      if (text) {
        EXPECT_TRUE(takes(option, text)) << option.name << " " << text;
      }
    const bool is_number = form.kind == ValueForm::kWhole || form.kind == ValueForm::kNumber;
    EXPECT_EQ(takes(option, "2%"), form.high_percent > 0 || (form.kind == ValueForm::kText && !*form.shape && takes(option, "a")))
        << option.name;
    if (!is_number) continue;
    EXPECT_EQ(takes(option, "3.5"), form.kind == ValueForm::kNumber && form.low <= 3.5 && form.high >= 3.5) << option.name;
    const auto textOfNumber = [&](double number) {
      return form.kind == ValueForm::kWhole ? fmt::format("{:.0f}", number) : shortestText(number);
    };
    for (const double limit : {form.low, form.high}) {
      if (!std::isfinite(limit) || limit == kAboveZero) continue;
      const bool is_in_range = form.kind == ValueForm::kNumber || limit < 0x1p64;  // beyond the last seed
      EXPECT_EQ(takes(option, textOfNumber(limit)), is_in_range) << option.name << " " << limit;
      const double beyond = limit == form.low ? limit - 1 - std::fabs(limit) : 2 * limit + 1;
      EXPECT_FALSE(takes(option, textOfNumber(beyond))) << option.name << " " << beyond;
    }
  }
}

// A default that reads as a value is the one that holds where the option is not given. Others are words, and parameters_test and
// fields_test hold those to what they say.
TEST(Options, GivingTheDefaultChangesNothing) {
  const std::set<std::string> words{"ray-length",     "bake-voxels",    "exponent",      "bias",       "extinction",
                                    "sun-arc",        "uv-set",         "noise-size",    "units",      "up",
                                    "truth-vertices", "memory",         "threads",       "iso",        "scene-index",
                                    "base-softness",  "base-bump-size", "noise-octaves", "frame-count"};
  // Free text, a length of which 0 means the same as none, and what the option is given without its value.
  const std::set<std::string> elsewhere{"grid",  "name",    "depfile-target", "noise",          "base-bumps",
                                        "serve", "octaves", "phase",          "view-extinction"};
  const std::string untouched = textOf(Settings());
  for (const Option& option : optionTable()) {
    const std::string fallback = defaultOf(option);
    if (fallback.empty() || elsewhere.contains(option.name)) continue;
    EXPECT_EQ(takes(option, fallback), !words.contains(option.name)) << labelOf(option);
    if (!words.contains(option.name)) {
      EXPECT_EQ(textOf(setAlone(option, fallback)), untouched) << labelOf(option);
    }
  }
}

// Lowest and highest value, and the nearest beyond them.
struct Range {
  const char *name, *low, *high, *below, *above;
};
const Range kRanges[] = {
    {"rays", "1", "1048576", "0", "1048577"},
    {"steps", "1", "1048576", "0", "1048577"},
    {"ray-length", "1e-37", "3e38", "0", "1e39"},
    {"voxels", "1", "2147483647", "0", "2147483648"},
    {"voxel-size", "1e-37", "3e38", "0", "1e39"},
    {"bake-voxels", "1", "2147483647", "0", "2147483648"},
    {"target-error", "0.05", "180", "0.049", "180.1"},
    {"target-error", "0.01%", "100%", "0.009%", "100.1%"},
    {"exponent", "0", "1000", "-0.01", "1000.1"},
    {"bias", "-3e38", "3e38", "-1e39", "1e39"},
    {"bias", "-1000%", "1000%", "-1001%", "1001%"},
    {"extinction", "1e-37", "3e38", "0", "1e39"},
    {"extinction", "1:1", "1:3e38", "-1:2", "1:1e39"},
    {"sun-arc", "-90,-3600", "90,3600", "-90.1,0", "90.1,0"},
    {"sun-arc", "0:90,-3600:3600", "0:0,0:0", "0:90,-3601:0", "0:90,0:3601"},
    {"lattice-cells", "2", "128", "1", "129"},
    {"smooth", "0", "1000", "-1", "1001"},
    {"seed", "0", "18446744073709551615", "-1", "18446744073709551616"},
    {"vertices", "4", "2147483647", "3", "2147483648"},
    {"lods", "4", "2147483647", "3", "2147483648"},
    {"remesh", "1e-37", "3e38", "0", "1e39"},
    {"remesh", "0.001%", "1000%", "0%", "1001%"},
    {"refine", "0.0001", "1", "0", "1.1"},
    {"scene-index", "0", "2147483647", "-1", "2147483648"},
    {"uv-set", "0", "6", "-1", "7"},
    {"blend", "0", "3e38", "-0.1", "1e39"},
    {"blend", "0%", "1000%", "-1%", "1001%"},
    {"flat-base", "-3e38", "3e38", "-1e39", "1e39"},
    {"base-softness", "0", "3e38", "-0.1", "1e39"},
    {"base-softness", "0%", "1000%", "-1%", "1001%"},
    {"base-bumps", "0", "3e38", "-0.1", "1e39"},
    {"base-bumps", "0%", "1000%", "-1%", "1001%"},
    {"base-bump-size", "1e-37", "3e38", "0", "1e39"},
    {"noise", "0", "3e38", "-0.1", "1e39"},
    {"noise", "0%", "1000%", "-1%", "1001%"},
    {"noise-size", "1e-37", "3e38", "0", "1e39"},
    {"noise-octaves", "1", "8", "0", "9"},
    {"units", "1e-37", "3e38", "0", "1e39"},
    {"iso", "-3e38", "3e38", "-1e39", "1e39"},
    {"truth-vertices", "1", "2147483647", "0", "2147483648"},
    {"sun", "-3600,-90", "3600,90", "-3601,0", "0,91"},
    {"camera", "-3600,-90", "3600,90", "0,-91", "3601,0"},
    {"size@preview", "1x1", "16384x16384", "0x1", "1x16385"},
    {"size@view", "1x1", "16384x16384", "0x1", "1x16385"},
    {"fov", "1", "150", "0.9", "151"},
    {"time", "0", "1e6", "-1", "1000001"},
    {"turntable", "2", "10000", "1", "10001"},
    {"sun-sweep", "2", "10000", "1", "10001"},
    {"animate", "2", "10000", "1", "10001"},
    {"fps", "0.1", "100", "0.09", "101"},
    {"suns", "1", "10000", "0", "10001"},
    {"view-extinction", "0.01", "100", "0.009", "101"},
    {"octaves", "0", "15", "-1", "16"},
    {"octaves", "2,0,0", "2,1,1", "2,-0.1,0.5", "2,0.5,1.1"},
    {"phase", "-0.95", "0.95", "-0.96", "0.96"},
    {"view-extinction@preview", "0.01", "100", "0.009", "101"},
    {"octaves@preview", "0", "15,1,1", "-1", "15,2,1"},
    {"phase@preview", "-0.95", "0.95", "-0.96", "0.96"},
    {"exposure", "1e-37", "1e6", "0", "1000001"},
    {"serve", "0", "65535", "-1", "65536"},
    {"memory", "64M", "1e15", "63M", "2e15"},
    {"shard", "1/1", "100000/100000", "0/1", "1/100001"},
    {"shard", "1/2", "2/2", "-1/2", "3/2"},
    {"max-angle", "0", "180", "-1", "181"},
    {"max-transmittance-rms", "0", "1", "-0.1", "1.1"},
    {"max-surface-rms", "0", "1", "-0.1", "1.1"},
    {"threads", "1", "4096", "0", "4097"},
};

TEST(Options, RangesAreHeldAtBothEnds) {
  for (const auto& [name, low, high, below, above] : kRanges) {
    const Option& option = row(name);
    for (const char* inside : {low, high}) EXPECT_TRUE(takes(option, inside)) << name << " " << inside;
    for (const char* outside : {below, above}) {
      const std::string refusal = refusalOf<UsageError>([&] { setAlone(option, outside); });
      EXPECT_EQ(refusal.find(std::string("--") + option.name + ": '"), 0U) << name << " " << outside << ": " << refusal;
    }
  }
}

// `view --watch` bakes: with everything that changes the lobes, and nothing that only writes.
TEST(Options, AWatchTakesTheOptionsOfItsBake) {
  const std::set<std::string> left_out{"scene", "lattice", "lattice-cells", "lods", "inspect", "uv-set", "attribute", "keep-alive-texture",
                                       "force", "pack",    "pack-as"},
      of_any_run{"threads", "memory", "strict", "json"};
  for (const Option& option : optionTable()) {
    const bool of_bake = (option.commands & kBake) != 0;
    if (of_bake) {
      EXPECT_EQ(findOption(option.name, kView) == &option, !left_out.contains(option.name)) << option.name;
    }
    EXPECT_EQ(needsWatch(option), of_bake && !left_out.contains(option.name) && !of_any_run.contains(option.name)) << option.name;
    EXPECT_EQ(groupOf(option, kView), std::string(option.group) + (needsWatch(option) ? " (with --watch)" : "")) << option.name;
    EXPECT_EQ(groupOf(option, kBake), option.group) << option.name;
  }
  EXPECT_EQ(defaultOf(row("serve")), std::to_string(kServePort));
  EXPECT_TRUE(isOptionalUnit(row("serve").unit));
  EXPECT_FALSE(isOptionalUnit(row("watch").unit));
}

// What is no number is refused by every option that wants one, whole: nothing is read in part.
TEST(Options, NumbersAreReadWhole) {
  for (const Option& option : optionTable()) {
    if (!option.value.set || !*option.unit) continue;
    const bool is_number = contains(refusalOf<UsageError>([&] { setAlone(option, "x"); }), "number");
    if (contains(option.group, "as the recipe says")) continue;  // lsystem/recipe_test.cpp
    const ValueForm& form = option.value.form;
    const bool joins_numbers = std::string_view(form.shape).find_first_of("XN") != std::string_view::npos || &option == &row("memory");
    EXPECT_EQ(is_number, form.kind == ValueForm::kWhole || form.kind == ValueForm::kNumber || joins_numbers) << option.name;
    if (!is_number) continue;
    for (const char* value : {"", "1x5y", "nan", "inf", " 1", "1 ", "0x10", "1,", "%"})
      EXPECT_FALSE(takes(option, value)) << option.name << value;
  }
}

TEST(Options, KeysOfARecipeRefuseWhatTheRecipeDoes) {
  for (const char* name : {"generations", "domain", "random-scale", "connect", "emit", "max-depth"})
    EXPECT_EQ(refusalOf<UsageError>([&] { setAlone(row(name), "many"); }).find("--" + std::string(name) + ": 'many': "), 0U) << name;
  const Settings settings = setAlone(row("random-scale"), "0.5");
  EXPECT_EQ(settings.source.recipe_keys, (std::vector<std::pair<std::string, std::string>>{{"random_scale", "0.5"}}));
}

TEST(Options, MemoryCountsInPowersOf1024) {
  const auto bytes = [](const char* value) { return setAlone(row("memory"), value).run.memory.value(); };
  EXPECT_EQ(bytes("67108864"), 67108864U);
  EXPECT_EQ(bytes("70000K"), 71680000U);
  EXPECT_EQ(bytes("64M"), 67108864U);
  EXPECT_EQ(bytes("500M"), 524288000U);
  EXPECT_EQ(bytes("8G"), 8589934592U);
  EXPECT_EQ(bytes("1.5G"), 1610612736U);
  EXPECT_EQ(bytes("2T"), 2199023255552U);
  for (const char* value : {"G", "8P", "8GB", "0K", "-1M", "63M", "1000T"}) EXPECT_FALSE(takes(row("memory"), value)) << value;
}

TEST(Options, LengthsAreWorldUnitsOrShares) {
  const Length share = *setAlone(row("bias"), "-2.5%").lobe.bias, units = *setAlone(row("bias"), "-2.5").lobe.bias;
  EXPECT_FLOAT_EQ(share.resolve(8), -0.2F);
  EXPECT_FLOAT_EQ(units.resolve(8), -2.5F);
}

TEST(Options, RangesAndPairs) {
  using Pair = std::pair<float, float>;
  EXPECT_EQ(setAlone(row("extinction"), "2:9").lobe.extinction_range, Pair(2, 9));
  EXPECT_EQ(setAlone(row("extinction"), "3").lobe.extinction_range, Pair(3, 3));
  EXPECT_TRUE(contains(refusalOf([&] { setAlone(row("extinction"), "9:2"); }), "the lower first"));
  const SunArc arc = *setAlone(row("sun-arc"), "5:60,-80:100").lobe.sun_arc;
  EXPECT_EQ(textOf(arc), textOf(SunArc{5, 60, -80, 100}));
  EXPECT_TRUE(contains(refusalOf([&] { setAlone(row("sun-arc"), "5:60"); }), "joined by ','"));
  const PictureSettings sun = setAlone(row("sun"), "10,20").picture, camera = setAlone(row("camera"), "10,20").picture,
                        size = setAlone(row("size@preview"), "64x48").picture;
  EXPECT_EQ(std::pair(sun.sun_azimuth_degrees, sun.sun_elevation_degrees), Pair(10, 20));
  EXPECT_EQ(std::pair(camera.camera_azimuth_degrees, camera.camera_elevation_degrees), Pair(10, 20));
  EXPECT_EQ(std::pair(size.width, size.height), std::pair(64, 48));
  EXPECT_FALSE(takes(row("size@preview"), "64,48"));
  const TargetError angle = *setAlone(row("target-error"), "2").lobe.target_error,
                    rms = *setAlone(row("target-error"), "2%").lobe.target_error;
  EXPECT_EQ(textOf(angle), textOf(TargetError{2, false}));
  EXPECT_EQ(textOf(rms), textOf(TargetError{0.02, true}));
  const BatchSettings shard = setAlone(row("shard"), "2/3").batch;
  EXPECT_EQ(std::pair(shard.shard, shard.shards), std::pair(2, 3));
}

TEST(Options, RepairsAreAList) {
  const MeshSettings all = setAlone(row("repair"), "remesh,orient,fill").mesh, one = setAlone(row("repair"), "fill").mesh;
  EXPECT_TRUE(all.repair.orient && all.repair.fill && all.repair_remesh);
  EXPECT_TRUE(!one.repair.orient && one.repair.fill && !one.repair_remesh);
  for (const char* value : {"", "orient,", "orient,all", "Orient"}) EXPECT_FALSE(takes(row("repair"), value)) << value;
}

TEST(Options, FlagsAreTrueOrFalse) {
  for (const Option& option : optionTable()) {
    if (*option.unit || !option.value.set) continue;
    EXPECT_EQ(textOf(setAlone(option, "false")), textOf(Settings())) << option.name;
    for (const char* value : {"", "yes", "1", "TRUE"}) EXPECT_FALSE(takes(option, value)) << option.name << value;
  }
}

TEST(Options, ChoicesAreThoseThatAreTaken) {
  EXPECT_EQ(optionChoices(row("method")), (std::vector<std::string>{"sweep", "rays"}));
  EXPECT_EQ(optionChoices(row("quadrature")), (std::vector<std::string>{"crossing", "midpoint", "end"}));
  EXPECT_EQ(optionChoices(row("connect")), (std::vector<std::string>{"true", "false"}));
  for (const char* name : {"rays", "scene", "strict", "premise", "bias", "as-published"})
    EXPECT_TRUE(optionChoices(row(name)).empty()) << name;
  size_t with_choices = 0;
  for (const Option& option : optionTable()) {
    const std::vector<std::string> choices = optionChoices(option);
    if (choices.empty()) continue;
    ++with_choices;
    std::string listed;
    for (const std::string& choice : choices) {
      EXPECT_TRUE(takes(option, choice)) << option.name << " " << choice;
      listed += (listed.empty() ? "" : ", ") + choice;
    }
    EXPECT_FALSE(takes(option, "neither")) << option.name;
    if (std::string_view(option.unit) == "BOOL") continue;
    EXPECT_TRUE(contains(refusalOf([&] { setAlone(option, "neither"); }), "one of " + listed)) << option.name;
    // The help names them all.
    for (const std::string& choice : choices)
      EXPECT_TRUE(contains(std::string(option.help) + defaultOf(option), choice)) << option.name << " " << choice;
  }
  EXPECT_GT(with_choices, 15U);
}

TEST(Options, FilesHaveTheEndingsThatTheirFormatsNeed) {
  EXPECT_TRUE(isVdbFile("a.vdb") && isVdbFile("folder.x/A.VDB"));
  EXPECT_FALSE(isVdbFile("a.vdb.obj") || isVdbFile("vdb") || isVdbFile(""));
  for (const char* value : {"a.json", "folder/a.json"}) EXPECT_TRUE(takes(row("lattice"), value));
  for (const char* value : {"a.ktx2", "a", "", ".json"}) EXPECT_FALSE(takes(row("lattice"), value)) << value;
  for (const char* value : {"a.obj", "", "vdb"}) EXPECT_FALSE(takes(row("vdb"), value)) << value;
  for (const char* value : {"a.ply", "a.CSV"}) EXPECT_TRUE(takes(row("spheres"), value));
  EXPECT_FALSE(takes(row("spheres"), "a.txt"));
}

TEST(Options, LevelsDescend) {
  const std::string eight = "90%,80%,70%,60%,50%,40%,30%,20%";
  for (const std::string& value : {std::string("50%"), std::string("50%,25%,10%"), std::string("2000,4"), eight})
    EXPECT_TRUE(takes(row("lods"), value)) << value;
  for (const std::string& value :
       {std::string(""), std::string("0%"), std::string("100%"), std::string("120%"), std::string("-5%"), std::string("3"),
        std::string("25%,50%"), std::string("50%,50%"), std::string("50%,200"), std::string("50%,"), std::string("half"), eight + ",10%"})
    EXPECT_FALSE(takes(row("lods"), value)) << value;
  const std::vector<LevelSize> levels = settingsFor({"lods=50%,12.5%"}).mesh.levels;
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_EQ(levels[0].vertices(1001), 500U);
  EXPECT_EQ(levels[1].vertices(1000), 125U);
  EXPECT_EQ(settingsFor({"lods=700"}).mesh.levels.at(0).vertices(1001), 700U);
}

TEST(Options, OneMotionAtATime) {
  Settings settings = setAlone(row("turntable"), "8");
  const Option& sweep = row("sun-sweep");
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] { sweep.value.set(settings, sweep, "8"); }), "give only one of them"));
  settings = setAlone(row("turntable"), "8");
  row("turntable").value.set(settings, row("turntable"), "9");
  EXPECT_EQ(settings.picture.frame_count, 9);
}

// What a manifest may set: options of one asset, not of the run.
TEST(Options, ThoseOfAnAsset) {
  for (const char* name : {"rays", "seed", "bake_voxels", "domain", "close", "scene", "strict", "uv-set", "vertices", "lods"})
    EXPECT_NE(findAssetOption(name), nullptr) << name;
  for (const char* name : {"threads", "json", "dry-run", "shard", "memory", "html", "max-angle", "force", "sun", "against", "spheres",
                           "vdb", "lattice", "from-spheres", "rules", "nonsense"})
    EXPECT_EQ(findAssetOption(name), nullptr) << name;
  EXPECT_EQ(findAssetOption("size"), findOption("size", kGrow));
}

TEST(Options, IsGivenGoesByName) {
  const std::vector<Given> given = options({"rays=36", "bake-voxels=20"});
  EXPECT_TRUE(isGiven(given, "rays") && isGiven(given, "bake-voxels"));
  EXPECT_FALSE(isGiven(given, "voxels"));
}

}  // namespace
}  // namespace cloudbake
