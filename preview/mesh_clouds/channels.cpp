// "Volumetric Clouds and Mega-Particles", its first step, on the fields of "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves:
//   R = T_lobe(sun) · half-Lambert    G = T_lobe(+Y)    B = covered    A = max(0, (z − near)/(far − near))
// of the nearest surface, with z along the view, drawn into an image that is cleared to (0, 0, 0, 1).
#include "preview/mesh_clouds/channels.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include "core/parallel.h"
#include "preview/shading_math.h"

namespace cloudbake {

PixelBox cloudBox(const Image4& channels, float margin) {
  PixelBox box{channels.width, channels.height, 0, 0};
  for (int y = 0; y < channels.height; ++y) {
    const Rgba *row = &channels.at(0, y), *end = row + channels.width;
    const auto is_cloud = [](const Rgba& p) { return p != kNoCloud; };
    const Rgba* first = std::find_if(row, end, is_cloud);
    if (first == end) continue;
    const auto last = std::find_if(std::reverse_iterator(end), std::reverse_iterator(first), is_cloud);
    box.left = std::min(box.left, int(first - row)), box.right = std::max(box.right, int(last.base() - row));
    box.top = std::min(box.top, y), box.bottom = y + 1;
  }
  if (box.right == 0) return {};
  const int more = int(std::min(std::ceil(margin), float(channels.width + channels.height)));
  return {std::max(0, box.left - more), std::max(0, box.top - more), std::min(channels.width, box.right + more),
          std::min(channels.height, box.bottom + more)};
}

float meanLongestSide(std::span<const Instance> instances) {
  std::vector<std::optional<float>> sides(instances.size());
  parallelFor(instances.size(), [&](size_t i) {
    const Instance& instance = instances[i];
    if (instance.scattered) {
      sides[i] = instance.scattered->longest_side;
      return;
    }
    const Box box = instance.whole ? placedBox(instance)
                                   : drawnBox((instance.sized_as ? instance.sized_as : instance.mesh)->surface, instance.to_world);
    if (!box.empty()) sides[i] = box.longestSide();
  });
  float sum = 0;
  int count = 0;
  for (const std::optional<float>& side : sides)
    if (side) sum += *side, ++count;
  return sum > 0 ? sum / float(count) : 1;
}

DepthRange defaultDepthRange(std::span<const Instance> instances) { return {0, kFarSides * meanLongestSide(instances)}; }

Image4 renderChannels(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                      const ChannelSettings& settings) {
  LitMesh lit = lightMeshes(instances, light);
  prepareForRays(lit, light.rays);
  const DepthRange range = settings.depth_range.value_or(defaultDepthRange(instances));
  Camera local = camera;
  local.look_from = lit.toFrame(camera.look_from);
  local.look_at = lit.toFrame(camera.look_at);
  const Vec3 forward = cameraAxes(camera).forward;
  const std::vector<Vec2> places = pixelPlaces(settings.samples_per_side);

  // Rays are in the pixel coordinates of the whole picture.
  const int width = (camera.width + settings.divisor - 1) / settings.divisor,
            height = (camera.height + settings.divisor - 1) / settings.divisor;
  const float step_x = float(camera.width) / float(width), step_y = float(camera.height) / float(height);
  Image4 image = filledImage4(width, height, kNoCloud);
  const CameraRays rays(local);
  parallelFor(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      ChannelSum sum(ChannelMean::kCovered);
      for (const Vec2 place : places) {
        const Ray ray = rays.at((float(x) + place.x) * step_x, (float(y) + place.y) * step_y);
        const auto hit = nearestCrossing(lit, ray);
        const float z = hit ? hit->t * lit.size * dot(ray.direction, forward) : 0;
        sum.add(hit ? Rgba{hit->shade.sun, hit->shade.sky, 1, std::max(0.0F, (z - range.near) / (range.far - range.near))} : kNoCloud, 1);
      }
      image.at(x, y) = sum.value();
    }
  });
  return image;
}

Image channelPicture(const Image4& channels, int channel) {
  Image picture = blankImage(channels.width, channels.height);
  for (size_t i = 0; i < picture.pixels.size(); ++i) picture.pixels[i] = Vec3{1, 1, 1} * channels.pixels[i][size_t(channel)];
  return picture;
}

// --- Keys ---

const Keys<ChannelSettings>& channelKeys() {
  using S = ChannelSettings;
  static const Keys<S> keys{
      {"draw_divisor", &S::divisor, 1, 64, "clouds are drawn at this fraction of the picture's resolution", KeyUse::kScript},
      {"samples_per_side", &S::samples_per_side, 1, 16, "n·n rays per pixel", KeyUse::kScript, "the page has their places"},
  };
  return keys;
}

}  // namespace cloudbake
