// A bounding-volume hierarchy of triangles, with no library: for casting rays and for finding nearest places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ray_hit.h"
#include "core/types.h"

namespace cloudbake {

/// What RayScene is in a portable build. It computes in float, but which triangles a ray meets is exact: a line through an edge or a corner
/// of a closed mesh meets as many triangles from outside as from inside, and no triangle of an edge twice. Any thread may ask.
class TriangleTree {
 public:
  /// Indices must be in range. A triangle with a corner that is not finite, or beyond 1.8e18, is never met. The same mesh makes the same
  /// tree with any number of threads.
  TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  ~TriangleTree();

  /// Calls visit for every triangle that the ray meets, in no particular order. A ray that is not finite or has no direction meets none.
  void forHits(const Ray& ray, HitVisit visit) const;
  /// Appends to hits[i] what the i-th of at most kRaysTogether rays from one place meets.
  void addHits(Vec3 origin, std::span<const Vec3> directions, std::span<std::vector<RayHit>> hits) const;
  /// Calls visit for triangles whose boxes touch the ball around a point, whose radius is infinite at first and then what visit returns:
  /// for every triangle that touches the last ball, and for some that do not. The near ones come early.
  void forTrianglesNear(Vec3 point, NearVisit visit) const;

  /// Nodes on the longest way down, at most kMostDepth.
  size_t depth() const { return depth_; }
  static constexpr size_t kMostDepth = 41;

 private:
  struct Node;
  struct Leaf;
  class Builder;
  class Cast;
  template <typename Visit>
  void castTogether(std::span<const Cast> casts, const Visit& visit) const;
  std::vector<Node> nodes_;  ///< the first one is the root
  std::vector<Leaf> leaves_;
  Vec3 reach_;  ///< the largest magnitude of the coordinates, by axis
  size_t depth_ = 0;
};

}  // namespace cloudbake
