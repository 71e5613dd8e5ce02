// The chain as a whole: its order, its sizes, what it does to a cloud's rim.
#include "preview/mesh_clouds/mesh_clouds.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "preview/mesh_clouds/raster.h"
#include "preview/shading_math.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

const Camera kCamera{{0, 0, 5}, {0, 0, 0}, 35, 160, 90};

LightSettings someLight() { return lightForSun(100, 25); }

// The channels of the steps must be these, with these names.
void expectSteps(const std::vector<ChainStep>& made, std::initializer_list<std::pair<const char*, Image4>> expected) {
  ASSERT_EQ(made.size(), expected.size());
  for (size_t i = 0; const auto& [name, channels] : expected) {
    EXPECT_EQ(made[i].name, name);
    EXPECT_EQ(made[i].channels.pixels, channels.pixels) << name;
    ++i;
  }
}

TEST(MeshClouds, RunsThePublishedStepsInOrder) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  PostSettings settings = publishedPost();
  settings.distort.time_seconds = 3;
  settings.published->depth_blur.radius = 1;
  const std::vector<ChainStep> steps = drawMeshClouds(instances, kCamera, someLight(), settings);
  const Image picture = renderMeshClouds(instances, kCamera, someLight(), settings);

  const Image4 drawn = renderChannels(instances, kCamera, someLight(), settings.published->channels);
  const Image4 downsampled = resampleBilinear(drawn, 40, 23), blurred = blurByDepth(downsampled, settings.published->blur);
  const Image4 depth_blurred = blurDepth(blurred, settings.published->depth_blur), distorted = distort(depth_blurred, settings.distort);
  const Image background = renderSky(kCamera, someLight().sky, 2);
  expectSteps(
      steps,
      {{"drawn", drawn}, {"downsampled", downsampled}, {"blurred", blurred}, {"depth_blurred", depth_blurred}, {"distorted", distorted}});
  EXPECT_EQ(drawSky(kCamera, someLight().sky, settings).pixels, background.pixels);
  EXPECT_EQ(picture.pixels, composite(distorted, background, kCamera, someLight().sky, settings.composite).pixels);
  EXPECT_EQ(drawn.width, 80);
  EXPECT_EQ(picture.width, 160);
  EXPECT_EQ(picture.height, 90);
}

// The light of lamps goes through the steps like that of the sun: where a lamp gives each vertex the shares that the sun gives it, the two
// are the same channel.
TEST(MeshClouds, LampsGoThroughTheSameSteps) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  for (PostSettings settings : {PostSettings{}, publishedPost()}) {
    settings.distort.time_seconds = 3;
    LightSettings light = someLight();
    const std::vector<ChainStep> dark = drawMeshClouds(instances, kCamera, light, settings);
    constexpr float kFar = 1e5F;  // as far as the sun, as bright at the cloud
    light.lamps = {{keyLight(light.sky).direction * kFar, Vec3{0.5F, 1, 2} * (kFar * kFar)}};
    const std::vector<ChainStep> lit = drawMeshClouds(instances, kCamera, light, settings);
    ASSERT_EQ(lit.size(), dark.size());
    for (size_t i = 0; i < lit.size(); ++i) {
      EXPECT_EQ(lit[i].channels.pixels, dark[i].channels.pixels);
      EXPECT_TRUE(dark[i].colors.lamps.empty());
      ASSERT_EQ(lit[i].colors.lamps.size(), 2U);
      for (size_t p = 0; p < lit[i].channels.pixels.size(); ++p) {
        const Rgba &sun = lit[i].channels.pixels[p], &first = lit[i].colors.lamps[0].pixels[p], &second = lit[i].colors.lamps[1].pixels[p];
        ASSERT_NEAR(first[0], 0.5F * sun[0], 2e-3F);
        ASSERT_NEAR(first[1], sun[0], 4e-3F);
        ASSERT_NEAR(second[0], 2 * sun[0], 8e-3F);
        ASSERT_EQ(first[2], sun[2]);
        ASSERT_EQ(second[3], sun[3]);
      }
    }
    // The composite adds it to the cloud, before the fog.
    settings.composite.fog_density = 0;
    const Image without = renderMeshClouds(instances, kCamera, someLight(), settings),
                with = renderMeshClouds(instances, kCamera, light, settings);
    const auto& last = lit.back();
    if (last.channels.width == with.width)
      for (size_t p = 0; p < with.pixels.size(); ++p) {
        const float opacity = last.channels.pixels[p][2];
        const Vec3 more = with.pixels[p] - without.pixels[p];
        ASSERT_NEAR(more.y, last.colors.lamps[0].pixels[p][1] * opacity, 1e-4F);
        ASSERT_NEAR(more.z, last.colors.lamps[1].pixels[p][0] * opacity, 1e-4F);
      }
  }
}

// Own colours multiply the light of a cloud before the fog; white ones and switched ones change no bit.
TEST(MeshClouds, OwnColorsMultiplyTheLight) {
  const BakedMesh plain = bakedBall(1, {}, 4);
  BakedMesh white = plain, red = plain;
  white.colors.assign(plain.lobes.size(), {1, 1, 1});
  constexpr Vec3 kOwn{0.9F, 0.3F, 0.1F};
  red.colors.assign(plain.lobes.size(), kOwn);
  for (PostSettings settings : {PostSettings{}, publishedPost()}) {
    settings.distort.time_seconds = 3;
    settings.distort.dark = 0.8F;
    LightSettings light = someLight();
    light.lamps = {{{2, 2, 3}, {5, 2, 9}}};
    const auto drawn = [&](const BakedMesh& mesh) { return renderMeshClouds(std::array{Instance{&mesh, {}}}, kCamera, light, settings); };
    const Image without = drawn(plain);
    const Image with_white = drawn(white);
    for (size_t p = 0; p < without.pixels.size(); ++p) ASSERT_LE(length(with_white.pixels[p] - without.pixels[p]), 1e-5F);

    const std::vector<ChainStep> steps = drawMeshClouds(std::array{Instance{&red, {}}}, kCamera, light, settings);
    const ChainStep& last = steps.back();
    const Image sky = drawSky(kCamera, light.sky, settings), lit = drawn(red);
    const CloudLight cloud_light = cloudLight(light.sky);
    const CameraRays rays(kCamera);
    Image4 buffer;
    const Image4& channels = atSize(last.channels, kCamera.width, kCamera.height, settings.composite.mean, buffer);
    const ColorPixels lamps(last.colors.lamps, kCamera.width, kCamera.height, settings.composite.mean, {});
    size_t covered = 0;
    for (int y = 0; y < kCamera.height; ++y)
      for (int x = 0; x < kCamera.width; ++x) {
        const Rgba& pixel = channels.at(x, y);
        if (!(pixel[2] > 0)) {
          ASSERT_EQ(lit.at(x, y), sky.at(x, y));
          continue;
        }
        const Vec3 view = rays.at(float(x) + 0.5F, float(y) + 0.5F).direction;
        const Vec3 light_here = lightOfCloud(pixel, view, cloud_light, settings.composite.phase) + lamps.at(x, y);
        const float fog = 1 - std::exp(-settings.composite.fog_density * pixel[3]);
        const Vec3 fog_color = settings.composite.fog_color.value_or(cloud_light.colors.horizon) +
                               scatteredLight(view, cloud_light.to_light, cloud_light.colors.sun_color, settings.composite.scatter);
        const Vec3 cloud = lerp(Vec3{light_here.x * kOwn.x, light_here.y * kOwn.y, light_here.z * kOwn.z}, fog_color, fog);
        ASSERT_LE(length(lit.at(x, y) - lerp(sky.at(x, y), cloud, pixel[2])), 2e-4F) << x << " " << y;
        ++covered;
      }
    EXPECT_GT(covered, 500U);

    light.own_colors = false;
    EXPECT_EQ(drawn(red).pixels, without.pixels);
    light.own_colors = true;
    // There are images of colours only where something is coloured.
    const Instance both[] = {{&red, {}}, {&plain, {}}};
    const std::vector<ChainStep> beside = drawMeshClouds(both, kCamera, light, settings);
    ASSERT_EQ(beside.front().colors.own.size(), 2U);
    EXPECT_TRUE(drawMeshClouds(std::span(both).subspan(1), kCamera, light, settings).front().colors.own.empty());
  }
}

TEST(MeshClouds, RunsThePaintedStepsInOrder) {
  const BakedMesh ball = bakedBall(1, {}, 4), large = bakedBall(3, {}, 4);
  const Instance instances[] = {{&ball, {}}, {&large, {}}};
  PostSettings settings;
  settings.distort.time_seconds = 3;
  settings.near_distance = 1, settings.far_distance = 9;
  const Camera camera{{0, 0, 12}, {0, 0, 0}, 35, 160, 90};
  const std::vector<ChainStep> steps = drawMeshClouds(instances, camera, someLight(), settings);
  const Image picture = renderMeshClouds(instances, camera, someLight(), settings);

  const Image4 drawn = rasterChannels(placeMeshes(instances, someLight()), camera, {1, 9});
  const Image4 spread = spreadDepth(drawn, settings.painted.depth_spread), softened = soften(spread, settings.painted.soften);
  const Image4 distorted = distort(softened, settings.distort);
  // The balls are 2 and 6 wide.
  const Image4 eroded = erode(distorted, camera, {1, 9}, {{}, settings.painted.detail_size * 4}, settings.painted.erode);
  const Image background = renderSky(camera, someLight().sky, 2, SkySampling::kAtEdges);
  expectSteps(steps, {{"drawn", drawn}, {"depth_spread", spread}, {"softened", softened}, {"distorted", distorted}, {"eroded", eroded}});
  EXPECT_EQ(drawSky(camera, someLight().sky, settings).pixels, background.pixels);
  EXPECT_EQ(picture.pixels, composite(eroded, background, camera, someLight().sky, settings.composite).pixels);
  EXPECT_GT(settings.composite.phase.share, 0);
}

// The light of both chains is that of the plain look. A ramp without ambient light of its own lights painted clouds by its sky.
TEST(MeshClouds, LightSuitsTheChain) {
  const LightSettings plain = lightForSun(100, 25), published = lightFor(publishedPost(), 100, 25), painted = lightFor({}, 100, 25);
  EXPECT_EQ(published.sky.colors.ambient_sky, plain.sky.colors.ambient_sky);
  EXPECT_EQ(published.half_lambert, plain.half_lambert);
  EXPECT_EQ(painted.sky.to_sun, plain.sky.to_sun);
  EXPECT_EQ(painted.sky.colors.ambient_sky, plain.sky.colors.ambient_sky);
  SkyRamp without = defaultSkyRamp();
  without.own_ground = without.own_ambient_sky = without.own_ambient_ground = false;
  const float height = plain.sky.to_sun.y;
  EXPECT_EQ(skyColorsFor({}, height, without).ambient_sky, withAmbientOfSky(plain.sky.colors, height).ambient_sky);
  EXPECT_EQ(skyColorsFor(publishedPost(), height, without).ambient_sky, plain.sky.colors.ambient_sky);
  EXPECT_EQ(painted.sky.colors.sun_color, plain.sky.colors.sun_color);
  EXPECT_LT(painted.half_lambert, plain.half_lambert);
}

// Laid over the sky the layer is the composite, fog included; its distances are the surface's.
TEST(MeshClouds, AsALayerTheyAreWhatTheChainComposites) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  PostSettings settings = publishedPost();
  settings.composite.fog_density = 0.7F;
  settings.composite.fog_color = Vec3{0.9F, 0.2F, 0.1F};
  settings.composite.phase.share = 0.5F;
  settings.distort.swirl_strength = 0;
  const LightSettings light = someLight();
  const std::vector<ChainStep> steps = drawMeshClouds(instances, kCamera, light, settings);
  const Image background = drawSky(kCamera, light.sky, settings),
              picture = composite(steps.back().channels, background, kCamera, light.sky, settings.composite);
  const Layer layer = meshCloudLayer(steps.back().channels, steps.front().channels, kCamera, depthRangeOf(settings, instances), light.sky,
                                     settings.composite);
  const Image composed = composeLayers({&layer, 1}, background);
  EXPECT_EQ(picture.pixels, composed.pixels);
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
  const Layer layer =
      meshCloudLayer(filledImage4(10, 6, {0.5F, 0.5F, 1, 0.5F}), filledImage4(10, 6, kNoCloud), camera, {2, 10}, someLight().sky, {});
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

// The steps mix the depths of a near cloud and of a far one behind its rim. In the picture each pixel is as far as what was drawn there.
TEST(MeshClouds, DistancesAreTheCloudsOwn) {
  const BakedMesh ball = bakedBall(1, {}, 5);
  Affine large_and_far;
  for (size_t i = 0; i < 3; ++i) large_and_far.linear[i][i] = 12;
  large_and_far.offset = {2, 0, -40};
  const Instance instances[] = {{&ball, {}}, {&ball, large_and_far}};
  const PostSettings settings;
  const std::vector<ChainStep> steps = drawMeshClouds(instances, kCamera, someLight(), settings);
  const DepthRange range = depthRangeOf(settings, instances);
  const Layer layer = meshCloudLayer(steps.back().channels, steps.front().channels, kCamera, range, someLight().sky, settings.composite);
  int near = 0, far = 0, mixed = 0;
  for (int y = 0; y < kCamera.height; ++y)
    for (int x = 0; x < kCamera.width; ++x) {
      const Rgba& drawn = steps.front().channels.at(x, y);
      if (drawn[2] < 1) continue;
      const float distance = layer.at(x, y).distance, depth = lerp(range.near, range.far, steps.back().channels.at(x, y)[3]);
      near += distance < 6;
      far += distance > 25;
      mixed += depth > 7 && depth < 24;
      ASSERT_TRUE(distance < 6 || distance > 25 || (drawn[3] > 6 / range.far && drawn[3] < 25 / range.far)) << distance;
    }
  EXPECT_GT(near, 500);
  EXPECT_GT(far, 1000);
  EXPECT_GT(mixed, 100) << "the scene does not show what it is for";
}

TEST(MeshClouds, TheEndsAreTheSameAlone) {
  const BakedMesh ball = bakedBall(1);
  const std::vector<Instance> instances{{&ball, {}}};
  for (const PostSettings& settings : {PostSettings(), publishedPost()}) {
    const auto all = drawMeshClouds(instances, kCamera, someLight(), settings),
               ends = drawMeshClouds(instances, kCamera, someLight(), settings, StepsKept::kEnds);
    ASSERT_EQ(all.size(), 5U);
    ASSERT_EQ(ends.size(), 2U);
    EXPECT_EQ(ends.front().name, all.front().name);
    EXPECT_EQ(ends.front().channels.pixels, all.front().channels.pixels);
    EXPECT_EQ(ends.back().name, all.back().name);
    EXPECT_EQ(ends.back().channels.pixels, all.back().channels.pixels);
  }
}

TEST(MeshClouds, BackgroundFarFromTheCloudIsTheSky) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  const Image picture = renderMeshClouds(instances, kCamera, someLight()),
              sky = renderSky(kCamera, someLight().sky, 2, SkySampling::kAtEdges);
  EXPECT_EQ(picture.at(3, 3), sky.at(3, 3));
  EXPECT_EQ(picture.at(156, 45), sky.at(156, 45));
  EXPECT_GT(length(picture.at(80, 45) - sky.at(80, 45)), 0.1F);
  EXPECT_EQ(renderMeshClouds({}, kCamera, someLight()).pixels, sky.pixels);
}

// How many pixels are neither clear nor opaque.
int softPixels(PostSettings settings, float near, float far) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}};
  settings.near_distance = near, settings.far_distance = far;
  settings.distort.swirl_strength = 0;
  const auto steps = drawMeshClouds(instances, {{0, 0, 5}, {0, 0, 0}, 35, 640, 360}, someLight(), settings);
  int soft = 0;
  for (const Rgba& p : steps.back().channels.pixels) soft += p[2] > 0.02F && p[2] < 0.98F;
  return soft;
}

TEST(MeshClouds, NearRimsAreSoftAndFarOnesCrisp) {
  for (const PostSettings& settings : {PostSettings{}, publishedPost()})
    EXPECT_GT(softPixels(settings, 5, 100), 2 * softPixels(settings, 0, 4));
}

// A cloud ten times as far is sharper in pixels: seen as large, by a camera of a tenth of the angle, its rim is a third as soft.
TEST(MeshClouds, AFarCloudIsSharper) {
  const BakedMesh ball = bakedBall(1, {}, 5);
  const Instance instances[] = {{&ball, {}}};
  for (PostSettings settings : {PostSettings{}, publishedPost()}) {
    settings.distort.swirl_strength = 0;
    const auto soft = [&](float distance) {
      const Camera camera{{0, 0, distance}, {0, 0, 0}, float(2 * std::atan(1.6 / distance) * 180 / kPi), 640, 360};
      const auto steps = drawMeshClouds(instances, camera, someLight(), settings);
      // The mean width of the rim along the middle row: pixels that are neither clear nor opaque.
      const Image4& last = steps.back().channels;
      int count = 0;
      for (int y = 0; y < last.height; ++y)
        for (int x = 0; x < last.width; ++x) count += last.at(x, y)[2] > 0.02F && last.at(x, y)[2] < 0.98F;
      return count;
    };
    EXPECT_LT(soft(30), 0.5 * soft(3)) << (settings.published ? "published" : "painted");
  }
}

// The same picture at another size: lengths are shares of it.
TEST(MeshClouds, PaintedLookDoesNotDependOnTheSize) {
  const BakedMesh ball = bakedBall(1, {}, 5);
  const Instance instances[] = {{&ball, {}}};
  const Camera small{{0, 0, 4}, {0, 0, 0}, 35, 120, 90}, large{{0, 0, 4}, {0, 0, 0}, 35, 480, 360};
  const Image few = renderMeshClouds(instances, small, someLight()), many = renderMeshClouds(instances, large, someLight());
  double square = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x) {
      Vec3 mean;
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) mean += many.at(4 * x + i, 4 * y + j) / 16;
      square += dot(mean - few.at(x, y), mean - few.at(x, y));
    }
  EXPECT_LT(std::sqrt(square / (120 * 90)), 0.02);
}

TEST(MeshClouds, OneSettingSetsEveryMean) {
  PostSettings settings = publishedPost();
  setChannelMean(settings, ChannelMean::kAll);
  for (const ChannelMean mean : {settings.published->downsample_mean, settings.published->blur.mean, settings.published->depth_blur.mean,
                                 settings.distort.mean, settings.composite.mean})
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
