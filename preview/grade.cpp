// The image pass of I. Quilez, "Elevated" (Shadertoy MdX3Rr), from a reading of its code:
//   blur      mean of 32 pictures along the pixel's velocity v, |v| ≤ 0.25 per component
//   vignette  0.5 + 0.5 (16 u v (1 − u)(1 − v))^0.1
//   contrast  0.6 c + 0.4 c²(3 − 2c) + (0, 0, 0.04)
// A point P is seen from a camera with axes right, up, forward at ((P − from)·right, (P − from)·up)/((P − from)·forward), in units of which
// the picture's half height is the tangent of half the field of view. The present and the former place are computed by one function, so
// that they are equal to the last bit without motion.
#include "preview/grade.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/parallel.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

/// The values of a camera that a projection needs, computed once.
struct Projection {
  explicit Projection(const Camera& camera)
      : axes(cameraAxes(camera)),
        per_height(0.5 / std::tan(double(camera.vertical_fov_degrees) * kPi / 360)),
        aspect(double(camera.width) / camera.height) {}

  // Place on the picture of a point along `offset`, in widths and heights from the picture's centre; none if it is behind the camera.
  std::optional<std::array<double, 2>> place(const std::array<double, 3>& offset) const {
    const auto along = [&offset](Vec3 axis) { return offset[0] * axis.x + offset[1] * axis.y + offset[2] * axis.z; };
    const double depth = along(axes.forward);
    if (!(depth > 0)) return std::nullopt;
    return std::array<double, 2>{along(axes.right) / depth * per_height / aspect, -along(axes.up) / depth * per_height};
  }

  CameraAxes axes;
  double per_height, aspect;
};

// The vector from a camera to the point at a distance along a ray of the present camera; at infinity only its direction.
std::array<double, 3> offsetFrom(Vec3 camera, const Ray& ray, float distance) {
  const auto one = [distance](float from, float to, float direction) {
    return std::isinf(distance) ? double(direction) : double(to) - from + double(direction) * distance;
  };
  return {one(camera.x, ray.origin.x, ray.direction.x), one(camera.y, ray.origin.y, ray.direction.y),
          one(camera.z, ray.origin.z, ray.direction.z)};
}

Vec3 bilinear(const Image& image, float x, float y) {
  const float px = std::clamp(x - 0.5F, 0.0F, float(image.width - 1)), py = std::clamp(y - 0.5F, 0.0F, float(image.height - 1));
  const int x0 = int(px), y0 = int(py), x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  const Vec3 top = lerp(image.at(x0, y0), image.at(x1, y0), px - float(x0));
  return lerp(top, lerp(image.at(x0, y1), image.at(x1, y1), px - float(x0)), py - float(y0));
}

// The picture that `color(x, y)` gives.
template <typename Color>
Image eachPixel(const Image& image, const Color& color) {
  Image result = image;
  parallelFor(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) result.at(x, y) = color(x, y);
  });
  return result;
}

}  // namespace

Velocities cameraVelocity(const Camera& camera, const Camera& previous, std::span<const float> distances) {
  const int width = camera.width, height = camera.height;
  if (distances.size() != size_t(width) * size_t(height)) throw std::invalid_argument("cameraVelocity: not one distance per pixel");
  if (previous.width != width || previous.height != height) throw std::invalid_argument("cameraVelocity: cameras of two sizes");
  const Projection now(camera), before(previous);
  const CameraRays rays(camera);
  Velocities velocities{width, height, std::vector<Vec2>(distances.size())};
  parallelFor(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = size_t(y) * size_t(width) + size_t(x);
      const Ray ray = rays.at(float(x) + 0.5F, float(y) + 0.5F);
      const auto to = now.place(offsetFrom(camera.look_from, ray, distances[i]));
      const auto from = before.place(offsetFrom(previous.look_from, ray, distances[i]));
      if (to && from) velocities.pixels[i] = {float((*to)[0] - (*from)[0]), float((*to)[1] - (*from)[1])};
    }
  });
  return velocities;
}

Image motionBlur(const Image& image, const Velocities& velocities, const MotionBlurSettings& settings) {
  if (velocities.width != image.width || velocities.height != image.height || velocities.pixels.size() != image.pixels.size())
    throw std::invalid_argument("motionBlur: velocities of another size");
  return eachPixel(image, [&](int x, int y) {
    const Vec2 velocity = velocities.pixels[size_t(y) * size_t(image.width) + size_t(x)];
    if (velocity == Vec2{} || settings.taps < 2) return image.at(x, y);
    const float dx = std::clamp(velocity.x, -settings.limit, settings.limit) * float(image.width);
    const float dy = std::clamp(velocity.y, -settings.limit, settings.limit) * float(image.height);
    Vec3 sum;
    for (int i = 0; i < settings.taps; ++i) {
      const float part = float(i) / float(settings.taps - 1);
      sum += bilinear(image, float(x) + 0.5F - dx * part, float(y) + 0.5F - dy * part);
    }
    return sum / float(settings.taps);
  });
}

float vignetteFactor(float u, float v, const VignetteSettings& settings) {
  const float inside = std::max(0.0F, 16 * u * v * (1 - u) * (1 - v));
  return settings.corner + (1 - settings.corner) * std::pow(inside, settings.exponent);
}

Image vignette(const Image& image, const VignetteSettings& settings) {
  return eachPixel(image, [&](int x, int y) {
    return image.at(x, y) * vignetteFactor((float(x) + 0.5F) / float(image.width), (float(y) + 0.5F) / float(image.height), settings);
  });
}

Vec3 contrastColor(Vec3 color, const ContrastSettings& settings) {
  const auto curve = [&settings](float value) { return lerp(saturate(value), smoothStep(0, 1, value), settings.amount); };
  return Vec3{curve(color.x), curve(color.y), curve(color.z)} + settings.lift;
}

Image contrast(const Image& image, const ContrastSettings& settings) {
  return eachPixel(image, [&](int x, int y) { return contrastColor(image.at(x, y), settings); });
}

Image gammaBySqrt(const Image& image) {
  const auto root = [](float value) { return std::sqrt(std::max(0.0F, value)); };
  return eachPixel(image, [&](int x, int y) {
    const Vec3 color = image.at(x, y);
    return Vec3{root(color.x), root(color.y), root(color.z)};
  });
}

// --- Keys ---

const Keys<MotionBlurSettings>& motionBlurKeys() {
  using S = MotionBlurSettings;
  static const Keys<S> keys{
      {"motion_taps", &S::taps, 1, 1024, "samples of the motion blur"},
      {"motion_limit", &S::limit, 0, 10, "largest velocity of the motion blur, in pictures"},
      {"shutter", &S::shutter_seconds, 0, 1e3, "seconds that the shutter is open", KeyUse::kScript},
  };
  return keys;
}

const Keys<VignetteSettings>& vignetteKeys() {
  using S = VignetteSettings;
  static const Keys<S> keys{
      {"vignette", &S::corner, 0, 1, "factor in the corners"},
      {"vignette_exponent", &S::exponent, 1e-3, 100, "0.1 of the vignette 0.5 + 0.5·(16 u v (1 − u)(1 − v))^0.1"},
  };
  return keys;
}

const Keys<ContrastSettings>& contrastKeys() {
  using S = ContrastSettings;
  static const Keys<S> keys{
      {"contrast", &S::amount, 0, 1, "0.4 of 0.6 c + 0.4 c²(3 − 2c)"},
      {"lift", &S::lift, -1, 1, "added last"},
  };
  return keys;
}

}  // namespace cloudbake
