// Mesh clouds as a game draws them: channels, the image chain, and the sky behind.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/keys.h"
#include "preview/camera.h"
#include "preview/layer.h"
#include "preview/mesh_clouds/channels.h"
#include "preview/mesh_clouds/lit_mesh.h"
#include "preview/mesh_clouds/paint.h"
#include "preview/mesh_clouds/post.h"

namespace cloudbake {

/// The steps before the distortion as they were published, at a half and a quarter of the resolution.
struct PublishedSteps {
  ChannelSettings channels;  ///< 1. half resolution; the depth range is that of PostSettings
  int divisor = 4;           ///< 2. divides the resolution for the rest of the chain, ≥ 1
  ChannelMean downsample_mean = ChannelMean::kCovered;
  BlurSettings blur;             ///< 3.
  DepthBlurSettings depth_blur;  ///< 4.
};
/// Its keys in a scene file.
const Keys<PublishedSteps>& publishedKeys();

/// The settings of the whole chain. All lengths but those of PublishedSteps are in heights of the picture.
struct PostSettings {
  std::optional<PublishedSteps> published;  ///< unset: `painted`
  PaintedSteps painted;                     ///< at the picture's own resolution
  float near_distance = 0;                  ///< where the depth is 0, world units, ≥ 0
  std::optional<float> far_distance;        ///< where it is 1; unset: that of defaultDepthRange
  DistortSettings distort{.tile_size = 0.4F, .swirl_strength = 0.008F};
  CompositeSettings composite{.fog_density = 0.1F, .phase = {.share = 0.45F}};
  int sky_samples_per_side = 2;  ///< n·n samples per pixel of the background, ≥ 1
};
/// Its keys in a scene file.
const Keys<PostSettings>& depthKeys();

/// The chain as it was published.
PostSettings publishedPost();

/// The colours of sky and light for a sun of this height (the sine of its elevation): skyColorsForSun, and if the chain is not the
/// published one, ambient light of this sky, but for colours that the ramp has of its own.
SkyColors skyColorsFor(const PostSettings& settings, float sun_height, const SkyRamp& ramp = defaultSkyRamp());

/// Sets how means of pixels are taken, in all published steps at once.
void setChannelMean(PostSettings& settings, ChannelMean mean);

/// The channels after a step.
struct ChainStep {
  std::string name;
  Image4 channels;
  CloudColors colors{};
};

/// The light with what this chain changes of it: skyColorsFor its sun and ramp, and how much of the light falls by the surface's angle to
/// the sun.
LightSettings lookOf(const PostSettings& settings, LightSettings light);
/// The same of a sun at these angles.
LightSettings lightFor(const PostSettings& settings, float azimuth_degrees, float elevation_degrees);

/// Where the noise at rims is: it moves with the first instance or its field, so that a moved world looks the same, and its cells are a
/// share of the mean longest side.
NoiseFrame noiseFrame(std::span<const Instance> instances, float share);

/// The distances at which the depth of the instances is 0 and 1.
DepthRange depthRangeOf(const PostSettings& settings, std::span<const Instance> instances);

/// Which steps of the chain are of use; kEnds: the first and the last.
enum class StepsKept { kAll, kEnds };

/// The channels after each step of the chain; the first are what was drawn, the last what composite and meshCloudLayer take. If there are
/// lamps, their light goes through the same steps, and so do own colours of clouds, as means over what is covered.
/// `light.samples_per_side` and `light.view_extinction` are ignored: the chain has its own samples and softens edges. Throws as placeMeshes
/// does.
std::vector<ChainStep> drawMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                                      const PostSettings& settings = {}, StepsKept kept = StepsKept::kAll);

/// The sky behind them.
Image drawSky(const Camera& camera, const SkySettings& sky, const PostSettings& settings = {});

/// Mesh clouds before their sky, in linear colours and the camera's size.
Image renderMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                       const PostSettings& settings = {});

/// The chain's channels as a layer of the camera's size, for a picture with other things in it, which composes them as composite does. The
/// distances along the rays are those of the clouds that were drawn at the pixel, from A between the depths of `range`: the steps of the
/// chain mix the depths of clouds that are beside each other. Where none was drawn they are those of `channels`.
Layer meshCloudLayer(const Image4& channels, const Image4& drawn, const Camera& camera, const DepthRange& range, const SkySettings& sky,
                     const CompositeSettings& settings, const CloudColors& colors = {});

}  // namespace cloudbake
