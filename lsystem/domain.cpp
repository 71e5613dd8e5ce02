// Along each axis a centre c moves to o + a (c - o). A radius r becomes s r, with the same s for all axes, so that spheres stay spheres.
// The extent along an axis, max(c + r) - min(c - r), grows with a, so bisection finds a.
#include "lsystem/domain.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr std::array<double Double3::*, 3> kAxes{&Double3::x, &Double3::y, &Double3::z};

// The extent of the spheres along an axis, after their centres were moved from c to origin + stretch (c - origin) and their radii were
// scaled. A floor is the lower end; centres stay at least `flat` radii above it.
struct AxisMap {
  double Double3::*axis;
  double origin = 0, stretch = 1, scale = 1;
  std::optional<double> floor, flat;

  double center(const Puff& puff) const {
    const double moved = origin + stretch * (puff.center.*axis - origin);
    return flat && floor ? std::max(moved, *floor + *flat * scale * puff.radius) : moved;
  }
  Span cover(const std::vector<Puff>& puffs) const {
    Span span;
    for (const Puff& puff : puffs) {
      const double at = center(puff), radius = scale * puff.radius;
      span = {std::min(span.low, at - radius), std::max(span.high, at + radius)};
    }
    if (floor) span.low = *floor;
    return span;
  }
  double length(const std::vector<Puff>& puffs) const {
    const Span span = cover(puffs);
    return span.high - span.low;
  }
};

// The identity along each axis. Its origin is the middle of the footprint, and vertically the floor or the lowest point.
std::array<AxisMap, 3> axisMaps(const std::vector<Puff>& puffs, const Domain& domain) {
  std::array<AxisMap, 3> maps;
  for (size_t k = 0; k < 3; ++k) {
    AxisMap& map = maps[k];
    map.axis = kAxes[k];
    if (k == 1) map.floor = domain.floor, map.flat = domain.flat;
    const Span span = map.cover(puffs);
    map.origin = k == 1 ? span.low : 0.5 * (span.low + span.high);
  }
  return maps;
}

// The stretch at which an axis has the wanted length. The length grows with the stretch.
double findStretch(AxisMap map, const std::vector<Puff>& puffs, double wanted) {
  double low = 0, high = map.scale;
  const auto lengthAt = [&](double stretch) {
    map.stretch = stretch;
    return map.length(puffs);
  };
  while (lengthAt(high) < wanted && high < 1e30 * map.scale) high *= 2;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (lengthAt(middle) < wanted ? low : high) = middle;
  }
  return low;
}

}  // namespace

void fitDomain(std::vector<Puff>& puffs, const Domain& domain) {
  std::array<AxisMap, 3> maps = axisMaps(puffs, domain);
  std::array<double, 3> factors{};
  double product = 1;
  int given = 0;
  for (size_t k = 0; k < 3; ++k) {
    if (domain.size.*kAxes[k] == 0) continue;
    const double length = maps[k].length(puffs);
    if (!(length > 0)) throw InputError("", "the whole cloud is below the plane that cuts it: lower flat_base, or remove the domain");
    factors[k] = domain.size.*kAxes[k] / length;
    product *= factors[k];
    ++given;
  }
  const double mean = portablePow(product, 1.0 / given);

  // Scale radii by the mean factor, but by no more than fits every axis when all centres coincide.
  double scale = mean;
  for (size_t k = 0; k < 3; ++k) {
    AxisMap point = maps[k];
    point.stretch = 0;
    if (factors[k] > 0) scale = std::min(scale, domain.size.*kAxes[k] / point.length(puffs));
  }
  for (size_t k = 0; k < 3; ++k) {
    maps[k].scale = scale;
    maps[k].stretch = factors[k] > 0 ? findStretch(maps[k], puffs, domain.size.*kAxes[k]) : mean;
  }

  // Move the spheres, then centre the footprint again: stretching can move its middle.
  for (size_t k = 0; k < 3; ++k) {
    const Span span = maps[k].cover(puffs);
    const double shift = maps[k].floor ? 0 : maps[k].origin - (k == 1 ? span.low : 0.5 * (span.low + span.high));
    for (Puff& puff : puffs) puff.center.*kAxes[k] = maps[k].center(puff) + shift;
  }
  for (Puff& puff : puffs) puff.radius *= scale;
}

// Joining parts may push a sphere outside the domain, so everything is scaled down together.
void shrinkIntoDomain(std::vector<Puff>& puffs, const Domain& domain) {
  std::array<AxisMap, 3> maps = axisMaps(puffs, domain);
  double factor = 1;
  for (size_t k = 0; k < 3; ++k)
    if (const double wanted = domain.size.*kAxes[k]; wanted > 0) factor = std::min(factor, wanted / maps[k].length(puffs));
  if (factor == 1) return;
  for (Puff& puff : puffs) {
    for (AxisMap& map : maps) {
      map.stretch = map.scale = factor;
      puff.center.*map.axis = map.center(puff);
    }
    puff.radius *= factor;
  }
}

}  // namespace cloudbake
