// Angles as on the command line: azimuth 0 is +Z, 90 is +X; elevations count up from the horizon.
#include "pipeline/picture/scene_file.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text/toml.h"
#include "io/file/write_file.h"
#include "preview/backdrop/sky.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

constexpr double kFar = 1e9, kBright = 1e4;  // limits of positions, world units, and of colours

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

template <typename Seed>
void readSeed(TomlReader& table, Seed& seed) {
  int given = int(seed);
  table.read("seed", 0, 2147483647, given);
  seed = Seed(given);
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

// --- Light and sky ---

// With `by_sky`, ground and ambient light that are not given follow from the other colours.
void readColors(TomlReader table, SkySettings& sky, bool by_sky) {
  SkyColors& colors = sky.colors;
  for (const auto& [key, color] : {std::pair<const char*, Vec3 SkyColors::*>{"zenith", &SkyColors::zenith},
                                   {"horizon", &SkyColors::horizon},
                                   {"ground", &SkyColors::ground},
                                   {"sun", &SkyColors::sun_color},
                                   {"ambient_sky", &SkyColors::ambient_sky},
                                   {"ambient_ground", &SkyColors::ambient_ground}})
    table.read(key, 0.0, kBright, colors.*color);
  table.finish();
  if (!by_sky) return;
  const SkyColors lit = withAmbientOfSky(colors, sky.to_sun.y);
  for (const auto& [key, color] : {std::pair<const char*, Vec3 SkyColors::*>{"ground", &SkyColors::ground},
                                   {"ambient_sky", &SkyColors::ambient_sky},
                                   {"ambient_ground", &SkyColors::ambient_ground}})
    if (!table.has(key)) colors.*color = lit.*color;
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

void readSky(TomlReader table, SkySettings& sky, bool ambient_by_sky) {
  readColors(table.table("colors"), sky, ambient_by_sky);
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

void readLight(TomlReader table, LightSettings& light, PhaseSettings& phase) {
  table.read("extinction", 1e-9, 1e9, light.extinction);
  table.read("half_lambert", 0.0, 1.0, light.half_lambert);
  table.read("phase", 0.0, 1.0, phase.share);
  table.read("phase_asymmetry", 0.0, 0.99, phase.asymmetry);
  table.read("phase_limit", 0.0, kBright, phase.limit);
  table.read("lobes_only", light.lobes_only);
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
bool readAsPublished(TomlReader chain) {
  bool as_published = false;
  chain.read("as_published", as_published);
  return as_published;
}

void readPublishedSteps(TomlReader& table, PostSettings& post) {
  PublishedSteps& steps = *post.published;
  table.read("draw_divisor", 1, 64, steps.channels.divisor);
  table.read("samples_per_side", 1, 16, steps.channels.samples_per_side);
  table.read("divisor", 1, 64, steps.divisor);
  table.read("near_sigma", 1e-3, 1e3, steps.blur.near_sigma);
  table.read("far_sigma", 1e-3, 1e3, steps.blur.far_sigma);
  table.read("blur_as_quoted", steps.blur.as_quoted);
  table.read("depth_blur_radius", 0, 64, steps.depth_blur.radius);
  ChannelMean mean = ChannelMean::kCovered;
  table.read("mean", {{"covered", ChannelMean::kCovered}, {"all", ChannelMean::kAll}}, mean);
  setChannelMean(post, mean);
}

void readPaintedSteps(TomlReader& table, PaintedSteps& steps) {
  for (const char* key :
       {"draw_divisor", "samples_per_side", "divisor", "near_sigma", "far_sigma", "blur_as_quoted", "depth_blur_radius", "mean"})
    if (table.has(key))
      table.refuseAt(key, std::string("[chain]: '") + key + "' belongs to the chain as published: add as_published = true");
  table.read("depth_spread", 0.0, 1.0, steps.depth_spread);
  table.read("near_width", 0.0, 1.0, steps.soften.near_width);
  table.read("far_width", 0.0, 1.0, steps.soften.far_width);
  table.read("detail_size", 1e-4, 1e3, steps.detail_size);
  table.read("detail_shrink", 0.0, 0.99, steps.erode.shrink);
  table.read("detail_darkening", 0.0, 1.0, steps.erode.darkening);
}

void readChain(TomlReader table, PostSettings& post) {
  bool as_published = false;
  table.read("as_published", as_published);
  if (as_published)
    readPublishedSteps(table, post);
  else
    readPaintedSteps(table, post.painted);
  table.read("tile_size", 1e-3, 1e3, post.distort.tile_size);
  table.read("far_tiles", 1e-3, 1e3, post.distort.far_tiles);
  table.read("swirl_strength", 0.0, 10.0, post.distort.swirl_strength);
  table.read("far_strength", 0.0, 10.0, post.distort.far_strength);
  table.read("swirl_speed", 0.0, 1e3, post.distort.swirl_speed);
  readSeed(table, post.distort.seed);
  post.painted.erode.seed = post.distort.seed;
  table.finish();
}

// --- Clouds ---

SceneCloud readCloud(TomlReader table, const std::filesystem::path& folder) {
  SceneCloud cloud;
  std::string file;
  table.read("file", file);
  table.read("preset", cloud.preset);
  if (file.empty() == cloud.preset.empty())
    table.refuseAt(file.empty() ? "file" : "preset",
                   "a [[cloud]] has either a file, the .glb of a baked cloud, or a preset to grow: give one of the two");
  if (!file.empty()) cloud.file = folder / file;
  if (!cloud.preset.empty()) {
    if (cloud.preset.ends_with(".toml")) cloud.preset = (folder / cloud.preset).string();
    int vertices = int(cloud.vertices);
    readSeed(table, cloud.seed);
    table.read("vertices", 100, 10000000, vertices);
    table.read("lobe", {{"fit", true}, {"mean", false}}, cloud.fit);
    cloud.vertices = size_t(vertices);
  }
  Vec3 position, rotation, scale{1, 1, 1};
  table.read("position", -kFar, kFar, position);
  table.read("rotation", -3600.0, 3600.0, rotation);
  table.read("scale", -1e6, 1e6, scale, true);
  if (std::min({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)}) < 1e-6F)
    table.refuseAt("scale", "'scale' in [[cloud]] flattens the cloud: give numbers of magnitude 1e-6 or more; a negative one mirrors");
  table.finish();
  cloud.to_world = placement(position, rotation, scale);
  return cloud;
}

// --- Backdrops ---

// The light at this hour relative to full day.
Vec3 hourTint(const SceneFile& scene) {
  const SkyColors day = skyColorsFor(scene.post, 1), &colors = scene.light.sky.colors;
  return quotient(colors.sun_color + colors.ambient_sky, day.sun_color + day.ambient_sky);
}

void readFog(TomlReader table, SceneFile& scene) {
  scene.fog.color = scene.light.sky.colors.horizon;
  table.read("density", 0.0, 1e3, scene.post.composite.fog_density);
  table.read("per_unit", 0.0, 1e6, scene.fog.density);
  table.read("color", 0.0, kBright, scene.fog.color);
  table.finish();
}

TerrainSettings readTerrain(TomlReader table, const SceneFile& scene, bool& own_sky) {
  TerrainSettings terrain;
  const SkyColors day = skyColorsFor(scene.post, 1), &now = scene.light.sky.colors;
  terrain.light.sun = product(terrain.light.sun, quotient(now.sun_color, day.sun_color));
  terrain.light.specular = product(terrain.light.specular, quotient(now.sun_color, day.sun_color));
  for (Vec3* ambient : {&terrain.light.sky, &terrain.light.bounce, &terrain.light.snow_rim})
    *ambient = product(*ambient, quotient(now.ambient_sky, day.ambient_sky));
  table.read("own_sky", own_sky);
  terrain.use_own_fog = terrain.use_sun_scatter = own_sky;
  table.read("own_fog", terrain.use_own_fog);
  table.read("sun_scatter", terrain.use_sun_scatter);
  table.read("scale", 1e-6, 1e6, terrain.scale);
  table.read("origin", -kFar, kFar, terrain.origin);
  readSeed(table, terrain.seed);
  table.read("samples_per_side", 1, 16, terrain.samples_per_side);
  table.read("frequency", 1e-6, 1.0, terrain.shape.frequency);
  table.read("amplitude", 0.0, 1e4, terrain.shape.amplitude);
  table.read("gain", 0.05, 1.0, terrain.shape.gain);
  table.read("lacunarity", 1.0, 4.0, terrain.shape.lacunarity);
  table.read("march_octaves", 0, 16, terrain.shape.march_octaves);
  table.read("normal_octaves", 0, 16, terrain.shape.normal_octaves);
  table.read("march_steps", 1, 10000, terrain.march.steps);
  table.read("march_step", 0.01, 1.0, terrain.march.step);
  table.read("tolerance", 1e-6, 0.1, terrain.march.tolerance);
  table.read("farthest", 1.0, 1e6, terrain.march.farthest);
  table.read("shadow_sharpness", 0.1, 1000.0, terrain.shadow.sharpness);
  table.read("snow_low", -1e6, 1e6, terrain.ground.snow_low);
  table.read("snow_high", -1e6, 1e6, terrain.ground.snow_high);
  if (!(terrain.ground.snow_low < terrain.ground.snow_high))
    table.refuseAt(table.has("snow_low") ? "snow_low" : "snow_high", "[terrain]: snow_low is not below snow_high");
  for (const auto& [key, color] : {std::pair<const char*, Vec3*>{"sun", &terrain.light.sun},
                                   {"sky", &terrain.light.sky},
                                   {"bounce", &terrain.light.bounce},
                                   {"snow", &terrain.ground.snow},
                                   {"grass", &terrain.ground.grass},
                                   {"meadow", &terrain.ground.meadow},
                                   {"rock_dark", &terrain.ground.rock_dark},
                                   {"rock_light", &terrain.ground.rock_light}})
    table.read(key, 0.0, kBright, *color);
  table.finish();
  return terrain;
}

SlabSettings readSlab(TomlReader table, double time) {
  SlabSettings slab;
  slab.time_seconds = time;
  table.read("bottom", -kFar, kFar, slab.bottom);
  table.read("center", -kFar, kFar, slab.center);
  table.read("top", -kFar, kFar, slab.top);
  if (!(slab.bottom < slab.center && slab.center < slab.top))
    table.refuseAt(table.has("center") ? "center" : "top", "[[slab]]: its heights are out of order: give bottom < center < top");
  table.read("samples", 1, 4096, slab.samples);
  table.read("dither", 0.0, 1.0, slab.dither);
  table.read("samples_per_side", 1, 16, slab.samples_per_side);
  table.read("noise_scale", 1e-6, 1e9, slab.noise_scale);
  table.read("octaves", 1, 8, slab.octaves);
  readSeed(table, slab.seed);
  table.read("threshold", 0.0, 0.99, slab.threshold);
  table.read("edge_width", 1e-6, 1e6, slab.edge_width);
  table.read("bright", 0.0, 100.0, slab.bright);
  table.read("self_shadow", 0.0, 1.0, slab.self_shadow);
  table.read("outline_strength", 0.0, 1.0, slab.outline_strength);
  table.read("horizon_start", 0.0, 0.99, slab.horizon_start);
  table.read("horizon_gain", 1e-3, 1e3, slab.horizon_gain);
  table.read("night_light", 0.0, 1.0, slab.night_light);
  for (const auto& [key, tone] : {std::pair<const char*, Vec3 SlabTones::*>{"shadow", &SlabTones::shadow},
                                  {"middle", &SlabTones::middle},
                                  {"light", &SlabTones::light},
                                  {"highlight", &SlabTones::highlight},
                                  {"outline", &SlabTones::outline}})
    table.read(key, 0.0, kBright, slab.tones.*tone);
  table.finish();
  return slab;
}

// The settings of both kinds of marched clouds.
template <typename Settings>
void readMarched(TomlReader& table, double time, Settings& clouds, bool& has_wind) {
  table.read("scale", 1e-6, 1e9, clouds.scale);
  table.read("cloud_height", -kFar, kFar, clouds.cloud_height);
  table.read("flatness", 0.0, 100.0, clouds.flatness);
  table.read("noise_frequency", 1e-6, 1e3, clouds.noise_frequency);
  table.read("octaves", 1, 8, clouds.octaves);
  readSeed(table, clouds.seed);
  Vec3 wind;
  table.read("wind", -1e6, 1e6, wind);
  clouds.drift = wind * float(time);
  has_wind = has_wind || wind != Vec3{};
  table.read("samples", 1, 4096, clouds.samples);
  table.read("opacity_factor", 0.0, 1.0, clouds.opacity_factor);
  table.read("thin_color", 0.0, kBright, clouds.thin_color);
  table.read("dense_color", 0.0, kBright, clouds.dense_color);
  table.read("tint", 0.0, kBright, clouds.tint, true);
  table.read("dither", 0.0, 1.0, clouds.dither);
  table.read("samples_per_side", 1, 16, clouds.samples_per_side);
  table.finish();
}

void readLayers(TomlReader& table, double time, SceneFile& scene) {
  const bool has_terrain = table.has("terrain");
  const TerrainSettings terrain = readTerrain(table.table("terrain"), scene, scene.terrain_sky);
  if (has_terrain) scene.terrain = terrain;
  for (TomlReader& slab : table.tables("slab")) scene.slabs.push_back(readSlab(std::move(slab), time));
  for (TomlReader& marched : table.tables("marched")) {
    bool by_density = false;
    marched.read("field", {{"distance", false}, {"density", true}}, by_density);
    if (by_density) {
      DensityCloudSettings& clouds = scene.density_clouds.emplace_back();
      clouds.tint = hourTint(scene);
      marched.read("noise_strength", 0.0, 100.0, clouds.noise_strength);
      marched.read("noise_contrast", 0.0, 100.0, clouds.noise_contrast);
      marched.read("glow_strength", 0.0, 100.0, clouds.glow_strength);
      marched.read("fade_density", 0.0, 100.0, clouds.fade_density);
      readMarched(marched, time, clouds, scene.has_wind);
    } else {
      DistanceCloudSettings& clouds = scene.distance_clouds.emplace_back();
      clouds.tint = hourTint(scene);
      marched.read("noise_offset", -100.0, 100.0, clouds.noise_offset);
      marched.read("shadow_tuning", -100.0, 100.0, clouds.shadow_tuning);
      marched.read("farthest", 1e-3, 1e6, clouds.farthest);
      readMarched(marched, time, clouds, scene.has_wind);
    }
  }
}

void readGrade(TomlReader table, GradeSettings& grade) {
  table.read("gamma", {{"film", false}, {"sqrt", true}}, grade.sqrt_gamma);
  table.read("motion_blur", grade.motion_blur);
  const bool has_vignette = table.has("vignette"), has_contrast = table.has("contrast") || table.has("lift");
  VignetteSettings vignette;
  table.read("vignette", 0.0, 1.0, vignette.corner);
  ContrastSettings contrast;
  table.read("contrast", 0.0, 1.0, contrast.amount);
  table.read("lift", -1.0, 1.0, contrast.lift);
  table.finish();
  if (has_vignette) grade.vignette = vignette;
  if (has_contrast) grade.contrast = contrast;
}

// Reads the camera, the sun and the picture size.
SunRange readView(TomlReader& table, SceneFile& scene) {
  TomlReader picture = table.table("picture");
  const bool as_published = readAsPublished(table.table("chain"));
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
  readSky(table.table("sky"), scene.light.sky, !scene.post.published);
  readLight(table.table("light"), scene.light, scene.post.composite.phase);
  readVolume(table.table("volume"), scene.volume);
  readChain(table.table("chain"), scene.post);
  readFog(table.table("fog"), scene);
  readLayers(table, scene.view.time_seconds, scene);
  readGrade(table.table("grade"), scene.grade);
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
  const bool has_layers = scene.terrain || !scene.slabs.empty() || !scene.distance_clouds.empty() || !scene.density_clouds.empty();
  if (scene.clouds.empty() && !has_layers)
    table.refuseAt("cloud", "the scene is empty: add a [[cloud]] with its file, a [terrain], a [[slab]] or a [[marched]]");
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

SunAngles sunOnItsWay(const SunAngles& noon, double degrees) {
  const Vec3 rise = directionFromAngles(noon.azimuth_degrees - 90, 0), top = directionFromAngles(noon.azimuth_degrees, noon.elevation_degrees);
  const double angle = degrees * kPi / 180;
  const Vec3 sun = normalized(rise * float(std::cos(angle)) + top * float(std::sin(angle))).value_or(top);
  const auto rounded = [](double radians) { return float(std::round(radians * 180e3 / kPi) / 1e3); };
  return {rounded(std::atan2(double(sun.x), double(sun.z))), rounded(std::asin(std::clamp(double(sun.y), -1.0, 1.0)))};
}

double Day::degreesAt(double time_seconds) const {
  const double days = hour / 24 + (seconds > 0 ? time_seconds / seconds : 0) - 0.25;
  return 360 * (days - std::floor(days));
}

SceneFile readSceneFile(const std::filesystem::path& file, const std::string& text,
                        const std::function<PictureSettings(const PictureSettings&)>& over) {
  const toml::table document = parseTomlTable(text, file.string());
  TomlReader table(&document, "", file.string());
  SceneFile scene;
  readView(table, scene);
  scene.view = over(scene.view);
  if (scene.day) {  // at the time of the view; a sun that is given comes before the hour's
    const SunAngles sun = sunOnItsWay(scene.day->noon, scene.day->degreesAt(scene.view.time_seconds));
    scene.view.sun_azimuth_degrees = sun.azimuth_degrees, scene.view.sun_elevation_degrees = sun.elevation_degrees;
    scene.view = over(scene.view);
  }
  readScenery(table, file.parent_path(), scene);
  table.finish();
  checkWhole(table, scene);
  return scene;
}

SceneNeeds readSceneNeeds(const std::filesystem::path& file, Warnings& warnings) {
  const toml::table document = parseTomlTable(readFileBytes(file), file.string());
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
