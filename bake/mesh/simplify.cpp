// Edges collapse in order of their error in position and light (bake/mesh/collapse_edges.h).
#include "bake/mesh/simplify.h"

#include "bake/mesh/collapse_edges.h"
#include "bake/mesh/mesh_topology.h"
#include "core/distinct_positions.h"

namespace cloudbake {

std::vector<std::vector<Triangle>> simplified(const SurfaceMesh& mesh, std::span<const Vec3> light, const std::vector<bool>& held,
                                              std::span<const size_t> vertex_counts) {
  constexpr float kMostDistance = 0.03F;  // of the longest side; what is left at seams would otherwise be all that is left
  const float size = boundingBox(mesh).longestSide();
  CollapseInput<6> input;
  input.most_distance = kMostDistance * size;
  input.vertex_count = mesh.positions.size();
  DistinctPositions distinct(mesh.positions.size());
  std::vector<uint32_t> point_of;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    point_of.push_back(distinct.add(mesh.positions[v]));
    if (distinct.positions.size() > input.points.size()) {
      const Vec3 p = mesh.positions[v], l = light[v] * size;
      input.points.push_back({p.x, p.y, p.z, l.x, l.y, l.z});
      input.held.push_back(false);
    }
    if (!held.empty() && held[v]) input.held[point_of[v]] = true;
  }
  for (const Triangle& t : mesh.triangles) {
    const Triangle points{point_of[t[0]], point_of[t[1]], point_of[t[2]]};
    if (hasDistinctCorners(points)) {
      input.triangles.push_back(points), input.corners.push_back(t);
    } else {
      input.kept.push_back(t);
      for (const uint32_t p : points) input.held[p] = true;
    }
  }
  std::vector<std::vector<Triangle>> levels;
  for (CollapsedSurface& level : collapseEdges(std::move(input), vertex_counts)) levels.push_back(std::move(level.triangles));
  return levels;
}

}  // namespace cloudbake
