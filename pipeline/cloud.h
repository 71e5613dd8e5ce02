// A cloud on its way from its source to its lobes.
#pragma once

#include <optional>
#include <vector>

#include "core/sculpt.h"
#include "core/types.h"

namespace cloudbake {

/// A cloud grown or read, with everything that a bake needs.
struct Cloud {
  Sculpt sculpt;                      ///< parts as they will be written
  SurfaceMesh surface;                ///< all parts in scene space
  std::vector<Sphere> spheres;        ///< of a grown cloud; they are the exact shape where `exact_spheres`
  std::optional<LevelSet> level_set;  ///< of the surface, on a lattice of its own, where there is one
  std::optional<float> voxel_size;    ///< of a VDB, world units: the integration lattice gets it too
  bool exact_spheres = false;         ///< grown without blend, noise and flat base
  bool closed = true;                 ///< the surface bounds a volume
  bool wrapped = false;               ///< --close wrap: the volume is always that of a wrap
  std::optional<SurfaceMesh> filled;  ///< an open surface with its holes filled: bounds the volume in its place
  /// What bounds the volume, if anything definite does.
  const SurfaceMesh* solid() const { return closed ? &surface : filled ? &*filled : nullptr; }
};

}  // namespace cloudbake
