// A corner at (x, y, z) in the camera's axes about the box's centre is in view from the distance D if
//   |x| ≤ (D + z)·tan_x   and   |y| ≤ (D + z)·tan_y,
// so D is the largest |x|/tan_x − z and |y|/tan_y − z over the eight corners, and never so small that a corner is behind the camera.
#include "preview/camera.h"

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr float kMargin = 0.06F;  // of the picture, left free at each side

// Half the picture's height at distance 1.
float halfHeight(const Camera& camera) { return float(tanDegrees(double(camera.vertical_fov_degrees) / 2)); }

CameraAxes axesAlong(Vec3 forward) {
  // Level: right is in the horizontal plane. Straight up or down it is +X, as after a tilt from azimuth 0 (forward = −Z).
  const auto right = normalized(Vec3{-forward.z, 0, forward.x});
  CameraAxes axes{right.value_or(Vec3{1, 0, 0}), {}, forward};
  axes.up = cross(axes.right, forward);
  return axes;
}

}  // namespace

Vec3 directionFromAngles(float azimuth_degrees, float elevation_degrees) {
  const SinCos elevation = sinCosDegrees(elevation_degrees), azimuth = sinCosDegrees(azimuth_degrees);
  return {float(elevation.cos * azimuth.sin), float(elevation.sin), float(elevation.cos * azimuth.cos)};
}

CameraAxes cameraAxes(const Camera& camera) {
  const CameraAxes level = axesAlong(normalized(camera.look_at - camera.look_from).value_or(Vec3{0, 0, -1}));
  if (camera.roll_radians == 0) return level;
  const SinCos roll = sinCosDegrees(double(camera.roll_radians) * (180 / kPi));
  const auto c = float(roll.cos), s = float(roll.sin);
  return {level.right * c - level.up * s, level.up * c + level.right * s, level.forward};
}

CameraRays::CameraRays(const Camera& camera)
    : look_from_(camera.look_from),
      axes_(cameraAxes(camera)),
      center_x_(0.5F * float(camera.width)),
      center_y_(0.5F * float(camera.height)),
      per_pixel_(2 * halfHeight(camera) / float(camera.height)) {}

Ray CameraRays::at(float x, float y) const {
  const float right = (x - center_x_) * per_pixel_, up = (center_y_ - y) * per_pixel_;
  return {look_from_, *normalized(axes_.forward + axes_.right * right + axes_.up * up)};
}

Ray cameraRay(const Camera& camera, float x, float y) { return CameraRays(camera).at(x, y); }

// Kensler, "Correlated Multi-Jittered Sampling", Pixar 2013, its canonical arrangement.
std::vector<Vec2> pixelPlaces(int samples_per_side) {
  const int n = std::max(1, samples_per_side);
  std::vector<Vec2> places;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column)
      places.push_back(
          {(float(column) + (float(row) + 0.5F) / float(n)) / float(n), (float(row) + (float(column) + 0.5F) / float(n)) / float(n)});
  return places;
}

Camera frameCamera(const Box& box, float azimuth_degrees, float elevation_degrees, float fov_degrees, int width, int height) {
  Camera camera{{}, box.empty() ? Vec3{} : box.center(), fov_degrees, width, height};
  const Vec3 towards_camera = directionFromAngles(azimuth_degrees, elevation_degrees);
  const CameraAxes axes = axesAlong(-towards_camera);
  const float tan_y = halfHeight(camera) * (1 - 2 * kMargin), tan_x = tan_y * float(width) / float(height);

  float distance = 0;
  const Vec3 half = box.size() * 0.5F;
  const float nearest = 0.01F * box.diagonal();
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
    const float x = std::abs(dot(corner, axes.right)), y = std::abs(dot(corner, axes.up)), z = dot(corner, axes.forward);
    distance = std::max({distance, x / tan_x - z, y / tan_y - z, nearest - z});
  }
  if (!(distance > 0)) distance = std::max(1.0F, length(camera.look_at));
  camera.look_from = camera.look_at + towards_camera * distance;
  return camera;
}

}  // namespace cloudbake
