// Each triangle's normal is weighted by its angle at the vertex, so that the result does not depend on the tessellation (G. Thürmer,
// C. Wüthrich, "Computing Vertex Normals from Polygonal Facets", JGT 3(1), 1998). Where a fold lets these cancel, the weights are areas,
// whose sum is that of what lies around the fold. Single-precision atan2 gives the same bits on every CPU.
#include "core/vertex_normals.h"

#include <algorithm>
#include <cmath>

namespace cloudbake {

namespace {

constexpr float kCancelled = 1e-4F;  // of the sum of the weights

// Sums of normals weighted by area, for the vertices marked.
std::vector<Vec3> areaNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles, const std::vector<bool>& marked) {
  std::vector<Vec3> sums(positions.size());
  std::vector<float> areas(positions.size());
  for (const Triangle& t : triangles)
    for (size_t corner = 0; corner < 3; ++corner) {
      if (!marked[t[corner]]) continue;
      const Vec3 area = cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
      sums[t[corner]] += area, areas[t[corner]] += length(area);
    }
  for (size_t v = 0; v < sums.size(); ++v)
    if (!(length(sums[v]) > kCancelled * areas[v])) sums[v] = {};
  return sums;
}

}  // namespace

std::vector<Vec3> vertexNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::vector<Vec3> normals(positions.size());
  std::vector<float> angles(positions.size());
  for (const Triangle& t : triangles) {
    const Vec3 p[3] = {positions[t[0]], positions[t[1]], positions[t[2]]};
    const auto e0 = normalized(p[1] - p[0]), e1 = normalized(p[2] - p[1]), e2 = normalized(p[0] - p[2]);
    if (!e0 || !e1 || !e2) continue;
    const auto normal = normalized(cross(*e0, -*e2));
    if (!normal) continue;
    const auto add = [&](uint32_t vertex, Vec3 a, Vec3 b) {
      const float angle = std::atan2(length(cross(a, b)), dot(a, b));
      normals[vertex] += *normal * angle;
      angles[vertex] += angle;
    };
    add(t[0], *e0, -*e2);
    add(t[1], *e1, -*e0);
    add(t[2], *e2, -*e1);
  }
  std::vector<bool> cancelled(positions.size());
  for (size_t v = 0; v < normals.size(); ++v) cancelled[v] = angles[v] > 0 && !(length(normals[v]) > kCancelled * angles[v]);
  if (std::find(cancelled.begin(), cancelled.end(), true) != cancelled.end()) {
    const std::vector<Vec3> others = areaNormals(positions, triangles, cancelled);
    for (size_t v = 0; v < normals.size(); ++v)
      if (others[v] != Vec3{}) normals[v] = others[v];
  }
  for (Vec3& normal : normals) normal = normalized(normal).value_or(Vec3{});
  return normals;
}

}  // namespace cloudbake
