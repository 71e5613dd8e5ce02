// φ of a cluster of spheres at a point: the union, smooth or exact, bumps on its surface, and a flat base. All in index space.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bake/field/billow_noise.h"
#include "core/types.h"

namespace cloudbake {

struct IndexSphere {
  Vec3 center;
  float radius;
};

/// What is done to the union. φ is meant for |φ| < band_voxels; beyond, only its sign and |φ| ≥ band_voxels hold.
struct SphereField {
  float band_voxels;
  float k_voxels = 0;                               ///< width of the smooth minimum and maximum; 0: exact
  std::optional<float> base_voxels = std::nullopt;  ///< height of the flat base
  std::optional<BillowNoise> noise = std::nullopt;  ///< amplitude and size in voxels
  float steepest = 1;                               ///< bound of |∇φ| before it is normalised, 1 … 2

  float amplitude() const { return noise ? noise->amplitude : 0; }
  float farthestThatCounts() const { return steepest * band_voxels + amplitude(); }  ///< of the union's φ, outwards
};

/// φ at x. `distances` is room for one float per sphere.
float sphereFieldAt(Vec3 x, std::span<const IndexSphere> spheres, std::vector<float>& distances, const SphereField& field);

/// The spheres that can matter within `radius` of a point; none where the band is out of reach.
std::vector<IndexSphere> spheresNear(Vec3 center, float radius, std::span<const IndexSphere> spheres, const SphereField& field);

/// True where |φ| > band within `radius` of a point, judged by the value there.
bool isBeyondBand(Vec3 center, float radius, std::span<const IndexSphere> spheres, std::vector<float>& distances, const SphereField& field);

}  // namespace cloudbake
