#include "pipeline/scene/scene_keys.h"

#include <algorithm>
#include <array>

#include "core/text/numbers.h"
#include "core/text/toml.h"

namespace cloudbake {

// --- Sky ---

const SceneKeys<DiscSettings>& sunDiscKeys() {
  static const SceneKeys<DiscSettings> keys{{"disc_exponent", &DiscSettings::exponent, 1, 1e9},
                                            {"disc_gain", &DiscSettings::gain, 0, 1e30}};
  return keys;
}

const SceneKeys<SmoothDiscSettings>& smoothDiscKeys() {
  using S = SmoothDiscSettings;
  static const SceneKeys<S> keys{
      {"smooth_radius", &S::radius, 0, 100}, {"smooth_softness", &S::softness, 1e-3, 1e4}, {"smooth_gain", &S::gain, 0, kBright}};
  return keys;
}

const SceneKeys<SkySettings>& skyKeys() {
  using S = SkySettings;
  static const SceneKeys<S> keys{{"glow", &S::glow, 0, kBright},
                                 {"horizon_exponent", &S::horizon_exponent, 1, 1000},
                                 {"horizon_strength", &S::horizon_strength, 0, 1},
                                 {"viewer_height", &S::viewer_height, 0, 1e3}};
  return keys;
}

const SceneKeys<MoonSettings>& moonKeys() {
  using S = MoonSettings;
  static const SceneKeys<S> keys{
      {"phase", &S::phase_degrees, -180, 180}, {"color", &S::color, 0, kBright}, {"light", &S::light, 0, kBright, true}};
  return keys;
}

const SceneKeys<DiscSettings>& moonDiscKeys() {
  static const SceneKeys<DiscSettings> keys{{"disc_exponent", &DiscSettings::exponent, 1, 1e9},
                                            {"disc_gain", &DiscSettings::gain, 0.51, 1e30}};
  return keys;
}

const SceneKeys<StarSettings>& starKeys() {
  using S = StarSettings;
  static const SceneKeys<S> keys{{"count", &S::count, 100, 1e6},        {"brightness", &S::brightness, 0, kBright},
                                 {"size", &S::size_degrees, 1e-3, 5},   {"tint", &S::tint, 0, 1},
                                 {"low_height", &S::low_height, -1, 1}, {"high_height", &S::high_height, -1, 1},
                                 {"seed", &S::seed, 0, kMostSeed}};
  return keys;
}

// --- Mesh clouds ---

const SceneKeys<LightSettings>& lightKeys() {
  using S = LightSettings;
  static const SceneKeys<S> keys{{"half_lambert", &S::half_lambert, 0, 1}, {"lobes_only", &S::lobes_only}};
  return keys;
}

const SceneKeys<ShadowSettings>& shadowKeys() {
  using S = ShadowSettings;
  static const SceneKeys<S> keys{
      {"shadows", &S::are_drawn}, {"shadow_strength", &S::strength, 0, 1}, {"shadow_softness", &S::softness_degrees, 0, 45}};
  return keys;
}

const SceneKeys<PhaseSettings>& phaseKeys() {
  using S = PhaseSettings;
  static const SceneKeys<S> keys{
      {"phase", &S::share, 0, 1}, {"phase_asymmetry", &S::asymmetry, 0, 0.99}, {"phase_limit", &S::limit, 0, kBright}};
  return keys;
}

const SceneKeys<CompositeSettings>& chainFogKeys() {
  static const SceneKeys<CompositeSettings> keys{{"density", &CompositeSettings::fog_density, 0, 1e3}};
  return keys;
}

const SceneKeys<PostSettings>& depthKeys() {
  static const SceneKeys<PostSettings> keys{{"near_distance", &PostSettings::near_distance, 0, 1e30}};
  return keys;
}

const SceneKeys<DistortSettings>& distortKeys() {
  using S = DistortSettings;
  static const SceneKeys<S> keys{{"tile_size", &S::tile_size, 1e-3, 1e3},       {"far_tiles", &S::far_tiles, 1e-3, 1e3},
                                 {"swirl_strength", &S::swirl_strength, 0, 10}, {"far_strength", &S::far_strength, 0, 10},
                                 {"swirl_speed", &S::swirl_speed, 0, 1e3},      {"seed", &S::seed, 0, kMostSeed}};
  return keys;
}

const SceneKeys<PaintedSteps>& paintedKeys() {
  using S = PaintedSteps;
  static const SceneKeys<S> keys{{"depth_spread", &S::depth_spread, 0, 1}, {"detail_size", &S::detail_size, 1e-4, 1e3}};
  return keys;
}

const SceneKeys<SoftenSettings>& softenKeys() {
  using S = SoftenSettings;
  static const SceneKeys<S> keys{{"near_width", &S::near_width, 0, 1}, {"far_width", &S::far_width, 0, 1}};
  return keys;
}

const SceneKeys<ErodeSettings>& erodeKeys() {
  using S = ErodeSettings;
  static const SceneKeys<S> keys{{"detail_shrink", &S::shrink, 0, 0.99}, {"detail_darkening", &S::darkening, 0, 1}};
  return keys;
}

const SceneKeys<PublishedSteps>& publishedKeys() {
  static const SceneKeys<PublishedSteps> keys{{"divisor", &PublishedSteps::divisor, 1, 64}};
  return keys;
}

const SceneKeys<ChannelSettings>& channelKeys() {
  using S = ChannelSettings;
  static const SceneKeys<S> keys{{"draw_divisor", &S::divisor, 1, 64}, {"samples_per_side", &S::samples_per_side, 1, 16}};
  return keys;
}

const SceneKeys<BlurSettings>& blurKeys() {
  using S = BlurSettings;
  static const SceneKeys<S> keys{
      {"near_sigma", &S::near_sigma, 1e-3, 1e3}, {"far_sigma", &S::far_sigma, 1e-3, 1e3}, {"blur_as_quoted", &S::as_quoted}};
  return keys;
}

const SceneKeys<DepthBlurSettings>& depthBlurKeys() {
  static const SceneKeys<DepthBlurSettings> keys{{"depth_blur_radius", &DepthBlurSettings::radius, 0, 64}};
  return keys;
}

// --- Clouds of noise ---

const SceneKeys<SlabSettings>& slabKeys() {
  using S = SlabSettings;
  static const SceneKeys<S> keys{{"bottom", &S::bottom, -kFar, kFar},
                                 {"center", &S::center, -kFar, kFar},
                                 {"top", &S::top, -kFar, kFar},
                                 {"samples", &S::samples, 1, 4096},
                                 {"dither", &S::dither, 0, 1},
                                 {"samples_per_side", &S::samples_per_side, 1, 16},
                                 {"noise_scale", &S::noise_scale, 1e-6, 1e9},
                                 {"octaves", &S::octaves, 1, 8},
                                 {"seed", &S::seed, 0, kMostSeed},
                                 {"threshold", &S::threshold, 0, 0.99},
                                 {"low_share", &S::low_share, 0, 1},
                                 {"smooth_low", &S::smooth_low, 0, 1},
                                 {"smooth_high", &S::smooth_high, 0, 1},
                                 {"high_drift", &S::high_drift, -1e3, 1e3},
                                 {"low_drift", &S::low_drift, -1e3, 1e3},
                                 {"edge_width", &S::edge_width, 1e-6, 1e6},
                                 {"opaque_widths", &S::opaque_widths, 1e-3, 1e6},
                                 {"least_den", &S::least_den, 1e-9, 1},
                                 {"shadow_limit", &S::shadow_limit, 0, 1},
                                 {"middle_limit", &S::middle_limit, 0, 1},
                                 {"tone_softness", &S::tone_softness, 0, 1},
                                 {"bright", &S::bright, 0, 100},
                                 {"self_shadow", &S::self_shadow, 0, 1},
                                 {"self_shadow_gain", &S::self_shadow_gain, 0, 1},
                                 {"outline_strength", &S::outline_strength, 0, 1},
                                 {"outline_start", &S::outline_start, 0, 1e3},
                                 {"outline_full", &S::outline_full, 0, 1e3},
                                 {"horizon_start", &S::horizon_start, 0, 0.99},
                                 {"horizon_gain", &S::horizon_gain, 1e-3, 1e3},
                                 {"day_luminance", &S::day_luminance, 1e-6, kBright},
                                 {"night_light", &S::night_light, 0, 1}};
  return keys;
}

const SceneKeys<SlabTones>& slabToneKeys() {
  using S = SlabTones;
  static const SceneKeys<S> keys{{"shadow", &S::shadow, 0, kBright},
                                 {"middle", &S::middle, 0, kBright},
                                 {"light", &S::light, 0, kBright},
                                 {"highlight", &S::highlight, 0, kBright},
                                 {"outline", &S::outline, 0, kBright}};
  return keys;
}

namespace {

// What both kinds of marched clouds have.
template <typename S>
SceneKeys<S> marchedKeys() {
  return {{"scale", &S::scale, 1e-6, 1e9},
          {"cloud_height", &S::cloud_height, -kFar, kFar},
          {"flatness", &S::flatness, 0, 100},
          {"noise_frequency", &S::noise_frequency, 1e-6, 1e3},
          {"octaves", &S::octaves, 1, 8},
          {"seed", &S::seed, 0, kMostSeed},
          {"wind", &S::wind, -1e6, 1e6},
          {"samples", &S::samples, 1, 4096},
          {"least_step", &S::least_step, 1e-6, 1e6},
          {"step_growth", &S::step_growth, 1e-9, 1e3},
          {"thin_color", &S::thin_color, 0, kBright},
          {"dense_color", &S::dense_color, 0, kBright},
          {"opacity_factor", &S::opacity_factor, 0, 1},
          {"stop_opacity", &S::stop_opacity, 0, 1},
          {"tint", &S::tint, 0, kBright, true},
          {"dither", &S::dither, 0, 1},
          {"samples_per_side", &S::samples_per_side, 1, 16}};
}

template <typename S>
SceneKeys<S> joined(SceneKeys<S> keys, const SceneKeys<S>& more) {
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

}  // namespace

const SceneKeys<DistanceCloudSettings>& distanceCloudKeys() {
  using S = DistanceCloudSettings;
  static const SceneKeys<S> keys = joined(marchedKeys<S>(), {{"noise_offset", &S::noise_offset, -100, 100},
                                                             {"first_step", &S::first_step, 1e-6, 1e6},
                                                             {"step_factor", &S::step_factor, 1e-3, 10},
                                                             {"contact", &S::contact, 1e-6, 1e3},
                                                             {"farthest", &S::farthest, 1e-3, 1e6},
                                                             {"search_steps", &S::search_steps, 1, 1e5},
                                                             {"step_back", &S::step_back, 0, 1e6},
                                                             {"step_base", &S::step_base, -1e6, 1e6},
                                                             {"step_density", &S::step_density, -1e6, 1e6},
                                                             {"shadow_start", &S::shadow_start, 1e-6, 100},
                                                             {"shadow_slope", &S::shadow_slope, -100, 100},
                                                             {"shadow_tuning", &S::shadow_tuning, -100, 100},
                                                             {"shadow_distance", &S::shadow_distance, -1e6, 1e6},
                                                             {"shadow_range", &S::shadow_range, 0, 1},
                                                             {"shadow_floor", &S::shadow_floor, 0, 1},
                                                             {"fade_start", &S::fade_start, 0, 1}});
  return keys;
}

const SceneKeys<DensityCloudSettings>& densityCloudKeys() {
  using S = DensityCloudSettings;
  static const SceneKeys<S> keys = joined(marchedKeys<S>(), {{"noise_strength", &S::noise_strength, 0, 100},
                                                             {"noise_contrast", &S::noise_contrast, 0, 100},
                                                             {"color_factor", &S::color_factor, 0, kBright},
                                                             {"glow_color", &S::glow_color, 0, kBright},
                                                             {"glow_strength", &S::glow_strength, 0, 100},
                                                             {"glow_exponent", &S::glow_exponent, 0, 1e4},
                                                             {"fade_density", &S::fade_density, 0, 100},
                                                             {"first_t", &S::first_t, 1e-6, 1e6},
                                                             {"parts", &S::parts, 1, 256},
                                                             {"part_length", &S::part_length, 1e-6, 1e6}});
  return keys;
}

const SceneKeys<DustSettings>& dustKeys() {
  using S = DustSettings;
  static const SceneKeys<S> keys{{"reach", &S::reach, 0.01, 100},           {"thickness", &S::thickness, 0, 1e3},
                                 {"fade_start", &S::fade_start, 0, 0.99},   {"color", &S::color, 0, kBright},
                                 {"asymmetry", &S::asymmetry, -0.99, 0.99}, {"ambient", &S::ambient, 0, 1e3},
                                 {"samples", &S::samples, 1, 4096},         {"dither", &S::dither, 0, 1},
                                 {"seed", &S::seed, 0, kMostSeed},          {"samples_per_side", &S::samples_per_side, 1, 16}};
  return keys;
}

// --- Terrain ---

const SceneKeys<TerrainSettings>& terrainKeys() {
  using S = TerrainSettings;
  static const SceneKeys<S> keys{{"scale", &S::scale, 1e-6, 1e6},  {"origin", &S::origin, -kFar, kFar},
                                 {"seed", &S::seed, 0, kMostSeed}, {"samples_per_side", &S::samples_per_side, 1, 16},
                                 {"own_fog", &S::use_own_fog},     {"sun_scatter", &S::use_sun_scatter}};
  return keys;
}

const SceneKeys<TerrainShape>& terrainShapeKeys() {
  using S = TerrainShape;
  static const SceneKeys<S> keys{{"frequency", &S::frequency, 1e-6, 1},
                                 {"amplitude", &S::amplitude, 0, 1e4},
                                 {"gain", &S::gain, 0.05, 1},
                                 {"lacunarity", &S::lacunarity, 1, 4},
                                 {"camera_octaves", &S::camera_octaves, 0, 16},
                                 {"march_octaves", &S::march_octaves, 0, 16},
                                 {"normal_octaves", &S::normal_octaves, 0, 16}};
  return keys;
}

const SceneKeys<TerrainFbm>& terrainFbmKeys() {
  using S = TerrainFbm;
  static const SceneKeys<S> keys{{"lacunarities", &S::lacunarities, 1, 4}, {"gain", &S::gain, 0.05, 1}};
  return keys;
}

const SceneKeys<TerrainMarch>& terrainMarchKeys() {
  using S = TerrainMarch;
  static const SceneKeys<S> keys{{"steps", &S::steps, 1, 10000},
                                 {"step", &S::step, 0.01, 1},
                                 {"tolerance", &S::tolerance, 1e-6, 0.1},
                                 {"ceiling", &S::ceiling, 0, 1e6},
                                 {"nearest", &S::nearest, 1e-6, 1},
                                 {"farthest", &S::farthest, 1, 1e6},
                                 {"normal_step", &S::normal_step, 1e-6, 0.1}};
  return keys;
}

const SceneKeys<TerrainShadowSettings>& terrainShadowKeys() {
  using S = TerrainShadowSettings;
  static const SceneKeys<S> keys{{"lift", &S::lift, 0, 100},     {"sharpness", &S::sharpness, 0.1, 1000}, {"steps", &S::steps, 0, 10000},
                                 {"darkest", &S::darkest, 0, 1}, {"ceiling", &S::ceiling, 0, 1e6},        {"tint", &S::tint, 0, 1}};
  return keys;
}

const SceneKeys<TerrainGround>& terrainGroundKeys() {
  using S = TerrainGround;
  static const SceneKeys<S> keys{{"rock_dark", &S::rock_dark, 0, kBright},
                                 {"rock_light", &S::rock_light, 0, kBright},
                                 {"strata_frequency", &S::strata_frequency, 0, 10},
                                 {"strata_upwards", &S::strata_upwards, 0, 1e5},
                                 {"rock_plain", &S::rock_plain, 0, 10},
                                 {"rock_grain", &S::rock_grain, 0, 10},
                                 {"rock_gain", &S::rock_gain, 0, 10},
                                 {"grain_frequency", &S::grain_frequency, 0, 1e4},
                                 {"grass", &S::grass, 0, kBright},
                                 {"grass_gain", &S::grass_gain, 0, 10},
                                 {"grass_plain", &S::grass_plain, 0, 10},
                                 {"grass_grain", &S::grass_grain, 0, 10},
                                 {"grass_from", &S::grass_from, -1, 2},
                                 {"grass_to", &S::grass_to, -1, 2},
                                 {"meadow", &S::meadow, 0, kBright},
                                 {"meadow_gain", &S::meadow_gain, 0, 10},
                                 {"meadow_plain", &S::meadow_plain, 0, 10},
                                 {"meadow_grain", &S::meadow_grain, 0, 10},
                                 {"meadow_from", &S::meadow_from, -1, 2},
                                 {"meadow_to", &S::meadow_to, -1, 2},
                                 {"coarse_grain", &S::coarse_grain, 0, 1e4},
                                 {"fine_grain", &S::fine_grain, 0, 1e4},
                                 {"light_plain", &S::light_plain, 0, 10},
                                 {"light_gain", &S::light_gain, 0, 10},
                                 {"snow", &S::snow, 0, kBright},
                                 {"snow_gain", &S::snow_gain, 0, 10},
                                 {"snow_low", &S::snow_low, -1e6, 1e6},
                                 {"snow_high", &S::snow_high, -1e6, 1e6},
                                 {"snow_noise", &S::snow_noise, 0, 1e6},
                                 {"snow_frequency", &S::snow_frequency, 0, 1e4},
                                 {"snow_steep", &S::snow_steep, 0, 2},
                                 {"snow_flat", &S::snow_flat, 0, 2},
                                 {"snow_sunny", &S::snow_sunny, 0, 1},
                                 {"snow_shady", &S::snow_shady, 0, 1},
                                 {"snow_side_width", &S::snow_side_width, 1e-6, 2},
                                 {"snow_from", &S::snow_from, -1, 2},
                                 {"snow_to", &S::snow_to, -1, 2}};
  return keys;
}

const SceneKeys<TerrainLight>& terrainLightKeys() {
  using S = TerrainLight;
  static const SceneKeys<S> keys{{"sun", &S::sun, 0, kBright},
                                 {"sky", &S::sky, 0, kBright},
                                 {"sky_plain", &S::sky_plain, 0, 10},
                                 {"sky_up", &S::sky_up, 0, 10},
                                 {"bounce", &S::bounce, 0, kBright},
                                 {"bounce_plain", &S::bounce_plain, 0, 10},
                                 {"bounce_facing", &S::bounce_facing, 0, 10},
                                 {"specular", &S::specular, 0, kBright},
                                 {"gloss_exponent", &S::gloss_exponent, 0, 1e4},
                                 {"fresnel_plain", &S::fresnel_plain, 0, 10},
                                 {"fresnel_gain", &S::fresnel_gain, 0, 10},
                                 {"fresnel_exponent", &S::fresnel_exponent, 0, 100},
                                 {"gloss_plain", &S::gloss_plain, 0, 10},
                                 {"gloss_snow", &S::gloss_snow, 0, 10},
                                 {"snow_rim", &S::snow_rim, 0, kBright},
                                 {"rim_exponent", &S::rim_exponent, 0, 100},
                                 {"rim_to", &S::rim_to, 1e-6, 10}};
  return keys;
}

const SceneKeys<TerrainSkySettings>& terrainSkyKeys() {
  using S = TerrainSkySettings;
  static const SceneKeys<S> keys{{"color", &S::color, 0, kBright},
                                 {"darkening", &S::darkening, 0, 10},
                                 {"haze", &S::haze, 0, kBright},
                                 {"haze_exponent", &S::haze_exponent, 0, 1e3},
                                 {"wide_lobe", &S::wide_lobe, 0, kBright},
                                 {"middle_lobe", &S::middle_lobe, 0, kBright},
                                 {"narrow_lobe", &S::narrow_lobe, 0, kBright},
                                 {"wide_exponent", &S::wide_exponent, 0, 1e6},
                                 {"middle_exponent", &S::middle_exponent, 0, 1e6},
                                 {"narrow_exponent", &S::narrow_exponent, 0, 1e6},
                                 {"cloud", &S::cloud, 0, kBright},
                                 {"cloud_share", &S::cloud_share, 0, 1},
                                 {"cloud_from", &S::cloud_from, -1, 2},
                                 {"cloud_to", &S::cloud_to, -1, 2},
                                 {"cloud_height", &S::cloud_height, 0, 1e6},
                                 {"cloud_frequency", &S::cloud_frequency, 1e-9, 1e3},
                                 {"horizon", &S::horizon, 0, kBright},
                                 {"horizon_exponent", &S::horizon_exponent, 0, 1e3}};
  return keys;
}

const SceneKeys<TerrainFog>& terrainFogKeys() {
  using S = TerrainFog;
  static const SceneKeys<S> keys{{"density", &S::density, 0, 1e3},
                                 {"exponent", &S::exponent, 1e-3, 100},
                                 {"color", &S::color, 0, kBright},
                                 {"scatter", &S::scatter, 0, kBright},
                                 {"scatter_exponent", &S::scatter_exponent, 0, 1e6}};
  return keys;
}

const SceneKeys<TerrainPathSettings>& terrainPathKeys() {
  using S = TerrainPathSettings;
  static const SceneKeys<S> keys{{"time_factor", &S::time_factor, -1e3, 1e3},
                                 {"radius", &S::radius, 0, 1e6},
                                 {"x_rate", &S::x_rate, -1e3, 1e3},
                                 {"z_rate", &S::z_rate, -1e3, 1e3},
                                 {"z_phase", &S::z_phase, -1e3, 1e3},
                                 {"clearance", &S::clearance, -1e6, 1e6},
                                 {"sink", &S::sink, -1e6, 1e6},
                                 {"look_ahead", &S::look_ahead, 1e-6, 1e3},
                                 {"roll", &S::roll, -10, 10},
                                 {"roll_rate", &S::roll_rate, -1e3, 1e3},
                                 {"focal_length", &S::focal_length, 0.05, 1e3}};
  return keys;
}

// --- After drawing ---

const SceneKeys<MotionBlurSettings>& motionBlurKeys() {
  using S = MotionBlurSettings;
  static const SceneKeys<S> keys{
      {"motion_taps", &S::taps, 1, 1024}, {"motion_limit", &S::limit, 0, 10}, {"shutter", &S::shutter_seconds, 0, 1e3}};
  return keys;
}

const SceneKeys<VignetteSettings>& vignetteKeys() {
  using S = VignetteSettings;
  static const SceneKeys<S> keys{{"vignette", &S::corner, 0, 1}, {"vignette_exponent", &S::exponent, 1e-3, 100}};
  return keys;
}

const SceneKeys<ContrastSettings>& contrastKeys() {
  using S = ContrastSettings;
  static const SceneKeys<S> keys{{"contrast", &S::amount, 0, 1}, {"lift", &S::lift, -1, 1}};
  return keys;
}

// --- Reading and lists ---

void readKey(TomlReader& table, const char* name, double low, double high, bool takes_one, const KeyValue& value) {
  const auto read = [&](auto* given) {
    using Value = std::remove_pointer_t<decltype(given)>;
    if constexpr (std::is_same_v<Value, bool>)
      table.read(name, *given);
    else if constexpr (std::is_same_v<Value, Vec3>)
      table.read(name, low, high, *given, takes_one);
    else if constexpr (std::is_integral_v<Value>)
      table.read(name, int64_t(low), int64_t(high), *given);
    else
      table.read(name, low, high, *given);
  };
  std::visit(read, value);
}

namespace {

std::string tomlText(float value) { return shortestText(value); }
std::string tomlText(double value) { return shortestText(value); }
std::string tomlText(int value) { return std::to_string(value); }
std::string tomlText(uint32_t value) { return std::to_string(value); }
std::string tomlText(bool value) { return value ? "true" : "false"; }
std::string tomlText(Vec2 v) { return "[" + tomlText(v.x) + ", " + tomlText(v.y) + "]"; }
std::string tomlText(Vec3 v) { return "[" + tomlText(v.x) + ", " + tomlText(v.y) + ", " + tomlText(v.z) + "]"; }

// Calls visit(table, keys, settings) for every table of keys.
template <typename Visit>
void visitKeys(const SceneFile& scene, const Visit& visit) {
  const SkySettings& sky = scene.light.sky;
  visit("sky", sunDiscKeys(), sky.disc);
  visit("sky", smoothDiscKeys(), sky.smooth_disc);
  visit("sky", skyKeys(), sky);
  if (sky.moon) visit("sky.moon", moonKeys(), *sky.moon);
  if (sky.moon) visit("sky.moon", moonDiscKeys(), sky.moon->disc);
  if (sky.stars) visit("sky.stars", starKeys(), *sky.stars);
  const PostSettings& post = scene.post;
  visit("light", lightKeys(), scene.light);
  visit("light", shadowKeys(), scene.shadows);
  visit("light", phaseKeys(), post.composite.phase);
  visit("fog", chainFogKeys(), post.composite);
  visit("chain", depthKeys(), post);
  visit("chain", distortKeys(), post.distort);
  if (post.published) {
    visit("chain", publishedKeys(), *post.published);
    visit("chain", channelKeys(), post.published->channels);
    visit("chain", blurKeys(), post.published->blur);
    visit("chain", depthBlurKeys(), post.published->depth_blur);
  } else {
    visit("chain", paintedKeys(), post.painted);
    visit("chain", softenKeys(), post.painted.soften);
    visit("chain", erodeKeys(), post.painted.erode);
  }
  if (!scene.slabs.empty()) visit("slab", slabKeys(), scene.slabs.front());
  if (!scene.slabs.empty()) visit("slab", slabToneKeys(), scene.slabs.front().tones);
  if (!scene.distance_clouds.empty()) visit("marched by distance", distanceCloudKeys(), scene.distance_clouds.front());
  if (!scene.density_clouds.empty()) visit("marched by density", densityCloudKeys(), scene.density_clouds.front());
  if (!scene.dust.empty()) visit("dust", dustKeys(), scene.dust.front().settings);
  if (scene.terrain) visitTerrainKeys(*scene.terrain, visit);
  const GradeSettings& grade = scene.grade;
  if (grade.motion_blur) visit("grade", motionBlurKeys(), *grade.motion_blur);
  if (grade.vignette) visit("grade", vignetteKeys(), *grade.vignette);
  if (grade.contrast) visit("grade", contrastKeys(), *grade.contrast);
}

// A scene with everything.
SceneFile wholeScene(bool as_published) {
  const std::string published = as_published ? "as_published = true\n" : "";
  const std::string text =
      "[sky]\n" + published + "[sky.moon]\n[sky.stars]\n[chain]\n" + published + "[[slab]]\n" + published + "[[marched]]\n" + published +
      "[[marched]]\nfield = 'density'\n" + published + "[terrain]\n" + published +
      "[[dust]]\nlattice = 'cloud.json'\n[camera]\npath = 'terrain'\n[grade]\nmotion_blur = true\nvignette = 0.5\ncontrast = 0.4\n";
  return readSceneFile("scene", text, [](const PictureSettings& view) { return view; });
}

}  // namespace

std::vector<DescribedKey> describeKeys(const SceneFile& scene) {
  std::vector<DescribedKey> all;
  visitKeys(scene, [&](const char* table, const auto& keys, const auto& settings) {
    for (const auto& key : keys)
      all.push_back({table, key.name, std::visit([&](auto field) { return tomlText(settings.*field); }, key.field)});
  });
  return all;
}

std::string listSceneKeys() {
  std::vector<std::array<std::string, 3>> rows;
  for (const DescribedKey& key : describeKeys(wholeScene(false))) rows.push_back({key.table + "\t" + key.name, key.value, "-"});
  for (const DescribedKey& key : describeKeys(wholeScene(true))) {
    const std::string name = key.table + "\t" + key.name;
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& one) { return one[0] == name; });
    if (row == rows.end())
      rows.push_back({name, "-", key.value});
    else
      (*row)[2] = key.value;
  }
  std::string text;
  for (const auto& [name, fallback, published] : rows) text += name + "\t" + fallback + "\t" + published + "\n";
  return text;
}

}  // namespace cloudbake
