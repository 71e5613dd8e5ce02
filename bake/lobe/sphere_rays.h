// The sphere-ray bake: rays over the whole sphere from every vertex, density-squared mean direction, density along it.
#pragma once

#include <span>
#include <vector>

#include "bake/field/dense_field.h"
#include "core/types.h"

namespace cloudbake {

/// The mean direction m/‖m‖ with m = Σ ω ℓ², and its concentration κ = ‖m‖ / Σ ℓ² in [0, 1] (0 where all ℓ are 0).
struct MeanDirection {
  Vec3 direction;  ///< unit; zero where m is
  double concentration = 0;
};
MeanDirection meanDirection(std::span<const Vec3> directions, std::span<const float> lengths);

/// What a point without such a direction gets: −normal, or −Y where it has none (or one that is zero).
Vec3 undefinedDirection(const BakePoints& points, size_t point);
/// Counts such points.
void warnUndefined(uint64_t count, Warnings& warnings);

/// Bakes one lobe per point: N rays of S steps and length L (settings; L must be set, world units) through the field.
/// Where the direction is undefined (κ under the estimator's noise, bake/lobe/directions.h) it is −normal, or −Y without one; such
/// points are counted in `warnings`. The result is the same for any number of threads, any order of the points and any CPU.
std::vector<Lobe> bakeSphereRays(const BakePoints& points, const DenseField& field, const BakeSettings& settings, Warnings& warnings);

/// ℓ along given directions from every point by the settings' quadrature, world units: #points × #directions, row by row.
std::vector<float> marchedLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const DenseField& field,
                                  const BakeSettings& settings);

}  // namespace cloudbake
