// A triangle is cut from the middle of the longest of its marked edges to the opposite corner. Each of its other marked edges is then a
// side of one half, which is cut in the same way. This needs no half-edges: a table of edges sees seams and edges of any number of
// triangles.
#include "bake/mesh/refine_mesh.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "bake/mesh/mesh_topology.h"
#include "core/distinct_positions.h"

namespace cloudbake {

namespace {

constexpr uint32_t kNone = EdgeTable::kNone;

std::tuple<float, float, float> inOrder(const Vec3& p) { return {p.x, p.y, p.z}; }

// The rank of every vertex's position among the distinct positions in lexicographic order, and these positions.
std::vector<uint32_t> positionRanks(const std::vector<Vec3>& all, std::vector<Vec3>& sorted) {
  DistinctPositions distinct(all.size());
  std::vector<uint32_t> rank_of;
  for (const Vec3& p : all) rank_of.push_back(distinct.add(p));
  std::vector<uint32_t> order(distinct.positions.size()), ranks(order.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return inOrder(distinct.positions[a]) < inOrder(distinct.positions[b]); });
  for (uint32_t i = 0; i < order.size(); ++i) {
    ranks[order[i]] = i;
    sorted.push_back(distinct.positions[order[i]]);
  }
  for (uint32_t& rank : rank_of) rank = ranks[rank];
  return rank_of;
}

double squareLength(const Vec3& a, const Vec3& b) {
  const double x = double(a.x) - b.x, y = double(a.y) - b.y, z = double(a.z) - b.z;
  return x * x + y * y + z * z;
}

double areaOf(const SurfaceMesh& mesh, const Triangle& t) {
  const Vec3 a = mesh.positions[t[0]];
  return 0.5 * double(length(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)));
}

uint64_t sideKey(uint32_t a, uint32_t b) { return uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

// Equal lengths are told apart by the order of the edges.
bool isLonger(const EdgeTable& table, uint32_t a, uint32_t b) {
  return std::pair(table.edges[a].square_length, a) > std::pair(table.edges[b].square_length, b);
}

// The corner at which the longest of the triangle's sides begins, of those that `chosen` does not have as kNone; 3 if there is none.
size_t longestSide(const EdgeTable& table, const std::array<uint32_t, 3>& sides, const std::array<uint32_t, 3>& chosen) {
  size_t longest = 3;
  for (size_t i = 0; i < 3; ++i)
    if (chosen[i] != kNone && (longest == 3 || isLonger(table, sides[i], sides[longest]))) longest = i;
  return longest;
}

// Calls body(triangle, corner) for every side of a marked edge.
template <class Body>
void forEachMarkedSide(const EdgeTable& table, const std::vector<bool>& marked, const Body& body) {
  for (size_t f = 0; f < table.of_triangle.size(); ++f)
    for (size_t i = 0; i < 3; ++i)
      if (const uint32_t edge = table.of_triangle[f][i]; edge != kNone && marked[edge]) body(f, i);
}

// `middles` are the new vertices on the triangle's sides; kNone for a side that stays whole.
void cut(const Triangle& t, const std::array<uint32_t, 3>& sides, const std::array<uint32_t, 3>& middles, const EdgeTable& table,
         std::vector<Triangle>& out) {
  const size_t longest = longestSide(table, sides, middles);
  if (longest == 3) {
    out.push_back(t);
    return;
  }
  const size_t next = (longest + 1) % 3, last = (longest + 2) % 3;
  const uint32_t middle = middles[longest];
  cut({t[longest], middle, t[last]}, {kNone, kNone, sides[last]}, {kNone, kNone, middles[last]}, table, out);
  cut({middle, t[next], t[last]}, {kNone, sides[next], kNone}, {kNone, middles[next], kNone}, table, out);
}

}  // namespace

EdgeTable edgesOf(const SurfaceMesh& mesh, const MiddleOf& middle_of) {
  std::vector<Vec3> positions;
  const std::vector<uint32_t> rank_of = positionRanks(mesh.positions, positions);
  std::vector<Triangle> ranks;
  std::vector<double> areas;
  for (const Triangle& t : mesh.triangles) {
    ranks.push_back({rank_of[t[0]], rank_of[t[1]], rank_of[t[2]]});
    areas.push_back(areaOf(mesh, t));
  }
  const auto order = [&](const EdgeSide& side) { return std::tuple(areas[side.triangle], side.triangle, side.corner); };

  EdgeTable table;
  table.of_triangle.assign(mesh.triangles.size(), {kNone, kNone, kNone});
  forEachEdge(positions.size(), ranks, Degenerate::kKept, [&](uint32_t low, std::span<EdgeSide> sides) {
    std::sort(sides.begin(), sides.end(), [&](const EdgeSide& a, const EdgeSide& b) { return order(a) < order(b); });
    const Vec3 a = positions[low], b = positions[sides.front().high];
    const auto middleOn = [&](const EdgeSide& side) {
      const Triangle& t = mesh.triangles[side.triangle];
      return middle_of(t[side.corner], t[(side.corner + 1) % 3]);
    };
    SplittableEdge edge{{a, b}, middleOn(sides.front()).value_or(0.5F * (a + b)), 0, squareLength(a, b), true};
    for (const EdgeSide& side : sides) {
      const auto middle = middleOn(side);
      edge.area += areas[side.triangle];
      edge.can_split = edge.can_split && middle && *middle == edge.middle && *middle != a && *middle != b;
      table.of_triangle[side.triangle][side.corner] = uint32_t(table.edges.size());
    }
    table.edges.push_back(edge);
  });
  return table;
}

void markLongest(const EdgeTable& table, std::vector<bool>& marked) {
  for (bool changed = true; changed;) {
    changed = false;
    forEachMarkedSide(table, marked, [&](size_t f, size_t) {
      const std::array<uint32_t, 3>& sides = table.of_triangle[f];
      const uint32_t longest = sides[longestSide(table, sides, sides)];
      if (marked[longest] || !table.edges[longest].can_split) return;
      marked[longest] = changed = true;
    });
  }
}

size_t verticesToAdd(const SurfaceMesh& mesh, const EdgeTable& table, const std::vector<bool>& marked) {
  std::vector<uint64_t> keys;
  forEachMarkedSide(table, marked,
                    [&](size_t f, size_t i) { keys.push_back(sideKey(mesh.triangles[f][i], mesh.triangles[f][(i + 1) % 3])); });
  std::sort(keys.begin(), keys.end());
  return size_t(std::unique(keys.begin(), keys.end()) - keys.begin());
}

std::vector<std::array<uint32_t, 2>> splitEdges(SurfaceMesh& mesh, const EdgeTable& table, const std::vector<bool>& marked) {
  std::vector<std::array<uint32_t, 2>> parents;
  std::unordered_map<uint64_t, uint32_t> known;
  const bool has_normals = !mesh.normals.empty();
  const auto vertexOn = [&](uint32_t edge, uint32_t a, uint32_t b) {
    const auto [found, is_new] = known.try_emplace(sideKey(a, b), uint32_t(mesh.positions.size()));
    if (is_new) {
      parents.push_back({std::min(a, b), std::max(a, b)});
      mesh.positions.push_back(table.edges[edge].middle);
      if (has_normals) mesh.normals.push_back(directionBetween(mesh.normals[std::min(a, b)], mesh.normals[std::max(a, b)]));
    }
    return found->second;
  };
  std::vector<Triangle> triangles;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle t = mesh.triangles[f];
    const std::array<uint32_t, 3>& sides = table.of_triangle[f];
    std::array<uint32_t, 3> middles{kNone, kNone, kNone};
    for (size_t i = 0; i < 3; ++i)
      if (sides[i] != kNone && marked[sides[i]]) middles[i] = vertexOn(sides[i], t[i], t[(i + 1) % 3]);
    cut(t, sides, middles, table, triangles);
  }
  mesh.triangles = std::move(triangles);
  return parents;
}

}  // namespace cloudbake
