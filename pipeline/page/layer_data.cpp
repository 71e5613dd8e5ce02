#include "pipeline/page/layer_data.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/affine.h"
#include "core/error.h"
#include "core/harmonics.h"
#include "core/srgb.h"
#include "pipeline/page/live_layers.h"

namespace cloudbake {

namespace {

using Lattices = std::vector<std::shared_ptr<const HarmonicLattice>>;

// Each lattice once.
Lattices latticesOf(const SceneFile& scene) {
  Lattices all;
  for (const SceneDust& dust : scene.dust)
    if (std::find(all.begin(), all.end(), dust.lattice) == all.end()) all.push_back(dust.lattice);
  return all;
}

// The bytes of a linear picture in sRGB: R, G, B of each pixel.
std::vector<uint8_t> srgbBytes(const Image& picture) {
  std::vector<uint8_t> bytes;
  for (const Vec3 pixel : picture.pixels)
    for (const float channel : {pixel.x, pixel.y, pixel.z})
      bytes.push_back(uint8_t(std::lround(255 * srgbOfLinear(std::clamp(channel, 0.0F, 1.0F)))));
  return bytes;
}

}  // namespace

Image shrunkTo(const Image& picture, int most) {
  const int times = (std::max(picture.width, picture.height) + most - 1) / most;
  if (times <= 1) return picture;
  Image small = blankImage((picture.width + times - 1) / times, (picture.height + times - 1) / times);
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      const int right = std::min(picture.width, (x + 1) * times), bottom = std::min(picture.height, (y + 1) * times);
      Vec3 sum;
      for (int v = y * times; v < bottom; ++v)
        for (int u = x * times; u < right; ++u) sum += picture.at(u, v);
      small.at(x, y) = sum / float((right - x * times) * (bottom - y * times));
    }
  return small;
}

Json packedLayers(const SceneFile& scene, MeshPacker& packer) {
  constexpr int kMostPixels = 512;
  constexpr size_t kMostNumbers = 1 << 22;  // 16 MB of floats
  Json json = {{"lattices", Json::array()}};
  if (scene.light.sky.moon && scene.light.sky.moon->picture) {
    const Image picture = shrunkTo(*scene.light.sky.moon->picture, kMostPixels);
    json["moon_picture"] = {picture.width, picture.height};
    packer.addBytes(srgbBytes(picture));
  }
  size_t numbers = 0;
  for (const auto& lattice : latticesOf(scene)) {
    numbers += lattice->coefficients.size();
    if (numbers > kMostNumbers)
      throw UsageError("view shows dust of smaller lattices only: write them with a smaller --lattice-cells, such as 32");
    json["lattices"].push_back({{"origin", jsonOf(lattice->origin)},
                                {"cell_size", shortest(lattice->cell_size)},
                                {"cells", lattice->cells},
                                {"coefficients", harmonicCount(lattice->order)}});
    packer.addRounded(lattice->coefficients);
  }
  return json;
}

Json dustPlaces(const SceneFile& scene) {
  const Lattices lattices = latticesOf(scene);
  Json all = Json::array();
  for (const SceneDust& dust : scene.dust) {
    const float own = dust.lattice->extinction / unitScale(dust.to_world), world = scene.light.extinction.value_or(own);
    all.push_back({{"lattice", std::find(lattices.begin(), lattices.end(), dust.lattice) - lattices.begin()},
                   {"to_own", affineJson(inverted(dust.to_world).value())},
                   {"extinction", shortest(world / dust.lattice->extinction)}});
  }
  return all;
}

}  // namespace cloudbake
