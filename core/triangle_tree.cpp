// The tree. A node has up to four children and a leaf up to four triangles, which are tested side by side. A node's triangles are split
// where the surface area heuristic is least, among 16 bins along each axis (Wald, "On fast Construction of SAH-based Bounding Volume
// Hierarchies", 2007), until there are four parts. A leaf costs as much as four triangles, whether it is full or not.
//
// Triangles. A ray is made the z axis by a shear, after which it meets a triangle if the origin is in the triangle's projection (Woop,
// Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013). A corner is projected in the same way for each of its
// triangles, and the sign of an edge's function
//   e(b, c) = b.x c.y − b.y c.x
// is that of exact arithmetic or 0, because rounding is monotone. Where it is 0, it is computed in double, in which both products are
// exact. Where it is 0 there, the sign is that for a ray which is moved by (ε, ε²) (Edelsbrunner and Mücke, "Simulation of Simplicity", ACM
// ToG 9(1), 1990):
//   e(b − δ, c − δ) = e(b, c) + ε (b.y − c.y) + ε² (c.x − b.x)
// So every ray is in general position, and meets exactly the triangles that it would meet a little beside the edge or the corner.
//
// Boxes. Let u = 2⁻²⁴, and R the largest |coordinate| + |origin|. Translation, shear and its factors move a projected corner by at most 6 u
// R. A ray that meets the projection passes through the box of the triangle if that is larger by 16 u R, in which the rounding of the
// larger box is included. The distances to its planes have three roundings each, for which the far one is multiplied by 1 + 2 γ₃ (Ize,
// "Robust BVH Ray Traversal", JCGT 2(2), 2013).
#include "core/triangle_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr size_t kWide = 4;
// Vectors of GCC and Clang: of SSE, NEON or SIMD128 where the target has them, otherwise four numbers.
using Four = float __attribute__((vector_size(16)));
using Mask = int32_t __attribute__((vector_size(16)));

Four least(Four a, Four b) { return a < b ? a : b; }
Four most(Four a, Four b) { return a > b ? a : b; }

// Bit i is lane i.
unsigned lanesOf(Mask mask) {
#ifdef __SSE__
  return unsigned(_mm_movemask_ps((__m128)mask));
#else
  return unsigned((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
}

float component(Vec3 v, size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

constexpr float kLargest = 1.8e18F;  // the square is finite
bool isUsable(Vec3 p) { return std::abs(p.x) < kLargest && std::abs(p.y) < kLargest && std::abs(p.z) < kLargest; }

// An index of a node, or of a leaf and this bit.
constexpr uint32_t kLeaf = 0x80000000U, kNone = 0xffffffffU;

// SAH splits may be uneven. Below this depth halves are, and a node has a quarter of the triangles of its parent: 2³² end 16 nodes later.
constexpr size_t kUnevenDepth = 24;
constexpr size_t kStack = (kWide - 1) * TriangleTree::kMostDepth + 1;  // a node replaces itself by four

}  // namespace

struct TriangleTree::Node {
  std::array<Four, 6> planes;  // low x, y, z, high x, y, z of the children; empty boxes for those that are not there
  std::array<uint32_t, kWide> children;
};

struct TriangleTree::Leaf {
  std::array<std::array<Four, 3>, 3> corners;  // by axis and corner; NaN for triangles that are not there
  std::array<uint32_t, kWide> triangles;
};

// --- Building ---

namespace {

struct Boxed {
  Box box;
  uint32_t triangle = 0;
  float twiceCenter(size_t axis) const { return component(box.low, axis) + component(box.high, axis); }
};

void add(Box& box, const Box& other) {
  box.add(other.low);
  box.add(other.high);
}

float halfArea(const Box& box) {
  const Vec3 size = box.size();
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

size_t leavesFor(size_t triangles) { return (triangles + kWide - 1) / kWide; }

// Which of the bins along an axis a triangle belongs to.
constexpr size_t kBins = 16;
struct Binning {
  size_t axis = 0;
  float low = 0, scale = 0;
  size_t binOf(const Boxed& one) const { return std::min(size_t((one.twiceCenter(axis) - low) * scale), kBins - 1); }
};

struct Cut {
  Binning binning;
  size_t last_bin = 0;  // of the first part
  float cost = INFINITY;
};

// The least costly cut along one axis.
Cut cutAlong(const Binning& binning, std::span<const Boxed> some) {
  std::array<Box, kBins> boxes;
  std::array<size_t, kBins> counts{};
  for (const Boxed& one : some) {
    const size_t bin = binning.binOf(one);
    add(boxes[bin], one.box);
    ++counts[bin];
  }
  std::array<float, kBins> costs_above{};
  Box box;
  size_t count = 0;
  for (size_t bin = kBins - 1; bin > 0; --bin) {
    add(box, boxes[bin]);
    count += counts[bin];
    costs_above[bin] = count > 0 ? halfArea(box) * float(leavesFor(count)) : INFINITY;
  }
  Cut best{binning};
  box = {}, count = 0;
  for (size_t bin = 0; bin + 1 < kBins; ++bin) {
    add(box, boxes[bin]);
    count += counts[bin];
    const float cost = count > 0 ? halfArea(box) * float(leavesFor(count)) + costs_above[bin + 1] : INFINITY;
    if (cost < best.cost) best.last_bin = bin, best.cost = cost;
  }
  return best;
}

Cut bestCut(std::span<const Boxed> some) {
  std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (const Boxed& one : some)
    for (size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], one.twiceCenter(axis));
      high[axis] = std::max(high[axis], one.twiceCenter(axis));
    }
  Cut best;
  for (size_t axis = 0; axis < 3; ++axis) {
    const float scale = float(kBins) / (high[axis] - low[axis]);
    if (!std::isfinite(scale)) continue;  // all in one place
    const Cut cut = cutAlong({axis, low[axis], scale}, some);
    if (cut.cost < best.cost) best = cut;
  }
  return best;
}

}  // namespace

// Builds the tree of a part of the triangles. Large parts are split first, into tasks, which then run side by side.
class TriangleTree::Builder {
 public:
  struct Part {
    size_t begin = 0, end = 0;
    size_t size() const { return end - begin; }
  };
  // A part whose nodes are still to be built, and which child of which node it is.
  struct Task {
    Part part;
    size_t depth = 0;
    uint32_t parent = 0;
    size_t lane = 0;
  };

  Builder(std::span<Boxed> all, std::span<const Vec3> positions, std::span<const Triangle> triangles)
      : all_(all), positions_(positions), triangles_(triangles) {}

  std::vector<Node> nodes{};
  std::vector<Leaf> leaves{};
  std::vector<Task> tasks{};
  size_t depth = 0;

  // Returns the node's index. Parts of at most `largest_task` triangles become tasks.
  uint32_t addNode(Part whole, size_t at_depth, size_t largest_task) {
    std::array<Part, kWide> parts{whole};
    size_t count = 1;
    while (count < kWide) {
      Part& largest = *std::max_element(parts.begin(), parts.begin() + count, [](Part a, Part b) { return a.size() < b.size(); });
      if (largest.size() <= kWide) break;
      const size_t middle = split(largest, at_depth);
      parts[count++] = {middle, largest.end};
      largest.end = middle;
    }
    const auto index = uint32_t(nodes.size());
    nodes.emplace_back();
    depth = std::max(depth, at_depth + 1);
    for (size_t lane = 0; lane < kWide; ++lane) {
      const Part part = lane < count ? parts[lane] : Part{};
      Box box;
      for (const Boxed& one : all_.subspan(part.begin, part.size())) add(box, one.box);
      for (size_t axis = 0; axis < 3; ++axis) {
        nodes[index].planes[axis][lane] = component(box.low, axis);
        nodes[index].planes[3 + axis][lane] = component(box.high, axis);
      }
      nodes[index].children[lane] = kNone;
      if (part.size() == 0) continue;
      if (part.size() > kWide && part.size() <= largest_task) {
        tasks.push_back({part, at_depth + 1, index, lane});
      } else {
        const uint32_t child = part.size() <= kWide ? addLeaf(part) : addNode(part, at_depth + 1, largest_task);
        nodes[index].children[lane] = child;
      }
    }
    return index;
  }

 private:
  uint32_t addLeaf(Part part) {
    Leaf& leaf = leaves.emplace_back();
    for (size_t lane = 0; lane < kWide; ++lane) {
      const bool is_there = lane < part.size();
      leaf.triangles[lane] = is_there ? all_[part.begin + lane].triangle : kNone;
      for (size_t corner = 0; corner < 3; ++corner)
        for (size_t axis = 0; axis < 3; ++axis)
          leaf.corners[axis][corner][lane] = is_there ? component(positions_[triangles_[leaf.triangles[lane]][corner]], axis) : NAN;
    }
    return uint32_t(leaves.size() - 1) | kLeaf;
  }

  // Reorders a part and returns where its second half begins. The order within the halves is kept.
  size_t split(Part part, size_t at_depth) {
    const std::span<Boxed> some = all_.subspan(part.begin, part.size());
    const Cut cut = at_depth < kUnevenDepth ? bestCut(some) : Cut{};
    if (cut.cost == INFINITY) return part.begin + part.size() / 2;
    moved_.clear();
    size_t kept = 0;
    for (const Boxed& one : some) {
      if (cut.binning.binOf(one) > cut.last_bin) {
        moved_.push_back(one);
      } else {
        some[kept++] = one;
      }
    }
    std::copy(moved_.begin(), moved_.end(), some.begin() + std::ptrdiff_t(kept));
    return part.begin + kept;
  }

  std::span<Boxed> all_;
  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  std::vector<Boxed> moved_{};
};

TriangleTree::TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::vector<Boxed> all;
  all.reserve(triangles.size());
  Box box;
  for (size_t i = 0; i < triangles.size(); ++i) {
    Boxed one{{}, uint32_t(i)};
    bool is_usable = true;
    for (const uint32_t v : triangles[i]) {
      is_usable = is_usable && isUsable(positions[v]);
      one.box.add(positions[v]);
    }
    if (!is_usable) continue;
    all.push_back(one);
    add(box, one.box);
  }
  if (all.empty()) return;
  reach_ = {std::max(-box.low.x, box.high.x), std::max(-box.low.y, box.high.y), std::max(-box.low.z, box.high.z)};

  constexpr size_t kLargestTask = 8192;
  Builder top(all, positions, triangles);
  top.addNode({0, all.size()}, 0, kLargestTask);
  std::vector<Builder> below(top.tasks.size(), Builder(all, positions, triangles));
  parallelFor(below.size(), [&](size_t i) { below[i].addNode(top.tasks[i].part, top.tasks[i].depth, 0); });

  nodes_ = std::move(top.nodes);
  leaves_ = std::move(top.leaves);
  depth_ = top.depth;
  for (size_t i = 0; i < below.size(); ++i) {
    const auto first_node = uint32_t(nodes_.size()), first_leaf = uint32_t(leaves_.size());
    nodes_[top.tasks[i].parent].children[top.tasks[i].lane] = first_node;
    for (Node node : below[i].nodes) {
      for (uint32_t& child : node.children)
        if (child != kNone) child += child & kLeaf ? first_leaf : first_node;
      nodes_.push_back(node);
    }
    leaves_.insert(leaves_.end(), below[i].leaves.begin(), below[i].leaves.end());
    depth_ = std::max(depth_, below[i].depth);
  }
}
TriangleTree::~TriangleTree() = default;

// --- Rays ---

namespace {

int signOf(double x) { return int(x > 0) - int(x < 0); }

// The sign of e(b, c) for a ray that is moved by (ε, ε²). 0 if b = c.
int sideOf(float bx, float by, float cx, float cy) {
  const double e = double(bx) * cy - double(by) * cx;
  if (e != 0) return signOf(e);
  return by != cy ? signOf(double(by) - cy) : signOf(double(cx) - bx);
}

}  // namespace

class TriangleTree::Cast {
 public:
  Cast() = default;
  Cast(const Ray& ray, Vec3 reach) {
    const std::array<float, 3> o{ray.origin.x, ray.origin.y, ray.origin.z}, d{ray.direction.x, ray.direction.y, ray.direction.z};
    constexpr float kRounding = 0x1p-24F, kLeast = 1e-18F;
    float larger = 0;
    for (size_t axis = 0; axis < 3; ++axis) larger = std::max(larger, std::abs(o[axis]) + component(reach, axis));
    larger *= 16 * kRounding;
    for (size_t axis = 0; axis < 3; ++axis) {
      const bool is_back = std::signbit(d[axis]);
      near_plane_[axis] = is_back ? axis + 3 : axis;
      far_plane_[axis] = is_back ? axis : axis + 3;
      near_origin_[axis] = is_back ? o[axis] - larger : o[axis] + larger;
      far_origin_[axis] = is_back ? o[axis] + larger : o[axis] - larger;
      inverse_[axis] = 1 / (std::abs(d[axis]) < kLeast ? std::copysign(kLeast, d[axis]) : d[axis]);
    }
    z_ = std::abs(d[0]) > std::abs(d[1]) ? 0 : 1;
    if (std::abs(d[2]) >= std::abs(d[z_])) z_ = 2;
    x_ = (z_ + 1) % 3, y_ = (z_ + 2) % 3;
    if (d[z_] < 0) std::swap(x_, y_);  // seen from behind, a triangle turns the other way
    shear_x_ = d[x_] / d[z_], shear_y_ = d[y_] / d[z_], per_z_ = 1 / d[z_];
    origin_ = o;
  }

  // The children whose boxes the ray meets.
  unsigned meets(const Node& node) const {
    constexpr float kFarther = 1 + 2 * (3 * 0x1p-24F / (1 - 3 * 0x1p-24F));
    std::array<Four, 3> near_t, far_t;
    for (size_t axis = 0; axis < 3; ++axis) {
      near_t[axis] = (node.planes[near_plane_[axis]] - near_origin_[axis]) * inverse_[axis];
      far_t[axis] = (node.planes[far_plane_[axis]] - far_origin_[axis]) * inverse_[axis];
    }
    const Four first = most(most(near_t[0], near_t[1]), most(near_t[2], Four{}));
    const Four last = least(least(far_t[0], far_t[1]), far_t[2]) * kFarther;
    return lanesOf(first <= last);
  }

  template <typename Visit>
  void visitHits(const Leaf& leaf, const Visit& visit) const {
    std::array<Four, 3> x, y, z;
    for (size_t corner = 0; corner < 3; ++corner) {
      z[corner] = leaf.corners[z_][corner] - origin_[z_];
      x[corner] = (leaf.corners[x_][corner] - origin_[x_]) - shear_x_ * z[corner];
      y[corner] = (leaf.corners[y_][corner] - origin_[y_]) - shear_y_ * z[corner];
    }
    const Four e = x[1] * y[2] - y[1] * x[2], f = x[2] * y[0] - y[2] * x[0], g = x[0] * y[1] - y[0] * x[1];
    const Mask meets = (least(least(e, f), g) >= Four{}) | (most(most(e, f), g) <= Four{});
    for (unsigned lanes = lanesOf(meets); lanes != 0; lanes &= lanes - 1) {
      const auto i = unsigned(std::countr_zero(lanes));
      int sign = e[i] > 0 ? 1 : -1;
      double we = e[i], wf = f[i], wg = g[i];
      if (e[i] == 0 || f[i] == 0 || g[i] == 0) {
        sign = sideOf(x[1][i], y[1][i], x[2][i], y[2][i]);
        if (sign == 0 || sideOf(x[2][i], y[2][i], x[0][i], y[0][i]) != sign || sideOf(x[0][i], y[0][i], x[1][i], y[1][i]) != sign) continue;
        const auto exact = [](float bx, float by, float cx, float cy) { return double(bx) * cy - double(by) * cx; };
        we = exact(x[1][i], y[1][i], x[2][i], y[2][i]), wf = exact(x[2][i], y[2][i], x[0][i], y[0][i]);
        wg = exact(x[0][i], y[0][i], x[1][i], y[1][i]);
      }
      const auto t = float((we * z[0][i] + wf * z[1][i] + wg * z[2][i]) / (we + wf + wg) * per_z_);
      if (t >= 0) visit(RayHit{t, sign, leaf.triangles[i]});
    }
  }

 private:
  std::array<size_t, 3> near_plane_{}, far_plane_{};
  std::array<float, 3> near_origin_{}, far_origin_{}, inverse_{}, origin_{};
  size_t x_ = 0, y_ = 1, z_ = 2;
  float shear_x_ = 0, shear_y_ = 0, per_z_ = 1;
};

namespace {

bool isRay(Vec3 origin, Vec3 direction) { return isFinite(origin) && isFinite(direction) && direction != Vec3{}; }

}  // namespace

template <typename Visit>
void TriangleTree::castTogether(std::span<const Cast> casts, const Visit& visit) const {
  struct Waiting {
    uint32_t at, rays;  // rays: a bit for each
  };
  std::array<Waiting, kStack> stack;
  Waiting* top = stack.data();
  *top++ = {0, (1U << casts.size()) - 1};
  while (top != stack.data()) {
    const auto [at, rays] = *--top;
    if (at & kLeaf) {
      for (unsigned left = rays; left != 0; left &= left - 1) {
        const auto ray = size_t(std::countr_zero(left));
        casts[ray].visitHits(leaves_[at & ~kLeaf], [&](const RayHit& hit) { visit(ray, hit); });
      }
      continue;
    }
    const Node& node = nodes_[at];
    uint32_t rays_of_children = 0;  // a byte for each
    for (unsigned left = rays; left != 0; left &= left - 1) {
      const int ray = std::countr_zero(left);
      rays_of_children |= (casts[size_t(ray)].meets(node) * 0x00204081U & 0x01010101U) << ray;  // bit i goes to byte i
    }
    for (size_t i = 0; i < kWide; ++i, rays_of_children >>= 8)
      if (rays_of_children & 0xff) *top++ = {node.children[i], rays_of_children & 0xff};
  }
}

void TriangleTree::forHits(const Ray& ray, HitVisit visit) const {
  if (nodes_.empty() || !isRay(ray.origin, ray.direction)) return;
  const Cast cast(ray, reach_);
  castTogether({&cast, 1}, [&](size_t /*ray*/, const RayHit& hit) { visit(hit); });
}

void TriangleTree::addHits(Vec3 origin, std::span<const Vec3> directions, std::span<std::vector<RayHit>> hits) const {
  static_assert(kRaysTogether == 8);
  if (directions.size() > std::min(kRaysTogether, hits.size())) throw std::invalid_argument("TriangleTree::addHits: too many rays");
  std::array<Cast, kRaysTogether> casts;
  std::array<size_t, kRaysTogether> rays;
  size_t count = 0;
  for (size_t i = 0; i < directions.size(); ++i) {
    if (!isRay(origin, directions[i])) continue;
    casts[count] = Cast({origin, directions[i]}, reach_);
    rays[count++] = i;
  }
  if (!nodes_.empty()) castTogether(std::span(casts).first(count), [&](size_t ray, const RayHit& hit) { hits[rays[ray]].push_back(hit); });
}

// --- Nearest triangles ---

void TriangleTree::forTrianglesNear(Vec3 point, NearVisit visit) const {
  if (nodes_.empty() || !isFinite(point)) return;
  const std::array<float, 3> p{point.x, point.y, point.z};
  // The squared distance from the point to four boxes, rounded down: a difference, a square and two sums, each with one rounding.
  const auto squaredTo = [&](const std::array<Four, 3>& low, const std::array<Four, 3>& high) {
    Four squared{};
    for (size_t axis = 0; axis < 3; ++axis) {
      const Four outside = most(most(low[axis] - p[axis], p[axis] - high[axis]), Four{});
      squared += outside * outside;
    }
    return squared * (1 - 0x1p-20F);
  };

  struct Waiting {
    float squared = 0;
    uint32_t at = 0;
  };
  std::array<Waiting, kStack> stack;
  stack[0] = {};
  size_t count = 1;
  float radius = INFINITY;
  while (count > 0) {
    const Waiting next = stack[--count];
    if (!(next.squared <= radius * radius)) continue;
    if (next.at & kLeaf) {
      const Leaf& leaf = leaves_[next.at & ~kLeaf];
      std::array<Four, 3> low, high;
      for (size_t axis = 0; axis < 3; ++axis) {
        const auto& [a, b, c] = leaf.corners[axis];
        low[axis] = least(least(a, b), c), high[axis] = most(most(a, b), c);
      }
      const Four squared = squaredTo(low, high);
      for (size_t i = 0; i < kWide && leaf.triangles[i] != kNone; ++i)
        if (squared[i] <= radius * radius) radius = visit(leaf.triangles[i], radius);
      continue;
    }
    // The nearest child comes last, so that it is the next one.
    const Node& node = nodes_[next.at];
    const auto& [lx, ly, lz, hx, hy, hz] = node.planes;
    const Four squared = squaredTo({lx, ly, lz}, {hx, hy, hz});
    const size_t first = count;
    for (size_t i = 0; i < kWide && node.children[i] != kNone; ++i)
      if (squared[i] <= radius * radius) stack[count++] = {squared[i], node.children[i]};
    std::sort(stack.begin() + std::ptrdiff_t(first), stack.begin() + std::ptrdiff_t(count),
              [](const Waiting& a, const Waiting& b) { return a.squared != b.squared ? a.squared > b.squared : a.at > b.at; });
  }
}

}  // namespace cloudbake
