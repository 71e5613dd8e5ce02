#include "preview/mesh_clouds/shadow_frame.h"

#include <algorithm>
#include <cmath>

#include "preview/shading_math.h"

namespace cloudbake {

ShadowFrame shadowFrame(const Box& box, Vec3 to_sun) {
  ShadowFrame frame;
  frame.to_sun = to_sun;
  frame.right = normalized(cross({0, 1, 0}, to_sun)).value_or(Vec3{1, 0, 0});
  frame.up = *normalized(cross(to_sun, frame.right));
  if (box.empty()) return frame;
  frame.origin = box.center();
  const auto extentAlong = [&](Vec3 direction) {
    float most = 0;
    for (int i = 0; i < 8; ++i) most = std::max(most, dot(box.corner(i) - frame.origin, direction));
    return most;
  };
  frame.width = 2 * extentAlong(frame.right), frame.height = 2 * extentAlong(frame.up);
  frame.top = extentAlong(to_sun), frame.bottom = -frame.top;
  return frame;
}

Vec2 shadowPlace(Vec3 place, const ShadowFrame& frame) {
  const Vec3 way = place - frame.origin;
  return {dot(way, frame.right / frame.width) + 0.5F, dot(way, frame.up / frame.height) + 0.5F};
}

float shadowDepth(Vec3 place, const ShadowFrame& frame) {
  return saturate((frame.top - dot(place - frame.origin, frame.to_sun)) / std::max(frame.top - frame.bottom, 1e-6F));
}

float shadowFactor(float transmittance, Vec2 at, float strength) {
  const bool inside = at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1;
  return inside ? 1 - strength * (1 - transmittance) : 1;
}

}  // namespace cloudbake
