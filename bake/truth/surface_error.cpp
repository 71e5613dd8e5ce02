// RayScene finds the triangles whose boxes touch the ball around a point. The ball shrinks to the smallest distance so far, which is
// computed in double. Everything is in the surface's frame, with longest side 1, so that no size is too small or too large for floats.
#include "bake/truth/surface_error.h"

#include <openvdb/math/Proximity.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bake/mesh/mesh_topology.h"
#include "core/parallel.h"
#include "core/ray_scene.h"

namespace cloudbake {

namespace {

openvdb::Vec3d wide(Vec3 p) { return {p.x, p.y, p.z}; }

std::vector<Vec3> inFrame(std::span<const Vec3> positions, const Box& box) {
  std::vector<Vec3> result;
  for (const Vec3& p : positions) result.push_back((p - box.center()) / box.longestSide());
  return result;
}

class NearestTriangle : public NearestSurface {
 public:
  explicit NearestTriangle(const SurfaceMesh& surface)
      : frame_(boundingBox(surface)),
        positions_(inFrame(surface.positions, frame_)),
        triangles_(surface.triangles),
        scene_(positions_, triangles_, RaysToCome::kFew) {
    for (const auto& [a, b, c] : triangles_) {
      const Vec3 middle = (positions_[a] + positions_[b] + positions_[c]) / 3;
      const float radius = std::max({length(positions_[a] - middle), length(positions_[b] - middle), length(positions_[c] - middle)});
      balls_.push_back({middle, radius + kRounding});
    }
  }

  SurfaceError errorOf(const SurfaceMesh& now) const override {
    std::vector<Vec3> samples = inFrame(now.positions, frame_);
    const std::vector<Vec3> corners = samples;
    for (const auto& [a, b, c] : now.triangles) samples.push_back((corners[a] + corners[b] + corners[c]) / 3);

    std::vector<double> distances(samples.size());
    parallelFor(samples.size(), [&](size_t i) { distances[i] = nearestTo(samples[i]).distance; });
    SurfaceError error;
    for (const double d : distances) {
      error.rms += d * d;
      error.largest = std::max(error.largest, d);
    }
    error.rms = std::sqrt(error.rms / double(std::max<size_t>(1, distances.size())));
    return error;
  }

  std::vector<SurfacePoint> nearestTo(std::span<const Vec3> positions) const override {
    const std::vector<Vec3> queries = inFrame(positions, frame_);
    std::vector<SurfacePoint> points(queries.size());
    parallelFor(queries.size(), [&](size_t i) { points[i] = nearestTo(queries[i]).point; });
    return points;
  }

  std::vector<SurfacePoint> nearestFacing(std::span<const Vec3> positions, std::span<const Vec3> normals) const override {
    const std::vector<Vec3> queries = inFrame(positions, frame_);
    std::vector<SurfacePoint> points(queries.size());
    parallelFor(queries.size(), [&](size_t i) {
      Found found = nearestTo(queries[i], normals[i]);
      points[i] = (found.distance < INFINITY ? found : nearestTo(queries[i])).point;
    });
    return points;
  }

 private:
  struct Found {
    double distance = INFINITY;
    SurfacePoint point;
  };
  Found nearestTo(Vec3 at, std::optional<Vec3> facing = std::nullopt) const {
    const openvdb::Vec3d point = wide(at);
    double least = INFINITY;  // squared
    Found found;
    scene_.forTrianglesNear(at, [&](uint32_t triangle, float radius) {
      const Ball& ball = balls_[triangle];
      const float reach = ball.radius + radius;
      if (dot(ball.middle - at, ball.middle - at) > reach * reach * (1 + kRounding)) return radius;
      const auto& [a, b, c] = triangles_[triangle];
      if (facing && !(dot(cross(positions_[b] - positions_[a], positions_[c] - positions_[a]), *facing) > 0)) return radius;
      openvdb::Vec3d weights;
      const openvdb::Vec3d nearest =
          openvdb::math::closestPointOnTriangleToPoint(wide(positions_[a]), wide(positions_[b]), wide(positions_[c]), point, weights);
      const double squared = (nearest - point).lengthSqr();
      if (!(squared < least)) return radius;
      least = squared;
      found.point = {{a, b, c}, {float(weights[0]), float(weights[1]), float(weights[2])}};
      return std::nextafter(float(std::sqrt(squared)), INFINITY);
    });
    found.distance = std::sqrt(least);
    return found;
  }

  // Around a triangle, so that most of those that are too far away need no exact distance.
  struct Ball {
    Vec3 middle;
    float radius = 0;
  };
  static constexpr float kRounding = 1e-5F;

  Box frame_;
  std::vector<Vec3> positions_;
  const std::vector<Triangle>& triangles_;
  std::vector<Ball> balls_;
  RayScene scene_;
};

}  // namespace

std::unique_ptr<const NearestSurface> nearestSurface(const SurfaceMesh& surface) { return std::make_unique<NearestTriangle>(surface); }

}  // namespace cloudbake
