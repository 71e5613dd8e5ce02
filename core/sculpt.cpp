#include "core/sculpt.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
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
  constexpr size_t kGrain = 1 << 14;
  SurfaceMesh surface;
  size_t vertices = 0, triangles = 0;
  for (const SculptPart& part : sculpt.parts) vertices += part.positions.size(), triangles += part.triangles.size();
  surface.positions.resize(vertices), surface.normals.resize(vertices), surface.triangles.resize(triangles);
  size_t first_triangle = 0;
  for (uint32_t base = 0; const SculptPart& part : sculpt.parts) {
    const bool is_skinned = !part.vertex_to_scene.empty(), mirrored = !is_skinned && determinant(part.to_scene) < 0;
    parallelBlocks(part.triangles.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f) {
        const Triangle& t = part.triangles[f];
        const bool is_turned = is_skinned ? part.isMirrored(t) : mirrored;
        surface.triangles[first_triangle + f] = {base + t[0], base + t[is_turned ? 2 : 1], base + t[is_turned ? 1 : 2]};
      }
    });
    const bool has_normals = part.normals.size() == part.positions.size();
    const std::vector<Vec3> computed = has_normals ? std::vector<Vec3>() : vertexNormals(part.positions, part.triangles);
    const std::vector<Vec3>& normals = has_normals ? part.normals : computed;
    parallelBlocks(part.positions.size(), kGrain, [&](size_t begin, size_t end) {
      Affine map = normalMap(part.to_scene);
      for (size_t v = begin; v < end; ++v) {
        if (is_skinned) map = normalMap(part.vertex_to_scene[v]);
        surface.positions[base + v] = transformPoint(part.toScene(v), part.positions[v]);
        surface.normals[base + v] = transformVector(map, normals[v]);
      }
      // In a loop of its own, because GCC 12 at -O3 leaves out the rounding to float of what goes on in double.
      for (size_t v = begin; v < end; ++v) surface.normals[base + v] = normalized(surface.normals[base + v]).value_or(Vec3{});
    });
    base += uint32_t(part.positions.size());
    first_triangle += part.triangles.size();
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
