// The shadow is that of preview/mesh_clouds/cloud_shadow.h far behind the cloud, where all of the way through it counts, under a light
// without an extent.
#include "pipeline/picture/shadow_picture.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "core/text/maker.h"
#include "io/gltf/asset_info.h"
#include "io/image/image.h"
#include "pipeline/picture/scene_shadows.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {

namespace {

constexpr int kPlaces = 4;  // to a side of a pixel

// The points that triangles use.
std::vector<Vec3> drawnPoints(const SurfaceMesh& surface) {
  std::vector<Vec3> points;
  for (const Triangle& triangle : surface.triangles)
    for (const uint32_t v : triangle) points.push_back(surface.positions[v]);
  return points;
}

// The means over pixels of the shares that pass to the plane of the frame through `middle`. Nothing is in the way of an empty passage.
void fillPicture(ShadowPicture& picture, Vec3 middle, const LightPassage& passage) {
  const ShadowFrame& frame = picture.frame;
  const auto size = size_t(picture.size);
  picture.transmittance.resize(size * size);
  parallelFor(size, [&](size_t row) {
    std::vector<Vec3> points;
    for (size_t column = 0; column < size; ++column)
      for (int j = 0; j < kPlaces; ++j)
        for (int i = 0; i < kPlaces; ++i) {
          const float x = (float(column) + (float(i) + 0.5F) / kPlaces) / float(size) - 0.5F;
          const float y = 0.5F - (float(row) + (float(j) + 0.5F) / kPlaces) / float(size);
          points.push_back(middle + frame.right * (x * frame.width) + frame.up * (y * frame.height));
        }
    std::vector<float> shares(points.size(), 1);
    if (passage) passage(points, shares);
    for (size_t column = 0; column < size; ++column) {
      constexpr size_t kAll = size_t(kPlaces) * kPlaces;
      float sum = 0;
      for (size_t i = 0; i < kAll; ++i) sum += shares[column * kAll + i];
      picture.transmittance[row * size + column] = sum / kAll;
    }
  });
}

Json numbersOf(Vec3 v) { return {shortest(v.x), shortest(v.y), shortest(v.z)}; }

}  // namespace

ShadowPicture drawShadow(const BakedMesh& mesh, Vec3 to_sun, int size, std::optional<float> extinction, uint64_t memory_limit) {
  ShadowPicture picture;
  picture.size = size;
  Instance instance;
  instance.mesh = &mesh;
  LightSettings light;
  light.extinction = extinction;
  picture.extinction = worldExtinction(instance, light);
  ShadowFrame& frame = picture.frame;
  frame = shadowFrame(drawnPoints(mesh.surface), to_sun);

  // The cells are about as small as the shorter sides of the pixels.
  constexpr float kFewestVoxels = 32, kMostVoxels = 512;
  const float per_side = std::min(frame.width, frame.height) / float(size), longest = drawnBox(mesh.surface).longestSide();
  const float voxels = per_side > 0 ? std::clamp(longest / per_side, kFewestVoxels, kMostVoxels) : kFewestVoxels;
  const ShadowCaster caster = shadowCasterOf(mesh, int(voxels), memory_limit);

  // A cell of the field reaches beyond the mesh, and two pixels are left clear on each side.
  const float margin = 2 * caster.cell_size, clear = float(size) / float(size - 4);
  frame.width = (frame.width + 2 * margin) * clear, frame.height = (frame.height + 2 * margin) * clear;

  const CloudShadow shadow(caster, Affine{}, picture.extinction, to_sun, {.softness_degrees = 0});
  const Vec3 behind = frame.origin - to_sun * (4 * (frame.top - frame.bottom) + 4 * caster.cell_size);
  fillPicture(picture, behind, [&](std::span<const Vec3> points, std::span<float> shares) {
    for (size_t i = 0; i < points.size(); ++i) shares[i] = shadow.shareAt(points[i]);
  });
  return picture;
}

ShadowPicture drawShadow(const BakedMesh& mesh, const Settings& settings) {
  const Vec3 to_sun = directionFromAngles(settings.picture.sun_azimuth_degrees, settings.picture.sun_elevation_degrees);
  return drawShadow(mesh, to_sun, settings.shadow.size, settings.shadow.extinction, settings.picture.memory_limit);
}

ShadowPicture drawShadow(const Scenery& scenery, const ShadowPictureSettings& settings) {
  const std::vector<Instance> instances = instancesAt(scenery, scenery.scene.view);
  std::vector<Vec3> corners;
  for (const Instance& instance : instances) {
    if (!instance.caster) continue;
    const Box box = placedBox(instance);
    const float more = 2 * float(kShadeCoarser) / kCasterVoxels;  // the field of a caster reaches beyond its mesh
    for (int i = 0; i < 8 && !box.empty(); ++i) corners.push_back(box.center() + (box.corner(i) - box.center()) * (1 + 2 * more));
  }
  if (corners.empty())
    throw InputError(
        "", 0,
        "no cloud casts a shadow: a scene needs two mesh clouds, a field, or a ground below its cloud, and [light] shadows; of one "
        "cloud give its file");
  ShadowPicture picture;
  picture.size = settings.size;
  const Vec3 to_sun = keyLight(scenery.scene.light.sky).direction;
  ShadowFrame& frame = picture.frame;
  frame = shadowFrame(corners, to_sun);
  const float clear = float(picture.size) / float(picture.size - 4);
  frame.width *= clear, frame.height *= clear;

  SceneFile scene = scenery.scene;
  scene.terrain.reset(), scene.slabs.clear(), scene.distance_clouds.clear(), scene.density_clouds.clear();
  scene.terrain.emplace();  // what is below, so that all clouds cast a shadow
  scene.shadows.softness_degrees = 0;
  const SceneShadows shadows(scene, instances);
  const LightPassage passage = shadows.past(SceneShadows::Kind::kTerrain);
  const Vec3 behind = frame.origin - to_sun * (2 * (frame.top - frame.bottom));
  fillPicture(picture, behind, passage);
  return picture;
}

ShadowFiles encodeShadow(const ShadowPicture& picture) {
  const ShadowFrame& frame = picture.frame;
  Json json = {{"schema", "cloudbake-shadow-1"},
               {"generator", kMaker},
               {"origin", numbersOf(frame.origin)},
               {"right", numbersOf(frame.right)},
               {"up", numbersOf(frame.up)},
               {"to_sun", numbersOf(frame.to_sun)},
               {"width", shortest(frame.width)},
               {"height", shortest(frame.height)},
               {"top", shortest(frame.top)},
               {"bottom", shortest(frame.bottom)},
               {"sigma", shortest(picture.extinction)}};
  if (!(picture.extinction > 0)) json.erase("sigma");  // each cloud has its own
  std::vector<uint8_t> grey;
  for (const float share : picture.transmittance) grey.push_back(uint8_t(std::lround(255 * std::clamp(share, 0.0F, 1.0F))));
  return {encodeGreyPng(picture.size, picture.size, grey, kShadowKeyword, json.dump()), json.dump(2) + "\n"};
}

std::filesystem::path shadowFrameFile(const std::filesystem::path& picture) {
  return std::filesystem::path(picture).replace_extension(".json");
}

}  // namespace cloudbake
