// The truth that every error figure is measured against: exact chords, never the estimator under test.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bake/field/dense_field.h"
#include "core/types.h"

namespace cloudbake {

/// Exact inside lengths of one shape; safe to query from several threads.
class Reference {
 public:
  virtual ~Reference() = default;
  /// ℓ(p, ω; L) in world units. `ray.direction` is unit; `length` = L in world units, may be infinite.
  virtual double insideLength(const Ray& ray, double length) const = 0;
  /// How the truth is found, for reports.
  virtual std::string name() const = 0;
};

/// Closed mesh (mesh_topology: no unmatched edges): Embree, all hits along the ray, inside where the winding number is not 0.
/// Starting on the surface is exact: the winding is counted from the ray's far end, where it is 0.
std::unique_ptr<Reference> meshReference(const SurfaceMesh& mesh);

/// Union of unblended spheres: the union of the ray's intervals, in double.
std::unique_ptr<Reference> sphereReference(std::span<const Sphere> spheres);

/// Where a mesh encloses nothing definite: a march of the level set at a tenth of a voxel. No independent truth of the field itself.
/// `length` must be finite.
std::unique_ptr<Reference> marchReference(DenseField field);

/// What the truth says of each vertex.
struct Truth {
  std::vector<Lobe> lobes;            ///< #V: mean direction and density along it
  std::vector<double> concentration;  ///< #V: κ
};

/// Mean directions over `directions` (fixed, of equal solid angle; 4096 in reports) with exact chords.
Truth trueLobes(const Reference& reference, std::span<const Vec3> positions, std::span<const Vec3> directions, double ray_length);

/// Exact ℓ from every point along every direction, world units: #points × #directions, row by row.
std::vector<float> trueLengths(const Reference& reference, std::span<const Vec3> positions, std::span<const Vec3> directions,
                               double ray_length);

}  // namespace cloudbake
