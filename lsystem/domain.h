// Fits a cluster of spheres into a box.
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
  std::optional<double> floor;  ///< height of the plane that cuts the cloud; what lies below it is ignored
  std::optional<double> flat;   ///< centres stay this × radius above the floor
};

/// Stretches the centres along each axis and scales all radii by the geometric mean of the stretches, so that the spheres fill the domain.
/// A free axis is stretched by the mean. The middle of the footprint stays in place, and so does the floor or, without a floor, the lowest
/// point. `puffs` must not be empty. Throws InputError if nothing is above the floor.
void fitDomain(std::vector<Puff>& puffs, const Domain& domain);

/// Scales everything by one factor of at most 1, so that nothing is outside the domain.
void shrinkIntoDomain(std::vector<Puff>& puffs, const Domain& domain);

}  // namespace cloudbake
