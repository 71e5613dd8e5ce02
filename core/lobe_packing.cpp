// v = M⁻¹(o·d) keeps direction and thickness together. Under a non-uniform scale the direction and length of a chord change
// like one vector, so M restores both exactly. A thickness of zero gives no vector; then the direction alone is mapped.
#include "core/lobe_packing.h"

#include <algorithm>
#include <cmath>

namespace cloudbake {

Lobe mappedLobe(const Lobe& lobe, const Affine& map) {
  const Vec3 direction = transformVector(map, lobe.direction);
  const auto unit = normalized(direction);
  if (!unit) return {lobe.direction, 0};
  return {*unit, lobe.thickness * length(direction)};
}

LobeUvs packLobe(const Lobe& lobe, const Affine& from_scene) {
  const Lobe local = mappedLobe(lobe, from_scene);
  return {{local.direction.x, local.direction.y}, {local.direction.z, local.thickness}};
}

Lobe unpackLobe(const LobeUvs& uvs, const Affine& to_scene) {
  return mappedLobe({{uvs.first.x, uvs.first.y, uvs.second.x}, uvs.second.y}, to_scene);
}

// Octahedral directions: Meyer and others, "On Floating-Point Normal Vectors", EGSR 2010. The octahedron's lower half is folded out around
// the square |u| + |v| ≤ 1.
std::array<double, 2> octahedronPlace(double x, double y, double z) {
  const double sum = std::fabs(x) + std::fabs(y) + std::fabs(z);
  const double u = sum > 0 ? x / sum : 0, v = sum > 0 ? y / sum : 0;
  if (z < 0) return {std::copysign(1 - std::fabs(v), x), std::copysign(1 - std::fabs(u), y)};
  return {u, v};
}

PackedLobe quantisedLobe(const LobeUvs& uvs, float density_max) {
  const auto [u, v] = octahedronPlace(uvs.first.x, uvs.first.y, uvs.second.x);
  const double share = std::clamp(double(uvs.second.y) / double(density_max), 0.0, 1.0);
  const auto step = [](double of_one) { return int16_t(std::lround(kDirectionSteps * std::clamp(of_one, -1.0, 1.0))); };
  return {step(u), step(v), uint16_t(std::lround(kDensitySteps * std::sqrt(share)))};
}

std::array<double, 3> octahedronPoint(double u, double v) {
  const double z = 1 - std::fabs(u) - std::fabs(v), fold = std::max(-z, 0.0);
  return {u - std::copysign(fold, u), v - std::copysign(fold, v), z};
}

LobeUvs dequantisedLobe(const LobeUvs& stored, float density_max) {
  const auto [x, y, z] = octahedronPoint(stored.first.x, stored.first.y);
  const double size = std::sqrt(x * x + y * y + z * z), root = stored.second.y;
  return {{float(x / size), float(y / size)}, {float(z / size), float(double(density_max) * root * root)}};
}

}  // namespace cloudbake
