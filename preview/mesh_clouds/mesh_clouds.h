// Mesh clouds as a game draws them: channels at half resolution, the image chain, and the sky behind.
#pragma once

#include <span>

#include "core/image.h"
#include "preview/camera.h"
#include "preview/layer.h"
#include "preview/mesh_clouds/channels.h"
#include "preview/mesh_clouds/lit_mesh.h"
#include "preview/mesh_clouds/post.h"

namespace cloudbake {

/// The settings of every step, in their order.
struct PostSettings {
  ChannelSettings channels;  ///< 1. half resolution
  int divisor = 4;           ///< 2. divides the resolution for the rest of the chain, ≥ 1
  ChannelMean downsample_mean = ChannelMean::kCovered;
  BlurSettings blur;             ///< 3.
  DepthBlurSettings depth_blur;  ///< 4.
  DistortSettings distort;       ///< 5.
  CompositeSettings composite;   ///< 6.
  int sky_samples_per_side = 2;  ///< n·n samples per pixel of the background, ≥ 1
};

/// Sets how means of pixels are taken, in all steps at once.
void setChannelMean(PostSettings& settings, ChannelMean mean);

/// The picture after each step.
struct MeshCloudSteps {
  Image4 drawn, downsampled, blurred, depth_blurred, distorted;
  Image background;
};

/// The whole chain, in linear colours and the camera's size. `light.samples_per_side` and `light.view_extinction` are ignored: `settings`
/// has its own samples, and the chain softens edges. `steps`, if given, receives the results of the steps. Throws as lightMeshes does.
Image renderMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                       const PostSettings& settings = {}, MeshCloudSteps* steps = nullptr);

/// The chain's channels as a layer of the camera's size, for a picture with other things in it: colours without fog, distances along the
/// rays from A between the depths of `range`.
Layer meshCloudLayer(const Image4& channels, const Camera& camera, const DepthRange& range, const SkyColors& colors,
                     ChannelMean mean = ChannelMean::kCovered);

}  // namespace cloudbake
