#include "core/sculpt.h"

#include <fmt/format.h>

#include "core/vertex_normals.h"

namespace cloudbake {

SurfaceMesh surfaceInScene(const Sculpt& sculpt) {
  SurfaceMesh surface;
  for (const SculptPart& part : sculpt.parts) {
    const uint32_t base = uint32_t(surface.positions.size());
    const bool mirrored = determinant(part.to_scene) < 0;
    for (const Vec3 p : part.positions) surface.positions.push_back(transformPoint(part.to_scene, p));
    for (const Triangle& t : part.triangles)
      surface.triangles.push_back(mirrored ? Triangle{base + t[0], base + t[2], base + t[1]}
                                           : Triangle{base + t[0], base + t[1], base + t[2]});

    // Normals are transformed by the inverse transpose.
    const auto from_scene = inverted(part.to_scene);
    const std::vector<Vec3> normals = part.normals.empty() ? vertexNormals(part.positions, part.triangles) : part.normals;
    for (const Vec3 n : normals) {
      Affine transpose;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) transpose.linear[r][c] = from_scene ? from_scene->linear[c][r] : transpose.linear[r][c];
      surface.normals.push_back(normalized(transformVector(transpose, n)).value_or(Vec3{}));
    }
  }
  return surface;
}

std::string frameText(double metres_per_unit, char up, bool up_is_negative, const char* source) {
  return fmt::format("{:g} m per unit, {}{} up ({})", metres_per_unit, up_is_negative ? '-' : '+', up, source);
}

}  // namespace cloudbake
