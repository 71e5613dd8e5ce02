// Lobe impostors as an engine draws them (shaders/functions/impostor.glsl): the three frames around the eye's direction are read where the
// ray of a pixel meets the surface that the frame's depth describes, and blended.
#pragma once

#include <span>

#include "core/image.h"
#include "core/impostor.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/channels.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {

/// What a ray sees of an impostor, in its own space.
struct ImpostorPoint {
  TexelLobe texel;
  float opacity = 0;
  float distance = 0;  ///< along the ray, in lengths of its direction
};

/// An impostor and where it is seen from, in its own space: the eye must be outside of its ball.
class ImpostorView {
 public:
  ImpostorView(const Impostor& impostor, Vec3 eye);
  /// `direction` need not be a unit vector. `texel_share`: texels of the finest pictures per pixel of the camera, which chooses the mip
  /// level.
  ImpostorPoint at(Vec3 direction, float texel_share) const;

 private:
  struct Frame {
    int i = 0, j = 0;
    float weight = 0;
    FrameAxes axes;
  };
  const Impostor& impostor_;
  Vec3 eye_;  // from the center, in radii
  std::array<Frame, 3> frames_;
};

/// Adds the instances that are impostors to the channels of the others, pixel by pixel, nearer clouds before farther ones. The eye of a
/// camera inside of an impostor's ball does not see it.
void addImpostors(Image4& channels, std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                  const DepthRange& range);

}  // namespace cloudbake
