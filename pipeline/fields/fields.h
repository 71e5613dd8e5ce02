// The integration field of a cloud, and the lobes and lengths that either method, sweep or rays, computes from it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bake/lobe/sphere_rays.h"
#include "bake/lobe/sweep.h"
#include "bake/truth/reference.h"
#include "core/types.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// What a lattice is for. --voxels and --voxel-size are for the surface, --bake-voxels for the integration field (unset: same as the
/// surface).
enum class Lattice { kSurface, kIntegration };

/// The box that the spheres fill.
Box boundingBox(std::span<const Sphere> spheres);

/// The level set of the cloud: of its spheres if it has any, else of its surface, which is closed first if it is open.
LevelSet levelSetOf(const Cloud& cloud, const FieldSettings& settings, Lattice lattice, Warnings& warnings);

/// The field that a method integrates: coverage for a sweep, a dense field for rays.
struct IntegrationField {
  std::optional<CoverageField> coverage;
  std::optional<DenseField> dense;
  std::string kind;  ///< what it was made from: "coverage" or "level set"
  double voxelSize() const { return coverage ? coverage->frame.voxel_size : dense->frame.voxel_size; }
  /// The coverage as sweeps read it, made by the first call. One thread at a time may call this.
  const SweepField& swept() const;

 private:
  mutable std::shared_ptr<const SweepField> swept_;
};

/// Builds the field of a method, on the integration lattice.
IntegrationField buildField(const Cloud& cloud, const FieldSettings& settings, Method method, Warnings& warnings);

/// The mean lobes of points, by the method that the field was built for.
std::vector<Lobe> meanLobes(const BakePoints& points, const IntegrationField& field, const BakeSettings& settings, Warnings& warnings);

/// The method's estimates of ℓ from every point along bothSenses(axes), world units: #points × 2 #axes, row by row.
std::vector<float> estimatedLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const IntegrationField& field,
                                    const BakeSettings& settings);

/// The reference for the truth of a cloud: exact spheres, a closed mesh, or else a fine march through its level set.
std::unique_ptr<Reference> referenceFor(const Cloud& cloud, const FieldSettings& settings);
/// Whether that reference is a march, which is slow.
bool truthIsMarched(const Cloud& cloud);

/// At most `wanted` indices below `count`, evenly spread.
std::vector<size_t> evenlySpread(size_t count, size_t wanted);
/// The same, but one index drawn at random from each of `wanted` equal stretches, so that no pattern in the order of vertices hides one.
std::vector<size_t> drawnFromStretches(size_t count, size_t wanted);

/// The values at these indices; empty if `from` is.
template <class Value>
std::vector<Value> pick(const std::vector<Value>& from, std::span<const size_t> indices) {
  std::vector<Value> picked;
  if (from.empty()) return picked;
  for (const size_t i : indices) picked.push_back(from[i]);
  return picked;
}

}  // namespace cloudbake
