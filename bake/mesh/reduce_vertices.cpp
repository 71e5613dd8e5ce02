// Decimation by quadric error (bake/mesh/collapse_edges.h) of the surface welded by position.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bake/mesh/collapse_edges.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"

namespace cloudbake {

namespace {

// Drops vertices that no triangle uses. The others are stored in the order of their first use.
void dropUnusedVertices(SurfaceMesh& mesh) {
  std::vector<uint32_t> place(mesh.positions.size(), UINT32_MAX);
  std::vector<Vec3> positions;
  for (Triangle& t : mesh.triangles)
    for (uint32_t& v : t) {
      if (place[v] == UINT32_MAX) {
        place[v] = uint32_t(positions.size());
        positions.push_back(mesh.positions[v]);
      }
      v = place[v];
    }
  mesh.positions = std::move(positions);
}

std::string reasonsOf(const CollapseObstacles& obstacles) {
  std::string reasons;
  const auto add = [&](size_t count, const char* reason) {
    if (count > 0) reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", count, reason);
  };
  add(obstacles.fixed, "lie on borders or edges of three and more triangles");
  add(obstacles.topology, "cannot go without closing a handle, or losing or joining parts");
  add(obstacles.shape, "cannot go without folding the surface");
  return reasons;
}

}  // namespace

void reduceVertices(SurfaceMesh& mesh, size_t target_count, Warnings& warnings) {
  mesh = weldedByPosition(mesh);
  std::erase_if(mesh.triangles, [](const Triangle& t) { return !hasDistinctCorners(t); });
  dropUnusedVertices(mesh);
  if (mesh.positions.size() <= target_count) return;
  CollapseInput<3> input;
  for (const Vec3& p : mesh.positions) input.points.push_back({p.x, p.y, p.z});
  input.triangles = std::move(mesh.triangles);
  CollapsedSurface reduced = std::move(collapseEdges(std::move(input), std::array{target_count}).front());
  mesh.triangles = std::move(reduced.triangles);
  dropUnusedVertices(mesh);
  if (reduced.used > target_count)
    warnings.add(WarningKind::kVertexBudget,
                 fmt::format("{} vertices are left instead of {}: {}", reduced.used, target_count, reasonsOf(reduced.obstacles)));
}

}  // namespace cloudbake
