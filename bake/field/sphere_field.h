// φ of a cluster of spheres at a point: their smooth or exact union with bumps on its surface and a flat base. All in index space.
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

/// Settings that are applied to the union. φ is valid for |φ| < band_voxels. Farther away only its sign is right, and |φ| ≥ band_voxels.
struct SphereField {
  float band_voxels;
  float k_voxels = 0;                                    ///< width of the smooth minimum and maximum; 0 = exact
  std::optional<float> base_voxels = std::nullopt;       ///< height of the flat base
  float base_k_voxels = 0;                               ///< width of the smooth maximum with the base
  std::optional<BillowNoise> base_bumps = std::nullopt;  ///< bumps that hang from the base; amplitude and size in voxels
  std::optional<BillowNoise> noise = std::nullopt;       ///< amplitude and size in voxels
  float steepest = 1;                                    ///< bound of |∇φ| before normalisation, 1 … 2

  float amplitude() const { return noise ? noise->amplitude : 0; }
  float baseAmplitude() const { return base_bumps ? base_bumps->amplitude : 0; }
  float farthestThatCounts() const { return steepest * band_voxels + amplitude(); }  ///< largest φ of the union that matters
};

/// φ at x. `distances` is scratch space for one float per sphere.
float sphereFieldAt(Vec3 x, std::span<const IndexSphere> spheres, std::vector<float>& distances, const SphereField& field);

/// The spheres that can affect φ within `radius` of a point; none if the band is out of reach.
std::vector<IndexSphere> spheresNear(Vec3 center, float radius, std::span<const IndexSphere> spheres, const SphereField& field);

/// Whether |φ| > band everywhere within `radius` of a point, judged by the value at the point.
bool isBeyondBand(Vec3 center, float radius, std::span<const IndexSphere> spheres, std::vector<float>& distances, const SphereField& field);

}  // namespace cloudbake
