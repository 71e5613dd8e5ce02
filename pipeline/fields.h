// The integration field of a cloud, and what is baked from it: the one place that knows the two methods.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bake/lobe/sphere_rays.h"
#include "bake/truth/reference.h"
#include "core/types.h"
#include "pipeline/cloud.h"
#include "pipeline/settings.h"

namespace cloudbake {

/// What a lattice is for: --voxels and --voxel-size are the surface's, --bake-voxels the integration field's (unset: as the surface's).
enum class Lattice { kSurface, kIntegration };

/// A level set of the cloud: of its spheres, else of its surface (an open one through what closes it).
LevelSet levelSetOf(const Cloud& cloud, const FieldSettings& settings, Lattice lattice, Warnings& warnings);

/// What a method integrates: a sweep's coverage, or the rays' dense field.
struct IntegrationField {
  std::optional<CoverageField> coverage;
  std::optional<DenseField> dense;
  std::string kind;  ///< what it was made of: "coverage" or "level set"
  double voxelSize() const { return coverage ? coverage->frame.voxel_size : dense->frame.voxel_size; }
};

/// Builds it for a method on the integration lattice.
IntegrationField buildField(const Cloud& cloud, const FieldSettings& settings, Method method, Warnings& warnings);

/// The mean lobes of points by the method that the field is for.
std::vector<Lobe> meanLobes(const BakePoints& points, const IntegrationField& field, const BakeSettings& settings, Warnings& warnings);

/// ω and −ω of every axis, in turn.
std::vector<Vec3> bothSenses(std::span<const Vec3> axes);

/// ℓ as the method estimates it from every point along bothSenses(axes), world units: #points × 2 #axes, row by row.
std::vector<float> estimatedLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const IntegrationField& field,
                                    const BakeSettings& settings);

/// The truth of a cloud: exact spheres, a closed mesh, or else a fine march of its level set.
std::unique_ptr<Reference> referenceFor(const Cloud& cloud, const FieldSettings& settings);
/// Whether that is a march, which is slow.
bool truthIsMarched(const Cloud& cloud);

/// At most `wanted` of `count` indices, evenly spread.
std::vector<size_t> evenlySpread(size_t count, size_t wanted);

/// The values at those indices; nothing of an empty list.
template <class Value>
std::vector<Value> pick(const std::vector<Value>& from, std::span<const size_t> indices) {
  std::vector<Value> picked;
  if (from.empty()) return picked;
  for (const size_t i : indices) picked.push_back(from[i]);
  return picked;
}

}  // namespace cloudbake
