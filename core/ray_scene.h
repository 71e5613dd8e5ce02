// The triangles of a mesh in an Embree scene: for rays and for nearest points.
#pragma once

#include <memory>
#include <span>

#include "core/types.h"

struct RTCDeviceTy;  // Embree's own names: only the .cpp files that ask a scene include its header
struct RTCSceneTy;

namespace cloudbake {

/// Embree computes in float: give positions in a frame of the shape, whose longest side is about 1. The scene keeps its own copy. Its rays
/// hit edges from both sides (robust), and a query may bring a filter of its own. Throws std::runtime_error where Embree cannot start,
/// std::bad_alloc where memory is short.
class RayScene {
 public:
  RayScene(std::span<const Vec3> positions, std::span<const Triangle> triangles);
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
