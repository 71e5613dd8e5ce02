// Converts a level set to a closed triangle mesh with smooth normals, and reduces a mesh to a vertex budget.
#pragma once

#include "core/types.h"

namespace cloudbake {

struct SurfaceSettings {
  std::optional<size_t> vertices;  ///< vertex budget; unset = no limit
};

/// The surface φ = 0 as triangles that face outwards, with smooth normals, in world units. It is closed, and its vertices lie on φ = 0.
/// Throws InputError if the level set is empty.
SurfaceMesh meshFromLevelSet(const LevelSet& level_set, const SurfaceSettings& settings, Warnings& warnings);

/// Collapses edges, least quadric error first, until at most `target_count` vertices are left. Drops normals and vertices that no triangle
/// uses. Borders and non-manifold edges stay; a budget that cannot be met because of them is counted.
void reduceVertices(SurfaceMesh& mesh, size_t target_count, Warnings& warnings);

}  // namespace cloudbake
