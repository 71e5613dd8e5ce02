// Angles as on the command line: azimuth 0 is +Z, 90 is +X; elevations count up from the horizon.
#include "app/scene_file.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/toml_table.h"
#include "preview/sky.h"

namespace cloudbake {

namespace {

constexpr double kFar = 1e9, kBright = 1e4;  // of places, world units; of colours

Affine rotationAbout(int axis, double degrees) {
  const double radians = degrees * kPi / 180, c = std::cos(radians), s = std::sin(radians);
  const size_t i = size_t(axis + 1) % 3, j = size_t(axis + 2) % 3;
  Affine m;
  m.linear[i][i] = m.linear[j][j] = c;
  m.linear[i][j] = -s;
  m.linear[j][i] = s;
  return m;
}

void readAngles(TomlReader& table, float& azimuth, float& elevation) {
  table.read("azimuth", -3600.0, 3600.0, azimuth);
  table.read("elevation", -90.0, 90.0, elevation);
}

// --- What the command line can say too ---

void readPicture(TomlReader table, ViewSettings& view) {
  table.read("width", 1, 16384, view.width);
  table.read("height", 1, 16384, view.height);
  table.read("exposure", 1e-6, 1e6, view.exposure);
  table.read("time", 0.0, 1e6, view.time_seconds);
  table.finish();
}

std::optional<CameraPlace> readCamera(TomlReader table, ViewSettings& view) {
  table.read("fov", 1.0, 150.0, view.field_of_view_degrees);
  readAngles(table, view.camera_azimuth_degrees, view.camera_elevation_degrees);
  CameraPlace place;
  table.read("position", -kFar, kFar, place.look_from);
  table.read("target", -kFar, kFar, place.look_at);
  table.finish();
  if (!table.has("position") && !table.has("target")) return std::nullopt;
  if (!table.has("target")) table.refuseAt("position", "[camera] has a position: say with target where it looks");
  if (!table.has("position")) table.refuseAt("target", "[camera] has a target: say with position where it stands");
  if (table.has("azimuth") || table.has("elevation"))
    table.refuseAt("position", "[camera] has a position and angles: give position and target, or azimuth and elevation");
  if (place.look_from == place.look_at) table.refuseAt("target", "[camera]: target is where the camera stands: give another point");
  return place;
}

// --- Light and sky ---

void readColors(TomlReader table, SkyColors& colors) {
  for (const auto& [key, color] : {std::pair<const char*, Vec3 SkyColors::*>{"zenith", &SkyColors::zenith},
                                   {"horizon", &SkyColors::horizon},
                                   {"ground", &SkyColors::ground},
                                   {"sun", &SkyColors::sun_color},
                                   {"ambient_sky", &SkyColors::ambient_sky},
                                   {"ambient_ground", &SkyColors::ambient_ground}})
    table.read(key, 0.0, kBright, colors.*color);
  table.finish();
}

std::optional<MoonSettings> readMoon(TomlReader table, bool is_there) {
  MoonSettings moon;
  float azimuth = 180, elevation = 45;
  readAngles(table, azimuth, elevation);
  moon.direction = directionFromAngles(azimuth, elevation);
  if (std::abs(moon.direction.y) > 0.999F) moon.up = {0, 0, 1};
  table.read("phase", -180.0, 180.0, moon.phase_degrees);
  table.read("color", 0.0, kBright, moon.color);
  table.read("disc_exponent", 1.0, 1e9, moon.disc.exponent);
  table.read("disc_gain", 0.51, 1e30, moon.disc.gain);
  table.finish();
  return is_there ? std::optional(moon) : std::nullopt;
}

enum class DiscChoice { kSimple, kSmooth, kNone };

void readSky(TomlReader table, SkySettings& sky) {
  readColors(table.table("colors"), sky.colors);
  const bool has_moon = table.has("moon");
  sky.moon = readMoon(table.table("moon"), has_moon);
  DiscChoice disc = DiscChoice::kSimple;
  table.read("disc", {{"simple", DiscChoice::kSimple}, {"smooth", DiscChoice::kSmooth}, {"none", DiscChoice::kNone}}, disc);
  table.read("disc_exponent", 1.0, 1e9, sky.disc.exponent);
  table.read("disc_gain", 0.0, 1e30, sky.disc.gain);
  table.read("glow", 0.0, kBright, sky.glow);
  table.read("smooth_radius", 0.0, 100.0, sky.smooth_disc.radius);
  table.read("smooth_softness", 1e-3, 1e4, sky.smooth_disc.softness);
  table.read("smooth_gain", 0.0, kBright, sky.smooth_disc.gain);
  table.read("horizon_exponent", 1.0, 1000.0, sky.horizon_exponent);
  table.read("viewer_height", 0.0, 1e3, sky.viewer_height);
  table.finish();
  if (disc == DiscChoice::kSmooth) sky.sun_disc = SunDisc::kSmooth;
  if (disc == DiscChoice::kNone) sky.disc.gain = 0;
}

void readLight(TomlReader table, LightSettings& light) {
  table.read("extinction", 1e-9, 1e9, light.extinction);
  table.read("half_lambert", 0.0, 1.0, light.half_lambert);
  table.read("lobes_only", light.lobes_only);
  table.finish();
}

// --- The image chain ---

void readChain(TomlReader table, PostSettings& post) {
  table.read("draw_divisor", 1, 64, post.channels.divisor);
  table.read("samples_per_side", 1, 16, post.channels.samples_per_side);
  table.read("divisor", 1, 64, post.divisor);
  table.read("near_sigma", 1e-3, 1e3, post.blur.near_sigma);
  table.read("far_sigma", 1e-3, 1e3, post.blur.far_sigma);
  table.read("blur_as_quoted", post.blur.as_quoted);
  table.read("depth_blur_radius", 0, 64, post.depth_blur.radius);
  table.read("tile_size", 1e-3, 1e3, post.distort.tile_size);
  table.read("far_tiles", 1e-3, 1e3, post.distort.far_tiles);
  table.read("swirl_strength", 0.0, 10.0, post.distort.swirl_strength);
  table.read("far_strength", 0.0, 10.0, post.distort.far_strength);
  table.read("swirl_speed", 0.0, 1e3, post.distort.swirl_speed);
  int seed = 0;
  table.read("seed", 0, 2147483647, seed);
  post.distort.seed = uint32_t(seed);
  ChannelMean mean = ChannelMean::kCovered;
  table.read("mean", {{"covered", ChannelMean::kCovered}, {"all", ChannelMean::kAll}}, mean);
  setChannelMean(post, mean);
  table.finish();
}

// --- Clouds ---

SceneCloud readCloud(TomlReader table, const std::filesystem::path& folder) {
  std::string file;
  table.read("file", file);
  if (file.empty()) table.refuseAt("file", "a [[cloud]] needs a file: the .glb of a baked cloud");
  Vec3 position, rotation, scale{1, 1, 1};
  table.read("position", -kFar, kFar, position);
  table.read("rotation", -3600.0, 3600.0, rotation);
  table.read("scale", -1e6, 1e6, scale, true);
  if (std::min({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)}) < 1e-6F)
    table.refuseAt("scale", "'scale' in [[cloud]] flattens the cloud: give numbers of at least 1e-6; a negative one mirrors");
  table.finish();
  return {folder / file, placement(position, rotation, scale)};
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

SceneFile readSceneFile(const std::filesystem::path& file, const std::string& text, Settings& settings,
                        const std::function<void(Settings&)>& apply_command_line) {
  const toml::table document = parseTomlTable(text, file.string());
  TomlReader table(&document, "", file.string());
  ViewSettings& view = settings.view;
  SceneFile scene;
  readPicture(table.table("picture"), view);
  scene.camera = readCamera(table.table("camera"), view);
  TomlReader sun = table.table("sun");
  readAngles(sun, view.sun_azimuth_degrees, view.sun_elevation_degrees);
  sun.finish();
  apply_command_line(settings);

  scene.light = lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees);
  readSky(table.table("sky"), scene.light.sky);
  readLight(table.table("light"), scene.light);
  readChain(table.table("chain"), scene.post);
  TomlReader fog = table.table("fog");
  fog.read("density", 0.0, 1e3, scene.post.composite.fog_density);
  fog.finish();
  for (TomlReader& cloud : table.tables("cloud")) scene.clouds.push_back(readCloud(std::move(cloud), file.parent_path()));
  table.finish();
  if (scene.clouds.empty()) throw InputError(file.string(), "there is no [[cloud]] in the scene: name at least one, with its file");
  return scene;
}

}  // namespace cloudbake
