// All settings and constants go to the page as JSON, from the structs that `preview` uses; vertices and triangles are packed.
#include "pipeline/page/live_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include "bake/mesh/mesh_topology.h"
#include "core/affine.h"
#include "core/error.h"
#include "core/harmonics.h"
#include "core/impostor.h"
#include "core/portable_math.h"
#include "io/gltf/asset_info.h"
#include "pipeline/page/layer_data.h"
#include "pipeline/page/live_layers.h"
#include "pipeline/page/packed_mesh.h"
#include "pipeline/page/packed_sequence.h"
#include "pipeline/picture/scene_shadows.h"
#include "preview/mesh_clouds/levels.h"

namespace cloudbake {

namespace {

Json jsonOf(const std::vector<Vec2>& places) {
  Json json = Json::array();
  for (const Vec2 p : places) json.push_back({shortest(p.x), shortest(p.y)});
  return json;
}

void refuseWhatIsNotShown(const SceneFile& scene) {
  constexpr size_t kMostNoiseClouds = 8;  // of compose.frag
  const size_t noise_clouds = scene.slabs.size() + scene.distance_clouds.size() + scene.density_clouds.size() + scene.dust.size();
  if (scene.compares_techniques && !hasMeshClouds(scene) && noise_clouds == 0)
    throw UsageError("view needs a cloud for a sheet of techniques: add a [[cloud]], a [[slab]], [[marched]] or [[dust]]");
  if (noise_clouds > kMostNoiseClouds)
    throw UsageError("view shows at most eight clouds of [[slab]], [[marched]] and [[dust]]: leave some out");
  if (scene.view.plain && !(scene.lamps.empty() && scene.lightning.empty()))
    throw UsageError("view shows lamps and lightning in the painted look: leave out --look plain");
  if (scene.view.plain && isLayered(scene)) throw UsageError("view shows only mesh clouds in the plain look: leave out the other layers");
}

// --- Looks ---

// The heights of the sun for tables: the hours of the sky, noon, where the key light changes, and half way between.
std::vector<float> tableHeights(const SkyRamp& ramp) {
  std::vector<float> heights, hours = skyHours(ramp);
  for (const float elevation : {kMoonLight, kLastLight, kFullLight}) hours.push_back(float(sinCosDegrees(elevation).sin));
  std::sort(hours.begin(), hours.end());
  hours.erase(std::unique(hours.begin(), hours.end()), hours.end());
  for (const float hour : hours) {
    if (!heights.empty()) heights.push_back((heights.back() + hour) / 2);
    heights.push_back(hour);
  }
  return heights;
}

/// The sun's heights of tables, and the scene's file as it is read under each of them; none for an asset.
struct SunTable {
  std::vector<float> heights;
  std::vector<SceneFile> scenes;
};

SunTable sunTable(const Scenery& scenery) {
  SunTable table{tableHeights(scenery.scene.light.sky.ramp), {}};
  if (!scenery.read) return table;
  for (const float height : table.heights) {
    const float elevation = float(asinDegrees(std::clamp(height, -1.0F, 1.0F)));
    table.scenes.push_back(sceneUnder(scenery, scenery.scene.view.sun_azimuth_degrees, elevation));
  }
  return table;
}

// The colours at each height. Those of a file follow what it sets, also where it sets a part of them.
std::vector<SkyColors> colorsOf(const SunTable& suns, const PostSettings& post, const SkyRamp& ramp) {
  std::vector<SkyColors> colors;
  for (const SceneFile& scene : suns.scenes) colors.push_back(scene.light.sky.colors);
  if (suns.scenes.empty())
    for (const float height : suns.heights) colors.push_back(skyColorsFor(post, height, ramp));
  return colors;
}

// Three numbers each: at the hours of the sky, at noon, and half way between them. From one hour to the next they are polynomials of degree
// 2 at most.
Json colorTable(std::span<const float> heights, std::span<const SkyColors> all) {
  const std::pair<const char*, Vec3 SkyColors::*> names[] = {
      {"zenith", &SkyColors::zenith},       {"horizon", &SkyColors::horizon},         {"ground", &SkyColors::ground},
      {"sun_color", &SkyColors::sun_color}, {"ambient_sky", &SkyColors::ambient_sky}, {"ambient_ground", &SkyColors::ambient_ground},
      {"low_sky", &SkyColors::low_sky}};
  Json table = {{"heights", Json::array()}};
  for (const float height : heights) table["heights"].push_back(shortest(height));
  for (const SkyColors& colors : all)
    for (const auto& [name, color] : names) table["colors"][name].push_back(jsonOf(colors.*color));
  return table;
}

Json chainJson(const PostSettings& post) {
  const DistortSettings& distort = post.distort;
  const CompositeSettings& composite = post.composite;
  const PhaseSettings& phase = composite.phase;
  Json chain;
  chain["distort"] = {{"tile_size", shortest(distort.tile_size)},
                      {"far_tiles", shortest(distort.far_tiles)},
                      {"swirl_strength", shortest(distort.swirl_strength)},
                      {"far_strength", shortest(distort.far_strength)},
                      {"swirl_speed", shortest(distort.swirl_speed)},
                      {"near_drift", {shortest(distort.near_drift.x), shortest(distort.near_drift.y)}},
                      {"far_drift", {shortest(distort.far_drift.x), shortest(distort.far_drift.y)}},
                      {"dark", shortest(distort.dark)},
                      {"seed", distort.seed},
                      {"octaves", kSwirlNoise.octaves},
                      {"gain", shortest(kSwirlNoise.gain)},
                      {"cells", kSwirlNoise.period},
                      {"typical_slope", shortest(kTypicalSlope)}};
  chain["composite"] = {{"fog_density", shortest(composite.fog_density)},
                        {"phase", {shortest(phase.share), shortest(phase.asymmetry), shortest(phase.limit)}}};
  chain["mean_all"] = composite.mean == ChannelMean::kAll;
  if (post.published) {
    const PublishedSteps& steps = *post.published;
    chain["draw_divisor"] = steps.channels.divisor;
    chain["samples"] = jsonOf(pixelPlaces(steps.channels.samples_per_side));
    chain["divisor"] = steps.divisor;
    chain["blur"] = {{"near_sigma", shortest(steps.blur.near_sigma)},
                     {"far_sigma", shortest(steps.blur.far_sigma)},
                     {"as_quoted", steps.blur.as_quoted}};
    chain["depth_blur"] = {{"radius", steps.depth_blur.radius}, {"shrink", steps.depth_blur.shrink}};
    return chain;
  }
  const PaintedSteps& painted = post.painted;
  const ErodeSettings& erode = painted.erode;
  chain["draw_divisor"] = 1;
  chain["samples"] = jsonOf(pixelPlaces(4));  // those of rasterChannels
  chain["depth_spread"] = shortest(painted.depth_spread);
  chain["soften"] = {{"near_width", shortest(painted.soften.near_width)}, {"far_width", shortest(painted.soften.far_width)}};
  chain["erode"] = {{"shrink", shortest(erode.shrink)},
                    {"darkening", shortest(erode.darkening)},
                    {"fading", {shortest(kFadingFrom), shortest(kFadingTo)}},
                    {"octaves", kErosionNoise.octaves},
                    {"gain", shortest(kErosionNoise.gain)}};
  return chain;
}

// Everything that is the same for all clouds in this look. `kind` is painted, published or plain.
Json lookJson(const std::string& kind, const PostSettings& post, const LightSettings& light, const SunTable& suns) {
  Json look = {{"kind", kind},
               {"half_lambert", shortest(light.half_lambert)},
               {"half_lambert_sky", shortest(light.half_lambert_sky)},
               {"volume_gain", shortest(light.volume_gain)},
               {"own_colors", light.own_colors},
               {"colors", colorTable(suns.heights, colorsOf(suns, post, light.sky.ramp))}};
  look["sky_places"] = jsonOf(pixelPlaces(post.sky_samples_per_side));
  if (kind == "plain") {
    look["samples"] = jsonOf(pixelPlaces(light.samples_per_side));
    look["view_extinction"] = shortest(light.view_extinction);
  } else {
    look["chain"] = chainJson(post);
    look["samples"] = look["chain"]["samples"];
    look["chain"].erase("samples");
  }
  return look;
}

std::string lookOfScene(const SceneFile& scene) { return scene.view.plain ? "plain" : scene.post.published ? "published" : "painted"; }

// An asset can be drawn in every look, a scene file says how it is drawn.
Json looksOf(const SceneFile& scene, const SunTable& suns) {
  Json looks;
  if (!hasMeshClouds(scene) && !isLayered(scene)) {
    const auto add = [&](const char* kind, const PostSettings& post) {
      looks[kind] = lookJson(kind, post, lightFor(post, scene.view.sun_azimuth_degrees, scene.view.sun_elevation_degrees), suns);
    };
    add("painted", {});
    add("published", publishedPost());
    add("plain", publishedPost());
  } else {
    const std::string kind = lookOfScene(scene);
    looks[kind] = lookJson(kind, scene.post, scene.light, suns);
  }
  return looks;
}

// --- Keys ---

/// Keys of a scene file whose values the page has, by table.
class PageKeys {
 public:
  /// `paths`: where the page has the values of some of the keys, in its `scene` or in its `look`.
  template <typename Settings>
  void add(const char* table, const Keys<Settings>& keys, const std::map<std::string, Json>& paths) {
    for (const Key<Settings>& key : keys)
      if (const auto found = paths.find(key.name); found != paths.end()) add(table, key.name, found->second, limitsOf(key));
  }
  void add(const char* table, const char* name, const Json& path, const Json& limits) {
    all_.push_back({{"table", table}, {"name", name}, {"path", path}, {"limits", limits}});
  }
  Json take() { return std::move(all_); }

 private:
  Json all_ = Json::array();
};

// The keys of sky, light, fog and chain; those of the layers are beside the layers.
Json keysJson(const SceneFile& scene, bool has_simple_disc, bool are_colored) {
  PageKeys all;
  if (!scene.camera_path) {
    all.add("camera", viewKeys(), {{"fov", {"scene", "camera", "fov"}}});
    all.add("camera", cameraKeys(), {{"roll", {"scene", "camera", "roll"}}});
  }
  all.add("picture", pictureKeys(), {{"time_offset", {"scene", "time_offset"}}});
  if (scene.day) all.add("sun", dayKeys(), {{"day_seconds", {"scene", "layers", "day", "seconds"}}});
  const auto sky = [](const auto&... rest) { return Json::array({"scene", "sky", rest...}); };
  if (has_simple_disc) {
    all.add("sky", sunDiscKeys(), {{"disc_exponent", sky("disc", 0)}, {"disc_gain", sky("disc", 1)}});
    all.add("sky", skyKeys(), {{"glow", sky("disc", 2)}});
  }
  for (const char* name : {"horizon_exponent", "horizon_strength", "viewer_height"}) all.add("sky", skyKeys(), {{name, sky(name)}});
  if (scene.light.sky.horizon_color) all.add("sky", skyKeys(), {{"horizon_color", sky("horizon_color")}});
  for (const char* name : {"half_lambert", "half_lambert_sky", "volume_gain"}) all.add("light", lightKeys(), {{name, {"look", name}}});
  if (are_colored) all.add("light", lightKeys(), {{"own_colors", {"look", "own_colors"}}});
  all.add("light", shadowKeys(),
          {{"shadow_strength", {"scene", "shadows", "strength"}}, {"shadow_softness", {"scene", "shadows", "softness"}}});
  const auto addLamp = [&](const char* table, const auto& keys, size_t index, std::initializer_list<const char*> names) {
    for (const char* name : names) all.add(table, keys, {{name, {"scene", "lamps", index, name}}});
  };
  if (!scene.lamps.empty()) addLamp("[lamp]", lampKeys(), 0, {"color", "strength", "range", "radius"});
  if (!scene.lamps.empty() && !scene.lamps.front().look_at) addLamp("[lamp]", lampKeys(), 0, {"place"});
  if (!scene.lightning.empty())
    addLamp("[lightning]", lightningKeys(), scene.lamps.size(), {"color", "strength", "range", "radius", "decay"});
  all.add("fog", fogKeys(), {{"per_unit", {"scene", "distance_fog"}}});
  all.add("fog", scatterKeys(), {{"scatter", {"scene", "fog_scatter", 0}}, {"scatter_exponent", {"scene", "fog_scatter", 1}}});
  if (scene.fog.color != scene.light.sky.colors.horizon) all.add("fog", fogKeys(), {{"color", {"scene", "fog_color"}}});
  if (scene.view.plain) return all.take();
  const auto chain = [](const auto&... rest) { return Json::array({"look", "chain", rest...}); };
  all.add("light", phaseKeys(),
          {{"phase", chain("composite", "phase", 0)},
           {"phase_asymmetry", chain("composite", "phase", 1)},
           {"phase_limit", chain("composite", "phase", 2)}});
  all.add("fog", chainFogKeys(), {{"density", chain("composite", "fog_density")}});
  all.add("chain", depthKeys(), {{"near_distance", {"scene", "depth_range", 0}}, {"far_distance", {"scene", "depth_range", 1}}});
  for (const char* name :
       {"tile_size", "far_tiles", "swirl_strength", "far_strength", "swirl_speed", "near_drift", "far_drift", "dark", "seed"})
    all.add("chain", distortKeys(), {{name, chain("distort", name)}});
  if (scene.post.published) {
    all.add("chain", publishedKeys(), {{"divisor", chain("divisor")}});
    all.add("chain", channelKeys(), {{"draw_divisor", chain("draw_divisor")}});
    all.add("chain", blurKeys(),
            {{"near_sigma", chain("blur", "near_sigma")},
             {"far_sigma", chain("blur", "far_sigma")},
             {"blur_as_quoted", chain("blur", "as_quoted")}});
    all.add("chain", depthBlurKeys(), {{"depth_blur_radius", chain("depth_blur", "radius")}, {"shrink", chain("depth_blur", "shrink")}});
  } else {
    all.add("chain", paintedKeys(), {{"depth_spread", chain("depth_spread")}, {"detail_size", {"scene", "noise", "share"}}});
    all.add("chain", softenKeys(), {{"near_width", chain("soften", "near_width")}, {"far_width", chain("soften", "far_width")}});
    all.add("chain", erodeKeys(), {{"detail_shrink", chain("erode", "shrink")}, {"detail_darkening", chain("erode", "darkening")}});
  }
  return all.take();
}

// --- Lamps ---

Json jsonOf(const Lamp& lamp, Vec3 color, float strength) {
  return {{"place", jsonOf(lamp.place)},
          {"color", jsonOf(color)},
          {"strength", shortest(strength)},
          {"range", shortest(lamp.range)},
          {"radius", shortest(lamp.radius)},
          {"axis", jsonOf(lamp.axis)},
          {"cone", {shortest(lamp.cone.x), shortest(lamp.cone.y)}}};
}

// Lamps, then lightning with all of its flashes.
Json lampsJson(const SceneFile& scene) {
  Json all = Json::array();
  for (const LampSettings& lamp : scene.lamps) all.push_back(jsonOf(lampOf(lamp), lamp.color, lamp.strength));
  for (const LightningSettings& one : scene.lightning) {
    Json json = jsonOf(Lamp{one.place, {}, one.range, one.radius}, one.color, one.strength);
    json["every"] = one.at ? 0 : shortest(one.every_seconds);
    json["decay"] = shortest(one.decay_seconds);
    json["dark"] = shortest(kDarkFlash);
    for (const Flash& flash : flashesOf(one))
      json["flashes"].push_back({{"place", jsonOf(flash.place)}, {"strokes", jsonOf(flash.strokes)}});
    all.push_back(std::move(json));
  }
  return all;
}

// --- Camera and meshes ---

// Where the camera is, as the page turns it: about its target.
Json cameraJson(const Camera& camera, float roll_degrees, Json& view) {
  const Vec3 arm = camera.look_from - camera.look_at;
  const float distance = length(arm);
  view["azimuth"] = atan2Degrees(arm.x, arm.z);
  view["elevation"] = asinDegrees(std::clamp(double(arm.y / distance), -1.0, 1.0));
  view["zoom"] = 1;
  view["shift"] = {0, 0, 0};
  return {{"at", jsonOf(camera.look_at)},
          {"distance", shortest(distance)},
          {"fov", shortest(camera.vertical_fov_degrees)},
          {"roll", shortest(roll_degrees)},
          {"aspect", double(camera.width) / camera.height}};
}

struct Lobes {
  std::vector<Vec3> directions;
  std::vector<float> thicknesses;
  void append(const std::vector<Lobe>& lobes) {
    for (const Lobe& lobe : lobes) directions.push_back(lobe.direction), thicknesses.push_back(lobe.thickness);
  }
};

// Vertices and triangles of all clouds, one array after the other, and what belongs to each cloud. A copy of a cloud has its place in the
// arrays of the page, but its vertices are those of the first one, moved; they are not stored.
struct Meshes {
  MeshPacker packer;                                             // has the positions
  size_t vertices = 0, indices = 0;                              // with copies and with room for clouds that change
  std::map<const BakedMesh*, std::pair<size_t, Affine>> firsts;  // the part that is stored, and its place
  std::vector<Vec3> normals;
  Lobes lobes, compared;
  std::vector<float> colors;  // own ones: red, green and blue per vertex
  std::vector<float> harmonics;
  std::vector<uint32_t> triangles;
  std::vector<const ShadowCaster*> casters;
  int harmonic_order = 0;  // the largest of all clouds
  bool compares = false, are_colored = false;
  std::vector<const Impostor*> impostors;
  std::vector<const CloudSequence*> sequences;
  Json parts = Json::array(), corners = Json::array();
};

// The coefficients of each vertex, padded to whole vectors of four.
void appendHarmonics(Meshes& all, const BakedMesh& mesh) {
  const size_t count = mesh.harmonics.empty() ? 0 : harmonicCount(mesh.info.harmonic_order), padded = harmonicCount(all.harmonic_order);
  for (size_t v = 0; v < mesh.lobes.size(); ++v) {
    for (size_t i = 0; i < count; ++i) all.harmonics.push_back(mesh.harmonics[v * count + i]);
    all.harmonics.resize(all.harmonics.size() + (padded + 3) / 4 * 4 - count);
  }
}

Json harmonicsJson(const Instance& instance, const BakedMesh& mesh) {
  return {{"to_own", linearJson(inverted(instance.to_world).value())},
          {"extinction", shortest(mesh.info.extinction)},
          {"is_of_volume", mesh.info.volume.has_value()}};
}

// The field of an instance that casts a shadow, and the way to its space.
void appendCaster(Meshes& all, const Instance& instance, Json& part) {
  if (!instance.caster) return;
  const auto known = std::find(all.casters.begin(), all.casters.end(), instance.caster);
  part["caster"] = known - all.casters.begin();
  if (known == all.casters.end()) all.casters.push_back(instance.caster);
  part["to_own"] = affineJson(inverted(instance.to_world).value());
}

Json castersJson(const Meshes& meshes) {
  Json all = Json::array();
  for (const ShadowCaster* caster : meshes.casters)
    all.push_back({{"origin", jsonOf(caster->origin)}, {"cell_size", shortest(caster->cell_size)}, {"cells", caster->cells}});
  return all;
}

Json volumeJson(const VolumeLight& light) {
  const OctaveSettings& octaves = light.octaves;
  return {{"view_extinction", shortest(light.view_extinction)},
          {"asymmetry", shortest(light.asymmetry)},
          {"octaves", {octaves.count, shortest(octaves.extinction), shortest(octaves.contribution), shortest(octaves.eccentricity)}}};
}

Json shapeJson(const LobeShape& shape) { return {shortest(shape.exponent), shortest(shape.bias)}; }

// The map from one place to another, if it only turns, moves and scales.
std::optional<Affine> similarity(const Affine& from, const Affine& to) {
  const auto back = inverted(from);
  if (!back) return {};
  const Affine map = compose(to, *back);
  // The rows are perpendicular, as long as each other, and right-handed
  constexpr double kTolerance = 1e-9;
  const auto product = [&](size_t r, size_t s) {
    return map.linear[r][0] * map.linear[s][0] + map.linear[r][1] * map.linear[s][1] + map.linear[r][2] * map.linear[s][2];
  };
  const double square = product(0, 0);
  for (size_t r = 0; r < 3; ++r)
    for (size_t s = 0; s <= r; ++s)
      if (std::abs(product(r, s) - (r == s ? square : 0)) > kTolerance * square) return {};
  return determinant(map) > 0 ? std::optional(map) : std::nullopt;
}

// Whether the vertices of an instance are those of another one, moved: then the part says of which, and by what.
bool isCopy(Meshes& all, const Instance& instance, Json& part) {
  if (all.compares || all.harmonic_order > 0) return false;
  const auto [known, is_new] = all.firsts.try_emplace(instance.mesh, all.parts.size(), instance.to_world);
  if (is_new) return false;
  const auto map = similarity(known->second.second, instance.to_world);
  if (!map) return false;
  part["copy"] = {{"of", known->second.first}, {"by", affineJson(*map)}};
  return true;
}

// The impostor of an instance, and its pictures once.
Json impostorJson(Meshes& all, const Instance& instance, const SceneFile& scene) {
  const Impostor& impostor = *instance.mesh->impostor;
  const ImpostorInfo& info = impostor.info;
  const auto known = std::find(all.impostors.begin(), all.impostors.end(), &impostor);
  const auto picture = known - all.impostors.begin();
  if (known == all.impostors.end()) all.impostors.push_back(&impostor);
  Affine to_radii = inverted(instance.to_world).value();
  for (auto& row : to_radii.linear)
    for (double& entry : row) entry /= double(info.radius);
  Box ball;
  const Vec3 reach{info.radius, info.radius, info.radius};
  ball.add(info.center - reach), ball.add(info.center + reach);
  for (int i = 0; i < 8; ++i) all.corners.push_back(jsonOf(transformPoint(instance.to_world, ball.corner(i))));
  return {{"picture", picture},
          {"atlas", {info.views, info.frame, impostor.lobe.size() - 1, shortest(info.thickest)}},
          {"center", jsonOf(transformPoint(instance.to_world, info.center))},
          {"radius", shortest(info.radius * unitScale(instance.to_world))},
          {"own_radius", shortest(info.radius)},
          {"to_own", linearJson(to_radii)},
          {"to_world", linearJson(instance.to_world)},
          {"exponent", shortest(info.exponent)},
          {"extinction", shortest(worldExtinction(instance, scene.light))},
          {"gains", info.gains}};
}

// Of a cloud that changes, the part has room for the largest of its meshes, which the page puts there.
PlacedMesh roomFor(const CloudSequence& sequence, PlacedMesh placed) {
  size_t vertices = 0, triangles = 0;
  for (const SequenceSegment& segment : sequence.segments) {
    vertices = std::max(vertices, segment.keys.front().positions.size());
    triangles = std::max(triangles, segment.triangles.size());
  }
  placed.positions.resize(vertices), placed.triangles.resize(triangles);
  return placed;
}

// Which sequence an instance shows, and where.
Json sequenceJson(Meshes& all, const Instance& instance, const CloudSequence& sequence) {
  const auto known = std::find(all.sequences.begin(), all.sequences.end(), &sequence);
  const auto of = known - all.sequences.begin();
  if (known == all.sequences.end()) all.sequences.push_back(&sequence);
  return {{"of", of}, {"by", affineJson(instance.to_world)}};
}

// Of an impostor, the part has the corners of its box, where the page finds the light that comes past other things, and no triangles.
void appendInstance(Meshes& all, const Instance& instance, const Scenery& scenery) {
  PlacedMesh placed = placedMesh(instance, scenery.scene.light);
  if (instance.mesh->impostor) placed.triangles.clear();
  const auto changing = scenery.sequences.find(instance.mesh);
  if (changing != scenery.sequences.end()) placed = roomFor(changing->second.sequence, std::move(placed));
  const auto first = uint32_t(all.vertices);
  Json part = {{"first", all.indices},
               {"count", 3 * placed.triangles.size()},
               {"first_vertex", first},
               {"vertices", placed.positions.size()},
               {"lobe", instance.mesh->info.lobe},
               {"is_of_volume", instance.mesh->info.volume.has_value()},
               {"shape", shapeJson(placed.shape)},
               {"extinction", shortest(placed.extinction)}};
  appendCaster(all, instance, part);
  if (instance.mesh->impostor) part["impostor"] = impostorJson(all, instance, scenery.scene);
  all.vertices += placed.positions.size(), all.indices += 3 * placed.triangles.size();
  if (changing != scenery.sequences.end()) {
    part["sequence"] = sequenceJson(all, instance, changing->second.sequence);
  } else if (!isCopy(all, instance, part)) {
    part.update(all.packer.addPositions(placed.positions));
    all.normals.insert(all.normals.end(), placed.normals.begin(), placed.normals.end());
    all.lobes.append(placed.lobes);
    if (all.are_colored)
      for (const Vec3& own : ownColors(*instance.mesh)) all.colors.insert(all.colors.end(), {own.x, own.y, own.z});
    for (const Triangle& t : placed.triangles)
      for (const uint32_t v : t) all.triangles.push_back(first + v);
  }
  if (scenery.instances.size() == 1) {
    part["volume"] = volumeJson(instance.mesh->info.volume.value_or(VolumeLight{}));
    if (findDefects(instance.mesh->surface).unmatched_edges > 0) part["is_open"] = true;
  }
  const auto compared = scenery.compared.find(instance.mesh);
  const BakedMesh& with_harmonics =
      compared == scenery.compared.end() || !instance.mesh->harmonics.empty() ? *instance.mesh : compared->second;
  if (!with_harmonics.harmonics.empty()) part["harmonics"] = harmonicsJson(instance, with_harmonics);
  if (all.harmonic_order > 0 && changing == scenery.sequences.end()) appendHarmonics(all, with_harmonics);
  if (compared != scenery.compared.end()) {
    const PlacedMesh other = placedMesh({&compared->second, instance.to_world}, scenery.scene.light);
    part["compared"] = {{"lobe", compared->second.info.lobe},
                        {"is_of_volume", compared->second.info.volume.has_value()},
                        {"shape", shapeJson(other.shape)}};
    all.compared.append(other.lobes);
  } else if (all.compares) {
    all.compared.append(placed.lobes);
  }
  const Box box = boxOfMesh(instance);
  for (int i = 0; i < 8 && !box.empty(); ++i) all.corners.push_back(jsonOf(transformPoint(instance.to_world, box.corner(i))));
  all.parts.push_back(std::move(part));
}

// A cloud, then its levels, impostors among them, which the page draws in its place where it is small: the rule of
// preview/mesh_clouds/levels.h.
void appendWithLevels(Meshes& all, const Instance& instance, const Scenery& scenery) {
  const size_t full = all.parts.size();
  appendInstance(all, instance, scenery);
  if (instance.levels.empty()) return;
  for (const BakedMesh* level : instance.levels) {
    appendInstance(all, {level, instance.to_world}, scenery);
    all.parts.back()["level"] = {{"of", full}, {"pixels", level->info.switch_pixels}};
  }
  const Box box = drawnBox(instance.mesh->surface, instance.to_world);
  all.parts[full]["seen"] = {{"low", jsonOf(box.low)}, {"high", jsonOf(box.high)}, {"longest", shortest(longestStretched(instance))}};
}

Meshes meshesOf(std::span<const Instance> instances, const Scenery& scenery) {
  Meshes all;
  all.compares = !scenery.compared.empty();
  const auto useOrderOf = [&](const BakedMesh& mesh) {
    if (!mesh.harmonics.empty()) all.harmonic_order = std::max(all.harmonic_order, mesh.info.harmonic_order);
  };
  for (const auto& [own, compared] : scenery.compared) useOrderOf(compared);
  for (const Instance& instance : instances) useOrderOf(*instance.mesh);
  all.are_colored = std::ranges::any_of(instances, [](const Instance& one) { return !one.mesh->colors.empty(); });
  for (const Instance& instance : instances) appendWithLevels(all, instance, scenery);
  return all;
}

Json lobesJson(MeshPacker& packer, const Lobes& lobes) {
  const int steps = packer.addDirections(lobes.directions);
  packer.addRounded(lobes.thicknesses);
  return {{"direction_steps", steps}};
}

// Three bytes per pixel.
std::vector<uint8_t> bytesOf(const Image& picture) {
  std::vector<uint8_t> bytes;
  for (const Vec3& pixel : picture.pixels)
    for (const float value : {pixel.x, pixel.y, pixel.z}) bytes.push_back(uint8_t(std::lround(255 * std::clamp(value, 0.0F, 1.0F))));
  return bytes;
}

// Packs what comes after the positions; `layered`: the scene whose layers are packed with it, or null.
Json meshJson(Meshes& meshes, const SceneFile* layered) {
  MeshPacker& packer = meshes.packer;
  Json json = {
      {"vertices", meshes.vertices}, {"normal_steps", packer.addDirections(meshes.normals)}, {"lobes", lobesJson(packer, meshes.lobes)}};
  if (meshes.compares) json["compared"] = lobesJson(packer, meshes.compared);
  json["is_colored"] = meshes.are_colored;
  packer.addRounded(meshes.colors);
  packer.addFloats(meshes.harmonics);
  json["harmonics"] = meshes.harmonics.empty() ? 0 : (harmonicCount(meshes.harmonic_order) + 3) / 4 * 4;
  packer.addTriangles(meshes.triangles);
  json["fields"] = Json::array();
  for (const ShadowCaster* caster : meshes.casters) {
    packer.addBytes(caster->fractions);
    json["fields"].push_back(caster->fractions.size());
  }
  for (const Impostor* impostor : meshes.impostors) {
    for (const Image& picture : {impostor->lobe.front(), impostor->rest.front()}) packer.addBytes(bytesOf(picture));
    json["impostors"].push_back(3 * impostor->lobe.front().pixels.size());
  }
  for (const CloudSequence* sequence : meshes.sequences) json["sequences"].push_back(packedSequence(*sequence, packer));
  if (layered) json["layers"] = packedLayers(*layered, packer);
  json["data"] = packer.packed();
  return json;
}

// --- Fields of clouds ---

// A field: its wind and horizon, its clouds as six numbers each, and for every mesh the part that has it, whose levels follow.
Json fieldJson(const DrawnField& field, bool has_world_extinction, size_t& next_part) {
  const ScatterSettings& s = field.settings;
  Json json = {{"low", jsonOf(s.low)},
               {"high", jsonOf(s.high)},
               {"drift", jsonOf(s.drift)},
               {"fade", shortest(s.fade)},
               {"horizon_scale", shortest(s.horizon_scale)},
               {"horizon_lower", shortest(s.horizon_lower)},
               {"has_world_extinction", has_world_extinction},
               {"clouds", Json::array()},
               {"meshes", Json::array()}};
  for (const ScatteredCloud& cloud : field.clouds)
    for (const Json& number : {Json(shortest(cloud.place.x)), Json(shortest(cloud.place.y)), Json(shortest(cloud.place.z)),
                               Json(shortest(cloud.turn_degrees)), Json(shortest(cloud.size)), Json(cloud.mesh)})
      json["clouds"].push_back(number);
  for (const Instance& mesh : field.meshes) {
    const Box box = boxOfMesh(mesh);
    Json corners = Json::array();
    for (int i = 0; i < 8 && !box.empty(); ++i) corners.push_back(jsonOf(transformPoint(mesh.to_world, box.corner(i))));
    json["meshes"].push_back({{"part", next_part}, {"corners", std::move(corners)}, {"longest", shortest(longestStretched(mesh))}});
    next_part += 1 + mesh.levels.size();
  }
  return json;
}

// All fields, with meshes of their own that are placed as they are before they are scattered.
Json scatteredJson(const Scenery& scenery) {
  std::vector<Instance> instances;
  Json fields = Json::array();
  size_t next_part = 0;
  for (const DrawnField& field : scenery.fields) {
    fields.push_back(fieldJson(field, scenery.scene.light.extinction.has_value(), next_part));
    instances.insert(instances.end(), field.meshes.begin(), field.meshes.end());
  }
  Meshes meshes = meshesOf(instances, scenery);
  Json json = {{"fields", std::move(fields)}, {"mesh", meshJson(meshes, nullptr)}, {"casters", castersJson(meshes)}};
  json["parts"] = std::move(meshes.parts);
  return json;
}

// How clouds shade each other, and what the grid encloses that the page makes for all clouds or, unless the scene has the grid, for those
// of fields.
Json shadeJson(CloudShade shade, std::vector<Instance> instances) {
  const char* const kinds[]{"none", "each", "grid"};
  Json json = {{"kind", kinds[size_t(shade)]}};
  if (shade != CloudShade::kGrid) std::erase_if(instances, [](const Instance& one) { return !one.scattered; });
  const std::optional<ShadeExtent> extent = shadeExtent(instances);
  if (!extent) return json;
  json["low"] = jsonOf(extent->box.low);
  json["high"] = jsonOf(extent->box.high);
  json["cloud_size"] = shortest(extent->cloud_size);
  json["drifts"] = extent->wind.has_value();
  return json;
}

}  // namespace

LiveScene liveScene(const Scenery& scenery, const std::string& name) {
  const SceneFile& file = scenery.scene;
  refuseWhatIsNotShown(file);
  const SkySettings& sky = file.light.sky;
  const SunTable suns = sunTable(scenery);
  const std::vector<Instance> instances = instancesAt(scenery, file.view);
  Meshes meshes = meshesOf(scenery.instances, scenery);
  if (meshes.triangles.empty() && meshes.impostors.empty() && meshes.sequences.empty() && scenery.fields.empty() && !isLayered(file))
    throw UsageError("view needs a cloud with triangles, or another layer");

  Json scene = {{"name", name}, {"time", file.view.time_seconds}, {"look", lookOfScene(file)}};
  scene["time_offset"] = file.view.time_offset_seconds;
  scene["view"] = {{"sun", {shortest(file.view.sun_azimuth_degrees), shortest(file.view.sun_elevation_degrees)}},
                   {"exposure", shortest(file.view.exposure)}};
  scene["camera"] = cameraJson(cameraFor(file, instances), file.camera_roll_degrees, scene["view"]);
  if (file.view.is_sized && !file.compares_techniques) scene["size"] = {file.view.width, file.view.height};
  const bool has_harmonics =
      std::any_of(instances.begin(), instances.end(), [](const Instance& one) { return !one.mesh->harmonics.empty(); });
  scene["light"] = has_harmonics && !file.light.lobes_only ? "harmonics" : "lobe";
  const DepthRange range = depthRangeOf(file.post, instances);
  scene["depth_range"] = {shortest(range.near), shortest(range.far)};
  const bool has_simple_disc = sky.sun_disc == DiscKind::kSimple;  // the other one has its own glow
  scene["sky"] = {
      {"disc", {shortest(sky.disc.exponent), has_simple_disc ? shortest(sky.disc.gain) : 0, has_simple_disc ? shortest(sky.glow) : 0}},
      {"horizon_exponent", shortest(sky.horizon_exponent)},
      {"horizon_strength", shortest(sky.horizon_strength)},
      {"viewer_height", shortest(sky.viewer_height)}};
  if (sky.horizon_color) scene["sky"]["horizon_color"] = jsonOf(*sky.horizon_color);
  const NoiseFrame frame = noiseFrame(instancesAt(scenery, 0), file.post.painted.detail_size);
  const double share = shortest(file.post.painted.detail_size);
  scene["noise"] = {{"origin", jsonOf(frame.origin)}, {"longest", shortest(frame.size / file.post.painted.detail_size)}, {"share", share}};
  if (scenery.instances.empty() && !scenery.fields.empty()) scene["noise"]["wind"] = jsonOf(scenery.fields.front().settings.drift);
  scene["extinction_times_size"] = shortest(kDefaultExtinctionTimesSize);  // of assets that are dropped on the page
  scene["far_sides"] = shortest(kFarSides);
  scene["distance_fog"] = shortest(file.fog.density);
  const FogScatter& scatter = file.post.composite.scatter;
  scene["fog_scatter"] = {shortest(scatter.strength), shortest(scatter.exponent)};
  // Fog of the horizon's colour follows the sun.
  if (file.fog.color != sky.colors.horizon) scene["fog_color"] = jsonOf(file.fog.color);
  if (!file.lamps.empty() || !file.lightning.empty()) scene["lamps"] = lampsJson(file);
  scene["mesh"] = meshJson(meshes, isLayered(file) ? &file : nullptr);
  scene["casters"] = castersJson(meshes);
  scene["shadows"] = {{"strength", shortest(file.shadows.strength)}, {"softness", shortest(file.shadows.softness_degrees)}};
  scene["shade"] = shadeJson(file.shadows.cloud_shade, instances);
  if (!scenery.fields.empty()) scene["scattered"] = scatteredJson(scenery);
  const bool are_colored = meshes.are_colored || (!scenery.fields.empty() && scene["scattered"]["mesh"]["is_colored"]);
  if (hasMeshClouds(file) || isLayered(file)) scene["keys"] = keysJson(file, has_simple_disc, are_colored);
  if (isLayered(file)) scene["layers"] = layersJson(scenery, suns.heights, suns.scenes);
  for (const DrawnField& field : scenery.fields)
    for (int i = 0; i < 8; ++i) meshes.corners.push_back(jsonOf(boxOf(field).corner(i)));
  scene["parts"] = std::move(meshes.parts);
  scene["corners"] = std::move(meshes.corners);
  return {std::move(scene), looksOf(file, suns)};
}

}  // namespace cloudbake
