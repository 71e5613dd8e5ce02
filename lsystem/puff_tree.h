// A tree of boxes over spheres. It finds the spheres near a sphere quickly, even if they are dense or differ much in size.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "lsystem/double3.h"

namespace cloudbake {

/// A sphere in double precision, before it is rounded to float.
struct Puff {
  Double3 center;
  double radius = 0;
};

/// Bounds of the spheres under a node. Initially it contains none.
struct PuffHull {
  Double3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  double radius = 0;  ///< largest radius
};

/// Node k has the children 2k+1 and 2k+2. Each gets half of its range of `order`, down to `kPuffLeaf` spheres.
struct PuffTree {
  std::vector<uint32_t> order;  ///< indices of the spheres; neighbours in space are mostly next to each other
  std::vector<uint32_t> slots;  ///< place of each sphere in `order`
  std::vector<PuffHull> hulls;  ///< bounds of the spheres that were added, per node
};

constexpr uint32_t kPuffLeaf = 16;

struct PuffNode {
  uint32_t index, begin, end;  ///< range of `order`; a leaf if end - begin <= kPuffLeaf
  bool isLeaf() const { return end - begin <= kPuffLeaf; }
  PuffNode left() const { return {2 * index + 1, begin, begin + (end - begin) / 2}; }
  PuffNode right() const { return {2 * index + 2, begin + (end - begin) / 2, end}; }
};
inline PuffNode rootOf(const PuffTree& tree) { return {0, 0, uint32_t(tree.order.size())}; }

/// A tree that is laid out for these centres, without any sphere added.
PuffTree makePuffTree(const std::vector<Puff>& puffs);
/// Adds sphere `index`, which may have moved since the tree was made. Results stay exact; only the search slows down if many have moved
/// far.
void addToTree(PuffTree& tree, const Puff& puff, uint32_t index);

/// Square of the distance from a point to a hull's box, never rounded up; infinite for an empty hull.
inline double squaredDistance(const PuffHull& hull, Double3 center) {
  const auto outside = [](double low, double high, double x) { return x < low ? low - x : x > high ? x - high : 0; };
  const Double3 way{outside(hull.low.x, hull.high.x, center.x), outside(hull.low.y, hull.high.y, center.y),
                    outside(hull.low.z, hull.high.z, center.z)};
  return dot(way, way) * (1 - 1e-12);
}

/// Calls visit(j) for the spheres j of all leaves within reach of a point, nearer leaves first. It also visits spheres that were never
/// added. Stops when visit returns true. `reach(r)` is the largest distance of the centre of a sphere of radius <= r; it may shrink during
/// the search.
template <class Reach, class Visit>
bool searchTree(const PuffTree& tree, Double3 center, const Reach& reach, const Visit& visit, PuffNode node, double squared_distance) {
  const double limit = reach(tree.hulls[node.index].radius);
  if (limit < 0 || squared_distance > limit * limit * (1 + 1e-12)) return false;
  if (node.isLeaf()) {
    for (uint32_t slot = node.begin; slot < node.end; ++slot)
      if (visit(tree.order[slot])) return true;
    return false;
  }
  PuffNode near = node.left(), far = node.right();
  double to_near = squaredDistance(tree.hulls[near.index], center), to_far = squaredDistance(tree.hulls[far.index], center);
  if (to_far < to_near) {
    std::swap(near, far);
    std::swap(to_near, to_far);
  }
  return searchTree(tree, center, reach, visit, near, to_near) || searchTree(tree, center, reach, visit, far, to_far);
}

template <class Reach, class Visit>
bool searchTree(const PuffTree& tree, Double3 center, const Reach& reach, const Visit& visit) {
  return searchTree(tree, center, reach, visit, rootOf(tree), squaredDistance(tree.hulls[0], center));
}

}  // namespace cloudbake
