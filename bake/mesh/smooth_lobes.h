// Laplacian smoothing of lobes over a mesh.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// In each pass every vertex takes half of its own thickness function and half of its neighbours' mean: density by d, direction by o·d.
/// Vertices at the same position count as one vertex and get the same lobe. A vertex without neighbours stays unchanged, and a direction is
/// kept if the directions around it cancel out. Triangles may be open, non-manifold or degenerate. The bytes depend neither on the order of
/// vertices and triangles nor on the number of threads. Nothing changes if `passes` is 0. `lobes` has #V entries.
void smoothLobes(std::vector<Lobe>& lobes, const SurfaceMesh& mesh, int passes);

}  // namespace cloudbake
