// The truth that every error figure is measured against: exact chords, independent of the estimator under test.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bake/field/dense_field.h"
#include "core/types.h"

namespace cloudbake {

/// Exact inside lengths of one shape. Several threads may query it at the same time.
class Reference {
 public:
  virtual ~Reference() = default;
  /// ℓ(p, ω; L) in world units. `ray.direction` is a unit vector. `length` = L in world units; it may be infinite.
  virtual double insideLength(const Ray& ray, double length) const = 0;
  /// The same from one origin along every direction, as float. It is fastest if directions that follow each other point the same way.
  virtual void insideLengths(Vec3 origin, std::span<const Vec3> directions, double length, std::span<float> lengths) const;
  /// How the truth is computed, for reports.
  virtual std::string name() const = 0;
};

/// For a closed mesh (mesh_topology: no unmatched edges). Embree finds all hits along the ray; inside means that the winding number is not
/// 0. A start on the surface is exact, because the winding number is counted from the ray's far end, where it is 0.
std::unique_ptr<Reference> meshReference(const SurfaceMesh& mesh);

/// For a union of unblended spheres: the union of the ray's intervals, in double.
std::unique_ptr<Reference> sphereReference(std::span<const Sphere> spheres);

/// For a mesh whose inside is not well defined: a march of the level set at a tenth of a voxel. This cannot show errors of the field
/// itself. `length` must be finite.
std::unique_ptr<Reference> marchReference(DenseField field);

/// The truth for each vertex.
struct Truth {
  std::vector<Lobe> lobes;            ///< #V: mean direction and density along it
  std::vector<double> concentration;  ///< #V: κ
};

/// Mean directions over `directions` with exact chords. The directions are fixed and of equal solid angle; reports use 4096.
Truth trueLobes(const Reference& reference, std::span<const Vec3> positions, std::span<const Vec3> directions, double ray_length);

/// Exact ℓ in world units from every point along every direction: #points × #directions, row by row.
std::vector<float> trueLengths(const Reference& reference, std::span<const Vec3> positions, std::span<const Vec3> directions,
                               double ray_length);

}  // namespace cloudbake
