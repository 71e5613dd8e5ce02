// Affine maps: the transforms of glTF nodes, in double.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "core/vec3.h"

namespace cloudbake {

/// x' = linear·x + offset, in double: a glTF node's transform. Row-major.
struct Affine {
  std::array<std::array<double, 3>, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::array<double, 3> offset{0, 0, 0};
};
inline Vec3 transformVector(const Affine& m, Vec3 v) {
  Vec3 result;
  float* out[3] = {&result.x, &result.y, &result.z};
  for (int r = 0; r < 3; ++r) *out[r] = float(m.linear[r][0] * v.x + m.linear[r][1] * v.y + m.linear[r][2] * v.z);
  return result;
}
/// Not rounded to float.
inline std::array<double, 3> preciseTransformPoint(const Affine& m, Vec3 p) {
  std::array<double, 3> result;
  for (size_t r = 0; r < 3; ++r) result[r] = m.linear[r][0] * p.x + m.linear[r][1] * p.y + m.linear[r][2] * p.z + m.offset[r];
  return result;
}
inline Vec3 transformPoint(const Affine& m, Vec3 p) {
  const auto [x, y, z] = preciseTransformPoint(m, p);
  return {float(x), float(y), float(z)};
}
/// a∘b: first b, then a.
inline Affine compose(const Affine& a, const Affine& b) {
  Affine c;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k)
      c.linear[r][k] = a.linear[r][0] * b.linear[0][k] + a.linear[r][1] * b.linear[1][k] + a.linear[r][2] * b.linear[2][k];
    c.offset[r] = a.linear[r][0] * b.offset[0] + a.linear[r][1] * b.offset[1] + a.linear[r][2] * b.offset[2] + a.offset[r];
  }
  return c;
}
inline double determinant(const Affine& m) {
  const auto& a = m.linear;
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
         a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}
/// The inverse, or nothing if the linear part is singular or its inverse is not finite.
inline std::optional<Affine> inverted(const Affine& m) {
  const double det = determinant(m);
  if (det == 0 || !std::isfinite(1 / det)) return std::nullopt;
  const auto& a = m.linear;
  Affine inverse;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const int r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
      inverse.linear[r][c] = (a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1]) / det;
    }
  for (int r = 0; r < 3; ++r) {
    inverse.offset[r] = 0;
    for (int k = 0; k < 3; ++k) inverse.offset[r] -= inverse.linear[r][k] * m.offset[k];
  }
  return inverse;
}
/// What moves normals when `map` moves points: the inverse transpose. A singular map leaves them as they are.
inline Affine normalMap(const Affine& map) {
  Affine transpose;
  const auto back = inverted(map);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) transpose.linear[r][c] = back ? back->linear[c][r] : transpose.linear[r][c];
  return transpose;
}

}  // namespace cloudbake
