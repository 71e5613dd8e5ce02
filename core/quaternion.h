// Quaternions as glTF stores rotations: x, y, z, w.
#pragma once

#include <array>
#include <optional>

#include "core/affine.h"

namespace cloudbake {

using Quaternion = std::array<double, 4>;

/// The rotation of a unit quaternion.
Affine rotationBy(const Quaternion& q);

/// Of length 1; nothing if `q` is zero or not finite.
std::optional<Quaternion> normalized(const Quaternion& q);

/// From `a` (t = 0) to `b` (t = 1) along the shorter way, at an even speed. Both are of length 1.
Quaternion slerp(const Quaternion& a, const Quaternion& b, double t);

}  // namespace cloudbake
