// Other bakers that `measure` prints for comparison: they use OpenVDB or Embree directly instead of cloudbake's kernels. They have the
// contract of bakeSphereRays (bake/lobe/sphere_rays.h): one lobe per point, N directions by the settings' sampler, L must be set, undefined
// directions are counted, and the result is the same for any number of threads and any order of the points.
#pragma once

#include <span>
#include <vector>

#include "bake/lobe/sphere_rays.h"
#include "bake/truth/reference.h"
#include "core/types.h"

namespace cloudbake {

/// A plain port of the published method: S trilinear samples per ray, read from OpenVDB's tree through an accessor.
std::vector<Lobe> plainSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings);

/// Uses OpenVDB's hierarchical traversal, which skips everything outside the narrow band. Steps and quadrature do not apply.
std::vector<Lobe> hddaSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings);

/// Uses exact chords. Steps and quadrature do not apply. The random streams depend on world positions, not on the shape's own frame.
std::vector<Lobe> referenceSphereRays(const BakePoints& points, const Reference& reference, const BakeSettings& settings,
                                      Warnings& warnings);

/// ℓ in world units by the hierarchical traversal, from every point along the given directions: #points × #directions, row by row.
/// `ray_length` is in world units and may be infinite.
std::vector<float> hddaLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const LevelSet& level_set,
                               double ray_length);

}  // namespace cloudbake
