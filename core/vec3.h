// Three-component float vectors, and the affine maps that act on them.
#pragma once

#include <array>
#include <cmath>
#include <optional>

namespace cloudbake {

constexpr double kPi = 3.14159265358979323846;

struct Vec2 {
  float x = 0, y = 0;
  friend bool operator==(const Vec2&, const Vec2&) = default;
};

struct Vec3 {
  float x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(float s, Vec3 a) { return a * s; }
inline Vec3 operator/(Vec3 a, float s) { return {a.x / s, a.y / s, a.z / s}; }
inline Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }

inline float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline bool isFinite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Euclidean length, free of overflow and underflow for any finite v.
inline float length(Vec3 v) {
  const double x = v.x, y = v.y, z = v.z;
  return static_cast<float>(std::sqrt(x * x + y * y + z * z));
}

/// Unit vector along v; nothing for a vector that is zero or not finite.
inline std::optional<Vec3> normalized(Vec3 v) {
  const double x = v.x, y = v.y, z = v.z, norm = std::sqrt(x * x + y * y + z * z);
  if (!(norm > 0) || !std::isfinite(norm)) return std::nullopt;
  return Vec3{static_cast<float>(x / norm), static_cast<float>(y / norm), static_cast<float>(z / norm)};
}

/// Angle between two unit vectors in degrees, by atan2: accurate at 0 and 180, where acos is not.
inline double angleDegrees(Vec3 a, Vec3 b) {
  const double cx = double(a.y) * b.z - double(a.z) * b.y, cy = double(a.z) * b.x - double(a.x) * b.z,
               cz = double(a.x) * b.y - double(a.y) * b.x;
  const double cosine = double(a.x) * b.x + double(a.y) * b.y + double(a.z) * b.z;
  return std::atan2(std::sqrt(cx * cx + cy * cy + cz * cz), cosine) * (180 / kPi);
}

/// The two unit vectors that complete a unit vector to a right-handed frame (tangent × bitangent = normal).
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
struct Frame {
  Vec3 tangent, bitangent;
};
inline Frame frameAround(Vec3 n) {
  const float sign = std::copysign(1.0F, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

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
inline Vec3 transformPoint(const Affine& m, Vec3 p) {
  Vec3 result;
  float* out[3] = {&result.x, &result.y, &result.z};
  for (int r = 0; r < 3; ++r) *out[r] = float(m.linear[r][0] * p.x + m.linear[r][1] * p.y + m.linear[r][2] * p.z + m.offset[r]);
  return result;
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
/// Inverse; nothing where the linear part is singular or not finite.
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

/// Axis-aligned bounding box; empty until something is added.
struct Box {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  void add(Vec3 p) {
    // A NaN compares false and changes nothing.
    low = {p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z};
    high = {p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y, p.z > high.z ? p.z : high.z};
  }
  bool empty() const { return !(low.x <= high.x); }
  Vec3 size() const { return empty() ? Vec3{} : high - low; }
  Vec3 center() const {
    return {float((double(low.x) + high.x) / 2), float((double(low.y) + high.y) / 2), float((double(low.z) + high.z) / 2)};
  }
  float longestSide() const { return std::fmax(size().x, std::fmax(size().y, size().z)); }
  float diagonal() const { return length(size()); }
};

}  // namespace cloudbake
