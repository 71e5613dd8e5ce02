// Three-component float vectors, and boxes of them.
#pragma once

#include <cmath>
#include <optional>

#include "core/portable_math.h"

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
/// Component by component, as colours multiply.
inline Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3 operator/(Vec3 a, float s) { return {a.x / s, a.y / s, a.z / s}; }
inline Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }

inline float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline bool isFinite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Euclidean length. It does not overflow or underflow for any finite v.
inline float length(Vec3 v) {
  const double x = v.x, y = v.y, z = v.z;
  return static_cast<float>(std::sqrt(x * x + y * y + z * z));
}

/// The unit vector along v; nothing if v is zero or not finite.
inline std::optional<Vec3> normalized(Vec3 v) {
  const double x = v.x, y = v.y, z = v.z, norm = std::sqrt(x * x + y * y + z * z);
  if (!(norm > 0) || !std::isfinite(norm)) return std::nullopt;
  return Vec3{static_cast<float>(x / norm), static_cast<float>(y / norm), static_cast<float>(z / norm)};
}

/// The vector halfway between two normals or tangents, shortened as an engine blends them; the first if they cancel out. Repeated halving
/// stays on the line between the ends, which unit vectors between unit vectors would leave.
inline Vec3 directionBetween(Vec3 a, Vec3 b) { return normalized(a + b) ? 0.5F * (a + b) : a; }

/// The angle between two unit vectors in degrees. It uses atan2, which is accurate near 0 and 180, where acos is not.
inline double angleDegrees(Vec3 a, Vec3 b) {
  const double cx = double(a.y) * b.z - double(a.z) * b.y, cy = double(a.z) * b.x - double(a.x) * b.z,
               cz = double(a.x) * b.y - double(a.y) * b.x;
  const double cosine = double(a.x) * b.x + double(a.y) * b.y + double(a.z) * b.z;
  return atan2Degrees(std::sqrt(cx * cx + cy * cy + cz * cz), cosine);
}

/// Two unit vectors that form a right-handed frame with a unit normal (tangent × bitangent = normal).
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
struct Frame {
  Vec3 tangent, bitangent;
};
inline Frame frameAround(Vec3 n) {
  const float sign = std::copysign(1.0F, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

/// Axis-aligned bounding box; empty until something is added.
struct Box {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  void add(Vec3 p) {
    // Comparisons with NaN are false, so a NaN changes nothing.
    low = {p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z};
    high = {p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y, p.z > high.z ? p.z : high.z};
  }
  bool empty() const { return !(low.x <= high.x); }
  Vec3 size() const { return empty() ? Vec3{} : high - low; }
  Vec3 center() const {
    return {float((double(low.x) + high.x) / 2), float((double(low.y) + high.y) / 2), float((double(low.z) + high.z) / 2)};
  }
  /// Corner i of 0 … 7: bits 0, 1 and 2 choose the high x, y and z.
  Vec3 corner(int i) const { return {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; }
  float longestSide() const { return std::fmax(size().x, std::fmax(size().y, size().z)); }
  float diagonal() const { return length(size()); }
};

}  // namespace cloudbake
