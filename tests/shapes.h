// Analytic shapes for tests: closed meshes with outward triangles, and what is known of them in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "core/types.h"

namespace cloudbake {

/// Icosphere with normals: every vertex on the sphere, #V = 10·4^n + 2.
inline SurfaceMesh ballMesh(float radius, int subdivisions, Vec3 center = {}) {
  const float g = 1.618033989F;
  SurfaceMesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middle_of;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [found, is_new] = middle_of.try_emplace(std::minmax(a, b), uint32_t(mesh.positions.size()));
      if (is_new) mesh.positions.push_back(0.5F * (mesh.positions[a] + mesh.positions[b]));
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
    for (Vec3& p : mesh.positions) p = *normalized(p);
  }
  for (Vec3& p : mesh.positions) {
    mesh.normals.push_back(*normalized(p));
    p = center + radius * mesh.normals.back();
  }
  return mesh;
}

/// Torus around the y axis, with normals: `major_radius` from the axis to the middle of the tube, `minor_radius` of the tube.
inline SurfaceMesh torusMesh(float major_radius, float minor_radius, int segments_major, int segments_minor) {
  SurfaceMesh mesh;
  for (int i = 0; i < segments_major; ++i)
    for (int j = 0; j < segments_minor; ++j) {
      const float u = float(2 * kPi) * float(i) / float(segments_major), v = float(2 * kPi) * float(j) / float(segments_minor);
      const Vec3 normal{std::cos(v) * std::cos(u), std::sin(v), std::cos(v) * std::sin(u)};
      mesh.normals.push_back(normal);
      mesh.positions.push_back(Vec3{major_radius * std::cos(u), 0, major_radius * std::sin(u)} + minor_radius * normal);
    }
  const auto at = [&](int i, int j) { return uint32_t((i % segments_major) * segments_minor + j % segments_minor); };
  for (int i = 0; i < segments_major; ++i)
    for (int j = 0; j < segments_minor; ++j) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  return mesh;
}

/// Axis-aligned box of 8 vertices, without normals.
inline SurfaceMesh boxMesh(Vec3 low, Vec3 high) {
  SurfaceMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// What a vertex of a ball must carry: o = inward normal, d = 2R. Not for the centre, which has no direction.
inline Lobe ballLobe(Vec3 point, Vec3 center, float radius) { return {*normalized(center - point), 2 * radius}; }

/// A ball with its lobes, as the bake would store it: σ = 7 / diameter.
inline BakedMesh bakedBall(float radius = 1, Vec3 center = {}, int subdivisions = 5) {
  BakedMesh ball;
  ball.surface = ballMesh(radius, subdivisions, center);
  for (const Vec3& p : ball.surface.positions) ball.lobes.push_back(ballLobe(p, center, radius));
  ball.info.extinction = 7 / (2 * radius);
  ball.info.shape = {3, -0.003F * 2 * radius};
  return ball;
}

/// Turns a mesh inside out: triangles and normals.
inline void reverse(SurfaceMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  for (Vec3& n : mesh.normals) n = -n;
}

/// Both meshes as one, `a` first; with normals where both have them.
inline SurfaceMesh merged(SurfaceMesh a, const SurfaceMesh& b) {
  const bool has_normals = a.normals.size() == a.positions.size() && b.normals.size() == b.positions.size();
  const auto offset = uint32_t(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  if (!has_normals) a.normals.clear();
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + offset, j + offset, k + offset});
  return a;
}

}  // namespace cloudbake
