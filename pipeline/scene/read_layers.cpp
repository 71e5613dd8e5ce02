#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "core/text/toml.h"
#include "pipeline/scene/read_keys.h"
#include "pipeline/scene/scene_parts.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// The light of full day, by which settings of backdrops are meant: that of a sun as high as this one, or at 20 degrees.
SkyColors fullDay(const SceneFile& scene) {
  constexpr float kLowest = 0.34202F;
  return skyColorsFor(scene.post, std::max(kLowest, scene.light.sky.to_sun.y), scene.light.sky.ramp);
}

// The light at this hour relative to full day.
Vec3 hourTint(const SceneFile& scene) {
  const SkySettings& sky = scene.light.sky;
  const SkyColors day = fullDay(scene), now = lightColors(sky);
  return quotient(now.sun_color + now.ambient_sky, day.sun_color + day.ambient_sky);
}

bool readAsPublished(TomlReader& table) {
  bool as_published = false;
  table.read("as_published", as_published);
  return as_published;
}

// The light of the hour, on the ground and in its own sky, and snow on the side away from the sun.
void adaptToSky(TerrainSettings& terrain, const SceneFile& scene) {
  const SkySettings& sky = scene.light.sky;
  const SkyColors day = fullDay(scene);
  const Vec3 sun = quotient(keyLight(sky).color, day.sun_color), from_sky = quotient(sky.colors.ambient_sky, day.ambient_sky);
  TerrainLight& light = terrain.light;
  TerrainSkySettings& own = terrain.sky;
  for (Vec3* direct : {&light.sun, &light.specular, &own.wide_lobe, &own.middle_lobe, &own.narrow_lobe, &terrain.fog.scatter})
    *direct = *direct * sun;
  for (Vec3* ambient : {&light.sky, &light.bounce, &light.snow_rim, &own.color, &own.haze, &own.cloud, &own.horizon, &terrain.fog.color})
    *ambient = *ambient * from_sky;
  terrain.ground.snow_side = normalized(Vec3{-sky.to_sun.x, 0, -sky.to_sun.z}).value_or(terrain.ground.snow_side);
}

void readSnow(TomlReader& table, TerrainGround& ground) {
  float azimuth = 0;
  table.read("snow_side", -3600.0, 3600.0, azimuth);
  if (table.has("snow_side")) ground.snow_side = directionFromAngles(azimuth, 0);
  if (!(ground.snow_low < ground.snow_high))
    table.refuseAt(table.has("snow_low") ? "snow_low" : "snow_high", "[terrain.ground]: snow_low is not below snow_high");
}

TerrainSettings readTerrain(TomlReader table, const SceneFile& scene, bool& own_sky) {
  TerrainSettings terrain;
  own_sky = readAsPublished(table);
  if (!own_sky) adaptToSky(terrain, scene);
  table.read("own_sky", own_sky);
  terrain.use_own_fog = terrain.use_sun_scatter = own_sky;
  visitTerrainKeys(terrain, [&](const char* name, const auto& keys, auto& settings) {
    const char* dot = std::strchr(name, '.');
    if (!dot) return readKeys(table, keys, settings);
    TomlReader part = table.table(dot + 1);
    readKeys(part, keys, settings);
    if constexpr (std::is_same_v<decltype(settings), TerrainGround&>) readSnow(part, settings);
    part.finish();
  });
  table.finish();
  return terrain;
}

// Tones take the light of the hour: the shadow and the outline that of the sky, the light ones that of the sun too. Those that the table
// sets, or all if they are as published, are only darkened at night.
void adaptTones(const TomlReader& table, bool as_published, const SceneFile& scene, SlabSettings& slab) {
  const Vec3 whole = hourTint(scene), sky = quotient(scene.light.sky.colors.ambient_sky, fullDay(scene).ambient_sky);
  const Vec3 from_sky{std::min(whole.x, sky.x), std::min(whole.y, sky.y), std::min(whole.z, sky.z)};  // shadows stay the darker tones
  const float night = slabNightFactor(scene.light.sky.colors, slab);
  const auto adapt = [&](const char* key, Vec3& tone, Vec3 light) { tone = as_published || table.has(key) ? tone * night : tone * light; };
  adapt("shadow", slab.tones.shadow, from_sky);
  adapt("middle", slab.tones.middle, (whole + from_sky) * 0.5F);
  adapt("light", slab.tones.light, whole);
  adapt("highlight", slab.tones.highlight, whole);
  adapt("outline", slab.tones.outline, from_sky);
}

SlabSettings readSlab(TomlReader table, const SceneFile& scene) {
  const bool as_published = readAsPublished(table);
  SlabSettings slab = as_published ? publishedSlab() : SlabSettings{};
  slab.time_seconds = scene.view.time_seconds + scene.view.time_offset_seconds;
  readKeys(table, slabKeys(), slab);
  readKeys(table, slabToneKeys(), slab.tones);
  adaptTones(table, as_published, scene, slab);
  const auto demandOrder = [&](bool is_in_order, const char* first, const char* second, const char* what) {
    if (!is_in_order) table.refuseAt(table.has(first) ? first : second, what);
  };
  demandOrder(slab.bottom < slab.center && slab.center < slab.top, "center", "top",
              "[[slab]]: its heights are out of order: give bottom < center < top");
  demandOrder(slab.smooth_low < slab.smooth_high, "smooth_low", "smooth_high", "[[slab]]: smooth_low is not below smooth_high");
  demandOrder(slab.outline_start < slab.outline_full, "outline_start", "outline_full", "[[slab]]: outline_start is not below outline_full");
  table.finish();
  return slab;
}

template <typename Settings>
Settings readMarched(TomlReader& table, const Keys<Settings>& keys, Settings clouds, const Vec3& tint, double time_seconds) {
  clouds.tint = tint;
  clouds.time_seconds = time_seconds;
  readKeys(table, keys, clouds);
  table.finish();
  return clouds;
}

}  // namespace

void readLayers(TomlReader& table, SceneFile& scene) {
  const double time = scene.view.time_seconds + scene.view.time_offset_seconds;
  const bool has_terrain = table.has("terrain");
  const TerrainSettings terrain = readTerrain(table.table("terrain"), scene, scene.terrain_sky);
  if (has_terrain) scene.terrain = terrain;
  for (TomlReader& slab : table.tables("slab")) scene.slabs.push_back(readSlab(std::move(slab), scene));
  for (TomlReader& marched : table.tables("marched")) {
    bool by_density = false;
    marched.read("field", {{"distance", false}, {"density", true}}, by_density);
    const bool as_published = readAsPublished(marched);
    const Vec3 tint = as_published ? Vec3{1, 1, 1} : hourTint(scene);
    if (by_density)
      scene.density_clouds.push_back(
          readMarched(marched, densityCloudKeys(), as_published ? publishedDensityClouds() : DensityCloudSettings{}, tint, time));
    else
      scene.distance_clouds.push_back(
          readMarched(marched, distanceCloudKeys(), as_published ? publishedDistanceClouds() : DistanceCloudSettings{}, tint, time));
  }
}

}  // namespace cloudbake
