#include "lsystem/recipe.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "tests/folders.h"
#include "tests/lsystem/lsystem_cases.h"

using namespace cloudbake;

namespace {

constexpr const char* kPresets[] = {"puffball",     "humilis",      "mediocris", "congestus", "anvil",       "stratoroll", "castellanus",
                                    "hero",         "lenticularis", "toon",      "swirl",     "fractus",     "bank",       "cirrus",
                                    "cumulonimbus", "horizon",      "mammatus",  "sprouting", "fairweather", "stormtower"};

CloudRecipe recipeIn(const std::string& folder, const std::string& name) {
  std::ifstream file(sourceFolder() / folder / (name + ".toml"), std::ios::binary);
  return parseRecipe({std::istreambuf_iterator<char>(file), {}}, name + ".toml");
}
CloudRecipe presetRecipe(const std::string& name) { return recipeIn("data/presets", name); }

CloudRecipe recipeOf(const std::string& text) { return parseRecipe(text, "cloud.toml"); }
InputError failureOf(const std::string& text, const std::string& piece) {
  return expectInputError([&] { recipeOf(text); }, piece);
}
bool sameBytes(const std::vector<Sphere>& a, const std::vector<Sphere>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Sphere)) == 0;
}

}  // namespace

// Row 33: counts of an independent program, for recipes that it has grown; none warns.
TEST(Recipe, Row33Counts) {
  const std::string recipes[] = {"puffball", "humilis", "mediocris", "congestus", "anvil", "stratoroll"};
  const size_t expected[6][2][3] = {{{403, 57, 55}, {445, 63, 60}},       {{553, 104, 94}, {550, 103, 88}},
                                    {{1619, 228, 194}, {1570, 221, 188}}, {{1281, 193, 168}, {1281, 193, 168}},
                                    {{1133, 232, 200}, {1133, 232, 200}}, {{589, 141, 115}, {631, 150, 123}}};
  for (size_t p = 0; p < 6; ++p)
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      CloudRecipe recipe = recipeIn("tests/lsystem/recipes", recipes[p]);
      Warnings warnings;
      recipe.derive.seed = seed;
      const ModuleString string = derive(parseGrammar(recipe.grammar, warnings), recipe.derive, recipe.turtle, warnings);
      const TurtlePath path = runTurtle(string, recipe.turtle, warnings);
      const auto spheres = spheresFromPath(path, recipe.spheres, warnings);
      EXPECT_EQ(string.modules.size(), expected[p][seed - 1][0]) << recipes[p];
      EXPECT_EQ(path.points.size(), expected[p][seed - 1][1]) << recipes[p];
      EXPECT_EQ(spheres.size(), expected[p][seed - 1][2]) << recipes[p];
      EXPECT_TRUE(warnings.empty()) << warnings.entries().begin()->second.first;
      EXPECT_TRUE(sameBytes(spheres, growSpheres(recipe, seed, warnings)));
    }
}

// All seeds are different, of one part once connected (unless parts are intended), and on average of the width and height that the files
// state.
TEST(Presets, SeedsDifferAndHangTogether) {
  const double sizes[][2] = {{3.0, 2.1}, {4.8, 2.2}, {5.1, 3.8}, {6.2, 7.1}, {8.4, 7.0}, {8.0, 2.1},  {9.4, 2.9},
                             {7.1, 5.4}, {6.5, 1.7}, {4.9, 2.4}, {7.3, 4.8}, {6.4, 1.7}, {32.4, 5.1}, {9, 3},
                             {14, 9},    {40, 5},    {9, 2},     {5, 5.2},   {12, 2},    {5.5, 6}};
  constexpr uint64_t kSeeds = 60;
  static_assert(std::size(sizes) == std::size(kPresets));
  for (size_t p = 0; p < std::size(sizes); ++p) {
    const CloudRecipe recipe = presetRecipe(kPresets[p]);
    std::set<std::pair<float, float>> seen;
    double width = 0, height = 0;
    std::pair<size_t, size_t> counts{SIZE_MAX, 0};
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
      Warnings warnings;
      const auto spheres = growSpheres(recipe, seed, warnings);
      const auto parts = findParts(spheres);
      EXPECT_TRUE(*std::max_element(parts.begin(), parts.end()) == 0 || recipe.spheres.connect == false) << kPresets[p] << " " << seed;
      EXPECT_TRUE(warnings.empty()) << kPresets[p] << " " << seed << ": " << warnings.entries().begin()->second.first;
      counts = {std::min(counts.first, spheres.size()), std::max(counts.second, spheres.size())};
      Box box;
      for (const Sphere& s : spheres) {
        box.add(s.center + Vec3{s.radius, s.radius, s.radius});
        box.add(s.center - Vec3{s.radius, s.radius, s.radius});
      }
      seen.insert({box.size().x, box.size().y});
      width += std::max(box.size().x, box.size().z) / double(kSeeds);
      height += box.size().y / double(kSeeds);
    }
    EXPECT_EQ(seen.size(), kSeeds) << kPresets[p];
    RecordProperty(kPresets[p], std::to_string(counts.first) + " to " + std::to_string(counts.second) + " spheres");
    EXPECT_NEAR(width, sizes[p][0], 0.1 * sizes[p][0]) << kPresets[p];
    EXPECT_NEAR(height, sizes[p][1], 0.1 * sizes[p][1]) << kPresets[p];
  }
}

// Which of kSide × kSide cells the spheres cover as seen along z, above their base, stretched to fill the box.
constexpr int kSide = 128;
std::vector<bool> outlineOf(const std::vector<Sphere>& spheres, float base) {
  Box box;
  for (const auto& [c, r] : spheres) box.add({c.x - r, std::max(base, c.y - r), 0}), box.add({c.x + r, std::max(base, c.y + r), 0});
  const Vec3 cell = box.size() / float(kSide);
  std::vector<bool> covered(size_t(kSide) * kSide);
  for (const auto& [c, r] : spheres)
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const float x = box.low.x + (float(i) + 0.5F) * cell.x - c.x, y = box.low.y + (float(j) + 0.5F) * cell.y - c.y;
        if (x * x + y * y < r * r) covered[size_t(j) * kSide + size_t(i)] = true;
      }
  return covered;
}

double overlapOf(const std::vector<bool>& a, const std::vector<bool>& b) {
  size_t both = 0, any = 0;
  for (size_t i = 0; i < a.size(); ++i) both += a[i] && b[i], any += a[i] || b[i];
  return double(both) / double(any);
}

// Seeds 1 to 3 of a genus look unlike each other: intersection over union of their outlines, each stretched to the same box.
TEST(Presets, SeedsHaveOutlinesOfTheirOwn) {
  const std::set<std::string> drawn{"hero", "swirl", "toon", "puffball"};  // drawn forms, which are alike at every seed
  for (const std::string name : kPresets) {
    std::vector<std::vector<bool>> outlines;
    const CloudRecipe recipe = presetRecipe(name);
    Warnings warnings;
    for (uint64_t seed = 1; seed <= 3; ++seed)
      outlines.push_back(outlineOf(growSpheres(recipe, seed, warnings), recipe.spheres.base ? float(*recipe.spheres.base) : -INFINITY));
    double most = 0;
    for (size_t a = 0; a < 3; ++a)
      for (size_t b = 0; b < a; ++b) most = std::max(most, overlapOf(outlines[a], outlines[b]));
    EXPECT_LT(most, drawn.contains(name) ? 0.95 : 0.84) << name;
    RecordProperty(name, std::to_string(most));
  }
}

// Row 34: threads change nothing, and one generation more keeps every old point's key.
TEST(Presets, Row34ThreadsAndGrowthChangeNothing) {
  for (const char* name : kPresets) {
    CloudRecipe recipe = presetRecipe(name);
    Warnings warnings;
    const auto alone = growSpheres(recipe, 1, warnings);
    std::vector<std::vector<Sphere>> results(4);
    std::vector<std::thread> threads;
    for (auto& result : results)
      threads.emplace_back([&recipe, &result] {
        Warnings own;
        result = growSpheres(recipe, 1, own);
      });
    for (std::thread& thread : threads) thread.join();
    for (const auto& result : results) EXPECT_TRUE(sameBytes(alone, result));

    const auto keysOf = [&](double generations) {
      recipe.derive.generations = generations;
      std::set<uint64_t> keys;
      for (const Module& m : derive(parseGrammar(recipe.grammar, warnings), recipe.derive, recipe.turtle, warnings).modules)
        if (m.symbol == 'F') keys.insert(m.key);  // no rule rewrites F
      return keys;
    };
    for (const double generations : {3.0, recipe.derive.generations}) {
      const auto young = keysOf(generations), old = keysOf(generations + 1);
      EXPECT_FALSE(young.empty() && generations > 3);
      EXPECT_TRUE(std::includes(old.begin(), old.end(), young.begin(), young.end())) << name;
    }
  }
}

TEST(Presets, LeaveOptionsToTheBake) {
  for (const char* name : kPresets) {
    const CloudRecipe recipe = presetRecipe(name);
    ASSERT_FALSE(recipe.bake_options.empty());
    EXPECT_EQ(recipe.bake_options[0].key, "blend");
    EXPECT_EQ(recipe.bake_options[0].value.back(), '%');
    const auto& options = recipe.bake_options;
    const bool has_base = std::any_of(options.begin(), options.end(), [](const auto& option) { return option.key == "flat_base"; });
    EXPECT_EQ(has_base, recipe.spheres.flat.has_value()) << name;
    EXPECT_GT(recipe.bake_options[0].line, 0);
  }
}

TEST(Recipe, ReadsEveryKey) {
  const CloudRecipe recipe = recipeOf(R"(
premise = 'A'
rules = ['A=FA', '''
B=F
C=F''']
context_ignore = '+-'
generations = 2.5
seed = 9
context_includes_siblings = true
inner_shape = [[0, 1, 2, 3.5]]
[variables]
b = 2
w2 = 0.5
[turtle]
step = 1
step_scale = 2
angle = 3
angle_scale = 4
thickness = 5
thickness_scale = 6
gravity = 7
uv_increment = 8
vertical_increment = 9
random_scale = 0.5
random_scale_all = true
segments = 3
continuous_length = false
continuous_angles = false
continuous_width = false
pitch_up = true
start_position = [1, 2, 3]
start_rotation = [4, 5, 6]
[spheres]
emit = "leaves"
size = 1.5
leaf_size = 2.5
width_power = 0.5
generation_power = 1
radius_min = 0.5
radius_max = 2
top_falloff = 0.25
base = -1
jitter = 0.125
squash = 0.5
ceiling = 4
flat = 0.42
connect = true
[limits]
max_modules = 100
max_passes = 10
max_steps = 1000
max_depth = 5
max_points = 50
max_spheres = 20
[bake]
rays = 64
as_published = true
bias = -0.003
blend = "2.5%"
)");
  EXPECT_EQ(recipe.grammar.premise.text, "A");
  EXPECT_EQ(recipe.grammar.premise.line, 2);
  EXPECT_EQ(recipe.grammar.premise.column, 12);
  ASSERT_EQ(recipe.grammar.rules.size(), 3U);
  EXPECT_EQ(recipe.grammar.rules[0].column, 11);
  EXPECT_EQ(recipe.grammar.rules[2].text, "C=F");
  EXPECT_EQ(recipe.grammar.rules[2].line, 5);
  EXPECT_EQ(recipe.grammar.context_ignore, "+-");
  EXPECT_EQ(recipe.grammar.variables, (std::vector<std::pair<std::string, double>>{{"b", 2}, {"w2", 0.5}}));
  EXPECT_EQ(recipe.derive.generations, 2.5);
  EXPECT_EQ(recipe.derive.seed, 9U);
  EXPECT_TRUE(recipe.derive.context_includes_siblings);
  ASSERT_EQ(recipe.derive.inner_shape.size(), 1U);
  EXPECT_EQ(recipe.derive.inner_shape[0].radius, 3.5F);
  const TurtleSettings& t = recipe.turtle;
  const double turtle[] = {t.step,         t.step_scale,        t.angle, t.angle_scale, t.thickness, t.thickness_scale, t.gravity,
                           t.uv_increment, t.vertical_increment};
  for (int k = 0; k < 9; ++k) EXPECT_EQ(turtle[k], k + 1);
  EXPECT_EQ(t.random_scale, 0.5);
  EXPECT_TRUE(t.random_scale_all && t.pitch_up && !t.continuous_length && !t.continuous_angles && !t.continuous_width);
  EXPECT_EQ(t.segments, 3);
  EXPECT_EQ(t.start_position, (Double3{1, 2, 3}));
  EXPECT_EQ(t.start_rotation, (Double3{4, 5, 6}));
  const SphereSettings& s = recipe.spheres;
  EXPECT_EQ(s.emit, Emit::kLeaves);
  const double spheres[] = {*s.size,       s.leaf_size, s.width_power, s.generation_power, s.radius_min, s.radius_max,
                            s.top_falloff, *s.base,     s.jitter,      s.squash,           *s.ceiling,   *s.flat};
  const double expected[] = {1.5, 2.5, 0.5, 1, 0.5, 2, 0.25, -1, 0.125, 0.5, 4, 0.42};
  for (int k = 0; k < 12; ++k) EXPECT_EQ(spheres[k], expected[k]) << k;
  EXPECT_TRUE(s.connect.value());
  EXPECT_EQ(recipe.derive.max_modules, 100U);
  EXPECT_EQ(recipe.derive.max_passes, 10);
  EXPECT_EQ(recipe.derive.max_steps, 1000U);
  EXPECT_EQ(t.max_depth, 5);
  EXPECT_EQ(t.max_points, 50U);
  EXPECT_EQ(s.max_spheres, 20U);
  ASSERT_EQ(recipe.bake_options.size(), 4U);
  const char* options[4][2] = {{"rays", "64"}, {"as_published", "true"}, {"bias", "-0.003"}, {"blend", "2.5%"}};
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(recipe.bake_options[k].key, options[k][0]);
    EXPECT_EQ(recipe.bake_options[k].value, options[k][1]);
    EXPECT_EQ(recipe.bake_options[k].line, int(56 + k));
  }
}

// Errors inside a rule point into the file, however the rules are written.
TEST(Recipe, RuleErrorsPointIntoTheFile) {
  const auto placeOf = [](const std::string& text) {
    const CloudRecipe recipe = recipeOf(text);
    Warnings warnings;
    const InputError error = expectInputError([&] { parseGrammar(recipe.grammar, warnings); }, "unknown variable \"q\"");
    return std::pair(error.line, error.column);
  };
  EXPECT_EQ(placeOf("premise='A'\nrules = '''\nA=FA\nA=F( q )\n'''"), std::pair(4, 6));
  EXPECT_EQ(placeOf("premise='A'\nrules = '''A=F(q)\nB=F'''"), std::pair(2, 16));
  EXPECT_EQ(placeOf("premise='A'\r\nrules = [\r\n  'A=FA',\r\n  'A=F(q)']"), std::pair(4, 8));
  EXPECT_EQ(placeOf("premise='A'\nrules = [\"A=F(q)\"]"), std::pair(2, 15));
  EXPECT_EQ(placeOf("premise='A'\nrules = [\"A=\\\\F(q)\"]"), std::pair(2, 0));  // an escape: the line alone is sure
  EXPECT_EQ(placeOf("premise='F(q)'"), std::pair(1, 12));
}

TEST(Recipe, RefusesWithPlaceAndCure) {
  const InputError unknown = failureOf("premise = 'A'\ngeneration = 3\n", "did you mean \"generations\"");
  EXPECT_EQ(unknown.line, 2);
  EXPECT_EQ(failureOf("premise = 'A'\n[turtle]\n\nstepscale = 2", "did you mean \"step_scale\"").line, 4);
  failureOf("premise = 'A'\n[spheres]\nzzzzzz = 2", "unknown key 'zzzzzz' in [spheres]");
  const InputError syntax = failureOf("premise = 'A'\nrules = [\n'A=F'", "not valid TOML");
  EXPECT_GT(syntax.line, 1);
  EXPECT_GT(syntax.column, 0);
  failureOf("premise = \"A\\/\"", "not valid TOML");
  failureOf("rules = ['A=F']", "no premise");
  failureOf("premise = ''", "no premise");
  failureOf("premise = 3", "premise must be");
  failureOf("premise = '''A\nB'''", "one line");
  failureOf("premise = 'A'\nrules = 3", "rules must be");
  failureOf("premise = 'A'\nrules = [3]", "rules must be");
  failureOf("premise = 'A'\ngenerations = -1", "generations must be a number of 0 or more");
  failureOf("premise = 'A'\ngenerations = nan", "generations must be");
  failureOf("premise = 'A'\ngenerations = '3'", "generations must be");
  failureOf("premise = 'A'\nseed = 1.5", "whole number");
  failureOf("premise = 'A'\nseed = -1", "whole number");
  failureOf("premise = 'A'\nturtle = 3", "[turtle]");
  failureOf("premise = 'A'\n[turtle]\nthickness = 0", "above 0");
  failureOf("premise = 'A'\n[turtle]\nrandom_scale = 2", "from 0 to 1");
  failureOf("premise = 'A'\n[turtle]\npitch_up = 1", "true or false");
  failureOf("premise = 'A'\n[turtle]\nstart_position = [1, 2]", "three numbers");
  failureOf("premise = 'A'\n[spheres]\nemit = \"all\"", "emit must be one of points, leaves, both");
  failureOf("premise = 'A'\ninner_shape = [[0, 0, 0]]", "list of spheres");
  failureOf("premise = 'A'\n[bake]\nrays = [[1]]", "no option takes this");
  failureOf("premise = 'A'\n[variables]\nw = 'x'", "must be a number");
}

// Keys of thousands of parts would exhaust the stack of the TOML reader. Dots elsewhere are none.
TEST(Recipe, RefusesDeepKeys) {
  std::string parts = "a";
  for (int k = 0; k < 50000; ++k) parts += ".a";
  EXPECT_EQ(failureOf("premise = 'F'\n" + parts + " = 1\n", "more than 8 parts").line, 2);
  EXPECT_EQ(failureOf("\n\n[" + parts + "]\n", "more than 8 parts").line, 3);
  EXPECT_EQ(failureOf("x = {'a' . \"b\"" + parts.substr(1) + " = 1}\n", "more than 8 parts").line, 1);
  const CloudRecipe recipe = recipeOf(R"(premise = '{F.F.F.F.F.F.F.F.F.F}' # a.b.c.d.e.f.g.h.i.j.k
rules = ["A=\"..........", '''
B=...........
''']
inner_shape = [[0.5, 0.5, 0.5, 1.5], [0.5, 0.5, 0.5, 1.5], [0.5, 0.5, 0.5, 1.5]]
)");
  EXPECT_EQ(recipe.grammar.rules.size(), 3U);
}

TEST(Recipe, RefusesLettersOutsideTexts) {
  EXPECT_EQ(failureOf("premise = 'F'\nprémisse = 2\n", "outside ASCII").line, 2);
  failureOf("premise = “F”\n", "outside ASCII");
  failureOf("premise = 'F'\n\xE3\x80\x81 = 1\n", "outside ASCII");
  EXPECT_EQ(recipeOf("\xEF\xBB\xBFpremise = 'F' # é\n").grammar.premise.text, "F");
}

// A long list on one line is read in one go; each rule keeps its place.
TEST(Recipe, RulesOnOneLine) {
  std::string text = "premise = 'F'\nrules = [";
  for (int k = 0; k < 20000; ++k) text += k % 2 == 0 ? "'F=FF'," : "\"F=FF\",";
  const CloudRecipe recipe = parseRecipe(text + "]\n", "long.toml");
  ASSERT_EQ(recipe.grammar.rules.size(), 20000U);
  EXPECT_EQ(recipe.grammar.rules[19999].column, 10 + 7 * 19999 + 1);
}

TEST(Rules, PlainList) {
  const CloudRecipe recipe = parseRules("# a comment\npremise: FA\ncontext_ignore: +-\n\nA = FA\n  B=F(1) \n", "r.txt");
  Warnings warnings;
  const Grammar grammar = parseGrammar(recipe.grammar, warnings);
  EXPECT_EQ(grammar.premise.size(), 2U);
  EXPECT_EQ(grammar.rules.size(), 2U);
  EXPECT_EQ(grammar.rules[1].line, 6);
  EXPECT_EQ(grammar.rules[1].column, 3);
  EXPECT_TRUE(grammar.context_ignore.test('+'));
  EXPECT_FALSE(grammar.context_ignore.test('F'));
  EXPECT_EQ(expectInputError([&] { parseGrammar(parseRules("premise: F\nA=F(q)\n", "r.txt").grammar, warnings); }, "\"q\"").line, 2);
}

TEST(Rules, HeadersStandOnce) {
  Warnings warnings;
  expectInputError([&] { growSpheres(parseRules("A=F\n", "r.txt"), 1, warnings); }, "no premise");
  EXPECT_EQ(expectInputError([] { parseRules("premise: A\npremise: B\n", "r.txt"); }, "appears twice").line, 2);
}

// A list of rules with its parameters beside it gives what the same parameters in TOML give.
TEST(Rules, ParametersAsAKeyEach) {
  CloudRecipe rules = parseRules("A=F(q)[+FA][-FA]\n", "r.txt");
  const std::pair<const char*, const char*> given[] = {
      {"premise", "!A"},       {"generations", "4.5"}, {"angle", "+33"},       {"variable", "q=.25,unused=3"},
      {"thickness", "1"},      {"size", ".4"},         {"emit", "points"},     {"start_position", "1,2,3"},
      {"context_ignore", "F"}, {"connect", "true"},    {"base", "0"},          {"squash", "0.5"},
      {"count", "50"},         {"domain", "4x2x3"},    {"max_modules", "5000"}};
  for (const auto& [key, value] : given) setRecipeKey(rules, key, value);
  const CloudRecipe toml = recipeOf(
      "premise = '!A'\nrules = ['A=F(q)[+FA][-FA]']\ngenerations = 4.5\ncontext_ignore = 'F'\n[variables]\nq = 0.25\nunused = "
      "3\n[turtle]\nangle = 33\n"
      "thickness = 1\nstart_position = [1, 2, 3]\n[spheres]\nsize = 0.4\nemit = 'points'\nconnect = true\nbase = 0\nsquash = 0.5\ncount = "
      "50\n"
      "domain = [4, 2, 3]\n[limits]\nmax_modules = 5000");
  EXPECT_EQ(rules.grammar.context_ignore, toml.grammar.context_ignore);
  EXPECT_EQ(rules.grammar.variables, toml.grammar.variables);
  EXPECT_EQ(rules.derive.max_modules, 5000U);
  Warnings warnings;
  const auto spheres = growSpheres(rules, 3, warnings);
  EXPECT_EQ(spheres.size(), 50U);
  EXPECT_TRUE(sameBytes(spheres, growSpheres(toml, 3, warnings)));
  setRecipeKey(rules, "domain", "none");
  setRecipeKey(rules, "count", "none");
  EXPECT_FALSE(rules.spheres.domain || rules.spheres.count);
}

TEST(Rules, KeysRefuseWhatTomlWouldRefuse) {
  CloudRecipe recipe;
  const std::pair<const char*, const char*> wrong[] = {
      {"size", "0"},         {"size", "wide"},      {"segments", "0"},      {"segments", "2.5"},
      {"connect", "1"},      {"emit", "some"},      {"domain", "1x2"},      {"domain", "0,0,0"},
      {"domain", "-1x1x1"},  {"count", "0"},        {"variable", "q"},      {"variable", "=3"},
      {"variable", "q=two"}, {"domain", "4x2x3x"},  {"domain", "4,2,3,"},   {"start_position", "1,,2"},
      {"variable", "q=1,"},  {"generations", "-1"}, {"generations", "inf"}, {"base", "low"},
      {"max_spheres", "0"}};
  for (const auto& [key, value] : wrong) EXPECT_THROW(setRecipeKey(recipe, key, value), InputError) << key << " = " << value;
  expectInputError([&] { setRecipeKey(recipe, "sise", "1"); }, "unknown key");
}

// Rules as they stand in Houdini's parameter fields, quotes, backslashes, percent sign and all; growth from generation to generation is
// smooth: no point jumps by more than the newest symbols grow.
TEST(Rules, PastedFromHoudini) {
  CloudRecipe recipe = parseRules(
      "premise: FFFA\n"
      "A=\"(1)^;(0.2)+;(5)F[T]C:0.2\n"
      "A=%:0.1\n"
      "A=\"(0.9)F[+B]&FA:0.7\n"
      "B=!FA\n"
      "T=;(0.2)+\"(0.6)FD:0.3\n"
      "C=[\\A][\\\\A]\\\\\\A\n",
      "r.txt");
  Warnings warnings;
  const Grammar grammar = parseGrammar(recipe.grammar, warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(grammar.rules[0].replacement[0].symbol, '"');
  EXPECT_EQ(grammar.rules[1].replacement[0].symbol, '%');
  EXPECT_EQ(grammar.rules[5].replacement.size(), 13U);
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    recipe.derive.seed = seed;
    std::map<uint64_t, Double3> before;
    for (int step = 40; step <= 80; ++step) {
      recipe.derive.generations = step / 10.0;
      Warnings quiet;
      const TurtlePath path = runTurtle(derive(grammar, recipe.derive, recipe.turtle, quiet), recipe.turtle, quiet);
      std::map<uint64_t, Double3> now;
      for (const TurtlePoint& point : path.points) now.try_emplace(point.key, point.position);
      for (const auto& [key, position] : before)
        EXPECT_TRUE(!now.contains(key) || length(now[key] - position) < 0.35) << "seed " << seed << ", generation " << step / 10.0;
      before = std::move(now);
    }
    recipe.derive.generations = 7.5;
    EXPECT_GE(growSpheres(recipe, seed, warnings).size(), 4U);
  }
}

// What the summary counts, on a string small enough to count by hand.
TEST(Summary, CountsWhatBecameOfThePoints) {
  CloudRecipe recipe =
      recipeOf("premise = 'FA'\nrules = ['A=F[+F]J(0)A']\ngenerations = 2\n[turtle]\nstep = 10\n[spheres]\nsize = 1\ncount = 4");
  Warnings warnings;
  GrowthSummary summary;
  const auto spheres = growSpheres(recipe, 1, warnings, &summary);
  ASSERT_EQ(summary.generations.size(), 3U);
  EXPECT_EQ(summary.generations[0], (SymbolCounts{{'A', 1}, {'F', 1}}));
  EXPECT_EQ(summary.generations[2], (SymbolCounts{{'A', 1}, {'F', 5}, {'J', 2}, {'[', 2}, {']', 2}, {'+', 2}}));
  EXPECT_EQ(summary.expansion, "FF[+F]J(0)F[+F]J(0)A");
  EXPECT_EQ(summary.points, 6U);
  EXPECT_EQ(summary.leaves, 2U);
  EXPECT_EQ(summary.without_radius, 2U);
  EXPECT_EQ(summary.hidden, 0U);
  EXPECT_EQ(summary.over_count, 2U);
  EXPECT_EQ(summary.parts, 4);
  EXPECT_FALSE(summary.connected);
  ASSERT_EQ(summary.radii.size(), 4U);
  EXPECT_EQ(summary.radii[2], spheres[2].radius);
}

TEST(Recipe, FieldsCanBeOverridden) {
  CloudRecipe recipe = recipeOf("premise = 'F'\nrules = ['F=FF']\n[spheres]\nsize = 1\nradius_min = 1\nradius_max = 1");
  recipe.derive.generations = 2;
  recipe.turtle.step = 10;
  recipe.spheres.size = 0.5;
  Warnings warnings;
  const auto spheres = growSpheres(recipe, 1, warnings);
  ASSERT_EQ(spheres.size(), 5U);
  EXPECT_EQ(spheres[4].center, (Vec3{0, 40, 0}));
  EXPECT_EQ(spheres[4].radius, 0.5F);
}
