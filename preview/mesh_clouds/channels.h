// Mesh clouds as four channels, which the image chain of preview/mesh_clouds/post.h works on:
//   R = T_lobe(sun)·half-Lambert, G = T_lobe(up), B = opacity, A = depth, 0 near, 1 far and more beyond; (0, 0, 0, 1) where there is no
//   cloud.
#pragma once

#include <optional>
#include <span>

#include "core/image.h"
#include "core/keys.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {

/// The channels where there is no cloud.
constexpr Rgba kNoCloud{0, 0, 0, 1};

/// Columns left … right − 1 of the rows top … bottom − 1.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
  int width() const { return right - left; }
};

/// The smallest box around all pixels that are not kNoCloud, larger by `margin` ≥ 0 pixels on every side, within the image. Where there is
/// nothing but kNoCloud a mean of pixels is kNoCloud too, so that the steps of the chain leave the rest of the picture out.
PixelBox cloudBox(const Image4& channels, float margin);

/// How a mean over places of such an image is taken. B is always the plain mean.
enum class ChannelMean {
  kCovered,  ///< R, G and A over what is covered, that is, weighted by B: rims keep the cloud's colour and depth
  kAll       ///< every place counts, as published: the clear value's black and its depth 1 bleed into rims
};

/// Adds up a mean over places.
class ChannelSum {
 public:
  explicit ChannelSum(ChannelMean mean) : mean_(mean) {}
  void add(const Rgba& channels, float weight) {
    const float counted = mean_ == ChannelMean::kCovered ? weight * channels[2] : weight;
    red_ += counted * channels[0];
    green_ += counted * channels[1];
    depth_ += counted * channels[3];
    counted_ += counted;
    opacity_ += weight * channels[2];
    total_ += weight;
  }
  /// The mean; kNoCloud if nothing counted.
  Rgba value() const {
    if (!(counted_ > 0)) return kNoCloud;
    return {red_ / counted_, green_ / counted_, opacity_ / total_, depth_ / counted_};
  }

 private:
  ChannelMean mean_;
  float red_ = 0, green_ = 0, opacity_ = 0, depth_ = 0, counted_ = 0, total_ = 0;
};

/// Distances from the camera along its view at which A is 0 and 1, world units; near < far. It is that of the scene, as the clipping planes
/// of an engine's camera are: a cloud that moves away goes from A = 0 to 1.
struct DepthRange {
  float near = 0, far = 1;
};

/// So many times as far as a cloud is large, its depth is 1.
inline constexpr float kFarSides = 10;

/// The mean longest side of the instances in the world, of clouds of fields without their horizon; 1 if nothing has a size.
float meanLongestSide(std::span<const Instance> instances);

/// From the camera to kFarSides times the mean longest side.
DepthRange defaultDepthRange(std::span<const Instance> instances);

struct ChannelSettings {
  int divisor = 2;                                       ///< the picture's width and height are divided by this, rounded up; ≥ 1
  int samples_per_side = 2;                              ///< n·n rays per pixel of the channels, ≥ 1
  std::optional<DepthRange> depth_range = std::nullopt;  ///< unset: defaultDepthRange of the instances
};
/// Its keys in a scene file.
const Keys<ChannelSettings>& channelKeys();

/// The nearest surface in the samples of each pixel. B is the fraction of samples that meet a cloud; R, G and A are means over these
/// samples, because a mean over all would darken every rim, here and again in each step that averages pixels. If the divisor does not
/// divide the size, the channels are stretched to the picture's edges. Throws as lightMeshes does.
Image4 renderChannels(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                      const ChannelSettings& settings = {});

/// One channel as a grey picture with unchanged values, for looking at.
Image channelPicture(const Image4& channels, int channel);

}  // namespace cloudbake
