// The order of the steps is that of "Volumetric Clouds and Mega-Particles" and of "On Mesh Cloud Rendering" (2019-06-30), after Sea of
// Thieves: draw at half resolution, downsample to a quarter, blur by depth, blur the depth, distort, composite.
#include "preview/mesh_clouds/mesh_clouds.h"

#include "preview/mesh_clouds/raster.h"
#include "preview/parallel_rows.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// The noise moves with the first instance, so that a moved world looks the same; its cells are a share of the mean longest side.
NoiseFrame noiseFrame(std::span<const Instance> instances, float share) {
  float sum = 0;
  int count = 0;
  for (const Instance& instance : instances) {
    const Box box = drawnBox(instance.mesh->surface, instance.to_world);
    if (!box.empty()) sum += box.longestSide(), ++count;
  }
  if (count == 0) return {};
  const auto& offset = instances.front().to_world.offset;
  return {{float(offset[0]), float(offset[1]), float(offset[2])}, share * (sum > 0 ? sum / float(count) : 1)};
}

std::vector<ChainStep> publishedSteps(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                                      const PublishedSteps& settings, const DepthRange& range) {
  ChannelSettings channels = settings.channels;
  channels.depth_range = range;
  std::vector<ChainStep> steps{{"drawn", renderChannels(instances, camera, light, channels)}};
  const int width = (camera.width + settings.divisor - 1) / settings.divisor,
            height = (camera.height + settings.divisor - 1) / settings.divisor;
  steps.push_back({"downsampled", resampleBilinear(steps.back().channels, width, height, settings.downsample_mean)});
  steps.push_back({"blurred", blurByDepth(steps.back().channels, settings.blur)});
  steps.push_back({"depth_blurred", blurDepth(steps.back().channels, settings.depth_blur)});
  return steps;
}

std::vector<ChainStep> paintedSteps(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                                    const PaintedSteps& settings, const DepthRange& range) {
  std::vector<ChainStep> steps{{"drawn", rasterChannels(placeMeshes(instances, light), camera, range)}};
  steps.push_back({"depth_spread", spreadDepth(steps.back().channels, settings.depth_spread)});
  steps.push_back({"softened", soften(steps.back().channels, settings.soften)});
  return steps;
}

}  // namespace

SkyColors skyColorsFor(const PostSettings& settings, float sun_height) {
  const SkyColors colors = skyColorsForSun(sun_height);
  return settings.published ? colors : withAmbientOfSky(colors, sun_height);
}

LightSettings lookOf(const PostSettings& settings, LightSettings light) {
  light.sky.colors = skyColorsFor(settings, light.sky.to_sun.y);
  if (!settings.published) light.half_lambert = 0.3F;
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

std::vector<ChainStep> drawMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                                      const PostSettings& settings) {
  const DepthRange range = settings.depth_range.value_or(depthRange(instances, camera));
  std::vector<ChainStep> steps = settings.published ? publishedSteps(instances, camera, light, *settings.published, range)
                                                    : paintedSteps(instances, camera, light, settings.painted, range);
  steps.push_back({"distorted", distort(steps.back().channels, settings.distort)});
  if (settings.published) return steps;
  const NoiseFrame frame = noiseFrame(instances, settings.painted.detail_size);
  steps.push_back({"eroded", erode(steps.back().channels, camera, range, frame, settings.painted.erode)});
  return steps;
}

Image drawSky(const Camera& camera, const SkySettings& sky, const PostSettings& settings) {
  return renderSky(camera, sky, settings.sky_samples_per_side, settings.published ? SkySampling::kEverywhere : SkySampling::kAtEdges);
}

Image renderMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light,
                       const PostSettings& settings) {
  const std::vector<ChainStep> steps = drawMeshClouds(instances, camera, light, settings);
  return composite(steps.back().channels, drawSky(camera, light.sky, settings), camera, light.sky, settings.composite);
}

Layer meshCloudLayer(const Image4& channels, const Camera& camera, const DepthRange& range, const SkySettings& sky,
                     const CompositeSettings& settings) {
  const Image4 full = resampleBilinear(channels, camera.width, camera.height, settings.mean);
  const Vec3 forward = cameraAxes(camera).forward;
  Layer layer = blankLayer(camera.width, camera.height);
  const CameraRays rays(camera);
  forEachRow(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const Rgba& pixel = full.at(x, y);
      if (!(pixel[2] > 0)) continue;
      const Ray ray = rays.at(float(x) + 0.5F, float(y) + 0.5F);
      layer.at(x, y) = {lightOfCloud(pixel, ray.direction, sky, settings.phase), pixel[2],
                        lerp(range.near, range.far, pixel[3]) / dot(ray.direction, forward)};
    }
  });
  return layer;
}

}  // namespace cloudbake
