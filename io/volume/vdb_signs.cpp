// Every pair of neighbours of opposite sign is found once, from its voxel inside: voxels of leaves look at their six neighbours, tiles at
// what lies along their six faces. A face is split only where the blocks along it are smaller, so that a large tile takes as long as its
// neighbours have data.
#include "io/volume/vdb_signs.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace cloudbake {

namespace {

namespace vdb = openvdb;

using Leaf = vdb::FloatTree::LeafNodeType;
using Reader = vdb::FloatGrid::ConstUnsafeAccessor;  // is not registered in the tree: cheap to make, for trees that stay as they are

// The side of a block by its depth: a tile of the root, of the nodes below it, and a voxel of a leaf.
constexpr std::array<int, 4> kSides{4096, 128, 8, 1};
static_assert(vdb::FloatTree::RootNodeType::ChildNodeType::DIM == 4096 && Leaf::DIM == 8);

constexpr int kDirections = 6;
vdb::Coord neighbour(vdb::Coord at, int direction) {
  at[direction / 2] += direction % 2 ? 1 : -1;
  return at;
}

// The depth of the block at a place. The background counts as a tile of the root.
int depthAt(const Reader& file, const vdb::Coord& at) { return std::max(0, file.getValueDepth(at)); }

template <class Body>
void forEachTile(const vdb::FloatGrid& grid, const Body& body) {
  auto tile = grid.tree().cbeginValueAll();
  tile.setMaxDepth(vdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) body(tile);
}

// A square of pairs of neighbours: `inside` is the first voxel of those inside, and the others follow along the two other axes.
struct Square {
  vdb::Coord inside;
  int direction, side;
  int active;  // voxels of a pair
};

template <class Visit>
void visitLeaf(const Leaf& leaf, const Reader& file, const InsideRule& is_inside, const Visit& visit) {
  const float* values = leaf.buffer().data();
  const auto count = std::count_if(values, values + Leaf::SIZE, is_inside);
  if (count == 0) return;
  for (vdb::Index n = 0; n < Leaf::SIZE; ++n) {
    if (!is_inside(values[n])) continue;
    const vdb::Coord at = leaf.offsetToGlobalCoord(n);
    for (int direction = 0; direction < kDirections; ++direction) {
      const vdb::Coord next = neighbour(at, direction);
      const bool is_here = (next & ~int(Leaf::DIM - 1)) == leaf.origin();
      if (is_here && count == Leaf::SIZE) continue;
      const vdb::Index there = Leaf::coordToOffset(next);
      float value = values[there];
      const bool is_on = is_here ? leaf.isValueOn(there) : file.probeValue(next, value);
      if (!is_inside(value)) visit(Square{at, direction, 1, int(leaf.isValueOn(n)) + int(is_on)});
    }
  }
}

// A square of a tile's face; `depth` is that of a block with its side.
template <class Visit>
void visitFace(const vdb::Coord& at, int direction, int depth, const Reader& file, const InsideRule& is_inside, const Visit& visit) {
  const vdb::Coord next = neighbour(at, direction);
  const int side = kSides[size_t(depth)];
  if (depthAt(file, next) <= depth) {
    float value = 0;
    const bool is_on = file.probeValue(next, value);
    if (!is_inside(value)) visit(Square{at, direction, side, int(file.isValueOn(at)) + int(is_on)});
    return;
  }
  const int part = kSides[size_t(depth) + 1], u = (direction / 2 + 1) % 3, v = (direction / 2 + 2) % 3;
  for (int i = 0; i < side; i += part)
    for (int j = 0; j < side; j += part) {
      vdb::Coord corner = at;
      corner[u] += i;
      corner[v] += j;
      visitFace(corner, direction, depth + 1, file, is_inside, visit);
    }
}

template <class Visit>
void visitTiles(const vdb::FloatGrid& grid, const InsideRule& is_inside, const Visit& visit) {
  const Reader file = grid.getConstUnsafeAccessor();
  forEachTile(grid, [&](const auto& tile) {
    if (!is_inside(*tile)) return;
    const int depth = int(tile.getDepth());
    for (int direction = 0; direction < kDirections; ++direction) {
      vdb::Coord corner = tile.getCoord();
      if (direction % 2) corner[direction / 2] += kSides[size_t(depth)] - 1;
      visitFace(corner, direction, depth, file, is_inside, visit);
    }
  });
}

std::vector<const Leaf*> leavesOf(const vdb::FloatGrid& grid) {
  std::vector<const Leaf*> leaves;
  grid.tree().getNodes(leaves);
  return leaves;
}

void count(SignChanges& changes, const Square& square) {
  const uint64_t pairs = uint64_t(square.side) * uint64_t(square.side);
  (square.active == 2 ? changes.both_active : square.active == 1 ? changes.one_active : changes.none_active) += pairs;
  if (square.side > 1) changes.blocks += 2 * double(pairs) / (Leaf::DIM * Leaf::DIM);
}

}  // namespace

void IndexBox::add(const vdb::Coord& first, int64_t side) {
  for (int a = 0; a < 3; ++a) {
    low[size_t(a)] = std::min<int64_t>(low[size_t(a)], first[a]);
    high[size_t(a)] = std::max<int64_t>(high[size_t(a)], int64_t(first[a]) + side - 1);
  }
}

void IndexBox::add(const IndexBox& other) {
  for (size_t a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

IndexBox activeBox(const vdb::FloatGrid& grid) {
  IndexBox box;
  vdb::CoordBBox active;
  if (grid.tree().evalActiveVoxelBoundingBox(active)) box.add(active.min(), 1), box.add(active.max(), 1);
  return box;
}

IndexBox insideBox(const vdb::FloatGrid& grid, const InsideRule& inside) {
  IndexBox box;
  forEachTile(grid, [&](const auto& tile) {
    if (inside(*tile)) box.add(tile.getCoord(), kSides[size_t(tile.getDepth())]);
  });
  for (const Leaf* leaf : leavesOf(grid))
    for (vdb::Index n = 0; n < Leaf::SIZE; ++n)
      if (inside(leaf->getValue(n))) box.add(leaf->offsetToGlobalCoord(n), 1);
  return box;
}

bool isInactiveInside(const vdb::FloatGrid& grid, const InsideRule& inside) {
  for (auto value = grid.cbeginValueOff(); value; ++value)
    if (inside(*value)) return true;
  return false;
}

SignChanges countSignChanges(const vdb::FloatGrid& grid, const InsideRule& inside) {
  const std::vector<const Leaf*> leaves = leavesOf(grid);
  std::vector<SignChanges> of_leaf(leaves.size());
  parallelBlocks(leaves.size(), 64, [&](size_t begin, size_t end) {
    const Reader file = grid.getConstUnsafeAccessor();
    for (size_t l = begin; l < end; ++l) visitLeaf(*leaves[l], file, inside, [&](const Square& square) { count(of_leaf[l], square); });
  });
  SignChanges changes;
  visitTiles(grid, inside, [&](const Square& square) { count(changes, square); });
  for (const SignChanges& one : of_leaf) {
    changes.both_active += one.both_active;
    changes.one_active += one.one_active;
    changes.none_active += one.none_active;
  }
  return changes;
}

vdb::MaskTree::Ptr surfaceMask(const vdb::FloatGrid& grid, const InsideRule& inside) {
  auto mask = std::make_shared<vdb::MaskTree>();
  vdb::tree::ValueAccessor<vdb::MaskTree> to(*mask);
  const auto mark = [&](const vdb::Coord& at) {
    to.setValue(at, true);
    for (int corner = 0; corner < 8; ++corner) to.touchLeaf(at.offsetBy(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  };
  const auto markAll = [&](const Square& square) {
    const int u = (square.direction / 2 + 1) % 3, v = (square.direction / 2 + 2) % 3;
    for (int i = 0; i < square.side; ++i)
      for (int j = 0; j < square.side; ++j) {
        vdb::Coord at = square.inside;
        at[u] += i;
        at[v] += j;
        mark(at);
        mark(neighbour(at, square.direction));
      }
  };
  const Reader file = grid.getConstUnsafeAccessor();
  for (const Leaf* leaf : leavesOf(grid)) visitLeaf(*leaf, file, inside, markAll);
  visitTiles(grid, inside, markAll);
  return mask;
}

}  // namespace cloudbake
