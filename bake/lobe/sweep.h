// The sweep handles one direction for all points together. Its cost per direction is cells + points; rays cost points × steps.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bake/lobe/sliced_field.h"
#include "bake/lobe/sphere_rays.h"
#include "core/types.h"

namespace cloudbake {

/// The axes of a sweep of `directions` = 2, 4, 6 … directions: the upper half of the spherical Fibonacci set. Each axis represents both
/// senses.
std::vector<Vec3> sweepAxes(int directions);

/// Bakes one lobe per point like bakeSphereRays, with the settings.rays (even) directions of sweepAxes and settings.ray_length (must be
/// set, world units). Points outside the field's box are moved to its border and counted. Memory does not depend on the number of
/// directions. The result is the same for any number of threads and any CPU.
std::vector<Lobe> bakeSweep(const BakePoints& points, const SweepField& field, const BakeSettings& settings, Warnings& warnings);

/// ω and −ω of every axis, axis by axis.
std::vector<Vec3> bothSenses(std::span<const Vec3> axes);

/// ℓ in world units from every point along both senses of every axis: in the order of bothSenses, each #points floats.
std::vector<float> sweptLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const SweepField& field, double ray_length);

/// The same for a few axes at a time, so that they need not all be stored together: calls use(first axis, lengths), with the lengths along
/// both senses of that axis and the next ones, from several threads at a time.
void sweepLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const SweepField& field, double ray_length,
                  const std::function<void(size_t, std::span<const float>)>& use);

/// ℓ of the same points in one direction after the other, when they are not all known at once: what does not depend on the direction is
/// kept. It refers to nothing that it was made of.
class SweptPoints {
 public:
  SweptPoints(std::span<const Vec3> positions, const CoverageField& field, double ray_length);
  ~SweptPoints();
  /// ℓ in world units from every point along a unit direction, as sweptLengths gives it.
  std::vector<float> lengths(Vec3 direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cloudbake
