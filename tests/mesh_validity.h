// Counts what a mesh must not have that an engine draws and light is baked on.
#pragma once

#include <algorithm>
#include <cmath>
#include <ostream>

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/shells.h"

namespace cloudbake {

/// The faults of a mesh as it is stored: nothing is welded before most of them are counted.
struct MeshFaults {
  size_t unmatched_sides = 0;     ///< directed edges that are there more than once, or whose reverse is not
  size_t doubled_triangles = 0;   ///< the same three vertices twice
  size_t flat_triangles = 0;      ///< no area, or less than float can tell from none
  size_t folds = 0;               ///< neighbours whose normals are opposite
  size_t wrong_normals = 0;       ///< not finite, not unit, or missing
  size_t repeated_positions = 0;  ///< two vertices at one place
  size_t pinched_vertices = 0;    ///< triangles that are more than one fan
  size_t unused_vertices = 0;
  size_t odd_parts = 0;  ///< connected parts whose Euler number is not 2, 0, −2, …

  size_t count() const {
    return unmatched_sides + doubled_triangles + flat_triangles + folds + wrong_normals + repeated_positions + pinched_vertices +
           unused_vertices + odd_parts;
  }
  friend std::ostream& operator<<(std::ostream& out, const MeshFaults& f) {
    return out << "sides " << f.unmatched_sides << ", doubled " << f.doubled_triangles << ", flat " << f.flat_triangles << ", folds "
               << f.folds << ", normals " << f.wrong_normals << ", repeated " << f.repeated_positions << ", pinched " << f.pinched_vertices
               << ", unused " << f.unused_vertices << ", odd " << f.odd_parts;
  }
};

/// Two neighbours fold if the angle between their normals has a cosine below this.
inline constexpr double kFoldCosine = -0.99;

inline MeshFaults faultsOf(const SurfaceMesh& mesh) {
  using Vec3d = std::array<double, 3>;
  const auto minus = [](Vec3 a, Vec3 b) { return Vec3d{double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z}; };
  const auto dot = [](const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  MeshFaults faults;
  std::vector<Vec3d> normals;
  std::vector<size_t> triangles_at(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    for (const uint32_t v : t) ++triangles_at[v];
    const Vec3d a = minus(mesh.positions[t[1]], mesh.positions[t[0]]), b = minus(mesh.positions[t[2]], mesh.positions[t[0]]);
    Vec3d n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const double area = std::sqrt(dot(n, n)), longest = std::max(dot(a, a), dot(b, b));
    if (!(area > 1e-6 * longest)) ++faults.flat_triangles;
    for (double& x : n) x = area > 0 ? x / area : 0;
    normals.push_back(n);
  }
  std::vector<size_t> edges_at(mesh.positions.size());
  forEachEdge(mesh.positions.size(), mesh.triangles, Degenerate::kLeftOut, [&](uint32_t low, std::span<EdgeSide> sides) {
    ++edges_at[low], ++edges_at[sides.front().high];
    if (sides.size() != 2 || sides[0].sense == sides[1].sense)
      faults.unmatched_sides += sides.size();
    else if (dot(normals[sides[0].triangle], normals[sides[1].triangle]) < kFoldCosine)
      ++faults.folds;
  });
  std::vector<Triangle> sorted = mesh.triangles;
  for (Triangle& t : sorted) std::sort(t.begin(), t.end());
  std::sort(sorted.begin(), sorted.end());
  for (size_t f = 1; f < sorted.size(); ++f) faults.doubled_triangles += sorted[f] == sorted[f - 1];
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    faults.unused_vertices += triangles_at[v] == 0;
    const double length = mesh.normals.empty() ? 0 : std::sqrt(dot(minus(mesh.normals[v], {}), minus(mesh.normals[v], {})));
    faults.wrong_normals += !(std::fabs(length - 1) < 1e-4);
  }
  faults.repeated_positions = mesh.positions.size() - weldedByPosition(mesh).positions.size();

  // A vertex of one fan has as many edges as triangles, and all of these are reached by walking around it.
  std::vector<std::vector<std::pair<uint32_t, uint32_t>>> fan(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) fan[t[k]].emplace_back(t[(k + 1) % 3], t[(k + 2) % 3]);
  for (const auto& around : fan) {
    if (around.empty()) continue;
    size_t steps = 0;
    uint32_t at = around.front().first;
    do {
      const auto next = std::find_if(around.begin(), around.end(), [&](const auto& pair) { return pair.first == at; });
      if (next == around.end()) break;
      at = next->second, ++steps;
    } while (at != around.front().first && steps < around.size());
    faults.pinched_vertices += steps != around.size() || at != around.front().first;
  }
  for (const Shell& shell : shellsOf(mesh)) {
    std::vector<uint32_t> vertices;
    for (const uint32_t f : shell.triangles) vertices.insert(vertices.end(), mesh.triangles[f].begin(), mesh.triangles[f].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const ptrdiff_t euler = ptrdiff_t(vertices.size()) - ptrdiff_t(shell.triangles.size()) / 2;
    faults.odd_parts += shell.triangles.size() % 2 != 0 || euler > 2 || euler % 2 != 0;
  }
  return faults;
}

}  // namespace cloudbake
