// A cloud as it was read or grown, before its lobes are baked.
#pragma once

#include <optional>
#include <vector>

#include "core/sculpt.h"
#include "core/types.h"

namespace cloudbake {

/// A grown or read cloud, with everything that a bake needs.
struct Cloud {
  Sculpt sculpt;                      ///< parts as they will be written
  SurfaceMesh surface;                ///< all parts in scene space
  std::vector<Sphere> spheres;        ///< of a grown cloud; they are its exact shape if `exact_spheres`
  std::optional<LevelSet> level_set;  ///< of the surface, on its own lattice, if there is one
  std::optional<float> voxel_size;    ///< of a VDB, world units; the integration lattice uses it too
  std::optional<double> iso;          ///< of a VDB of fog: the value at its surface
  bool exact_spheres = false;         ///< grown without blend, noise and flat base
  bool closed = true;                 ///< the surface bounds a volume
  bool wrapped = false;               ///< --close wrap: a wrap always bounds the volume
  std::optional<SurfaceMesh> filled;  ///< an open surface with its holes filled; it bounds the volume instead
  /// The closed mesh that bounds the volume; null if there is none.
  const SurfaceMesh* solid() const { return closed ? &surface : filled ? &*filled : nullptr; }
};

}  // namespace cloudbake
