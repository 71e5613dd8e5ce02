// Measures how far a new surface lies from the one that it replaces.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/figures.h"
#include "core/surface_points.h"
#include "core/types.h"

namespace cloudbake {

/// Finds the nearest places of a surface, for many questions.
class NearestSurface {
 public:
  virtual ~NearestSurface() = default;
  /// Exact distances of another surface's vertices and triangle centres to the nearest triangle, as fractions of this surface's longest
  /// side. The distances are one-way: a part of this surface that the other one lacks is not noticed.
  virtual SurfaceError errorOf(const SurfaceMesh& now) const = 0;
  /// The exactly nearest place for each position.
  virtual std::vector<SurfacePoint> nearestTo(std::span<const Vec3> positions) const = 0;
  /// The same among triangles that face to the side of each position's normal; among all where none does.
  virtual std::vector<SurfacePoint> nearestFacing(std::span<const Vec3> positions, std::span<const Vec3> normals) const = 0;
};

/// The surface must have a triangle, and outlive what is returned.
std::unique_ptr<const NearestSurface> nearestSurface(const SurfaceMesh& surface);

}  // namespace cloudbake
