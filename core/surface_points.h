// Places on a mesh between its vertices, and the lobes that an engine has there.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// A place on a triangle.
struct SurfacePoint {
  Triangle corners{};              ///< vertices
  std::array<float, 3> weights{};  ///< of the corners, at least 0; their sum is 1
};

/// `count` points, spread evenly over the surface by area: one in each of `count` stretches of equal area, as the triangles follow each
/// other. The same mesh and count give the same points. Fewer than `count`, or none, only if no triangle has an area.
std::vector<SurfacePoint> spreadOverSurface(const SurfaceMesh& mesh, size_t count);

/// The weighted mean of the corners' values.
Vec3 valueAt(const SurfacePoint& point, std::span<const Vec3> values);
/// The same of normals, of unit length; zero if they cancel out.
Vec3 normalAt(const SurfacePoint& point, std::span<const Vec3> normals);

/// The lobe of a pixel if an engine evaluates the formula there: each of the four floats is blended across the triangle, then decoded.
Lobe blendedLobe(const SurfacePoint& point, std::span<const Lobe> lobes);

/// The transmittance of a pixel if an engine evaluates the formula at the vertices and blends the results.
float blendedTransmittance(const SurfacePoint& point, std::span<const Lobe> lobes, Vec3 to_light, LobeShape shape, float extinction);

}  // namespace cloudbake
