// Three-component double vectors. The turtle computes in double, so that long paths do not drift.
#pragma once

#include <cmath>

#include "core/vec3.h"

namespace cloudbake {

struct Double3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Double3&, const Double3&) = default;
};

inline Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Double3 operator*(Double3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Double3 cross(Double3 a, Double3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Double3 v) { return std::sqrt(dot(v, v)); }
inline Vec3 toFloat(Double3 v) { return {float(v.x), float(v.y), float(v.z)}; }

}  // namespace cloudbake
