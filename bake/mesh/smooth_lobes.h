// Laplacian smoothing of lobes over a mesh.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// In each pass every vertex takes half of its own thickness function and half of its neighbours' mean: density by d, direction by o·d.
/// Vertices at one position are one vertex and end with one lobe. A vertex without neighbours stays as it is, and so does a direction that
/// nothing is left of because all cancel. Any triangles will do: open, non-manifold, degenerate. The bytes depend neither on the order of
/// vertices and triangles nor on the number of threads. Nothing changes where `passes` is 0. `lobes` #V.
void smoothLobes(std::vector<Lobe>& lobes, const SurfaceMesh& mesh, int passes);

}  // namespace cloudbake
