// The order of the steps is that of "Volumetric Clouds and Mega-Particles" and of "On Mesh Cloud Rendering" (2019-06-30), after Sea of
// Thieves: draw at half resolution, downsample to a quarter, blur by depth, blur the depth, distort, composite.
#include "preview/mesh_clouds/mesh_clouds.h"

#include <array>
#include <utility>

#include "core/parallel.h"
#include "preview/mesh_clouds/impostor.h"
#include "preview/mesh_clouds/raster.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// The steps of a chain, each made from the one before.
class Chain {
 public:
  Chain(Image4 drawn, StepsKept kept) : kept_(kept) { steps_.push_back({"drawn", std::move(drawn)}); }

  // Appends what `make` makes of the last step.
  template <typename Make>
  void add(const std::string& name, const Make& make) {
    Image4& last = steps_.back().channels;
    const bool replaces = kept_ == StepsKept::kEnds && steps_.size() > 1;
    ChainStep next{name, replaces ? make(std::move(last)) : make(last)};
    if (replaces) steps_.pop_back();
    steps_.push_back(std::move(next));
  }
  std::vector<ChainStep> steps() && { return std::move(steps_); }

 private:
  StepsKept kept_;
  std::vector<ChainStep> steps_;
};

Chain publishedChain(std::span<const Instance> instances, const Camera& camera, const LightSettings& light, const PublishedSteps& settings,
                     const DepthRange& range, StepsKept kept) {
  ChannelSettings channels = settings.channels;
  channels.depth_range = range;
  Image4 drawn = renderChannels(instances, camera, light, channels);
  addImpostors(drawn, instances, camera, light, range);
  Chain chain(std::move(drawn), kept);
  const int width = (camera.width + settings.divisor - 1) / settings.divisor,
            height = (camera.height + settings.divisor - 1) / settings.divisor;
  chain.add("downsampled", [&](const Image4& last) { return resampleBilinear(last, width, height, settings.downsample_mean); });
  chain.add("blurred", [&](const Image4& last) { return blurByDepth(last, settings.blur); });
  chain.add("depth_blurred", [&](const Image4& last) { return blurDepth(last, settings.depth_blur); });
  return chain;
}

Chain paintedChain(std::span<const Instance> instances, const Camera& camera, const LightSettings& light, const PaintedSteps& settings,
                   const DepthRange& range, StepsKept kept) {
  Image4 drawn = rasterChannels(placeMeshes(instances, light), camera, range);
  addImpostors(drawn, instances, camera, light, range);
  Chain chain(std::move(drawn), kept);
  chain.add("depth_spread", [&](Image4 last) { return spreadDepth(std::move(last), settings.depth_spread); });
  chain.add("softened", [&](Image4 last) { return soften(std::move(last), settings.soften); });
  return chain;
}

}  // namespace

NoiseFrame noiseFrame(std::span<const Instance> instances, float share) {
  if (instances.empty()) return {};
  const Instance& first = instances.front();
  const auto& offset = first.to_world.offset;
  const Vec3 origin = first.scattered ? first.scattered->field.center() + first.scattered->wind
                                      : Vec3{float(offset[0]), float(offset[1]), float(offset[2])};
  return {origin, share * meanLongestSide(instances)};
}

SkyColors skyColorsFor(const PostSettings& settings, float sun_height, const SkyRamp& ramp) {
  const SkyColors own = skyColorsForSun(sun_height, ramp);
  if (settings.published) return own;
  SkyColors colors = withAmbientOfSky(own, sun_height);
  if (ramp.own_ground) colors.ground = own.ground;
  if (ramp.own_ambient_sky) colors.ambient_sky = own.ambient_sky;
  if (ramp.own_ambient_ground) colors.ambient_ground = own.ambient_ground;
  return colors;
}

LightSettings lookOf(const PostSettings& settings, LightSettings light) {
  light.sky.colors = skyColorsFor(settings, light.sky.to_sun.y, light.sky.ramp);
  // Both are measured against volumes in the same light: docs/truth.md
  if (!settings.published) light.half_lambert = 0.3F, light.volume_gain = 1.4F;
  return light;
}

LightSettings lightFor(const PostSettings& settings, float azimuth_degrees, float elevation_degrees) {
  return lookOf(settings, lightForSun(azimuth_degrees, elevation_degrees));
}

PostSettings publishedPost() {
  PostSettings settings;
  settings.published.emplace();
  settings.distort = {};
  settings.composite = {};
  return settings;
}

void setChannelMean(PostSettings& settings, ChannelMean mean) {
  PublishedSteps& steps = settings.published.value();
  steps.downsample_mean = steps.blur.mean = steps.depth_blur.mean = settings.distort.mean = settings.composite.mean = mean;
}

DepthRange depthRangeOf(const PostSettings& settings, std::span<const Instance> instances) {
  const float far = settings.far_distance.value_or(settings.near_distance + defaultDepthRange(instances).far);
  return {settings.near_distance, far};
}

namespace {

std::vector<ChainStep> chainOf(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                               const PostSettings& settings, StepsKept kept) {
  const DepthRange range = depthRangeOf(settings, instances);
  Chain chain = settings.published ? publishedChain(instances, camera, light, *settings.published, range, kept)
                                   : paintedChain(instances, camera, light, settings.painted, range, kept);
  chain.add("distorted", [&](const Image4& last) { return distort(last, settings.distort); });
  if (!settings.published) {
    const NoiseFrame frame = noiseFrame(instances, settings.painted.detail_size);
    chain.add("eroded", [&](Image4 last) { return erode(std::move(last), camera, range, frame, settings.painted.erode); });
  }
  return std::move(chain).steps();
}

// The two images of a colour after each of `steps`.
void addColors(std::span<const Instance> instances, const Camera& camera, LightSettings light, const PostSettings& settings, StepsKept kept,
               std::array<ShownLight, 2> shown, ColorChannels CloudColors::*colors, std::vector<ChainStep>& steps) {
  for (const ShownLight one : shown) {
    light.shown = one;
    std::vector<ChainStep> same = chainOf(instances, camera, light, settings, kept);
    for (size_t i = 0; i < steps.size(); ++i) (steps[i].colors.*colors).push_back(std::move(same[i].channels));
  }
}

// Of own colours: no black of a pixel's rest bleeds into them, and nothing darkens them.
PostSettings stepsOfColors(PostSettings settings) {
  if (settings.published) setChannelMean(settings, ChannelMean::kCovered);
  settings.distort.dark = 1;
  settings.painted.erode.darkening = 0;
  return settings;
}

}  // namespace

std::vector<ChainStep> drawMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                                      const PostSettings& settings, StepsKept kept) {
  std::vector<ChainStep> steps = chainOf(instances, camera, light, settings, kept);
  if (!light.lamps.empty())
    addColors(instances, camera, light, settings, kept, {ShownLight::kLampsRedGreen, ShownLight::kLampsBlue}, &CloudColors::lamps, steps);
  if (haveOwnColors(instances, light))
    addColors(instances, camera, light, stepsOfColors(settings), kept, {ShownLight::kOwnRedGreen, ShownLight::kOwnBlue}, &CloudColors::own,
              steps);
  return steps;
}

Image drawSky(const Camera& camera, const SkySettings& sky, const PostSettings& settings) {
  return renderSky(camera, sky, settings.sky_samples_per_side, settings.published ? SkySampling::kEverywhere : SkySampling::kAtEdges);
}

Image renderMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                       const PostSettings& settings) {
  const std::vector<ChainStep> steps = drawMeshClouds(instances, camera, light, settings, StepsKept::kEnds);
  return composite(steps.back().channels, drawSky(camera, light.sky, settings), camera, light.sky, settings.composite, steps.back().colors);
}

Layer meshCloudLayer(const Image4& channels, const Image4& drawn, const Camera& camera, const DepthRange& range, const SkySettings& sky,
                     const CompositeSettings& settings, const CloudColors& colors) {
  Image4 resampled, resampled_drawn;
  const ColorPixels lamps(colors.lamps, camera.width, camera.height, settings.mean, {});
  const ColorPixels own_colors(colors.own, camera.width, camera.height, ChannelMean::kCovered, {1, 1, 1});
  const Image4& full = atSize(channels, camera.width, camera.height, settings.mean, resampled);
  const Image4& own = atSize(drawn, camera.width, camera.height, settings.mean, resampled_drawn);
  const Vec3 forward = cameraAxes(camera).forward;
  Layer layer = blankLayer(camera.width, camera.rows());
  const CloudLight light = cloudLight(sky);
  const CameraRays rays(camera);
  parallelFor(camera.rows(), [&](int y) {
    const int row = camera.first_row + y;
    for (int x = 0; x < camera.width; ++x) {
      const Rgba &pixel = full.at(x, row), &here = own.at(x, row);
      if (!(pixel[2] > 0)) continue;
      const Vec3 view = rays.at(float(x) + 0.5F, float(row) + 0.5F).direction;
      const float depth = here[2] > 0 ? here[3] : pixel[3];
      layer.at(x, y) = {foggedCloud(pixel, view, light, settings, lamps.at(x, row), own_colors.at(x, row)), pixel[2],
                        lerp(range.near, range.far, depth) / dot(view, forward)};
    }
  });
  return layer;
}

// --- Keys ---

const Keys<PostSettings>& depthKeys() {
  using S = PostSettings;
  static const Keys<S> keys{
      {"near_distance", &S::near_distance, 0, 1e30, "distance at which the depth is 0, world units"},
      {"far_distance", &S::far_distance, 1e-30, 1e30,
       "distance at which the depth is 1, world units; unset: ten times the mean longest side of the clouds"},
  };
  return keys;
}

const Keys<PublishedSteps>& publishedKeys() {
  using S = PublishedSteps;
  static const Keys<S> keys{
      {"divisor", &S::divisor, 1, 64, "the image chain has this fraction of the picture's resolution"},
  };
  return keys;
}

}  // namespace cloudbake
