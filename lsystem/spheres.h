// Makes the spheres of a cloud from the turtle's points.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/types.h"
#include "lsystem/turtle.h"

namespace cloudbake {

/// What becomes a sphere: recorded points, leaves (J K M), or both.
enum class Emit { kPoints, kLeaves, kBoth };

struct SphereSettings {
  Emit emit = Emit::kBoth;
  std::optional<double> size;   ///< radius of a sphere at the starting width, world units, > 0; unset = the turtle's step
  double leaf_size = 1;         ///< radius of a leaf of scale 1, world units, > 0
  double width_power = 1;       ///< radius × (width / thickness)^this
  double generation_power = 0;  ///< radius × (2 / (gen + 2))^this
  double radius_min = 0.85;     ///< radius × a random number between these two
  double radius_max = 1.15;
  double top_falloff = 0;         ///< 0 … 1: radius × (1 - this · smoothstep(base, highest point, height))
  double jitter = 0;              ///< centres move by up to this × radius along each axis
  std::optional<double> base;     ///< height of the condensation level, world units; if unset, top_falloff starts at the lowest point
  double squash = 1;              ///< 0 … 1: depth below the base × this
  std::optional<double> ceiling;  ///< heights above it × 0.3, world units
  std::optional<double> flat;     ///< centres stay at least this × radius above the base
  std::optional<uint64_t> count;  ///< maximum number of spheres; the largest are kept
  /// Width, height and depth (x, y, z) that the cloud fills, world units; 0 = it follows from the others. Centres are stretched per axis,
  /// radii by one factor. The middle of the footprint stays in place, and so does the floor or, without a floor, the lowest point.
  std::optional<Double3> domain;
  std::optional<double> floor;  ///< height of the plane that cuts the cloud, world units; the domain ignores what lies below it
  std::optional<bool> connect;  ///< true: separate parts are pulled together; false: they are intended; unset: they give a warning
  uint64_t max_spheres = 1'000'000;
};

/// The spheres in the order of the points, then of the leaves. Spheres hidden inside others are left out.
/// Throws InputError for a path without spheres, an exceeded limit, or a setting out of its range. Warns (kGrammar) about spheres
/// without a radius and, if `connect` is unset, about a cloud in several parts. Fills the counts of `summary` if it is given.
std::vector<Sphere> spheresFromPath(const TurtlePath& path, const SphereSettings& settings, Warnings& warnings,
                                    GrowthSummary* summary = nullptr);

/// The part that each sphere belongs to: 0, 1, … in order of first appearance. Two spheres belong to the same part if
/// |ci-cj| < ri + rj - 0.1 min(ri, rj).
std::vector<int> findParts(const std::vector<Sphere>& spheres);

}  // namespace cloudbake
