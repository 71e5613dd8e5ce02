#include "preview/mesh_clouds/impostor.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/affine.h"
#include "core/lobe_lighting.h"
#include "core/lobe_packing.h"
#include "core/parallel.h"
#include "preview/backdrop/sky.h"

namespace cloudbake {

namespace {

// The linear filter of a GPU: four texels, clamped at the picture's edges. `u` and `v` are 0 … 1 across the picture.
Vec3 bilinear(const Image& image, float u, float v) {
  const float x = u * float(image.width) - 0.5F, y = v * float(image.height) - 0.5F;
  const float left = std::floor(x), top = std::floor(y), a = x - left, b = y - top;
  const auto at = [&](int dx, int dy) {
    return image.at(std::clamp(int(left) + dx, 0, image.width - 1), std::clamp(int(top) + dy, 0, image.height - 1));
  };
  return (at(0, 0) * (1 - a) + at(1, 0) * a) * (1 - b) + (at(0, 1) * (1 - a) + at(1, 1) * a) * b;
}

}  // namespace

Vec3 filtered(const std::vector<Image>& levels, float u, float v, float level) {
  const float clamped = std::clamp(level, 0.0F, float(levels.size() - 1));
  const auto fine = size_t(clamped);
  const float share = clamped - float(fine);
  const Vec3 value = bilinear(levels[fine], u, v);
  return share > 0 ? value * (1 - share) + bilinear(levels[fine + 1], u, v) * share : value;
}

ImpostorView::ImpostorView(const Impostor& impostor, Vec3 eye)
    : impostor_(impostor), eye_((eye - impostor.info.center) / impostor.info.radius) {
  const auto weights = framesAround(eye_ / length(eye_), impostor.info.views);
  for (size_t f = 0; f < frames_.size(); ++f) {
    const auto& [i, j, weight] = weights[f];
    frames_[f] = {i, j, weight, frameAxes(frameDirection(i, j, impostor.info.views))};
  }
}

void ImpostorView::forFrames(Vec3 direction, float texel_share, FunctionRef<void(const AtlasPlace&)> visit) const {
  const ImpostorInfo& info = impostor_.info;
  const float level = std::log2(std::max(texel_share, 1e-6F)), half_texel = 0.5F / float(info.frame);
  for (const Frame& frame : frames_) {
    const float facing = dot(direction, frame.axes.to_eye), away = dot(eye_, frame.axes.to_eye);
    if (!(frame.weight > 0) || !(facing < 0)) continue;
    const auto placeAt = [&](float height) {  // where the ray is at this height over the frame's plane
      const Vec3 p = eye_ + direction * ((height - away) / facing);
      return Vec2{0.5F + 0.5F * dot(p, frame.axes.right), 0.5F - 0.5F * dot(p, frame.axes.up)};
    };
    const auto inAtlas = [&](float within, int index) {
      return (float(index) + std::clamp(within, half_texel, 1 - half_texel)) / float(info.views);
    };
    const Vec2 flat = placeAt(0);
    const Vec3 first = filtered(impostor_.rest, inAtlas(flat.x, frame.i), inAtlas(flat.y, frame.j), level);
    const Vec2 at = placeAt(1 - 2 * first.z);
    if (at.x < 0 || at.x > 1 || at.y < 0 || at.y > 1) continue;
    const float u = inAtlas(at.x, frame.i), v = inAtlas(at.y, frame.j);
    const Vec3 rest = filtered(impostor_.rest, u, v, level);
    if (rest.y > 0) visit({frame.axes, u, v, level, rest, frame.weight * rest.y, (1 - 2 * rest.z - away) / facing});
  }
}

ImpostorPoint ImpostorView::at(Vec3 direction, float texel_share) const {
  const ImpostorInfo& info = impostor_.info;
  Vec3 sum_direction;
  float opacity = 0, thickness = 0, lit = 0, distance = 0;
  forFrames(direction, texel_share, [&](const AtlasPlace& place) {
    const Vec3 lobe = filtered(impostor_.lobe, place.u, place.v, place.level);
    sum_direction += decodedDirection({lobe.x, lobe.y}, place.axes) * place.weight;
    thickness += lobe.z * lobe.z * info.thickest * place.weight;
    lit += place.rest.x * place.weight;
    distance += place.distance * place.weight;
    opacity += place.weight;
  });
  if (!(opacity > 0)) return {};
  return {{{normalized(sum_direction).value_or(Vec3{0, -1, 0}), thickness / opacity}, lit / opacity},
          opacity,
          distance * info.radius / opacity};
}

Image renderQuad(const Camera& camera, const LightSettings& light, FunctionRef<QuadPoint(Vec3 direction)> at) {
  const SkyColors colors = lightColors(light.sky);
  const CameraRays rays(camera);
  Image image = renderSky(camera, light.sky, light.samples_per_side);
  parallelFor(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const QuadPoint seen = at(rays.at(float(x) + 0.5F, float(y) + 0.5F).direction);
      image.at(x, y) = image.at(x, y) * (1 - seen.opacity) + cloudColor(seen.shade, colors) * seen.opacity;
    }
  });
  return image;
}

Image renderImpostor(const Impostor& impostor, const Camera& camera, const LightSettings& light) {
  const ImpostorInfo& info = impostor.info;
  if (length(camera.look_from - info.center) <= info.radius) return renderSky(camera, light.sky, light.samples_per_side);
  const ImpostorView view(impostor, camera.look_from);
  const float per_pixel = 2 * std::tan(camera.vertical_fov_degrees * float(kPi / 360)) / float(camera.height);
  const float share = length(camera.look_from - info.center) * per_pixel / (2 * info.radius) * float(info.frame);
  const Vec3 sun = keyLight(light.sky).direction;
  return renderQuad(camera, light, [&](Vec3 direction) -> QuadPoint {
    const ImpostorPoint seen = view.at(direction, share);
    const auto from = [&](Vec3 to_light) { return texelLight(seen.texel, to_light, info.exponent, info.extinction); };
    return {{from(sun), from({0, 1, 0})}, seen.opacity};
  });
}

namespace {

// Two colours of a pixel, the nearer one before the other.
Rgba over(const Rgba& a, const Rgba& b) {
  const bool a_is_near = a[3] <= b[3];
  const Rgba &near = a_is_near ? a : b, &far = a_is_near ? b : a;
  const float behind = (1 - near[2]) * far[2], opacity = near[2] + behind;
  if (!(opacity > 0)) return kNoCloud;
  const auto mean = [&](size_t c) { return (near[c] * near[2] + far[c] * behind) / opacity; };
  return {mean(0), mean(1), opacity, mean(3)};
}

void addImpostor(Image4& channels, const Instance& instance, const Camera& camera, const LightSettings& light, const DepthRange& range) {
  const Impostor& impostor = *instance.mesh->impostor;
  const Affine to_own = inverted(instance.to_world).value();
  const Vec3 eye = transformPoint(to_own, camera.look_from);
  if (length(eye - impostor.info.center) <= impostor.info.radius) return;
  const ImpostorView view(impostor, eye);
  const CameraAxes axes = cameraAxes(camera);
  const CameraRays rays(camera);

  // The pixels of the ball's box in the world.
  const float reach = impostor.info.radius;
  int left = camera.width, right = -1, top = camera.height, bottom = -1;
  const float per_pixel = 2 * std::tan(camera.vertical_fov_degrees * float(kPi / 360)) / float(camera.height);
  const Vec3 half{reach, reach, reach};
  const Box ball{impostor.info.center - half, impostor.info.center + half};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 from = transformPoint(instance.to_world, ball.corner(corner)) - camera.look_from;
    const float depth = dot(from, axes.forward) * per_pixel;
    if (!(depth > 0)) {
      left = top = 0, right = camera.width - 1, bottom = camera.height - 1;
      break;
    }
    const float x = float(camera.width) / 2 + dot(from, axes.right) / depth, y = float(camera.height) / 2 - dot(from, axes.up) / depth;
    const auto within = [](float at, int count) { return int(std::clamp(at, -1.0F, float(count))); };
    left = std::min(left, within(x - 1, camera.width)), right = std::max(right, within(x + 1, camera.width));
    top = std::min(top, within(y - 1, camera.height)), bottom = std::max(bottom, within(y + 1, camera.height));
  }
  left = std::max(left, 0), top = std::max(top, 0), right = std::min(right, camera.width - 1), bottom = std::min(bottom, camera.height - 1);

  const float scale = unitScale(instance.to_world), extinction = worldExtinction(instance, light);
  const LobeShape shape{impostor.info.exponent, 0};
  const Vec3 center = transformPoint(instance.to_world, impostor.info.center), to_light = keyLight(light.sky).direction;
  const float step_x = float(camera.width) / float(channels.width), step_y = float(camera.height) / float(channels.height);
  const float texel_share = length(center - camera.look_from) * per_pixel * step_y / (2 * reach * scale) * float(impostor.info.frame);
  const float gain = impostor.info.gains ? light.volume_gain : 1;
  const float share = instance.sun_shares.empty() ? 1
                                                  : std::accumulate(instance.sun_shares.begin(), instance.sun_shares.end(), 0.0F) /
                                                        float(instance.sun_shares.size());
  left = int(float(left) / step_x), right = std::min(int(float(right) / step_x), channels.width - 1);
  top = int(float(top) / step_y), bottom = std::min(int(float(bottom) / step_y), channels.height - 1);
  // An impostor has no colour of its own, and lamps do not shine on it.
  const auto fieldsOf = [&](const TexelLobe& texel) -> std::array<float, 2> {
    if (light.shown == ShownLight::kOwnRedGreen) return {1, 1};
    if (light.shown == ShownLight::kOwnBlue) return {1, 0};
    if (light.shown != ShownLight::kSunAndSky) return {0, 0};
    const auto lightFrom = [&](Vec3 from) { return texel.lit * lobeTransmittance(texel.lobe, from, shape, extinction); };
    return {std::min(gain * lightFrom(to_light), 1.0F) * share, lightFrom({0, 1, 0})};
  };
  parallelFor(top, bottom + 1, [&](int y) {
    for (int x = left; x <= right; ++x) {
      const Vec3 direction = rays.at((float(x) + 0.5F) * step_x, (float(y) + 0.5F) * step_y).direction;
      const ImpostorPoint seen = view.at(transformVector(to_own, direction), texel_share);
      if (!(seen.opacity > 0)) continue;
      const auto [red, green] = fieldsOf({mappedLobe(seen.texel.lobe, instance.to_world), seen.texel.lit});
      const float depth = (dot(direction, axes.forward) * seen.distance - range.near) / (range.far - range.near);
      Rgba& pixel = channels.at(x, y);
      pixel = over(pixel, {red, green, seen.opacity, std::max(0.0F, depth)});
    }
  });
}

}  // namespace

void addImpostors(Image4& channels, std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                  const DepthRange& range) {
  std::vector<std::pair<float, const Instance*>> placed;  // by the distance of the center
  for (const Instance& instance : instances)
    if (instance.is_seen && instance.mesh->impostor)
      placed.emplace_back(length(transformPoint(instance.to_world, instance.mesh->impostor->info.center) - camera.look_from), &instance);
  std::stable_sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [distance, instance] : placed) addImpostor(channels, *instance, camera, light, range);
}

}  // namespace cloudbake
