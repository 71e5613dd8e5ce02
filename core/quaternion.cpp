// Slerp as in glTF 2.0, appendix C.4: with d = a·b and θ = arccos |d| it is sin((1 − t) θ) / sin θ · a + sign(d) sin(t θ) / sin θ · b.
#include "core/quaternion.h"

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"

namespace cloudbake {

Affine rotationBy(const Quaternion& q) {
  const auto [x, y, z, w] = q;
  Affine m;
  m.linear = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
  return m;
}

std::optional<Quaternion> normalized(const Quaternion& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return Quaternion{q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

Quaternion slerp(const Quaternion& a, const Quaternion& b, double t) {
  const double d = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const double angle = acosDegrees(std::min(std::fabs(d), 1.0)), sine = sinCosDegrees(angle).sin;
  double of_a = 1 - t, of_b = t;
  if (sine > 1e-6) of_a = sinCosDegrees((1 - t) * angle).sin / sine, of_b = sinCosDegrees(t * angle).sin / sine;
  if (d < 0) of_b = -of_b;
  Quaternion blended;
  for (size_t i = 0; i < 4; ++i) blended[i] = of_a * a[i] + of_b * b[i];
  return normalized(blended).value_or(a);
}

}  // namespace cloudbake
