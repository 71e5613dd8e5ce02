#include "preview/mesh_clouds/shadow_frame.h"

#include <algorithm>
#include <cmath>

#include "preview/shading_math.h"

namespace cloudbake {

ShadowFrame shadowFrame(std::span<const Vec3> points, Vec3 to_sun) {
  ShadowFrame frame;
  frame.to_sun = to_sun;
  frame.right = normalized(cross({0, 1, 0}, to_sun)).value_or(Vec3{1, 0, 0});
  frame.up = *normalized(cross(to_sun, frame.right));
  Box box;  // in the axes of the picture
  for (const Vec3& p : points) box.add({dot(p, frame.right), dot(p, frame.up), dot(p, to_sun)});
  if (box.empty()) return frame;
  const Vec3 center = box.center(), size = box.size();
  frame.origin = frame.right * center.x + frame.up * center.y + to_sun * center.z;
  frame.width = size.x, frame.height = size.y;
  frame.top = size.z / 2, frame.bottom = -frame.top;
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
