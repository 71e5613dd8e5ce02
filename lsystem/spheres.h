// From the turtle's points to the puffs of a cloud.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/types.h"
#include "lsystem/turtle.h"

namespace cloudbake {

/// Which places become spheres: recorded points, leaves (J K M), or both.
enum class Emit { kPoints, kLeaves, kBoth };

struct SphereSettings {
  Emit emit = Emit::kBoth;
  std::optional<double> size;   ///< radius of a sphere at the starting width, world units, > 0; unset: the turtle's step
  double leaf_size = 1;         ///< radius of a leaf of scale 1, world units, > 0
  double width_power = 1;       ///< radius × (width / thickness)^this
  double generation_power = 0;  ///< radius × (2 / (gen + 2))^this
  double radius_min = 0.85;     ///< radius × a draw between these two
  double radius_max = 1.15;
  double top_falloff = 0;         ///< 0 … 1: radius × (1 - this · smoothstep(base, highest point, height))
  double jitter = 0;              ///< centres move by up to this × radius along each axis
  std::optional<double> base;     ///< height of the condensation level, world units; top_falloff without it starts at the lowest point
  double squash = 1;              ///< 0 … 1: depth below the base × this
  std::optional<double> ceiling;  ///< heights above it × 0.3, world units
  std::optional<double> flat;     ///< centres stay at least this × radius above the base
  std::optional<uint64_t> count;  ///< at most so many spheres: the largest are kept
  /// Width, height and depth (x, y, z) that the cloud is to fill, world units; 0 = as the others give it. Centres are stretched per axis,
  /// radii as a whole. The middle of the footprint stays, and the floor, or without one the lowest point.
  std::optional<Double3> domain;
  std::optional<double> floor;  ///< height of the plane that cuts the cloud, below which nothing counts for the domain, world units
  std::optional<bool> connect;  ///< pull separate parts together; false: they are meant; unset: they are warned of
  uint64_t max_spheres = 1'000'000;
};

/// Spheres in the order of the points, then of the leaves; those hidden inside others are left out.
/// Throws InputError for a path without spheres, a limit exceeded, or a setting out of its range. Warns (kGrammar) of spheres
/// without a radius and, where `connect` is unset, of a cloud in several parts. Adds to `summary`, if given, what became of the points.
std::vector<Sphere> spheresFromPath(const TurtlePath& path, const SphereSettings& settings, Warnings& warnings,
                                    GrowthSummary* summary = nullptr);

/// The part that each sphere belongs to, 0, 1, … in order of first appearance. Two spheres are of one part where
/// |ci-cj| < ri + rj - 0.1 min(ri, rj).
std::vector<int> findParts(const std::vector<Sphere>& spheres);

}  // namespace cloudbake
