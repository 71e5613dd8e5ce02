// Angles as on the command line: azimuth 0 is +Z, 90 is +X; elevations count up from the horizon.
#include "pipeline/scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text/toml.h"
#include "io/file/write_file.h"
#include "pipeline/scene/scene_keys.h"
#include "pipeline/scene/scene_parts.h"

namespace cloudbake {

namespace {

Affine rotationAbout(int axis, double degrees) {
  const double radians = degrees * kPi / 180, c = std::cos(radians), s = std::sin(radians);
  const size_t i = size_t(axis + 1) % 3, j = size_t(axis + 2) % 3;
  Affine m;
  m.linear[i][i] = m.linear[j][j] = c;
  m.linear[i][j] = -s;
  m.linear[j][i] = s;
  return m;
}

// Whether a table has one of the keys.
template <typename Settings>
bool hasAny(const TomlReader& table, const SceneKeys<Settings>& keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const SceneKey<Settings>& key) { return table.has(key.name); });
}

// --- Settings that the command line has too ---

void readPicture(TomlReader table, PictureSettings& view, bool& compares_techniques) {
  table.read("layout", {{"whole", false}, {"techniques", true}}, compares_techniques);
  table.read("width", 1, 16384, view.width);
  table.read("height", 1, 16384, view.height);
  table.read("exposure", 1e-6, 1e6, view.exposure);
  table.read("time", 0.0, 1e6, view.time_seconds);
  table.finish();
}

void readCamera(TomlReader table, SceneFile& scene) {
  PictureSettings& view = scene.view;
  table.read("path", {{"none", false}, {"terrain", true}}, scene.camera_path);
  table.read("fov", 1.0, 150.0, view.field_of_view_degrees);
  readAngles(table, view.camera_azimuth_degrees, view.camera_elevation_degrees);
  table.read("roll", -180.0, 180.0, scene.camera_roll_degrees);
  if (table.has("distance")) table.read("distance", 1e-30, 1e30, scene.camera_distance.emplace());
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
  table.read("extinction", 1e-9, 1e9, light.extinction);
  readKeys(table, shadowKeys(), shadows);
  readKeys(table, lightKeys(), light);
  readKeys(table, phaseKeys(), phase);
  table.finish();
}

// What lobes that are baked for the scene are fitted to, with --fit-to volume.
void readVolume(TomlReader table, VolumeChoices& volume) {
  table.read("view_extinction", 0.01, 100.0, volume.view_extinction);
  table.read("phase", -0.95, 0.95, volume.asymmetry);
  if (table.has("octaves") || table.has("octave_extinction") || table.has("octave_contribution")) {
    OctaveSettings& octaves = volume.octaves.emplace();
    table.read("octaves", 0, kMostLightOctaves, octaves.count);
    table.read("octave_extinction", 0.0, 1.0, octaves.extinction);
    table.read("octave_contribution", 0.0, 1.0, octaves.contribution);
  }
  table.finish();
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
void refuseKeys(TomlReader& table, const SceneKeys<Settings>& keys, const std::string& why) {
  for (const SceneKey<Settings>& key : keys)
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
  if (table.has("far_distance")) table.read("far_distance", 1e-30, 1e30, post.far_distance.emplace());
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

SceneCloud readCloud(TomlReader table, const std::filesystem::path& folder) {
  SceneCloud cloud;
  std::string file;
  table.read("file", file);
  table.read("preset", cloud.preset);
  if (file.empty() == cloud.preset.empty())
    table.refuseAt(file.empty() ? "file" : "preset",
                   "a [[cloud]] has either a file, the .glb of a baked cloud, or a preset to grow: give one of the two");
  if (!file.empty()) {
    cloud.file = folder / file;
    table.read("levels", cloud.levels);
  } else if (table.has("levels")) {
    table.refuseAt("levels", "'levels' belongs to a file: run `cloudbake grow " + cloud.preset +
                                 " --lods 50%,25%,10% -o FILE.glb`, and name that file");
  }
  if (!cloud.preset.empty()) {
    if (cloud.preset.ends_with(".toml")) cloud.preset = (folder / cloud.preset).string();
    int vertices = int(cloud.vertices);
    table.read("seed", 0, int64_t(kMostSeed), cloud.seed);
    table.read("vertices", 100, 10000000, vertices);
    table.read("lobe", {{"fit", true}, {"mean", false}}, cloud.fit);
    cloud.vertices = size_t(vertices);
  }
  cloud.to_world = readPlacement(table);
  table.finish();
  return cloud;
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
  table.read("per_unit", 0.0, kDensestFog, scene.fog.density);
  table.read("color", 0.0, kBright, scene.fog.color);
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
  if (sun.has("hour") || sun.has("day_seconds")) {
    Day& day = scene.day.emplace();
    sun.read("hour", 0.0, 24.0, day.hour);
    sun.read("day_seconds", 0.0, 1e9, day.seconds);
  }
  sun.finish();
  view.sun_azimuth_degrees = (range.azimuth_low + range.azimuth_high) / 2;
  view.sun_elevation_degrees = (range.elevation_low + range.elevation_high) / 2;
  if (scene.day) scene.day->noon = {view.sun_azimuth_degrees, view.sun_elevation_degrees};
  return range;
}

// Reads everything else. The defaults of the light depend on the sun of the view.
void readScenery(TomlReader& table, const std::filesystem::path& folder, SceneFile& scene) {
  scene.light = lightFor(scene.post, scene.view.sun_azimuth_degrees, scene.view.sun_elevation_degrees);
  readSky(table.table("sky"), folder, scene);
  readLight(table.table("light"), scene.light, scene.shadows, scene.post.composite.phase);
  readVolume(table.table("volume"), scene.volume);
  readChain(table.table("chain"), scene.post);
  readFog(table.table("fog"), scene);
  readLayers(table, scene);
  readGrade(table.table("grade"), scene.grade);
  for (TomlReader& dust : table.tables("dust")) scene.dust.push_back(readDust(std::move(dust), folder));
  for (TomlReader& cloud : table.tables("cloud")) scene.clouds.push_back(readCloud(std::move(cloud), folder));
}

// Reads the keys of scenes for bakes from before these had the tables of a picture.
void readOldKeys(TomlReader& table, SceneFile& scene, std::optional<SunArc>& arc, Warnings& warnings) {
  const auto old = [&](const char* key, const char* now) {
    if (!table.has(key)) return false;
    warnings.add(WarningKind::kOldKey, std::string("'") + key + "' is an old key: write " + now);
    return true;
  };
  if (old("camera_distance", "distance in [camera]")) table.read("camera_distance", 1e-30, 1e30, scene.camera_distance.emplace());
  if (old("field_of_view", "fov in [camera]")) table.read("field_of_view", 1e-3, 179.0, scene.view.field_of_view_degrees);
  if (old("image_height", "height in [picture]")) table.read("image_height", 1, 65536, scene.view.height);
  const bool has_elevation = old("sun_elevation", "elevation in [sun]"), has_azimuth = old("sun_azimuth", "azimuth in [sun]");
  if (!has_elevation && !has_azimuth) return;
  arc = SunArc{};
  table.readRange("sun_elevation", -3600, 3600, arc->elevation_low_degrees, arc->elevation_high_degrees);
  table.readRange("sun_azimuth", -3600, 3600, arc->azimuth_low_degrees, arc->azimuth_high_degrees);
}

// Throws unless there is something to draw and the camera has a position.
void checkWhole(const TomlReader& table, const SceneFile& scene) {
  const bool has_layers =
      scene.terrain || !scene.slabs.empty() || !scene.distance_clouds.empty() || !scene.density_clouds.empty() || !scene.dust.empty();
  if (scene.clouds.empty() && !has_layers)
    table.refuseAt("cloud", "the scene is empty: add a [[cloud]] with its file, a [terrain], a [[slab]], a [[marched]] or a [[dust]]");
  if (scene.camera_path && !scene.terrain) table.refuseAt("camera", "[camera] path = 'terrain' needs a [terrain]");
  if (scene.camera_path && scene.camera) table.refuseAt("camera", "[camera] has a path and a position: give one of the two");
  if (scene.clouds.empty() && !scene.camera && !scene.camera_path)
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
  readScenery(table, file.parent_path(), scene);
  table.finish();
  checkWhole(table, scene);
  return scene;
}

SceneNeeds readSceneNeeds(const std::filesystem::path& file, Warnings& warnings, const FileReader& read_file) {
  const toml::table document = parseTomlTable(read_file(file), file.string());
  TomlReader table(&document, "", file.string());
  return readSceneNeeds(table, file.parent_path(), warnings);
}

SceneNeeds readSceneNeeds(TomlReader& table, const std::filesystem::path& folder, Warnings& warnings) {
  SceneFile scene;
  const SunRange sun = readView(table, scene);
  SceneNeeds needs;
  if (sun.has_elevation || sun.has_azimuth) {  // an angle that is not given has its full range
    needs.sun_arc.emplace();
    if (sun.has_elevation)
      needs.sun_arc->elevation_low_degrees = sun.elevation_low, needs.sun_arc->elevation_high_degrees = sun.elevation_high;
    if (sun.has_azimuth) needs.sun_arc->azimuth_low_degrees = sun.azimuth_low, needs.sun_arc->azimuth_high_degrees = sun.azimuth_high;
  }
  readOldKeys(table, scene, needs.sun_arc, warnings);
  readScenery(table, folder, scene);
  table.finish();
  needs.view = scene.view;
  needs.volume = scene.volume;
  needs.camera_distance =
      scene.camera ? std::optional<double>(length(scene.camera->look_from - scene.camera->look_at)) : scene.camera_distance;
  return needs;
}

}  // namespace cloudbake
