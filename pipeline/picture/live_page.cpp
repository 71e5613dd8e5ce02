// All settings and constants go into the page as JSON, from the structs that `preview` uses; vertices and triangles follow as base64.
#include "pipeline/picture/live_page.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text/base64.h"
#include "core/text/markup.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

namespace {

constexpr size_t kShortIndices = 1 << 16;  // so many vertices have indices of two bytes
constexpr int kSunHeights = 161;           // of the table of colours; the hours of skyColorsForSun are among them

Json jsonOf(Vec3 v) { return {shortest(v.x), shortest(v.y), shortest(v.z)}; }

Json jsonOf(const std::vector<Vec2>& places) {
  Json json = Json::array();
  for (const Vec2 p : places) json.push_back({shortest(p.x), shortest(p.y)});
  return json;
}

void refuseWhatIsNotShown(const SceneFile& scene) {
  const SkySettings& sky = scene.light.sky;
  const bool shown = !scene.terrain && scene.slabs.empty() && scene.distance_clouds.empty() && scene.density_clouds.empty() &&
                     !scene.post.published && !scene.view.plain && !sky.moon && sky.sun_disc == SunDisc::kSimple &&
                     !scene.grade.sqrt_gamma && !scene.grade.vignette && !scene.grade.contrast && !scene.compares_techniques;
  if (!shown)
    throw UsageError(
        "view shows mesh clouds and their sky in the painted look: leave out terrain, slabs, marched clouds, moon, smooth "
        "disc, grade and as_published");
}

// The colours by the sun's height, from −1 to 1. Those that the scene sets are the same at every height.
Json colorTable(const SceneFile& scene) {
  const std::pair<const char*, Vec3 SkyColors::*> names[] = {
      {"zenith", &SkyColors::zenith},       {"horizon", &SkyColors::horizon},         {"ground", &SkyColors::ground},
      {"sun_color", &SkyColors::sun_color}, {"ambient_sky", &SkyColors::ambient_sky}, {"ambient_ground", &SkyColors::ambient_ground}};
  const SkySettings& sky = scene.light.sky;
  const SkyColors of_hour = skyColorsFor(scene.post, sky.to_sun.y);
  Json table = {{"names", Json::array()}, {"rows", Json::array()}};
  for (const auto& [name, color] : names) table["names"].push_back(name);
  for (int i = 0; i < kSunHeights; ++i) {
    const SkyColors colors = skyColorsFor(scene.post, 2 * float(i) / (kSunHeights - 1) - 1);
    Json row = Json::array();
    for (const auto& [name, color] : names) row.push_back(jsonOf(sky.colors.*color == of_hour.*color ? colors.*color : sky.colors.*color));
    table["rows"].push_back(std::move(row));
  }
  return table;
}

// Where the camera is, as the page turns it: about its target.
Json cameraJson(const Camera& camera, Json& view) {
  const Vec3 arm = camera.look_from - camera.look_at;
  const float distance = length(arm);
  view["azimuth"] = std::atan2(arm.x, arm.z) * 180 / kPi;
  view["elevation"] = std::asin(std::clamp(double(arm.y / distance), -1.0, 1.0)) * 180 / kPi;
  view["zoom"] = 1;
  view["shift"] = {0, 0, 0};
  return {{"at", jsonOf(camera.look_at)}, {"distance", shortest(distance)}, {"fov", shortest(camera.vertical_fov_degrees)}};
}

// Vertices and triangles of all clouds, one array after the other, and what belongs to each cloud.
struct Meshes {
  std::vector<float> positions, normals, lobes;
  std::vector<uint32_t> triangles;
  Json parts = Json::array(), corners = Json::array();
};

Meshes meshesOf(const Scenery& scenery) {
  Meshes all;
  for (const Instance& instance : scenery.instances) {
    const PlacedMesh placed = placedMesh(instance);
    const auto first = uint32_t(all.positions.size() / 3);
    all.parts.push_back({{"first", all.triangles.size()},
                         {"count", 3 * placed.triangles.size()},
                         {"shape", {shortest(placed.shape.exponent), shortest(placed.shape.bias)}},
                         {"extinction", shortest(placed.extinction)}});
    for (const Vec3& p : placed.positions) all.positions.insert(all.positions.end(), {p.x, p.y, p.z});
    for (const Vec3& n : placed.normals) all.normals.insert(all.normals.end(), {n.x, n.y, n.z});
    for (const Lobe& lobe : placed.lobes)
      all.lobes.insert(all.lobes.end(), {lobe.direction.x, lobe.direction.y, lobe.direction.z, lobe.thickness});
    for (const Triangle& t : placed.triangles)
      for (const uint32_t v : t) all.triangles.push_back(first + v);
    const Box box = drawnBox(instance.mesh->surface);
    for (int i = 0; i < 8 && !box.empty(); ++i) all.corners.push_back(jsonOf(transformPoint(instance.to_world, box.corner(i))));
  }
  return all;
}

template <typename Value>
void appendBytes(std::string& bytes, const std::vector<Value>& values) {
  const size_t size = bytes.size(), more = values.size() * sizeof(Value);
  bytes.resize(size + more);
  if (more > 0) std::memcpy(&bytes[size], values.data(), more);
}

std::string script(const std::string& attributes, const std::string& text) { return "<script" + attributes + ">" + text + "</script>\n"; }

void replaceAll(std::string& text, const std::string& word, const std::string& by) {
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + by.size())) text.replace(at, word.size(), by);
}

}  // namespace

std::string livePage(const Scenery& scenery, const std::string& name) {
  const SceneFile& scene = scenery.scene;
  refuseWhatIsNotShown(scene);
  const SkySettings& sky = scene.light.sky;
  const PostSettings& post = scene.post;
  const PaintedSteps& painted = post.painted;
  const DistortSettings& distort = post.distort;
  const CompositeSettings& composite = post.composite;
  Meshes meshes = meshesOf(scenery);
  if (meshes.triangles.empty()) throw UsageError("view needs a cloud with triangles");

  Json page = {{"name", name}, {"time", scene.view.time_seconds}, {"half_lambert", shortest(scene.light.half_lambert)}};
  page["view"] = {{"sun", {shortest(scene.view.sun_azimuth_degrees), shortest(scene.view.sun_elevation_degrees)}},
                  {"exposure", shortest(scene.view.exposure)}};
  page["camera"] = cameraJson(cameraFor(scenery, scene.view, 0), page["view"]);
  page["view"]["density"] = 1;
  page["view"]["k"] = meshes.parts[0]["shape"][0];
  page["mesh"] = {{"vertices", meshes.positions.size() / 3},
                  {"indices", meshes.triangles.size()},
                  {"short", meshes.positions.size() / 3 <= kShortIndices}};
  page["parts"] = std::move(meshes.parts);
  page["corners"] = std::move(meshes.corners);
  if (post.depth_range) page["depth_range"] = {shortest(post.depth_range->near), shortest(post.depth_range->far)};
  page["samples"] = jsonOf(pixelPlaces(4));  // those of rasterChannels
  page["sky_places"] = jsonOf(pixelPlaces(PostSettings().sky_samples_per_side));
  page["sky"] = {{"disc", {shortest(sky.disc.exponent), shortest(sky.disc.gain), shortest(sky.glow)}},
                 {"horizon_exponent", shortest(sky.horizon_exponent)},
                 {"viewer_height", shortest(sky.viewer_height)}};
  page["colors"] = colorTable(scene);
  page["depth_spread"] = shortest(painted.depth_spread);
  page["soften"] = {{"near_width", shortest(painted.soften.near_width)}, {"far_width", shortest(painted.soften.far_width)}};
  page["distort"] = {{"tile_size", shortest(distort.tile_size)},
                     {"far_tiles", shortest(distort.far_tiles)},
                     {"swirl_strength", shortest(distort.swirl_strength)},
                     {"far_strength", shortest(distort.far_strength)},
                     {"swirl_speed", shortest(distort.swirl_speed)},
                     {"seed", distort.seed},
                     {"octaves", kSwirlNoise.octaves},
                     {"gain", shortest(kSwirlNoise.gain)},
                     {"cells", kSwirlNoise.period},
                     {"typical_slope", shortest(kTypicalSlope)}};
  const NoiseFrame frame = noiseFrame(scenery.instances, painted.detail_size);
  page["erode"] = {{"noise_origin", jsonOf(frame.origin)},
                   {"noise_size", shortest(frame.size)},
                   {"shrink", shortest(painted.erode.shrink)},
                   {"darkening", shortest(painted.erode.darkening)},
                   {"seed", painted.erode.seed},
                   {"fading", {shortest(kFadingFrom), shortest(kFadingTo)}},
                   {"octaves", kErosionNoise.octaves},
                   {"gain", shortest(kErosionNoise.gain)}};
  const PhaseSettings& phase = composite.phase;
  // Fog of the horizon's colour follows the sun.
  if (scene.fog.density > 0 && scene.fog.color != sky.colors.horizon) page["fog_color"] = jsonOf(scene.fog.color);
  page["composite"] = {{"fog_density", shortest(composite.fog_density)},
                       {"distance_fog", shortest(scene.fog.density)},
                       {"phase", {shortest(phase.share), shortest(phase.asymmetry), shortest(phase.limit)}}};

  std::string bytes, scripts;
  appendBytes(bytes, meshes.positions);
  appendBytes(bytes, meshes.normals);
  appendBytes(bytes, meshes.lobes);
  if (meshes.positions.size() / 3 <= kShortIndices)
    appendBytes(bytes, std::vector<uint16_t>(meshes.triangles.begin(), meshes.triangles.end()));
  else
    appendBytes(bytes, meshes.triangles);
  std::string json = page.dump();
  replaceAll(json, "<", "\\u003c");  // a name must not end the script
  scripts += script(" type=\"application/json\" id=\"page\"", json);
  scripts += script(" type=\"text/plain\" id=\"mesh\"", encodeBase64(bytes));
  std::string html, code;
  for (const ViewerFile& file : viewerFiles()) {
    const std::string file_name = file.name;
    if (file_name == "page.html") {
      html = file.text;
    } else if (file_name.ends_with(".js")) {
      code += file.text;
    } else {
      scripts += script(" type=\"x-shader/x-fragment\" id=\"shader " + file_name + "\"", file.text);
    }
  }
  scripts += script("", code);
  replaceAll(html, "@NAME@", escapedMarkup(name));
  html.replace(html.find("@SCRIPTS@"), std::strlen("@SCRIPTS@"), scripts);
  return html;
}

}  // namespace cloudbake
