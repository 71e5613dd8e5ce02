// Simplifies a surface to levels of detail.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// Removes vertices, those that change shape and light least first, until at most `vertex_counts[i]` of them are used; one list of
/// triangles per count. Counts descend; every list continues from the one before. Vertices stay where they are, so their attributes stay
/// true.
///
/// Vertices with one position are the sides of a seam: they go together, along the seam. Borders, non-manifold edges and vertices that are
/// `held` (#V, or empty) stay, and no vertex goes whose surroundings would move by more than 3 % of the longest side, so that a count may
/// not be met. `light` (#V) is what is blended across the triangles: at equal positions it is equal, and a difference of 1 in it counts as
/// much as a distance of the longest side.
std::vector<std::vector<Triangle>> simplified(const SurfaceMesh& mesh, std::span<const Vec3> light, const std::vector<bool>& held,
                                              std::span<const size_t> vertex_counts);

}  // namespace cloudbake
