// The sphere-ray bake: it casts rays over the whole sphere from every vertex, and computes the mean direction, weighted by the squared
// density, and the density along it.
#pragma once

#include <span>
#include <vector>

#include "bake/field/dense_field.h"
#include "core/types.h"

namespace cloudbake {

/// The mean direction m/‖m‖ with m = Σ ω ℓ², and its concentration κ = ‖m‖ / Σ ℓ² in [0, 1] (0 if all ℓ are 0).
struct MeanDirection {
  Vec3 direction;  ///< unit vector; zero if m is zero
  double concentration = 0;
};
MeanDirection meanDirection(std::span<const Vec3> directions, std::span<const float> lengths);

/// Bakes one lobe per point with N rays of S steps and length L through the field (settings; L must be set, world units).
/// A direction is undefined if κ is below the estimator's noise (bake/lobe/directions.h). It is then replaced by undefinedDirection, and
/// the point is counted in `warnings`. The result is the same for any number of threads, any order of the points and any CPU.
std::vector<Lobe> bakeSphereRays(const BakePoints& points, const DenseField& field, const BakeSettings& settings, Warnings& warnings);

/// ℓ in world units from every point along the given directions, by the settings' quadrature: #points × #directions, row by row.
std::vector<float> marchedLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const DenseField& field,
                                  const BakeSettings& settings);

}  // namespace cloudbake
