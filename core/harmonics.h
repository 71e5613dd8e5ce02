// Real spherical harmonics up to band 3. They store the transmittance of a vertex for every light direction where one lobe is too coarse.
//   T(l) ≈ Σᵢ cᵢ Yᵢ(l)      i = b² + b + m, band b = 0 … order, m = −b … b
// The Yᵢ are orthonormal over the sphere, in Cartesian form: P.-P. Sloan, "Stupid Spherical Harmonics (SH) Tricks" (GDC 2008),
// appendix A2, without its Condon–Shortley signs.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "core/vec3.h"

namespace cloudbake {

constexpr int kMaxHarmonicOrder = 3;
constexpr size_t kMaxHarmonics = 16;

/// Number of coefficients of an order: (order + 1)².
constexpr size_t harmonicCount(int order) { return size_t(order + 1) * size_t(order + 1); }

/// Y₀ … Y₁₅ for a unit direction.
inline std::array<float, kMaxHarmonics> evaluateHarmonics(Vec3 d) {
  const float x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
  return {0.28209479F,
          0.48860251F * y,
          0.48860251F * z,
          0.48860251F * x,
          1.09254843F * x * y,
          1.09254843F * y * z,
          0.31539157F * (3 * zz - 1),
          1.09254843F * x * z,
          0.54627422F * (xx - yy),
          0.59004359F * y * (3 * xx - yy),
          2.89061144F * x * y * z,
          0.45704580F * y * (5 * zz - 1),
          0.37317633F * z * (5 * zz - 3),
          0.45704580F * x * (5 * zz - 1),
          1.44530572F * z * (xx - yy),
          0.59004359F * x * (xx - 3 * yy)};
}

/// T in [0, 1] from a vertex's coefficients (1, 4, 9 or 16 of them). `to_light` is a unit vector in the axes of the coefficients.
inline float harmonicTransmittance(std::span<const float> coefficients, Vec3 to_light) {
  const auto basis = evaluateHarmonics(to_light);
  float sum = 0;
  for (size_t i = 0; i < coefficients.size(); ++i) sum += coefficients[i] * basis[i];
  return std::clamp(sum, 0.0F, 1.0F);
}

}  // namespace cloudbake
