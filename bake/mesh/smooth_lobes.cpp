// The quantity averaged is the thickness s(l) = ((l·o + 1)/2)^k d of a lobe towards a light (docs/lobe_math.md, without b). Over the sphere
// of l
//
//   ∫ s dl = c₀ d,    ∫ l s dl = c₁ d o        where c₀, c₁ depend only on k,
//
// so the mean of several lobes' s has the total thickness of the mean d, and its first moment points along the mean of o·d. All passes work
// on these two moments and together are one linear filter. At the end the moments are converted to lobes again.
//
// The filter: x ← x + λ mean(x_j − x) over the one-ring. G. Taubin, "A Signal Processing Approach to Fair Surface Design", SIGGRAPH 1995:
// the frequencies of this Laplacian are in 0 … 2, and a pass scales frequency f by 1 − λf. λ = 1/2 is the largest value that changes no
// sign. Weights are uniform, because cotangent weights may be negative and a mean could then leave the range of its terms (M. Wardetzky, S.
// Mathur, F. Kälberer, E. Grinspun, "Discrete Laplace operators: No free lunch", SGP 2007).
#include "bake/mesh/smooth_lobes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

#include "bake/mesh/mesh_topology.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"

namespace cloudbake {

namespace {

constexpr double kLambda = 0.5;
constexpr double kLeastConcentration = 1e-6;  // |mean of o·d| / mean of d; below this the float32 directions cancel out

struct Moments {
  double x = 0, y = 0, z = 0, d = 0;  // o·d, and d
  friend bool operator==(const Moments&, const Moments&) = default;
};

// Differences are summed, so that equal terms add exactly 0.
void addDifference(Moments& sum, const Moments& b, const Moments& a) {
  sum.x += b.x - a.x, sum.y += b.y - a.y, sum.z += b.z - a.z, sum.d += b.d - a.d;
}
Moments moved(const Moments& a, const Moments& step, double share) {
  return {a.x + share * step.x, a.y + share * step.y, a.z + share * step.z, a.d + share * step.d};
}

Moments momentsOf(const Lobe& lobe) {
  const double d = lobe.thickness;
  return {d * lobe.direction.x, d * lobe.direction.y, d * lobe.direction.z, d};
}

Lobe lobeOf(const Moments& m, Vec3 old_direction) {
  const double norm = std::sqrt(m.x * m.x + m.y * m.y + m.z * m.z);
  if (!(norm > kLeastConcentration * m.d)) return {old_direction, float(m.d)};
  return {{float(m.x / norm), float(m.y / norm), float(m.z / norm)}, float(m.d)};
}

// Lists of indices, one after the other: list i is items[first[i]] … items[first[i + 1] − 1].
struct Lists {
  std::vector<uint32_t> items, first;
  size_t count() const { return first.size() - 1; }
  std::span<const uint32_t> operator[](size_t i) const { return std::span(items).subspan(first[i], first[i + 1] - first[i]); }
};

// The vertices at each position. Positions are in lexicographic order; vertices at the same position are ordered by their lobes' bits.
Lists verticesByPosition(const std::vector<Lobe>& lobes, const std::vector<Vec3>& positions) {
  Lists lists;
  lists.items.resize(positions.size());
  std::iota(lists.items.begin(), lists.items.end(), 0U);
  const auto place = [&](uint32_t v) { return std::tie(positions[v].x, positions[v].y, positions[v].z); };
  const auto bits = [&](uint32_t v) { return std::bit_cast<std::array<uint32_t, 4>>(lobes[v]); };
  parallelSort(lists.items.begin(), lists.items.end(),
               [&](uint32_t a, uint32_t b) { return std::pair(place(a), bits(a)) < std::pair(place(b), bits(b)); });
  for (uint32_t i = 0; i < lists.items.size(); ++i)
    if (i == 0 || place(lists.items[i]) != place(lists.items[i - 1])) lists.first.push_back(i);
  lists.first.push_back(uint32_t(lists.items.size()));
  return lists;
}

// For each position, the positions that share a triangle's edge with it, in order.
Lists neighboursOf(const Lists& vertices, std::vector<Triangle> triangles) {
  std::vector<uint32_t> position_of(vertices.items.size());
  for (uint32_t p = 0; p < vertices.count(); ++p)
    for (const uint32_t v : vertices[p]) position_of[v] = p;
  for (Triangle& t : triangles)
    for (uint32_t& v : t) v = position_of[v];
  std::vector<std::array<uint32_t, 2>> edges;  // in order, and so every list will be
  forEachEdge(vertices.count(), triangles, Degenerate::kKept, [&](uint32_t low, std::span<EdgeSide> sides) {
    edges.push_back({low, sides.front().high});
  });

  // A counting sort, as in forEachEdge.
  Lists lists;
  lists.first.assign(vertices.count() + 2, 0);
  for (const auto& [low, high] : edges) ++lists.first[low + 2], ++lists.first[high + 2];
  std::partial_sum(lists.first.begin(), lists.first.end(), lists.first.begin());
  lists.items.resize(2 * edges.size());
  for (const auto& [low, high] : edges) lists.items[lists.first[low + 1]++] = high, lists.items[lists.first[high + 1]++] = low;
  lists.first.pop_back();
  return lists;
}

Moments smoothed(const std::vector<Moments>& all, size_t position, std::span<const uint32_t> neighbours) {
  Moments sum;
  for (const uint32_t n : neighbours) addDifference(sum, all[n], all[position]);
  return neighbours.empty() ? all[position] : moved(all[position], sum, kLambda / double(neighbours.size()));
}

}  // namespace

void smoothLobes(std::vector<Lobe>& lobes, const SurfaceMesh& mesh, int passes) {
  if (passes <= 0) return;
  const Lists vertices = verticesByPosition(lobes, mesh.positions);
  const Lists neighbours = neighboursOf(vertices, mesh.triangles);
  std::vector<Moments> now(vertices.count()), next(vertices.count());
  for (size_t p = 0; p < now.size(); ++p) {
    const Moments first = momentsOf(lobes[vertices[p].front()]);
    Moments sum;
    for (const uint32_t v : vertices[p]) addDifference(sum, momentsOf(lobes[v]), first);
    now[p] = moved(first, sum, 1.0 / double(vertices[p].size()));
  }
  for (int pass = 0; pass < passes; ++pass) {
    parallelFor(now.size(), [&](size_t p) { next[p] = smoothed(now, p, neighbours[p]); });
    now.swap(next);
  }
  for (size_t p = 0; p < now.size(); ++p) {
    const Lobe first = lobes[vertices[p].front()];  // its bits are kept if nothing changed
    const Lobe result = now[p] == momentsOf(first) ? first : lobeOf(now[p], first.direction);
    for (const uint32_t v : vertices[p]) lobes[v] = result;
  }
}

}  // namespace cloudbake
