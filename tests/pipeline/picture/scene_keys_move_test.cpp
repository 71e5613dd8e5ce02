// Every key of a scene file counts: with another value of it, `preview` draws another picture. And the reference has every key that a scene
// file may have.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "core/harmonics.h"
#include "core/text/numbers.h"
#include "pipeline/picture/scene_picture.h"
#include "pipeline/scene/scene_keys.h"
#include "tests/pipeline/picture_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

// A small scene in which keys of a table are seen: the text before the table's lines, its lines, and the text behind them.
struct Stage {
  std::string table, before;
  std::vector<std::string> lines;
  std::string after;
};

const std::string kSmall = "[picture]\nwidth = 24\nheight = 16\ntime = 30\n";
const std::string kTwoClouds = "[[cloud]]\nfile = 'a.glb'\n[[cloud]]\nfile = 'a.glb'\nposition = [0.7, 0.4, -4]\n";
// Two clouds, one behind the other; the sun is behind both.
const std::string kBeforeClouds = "[picture]\nwidth = 48\nheight = 32\ntime = 30\n[camera]\nposition = [0, 0.5, 6]\ntarget = [0, 0.2, 0]\n";
const std::string kClouds = kBeforeClouds + "[sun]\nazimuth = 180\nelevation = 6\n";
const std::string kLandscape = kSmall + "[camera]\nposition = [0, 1.2, 22]\ntarget = [0, 4.2, 0]\nfov = 46\n";
const std::string kSun = "[sun]\nazimuth = 75\nelevation = 34\n", kSunAhead = "[sun]\nazimuth = 180\nelevation = 14\n";
const std::string kPlace = "scale = 0.03\norigin = [30, -4.6, 10]\n";
const std::string kUpwards = kSmall + "[camera]\nposition = [0, 0.5, 9]\ntarget = [0, 4.5, 0]\nfov = 60\n";
const std::string kNight =
    kSmall + "[camera]\nposition = [0, 0.5, 9]\ntarget = [0, 3, 0]\nfov = 12\n[sun]\nazimuth = 0\nelevation = -8.6\n[sky]\n";
// On the terrain's path, just above the ground.
const std::string kFlight = kSmall + "[camera]\npath = 'terrain'\n[sun]\nazimuth = 75\nelevation = 34\n";

// Two stages of a terrain, as ours and in its own sky; of a part of it the table's own lines come first.
std::vector<Stage> terrainStages(const std::string& part, const std::vector<std::string>& lines = {}) {
  std::vector<Stage> stages;
  for (const std::string own : {"", "as_published = true\n"})
    for (const std::string& sun : {kSun, kSunAhead})
      stages.push_back({"terrain." + part, kLandscape + sun + "[terrain]\n" + own + kPlace + "[terrain." + part + "]\n", lines, ""});
  return stages;
}

std::vector<Stage> allStages() {
  std::vector<Stage> stages{
      {"picture",
       "[camera]\nposition = [0, 0.5, 6]\ntarget = [0, 0.2, 0]\n[picture]\n",
       {"width = 48", "height = 32", "time = 5"},
       "[chain]\nswirl_strength = 0.1\n" + kTwoClouds},
      {"camera", kSmall + "[camera]\n", {}, kTwoClouds},
      {"sun", kSmall + "[sun]\nhour = 9\n", {"day_seconds = 100"}, kTwoClouds},
      {"sun", kSmall + "[sun]\n", {"hour = 9"}, kTwoClouds},
      {"sky.colors", kUpwards + kSunAhead + "[sky.colors]\n", {}, kTwoClouds},
      {"sky.colors", kClouds + "[sky.colors]\n", {}, kTwoClouds},
      {"sky.colors", kLandscape + "[sky.colors]\n", {}, kTwoClouds},
      {"sky", kUpwards + kSunAhead + "[sky]\n", {}, kTwoClouds},
      {"sky", kUpwards + kSunAhead + "[sky]\nhorizon_color = [1, 0, 0]\n", {}, kTwoClouds},
      {"sky", kUpwards + kSunAhead + "[sky]\ndisc = 'smooth'\n", {}, kTwoClouds},
      {"sky.moon", kNight + "[sky.moon]\nazimuth = 180\nelevation = 17\n", {}, kTwoClouds},
      {"sky.moon", kBeforeClouds + "[sun]\nelevation = -14\n[sky]\n[sky.moon]\nelevation = 60\n", {}, kTwoClouds},
      {"sky.stars", kNight + "[sky.stars]\n", {"count = 2000", "brightness = 3", "size = 1"}, kTwoClouds},
      {"sky.moon", kNight + "[sky.moon]\nazimuth = 180\nelevation = 17\ndisc = 'smooth'\n", {}, kTwoClouds},
      {"sky.aurora",
       kSmall + "[camera]\nposition = [0, 0.5, 9]\ntarget = [0, 4.5, 0]\nfov = 60\n[sun]\nelevation = -9\n[sky.aurora]\n",
       {"strength = 4"},
       kTwoClouds},
      {"light", kClouds + "[light]\n", {}, kTwoClouds},
      {"lamp", kClouds + "[[lamp]]\n", {"place = [2, 1, 2]", "strength = 4", "range = 6", "radius = 2"}, kTwoClouds},
      {"lamp",
       kClouds + "[[lamp]]\nplace = [0, 1, 4]\nstrength = 9\n",
       {"look_at = [0, 0.5, 0]", "inner_angle = 5", "outer_angle = 12"},
       kTwoClouds},
      {"lightning",
       kClouds + "[[lightning]]\n",
       {"place = [2, 1, 2]", "strength = 4", "range = 6", "radius = 2", "spread = [1, 1, 1]", "at = 29.7", "decay = 0.1", "seed = 7"},
       kTwoClouds},
      {"lightning", kClouds + "[[lightning]]\nplace = [2, 1, 2]\nstrength = 4\n", {"every = 2"}, kTwoClouds},
      {"fog", kClouds + "[fog]\n", {"density = 0.5", "scatter = 0.5"}, kTwoClouds},
      {"chain", kClouds + "[chain]\n", {"near_width = 0.05", "swirl_strength = 0.1"}, kTwoClouds},
      {"chain", kClouds + "[chain]\nas_published = true\n", {"swirl_strength = 0.1", "divisor = 1"}, "[fog]\ndensity = 3\n" + kTwoClouds},
      {"cloud.scatter",
       kBeforeClouds + kSun + "[[cloud]]\nfile = 'a.glb'\nscale = [0.6, 0.4, 0.3]\n[cloud.scatter]\nlow = [-3, 0, -3]\nhigh = [3, 1, 1]\n",
       {"count = 12", "drift = [1, 0, 0]"},
       ""},
      {"slab", kUpwards + kSun + "[[slab]]\n", {"outline_start = 0.02", "outline_full = 0.1"}, ""},
      {"slab", kUpwards + "[sun]\nelevation = -8\n[[slab]]\n", {"shadow = [1, 1, 1]", "middle = [1, 1, 1]", "light = [1, 1, 1]"}, ""},
      {"marched by distance", kUpwards + kSun + "[[marched]]\n", {"search_steps = 8", "shadow_tuning = 1"}, ""},
      {"marched by distance", kUpwards + kSun + "[[marched]]\n", {"search_farthest = 12"}, ""},
      {"marched by density", kUpwards + kSunAhead + "[[marched]]\nfield = 'density'\n", {"samples = 8"}, ""},
      {"dust",
       kSmall + "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n" + kSun + "[[dust]]\nlattice = 'a.json'\n",
       {"thickness = 1", "samples = 3"},
       ""},
      {"terrain", kLandscape + kSunAhead + "[terrain]\n", {"scale = 0.03", "origin = [30, -4.6, 10]"}, ""},
      {"terrain.path", kFlight + "[terrain]\n[terrain.path]\n", {}, ""},
      {"terrain.shape", kFlight + "[terrain]\n[terrain.shape]\n", {}, ""},
      {"terrain.march",
       kFlight + "[terrain]\n[terrain.shape]\ncamera_octaves = 9\n[terrain.path]\nclearance = 0.3\n[terrain.march]\n",
       {},
       ""},
      {"grade", kFlight + "[terrain]\n[grade]\nmotion_blur = true\n", {"shutter = 2", "vignette = 0.5", "contrast = 0.4"}, ""},
  };
  for (const char* part : {"shape", "fbm", "shadow", "ground", "light", "sky", "fog"})
    for (const Stage& stage : terrainStages(part)) stages.push_back(stage);
  for (const Stage& stage : terrainStages("march", {"steps = 40", "farthest = 400"})) stages.push_back(stage);
  for (const Stage& stage : terrainStages("shadow", {"steps = 8"})) stages.push_back(stage);
  return stages;
}

// The text of a stage in which a key has this value.
std::string textOf(const Stage& stage, const std::string& key = "", const std::string& value = "") {
  std::string text = stage.before;
  for (const std::string& line : stage.lines)
    if (key.empty() || !line.starts_with(key + " =")) text += line + "\n";
  return text + (key.empty() ? "" : key + " = " + value + "\n") + stage.after;
}

SceneFile readStage(const std::string& text) {
  SceneFile scene = readSceneFile("scene", text, [](const PictureSettings& view) { return view; });
  HarmonicLattice lattice;
  lattice.order = 1, lattice.extinction = 1, lattice.cell_size = 1, lattice.cells = {3, 3, 3}, lattice.origin = {-1, -1, -1};
  for (int i = 0; i < 27; ++i) lattice.coefficients.insert(lattice.coefficients.end(), {1.5F, 0.2F, 0.3F, 0.1F * float(i % 5)});
  for (SceneDust& dust : scene.dust) dust.lattice = std::make_shared<const HarmonicLattice>(lattice);
  return scene;
}

const BakedMesh& litBall() {
  static const BakedMesh mesh = [] {
    BakedMesh made = bakedBall(1, {}, 3);
    made.info.volume.emplace();  // so that volume_gain is of use
    made.colors.assign(made.lobes.size(), {1, 0.7F, 0.5F});
    made.info.harmonic_order = 1;
    for (size_t v = 0; v < made.lobes.size(); ++v) made.harmonics.insert(made.harmonics.end(), {1, 0.2F, -0.1F, 0.3F});
    return made;
  }();
  return mesh;
}

// The ball in cells.
ShadowCaster ballCaster() {
  constexpr int kCells = 10;
  ShadowCaster caster{.origin = {-0.9F, -0.9F, -0.9F}, .cell_size = 0.2F, .cells = {kCells, kCells, kCells}, .fractions = {}};
  for (int i = 0; i < kCells * kCells * kCells; ++i) {
    const int row = i / kCells % kCells, slice = i / kCells / kCells;
    const Vec3 cell{float(i % kCells), float(row), float(slice)};
    caster.fractions.push_back(length(caster.origin + cell * caster.cell_size) < 1 ? 255 : 0);
  }
  return caster;
}

Image drawText(const std::string& text) {
  static const ShadowCaster caster = ballCaster();
  const SceneFile scene = readStage(text);
  Scenery scenery;
  for (const SceneCloud& cloud : scene.clouds) scenery.instances.push_back({&litBall(), cloud.to_world, &caster});
  for (const SceneField& field : scene.fields)
    scenery.fields.push_back(
        {field.scatter, scatterClouds(field.scatter, field.weights), {{&litBall(), field.clouds.front().to_world, &caster}}});
  DrawnParts parts;
  return drawScene(scene, instancesAt(scenery, scene.view), {}, parts);
}

bool areDifferent(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) return true;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const Vec3 off = a.pixels[i] - b.pixels[i];
    if (std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) > 1.0F / 255) return true;
  }
  return false;
}

// Other numbers within the limits.
std::vector<double> otherNumbers(double number, double low, double high) {
  std::vector<double> others{number * 2, number / 2, number * 4, number / 4, number * 1.1};
  if (number == 0) others = {1, -1, 0.3};
  if (high - low <= 1000)
    for (const double share : {0.9, 0.1, 0.5}) others.push_back(low + share * (high - low));
  for (double& other : others) other = std::clamp(other, low, high);
  return others;
}

// Other values of the same form.
std::vector<std::string> otherValues(const DescribedKey& key) {
  if (key.value == "true" || key.value == "false") return {key.value == "true" ? "false" : "true"};
  if (key.value == "unset") return {"2", "20", "[1, 0, 0.5]"};
  std::vector<std::string> values;
  std::string numbers = key.value;
  std::replace_if(
      numbers.begin(), numbers.end(), [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
  std::istringstream stream(numbers);
  const bool is_list = key.value.front() == '[';
  for (double number; stream >> number;) {
    const std::vector<double> others = otherNumbers(number, key.low, key.high);
    values.resize(std::max(values.size(), others.size()), is_list ? "[" : "");
    for (size_t i = 0; i < others.size(); ++i) values[i] += (values[i].size() > 1 && is_list ? ", " : "") + shortestText(others[i]);
  }
  for (std::string& value : values) value += is_list ? "]" : "";
  return values;
}

// Whether a value of the key changes the picture of the stage. A value that a file may not have is not drawn.
bool isSeen(const Stage& stage, const DescribedKey& key, const Image& before) {
  for (const std::string& value : otherValues(key)) {
    try {
      if (areDifferent(before, drawText(textOf(stage, key.name, value)))) return true;
    } catch (const InputError&) {
    }
  }
  return false;
}

// Keys that only matter before anything is drawn, and the test of each.
const std::map<std::string, const char*> kNotDrawn{
    {"cloud.file", "names a file: picture_test"},
    {"cloud.files", "names files: cli/preview_scenes"},
    {"cloud.levels", "names files: picture_test"},
    {"cloud.presets", "grows clouds: cli/preview_scenes"},
    {"cloud.weights", "of several files: scatter_test, cli/preview_scenes"},
    {"cloud.preset", "grows a cloud: picture_test"},
    {"cloud.seed", "grows a cloud: picture_test"},
    {"cloud.vertices", "grows a cloud: picture_test"},
    {"cloud.lobe", "grows a cloud: picture_test"},
    {"dust.lattice", "names a file: dust_lattice_test"},
    {"sky.moon.picture", "names a file: picture_test"},
    {"picture.start", "of motion: picture_test"},
    {"sky.ramp", "names a file: scene_file_test"},
    {"sky.ramp_low", "of a picture: scene_file_test"},
    {"sky.ramp_high", "of a picture: scene_file_test"},
    {"sky.ramp_columns", "of a picture: scene_file_test"},
    {"sky.ramp_gain", "of a picture: scene_file_test"},
    {"volume.view_extinction", "of bakes: scene_file_test"},
    {"volume.phase", "of bakes: scene_file_test"},
    {"volume.octaves", "of bakes: scene_file_test"},
    {"volume.octave_extinction", "of bakes: scene_file_test"},
    {"volume.octave_contribution", "of bakes: scene_file_test"},
};

TEST(SceneKeys, EachChangesThePicture) {
  std::set<std::string> unseen, seen;
  for (const Stage& stage : allStages()) {
    const std::string text = textOf(stage);
    std::optional<Image> before;
    for (const DescribedKey& key : describeKeys(readStage(text))) {
      const std::string name = key.table + "." + key.name;
      if (kNotDrawn.contains(name)) continue;
      if (key.table != stage.table) {
        if (!seen.contains(name)) unseen.insert(name);
        continue;
      }
      if (seen.contains(name)) continue;
      if (!before) before = drawText(text);
      if (isSeen(stage, key, *before))
        seen.insert(name), unseen.erase(name);
      else
        unseen.insert(name);
    }
  }
  for (const std::string& name : unseen) ADD_FAILURE() << name << " changes no pixel of its stages";
  for (const auto& [key, why] : kNotDrawn) EXPECT_FALSE(seen.contains(key)) << key << " is drawn";
}

// Two scenes that differ in one key that is no field of a struct.
struct Pair {
  std::string key, before, line, other, after;
};

std::vector<Pair> specialPairs() {
  const std::string published = "as_published = true\n", terrain = kLandscape + kSun + "[terrain]\n" + kPlace;
  const std::string dust = kSmall + "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n[[dust]]\nlattice = 'a.json'\nthickness = 3\n";
  const std::string cloud = kClouds + "[[cloud]]\nfile = 'a.glb'\nscale = [1, 0.4, 0.7]\n", hours = "[[sky.hours]]\nelevation = -30\n";
  const std::string field = kBeforeClouds + "[[cloud]]\nfile = 'a.glb'\nscale = 0.4\n[cloud.scatter]\ncount = 12\n";
  const std::string shaded = kSmall + "[sun]\nazimuth = 90\nelevation = 12\n[light]\n",
                    in_a_row = "[[cloud]]\nfile = 'a.glb'\n[[cloud]]\nfile = 'a.glb'\nposition = [2.5, 0, 0]\n";
  const std::string marched = kUpwards + kSun + "[[marched]]\n", moon = kNight + "[sky.moon]\nphase = 90\n";
  return {
      {"picture.layout", kSmall, "", "layout = 'techniques'\n", kTwoClouds},
      {"camera.path", kSmall + "[terrain]\n[camera]\n", "position = [0, 9, 1]\ntarget = [0, 9, 0]\n", "path = 'terrain'\n", ""},
      {"camera.position", kSmall + "[camera]\ntarget = [0, 0, 0]\n", "position = [0, 0, 6]\n", "position = [0, 0, 5]\n", kTwoClouds},
      {"camera.target", kSmall + "[camera]\nposition = [0, 0, 6]\n", "target = [0, 0, 0]\n", "target = [1, 0, 0]\n", kTwoClouds},
      {"sun.azimuth", kSmall + "[sun]\n", "", "azimuth = [40, 60]\n", kTwoClouds},
      {"sun.elevation", kSmall + "[sun]\n", "", "elevation = 60\n", kTwoClouds},
      {"sky.as_published", kUpwards + kSunAhead + "[sky]\n", "", published, kTwoClouds},
      {"sky.disc", kUpwards + kSunAhead + "[sky]\n", "disc = 'none'\n", "disc = 'smooth'\n", kTwoClouds},
      {"sky.hours.elevation", kClouds + hours + "zenith = [1, 0, 0]\n[[sky.hours]]\n", "elevation = 30\n", "elevation = 60\n", kTwoClouds},
      {"sky.moon.azimuth", moon + "elevation = 17\n", "azimuth = 180\n", "azimuth = 181\n", kTwoClouds},
      {"sky.moon.elevation", moon + "azimuth = 180\n", "elevation = 17\n", "elevation = 18\n", kTwoClouds},
      {"sky.moon.disc", moon + "elevation = 17\n", "", "disc = 'smooth'\n", kTwoClouds},
      {"sky.moon.up", moon + "elevation = 17\n", "", "up = [1, 0, 0]\n", kTwoClouds},
      {"sky.stars.pole", kNight + "[sky.stars]\nbrightness = 9\nsize = 2\nturn = 30\n", "", "pole = [1, 0, 0]\n", kTwoClouds},
      {"light.cloud_shade", shaded, "cloud_shade = 'none'\n", "cloud_shade = 'each'\n", in_a_row},
      {"light.cloud_shade", shaded, "cloud_shade = 'none'\n", "cloud_shade = 'grid'\n", in_a_row},
      {"chain.as_published", kClouds + "[chain]\n", "", published, kTwoClouds},
      {"chain.mean", kClouds + "[chain]\n" + published, "", "mean = 'all'\n", kTwoClouds},
      {"cloud.position", cloud, "", "position = [0, 0.3, 0]\n", ""},
      {"cloud.rotation", cloud, "", "rotation = [0, 0, 40]\n", ""},
      {"cloud.scale", kClouds + "[[cloud]]\nfile = 'a.glb'\n", "", "scale = 0.7\n", kTwoClouds},
      {"cloud.scatter.low", field + "high = [3, 1, 1]\n", "low = [-3, 0, -3]\n", "low = [-2, 0, -3]\n", ""},
      {"cloud.scatter.high", field + "low = [-3, 0, -3]\n", "high = [3, 1, 1]\n", "high = [3, 2, 1]\n", ""},
      {"slab.as_published", kUpwards + kSun + "[[slab]]\n", "", published, ""},
      {"marched by distance.field", marched, "field = 'distance'\n", "field = 'density'\n", ""},
      {"marched by density.field", marched, "field = 'density'\n", "field = 'distance'\n", ""},
      {"marched by distance.as_published", marched, "", published, ""},
      {"marched by density.as_published", marched + "field = 'density'\n", "", published, ""},
      {"dust.position", dust, "", "position = [0, 0.5, 0]\n", ""},
      {"dust.rotation", dust, "", "rotation = [0, 0, 40]\n", ""},
      {"dust.scale", dust, "", "scale = 0.7\n", ""},
      {"terrain.as_published", terrain, "own_sky = true\n", published, ""},
      {"terrain.own_sky", terrain, "", "own_sky = true\n", ""},
      {"terrain.ground.snow_side", terrain + "[terrain.ground]\n", "", "snow_side = 75\n", ""},
      {"grade.gamma", kFlight + "[terrain]\n[grade]\n", "", "gamma = 'sqrt'\n", ""},
      {"grade.motion_blur", kFlight + "[terrain]\n[grade]\nshutter = 2\n", "", "motion_blur = true\n", ""},
  };
}

TEST(SceneKeys, EachSpecialOneChangesThePicture) {
  std::set<std::string> seen;
  for (const auto& [key, before, line, other, after] : specialPairs()) {
    EXPECT_TRUE(areDifferent(drawText(before + line + after), drawText(before + other + after))) << key;
    seen.insert(key);
  }
  for (const SpecialKey& key : specialKeys()) {
    const std::string name = std::string(key.table) + "." + key.name;
    EXPECT_TRUE(seen.contains(name) || kNotDrawn.contains(name)) << name << " has no pair";
  }
  const std::string hour = kClouds + "[[sky.hours]]\nelevation = 6\n";
  const Image plain = drawText(hour + kTwoClouds);
  for (const char* color : {"zenith", "low_sky", "horizon", "ground", "sun", "ambient_sky", "ambient_ground"})
    EXPECT_TRUE(areDifferent(plain, drawText(hour + color + " = [1, 0, 0.5]\n" + kTwoClouds))) << color;
}

// --- The reference ---

// The keys of each table, by the table's title.
std::map<std::string, std::set<std::string>> keysOfReference() {
  std::map<std::string, std::set<std::string>> all;
  std::istringstream reference(sceneReference());
  std::string title;
  for (std::string line; std::getline(reference, line);) {
    if (line.starts_with("## `")) title = line.substr(4, line.size() - 5);
    if (!line.starts_with("| `")) continue;
    EXPECT_TRUE(all[title].insert(line.substr(3, line.find('`', 3) - 3)).second) << title << " has this key twice: " << line;
  }
  return all;
}

// The keys and tables that the reader knows in a table: it lists them for a key that it does not know.
std::set<std::string> knownAfter(const std::string& text) {
  std::set<std::string> known;
  try {
    readStage(text + "zzzzzzzz = 1\n");
    ADD_FAILURE() << "an unknown key is read: " << text;
  } catch (const InputError& error) {
    const std::string message = error.what(), begin = "there are ";
    const size_t at = message.find(begin);
    EXPECT_NE(at, std::string::npos) << message;
    std::istringstream list(message.substr(std::min(at, message.size() - begin.size()) + begin.size()));
    for (std::string word; std::getline(list, word, ',');) known.insert(word.substr(word.find_first_not_of(' ')));
  }
  return known;
}

TEST(SceneKeys, AreAllInTheReference) {
  const auto reference = keysOfReference();
  const std::map<std::string, std::vector<std::string>> needed{
      {"[[sky.hours]]", {"elevation = 1\n"}},
      {"[chain]", {"", "as_published = true\n"}},
      {"[[cloud]]", {"file = 'a.glb'\n", "preset = 'hero'\n"}},
      {"[cloud.scatter]", {"low = [0, 0, 0]\nhigh = [1, 1, 1]\n"}},
      {"[[dust]]", {"lattice = 'a.json'\n"}},
  };
  std::set<std::string> tables;
  for (const auto& [title, keys] : reference) {
    // The table alone, of a title such as: [[marched]] field = "density"
    const size_t end = title.find("] ") == std::string::npos ? title.size() : title.find("] ") + 1;
    const std::string table = title.substr(0, end), field = end < title.size() ? title.substr(end + 1) + "\n" : "";
    tables.insert(table);
    std::set<std::string> known;
    for (const std::string& lines : needed.contains(title) ? needed.at(title) : std::vector<std::string>{""})
      known.merge(knownAfter((title == "[cloud.scatter]" ? "[[cloud]]\nfile = 'a.glb'\n" : "") + table + "\n" + field + lines));
    std::set<std::string> wanted = keys;
    if (title == "[[sky.hours]]") wanted.insert(reference.at("[sky.colors]").begin(), reference.at("[sky.colors]").end());
    const std::string name = table.substr(table.find_first_not_of('['), table.find(']') - table.find_first_not_of('['));
    for (const auto& [other, unused] : reference) {
      const size_t begin = other.find_first_not_of('[');
      if (other.substr(begin).starts_with(name + "."))
        wanted.insert(other.substr(begin + name.size() + 1, other.find(']') - begin - name.size() - 1));
    }
    EXPECT_EQ(known, wanted) << title;
  }
  std::set<std::string> top;
  for (const std::string& table : tables) {
    const size_t begin = table.find_first_not_of('[');
    top.insert(table.substr(begin, table.find_first_of(".]") - begin));
  }
  EXPECT_EQ(knownAfter(""), top);
}

}  // namespace
}  // namespace cloudbake
