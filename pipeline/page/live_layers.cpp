#include "pipeline/page/live_layers.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "pipeline/page/layer_data.h"
#include "pipeline/picture/scene_shadows.h"

namespace cloudbake {

namespace {

Json keyJson(float value) { return shortest(value); }
Json keyJson(double value) { return value; }
Json keyJson(int value) { return value; }
Json keyJson(uint32_t value) { return value; }
Json keyJson(uint64_t value) { return value; }
Json keyJson(bool value) { return value; }
Json keyJson(Vec2 v) { return {shortest(v.x), shortest(v.y)}; }
Json keyJson(Vec3 v) { return jsonOf(v); }
template <typename Value>
Json keyJson(const std::optional<Value>& value) {
  return value ? keyJson(*value) : Json();
}

/// Settings by key, and the limits of the keys by table.
class Tables {
 public:
  template <typename Settings>
  void add(Json& values, std::string_view table, const Keys<Settings>& keys, const Settings& settings) {
    visitValues(keys, settings, [&](const Key<Settings>& key, const auto& value) {
      values[key.name] = keyJson(value);
      if (key.use != KeyUse::kComputed) limits_[table][key.name] = limitsOf(key);
    });
  }
  Json takeLimits() { return std::move(limits_); }

 private:
  Json limits_ = Json::object();
};

Json terrainJson(const TerrainSettings& terrain, Tables& tables) {
  Json json;
  visitTerrainKeys(terrain, [&](std::string_view table, const auto& keys, const auto& settings) {
    const size_t dot = table.find('.');
    tables.add(dot == std::string_view::npos ? json : json[table.substr(dot + 1)], table, keys, settings);
  });
  return json;
}

Json slabJson(const SlabSettings& slab, Tables& tables) {
  Json json;
  tables.add(json, "slabs", slabKeys(), slab);
  tables.add(json, "slabs", slabToneKeys(), slab.tones);
  return json;
}

Json skyJson(const SkySettings& sky, Tables& tables) {
  Json json = {{"smooth", sky.sun_disc == DiscKind::kSmooth}};
  tables.add(json["smooth_disc"], "sky", smoothDiscKeys(), sky.smooth_disc);
  if (sky.moon) {
    tables.add(json["moon"], "sky.moon", moonKeys(), *sky.moon);
    json["smooth_moon"] = sky.moon->disc_kind == DiscKind::kSmooth;
    tables.add(json["moon"], "sky.moon", moonDiscKeys(), sky.moon->disc);
    tables.add(json["moon"], "sky.moon", smoothDiscKeys(), sky.moon->smooth_disc);
    for (const MoonCrater& crater : moonCraters())
      json["craters"].push_back({shortest(crater.center.x), shortest(crater.center.y), shortest(crater.center.z), shortest(crater.radius)});
  }
  if (sky.stars) tables.add(json["stars"], "sky.stars", starKeys(), *sky.stars);
  if (sky.aurora) tables.add(json["aurora"], "sky.aurora", auroraKeys(), *sky.aurora);
  return json;
}

Json gradeJson(const GradeSettings& grade, Tables& tables) {
  Json json = {{"sqrt_gamma", grade.sqrt_gamma}};
  if (grade.motion_blur) tables.add(json["motion_blur"], "grade.motion_blur", motionBlurKeys(), *grade.motion_blur);
  if (grade.vignette) tables.add(json["vignette"], "grade.vignette", vignetteKeys(), *grade.vignette);
  if (grade.contrast) tables.add(json["contrast"], "grade.contrast", contrastKeys(), *grade.contrast);
  return json;
}

Json dayJson(const Day& day) {
  return {
      {"hour", day.hour}, {"seconds", day.seconds}, {"noon", {shortest(day.noon.azimuth_degrees), shortest(day.noon.elevation_degrees)}}};
}

// The numbers of `from` that differ between moments, with their places: rows[i] is that of moment i.
void addDifferences(const Json& from, const std::vector<Json>& at, std::vector<Json> path, Json& differences) {
  if (from.is_object() || (from.is_array() && !from.empty() && from.front().is_structured())) {
    for (const auto& [key, value] : from.items()) {
      std::vector<Json> others;
      for (const Json& one : at) others.push_back(from.is_object() ? one.at(key) : one.at(std::stoul(key)));
      path.push_back(from.is_object() ? Json(key) : Json(std::stoul(key)));
      addDifferences(value, others, path, differences);
      path.pop_back();
    }
    return;
  }
  if (std::all_of(at.begin(), at.end(), [&](const Json& one) { return one == from; })) return;
  Json rows = Json::array();
  for (const Json& one : at) rows.push_back(one.is_array() ? one : Json::array({one}));
  differences.push_back({{"path", path}, {"rows", std::move(rows)}});
}

Json settingsJson(const SceneFile& scene, Tables& tables) {
  Json layers = {{"slabs", Json::array()}, {"distance", Json::array()}, {"density", Json::array()}, {"dust", Json::array()}};
  if (scene.terrain) layers["terrain"] = terrainJson(*scene.terrain, tables);
  for (const SlabSettings& slab : scene.slabs) layers["slabs"].push_back(slabJson(slab, tables));
  for (const DistanceCloudSettings& one : scene.distance_clouds)
    tables.add(layers["distance"].emplace_back(), "distance", distanceCloudKeys(), one);
  for (const DensityCloudSettings& one : scene.density_clouds)
    tables.add(layers["density"].emplace_back(), "density", densityCloudKeys(), one);
  for (const SceneDust& one : scene.dust) tables.add(layers["dust"].emplace_back(), "dust", dustKeys(), one.settings);
  return layers;
}

// What the height of the sun changes.
Json bySun(const Scenery& scenery, std::span<const float> heights, std::span<const SceneFile> under) {
  std::vector<Json> at;
  Json json = {{"heights", Json::array()}, {"values", Json::array()}};
  for (const float height : heights) json["heights"].push_back(shortest(height));
  for (const SceneFile& scene : under) {
    Tables not_needed;
    at.push_back(settingsJson(scene, not_needed));
  }
  addDifferences(at.front(), at, {}, json["values"]);
  const PictureSettings& view = scenery.scene.view;
  const auto snowSide = [&](float azimuth) {
    return sceneUnder(scenery, azimuth, view.sun_elevation_degrees).terrain.value().ground.snow_side;
  };
  json["snow_side"] = scenery.scene.terrain && snowSide(view.sun_azimuth_degrees) != snowSide(view.sun_azimuth_degrees + 90);
  return json;
}

}  // namespace

Json jsonOf(Vec3 v) { return {shortest(v.x), shortest(v.y), shortest(v.z)}; }

Json linearJson(const Affine& map) {
  Json columns = Json::array();
  for (size_t c = 0; c < 3; ++c)
    for (size_t r = 0; r < 3; ++r) columns.push_back(map.linear[r][c]);
  return columns;
}

Json affineJson(const Affine& map) {
  Json columns = linearJson(map);
  for (const double offset : map.offset) columns.push_back(offset);
  return columns;
}

SceneFile sceneUnder(const Scenery& scenery, float azimuth_degrees, float elevation_degrees) {
  Moment moment;
  moment.time_seconds = scenery.scene.view.time_seconds;
  moment.sun = SunAngles{azimuth_degrees, elevation_degrees};
  return scenery.read(moment);
}

bool isLayered(const SceneFile& scene) {
  const SkySettings& sky = scene.light.sky;
  const GradeSettings& grade = scene.grade;
  return scene.compares_techniques || scene.terrain || !scene.slabs.empty() || !scene.distance_clouds.empty() ||
         !scene.density_clouds.empty() || !scene.dust.empty() || sky.moon || sky.stars || sky.aurora || sky.sun_disc == DiscKind::kSmooth ||
         grade.sqrt_gamma || grade.motion_blur || grade.vignette || grade.contrast;
}

Json layersJson(const Scenery& scenery, std::span<const float> heights, std::span<const SceneFile> under) {
  const SceneFile& scene = scenery.scene;
  Tables tables;
  Json layers = settingsJson(scene, tables);
  layers["terrain_sky"] = scene.terrain && scene.terrain_sky;
  layers["sky"] = skyJson(scene.light.sky, tables);
  layers["grade"] = gradeJson(scene.grade, tables);
  layers["camera_path"] = scene.camera_path;
  if (scene.day) {
    layers["day"] = dayJson(*scene.day);
    Moment later;
    later.time_seconds = scene.view.time_seconds + scene.day->seconds / 3 + 1;
    const auto& moon = scene.light.sky.moon;
    const std::optional<MoonSettings> moved = moon ? scenery.read(later).light.sky.moon : std::nullopt;
    layers["day"]["places_moon"] = moon && moved->direction != moon->direction;
    layers["day"]["turns_moon"] = moon && moved->up != moon->up;
  }
  layers["dust_places"] = dustPlaces(scene);
  layers["is_sheet"] = scene.compares_techniques;
  layers["has_shadows"] = drawsShadows(scene);
  if (!under.empty()) layers["by_sun"] = bySun(scenery, heights, under);
  layers["limits"] = tables.takeLimits();
  return layers;
}

}  // namespace cloudbake
