// A balanced k-d tree: each node's spheres are split at the median of the axis along which they extend farthest.
#include "lsystem/puff_tree.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace cloudbake {

namespace {

struct Place {
  std::array<float, 3> center;
  uint32_t index;
};

void layOut(std::span<Place> places) {
  if (places.size() <= kPuffLeaf) return;
  std::array<float, 3> low = places[0].center, high = low;
  for (const Place& place : places)
    for (size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], place.center[axis]);
      high[axis] = std::max(high[axis], place.center[axis]);
    }
  size_t widest = 0;
  for (size_t axis = 1; axis < 3; ++axis)
    if (double(high[axis]) - low[axis] > double(high[widest]) - low[widest]) widest = axis;
  const size_t half = places.size() / 2;
  std::nth_element(places.begin(), places.begin() + ptrdiff_t(half), places.end(), [widest](const Place& a, const Place& b) {
    return std::pair(a.center[widest], a.index) < std::pair(b.center[widest], b.index);
  });
  layOut(places.first(half));
  layOut(places.subspan(half));
}

}  // namespace

PuffTree makePuffTree(const std::vector<Puff>& puffs) {
  std::vector<Place> places;
  places.reserve(puffs.size());
  for (const Puff& puff : puffs)
    places.push_back({{float(puff.center.x), float(puff.center.y), float(puff.center.z)}, uint32_t(places.size())});
  layOut(places);

  PuffTree tree;
  tree.slots.resize(puffs.size());
  for (const Place& place : places) {
    tree.slots[place.index] = uint32_t(tree.order.size());
    tree.order.push_back(place.index);
  }
  size_t nodes = 1;
  for (size_t largest = puffs.size(); largest > kPuffLeaf; largest -= largest / 2) nodes = 2 * nodes + 1;
  tree.hulls.resize(nodes);
  return tree;
}

void addToTree(PuffTree& tree, const Puff& puff, uint32_t index) {
  const uint32_t slot = tree.slots[index];
  for (PuffNode node = rootOf(tree);; node = slot < node.right().begin ? node.left() : node.right()) {
    PuffHull& hull = tree.hulls[node.index];
    const Double3& c = puff.center;
    hull.low = {std::min(hull.low.x, c.x), std::min(hull.low.y, c.y), std::min(hull.low.z, c.z)};
    hull.high = {std::max(hull.high.x, c.x), std::max(hull.high.y, c.y), std::max(hull.high.z, c.z)};
    hull.radius = std::max(hull.radius, puff.radius);
    if (node.isLeaf()) return;
  }
}

}  // namespace cloudbake
