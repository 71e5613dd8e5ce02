// Half-edge collapses. The error of a collapse is the squared distance that its triangles' planes have from where the point goes, by their
// areas (M. Garland, P. Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997). The planes are those of the surface
// as it is, not sums over what it was: without memory the surface comes out nearer to the first one (P. Lindstrom, G. Turk, "Fast and
// Memory Efficient Polygonal Simplification", IEEE Visualization 1998). Planes lie in the N dimensions of the points (M. Garland, P.
// Heckbert, "Simplifying Surfaces with Color and Texture using Quadric Error Metrics", IEEE Visualization 1998).
//
// The link condition: T. Dey, H. Edelsbrunner, S. Guha, D. Nekhayev, "Topology Preserving Edge Contraction", Publications de l'Institut
// Mathématique 66, 1999.
//
// The collapses are made in passes. In each, every point finds its best collapse, and the cheapest of these are made that do not disturb
// each other. Points are ordered along a Morton curve and cut into chunks of a fixed size, each of which chooses among its own collapses.
#include "bake/mesh/collapse_edges.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "bake/mesh/mesh_topology.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"

namespace cloudbake {

namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr float kSide = 1024;        // the longest side of the box
constexpr size_t kMostValence = 32;  // a point with more triangles waits until its neighbours have gone
constexpr size_t kLongStar = 256;
constexpr size_t kShare = 10;  // of the points that could go, one in so many is a candidate in a pass
constexpr size_t kChunk = 1 << 14;
constexpr size_t kSample = 1 << 16;
constexpr size_t kGrain = 1 << 10;
constexpr double kSeam = 1;     // the weight of a seam's planes per squared length
constexpr double kEven = 1e-5;  // the weight of a collapse's own squared length: where a surface is flat, points stay spread over it

// What is refused to a collapse.
struct Limits {
  double least_turn;     // cosine between a triangle's normals before and after
  double least_fold;     // cosine between the normals of neighbours
  double least_quality;  // twice a triangle's area per squared longest side
};
constexpr std::array<Limits, 2> kLimits{{{0.25, -0.5, 0.02}, {-1, -0.8, 1e-3}}};  // the second where the first leave nothing to collapse

template <size_t N>
using Point = std::array<float, N>;
template <size_t N>
using Vector = std::array<double, N>;

template <size_t N>
double dotOf(const Vector<N>& a, const Vector<N>& b) {
  double sum = 0;
  for (size_t i = 0; i < N; ++i) sum += a[i] * b[i];
  return sum;
}
template <size_t N>
Vector<N> between(const Point<N>& from, const Point<N>& to) {
  Vector<N> result;
  for (size_t i = 0; i < N; ++i) result[i] = double(to[i]) - from[i];
  return result;
}
// The part of `a` across unit vectors that are across each other, of unit length; zero if there is none.
template <size_t N>
Vector<N> unitAcross(Vector<N> a, std::initializer_list<Vector<N>> others) {
  for (const auto& other : others) {
    const double share = dotOf(a, other);
    for (size_t i = 0; i < N; ++i) a[i] -= share * other[i];
  }
  const double length = std::sqrt(dotOf(a, a));
  for (double& x : a) x = length > 0 ? x / length : 0;
  return a;
}
Vector<3> crossOf(const Vector<3>& a, const Vector<3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <size_t N>
Vector<3> positionOf(const Vector<N>& v) {
  return {v[0], v[1], v[2]};
}

// Where a triangle faces, and how far it is from a line.
struct Facet {
  Vector<3> normal{};  // unit, or zero
  double twice_area = 0, longest_squared = 0;
};
template <size_t N>
Facet facetOf(const Point<N>& p, const Point<N>& q, const Point<N>& r) {
  const Vector<3> a = positionOf(between(p, q)), b = positionOf(between(p, r)), c{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  Facet facet{crossOf(a, b), 0, std::max({dotOf(a, a), dotOf(b, b), dotOf(c, c)})};
  facet.twice_area = std::sqrt(dotOf(facet.normal, facet.normal));
  const double inverse = facet.twice_area > 0 ? 1 / facet.twice_area : 0;
  for (double& x : facet.normal) x *= inverse;
  return facet;
}

// A side of a triangle: 3 · triangle + the corner where it begins.
uint32_t faceOf(uint32_t side) { return side / 3; }
uint32_t nextSide(uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
uint32_t previousSide(uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }

// The neighbours of a point. side[i] leads from the point to at[i]; its triangle's third corner is at[i + 1]. Empty unless the triangles at
// the point are one closed fan.
struct Ring {
  size_t count = 0;
  std::array<uint32_t, kMostValence> at, side;

  size_t next(size_t i) const { return i + 1 == count ? 0 : i + 1; }
  size_t previous(size_t i) const { return i == 0 ? count - 1 : i - 1; }
  bool contains(uint32_t point) const { return std::find(at.begin(), at.begin() + count, point) != at.begin() + count; }
};

// Per neighbour: the triangle of the ring that begins there, the one on its other side, and the third corner of that, or kNone.
using Facets = std::array<Facet, kMostValence>;
struct Surroundings {
  Facets outer;
  std::array<uint32_t, kMostValence> apex;
  double worst_fold = 1, worst_quality = 1;  // of the triangles as they are
};

// The planes from which the error of a collapse is measured.
template <size_t N>
struct Planes {
  std::array<std::array<Vector<N>, N == 3 ? 1 : 2>, kMostValence> axes;  // the normal, or unit vectors that span the plane
  std::array<double, kMostValence> area;
  struct Seam {
    Vector<3> normal;
    double weight;
  };
  std::array<Seam, 2 * kMostValence> seams;
  size_t seam_count = 0;

  // The squared distance from plane i, where the point goes by `away`.
  double distance(size_t i, const Vector<N>& away) const {
    const double along = dotOf(axes[i][0], away);
    if constexpr (N == 3) return along * along;
    const double also_along = dotOf(axes[i].back(), away);
    return std::max(0.0, dotOf(away, away) - along * along - also_along * also_along);
  }
};
// --- the surface while it collapses ---

using Costs = std::array<std::pair<float, uint32_t>, kMostValence>;

struct Collapse {
  float cost = 0;
  uint32_t point = 0, target = kNone;
  bool operator<(const Collapse& other) const { return cost != other.cost ? cost < other.cost : point < other.point; }
};

uint64_t spread(uint64_t x) {  // 21 bits, with two zeros after each
  x = (x | x << 32) & 0x1F00000000FFFFULL;
  x = (x | x << 16) & 0x1F0000FF0000FFULL;
  x = (x | x << 8) & 0x100F00F00F00F00FULL;
  x = (x | x << 4) & 0x10C30C30C30C30C3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

template <size_t N>
Box boxOf(const std::vector<Point<N>>& points) {
  Box box;
  for (const auto& p : points) box.add({p[0], p[1], p[2]});
  return box;
}

// Points in the order of a Morton curve through their box.
template <size_t N>
std::vector<uint32_t> spatialOrder(const std::vector<Point<N>>& points, const Box& box) {
  const float scale = box.longestSide() > 0 ? float((1 << 21) - 1) / box.longestSide() : 0;
  std::vector<std::pair<uint64_t, uint32_t>> keys(points.size());
  parallelBlocks(points.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto along = [&](size_t k, float low) { return spread(uint64_t((points[i][k] - low) * scale)); };
      keys[i] = {along(0, box.low.x) << 2 | along(1, box.low.y) << 1 | along(2, box.low.z), uint32_t(i)};
    }
  });
  parallelSort(keys.begin(), keys.end(), std::less<>());
  std::vector<uint32_t> order;
  for (const auto& [key, i] : keys) order.push_back(i);
  return order;
}

template <size_t N>
class Collapsing {
 public:
  explicit Collapsing(CollapseInput<N>&& input);
  CollapsedSurface reducedTo(size_t count);

 private:
  void connect();
  uint32_t pointAt(uint32_t side) const { return triangles_[faceOf(side)][side % 3]; }
  uint32_t vertexAt(uint32_t side) const { return corners_[faceOf(side)][side % 3]; }
  Facet facet(uint32_t a, uint32_t b, uint32_t c) const { return facetOf(points_[a], points_[b], points_[c]); }

  Ring ringOf(uint32_t point) const;
  Facets facetsOf(uint32_t point, const Ring& ring) const;
  Planes<N> planesOf(uint32_t point, const Ring& ring, const Facets& inner) const;
  Surroundings surroundingsOf(const Ring& ring, const Facets& inner) const;
  uint32_t apexOf(const Ring& ring, size_t i) const;
  std::optional<bool> meet(uint32_t a, uint32_t b) const;

  bool keepsTopology(uint32_t point, const Ring& ring, size_t k) const;
  bool keepsShape(const Ring& ring, const Facets& inner, const Surroundings& around, size_t k) const;
  bool keepsSeams(const Ring& ring, size_t k) const;
  size_t costsOf(uint32_t point, const Ring& ring, const Facets& inner, Costs& costs) const;
  Collapse estimated(uint32_t point) const;
  Collapse verified(const Collapse& estimate, const Ring& ring) const;
  bool isFixed(uint32_t point) const { return held_[point] || irregular_[point] != kNone; }

  void estimate(bool all_stale);
  std::vector<Collapse> chosenOf(std::vector<Collapse>& candidates, uint32_t begin, uint32_t end, float most_cost,
                                 std::vector<Collapse>& crossing);
  float mostCost(size_t excess) const;
  std::vector<Collapse> choose(size_t excess);
  std::array<uint32_t, 3> collapse(const Collapse& collapse);
  void collapseAll(const std::vector<Collapse>& chosen);
  size_t countUsed() const;
  size_t verticesAt(uint32_t point) const;
  CollapseObstacles obstacles() const;

  std::vector<Point<N>> points_;
  std::vector<Triangle> triangles_, corners_, kept_;  // a triangle that has gone begins with kNone
  std::vector<uint32_t> opposite_;                    // per side, the same edge the other way round; kNone if it is not there once
  std::vector<uint32_t> side_of_;                     // per point, a side that begins there
  std::vector<uint32_t> irregular_;                   // per point: its place in stars_ if its triangles are not one closed fan, or kNone
  std::vector<std::vector<uint32_t>> stars_;          // the triangles there; some may have gone
  std::vector<uint8_t> held_;
  std::vector<uint32_t> original_;  // the index of a point in the input
  size_t vertex_count_ = 0, used_ = 0;
  float most_distance_;

  std::vector<uint32_t> left_;           // points that have not gone, ascending
  std::vector<Collapse> best_;           // per point
  std::vector<uint8_t> touched_, gone_;  // points of triangles that the pass changes; points that it removes
  const Limits* limits_ = nullptr;
};

template <size_t N>
Collapsing<N>::Collapsing(CollapseInput<N>&& input) : kept_(std::move(input.kept)), vertex_count_(input.vertex_count) {
  const Box box = boxOf(input.points);
  original_ = spatialOrder(input.points, box);
  // In a frame of the shape, so that no product of lengths leaves the range of floats.
  const float scale = box.longestSide() > 0 ? kSide / box.longestSide() : 1;
  const Vec3 center = box.center();
  most_distance_ = scale * input.most_distance;
  std::vector<uint32_t> place(original_.size());
  for (uint32_t i = 0; i < original_.size(); ++i) {
    place[original_[i]] = i;
    Point<N> p = input.points[original_[i]];
    p[0] -= center.x, p[1] -= center.y, p[2] -= center.z;
    for (float& x : p) x *= scale;
    points_.push_back(p);
    held_.push_back(!input.held.empty() && input.held[original_[i]]);
  }
  // Triangles in the order of their first point.
  const size_t count = input.triangles.size();
  std::vector<uint32_t> first(points_.size() + 1, 0), order(count);
  const auto first_point = [](const Triangle& t) { return std::min({t[0], t[1], t[2]}); };
  for (Triangle& t : input.triangles) {
    for (uint32_t& p : t) p = place[p];
    ++first[first_point(t) + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  for (uint32_t f = 0; f < count; ++f) order[first[first_point(input.triangles[f])]++] = f;
  for (const uint32_t f : order) {
    triangles_.push_back(input.triangles[f]);
    if (!input.corners.empty()) corners_.push_back(input.corners[f]);
  }
  input = {};
  connect();
  best_.resize(points_.size());
  for (auto* flags : {&touched_, &gone_}) flags->resize(points_.size());
  for (uint32_t p = 0; p < points_.size(); ++p)
    if (side_of_[p] != kNone) left_.push_back(p);
  used_ = countUsed();
}

// Finds the sides' opposites, and the points whose triangles are not one closed fan.
template <size_t N>
void Collapsing<N>::connect() {
  const VertexTriangles stars = trianglesAtVertices(points_.size(), triangles_);
  const auto has_side = [&](uint32_t face, uint32_t from, uint32_t to) {
    const Triangle& t = triangles_[face];
    return (t[0] == from && t[1] == to)   ? 3 * face
           : (t[1] == from && t[2] == to) ? 3 * face + 1
           : (t[2] == from && t[0] == to) ? 3 * face + 2
                                          : kNone;
  };
  opposite_.assign(3 * triangles_.size(), kNone);
  side_of_.assign(points_.size(), kNone);
  parallelBlocks(points_.size(), kGrain, [&](size_t begin, size_t end) {
    for (auto p = uint32_t(begin); p < end; ++p)
      for (const uint32_t face : stars.at(p)) {
        const Triangle& t = triangles_[face];
        const uint32_t corner = t[0] == p ? 0 : t[1] == p ? 1 : 2, to = t[(corner + 1) % 3];
        side_of_[p] = 3 * face + corner;
        size_t along = 0, back = 0;
        uint32_t other = kNone;
        for (const uint32_t f : stars.at(p)) {
          along += has_side(f, p, to) != kNone;
          if (const uint32_t side = has_side(f, to, p); side != kNone) other = side, ++back;
        }
        if (along == 1 && back == 1) opposite_[3 * face + corner] = other;
      }
  });
  irregular_.assign(points_.size(), kNone);
  for (uint32_t p = 0; p < points_.size(); ++p) {
    const auto faces = stars.at(p);
    if (faces.empty()) continue;
    size_t steps = 0;
    uint32_t side = side_of_[p];
    do side = opposite_[previousSide(side)];
    while (++steps < faces.size() && side != kNone && side != side_of_[p]);
    if (steps == faces.size() && side == side_of_[p] && steps >= 3) continue;
    irregular_[p] = uint32_t(stars_.size());
    stars_.emplace_back(faces.begin(), faces.end());
  }
}

template <size_t N>
Ring Collapsing<N>::ringOf(uint32_t point) const {
  Ring ring;
  uint32_t side = side_of_[point];
  do {
    if (ring.count == kMostValence) return {};
    ring.side[ring.count] = side;
    ring.at[ring.count++] = pointAt(nextSide(side));
    side = opposite_[previousSide(side)];
  } while (side != side_of_[point]);
  return ring;
}

template <size_t N>
Facets Collapsing<N>::facetsOf(uint32_t point, const Ring& ring) const {
  Facets facets;
  for (size_t i = 0; i < ring.count; ++i) facets[i] = facet(point, ring.at[i], ring.at[ring.next(i)]);
  return facets;
}

// The planes of its triangles, and those that stand on the seams that end there.
template <size_t N>
Planes<N> Collapsing<N>::planesOf(uint32_t point, const Ring& ring, const Facets& inner) const {
  Planes<N> planes;
  for (size_t i = 0; i < ring.count; ++i) {
    planes.area[i] = inner[i].twice_area / 2;
    if constexpr (N == 3) {
      planes.axes[i] = {inner[i].normal};
    } else {
      planes.axes[i][0] = unitAcross(between(points_[point], points_[ring.at[i]]), {});
      planes.axes[i][1] = unitAcross(between(points_[point], points_[ring.at[ring.next(i)]]), {planes.axes[i][0]});
    }
  }
  for (size_t i = 0; i < ring.count && !corners_.empty(); ++i) {
    const uint32_t side = ring.side[i], other = previousSide(ring.side[ring.previous(i)]);  // there and back
    if (vertexAt(side) == vertexAt(nextSide(other)) && vertexAt(nextSide(side)) == vertexAt(other)) continue;
    const Vector<3> edge = positionOf(between(points_[point], points_[ring.at[i]])), along = unitAcross(edge, {});
    for (const size_t beside : {ring.next(i), ring.previous(i)})
      planes.seams[planes.seam_count++] = {unitAcross(positionOf(between(points_[point], points_[ring.at[beside]])), {along}),
                                           kSeam * dotOf(edge, edge)};
  }
  return planes;
}

// The third corner of the triangle on the other side of at[i], at[i + 1]; kNone if there is none or several.
template <size_t N>
uint32_t Collapsing<N>::apexOf(const Ring& ring, size_t i) const {
  const uint32_t side = opposite_[nextSide(ring.side[i])];
  return side == kNone ? kNone : pointAt(previousSide(side));
}

template <size_t N>
Surroundings Collapsing<N>::surroundingsOf(const Ring& ring, const Facets& inner) const {
  Surroundings around;
  for (size_t i = 0; i < ring.count; ++i) {
    around.apex[i] = apexOf(ring, i);
    around.outer[i] = around.apex[i] == kNone ? inner[i] : facet(ring.at[ring.next(i)], ring.at[i], around.apex[i]);
    around.worst_quality = std::min(around.worst_quality, inner[i].twice_area / inner[i].longest_squared);
    around.worst_fold =
        std::min({around.worst_fold, dotOf(inner[i].normal, around.outer[i].normal), dotOf(inner[i].normal, inner[ring.next(i)].normal)});
  }
  return around;
}

// Whether two points share an edge; unknown if `a` has too many triangles to look at.
template <size_t N>
std::optional<bool> Collapsing<N>::meet(uint32_t a, uint32_t b) const {
  if (irregular_[a] != kNone) {
    const std::vector<uint32_t>& star = stars_[irregular_[a]];
    if (star.size() > kLongStar) return std::nullopt;
    return std::any_of(star.begin(), star.end(), [&](uint32_t f) {
      const Triangle& t = triangles_[f];
      return t[0] != kNone && (t[0] == b || t[1] == b || t[2] == b);
    });
  }
  uint32_t side = side_of_[a];
  for (size_t steps = 0; steps < kLongStar; ++steps) {
    if (pointAt(nextSide(side)) == b) return true;
    side = opposite_[previousSide(side)];
    if (side == side_of_[a]) return false;
  }
  return std::nullopt;
}

// The link condition: the only common neighbours of the ends are those of the edge's two triangles.
template <size_t N>
bool Collapsing<N>::keepsTopology(uint32_t point, const Ring& ring, size_t k) const {
  const uint32_t target = ring.at[k];
  const size_t left = ring.next(k), right = ring.previous(k);
  if (ring.count == 3 && apexOf(ring, left) == target) return false;  // a tetrahedron
  if (irregular_[target] == kNone) {
    // One way round the target.
    uint32_t side = side_of_[target];
    for (size_t steps = 0; steps < kLongStar; ++steps) {
      const uint32_t other = pointAt(nextSide(side));
      if (other != point && other != ring.at[left] && other != ring.at[right] && ring.contains(other)) return false;
      side = opposite_[previousSide(side)];
      if (side == side_of_[target]) return true;
    }
  }
  for (size_t i = 0; i < ring.count; ++i) {
    if (i == k || i == left || i == right) continue;
    const std::optional<bool> met = meet(ring.at[i], target);
    if (met ? *met : meet(target, ring.at[i]).value_or(true)) return false;
  }
  return true;
}

template <size_t N>
bool Collapsing<N>::keepsShape(const Ring& ring, const Facets& inner, const Surroundings& around, size_t k) const {
  const double least_fold = std::min(limits_->least_fold, around.worst_fold);
  const double least_quality = std::min(limits_->least_quality, around.worst_quality);
  const uint32_t target = ring.at[k];
  Facet before = around.outer[k];
  for (size_t i = ring.next(k); ring.next(i) != k; i = ring.next(i)) {
    const Facet now = facet(target, ring.at[i], ring.at[ring.next(i)]);
    if (!(now.twice_area > 0 && now.twice_area >= least_quality * now.longest_squared)) return false;
    if (inner[i].twice_area > limits_->least_quality * inner[i].longest_squared &&
        !(dotOf(now.normal, inner[i].normal) > limits_->least_turn))
      return false;
    if (!(dotOf(now.normal, before.normal) >= least_fold)) return false;
    if (around.apex[i] != kNone && !(dotOf(now.normal, around.outer[i].normal) >= least_fold)) return false;
    before = now;
  }
  const size_t last = ring.previous(k);
  return around.apex[last] == kNone || dotOf(before.normal, around.outer[last].normal) >= least_fold;
}

// Vertices at the point go where those of the edge's two triangles go, along the seam.
template <size_t N>
bool Collapsing<N>::keepsSeams(const Ring& ring, size_t k) const {
  if (corners_.empty()) return true;
  const uint32_t left = ring.side[k], right = previousSide(ring.side[ring.previous(k)]);
  const uint32_t from_left = vertexAt(left), from_right = vertexAt(nextSide(right));
  if (from_left == from_right && vertexAt(nextSide(left)) != vertexAt(right)) return false;
  return std::all_of(ring.side.begin(), ring.side.begin() + ring.count, [&](uint32_t side) {
    const uint32_t vertex = vertexAt(side);
    return vertex == from_left || vertex == from_right;
  });
}

// The cheapest one, whether or not it is allowed.
template <size_t N>
Collapse Collapsing<N>::estimated(uint32_t point) const {
  const Ring ring = isFixed(point) ? Ring{} : ringOf(point);
  Costs costs;
  if (ring.count == 0 || costsOf(point, ring, facetsOf(point, ring), costs) == 0) return {0, point, kNone};
  const auto [cost, k] = *std::min_element(costs.begin(), costs.begin() + ring.count);
  return {cost, point, ring.at[k]};
}

// The cheapest one that is allowed. Most are.
template <size_t N>
Collapse Collapsing<N>::verified(const Collapse& estimate, const Ring& ring) const {
  const uint32_t point = estimate.point;
  const Facets inner = facetsOf(point, ring);
  const Surroundings around = surroundingsOf(ring, inner);
  const auto is_allowed = [&](size_t k) {
    return keepsTopology(point, ring, k) && keepsShape(ring, inner, around, k) && keepsSeams(ring, k);
  };
  const size_t first = size_t(std::find(ring.at.begin(), ring.at.end(), estimate.target) - ring.at.begin());
  if (is_allowed(first)) return estimate;
  Costs costs;
  const size_t count = costsOf(point, ring, inner, costs);
  std::sort(costs.begin(), costs.begin() + ring.count);
  for (size_t i = 0; i < count; ++i)
    if (const auto [cost, k] = costs[i]; k != first && is_allowed(k)) return {cost, point, ring.at[k]};
  return {0, point, kNone};
}

// Fills in what the collapses onto the neighbours cost, and returns how many are not too far.
template <size_t N>
size_t Collapsing<N>::costsOf(uint32_t point, const Ring& ring, const Facets& inner, Costs& costs) const {
  const Planes<N> planes = planesOf(point, ring, inner);
  const double area = std::accumulate(planes.area.begin(), planes.area.begin() + ring.count, 0.0);
  size_t count = 0;
  for (uint32_t k = 0; k < ring.count; ++k) {
    const Vector<N> away = between(points_[point], points_[ring.at[k]]);
    double error = 0;
    for (size_t i = 0; i < ring.count; ++i) error += planes.area[i] * planes.distance(i, away);
    const bool is_near = error <= double(most_distance_) * most_distance_ * area;
    for (size_t i = 0; i < planes.seam_count; ++i) {
      const double distance = dotOf(planes.seams[i].normal, positionOf(away));
      error += planes.seams[i].weight * distance * distance;
    }
    costs[k] = {is_near ? float(error + kEven * area * dotOf(away, away)) : std::numeric_limits<float>::infinity(), k};
    count += is_near;
  }
  return count;
}

// Estimates the best collapses of points whose triangles have changed, and of those that none was allowed to before their neighbours'
// triangles changed.
template <size_t N>
void Collapsing<N>::estimate(bool all_stale) {
  parallelBlocks(left_.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const uint32_t point = left_[i];
      bool stale = all_stale || touched_[point];
      if (!stale && best_[point].target == kNone && !isFixed(point)) {
        const Ring ring = ringOf(point);
        stale = std::any_of(ring.at.begin(), ring.at.begin() + ring.count, [&](uint32_t p) { return touched_[p]; });
      }
      if (stale) best_[point] = estimated(point);
    }
  });
}

// Verified collapses that do not disturb each other, the cheapest first: what is checked of one, another does not change. Those that reach
// points outside begin … end are left to `crossing`.
template <size_t N>
std::vector<Collapse> Collapsing<N>::chosenOf(std::vector<Collapse>& candidates, uint32_t begin, uint32_t end, float most_cost,
                                              std::vector<Collapse>& crossing) {
  std::sort(candidates.begin(), candidates.end());
  const auto is_own = [&](uint32_t p) { return p == kNone || (p >= begin && p < end); };
  std::vector<Collapse> chosen;
  for (const Collapse& candidate : candidates) {
    const uint32_t point = candidate.point;
    if (touched_[point] || (is_own(candidate.target) && touched_[candidate.target])) continue;
    const Ring ring = ringOf(point);
    std::array<uint32_t, kMostValence> apex;
    bool all_own = true, is_free = true;
    for (size_t i = 0; i < ring.count && all_own; ++i) {
      apex[i] = apexOf(ring, i);
      all_own = is_own(ring.at[i]) && is_own(apex[i]);
    }
    if (!all_own) {
      crossing.push_back(candidate);
      continue;
    }
    for (size_t i = 0; i < ring.count; ++i) is_free = is_free && (apex[i] == kNone || !gone_[apex[i]]);
    if (!is_free) continue;
    const Collapse best = best_[point] = verified(candidate, ring);
    if (best.target == kNone || best.cost > most_cost || touched_[best.target]) continue;
    touched_[point] = gone_[point] = 1;
    for (size_t i = 0; i < ring.count; ++i) touched_[ring.at[i]] = 1;
    chosen.push_back(best);
  }
  return chosen;
}

// What a collapse of a pass may cost: as few points are candidates as serve their number. Of a large surface, a sample tells.
template <size_t N>
float Collapsing<N>::mostCost(size_t excess) const {
  const size_t step = std::max<size_t>(1, left_.size() / kSample);
  std::vector<float> costs;
  for (size_t i = 0; i < left_.size(); i += step)
    if (const Collapse& best = best_[left_[i]]; best.target != kNone) costs.push_back(best.cost);
  const size_t rank = std::max(std::min(costs.size() / kShare, 4 * excess / step), left_.size() / step / 256);
  if (rank >= costs.size()) return std::numeric_limits<float>::infinity();
  std::nth_element(costs.begin(), costs.begin() + ptrdiff_t(rank), costs.end());
  return costs[rank];
}

// The collapses of a pass. Only the cheaper ones are candidates, so that none is made before cheaper ones that others make possible.
template <size_t N>
std::vector<Collapse> Collapsing<N>::choose(size_t excess) {
  const float most_cost = mostCost(excess);
  std::fill(touched_.begin(), touched_.end(), 0);
  std::fill(gone_.begin(), gone_.end(), 0);
  struct Chunk {
    std::vector<Collapse> chosen, crossing;
  };
  std::vector<Chunk> chunks((left_.size() + kChunk - 1) / kChunk);
  parallelFor(chunks.size(), [&](size_t i) {
    const size_t begin = i * kChunk, end = std::min(begin + kChunk, left_.size());
    std::vector<Collapse> candidates;
    for (size_t j = begin; j < end; ++j)
      if (const Collapse& best = best_[left_[j]]; best.target != kNone && best.cost <= most_cost) candidates.push_back(best);
    chunks[i].chosen = chosenOf(candidates, left_[begin], left_[end - 1] + 1, most_cost, chunks[i].crossing);
  });
  std::vector<Collapse> chosen, crossing, none;
  for (const Chunk& chunk : chunks) {
    chosen.insert(chosen.end(), chunk.chosen.begin(), chunk.chosen.end());
    crossing.insert(crossing.end(), chunk.crossing.begin(), chunk.crossing.end());
  }
  const std::vector<Collapse> others = chosenOf(crossing, 0, uint32_t(points_.size()), most_cost, none);
  chosen.insert(chosen.end(), others.begin(), others.end());

  // As many as are asked for, in the order of their places.
  size_t removed = 0;
  for (const Collapse& one : chosen) removed += verticesAt(one.point);
  if (removed > excess) {
    parallelSort(chosen.begin(), chosen.end(), std::less<>());
    size_t count = 0;
    for (removed = 0; removed < excess; ++count) removed += verticesAt(chosen[count].point);
    chosen.resize(count);
  }
  parallelSort(chosen.begin(), chosen.end(), [](const Collapse& a, const Collapse& b) { return a.point < b.point; });
  return chosen;
}

// Returns sides that are left, of the points whose own ones may be gone.
template <size_t N>
std::array<uint32_t, 3> Collapsing<N>::collapse(const Collapse& collapse) {
  const auto [cost, point, target] = collapse;
  const Ring ring = ringOf(point);
  const size_t k = size_t(std::find(ring.at.begin(), ring.at.end(), target) - ring.at.begin());
  const size_t next = ring.next(k), previous = ring.previous(k);
  const uint32_t left = ring.side[k], right = previousSide(ring.side[previous]);  // to the target, and back
  for (size_t i = next; i != previous; i = ring.next(i)) {
    const uint32_t side = ring.side[i];
    if (!corners_.empty()) corners_[faceOf(side)][side % 3] = vertexAt(side) == vertexAt(left) ? vertexAt(nextSide(left)) : vertexAt(right);
    triangles_[faceOf(side)][side % 3] = target;
    if (irregular_[target] != kNone) stars_[irregular_[target]].push_back(faceOf(side));
  }
  for (const uint32_t side : {left, right}) triangles_[faceOf(side)][0] = kNone;
  // What lies on the other sides of the two triangles that go meets what lies on this one.
  const auto join = [&](uint32_t inner, uint32_t outer) {
    opposite_[inner] = outer;
    if (outer != kNone) opposite_[outer] = inner;
  };
  const uint32_t to_right = previousSide(ring.side[ring.previous(previous)]);
  join(ring.side[next], opposite_[nextSide(left)]);
  join(to_right, opposite_[nextSide(ring.side[previous])]);
  return {ring.side[next], nextSide(ring.side[next]), to_right};
}

template <size_t N>
void Collapsing<N>::collapseAll(const std::vector<Collapse>& chosen) {
  std::vector<std::array<uint32_t, 3>> sides(chosen.size());
  parallelBlocks(chosen.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) sides[i] = collapse(chosen[i]);
  });
  for (size_t i = 0; i < chosen.size(); ++i) {
    side_of_[chosen[i].point] = kNone;
    for (const uint32_t side : sides[i]) side_of_[pointAt(side)] = side;
  }
  std::erase_if(left_, [&](uint32_t point) { return side_of_[point] == kNone; });
  used_ = countUsed();
}

template <size_t N>
size_t Collapsing<N>::countUsed() const {
  if (corners_.empty()) return left_.size();
  std::vector<uint8_t> used(vertex_count_);
  for (size_t f = 0; f < corners_.size(); ++f)
    for (size_t k = 0; k < 3 && triangles_[f][0] != kNone; ++k) used[corners_[f][k]] = 1;
  for (const Triangle& t : kept_)
    for (const uint32_t v : t) used[v] = 1;
  return size_t(std::count(used.begin(), used.end(), 1));
}

// How many vertices go with a point.
template <size_t N>
size_t Collapsing<N>::verticesAt(uint32_t point) const {
  if (corners_.empty()) return 1;
  const Ring ring = ringOf(point);
  std::vector<uint32_t> vertices;
  for (size_t i = 0; i < ring.count; ++i) vertices.push_back(vertexAt(ring.side[i]));
  std::sort(vertices.begin(), vertices.end());
  return size_t(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
}

template <size_t N>
CollapseObstacles Collapsing<N>::obstacles() const {
  CollapseObstacles obstacles;
  for (const uint32_t point : left_) {
    if (isFixed(point)) {
      ++obstacles.fixed;
      continue;
    }
    const Ring ring = ringOf(point);
    bool could = ring.count == 0;
    for (size_t k = 0; k < ring.count && !could; ++k) could = keepsTopology(point, ring, k);
    ++(could ? obstacles.shape : obstacles.topology);
  }
  return obstacles;
}

template <size_t N>
CollapsedSurface Collapsing<N>::reducedTo(size_t count) {
  for (const Limits& limits : kLimits) {
    limits_ = &limits;
    for (bool possible = true, all_stale = true; possible && used_ > count;) {
      estimate(all_stale);
      all_stale = false;
      possible = std::any_of(left_.begin(), left_.end(), [&](uint32_t p) { return best_[p].target != kNone; });
      collapseAll(choose(used_ - count));
    }
  }
  CollapsedSurface surface{kept_, used_, {}};
  for (size_t f = 0; f < triangles_.size(); ++f) {
    const Triangle& t = triangles_[f];
    if (t[0] != kNone)
      surface.triangles.push_back(corners_.empty() ? Triangle{original_[t[0]], original_[t[1]], original_[t[2]]} : corners_[f]);
  }
  if (used_ > count) surface.obstacles = obstacles();
  return surface;
}

}  // namespace

template <size_t N>
std::vector<CollapsedSurface> collapseEdges(CollapseInput<N> input, std::span<const size_t> counts) {
  Collapsing<N> surface(std::move(input));
  std::vector<CollapsedSurface> surfaces;
  for (const size_t count : counts) surfaces.push_back(surface.reducedTo(count));
  return surfaces;
}

template std::vector<CollapsedSurface> collapseEdges<3>(CollapseInput<3> input, std::span<const size_t> counts);
template std::vector<CollapsedSurface> collapseEdges<6>(CollapseInput<6> input, std::span<const size_t> counts);

}  // namespace cloudbake
