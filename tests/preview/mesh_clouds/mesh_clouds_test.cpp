// The chain as a whole: its order, its sizes, what it does to a cloud's rim.
#include "preview/mesh_clouds/mesh_clouds.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/shapes.h"

namespace cloudbake {
namespace {

const Camera kCamera{{0, 0, 5}, {0, 0, 0}, 35, 160, 90};

LightSettings someLight() { return lightForSun(100, 25); }

TEST(MeshClouds, RunsTheStepsInOrder) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  PostSettings settings;
  settings.distort.time_seconds = 3;
  settings.depth_blur.radius = 1;
  MeshCloudSteps steps;
  const Image picture = renderMeshClouds(instances, kCamera, someLight(), settings, &steps);

  const Image4 drawn = renderChannels(instances, kCamera, someLight(), settings.channels);
  const Image4 downsampled = resampleBilinear(drawn, 40, 23), blurred = blurByDepth(downsampled, settings.blur);
  const Image4 depth_blurred = blurDepth(blurred, settings.depth_blur), distorted = distort(depth_blurred, settings.distort);
  const Image background = renderSky(kCamera, someLight().sky, 2);
  EXPECT_EQ(steps.drawn.pixels, drawn.pixels);
  EXPECT_EQ(steps.downsampled.pixels, downsampled.pixels);
  EXPECT_EQ(steps.blurred.pixels, blurred.pixels);
  EXPECT_EQ(steps.depth_blurred.pixels, depth_blurred.pixels);
  EXPECT_EQ(steps.distorted.pixels, distorted.pixels);
  EXPECT_EQ(steps.background.pixels, background.pixels);
  EXPECT_EQ(picture.pixels, composite(distorted, background, someLight().sky.colors, settings.composite).pixels);
  EXPECT_EQ(drawn.width, 80);
  EXPECT_EQ(picture.width, 160);
  EXPECT_EQ(picture.height, 90);
}

// Laid over the sky without fog, the layer is the composite; its distances are the surface's.
TEST(MeshClouds, AsALayerTheyAreWhatTheChainComposites) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  PostSettings settings;
  settings.composite.fog_density = 0;
  settings.distort.swirl_strength = 0;
  MeshCloudSteps steps;
  const LightSettings light = someLight();
  const Image picture = renderMeshClouds(instances, kCamera, light, settings, &steps);
  const Layer layer = meshCloudLayer(steps.distorted, kCamera, depthRange(instances, kCamera), light.sky.colors);
  const Image composed = composeLayers({&layer, 1}, steps.background);
  for (size_t i = 0; i < picture.pixels.size(); ++i) ASSERT_NEAR(length(picture.pixels[i] - composed.pixels[i]), 0, 1e-5);
  // The ball's front lies 4 before the camera; the blur takes in a little of what lies behind.
  EXPECT_NEAR(layer.at(80, 45).distance, 4, 0.1);
  EXPECT_EQ(layer.at(3, 3).opacity, 0);
  // Along a slanting ray the distance is longer than the depth.
  EXPECT_GT(layer.at(98, 45).distance, 4.05F);
}

// One depth in all of the picture is a plane across the view: half of the range 2 … 10 lies 6 before the camera, and every ray of the layer
// ends in that plane. Towards the corners of a wide picture the rays are up to 1.6 times as long.
TEST(MeshClouds, DistancesOfALayerLeadToItsDepth) {
  const Camera camera{{1, 2, 5}, {1, 2, 0}, 80, 40, 24};
  const Layer layer = meshCloudLayer(filledImage4(10, 6, {0.5F, 0.5F, 1, 0.5F}), camera, {2, 10}, someLight().sky.colors);
  float longest = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      ASSERT_NEAR((ray.origin + ray.direction * layer.at(x, y).distance).z, 5 - 6, 1e-4) << x << ' ' << y;
      longest = std::max(longest, layer.at(x, y).distance);
    }
  // tan 40° up, and 40/24 of that aside, less half a pixel.
  EXPECT_NEAR(longest, 6 * std::hypot(1.0, 0.8391 * 23 / 24, 0.8391 * 39 / 24), 0.01);
}

TEST(MeshClouds, BackgroundFarFromTheCloudIsTheSky) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  const Image picture = renderMeshClouds(instances, kCamera, someLight()), sky = renderSky(kCamera, someLight().sky, 2);
  EXPECT_EQ(picture.at(3, 3), sky.at(3, 3));
  EXPECT_EQ(picture.at(156, 45), sky.at(156, 45));
  EXPECT_GT(length(picture.at(80, 45) - sky.at(80, 45)), 0.1F);
  EXPECT_EQ(renderMeshClouds({}, kCamera, someLight()).pixels, sky.pixels);
}

// How many quarter-resolution pixels are neither clear nor opaque.
int softPixels(float near, float far) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  PostSettings settings;
  settings.channels.depth_range = DepthRange{near, far};
  settings.distort.swirl_strength = 0;
  MeshCloudSteps steps;
  renderMeshClouds(instances, {{0, 0, 5}, {0, 0, 0}, 35, 640, 360}, someLight(), settings, &steps);
  int soft = 0;
  for (const Rgba& p : steps.distorted.pixels) soft += p[2] > 0.02F && p[2] < 0.98F;
  return soft;
}

TEST(MeshClouds, NearRimsAreSoftAndFarOnesCrisp) { EXPECT_GT(softPixels(5, 100), 2 * softPixels(0, 4)); }

TEST(MeshClouds, OneSettingSetsEveryMean) {
  PostSettings settings;
  setChannelMean(settings, ChannelMean::kAll);
  for (const ChannelMean mean :
       {settings.downsample_mean, settings.blur.mean, settings.depth_blur.mean, settings.distort.mean, settings.composite.mean})
    EXPECT_EQ(mean, ChannelMean::kAll);
}

TEST(MeshClouds, SameBytesForAnyNumberOfThreads) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  const auto render = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return renderMeshClouds(instances, kCamera, someLight());
  };
  const Image one = render(1);
  for (const size_t threads : {2U, 7U})
    EXPECT_EQ(std::memcmp(one.pixels.data(), render(threads).pixels.data(), one.pixels.size() * sizeof(Vec3)), 0);
}

}  // namespace
}  // namespace cloudbake
