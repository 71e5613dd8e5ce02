// The order of the steps is that of "Volumetric Clouds and Mega-Particles" and of "On Mesh Cloud Rendering" (2019-06-30), after Sea of
// Thieves: draw at half resolution, downsample to a quarter, blur by depth, blur the depth, distort, composite.
#include "preview/mesh_clouds/mesh_clouds.h"

#include <utility>

#include "preview/parallel_rows.h"
#include "preview/shading_math.h"

namespace cloudbake {

void setChannelMean(PostSettings& settings, ChannelMean mean) {
  settings.downsample_mean = settings.blur.mean = settings.depth_blur.mean = settings.distort.mean = settings.composite.mean = mean;
}

Image renderMeshClouds(std::span<const Instance> instances, const Camera& camera, const LightSettings& light, const PostSettings& settings,
                       MeshCloudSteps* steps) {
  MeshCloudSteps made;
  made.drawn = renderChannels(instances, camera, light, settings.channels);
  const int width = (camera.width + settings.divisor - 1) / settings.divisor,
            height = (camera.height + settings.divisor - 1) / settings.divisor;
  made.downsampled = resampleBilinear(made.drawn, width, height, settings.downsample_mean);
  made.blurred = blurByDepth(made.downsampled, settings.blur);
  made.depth_blurred = blurDepth(made.blurred, settings.depth_blur);
  made.distorted = distort(made.depth_blurred, settings.distort);
  made.background = renderSky(camera, light.sky, settings.sky_samples_per_side);
  Image picture = composite(made.distorted, made.background, light.sky.colors, settings.composite);
  if (steps) *steps = std::move(made);
  return picture;
}

Layer meshCloudLayer(const Image4& channels, const Camera& camera, const DepthRange& range, const SkyColors& colors, ChannelMean mean) {
  const Image4 full = resampleBilinear(channels, camera.width, camera.height, mean);
  const Vec3 forward = cameraAxes(camera).forward;
  Layer layer = blankLayer(camera.width, camera.height);
  const CameraRays rays(camera);
  forEachRow(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const Rgba& pixel = full.at(x, y);
      if (!(pixel[2] > 0)) continue;
      const Ray ray = rays.at(float(x) + 0.5F, float(y) + 0.5F);
      layer.at(x, y) = {cloudColor({pixel[0], pixel[1]}, colors), pixel[2],
                        lerp(range.near, range.far, pixel[3]) / dot(ray.direction, forward)};
    }
  });
  return layer;
}

}  // namespace cloudbake
