// The sweep handles one direction for all points together. Its cost per direction is cells + points; rays cost points × steps.
#pragma once

#include <span>
#include <vector>

#include "bake/lobe/sphere_rays.h"
#include "core/types.h"

namespace cloudbake {

/// The axes of a sweep of `directions` = 2, 4, 6 … directions: the upper half of the spherical Fibonacci set. Each axis represents both
/// senses.
std::vector<Vec3> sweepAxes(int directions);

/// Bakes one lobe per point like bakeSphereRays, with the settings.rays (even) directions of sweepAxes and settings.ray_length (must be
/// set, world units). Points outside the field's box are moved to its border and counted. Memory does not depend on the number of
/// directions. The result is the same for any number of threads and any CPU.
std::vector<Lobe> bakeSweep(const BakePoints& points, const CoverageField& field, const BakeSettings& settings, Warnings& warnings);

/// ω and −ω of every axis, axis by axis.
std::vector<Vec3> bothSenses(std::span<const Vec3> axes);

/// ℓ in world units from every point along both senses of every axis: in the order of bothSenses, each #points floats.
std::vector<float> sweptLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const CoverageField& field, double ray_length);

}  // namespace cloudbake
