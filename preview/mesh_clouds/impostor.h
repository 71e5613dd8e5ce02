// Lobe impostors as an engine draws them (shaders/functions/impostor.glsl): the three frames around the eye's direction are read where the
// ray of a pixel meets the surface that the frame's depth describes, and blended.
#pragma once

#include <span>

#include "core/function_ref.h"
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

/// The place in an atlas that one of the three frames has for a ray.
struct AtlasPlace {
  const FrameAxes& axes;
  float u = 0, v = 0;  ///< of the atlas, 0 … 1
  float level = 0;     ///< mip level
  Vec3 rest;           ///< of Impostor::rest there
  float weight = 0;    ///< of the frame times the opacity
  float distance = 0;  ///< along the ray, in radii and lengths of its direction
};

/// A picture of an atlas as GPUs filter it: linearly between texels and between mip levels.
Vec3 filtered(const std::vector<Image>& levels, float u, float v, float level);

/// An impostor and where it is seen from, in its own space: the eye must be outside of its ball.
class ImpostorView {
 public:
  ImpostorView(const Impostor& impostor, Vec3 eye);
  /// `direction` need not be a unit vector. `texel_share`: texels of the finest pictures per pixel of the camera, which chooses the mip
  /// level.
  ImpostorPoint at(Vec3 direction, float texel_share) const;
  /// Calls visit for each frame in which the ray sees something.
  void forFrames(Vec3 direction, float texel_share, FunctionRef<void(const AtlasPlace&)> visit) const;

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

/// The light of a cloud at a pixel, and its opacity.
struct QuadPoint {
  Shade shade;
  float opacity = 0;
};
/// A picture over the sky as an engine draws a quad, with one sample per pixel; `at` gives what a ray of the camera sees. Linear colours.
Image renderQuad(const Camera& camera, const LightSettings& light, FunctionRef<QuadPoint(Vec3 direction)> at);
/// The impostor in its own space, lit by sun and sky without a factor of the surface.
Image renderImpostor(const Impostor& impostor, const Camera& camera, const LightSettings& light);

/// Adds the instances that are impostors to the channels of the others, pixel by pixel, nearer clouds before farther ones. The eye of a
/// camera inside of an impostor's ball does not see it.
void addImpostors(Image4& channels, std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                  const DepthRange& range);

}  // namespace cloudbake
