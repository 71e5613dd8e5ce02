#include "core/sculpt.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/vertex_normals.h"

namespace cloudbake {

bool SculptPart::isMirrored(const Triangle& triangle) const {
  if (vertex_to_scene.empty()) return determinant(to_scene) < 0;
  int mirrored = 0;
  for (const uint32_t v : triangle) mirrored += determinant(vertex_to_scene[v]) < 0;
  return mirrored > 1;
}

std::vector<uint32_t> partsOfVertices(const Sculpt& sculpt) {
  std::vector<uint32_t> parts;
  for (uint32_t i = 0; i < sculpt.parts.size(); ++i) parts.insert(parts.end(), sculpt.parts[i].positions.size(), i);
  return parts;
}

SurfaceMesh surfaceInScene(const Sculpt& sculpt) {
  SurfaceMesh surface;
  for (const SculptPart& part : sculpt.parts) {
    const uint32_t base = uint32_t(surface.positions.size());
    for (size_t v = 0; v < part.positions.size(); ++v) surface.positions.push_back(transformPoint(part.toScene(v), part.positions[v]));
    const bool is_skinned = !part.vertex_to_scene.empty(), mirrored = !is_skinned && determinant(part.to_scene) < 0;
    for (const Triangle& t : part.triangles)
      surface.triangles.push_back((is_skinned ? part.isMirrored(t) : mirrored) ? Triangle{base + t[0], base + t[2], base + t[1]}
                                                                               : Triangle{base + t[0], base + t[1], base + t[2]});

    const std::vector<Vec3> normals = part.normals.empty() ? vertexNormals(part.positions, part.triangles) : part.normals;
    Affine map = normalMap(part.to_scene);
    for (size_t v = 0; v < normals.size(); ++v) {
      if (is_skinned) map = normalMap(part.vertex_to_scene[v]);
      surface.normals.push_back(normalized(transformVector(map, normals[v])).value_or(Vec3{}));
    }
  }
  return surface;
}

std::string frameText(double metres_per_unit, char up, bool up_is_negative, const char* source) {
  return fmt::format("{:g} m per unit, {}{} up ({})", metres_per_unit, up_is_negative ? '-' : '+', up, source);
}

bool isFrameGiven(std::string_view frame_text) {
  const std::string_view source = frame_text.substr(std::min(frame_text.size(), frame_text.find('(')));
  return source.substr(0, source.find(')')).find("given") != std::string_view::npos;
}

}  // namespace cloudbake
