// Angles as on the command line: azimuth 0 is +Z, 90 is +X; elevations count up from the horizon.
#include "pipeline/scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/portable_math.h"
#include "core/text/toml.h"
#include "io/file/write_file.h"
#include "pipeline/scene/read_keys.h"
#include "pipeline/scene/scene_parts.h"

namespace cloudbake {

namespace {

Affine rotationAbout(int axis, double degrees) {
  const auto [s, c] = sinCosDegrees(degrees);
  const size_t i = size_t(axis + 1) % 3, j = size_t(axis + 2) % 3;
  Affine m;
  m.linear[i][i] = m.linear[j][j] = c;
  m.linear[i][j] = -s;
  m.linear[j][i] = s;
  return m;
}

// Whether a table has one of the keys.
template <typename Settings>
bool hasAny(const TomlReader& table, const Keys<Settings>& keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const Key<Settings>& key) { return table.has(key.name); });
}

// --- Settings that the command line has too ---

void readPicture(TomlReader table, PictureSettings& view, bool& compares_techniques) {
  table.read("layout", {{"whole", false}, {"techniques", true}}, compares_techniques);
  readKeys(table, pictureKeys(), view);
  table.finish();
}

void readCamera(TomlReader table, SceneFile& scene) {
  table.read("path", {{"none", false}, {"terrain", true}}, scene.camera_path);
  readKeys(table, viewKeys(), scene.view);
  readKeys(table, cameraKeys(), scene);
  CameraPlace place;
  table.read("position", -kFar, kFar, place.look_from);
  table.read("target", -kFar, kFar, place.look_at);
  table.finish();
  if (!table.has("position") && !table.has("target")) return;
  if (!table.has("target")) table.refuseAt("position", "[camera] has a position but no target: give the point that it looks at");
  if (!table.has("position")) table.refuseAt("target", "[camera] has a target but no position: give the point where it is");
  if (table.has("azimuth") || table.has("elevation") || table.has("distance"))
    table.refuseAt("position", "[camera] has a position and angles: give position and target, or azimuth, elevation and distance");
  if (place.look_from == place.look_at) table.refuseAt("target", "[camera]: target and position are the same point: give another target");
  scene.camera = place;
}

// --- Light ---

void readLight(TomlReader table, LightSettings& light, ShadowSettings& shadows, PhaseSettings& phase) {
  readKeys(table, shadowKeys(), shadows);
  table.read("cloud_shade", {{"each", CloudShade::kEach}, {"grid", CloudShade::kGrid}, {"none", CloudShade::kNone}}, shadows.cloud_shade);
  readKeys(table, lightKeys(), light);
  readKeys(table, phaseKeys(), phase);
  table.finish();
}

LampSettings readLamp(TomlReader table) {
  LampSettings lamp;
  readKeys(table, lampKeys(), lamp);
  table.finish();
  if (!lamp.look_at && (table.has("inner_angle") || table.has("outer_angle")))
    table.refuseAt(table.has("inner_angle") ? "inner_angle" : "outer_angle",
                   "[[lamp]] has an angle but does not say where it shines to: give look_at = [x, y, z], or leave the angle out");
  if (lamp.look_at && !(lamp.inner_degrees < lamp.outer_degrees))
    table.refuseAt(table.has("outer_angle") ? "outer_angle" : "inner_angle", "[[lamp]]: inner_angle is not below outer_angle");
  if (lamp.look_at && *lamp.look_at == lamp.place)
    table.refuseAt("look_at", "[[lamp]]: look_at and place are the same point: give another look_at");
  return lamp;
}

LightningSettings readLightning(TomlReader table) {
  LightningSettings lightning;
  readKeys(table, lightningKeys(), lightning);
  table.finish();
  if (lightning.at && table.has("every"))
    table.refuseAt("every", "[[lightning]] has a single flash (at) and many (every): give one of the two");
  return lightning;
}

// Lamps and lightning, and those of them that shine at the time of the view.
void readLamps(TomlReader& table, SceneFile& scene) {
  for (TomlReader& lamp : table.tables("lamp")) scene.lamps.push_back(readLamp(std::move(lamp)));
  for (TomlReader& lightning : table.tables("lightning")) scene.lightning.push_back(readLightning(std::move(lightning)));
  if (scene.lamps.size() + scene.lightning.size() > kMostLamps)
    table.refuseAt(scene.lamps.empty() ? "lightning" : "lamp",
                   fmt::format("there are more than {} [[lamp]] and [[lightning]]: leave some out", kMostLamps));
  scene.light.lamps = lampsAt(scene.lamps, scene.lightning, scene.view.time_seconds);
}

// What lobes that are baked for the scene are fitted to, with --fit-to volume.
void readVolume(TomlReader table, VolumeChoices& volume) {
  OctaveSettings octaves;
  readKeys(table, volumeKeys(), volume);
  readKeys(table, octaveKeys(), octaves);
  table.finish();
  if (hasAny(table, octaveKeys())) volume.octaves = octaves;
}

// --- The image chain ---

// Whether the scene wants the chain as published. Its defaults for sun, camera and light differ.
bool isChainPublished(TomlReader chain) {
  bool as_published = false;
  chain.read("as_published", as_published);
  return as_published;
}

void readPublishedSteps(TomlReader& table, PostSettings& post) {
  PublishedSteps& steps = *post.published;
  readKeys(table, publishedKeys(), steps);
  readKeys(table, channelKeys(), steps.channels);
  readKeys(table, blurKeys(), steps.blur);
  readKeys(table, depthBlurKeys(), steps.depth_blur);
  ChannelMean mean = ChannelMean::kCovered;
  table.read("mean", {{"covered", ChannelMean::kCovered}, {"all", ChannelMean::kAll}}, mean);
  setChannelMean(post, mean);
}

template <typename Settings>
void refuseKeys(TomlReader& table, const Keys<Settings>& keys, const std::string& why) {
  for (const Key<Settings>& key : keys)
    if (table.has(key.name)) table.refuseAt(key.name, fmt::format("[chain]: '{}' {}", key.name, why));
}

void readPaintedSteps(TomlReader& table, PaintedSteps& steps) {
  const char* why = "belongs to the chain as published: add as_published = true";
  refuseKeys(table, publishedKeys(), why);
  refuseKeys(table, channelKeys(), why);
  refuseKeys(table, blurKeys(), why);
  refuseKeys(table, depthBlurKeys(), why);
  if (table.has("mean")) table.refuseAt("mean", fmt::format("[chain]: 'mean' {}", why));
  readKeys(table, paintedKeys(), steps);
  readKeys(table, softenKeys(), steps.soften);
  readKeys(table, erodeKeys(), steps.erode);
}

void readChain(TomlReader table, PostSettings& post) {
  bool as_published = false;
  table.read("as_published", as_published);
  if (as_published)
    readPublishedSteps(table, post);
  else
    readPaintedSteps(table, post.painted);
  readKeys(table, distortKeys(), post.distort);
  readKeys(table, depthKeys(), post);
  if (post.far_distance && !(post.near_distance < *post.far_distance))
    table.refuseAt("far_distance", "[chain]: near_distance is not below far_distance");
  post.painted.erode.seed = post.distort.seed;
  table.finish();
}

// --- Clouds ---

// position, rotation and scale of a cloud.
Affine readPlacement(TomlReader& table) {
  Vec3 position, rotation, scale{1, 1, 1};
  table.read("position", -kFar, kFar, position);
  table.read("rotation", -3600.0, 3600.0, rotation);
  table.read("scale", -1e6, 1e6, scale, true);
  if (std::min({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)}) < 1e-6F)
    table.refuseAt("scale", "'scale' flattens the cloud: give numbers of magnitude 1e-6 or more; a negative one mirrors");
  return placement(position, rotation, scale);
}

// A list of names; none if the key is missing.
std::vector<std::string> readNames(TomlReader& table, const char* key) {
  std::vector<std::string> names;
  const toml::node* node = table.find(key);
  if (!node) return names;
  const auto refuse = [&] { table.refuse(key, *node, "a list of names in quotes, such as [\"a\", \"b\"]"); };
  if (!node->is_array()) refuse();
  for (const toml::node& element : *node->as_array()) {
    const auto name = element.value<std::string>();
    if (!name || name->empty()) refuse();
    names.push_back(*name);
  }
  if (names.empty()) refuse();
  return names;
}

// The clouds that a [[cloud]] names, in one of four ways; only those of a field may be several.
std::vector<SceneCloud> readNamedClouds(TomlReader& table, const std::filesystem::path& folder, bool is_field) {
  constexpr std::array kNames{"file", "preset", "files", "presets"};
  const auto given = std::count_if(kNames.begin(), kNames.end(), [&](const char* name) { return table.has(name); });
  std::string file, preset;
  table.read("file", file);
  table.read("preset", preset);
  std::vector<std::string> files = readNames(table, "files"), presets = readNames(table, "presets");
  for (const char* several : {"files", "presets"})
    if (table.has(several) && !is_field)
      table.refuseAt(several,
                     fmt::format("'{}' belongs to a field of clouds: add a [cloud.scatter] with its box, low and high, or give one "
                                 "[[cloud]] for each",
                                 several));
  if (!file.empty()) files = {file};
  if (!preset.empty()) presets = {preset};
  if (given != 1 || (files.empty() && presets.empty()))
    table.refuseAt(file.empty() ? "file" : "preset",
                   "a [[cloud]] has either a file, the .glb of a baked cloud, or a preset to grow: give one of the two");
  SceneCloud common;
  if (!files.empty())
    table.read("levels", common.levels);
  else if (table.has("levels"))
    table.refuseAt("levels", "'levels' belongs to a file: run `cloudbake grow " + presets.front() +
                                 " --lods 50%,25%,10% -o FILE.glb`, and name that file");
  if (!presets.empty()) {
    readKeys(table, growthKeys(), common);
    table.read("lobe", {{"fit", true}, {"mean", false}}, common.fit);
  }
  std::vector<SceneCloud> clouds;
  for (const std::string& name : files) clouds.push_back(common), clouds.back().file = folder / name;
  for (const std::string& name : presets) {
    clouds.push_back(common);
    clouds.back().preset = name.ends_with(".toml") ? (folder / name).string() : name;
  }
  return clouds;
}

ScatterSettings readScatter(TomlReader table) {
  ScatterSettings scatter;
  for (const auto& [name, corner] : {std::pair{"low", &scatter.low}, std::pair{"high", &scatter.high}}) {
    if (!table.has(name))
      table.refuseAt(name, fmt::format("[cloud.scatter] has no {}: give the box in which clouds are scattered, low = [x, y, z] and "
                                       "high = [x, y, z]",
                                       name));
    table.read(name, -kFar, kFar, *corner);
  }
  const Vec3 sides = scatter.high - scatter.low;
  if (!(sides.x > 0 && sides.z > 0 && sides.y >= 0))
    table.refuseAt("high", "[cloud.scatter]: the box is empty: each number of high must be above that of low; those of y may be equal");
  readKeys(table, fieldKeys(), scatter);
  if (scatter.size.x > scatter.size.y)
    table.refuseAt("size", "[cloud.scatter]: 'size' goes from the smallest factor to the largest one: swap its numbers");
  if (scatter.drift.y != 0 && sides.y == 0)
    table.refuseAt("drift", "[cloud.scatter]: clouds drift up or down in a box without a height: give low and high other heights");
  table.finish();
  return scatter;
}

// The weights of several clouds of a field.
std::vector<double> readWeights(TomlReader& table, size_t count, bool is_field) {
  const toml::node* node = table.find("weights");
  if (!node) return std::vector<double>(count, 1);
  if (!is_field || !(table.has("files") || table.has("presets")))
    table.refuseAt("weights", "'weights' belongs to several clouds of a field: give 'files' or 'presets', and a [cloud.scatter]");
  if (!node->is_array() || node->as_array()->size() != count)
    table.refuse("weights", *node, fmt::format("a list of {} numbers, one for each of the clouds", count));
  std::vector<double> weights = table.numbers("weights", count, "a list of numbers").value();
  if (!std::all_of(weights.begin(), weights.end(), [](double weight) { return weight > 0; }))
    table.refuse("weights", *node, "a list of numbers above 0: leave out clouds that are not to be there");
  return weights;
}

// A cloud, or a field of clouds.
void readCloud(TomlReader table, const std::filesystem::path& folder, SceneFile& scene) {
  const bool is_field = table.has("scatter");
  TomlReader scatter = table.table("scatter");
  std::vector<SceneCloud> clouds = readNamedClouds(table, folder, is_field);
  std::vector<double> weights = readWeights(table, clouds.size(), is_field);
  if (table.has("drift"))
    table.refuseAt("drift",
                   "'drift' belongs to [cloud.scatter], in whose box clouds wrap around; count = 1 and jitter = 0 place one cloud "
                   "in its middle");
  if (is_field && table.has("position"))
    table.refuseAt("position", "the clouds of a field are in the box of [cloud.scatter]: leave 'position' out");
  const Affine to_world = readPlacement(table);
  for (SceneCloud& cloud : clouds) cloud.to_world = to_world;
  if (is_field)
    scene.fields.push_back({std::move(clouds), std::move(weights), readScatter(std::move(scatter))});
  else
    scene.clouds.push_back(std::move(clouds.front()));
  table.finish();
}

SceneDust readDust(TomlReader table, const std::filesystem::path& folder) {
  SceneDust dust;
  std::string file;
  table.read("lattice", file);
  if (file.empty()) table.refuseAt("lattice", "a [[dust]] has no lattice: give the .json that `bake --basis sh3 --lattice` has written");
  dust.file = folder / file;
  dust.to_world = readPlacement(table);
  readKeys(table, dustKeys(), dust.settings);
  table.finish();
  return dust;
}

// --- After drawing ---

void readFog(TomlReader table, SceneFile& scene) {
  scene.fog.color = scene.light.sky.colors.horizon;
  readKeys(table, chainFogKeys(), scene.post.composite);
  readKeys(table, fogKeys(), scene.fog);
  readKeys(table, scatterKeys(), scene.post.composite.scatter);
  table.finish();
}

void readGrade(TomlReader table, GradeSettings& grade) {
  table.read("gamma", {{"film", false}, {"sqrt", true}}, grade.sqrt_gamma);
  bool blurs = false;
  table.read("motion_blur", blurs);
  VignetteSettings vignette;
  ContrastSettings contrast;
  MotionBlurSettings motion_blur;
  readKeys(table, motionBlurKeys(), motion_blur);
  readKeys(table, vignetteKeys(), vignette);
  readKeys(table, contrastKeys(), contrast);
  table.finish();
  if (blurs) grade.motion_blur = motion_blur;
  if (hasAny(table, vignetteKeys())) grade.vignette = vignette;
  if (hasAny(table, contrastKeys())) grade.contrast = contrast;
}

// Reads the camera, the sun and the picture size.
SunRange readView(TomlReader& table, SceneFile& scene) {
  TomlReader picture = table.table("picture");
  const bool as_published = isChainPublished(table.table("chain"));
  if (as_published) scene.post = publishedPost();
  PictureSettings& view = scene.view;
  const ViewAngles& angles = as_published ? kPlainView : kPaintedView;
  view.camera_azimuth_degrees = angles.camera_azimuth, view.camera_elevation_degrees = angles.camera_elevation;
  readPicture(std::move(picture), view, scene.compares_techniques);
  readCamera(table.table("camera"), scene);
  TomlReader sun = table.table("sun");
  SunRange range{angles.sun_azimuth, angles.sun_azimuth, angles.sun_elevation, angles.sun_elevation};
  sun.readRange("azimuth", -3600, 3600, range.azimuth_low, range.azimuth_high);
  sun.readRange("elevation", -90, 90, range.elevation_low, range.elevation_high);
  range.has_azimuth = sun.has("azimuth");
  range.has_elevation = sun.has("elevation");
  Day day;
  readKeys(sun, dayKeys(), day);
  sun.finish();
  if (hasAny(sun, dayKeys())) scene.day = day;
  view.sun_azimuth_degrees = (range.azimuth_low + range.azimuth_high) / 2;
  view.sun_elevation_degrees = (range.elevation_low + range.elevation_high) / 2;
  if (scene.day) scene.day->noon = {view.sun_azimuth_degrees, view.sun_elevation_degrees};
  return range;
}

// Reads everything else. The defaults of the light depend on the sun of the view. Without a reader no file is opened.
void readScenery(TomlReader& table, const std::filesystem::path& folder, const FileReader* read_file, SceneFile& scene) {
  scene.light = lightFor(scene.post, scene.view.sun_azimuth_degrees, scene.view.sun_elevation_degrees);
  readSky(table.table("sky"), folder, read_file, scene);
  readLight(table.table("light"), scene.light, scene.shadows, scene.post.composite.phase);
  readLamps(table, scene);
  readVolume(table.table("volume"), scene.volume);
  readChain(table.table("chain"), scene.post);
  readFog(table.table("fog"), scene);
  readLayers(table, scene);
  readGrade(table.table("grade"), scene.grade);
  for (TomlReader& dust : table.tables("dust")) scene.dust.push_back(readDust(std::move(dust), folder));
  for (TomlReader& cloud : table.tables("cloud")) readCloud(std::move(cloud), folder, scene);
}

// Throws unless there is something to draw and the camera has a position.
void checkWhole(const TomlReader& table, const SceneFile& scene) {
  const bool has_layers =
      scene.terrain || !scene.slabs.empty() || !scene.distance_clouds.empty() || !scene.density_clouds.empty() || !scene.dust.empty();
  if (!hasMeshClouds(scene) && !has_layers)
    table.refuseAt("cloud", "the scene is empty: add a [[cloud]] with its file, a [terrain], a [[slab]], a [[marched]] or a [[dust]]");
  if (scene.camera_path && !scene.terrain) table.refuseAt("camera", "[camera] path = 'terrain' needs a [terrain]");
  if (scene.camera_path && scene.camera) table.refuseAt("camera", "[camera] has a path and a position: give one of the two");
  if (!hasMeshClouds(scene) && !scene.camera && !scene.camera_path)
    table.refuseAt("camera", "[camera] has no cloud to frame: give its position and target, or path = 'terrain'");
}

}  // namespace

Affine placement(Vec3 position, Vec3 rotation_degrees, Vec3 scale) {
  Affine m;
  m.linear[0][0] = scale.x, m.linear[1][1] = scale.y, m.linear[2][2] = scale.z;
  m = compose(rotationAbout(0, rotation_degrees.x), m);
  m = compose(rotationAbout(1, rotation_degrees.y), m);
  m = compose(rotationAbout(2, rotation_degrees.z), m);
  m.offset = {position.x, position.y, position.z};
  return m;
}

SceneFile readSceneFile(const std::filesystem::path& file, const std::string& text,
                        const std::function<PictureSettings(const PictureSettings&)>& over) {
  const toml::table document = parseTomlTable(text, file.string());
  TomlReader table(&document, "", file.string());
  SceneFile scene;
  readView(table, scene);
  scene.view = over(scene.view);
  if (scene.day) {  // at the time of the view; a sun that is given comes before the hour's
    const SunAngles sun = SunCircle(scene.day->noon).anglesAt(scene.day->degreesAt(scene.view.time_seconds));
    scene.view.sun_azimuth_degrees = sun.azimuth_degrees, scene.view.sun_elevation_degrees = sun.elevation_degrees;
    scene.view = over(scene.view);
  }
  const FileReader read_file = readFileBytes;
  readScenery(table, file.parent_path(), &read_file, scene);
  table.finish();
  checkWhole(table, scene);
  return scene;
}

SceneNeeds readSceneNeeds(const std::filesystem::path& file, const FileReader& read_file) {
  const toml::table document = parseTomlTable(read_file(file), file.string());
  TomlReader table(&document, "", file.string());
  return readSceneNeeds(table, file.parent_path());
}

SceneNeeds readSceneNeeds(TomlReader& table, const std::filesystem::path& folder) {
  SceneFile scene;
  const SunRange sun = readView(table, scene);
  SceneNeeds needs;
  if (sun.has_elevation || sun.has_azimuth) {  // an angle that is not given has its full range
    needs.sun_arc.emplace();
    if (sun.has_elevation)
      needs.sun_arc->elevation_low_degrees = sun.elevation_low, needs.sun_arc->elevation_high_degrees = sun.elevation_high;
    if (sun.has_azimuth) needs.sun_arc->azimuth_low_degrees = sun.azimuth_low, needs.sun_arc->azimuth_high_degrees = sun.azimuth_high;
  }
  readScenery(table, folder, nullptr, scene);
  table.finish();
  needs.view = scene.view;
  needs.volume = scene.volume;
  needs.camera_distance =
      scene.camera ? std::optional<double>(length(scene.camera->look_from - scene.camera->look_at)) : scene.camera_distance;
  return needs;
}

// --- Keys ---

const Keys<SceneCloud>& growthKeys() {
  using S = SceneCloud;
  constexpr const char* kGrown = "clouds are grown before the page is written";
  static const Keys<S> keys{
      {"seed", &S::seed, 0, kMostSeed, "selects another cloud", KeyUse::kScript, kGrown},
      {"vertices", &S::vertices, 100, 1e7, "vertices of the cloud at most", KeyUse::kScript, kGrown},
  };
  return keys;
}

const Keys<SceneFile>& cameraKeys() {
  using S = SceneFile;
  static const Keys<S> keys{
      {"roll", &S::camera_roll_degrees, -180, 180, "turn of the camera about its view, degrees", KeyUse::kScript},
      {"distance", &S::camera_distance, 1e-30, 1e30, "from the centre of the clouds, world units; unset: the camera frames them",
       KeyUse::kScript, "the camera moves by hand"},
  };
  return keys;
}

const Keys<PictureSettings>& pictureKeys() {
  using S = PictureSettings;
  constexpr const char* kWindow = "the picture fills the window, and 'Save PNG' has a size of its own";
  static const Keys<S> keys{
      {"width", &S::width, 1, 16384, "width of the picture, pixels", KeyUse::kScript, kWindow},
      {"height", &S::height, 1, 16384, "height of the picture, pixels", KeyUse::kScript, kWindow},
      {"exposure", &S::exposure, 1e-6, 1e6, "factor of the light before tone mapping"},
      {"time", &S::time_seconds, 0, 1e6, "moment of all motion, seconds", KeyUse::kScript},
      {"start", &S::start_seconds, 0, 1e6, "moment at which animations and the page begin, seconds; unset: time", KeyUse::kScript,
       "it is the time at first"},
      {"time_offset", &S::time_offset_seconds, -1e6, 1e6,
       "how far swirls, wind, drift and aurora are ahead of the time, seconds; sun, moon, stars and camera are not", KeyUse::kScript},
  };
  return keys;
}

const Keys<PictureSettings>& viewKeys() {
  using S = PictureSettings;
  constexpr const char* kByHand = "the camera moves by hand";
  static const Keys<S> keys{
      {"fov", &S::field_of_view_degrees, 1, 150, "vertical field of view, degrees", KeyUse::kScript},
      {"azimuth", &S::camera_azimuth_degrees, -3600, 3600, "of a camera that looks at the centre of the clouds, degrees; 0 is +Z, 90 is +X",
       KeyUse::kScript, kByHand},
      {"elevation", &S::camera_elevation_degrees, -90, 90, "of that camera above the horizon, degrees", KeyUse::kScript, kByHand},
  };
  return keys;
}

const Keys<Day>& dayKeys() {
  using S = Day;
  static const Keys<S> keys{
      {"hour", &S::hour, 0, 24, "hour of the day at time 0: the sun rises at 6, and is highest, at azimuth and elevation, at 12",
       KeyUse::kScript},
      {"day_seconds", &S::seconds, 0, 1e9, "seconds that a day lasts; 0: the hour does not change", KeyUse::kScript},
  };
  return keys;
}

const Keys<VolumeChoices>& volumeKeys() {
  using S = VolumeChoices;
  constexpr const char* kBake = "it is for bakes";
  static const Keys<S> keys{
      {"view_extinction", &S::view_extinction, 0.01, 100, "opacity along the view, in units of σ", KeyUse::kScript, kBake},
      {"phase", &S::asymmetry, -0.95, 0.95, "g of Henyey and Greenstein's phase function", KeyUse::kScript, kBake},
  };
  return keys;
}

const Keys<OctaveSettings>& octaveKeys() {
  using S = OctaveSettings;
  constexpr const char* kBake = "it is for bakes";
  static const Keys<S> keys{
      {"octaves", &S::count, 0, kMostLightOctaves, "octaves of scattered light beyond the first", KeyUse::kScript, kBake},
      {"octave_extinction", &S::extinction, 0, 1, "factor of σ from one octave to the next", KeyUse::kScript, kBake},
      {"octave_contribution", &S::contribution, 0, 1, "factor of the light from one octave to the next", KeyUse::kScript, kBake},
  };
  return keys;
}

}  // namespace cloudbake
