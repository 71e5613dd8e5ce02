// The shadow is that of preview/mesh_clouds/cloud_shadow.h far behind the cloud, where all of the way through it counts, under a light
// without an extent.
#include "pipeline/picture/shadow_picture.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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
  picture.transmittance.resize(size_t(size) * size_t(size));
  parallelFor(size, [&](int row) {
    for (int column = 0; column < size; ++column) {
      float sum = 0;
      for (int j = 0; j < kPlaces; ++j)
        for (int i = 0; i < kPlaces; ++i) {
          const float x = (float(column) + (float(i) + 0.5F) / kPlaces) / float(size) - 0.5F;
          const float y = 0.5F - (float(row) + (float(j) + 0.5F) / kPlaces) / float(size);
          sum += shadow.shareAt(behind + frame.right * (x * frame.width) + frame.up * (y * frame.height));
        }
      picture.transmittance[size_t(row) * size_t(size) + size_t(column)] = sum / (kPlaces * kPlaces);
    }
  });
  return picture;
}

ShadowPicture drawShadow(const BakedMesh& mesh, const Settings& settings) {
  const Vec3 to_sun = directionFromAngles(settings.picture.sun_azimuth_degrees, settings.picture.sun_elevation_degrees);
  return drawShadow(mesh, to_sun, settings.shadow.size, settings.shadow.extinction, settings.picture.memory_limit);
}

ShadowFiles encodeShadow(const ShadowPicture& picture) {
  const ShadowFrame& frame = picture.frame;
  const Json json = {{"schema", "cloudbake-shadow-1"},
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
  std::vector<uint8_t> grey;
  for (const float share : picture.transmittance) grey.push_back(uint8_t(std::lround(255 * std::clamp(share, 0.0F, 1.0F))));
  return {encodeGreyPng(picture.size, picture.size, grey, kShadowKeyword, json.dump()), json.dump(2) + "\n"};
}

std::filesystem::path shadowFrameFile(const std::filesystem::path& picture) {
  return std::filesystem::path(picture).replace_extension(".json");
}

}  // namespace cloudbake
