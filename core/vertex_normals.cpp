// Each triangle's normal is weighted by its angle at the vertex, so that the result does not depend on the tessellation (G. Thürmer,
// C. Wüthrich, "Computing Vertex Normals from Polygonal Facets", JGT 3(1), 1998). Single-precision atan2 gives the same bits on every CPU.
#include "core/vertex_normals.h"

#include <cmath>

namespace cloudbake {

std::vector<Vec3> vertexNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::vector<Vec3> normals(positions.size());
  for (const Triangle& t : triangles) {
    const Vec3 p[3] = {positions[t[0]], positions[t[1]], positions[t[2]]};
    const auto e0 = normalized(p[1] - p[0]), e1 = normalized(p[2] - p[1]), e2 = normalized(p[0] - p[2]);
    if (!e0 || !e1 || !e2) continue;
    const auto normal = normalized(cross(*e0, -*e2));
    if (!normal) continue;
    const auto corner = [](Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)); };
    normals[t[0]] += *normal * corner(*e0, -*e2);
    normals[t[1]] += *normal * corner(*e1, -*e0);
    normals[t[2]] += *normal * corner(*e2, -*e1);
  }
  for (Vec3& normal : normals) normal = normalized(normal).value_or(Vec3{});
  return normals;
}

}  // namespace cloudbake
