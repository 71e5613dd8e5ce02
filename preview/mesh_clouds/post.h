// The image chain of mesh clouds, with a pure function per step, on the channels of preview/mesh_clouds/channels.h (R sun, G sky, B
// opacity, A depth). Beyond the border the outermost pixels are repeated. Every step gives the same bytes for any number of threads.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image.h"
#include "core/keys.h"
#include "preview/backdrop/noise.h"
#include "preview/backdrop/sky.h"
#include "preview/camera.h"
#include "preview/layer.h"
#include "preview/mesh_clouds/channels.h"

namespace cloudbake {

/// The image at another size. Each pixel is a bilinear mean of four about its centre; at exactly half the size, the mean of 2×2 pixels.
Image4 resampleBilinear(const Image4& image, int width, int height, ChannelMean mean = ChannelMean::kCovered);

/// The channels at the size of a picture: themselves if they have it, else resampleBilinear into `resampled`.
const Image4& atSize(const Image4& channels, int width, int height, ChannelMean mean, Image4& resampled);

/// A Gaussian of 7 taps. s depends on the depth of the resulting pixel: near clouds blur more, and nothing changes where A is 1, which is
/// behind the last cloud or where there is none. At s = 10 the 7 taps are nearly a box.
struct BlurSettings {
  float near_sigma = 10, far_sigma = 0.1F;  ///< s at A = 0 and from A = 1 on, pixels, > 0
  bool as_quoted = false;                   ///< weights exp(−2x²/s²), from rcp(−0.5 s²), instead of exp(−x²/(2 s²))
  ChannelMean mean = ChannelMean::kCovered;
};
/// Its keys in a scene file.
const Keys<BlurSettings>& blurKeys();

/// R, G and B blurred horizontally, then vertically. A does not change.
Image4 blurByDepth(const Image4& image, const BlurSettings& settings = {});

struct DepthBlurSettings {
  int radius = 4;  ///< pixels, ≥ 0; 0: no change. The default is about as far as the default distortion moves a near rim
  int shrink = 0;  ///< pixels, ≥ 0: B becomes its least value here and at the eight places so far away; the re-implementation has 2
  /// kCovered: a cloud's depth extends `radius` beyond it, so that fog and distortion at its rim are its own.
  ChannelMean mean = ChannelMean::kCovered;
};
/// Its keys in a scene file.
const Keys<DepthBlurSettings>& depthBlurKeys();

/// The mean of A over the square of side 2·radius + 1, and the least B of `shrink`. R and G do not change.
Image4 blurDepth(const Image4& image, const DepthBlurSettings& settings = {});

/// The noise of the flow, with its cells per tile as period: four cells give about two whirls across, and the second octave, with a
/// derivative nearly as large, frays them. Its slope is under kTypicalSlope at 19 places of 20.
inline constexpr FbmSettings kSwirlNoise{.octaves = 2, .gain = 0.4F, .period = 4};
inline constexpr float kTypicalSlope = 2;

/// Stirs the picture by a tiling noise that drifts. Lengths are in heights of the picture, so that its size does not matter. The published
/// shader moves the noise by the time times swirl_speed, and the far noise by half of that.
struct DistortSettings {
  float tile_size = 0.8F;        ///< of the near noise, > 0
  float far_tiles = 4;           ///< tiles of the far noise per tile of the near noise, > 0
  float swirl_strength = 0.03F;  ///< about how far the near noise moves a pixel in one cycle, ≥ 0; 0 = no change
  float far_strength = 0.25F;    ///< of the far noise, relative to that, ≥ 0; 1/far_tiles keeps the shape of the swirls
  float swirl_speed = 0.1F;      ///< cycles per second
  Vec2 near_drift{1, 0};         ///< how far the near noise moves to the right and up in one cycle, near tiles
  Vec2 far_drift{0.5F, 0};       ///< how far the far noise moves, near tiles
  /// R and G are multiplied by lerp(dark, 1, n·m) with the values n and m of a near and a far noise, 0 … 1; 1 = no change. The
  /// re-implementation maajor/Mesh-Cloud-Rendering has 0.8.
  float dark = 1;
  double time_seconds = 0;
  uint32_t seed = 0;
  ChannelMean mean = ChannelMean::kCovered;
};
/// Its keys in a scene file.
const Keys<DistortSettings>& distortKeys();

/// How far both noises have moved to the right and up, in tiles of their own, without the whole ones: 0 … 1.
struct NoiseDrift {
  Vec2 near, far;
};
NoiseDrift noiseDrift(const DistortSettings& settings);

/// The cycles after which the swirls are as they were: a half if nothing drifts, as the two phases have swapped then, or as many more as
/// both noises need to move by whole tiles. None if they need more than 16 cycles.
std::optional<double> cyclesOfLoop(const DistortSettings& settings);

/// How far the noise moves a point in one cycle, relative to the strength; it is under 1 except at rare places. It has no divergence, so
/// that it stirs and never gathers. `tiles` counts tiles of the near noise from the picture's corner; 0 ≤ depth ≤ 1 mixes the near and the
/// far noise, both where they are at the settings' time.
Vec2 swirlFlow(Vec2 tiles, float depth, const DistortSettings& settings);

/// The factor of R and G at a place, which counts like that of swirlFlow.
float darkness(Vec2 tiles, const DistortSettings& settings);

/// The two phases of a moment, half a cycle apart, and the weight of the second. Each has the weight 0 where it starts again.
struct FlowPhases {
  float first = 0, second = 0;  ///< 0 … 1
  float second_weight = 0;      ///< 0 … 1
};
FlowPhases flowPhases(double time_seconds, float swirl_speed);

/// Each pixel is the mean of the two phases, each moved by the flow.
Image4 distort(const Image4& image, const DistortSettings& settings = {});

/// How strongly clouds scatter forwards, so that they shine around the sun. The sun's term is multiplied by
/// 1 + share·(min(p, limit) − 1), with p = henyeyGreenstein(cos θ, g) for the angle θ between the view and the direction to the sun.
struct PhaseSettings {
  float share = 0;         ///< 0 … 1; 0: every direction alike
  float asymmetry = 0.7F;  ///< g, 0 … < 1
  float limit = 6;         ///< > 0
};
/// Its keys in a scene file.
const Keys<PhaseSettings>& phaseKeys();

/// The factor of the sun's term. Unit vectors.
float phaseFactor(Vec3 view, Vec3 to_sun, const PhaseSettings& settings);

/// What a sky sends to clouds.
struct CloudLight {
  SkyColors colors;  ///< lightColors
  Vec3 to_light;     ///< unit, towards the key light
};
CloudLight cloudLight(const SkySettings& sky);

/// The colour of a cloud's channels seen along `view`: cloudColor with the term of the key light times phaseFactor.
Vec3 lightOfCloud(const Rgba& channels, Vec3 view, const CloudLight& light, const PhaseSettings& settings);

/// Colours that went through the same steps as the channels of sun and sky and have their opacity and depth: red and green, and blue, in R
/// and G of two images. Empty if there are none.
using ColorChannels = std::vector<Image4>;

/// What a cloud has beside the light of sun and sky.
struct CloudColors {
  ColorChannels lamps;  ///< the light of lamps
  ColorChannels own;    ///< the clouds' own colours; empty: white
};

struct CompositeSettings {
  float fog_density = 0.2F;  ///< of the fog's 1 − exp(−density·A), ≥ 0; 0 = no fog
  ChannelMean mean = ChannelMean::kCovered;
  PhaseSettings phase = {};
  std::optional<Vec3> fog_color = std::nullopt;  ///< linear; unset: the sky's horizon
  FogScatter scatter = {};
};
/// Its keys in a scene file.
const Keys<CompositeSettings>& chainFogKeys();

/// lightOfCloud and the light of lamps, times the cloud's own colour, faded by the fog of its depth.
Vec3 foggedCloud(const Rgba& channels, Vec3 view, const CloudLight& light, const CompositeSettings& settings, Vec3 lamps = {},
                 Vec3 own = {1, 1, 1});

/// Reads colours at the pixels of a picture.
class ColorPixels {
 public:
  /// `colors` must outlive this; if they are empty, each pixel is `otherwise`.
  ColorPixels(const ColorChannels& colors, int width, int height, ChannelMean mean, Vec3 otherwise);
  Vec3 at(int x, int y) const {
    if (!red_green_) return otherwise_;
    const Rgba& p = red_green_->at(x, y);
    return {p[0], p[1], blue_->at(x, y)[0]};
  }

 private:
  Image4 resampled_[2];
  const Image4 *red_green_ = nullptr, *blue_ = nullptr;
  Vec3 otherwise_;
};

/// foggedCloud over the background by B, as composeLayers puts it there. The channels may be smaller than the
/// background, which has the camera's size: they are read bilinearly at its pixels. Where B is 0, the background stays exactly the same.
Image composite(const Image4& channels, const Image& background, const Camera& camera, const SkySettings& sky,
                const CompositeSettings& settings = {}, const CloudColors& colors = {});

}  // namespace cloudbake
