// A cluster fitted into a box.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "lsystem/puff_tree.h"

namespace cloudbake {

/// An interval of one axis; empty by default.
struct Span {
  double low = INFINITY, high = -INFINITY;
};

struct Domain {
  Double3 size;                 ///< width, height, depth, world units; 0 = free
  std::optional<double> floor;  ///< height below which nothing counts
  std::optional<double> flat;   ///< centres stay this × radius above the floor
};

/// Stretches the centres along each axis and scales all radii by the geometric mean of the stretches, so that the spheres fill the domain.
/// A free axis follows the mean. The middle of the footprint stays, and the floor, or without one the lowest point. `puffs` not empty.
/// Throws InputError where nothing is above the floor.
void fitDomain(std::vector<Puff>& puffs, const Domain& domain);

/// Scales everything by one factor, at most 1, so that nothing is outside.
void shrinkIntoDomain(std::vector<Puff>& puffs, const Domain& domain);

}  // namespace cloudbake
