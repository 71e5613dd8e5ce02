// A length s at the distance t covers s · height / (2 t tan(fov/2)) pixels in the middle of the picture.
#include "preview/mesh_clouds/levels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cloudbake {

float longestStretched(const Instance& instance) {
  const Vec3 own = (instance.scattered ? instance.scattered->own
                    : instance.whole   ? *instance.whole
                                       : drawnBox(instance.mesh->surface))
                       .size();
  float longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 unit{float(axis == 0), float(axis == 1), float(axis == 2)};
    longest = std::max(longest, dot(own, unit) * length(transformVector(instance.to_world, unit)));
  }
  return longest;
}

float pixelsAcross(const Instance& instance, const Camera& camera) {
  return pixelsAcross(placedBox(instance), longestStretched(instance), camera);
}

float pixelsAcross(const Box& box, float longest_side, const Camera& camera) {
  const Vec3 eye = camera.look_from, nearest{std::clamp(eye.x, box.low.x, box.high.x), std::clamp(eye.y, box.low.y, box.high.y),
                                             std::clamp(eye.z, box.low.z, box.high.z)};
  return longest_side * float(camera.height) / (2 * length(eye - nearest) * std::tan(camera.vertical_fov_degrees * float(kPi / 360)));
}

const BakedMesh& levelAt(const Instance& instance, const Camera& camera) {
  if (instance.levels.empty() || instance.mesh->surface.triangles.empty()) return *instance.mesh;
  const float pixels = pixelsAcross(instance, camera);
  for (size_t i = instance.levels.size(); i-- > 0;)
    if (pixels <= float(instance.levels[i]->info.switch_pixels)) return *instance.levels[i];
  return *instance.mesh;
}

bool isInView(const Instance& instance, const Camera& camera) { return isInView(placedBox(instance), camera); }

bool isInView(const Box& box, const Camera& camera) {
  constexpr float kMargin = 1.001F;  // for rounding
  const CameraAxes axes = cameraAxes(camera);
  const float half_height = kMargin * std::tan(camera.vertical_fov_degrees * float(kPi / 360)),
              half_width = half_height * float(camera.width) / float(camera.height);
  std::array<int, 5> beyond{};  // corners behind the camera, left, right, below, above
  for (int i = 0; i < 8; ++i) {
    const Vec3 offset = box.corner(i) - camera.look_from;
    const float w = dot(offset, axes.forward), x = dot(offset, axes.right), y = dot(offset, axes.up);
    beyond[0] += int(w < 0), beyond[1] += int(x < -half_width * w), beyond[2] += int(x > half_width * w);
    beyond[3] += int(y < -half_height * w), beyond[4] += int(y > half_height * w);
  }
  return !box.empty() && std::none_of(beyond.begin(), beyond.end(), [](int corners) { return corners == 8; });
}

}  // namespace cloudbake
