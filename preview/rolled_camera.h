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

/// The rays of a picture, with what does not depend on the pixel computed once. The same bits as those of a Camera if the roll is 0.
class RolledRays {
 public:
  explicit RolledRays(const RolledCamera& rolled)
      : level_(rolled.camera),
        center_x_(0.5F * float(rolled.camera.width)),
        center_y_(0.5F * float(rolled.camera.height)),
        cosine_(std::cos(rolled.roll_radians)),
        sine_(std::sin(rolled.roll_radians)),
        rolled_(rolled.roll_radians != 0) {}

  /// Through a point of the picture, as CameraRays::at.
  Ray at(float x, float y) const {
    if (!rolled_) return level_.at(x, y);
    const float dx = x - center_x_, dy = y - center_y_;
    return level_.at(center_x_ + dx * cosine_ - dy * sine_, center_y_ + dx * sine_ + dy * cosine_);
  }

 private:
  CameraRays level_;
  float center_x_, center_y_, cosine_, sine_;
  bool rolled_;
};

inline Ray cameraRay(const RolledCamera& rolled, float x, float y) { return RolledRays(rolled).at(x, y); }

}  // namespace cloudbake
