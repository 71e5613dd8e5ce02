// Every key of a scene file, and the constants of the published techniques.
#include "pipeline/scene/scene_keys.h"

#include <map>
#include <stdexcept>

#include "tests/pipeline/picture_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

SceneFile readWhole(const std::string& text) {
  return readSceneFile("/scenes/a.toml", text, [](const PictureSettings& view) { return view; });
}

// The tables of a scene with everything, with more lines under one of them.
std::string wholeText(const std::string& table, const std::string& lines, const std::string& published) {
  const std::pair<const char*, std::string> tables[]{
      {"picture", "[picture]\n"},
      {"camera", "[camera]\npath = 'terrain'\n"},
      {"sun", "[sun]\n"},
      {"sky", "[sky]\n" + published},
      {"sky.colors", "[sky.colors]\n"},
      {"sky.moon", "[sky.moon]\n"},
      {"sky.stars", "[sky.stars]\n"},
      {"sky.aurora", "[sky.aurora]\n"},
      {"light", "[light]\n"},
      {"lamp", "[[lamp]]\n"},
      {"lightning", "[[lightning]]\n"},
      {"fog", "[fog]\n"},
      {"chain", "[chain]\n" + published},
      {"cloud", "[[cloud]]\npreset = 'hero'\n"},
      {"cloud.scatter", "[[cloud]]\npreset = 'hero'\n[cloud.scatter]\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\n"},
      {"slab", "[[slab]]\n" + published},
      {"dust", "[[dust]]\nlattice = 'cloud.json'\n"},
      {"marched by distance", "[[marched]]\n" + published},
      {"marched by density", "[[marched]]\nfield = 'density'\n" + published},
      {"terrain", "[terrain]\n" + published},
      {"terrain.shape", "[terrain.shape]\n"},
      {"terrain.fbm", "[terrain.fbm]\n"},
      {"terrain.march", "[terrain.march]\n"},
      {"terrain.shadow", "[terrain.shadow]\n"},
      {"terrain.ground", "[terrain.ground]\n"},
      {"terrain.light", "[terrain.light]\n"},
      {"terrain.sky", "[terrain.sky]\n"},
      {"terrain.fog", "[terrain.fog]\n"},
      {"terrain.path", "[terrain.path]\n"},
      {"grade", "[grade]\nmotion_blur = true\n"},
      {"volume", "[volume]\n"},
  };
  // Without these, the keys that they belong to are left out.
  const std::tuple<std::string, std::string, const char*> needed[]{{"sun", "hour", "12"},
                                                                   {"grade", "vignette", "0.5"},
                                                                   {"grade", "contrast", "0.4"},
                                                                   {"volume", "octaves", "0"},
                                                                   {"lamp", "look_at", "[0, -1, 0]"}};
  std::string text;
  bool found = table.empty();
  for (const auto& [name, head] : tables) {
    text += head + (name == table ? lines : "");
    for (const auto& [of, key, value] : needed)
      if (name == of && (of != table || !lines.starts_with(key + " ="))) text.append(key).append(" = ").append(value).append("\n");
    found = found || name == table;
  }
  EXPECT_TRUE(found) << "no table " << table;
  return text;
}

std::map<std::string, std::string> valuesOf(const SceneFile& scene) {
  std::map<std::string, std::string> values;
  for (const DescribedKey& key : describeKeys(scene))
    EXPECT_TRUE(values.try_emplace(key.table + "." + key.name, key.value).second) << key.name;
  return values;
}

// A value near the given one, in the same form: each number a little higher, or lower where it would leave its range.
std::string changedText(const std::string& value, double factor, double shift) {
  if (value == "true" || value == "false") return value == "true" ? "false" : "true";
  if (value == "unset") return shift > 0.5 ? "[0.5, 0.25, 0.75]" : "0.5";
  std::string text, number;
  const auto flush = [&] {
    if (number.empty()) return;
    const double was = std::stod(number);
    const bool is_whole = number.find_first_of(".e") == std::string::npos && was >= 2;
    text += shortestText(is_whole ? was + (factor > 1 ? 1 : -1) : was * factor + shift);
    number.clear();
  };
  for (const char c : value) {
    if (std::string("[], ").find(c) != std::string::npos) {
      flush();
      text += c;
    } else {
      number += c;
    }
  }
  flush();
  return text;
}

// Each key of the list is read, from its own table, into its own value.
TEST(SceneKeys, EachIsRead) {
  for (const std::string published : {"", "as_published = true\n"}) {
    const auto plain = valuesOf(readWhole(wholeText("", "", published)));
    EXPECT_GT(plain.size(), 180U);
    for (const auto& [table, name, value, is_whole, low, high, help, without_control] :
         describeKeys(readWhole(wholeText("", "", published)))) {
      std::string wrong;
      bool is_read = false;
      for (const auto& [factor, shift] : {std::pair{1.03, 0.01}, std::pair{0.97, 0.0}, std::pair{1.0, 1.0}}) {
        const std::string changed = changedText(value, factor, shift);
        try {
          auto found = valuesOf(readWhole(wholeText(table, name + " = " + changed + "\n", published)));
          std::string& own = found[table + "." + name];
          is_read = own != value;
          if (own.find_first_of("[tfu") == std::string::npos) is_read &= std::abs(std::stod(own) - std::stod(changed)) < 1e-5;
          own = value;
          // The light of the hour is that of the ground, too.
          EXPECT_TRUE(found == plain || table == "sky.colors" || table == "sun") << table << "." << name << " changes another key";
          if (is_read) break;
        } catch (const InputError& error) {
          wrong = error.what();
        }
      }
      EXPECT_TRUE(is_read) << table << "." << name << " = " << value << ": " << wrong;
    }
  }
}

// Converts to the type of any field.
struct Anything {
  template <typename Value>
  operator Value() const {
    throw std::logic_error("nothing is converted");
  }
};

template <typename Struct, typename... Fields>
constexpr size_t fieldCount() {
  if constexpr (requires { Struct{Fields{}..., Anything{}}; })
    return fieldCount<Struct, Fields..., Anything>();
  else
    return sizeof...(Fields);
}

// `others`: the fields that are no keys.
template <typename Settings>
void expectKeys(const Keys<Settings>& keys, std::initializer_list<const char*> others = {}) {
  EXPECT_EQ(keys.size(), fieldCount<Settings>() - others.size()) << "of the struct with the key " << keys.front().name;
}

TEST(SceneKeys, EachFieldHasOne) {
  expectKeys(slabKeys(), {"tones"});
  expectKeys(slabToneKeys());
  expectKeys(distanceCloudKeys());
  expectKeys(densityCloudKeys());
  expectKeys(dustKeys());
  expectKeys(starKeys());
  expectKeys(auroraKeys());
  expectKeys(skyStripKeys());
  expectKeys(moonKeys(), {"disc_kind", "disc", "smooth_disc", "picture"});
  expectKeys(moonDiscKeys());
  expectKeys(sunDiscKeys());
  expectKeys(smoothDiscKeys());
  expectKeys(skyKeys(), {"to_sun", "ramp", "colors", "sun_disc", "disc", "smooth_disc", "moon", "stars", "aurora"});
  expectKeys(colorKeys());
  expectKeys(fogKeys());
  expectKeys(shadowKeys(), {"cloud_shade"});
  expectKeys(phaseKeys());
  expectKeys(lampKeys());
  expectKeys(lightningKeys());
  expectKeys(lightKeys(), {"sky", "view_extinction", "first_surface", "samples_per_side", "lamps", "shown", "rays"});
  expectKeys(depthKeys(), {"published", "painted", "distort", "composite", "sky_samples_per_side"});
  expectKeys(distortKeys(), {"time_seconds", "mean"});
  expectKeys(chainFogKeys(), {"mean", "phase", "fog_color", "scatter"});
  expectKeys(scatterKeys());
  expectKeys(publishedKeys(), {"channels", "downsample_mean", "blur", "depth_blur"});
  expectKeys(channelKeys(), {"depth_range"});
  expectKeys(blurKeys(), {"mean"});
  expectKeys(depthBlurKeys(), {"mean"});
  expectKeys(paintedKeys(), {"soften", "erode"});
  expectKeys(softenKeys());
  expectKeys(erodeKeys(), {"seed"});
  expectKeys(motionBlurKeys());
  expectKeys(vignetteKeys());
  expectKeys(contrastKeys());
  expectKeys(growthKeys(), {"file", "preset", "fit", "levels", "to_world"});
  expectKeys(fieldKeys(), {"low", "high"});
  expectKeys(dayKeys(), {"noon"});
  expectKeys(volumeKeys(), {"octaves"});
  expectKeys(octaveKeys(), {"eccentricity"});
  const TerrainSettings terrain;
  visitTerrainKeys(terrain, [](const std::string& table, const auto& keys, const auto&) {
    if (table == "terrain")
      expectKeys(keys, {"shape", "fbm", "march", "shadow", "ground", "light", "sky", "fog", "path"});
    else
      expectKeys(keys);
  });
}

/// A number of a published technique, where it is in a scene file.
struct PublishedConstant {
  const char *key, *value;
};

// Restated from the sources that the renderers name, not from the code. Colours that are products are multiplied out.
constexpr PublishedConstant kPublished[]{
    // "On Mesh Cloud Rendering", "Volumetric Clouds and Mega-Particles"
    {"chain.draw_divisor", "2"},
    {"chain.divisor", "4"},
    {"chain.near_sigma", "10"},
    {"chain.far_sigma", "0.1"},
    {"chain.far_tiles", "4"},
    // "Procedural Stylized Sky 1"
    {"sky.disc_exponent", "1000"},
    {"sky.disc_gain", "250"},
    {"sky.smooth_softness", "2"},
    {"sky.smooth_gain", "0.06"},
    // "Stylized cartoon volumetric clouds"
    {"slab.opaque_widths", "2"},
    {"slab.least_den", "1e-04"},
    {"slab.shadow_limit", "0.33"},
    {"slab.middle_limit", "0.66"},
    {"slab.self_shadow", "0.85"},
    {"slab.self_shadow_gain", "0.5"},
    {"slab.outline_strength", "0.3"},
    {"slab.horizon_start", "0.05"},
    {"slab.horizon_gain", "5"},
    {"slab.tone_softness", "0"},
    // "Cloud Ten"
    {"marched by distance.noise_frequency", "0.4"},
    {"marched by distance.noise_offset", "0.4"},
    {"marched by distance.first_step", "1"},
    {"marched by distance.step_factor", "0.8"},
    {"marched by distance.contact", "0.1"},
    {"marched by distance.farthest", "70"},
    {"marched by distance.step_back", "5"},
    {"marched by distance.samples", "128"},
    {"marched by distance.thin_color", "[0.8, 0.75, 0.85]"},
    {"marched by distance.dense_color", "[0, 0, 0]"},
    {"marched by distance.shadow_start", "0.2"},
    {"marched by distance.shadow_slope", "0.05"},
    {"marched by distance.shadow_tuning", "0"},
    {"marched by distance.shadow_distance", "1"},
    {"marched by distance.shadow_range", "0.85"},
    {"marched by distance.shadow_floor", "0.15"},
    {"marched by distance.opacity_factor", "0.9"},
    {"marched by distance.least_step", "0.4"},
    {"marched by distance.step_base", "2"},
    {"marched by distance.step_density", "30"},
    {"marched by distance.step_growth", "0.011"},
    {"marched by distance.stop_opacity", "0.99"},
    {"marched by distance.fade_start", "1"},
    {"marched by distance.tint", "[1, 1, 1]"},
    // "Clouds"
    {"marched by density.flatness", "0.15"},
    {"marched by density.cloud_height", "10.8"},
    {"marched by density.noise_strength", "1.6"},
    {"marched by density.noise_frequency", "0.15"},
    {"marched by density.noise_contrast", "1"},
    {"marched by density.thin_color", "[0.8, 0.76, 0.72]"},
    {"marched by density.dense_color", "[0.12, 0.12, 0.12]"},
    {"marched by density.color_factor", "0.65"},
    {"marched by density.glow_color", "[1, 0.7, 0.4]"},
    {"marched by density.glow_strength", "0.3"},
    {"marched by density.glow_exponent", "6"},
    {"marched by density.fade_density", "0.0018"},
    {"marched by density.opacity_factor", "0.5"},
    {"marched by density.first_t", "0.1"},
    {"marched by density.least_step", "0.1"},
    {"marched by density.step_growth", "0.3"},
    {"marched by density.samples", "64"},
    {"marched by density.stop_opacity", "0.99"},
    {"marched by density.parts", "1"},
    {"marched by density.tint", "[1, 1, 1]"},
    // "Elevated"
    {"terrain.scale", "250"},
    {"terrain.own_fog", "true"},
    {"terrain.sun_scatter", "true"},
    {"terrain.shape.frequency", "0.003"},
    {"terrain.shape.amplitude", "120"},
    {"terrain.shape.gain", "0.5"},
    {"terrain.shape.lacunarity", "2"},
    {"terrain.shape.camera_octaves", "3"},
    {"terrain.shape.march_octaves", "9"},
    {"terrain.shape.normal_octaves", "16"},
    {"terrain.fbm.lacunarities", "[2.02, 2.03, 2.01]"},
    {"terrain.fbm.gain", "0.5"},
    {"terrain.march.step", "0.4"},
    {"terrain.march.tolerance", "0.0015"},
    {"terrain.march.steps", "300"},
    {"terrain.march.ceiling", "300"},
    {"terrain.march.normal_step", "0.001"},
    {"terrain.shadow.lift", "0.05"},
    {"terrain.shadow.sharpness", "16"},
    {"terrain.shadow.steps", "80"},
    {"terrain.shadow.darkest", "0.001"},
    {"terrain.shadow.ceiling", "200"},
    {"terrain.shadow.tint", "[0, 0.5, 0.8]"},
    {"terrain.ground.rock_dark", "[0.08, 0.05, 0.03]"},
    {"terrain.ground.rock_light", "[0.1, 0.09, 0.08]"},
    {"terrain.ground.strata_frequency", "7e-05"},
    {"terrain.ground.strata_upwards", "48"},
    {"terrain.ground.rock_plain", "0.75"},
    {"terrain.ground.rock_grain", "0.25"},
    {"terrain.ground.rock_gain", "0.9"},
    {"terrain.ground.grain_frequency", "7"},
    {"terrain.ground.grass", "[0.45, 0.3, 0.15]"},
    {"terrain.ground.grass_gain", "0.2"},
    {"terrain.ground.grass_plain", "0.5"},
    {"terrain.ground.grass_grain", "0.5"},
    {"terrain.ground.grass_from", "0.7"},
    {"terrain.ground.grass_to", "0.9"},
    {"terrain.ground.meadow", "[0.3, 0.3, 0.1]"},
    {"terrain.ground.meadow_gain", "0.15"},
    {"terrain.ground.meadow_plain", "0.25"},
    {"terrain.ground.meadow_grain", "0.75"},
    {"terrain.ground.meadow_from", "0.95"},
    {"terrain.ground.meadow_to", "1"},
    {"terrain.ground.coarse_grain", "1.25"},
    {"terrain.ground.fine_grain", "10"},
    {"terrain.ground.light_plain", "0.1"},
    {"terrain.ground.light_gain", "1.8"},
    {"terrain.ground.snow", "[0.62, 0.65, 0.7]"},
    {"terrain.ground.snow_gain", "0.29"},
    {"terrain.ground.snow_low", "55"},
    {"terrain.ground.snow_high", "80"},
    {"terrain.ground.snow_noise", "25"},
    {"terrain.ground.snow_frequency", "0.01"},
    {"terrain.ground.snow_steep", "0.5"},
    {"terrain.ground.snow_flat", "0.1"},
    {"terrain.ground.snow_sunny", "0.3"},
    {"terrain.ground.snow_shady", "0.7"},
    {"terrain.ground.snow_side_width", "0.1"},
    {"terrain.ground.snow_from", "0.1"},
    {"terrain.ground.snow_to", "0.9"},
    {"terrain.light.sun", "[10.4, 6.5, 3.9]"},
    {"terrain.light.sky", "[0.48, 0.72, 1.2]"},
    {"terrain.light.sky_plain", "0.5"},
    {"terrain.light.sky_up", "0.5"},
    {"terrain.light.bounce", "[0.4, 0.5, 0.6]"},
    {"terrain.light.bounce_plain", "0.2"},
    {"terrain.light.bounce_facing", "0.8"},
    {"terrain.light.specular", "[7, 5, 3]"},
    {"terrain.light.gloss_exponent", "16"},
    {"terrain.light.fresnel_plain", "0.04"},
    {"terrain.light.fresnel_gain", "0.96"},
    {"terrain.light.fresnel_exponent", "5"},
    {"terrain.light.gloss_plain", "0.7"},
    {"terrain.light.gloss_snow", "0.3"},
    {"terrain.light.snow_rim", "[0.195, 0.325, 0.39]"},
    {"terrain.light.rim_exponent", "4"},
    {"terrain.light.rim_to", "0.6"},
    {"terrain.sky.color", "[0.3, 0.5, 0.85]"},
    {"terrain.sky.darkening", "0.5"},
    {"terrain.sky.haze", "[0.595, 0.6375, 0.7225]"},
    {"terrain.sky.haze_exponent", "4"},
    {"terrain.sky.wide_lobe", "[0.25, 0.175, 0.1]"},
    {"terrain.sky.middle_lobe", "[0.25, 0.2, 0.15]"},
    {"terrain.sky.narrow_lobe", "[0.2, 0.16, 0.12]"},
    {"terrain.sky.wide_exponent", "5"},
    {"terrain.sky.middle_exponent", "64"},
    {"terrain.sky.narrow_exponent", "512"},
    {"terrain.sky.cloud", "[1, 0.95, 1]"},
    {"terrain.sky.cloud_share", "0.5"},
    {"terrain.sky.cloud_from", "0.5"},
    {"terrain.sky.cloud_to", "0.8"},
    {"terrain.sky.cloud_height", "1000"},
    {"terrain.sky.cloud_frequency", "0.0005"},
    {"terrain.sky.horizon", "[0.272, 0.442, 0.68]"},
    {"terrain.sky.horizon_exponent", "16"},
    {"terrain.fog.density", "0.001"},
    {"terrain.fog.exponent", "1.5"},
    {"terrain.fog.color", "[0.26, 0.4225, 0.65]"},
    {"terrain.fog.scatter", "[0.3, 0.21, 0.09]"},
    {"terrain.fog.scatter_exponent", "8"},
    {"terrain.path.time_factor", "0.1"},
    {"terrain.path.radius", "1100"},
    {"terrain.path.x_rate", "0.23"},
    {"terrain.path.z_rate", "0.21"},
    {"terrain.path.z_phase", "1.5"},
    {"terrain.path.clearance", "22"},
    {"terrain.path.sink", "20"},
    {"terrain.path.look_ahead", "3"},
    {"terrain.path.roll", "0.2"},
    {"terrain.path.roll_rate", "0.1"},
    {"terrain.path.focal_length", "3"},
    {"grade.motion_taps", "32"},
    {"grade.motion_limit", "0.25"},
    {"grade.vignette", "0.5"},
    {"grade.vignette_exponent", "0.1"},
    {"grade.contrast", "0.4"},
    {"grade.lift", "[0, 0, 0.04]"},
};

// Numbers in a text, for a comparison that does not mind the last digit of a product.
std::vector<double> numbersIn(std::string text) {
  if (text == "true" || text == "false") return {double(text == "true")};
  for (char& c : text)
    if (c == '[' || c == ']' || c == ',') c = ' ';
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number = 0; stream >> number;) numbers.push_back(number);
  return numbers;
}

TEST(SceneKeys, HaveThePublishedValues) {
  const auto values = valuesOf(readWhole(wholeText("", "", "as_published = true\n")));
  for (const auto& [key, value] : kPublished) {
    const auto found = values.find(key);
    ASSERT_NE(found, values.end()) << key;
    const std::vector<double> numbers = numbersIn(found->second), expected = numbersIn(value);
    ASSERT_EQ(numbers.size(), expected.size()) << key << " = " << found->second;
    for (size_t i = 0; i < numbers.size(); ++i)
      EXPECT_NEAR(numbers[i], expected[i], 1e-6 * std::abs(expected[i])) << key << " = " << found->second;
  }
  EXPECT_EQ(values.at("slab.highlight"), values.at("slab.light")) << "the source mixes the light with itself";
  // What differs from the default is published where as_published is not set, too, or is one of a few that the docs explain.
  const auto defaults = valuesOf(readWhole(wholeText("", "", "")));
  std::vector<std::string> differ;
  for (const auto& [key, value] : kPublished)
    if (defaults.count(key) && numbersIn(defaults.at(key)) != numbersIn(values.at(key))) differ.emplace_back(key);
  EXPECT_EQ(differ, (std::vector<std::string>{
                        "sky.disc_exponent", "slab.tone_softness", "marched by distance.fade_start", "marched by density.noise_strength",
                        "marched by density.noise_contrast", "marched by density.color_factor", "marched by density.fade_density",
                        "marched by density.opacity_factor", "marched by density.parts", "terrain.own_fog", "terrain.sun_scatter"}));
  EXPECT_EQ(readWhole(wholeText("", "", "as_published = true\n")).terrain->ground.snow_side, (Vec3{1, 0, 0}));
  EXPECT_TRUE(readWhole(wholeText("", "", "as_published = true\n")).terrain_sky);
}

TEST(SceneKeys, AreListed) {
  const std::string list = sceneReference();
  EXPECT_TRUE(contains(list, "| `threshold` | 0.45 |  | 0 … 0.99 | ")) << list;
  EXPECT_TRUE(contains(list, "| `parts` | 16 | 1 | 1 … 256 | "));
  EXPECT_TRUE(contains(list, "| `near_sigma` | – | 10 | 0.001 … 1000 | "));
  EXPECT_TRUE(contains(list, "| `near_width` | 0.008 | – | 0 … 1 | "));
  EXPECT_TRUE(contains(list, "| `lobes_only` | false |  |  | "));
  const std::vector<DescribedKey> keys = describeKeys(readWhole(wholeText("", "", "")));
  for (const DescribedKey& key : keys) EXPECT_FALSE(key.help.empty()) << key.name;
}

}  // namespace
}  // namespace cloudbake
