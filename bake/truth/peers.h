// The peers that `measure` prints beside our own bakes: what one gets from OpenVDB or Embree without either. Contract as
// bakeSphereRays (bake/lobe/sphere_rays.h): one lobe per point, N directions by the settings' sampler, L must be set, undefined directions
// are counted, the same result for any number of threads and any order of the points.
#pragma once

#include <span>
#include <vector>

#include "bake/lobe/sphere_rays.h"
#include "bake/truth/reference.h"
#include "core/types.h"

namespace cloudbake {

/// Plain port of the published method: S trilinear samples per ray from OpenVDB's tree through an accessor.
std::vector<Lobe> plainSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings);

/// OpenVDB's hierarchical traversal, which skips whatever lies off the narrow band. Steps and quadrature do not apply.
std::vector<Lobe> hddaSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings);

/// Exact chords. Steps and quadrature do not apply. The random streams are those of world positions, not of a shape's own frame.
std::vector<Lobe> embreeSphereRays(const BakePoints& points, const Reference& reference, const BakeSettings& settings, Warnings& warnings);

/// ℓ by the hierarchical traversal along given directions from every point, world units: #points × #directions, row by row.
/// `ray_length` in world units, may be infinite.
std::vector<float> hddaLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const LevelSet& level_set,
                               double ray_length);

}  // namespace cloudbake
