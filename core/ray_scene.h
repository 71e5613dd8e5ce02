// The triangles of a mesh in an Embree scene, for casting rays and for finding nearest points.
#pragma once

#include <memory>
#include <span>

#include "core/types.h"

struct RTCDeviceTy;  // Embree's own names: only the .cpp files that query a scene include Embree's header
struct RTCSceneTy;

namespace cloudbake {

/// How many rays a scene is built for. kFew builds it 4 times as fast, and each ray takes a sixth longer (a humilis of 13,000 vertices).
enum class RaysToCome { kFew, kMany };

/// Embree computes in float, so give positions in the shape's frame, in which the longest side is about 1. The scene keeps its own copy.
/// It is built in Embree's robust mode, so that no ray slips through an edge, and a query may use its own filter. Throws
/// std::runtime_error if Embree cannot start, std::bad_alloc if memory runs out.
class RayScene {
 public:
  RayScene(std::span<const Vec3> positions, std::span<const Triangle> triangles, RaysToCome rays = RaysToCome::kMany);
  RTCSceneTy* handle() const { return scene_.get(); }

 private:
  struct Release {
    void operator()(RTCDeviceTy* device) const;
    void operator()(RTCSceneTy* scene) const;
  };
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace cloudbake
