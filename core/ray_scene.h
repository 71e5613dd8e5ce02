// The triangles of a mesh, prepared for casting rays and for finding nearest places: by Embree or, in a portable build, by TriangleTree.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/ray_hit.h"
#include "core/types.h"

namespace cloudbake {

/// How many rays a scene is built for. With kFew, Embree builds it 4 times as fast, and each ray takes a sixth longer (a humilis of 13,000
/// vertices).
enum class RaysToCome { kFew, kMany };

/// Rays are computed in float, so give positions in the shape's frame, in which the longest side is about 1. The scene keeps its own copy.
/// No ray slips through an edge. A triangle with a corner that is not finite is never met. Any thread may ask.
class RayScene {
 public:
  /// Indices must be in range. Throws std::runtime_error if Embree cannot start, std::bad_alloc if memory runs out.
  RayScene(std::span<const Vec3> positions, std::span<const Triangle> triangles, RaysToCome rays = RaysToCome::kMany);
  ~RayScene();

  /// Calls visit for every triangle that the ray meets, in no particular order. A ray through an edge may meet both triangles of the edge.
  void forHits(const Ray& ray, HitVisit visit) const;
  /// Appends to hits[i] what the i-th of at most kRaysTogether rays from one place meets, without triangles in whose plane it lies. The
  /// rays are cast faster if their directions are near each other.
  void addHits(Vec3 origin, std::span<const Vec3> directions, std::span<std::vector<RayHit>> hits) const;
  /// Calls visit for triangles whose boxes touch the ball around a point, whose radius is infinite at first and then what visit returns:
  /// for every triangle that touches the last ball, and for some that do not.
  void forTrianglesNear(Vec3 point, NearVisit visit) const;

  /// What answers.
#ifdef CLOUDBAKE_PORTABLE
  static constexpr const char* kName = "cloudbake tree";
#else
  static constexpr const char* kName = "Embree";
#endif

 private:
  struct Scene;
  std::unique_ptr<const Scene> scene_;
};

}  // namespace cloudbake
