// A pinhole camera that is turned about its line of sight.
#pragma once

#include <cmath>

#include "preview/camera.h"

namespace cloudbake {

/// A level camera and its roll, which Camera does not have. A plain Camera converts to one without roll.
struct RolledCamera {
  RolledCamera() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a Camera is accepted wherever a RolledCamera is
  RolledCamera(const Camera& level, float roll = 0) : camera(level), roll_radians(roll) {}

  Camera camera;
  float roll_radians = 0;  ///< positive: the camera's top leans to its right, so that the picture's horizon rises on the right
};

/// The level axes turned: right' = right·cos − up·sin, up' = up·cos + right·sin, forward' = forward.
inline CameraAxes cameraAxes(const RolledCamera& rolled) {
  const CameraAxes level = cameraAxes(rolled.camera);
  const float c = std::cos(rolled.roll_radians), s = std::sin(rolled.roll_radians);
  return {level.right * c - level.up * s, level.up * c + level.right * s, level.forward};
}

/// The ray through a point of the picture, as cameraRay of a Camera; the same bits if the roll is 0.
inline Ray cameraRay(const RolledCamera& rolled, float x, float y) {
  if (rolled.roll_radians == 0) return cameraRay(rolled.camera, x, y);
  const float c = std::cos(rolled.roll_radians), s = std::sin(rolled.roll_radians);
  const float center_x = 0.5F * float(rolled.camera.width), center_y = 0.5F * float(rolled.camera.height);
  const float dx = x - center_x, dy = y - center_y;
  return cameraRay(rolled.camera, center_x + dx * c - dy * s, center_y + dx * s + dy * c);
}

}  // namespace cloudbake
