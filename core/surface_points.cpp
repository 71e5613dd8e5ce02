// A point in a triangle from two numbers u, v in [0, 1): weights 1 − √u, √u (1 − v), √u v (R. Osada et al., Shape Distributions, ACM TOG
// 2002, section 3.1). u and v come from the additive recurrence of the plastic number (M. Roberts, The Unreasonable Effectiveness of
// Quasirandom Sequences, 2018), so that neighbours on the surface are well spread.
#include "core/surface_points.h"

#include <algorithm>
#include <cmath>

#include "core/lobe_lighting.h"
#include "core/lobe_packing.h"

namespace cloudbake {

std::vector<SurfacePoint> spreadOverSurface(const SurfaceMesh& mesh, size_t count) {
  Box box;
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t v : t) box.add(mesh.positions[v]);
  // A power of two changes no bit of what it scales to about 1, and squares of very small or large sizes leave float's range.
  const float scale = box.empty() || !(box.longestSide() > 0) ? 1 : std::ldexp(1.0F, -std::clamp(std::ilogb(box.longestSide()), -126, 126));
  std::vector<double> area_before{0};  // of the triangles before each
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]] * scale, b = mesh.positions[t[1]] * scale, c = mesh.positions[t[2]] * scale;
    area_before.push_back(area_before.back() + 0.5 * double(length(cross(b - a, c - a))));
  }
  const double area = area_before.back();
  std::vector<SurfacePoint> points;
  if (!(area > 0) || !std::isfinite(area)) return points;
  const auto part = [](double x) { return x - std::floor(x); };
  for (size_t i = 0; i < count; ++i) {
    const double at = area * (double(i) + 0.5) / double(count);
    const auto after = std::upper_bound(area_before.begin(), area_before.end(), at);
    const auto triangle = std::min<size_t>(size_t(after - area_before.begin()) - 1, mesh.triangles.size() - 1);
    const auto root = float(std::sqrt(part(0.5 + 0.7548776662466927 * double(i))));
    const auto v = float(part(0.5 + 0.5698402909980532 * double(i)));
    points.push_back({mesh.triangles[triangle], {1 - root, root * (1 - v), root * v}});
  }
  return points;
}

Vec3 valueAt(const SurfacePoint& point, std::span<const Vec3> values) {
  Vec3 value;
  for (size_t i = 0; i < 3; ++i) value += values[point.corners[i]] * point.weights[i];
  return value;
}

Vec3 normalAt(const SurfacePoint& point, std::span<const Vec3> normals) { return normalized(valueAt(point, normals)).value_or(Vec3{}); }

Lobe blendedLobe(const SurfacePoint& point, std::span<const Lobe> lobes) {
  Lobe floats;
  for (size_t i = 0; i < 3; ++i) {
    floats.direction += lobes[point.corners[i]].direction * point.weights[i];
    floats.thickness += lobes[point.corners[i]].thickness * point.weights[i];
  }
  return mappedLobe(floats, {});
}

float blendedTransmittance(const SurfacePoint& point, std::span<const Lobe> lobes, Vec3 to_light, LobeShape shape, float extinction) {
  float sum = 0;
  for (size_t i = 0; i < 3; ++i) sum += point.weights[i] * lobeTransmittance(lobes[point.corners[i]], to_light, shape, extinction);
  return sum;
}

}  // namespace cloudbake
