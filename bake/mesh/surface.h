// Level set → closed triangle mesh; vertex budget; smooth normals.
#pragma once

#include "core/types.h"

namespace cloudbake {

struct SurfaceSettings {
  std::optional<size_t> vertices;  ///< budget; unset: all that the grid gives
};

/// The surface φ = 0 as triangles that face outwards, with smooth normals, in world units. Closed; its vertices lie on φ = 0
/// except those that the budget moved. Throws InputError where the level set is empty.
SurfaceMesh meshFromLevelSet(const LevelSet& level_set, const SurfaceSettings& settings, Warnings& warnings);

/// Collapses edges until at most `target_count` vertices are left, least quadric error first. Normals are dropped, and vertices that no
/// triangle uses. Borders and non-manifold edges stay; a budget that they do not allow is counted.
void reduceVertices(SurfaceMesh& mesh, size_t target_count, Warnings& warnings);

}  // namespace cloudbake
