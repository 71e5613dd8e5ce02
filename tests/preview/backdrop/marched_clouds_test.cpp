// Marched clouds: every number of both methods, sums in closed form, and pictures that hold together.
#include "preview/backdrop/marched_clouds.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "preview/backdrop/noise.h"
#include "preview/camera.h"
#include "tests/preview/preview_helpers.h"

namespace cloudbake {
namespace {

Camera marchedCamera(Vec3 direction, Vec3 from = {0, 0.5F, 0}, int width = 32, int height = 24) {
  return {from, from + direction, 70, width, height};
}

// A homogeneous slab of n samples of opacity a, one apart: A = 1 − (1 − a)^n, and the mean place Σ a (1 − a)^i i / A.
TEST(AccumulateSamples, HomogeneousSlabIsTheGeometricSum) {
  const Vec3 color{0.3F, 0.6F, 2};
  for (const double a : {0.01, 0.2, 0.5})
    for (const int n : {1, 2, 7, 30}) {
      const LayerPixel pixel = accumulateSamples(10, n, 1, [&](float) { return CloudSample{color, float(a), 1}; });
      const double clear = std::pow(1 - a, n);
      EXPECT_NEAR(pixel.opacity, 1 - clear, 1e-5);
      expectNear(pixel.color, color);
      // Σ_{i<n} a q^i i = q (1 − n q^(n−1) + (n − 1) q^n)/(1 − q) with q = 1 − a
      const double q = 1 - a, mean = q * (1 - n * std::pow(q, n - 1) + (n - 1) * std::pow(q, n)) / (1 - q) / (1 - clear);
      EXPECT_NEAR(pixel.distance, 10 + mean, 1e-3);
    }
}

TEST(AccumulateSamples, NearerSamplesHideFartherOnes) {
  const LayerPixel pixel = accumulateSamples(0, 2, 1, [](float t) {
    return t == 0 ? CloudSample{{1, 0, 0}, 0.75F, 4} : CloudSample{{0, 1, 0}, 0.5F, 4};
  });
  EXPECT_EQ(pixel.opacity, 0.875F);
  expectNear(pixel.color, {0.75F / 0.875F, 0.125F / 0.875F, 0});
  EXPECT_NEAR(pixel.distance, 4 * 0.125 / 0.875, 1e-6);
}

TEST(AccumulateSamples, StopsWhereItIsTold) {
  int calls = 0;
  const auto count = [&](float opacity, float step, int samples, float stop) {
    calls = 0;
    accumulateSamples(0, samples, stop, [&](float) { return ++calls, CloudSample{{}, opacity, step}; });
    return calls;
  };
  EXPECT_EQ(count(0, 1, 17, 0.99F), 17);
  EXPECT_EQ(count(0.9F, 1, 100, 0.99F), 3);  // 0.9, 0.99 or a bit less, 0.999
  EXPECT_EQ(count(0.5F, 1, 100, 0.99F), 7);  // 1 − 2^−6 = 0.984, 1 − 2^−7 = 0.992
  EXPECT_EQ(count(0.5F, INFINITY, 100, 0.99F), 1);
  EXPECT_EQ(accumulateSamples(0, 9, 1, [](float) { return CloudSample{{1, 1, 1}, 0, 1}; }).distance, INFINITY);
}

TEST(DistanceClouds, DefaultsAreThePublishedConstants) {
  const DistanceCloudSettings s;
  EXPECT_EQ(s.noise_frequency, 0.4F);
  EXPECT_EQ(s.noise_offset, 0.4F);
  EXPECT_EQ(s.first_step, 1);
  EXPECT_EQ(s.step_factor, 0.8F);
  EXPECT_EQ(s.contact, 0.1F);
  EXPECT_EQ(s.farthest, 70);
  EXPECT_EQ(s.search_farthest, 70);
  EXPECT_EQ(s.step_back, 5);
  EXPECT_EQ(s.samples, 128);
  EXPECT_EQ(s.stop_opacity, 0.99F);
  EXPECT_EQ(s.shadow_tuning, 0);
}

TEST(DistanceClouds, FieldIsHeightPlusNoiseLessItsOffset) {
  DistanceCloudSettings settings;
  settings.cloud_height = 3, settings.flatness = 0.2F, settings.octaves = 4, settings.seed = 5;
  for (const Vec3 p : {Vec3{0.3F, 3, 0.7F}, Vec3{-8, 1, 4}, Vec3{2, 4.5F, -30}}) {
    const float noise = fbmValue3(p * 0.4F, {.octaves = 4, .seed = 5}).value;
    const float field = std::abs(p.y - 3) * 0.2F + noise - 0.4F;
    EXPECT_NEAR(distanceCloudField(p, settings), field, 1e-6);
    EXPECT_NEAR(distanceCloudDensity(p, settings), std::clamp(-field, 0.0F, 1.0F), 1e-6);
    settings.wind = {0.5F, 1, 1.5F}, settings.time_seconds = 2;
    EXPECT_NEAR(distanceCloudField({p.x + 1, p.y, p.z}, settings),
                std::abs(p.y - 3) * 0.2F + fbmValue3(Vec3{p.x, p.y - 2, p.z - 3} * 0.4F, {.octaves = 4, .seed = 5}).value - 0.4F, 1e-5);
    settings.wind = {};
  }
  // Where the height alone is 0.4, nothing; far out, clear air.
  EXPECT_EQ(distanceCloudDensity({0, 5.01F, 0}, settings), 0);
  EXPECT_EQ(distanceCloudDensity({1e30F, 3, 0}, settings), 0);
  for (const float far : {1e30F, -1e30F, INFINITY, -INFINITY, NAN}) {
    EXPECT_NEAR(distanceCloudField({far, 3, 0}, settings), 0.6F, 1e-6) << far;
    EXPECT_NEAR(distanceCloudField({0, 3, far}, settings), 0.6F, 1e-6) << far;
  }
  settings.noise_offset = 9;
  EXPECT_EQ(distanceCloudDensity({0, 3, 0}, settings), 1);
}

TEST(DistanceClouds, SearchStepsByTheFieldAndThenBack) {
  const DistanceCloudSettings settings;
  std::vector<float> asked;
  // First step 1, then 0.8·field: 1, 9, 17, and there the field is 0.1, less than 0.1/0.8.
  const float first = findDistanceCloud([&](float t) { return asked.push_back(t), t < 16 ? 10.0F : 0.1F; }, 0, settings);
  EXPECT_EQ(asked, (std::vector<float>{1, 9, 17}));
  EXPECT_EQ(first, 12);  // 5 back
  DistanceCloudSettings three = settings;
  three.search_steps = 3;
  EXPECT_NEAR(findDistanceCloud([](float) { return 1; }, 20, three), 20 + 1 + 0.8 + 0.8 - 5, 1e-5) << "no more steps than that";
  EXPECT_EQ(findDistanceCloud([](float) { return 0; }, 20, settings), 16);
  // Never behind the camera.
  EXPECT_EQ(findDistanceCloud([](float) { return 0; }, 0, settings), 0);
  // The limit of contact is |0.8 field| < 0.1, from both sides.
  asked.clear();
  findDistanceCloud([&](float t) { return asked.push_back(t), asked.size() < 4 ? 0.126F : 0.124F; }, 30, settings);
  EXPECT_EQ(asked.size(), 4U);
  EXPECT_NEAR(findDistanceCloud([](float) { return -0.12F; }, 30, settings), 26, 1e-5);
  // Deep inside it goes back to the surface.
  EXPECT_EQ(findDistanceCloud([](float t) { return t > 25 ? -10.0F : 0; }, 30, settings), 18);
  // Nothing from 70 on.
  EXPECT_EQ(findDistanceCloud([](float) { return 5; }, 0, settings), INFINITY);
  EXPECT_EQ(findDistanceCloud([](float t) { return t < 71 ? 3.0F : 0; }, 0, settings), INFINITY);
  EXPECT_NEAR(findDistanceCloud([](float t) { return t < 69.5F ? 1.0F : 0; }, 0, settings), 64.5, 0.8);
  EXPECT_EQ(findDistanceCloud([](float) { return INFINITY; }, 0, settings), INFINITY);
  DistanceCloudSettings far = settings;
  far.search_farthest = 200;
  EXPECT_NEAR(findDistanceCloud([](float t) { return t < 100 ? 3.0F : 0; }, 0, far), 95, 3) << "the search may go farther than samples";
  // Back and forth for ever: it ends all the same.
  EXPECT_TRUE(std::isfinite(findDistanceCloud([](float t) { return t > 20 ? -5.0F : 5; }, 0, settings)));
}

TEST(DistanceClouds, SampleHasItsColorShadowAndOpacity) {
  DistanceCloudSettings settings;
  // Without cloud towards the light: all of it.
  CloudSample sample = distanceCloudSample(10, 0.25F, 0, settings);
  expectNear(sample.color, Vec3{0.8F, 0.75F, 0.85F} * 0.75F);
  EXPECT_NEAR(sample.opacity, 0.25F * 0.9F, 1e-6);
  expectNear(distanceCloudSample(10, 1, 0, settings).color, {});
  // The reversed step is 1/2 at half of 0.2: shadow = 0.5·0.85 + 0.15, of colour and opacity.
  sample = distanceCloudSample(10, 0.25F, 0.1F, settings);
  expectNear(sample.color, Vec3{0.8F, 0.75F, 0.85F} * (0.75F * 0.575F));
  EXPECT_NEAR(sample.opacity, 0.25F * 0.9F * 0.575F, 1e-6);
  // At a quarter of the way Hermite's step has 27/32.
  EXPECT_NEAR(distanceCloudSample(10, 0.5F, 0.05F, settings).opacity, 0.45F * (0.85F * 27 / 32 + 0.15F), 1e-6);
  for (const float beyond : {0.2F, 0.7F}) EXPECT_NEAR(distanceCloudSample(10, 0.5F, beyond, settings).opacity, 0.45F * 0.15F, 1e-6);
  // m moves its end by 0.05.
  settings.shadow_tuning = 2;
  EXPECT_NEAR(distanceCloudSample(10, 0.5F, 0.15F, settings).opacity, 0.45F * 0.575F, 1e-6);
  settings.tint = {2, 1, 0};
  expectNear(distanceCloudSample(10, 0.25F, 0, settings).color, Vec3{1.6F, 0.75F, 0} * 0.75F);
}

TEST(DistanceClouds, StepGrowsWithDistanceAndShrinksInTheCloud) {
  const DistanceCloudSettings settings;
  EXPECT_NEAR(distanceCloudSample(50, 0, 0, settings).step, 1.1F, 1e-5);
  EXPECT_NEAR(distanceCloudSample(50, 0.02F, 0, settings).step, 0.77F, 1e-5);
  EXPECT_EQ(distanceCloudSample(50, 0.5F, 0, settings).step, 0.4F);
  EXPECT_EQ(distanceCloudSample(1, 0, 0, settings).step, 0.4F);
}

TEST(DistanceClouds, FarSamplesFadeOut) {
  DistanceCloudSettings settings;
  EXPECT_NEAR(distanceCloudSample(34.9F, 0.5F, 0, settings).opacity, 0.45F, 1e-6);
  EXPECT_NEAR(distanceCloudSample(52.5F, 0.5F, 0, settings).opacity, 0.225F, 1e-5);
  EXPECT_EQ(distanceCloudSample(70.1F, 0.5F, 0, settings).opacity, 0);
  settings.fade_start = 1;
  EXPECT_NEAR(distanceCloudSample(100, 0.5F, 0, settings).opacity, 0.45F, 1e-6);
}

TEST(DensityClouds, PublishedConstants) {
  const DensityCloudSettings s = publishedDensityClouds();
  EXPECT_EQ(s.opacity_factor, 0.5F);
  EXPECT_EQ(s.color_factor, 0.65F);
  EXPECT_EQ(s.fade_density, 0.0018F);
  EXPECT_EQ(s.cloud_height, 10.8F);
  EXPECT_EQ(s.flatness, 0.15F);
  EXPECT_EQ(s.noise_strength, 1.6F);
  EXPECT_EQ(s.noise_frequency, 0.15F);
  EXPECT_EQ(s.first_t, 0.1F);
  EXPECT_EQ(s.samples, 64);
  EXPECT_EQ(s.stop_opacity, 0.99F);
  EXPECT_NEAR(s.thin_color.y, 0.8 * 0.95, 1e-6);
  EXPECT_NEAR(s.dense_color.z, 0.2 * 0.6, 1e-6);
}

TEST(DensityClouds, DensityAtGivenHeights) {
  DensityCloudSettings settings;
  settings.noise_strength = 0;  // 1 − 0.15 |10.8 − y| alone
  EXPECT_NEAR(densityCloudDensity({3, 10.8F, 4}, settings), 1, 1e-6);
  EXPECT_NEAR(densityCloudDensity({3, 12.8F, 4}, settings), 0.7F, 1e-5);
  EXPECT_NEAR(densityCloudDensity({3, 5.8F, 4}, settings), 0.25F, 1e-5);
  EXPECT_EQ(densityCloudDensity({3, 4.1F, 4}, settings), 0);
  EXPECT_EQ(densityCloudDensity({3, 17.6F, 4}, settings), 0);
  settings = publishedDensityClouds();
  settings.seed = 3;
  double sum = 0;
  for (float x = 0; x < 40; x += 1.7F) {
    const Vec3 p{x, 9.8F, 2};
    const double noise = fbmValue3(p * 0.15F, {.octaves = 5, .seed = 3}).value;
    EXPECT_NEAR(densityCloudDensity(p, settings), std::clamp(0.85 - 1.6 * noise, 0.0, 1.0), 1e-5);
    settings.noise_contrast = 2;
    const double stretched = std::clamp(0.5 + 2 * (noise - 0.5), 0.0, 1.0), density = std::clamp(0.85 - 1.6 * stretched, 0.0, 1.0);
    EXPECT_NEAR(densityCloudDensity(p, settings), density, 1e-5);
    settings.noise_contrast = 1;
    sum += density;
  }
  EXPECT_GT(sum, 0.5);
  EXPECT_EQ(densityCloudDensity({1e30F, 10.8F, 0}, settings), 0);
}

TEST(DensityClouds, SampleRunsFromThinToDenseAndGlowsTowardsTheSun) {
  DensityCloudSettings settings = publishedDensityClouds();
  const Vec3 sky{9, 9, 9};
  const auto colorAt = [&](float density, float cosine) { return densityCloudSample(0, density, cosine, sky, settings).color; };
  expectNear(colorAt(1e-6F, -1), Vec3{0.8F, 0.76F, 0.72F} * 0.65F);
  expectNear(colorAt(1, 1), Vec3{0.12F, 0.12F, 0.12F} * 0.65F);  // no glow where it is dense
  expectNear(colorAt(0.5F, 0), Vec3{0.46F, 0.44F, 0.42F} * 0.65F);
  expectNear(colorAt(0.5F, 1) - colorAt(0.5F, 0), Vec3{1, 0.7F, 0.4F} * 0.15F);
  expectNear(colorAt(0.5F, 0.8F) - colorAt(0.5F, 0), Vec3{1, 0.7F, 0.4F} * float(0.15 * std::pow(0.8, 6)));
  expectNear(colorAt(0.5F, -0.8F), colorAt(0.5F, 0));
  EXPECT_NEAR(densityCloudSample(0, 0.3F, 0, sky, settings).opacity, 0.15F, 1e-6);
  EXPECT_EQ(densityCloudSample(0, 0, 0, sky, settings).opacity, 0);
  settings.tint = {2, 1, 0};
  expectNear(colorAt(0.5F, 0), Vec3{0.92F, 0.44F, 0} * 0.65F);
}

TEST(DensityClouds, FarSamplesFadeToTheSky) {
  const DensityCloudSettings settings = publishedDensityClouds();
  const Vec3 sky{0.1F, 0.2F, 0.9F}, near = densityCloudSample(0, 0.5F, 0, sky, settings).color;
  for (const double t : {1.0, 10.0, 30.0}) {
    const float fade = float(1 - std::exp(-0.0018 * t * t));
    expectNear(densityCloudSample(float(t), 0.5F, 0, sky, settings).color, near * (1 - fade) + sky * fade);
  }
  expectNear(densityCloudSample(1000, 0.5F, 0, sky, settings).color, sky);
}

TEST(DensityClouds, StepIsThePublishedOneOrAPartOfIt) {
  DensityCloudSettings settings = publishedDensityClouds();
  settings.parts = 16;
  EXPECT_EQ(densityCloudStep(0.1F, settings), 0.1F);
  EXPECT_NEAR(densityCloudStep(10, settings), 3, 1e-6);
  // 3 units: 7 parts of at least 0.4, all of them as opaque as the whole.
  EXPECT_NEAR(densityCloudSample(10, 0, 0, {}, settings).step, 3.0 / 7, 1e-6);
  EXPECT_NEAR(densityCloudSample(10, 0.4F, 0, {}, settings).step, 3.0 / 7, 1e-6);
  EXPECT_NEAR(std::pow(1 - densityCloudSample(10, 0.4F, 0, {}, settings).opacity, 7), 0.8, 1e-5);
  EXPECT_NEAR(densityCloudSample(1000, 0, 0, {}, settings).step, 300.0 / 16, 1e-4);
  EXPECT_EQ(densityCloudSample(0.2F, 0, 0, {}, settings).step, 0.1F);
  // As many parts as fit, up to the limit.
  for (float t = 1; t < 40; t += 0.37F) {
    const double whole = densityCloudStep(t, settings);
    const double parts = std::max(1.0, std::min(16.0, std::floor(whole / double(settings.part_length))));
    EXPECT_NEAR(densityCloudSample(t, 0, 0, {}, settings).step, whole / parts, 1e-5) << t;
  }
  settings.parts = 1;
  EXPECT_NEAR(densityCloudSample(10, 0.4F, 0, {}, settings).step, 3, 1e-6);
  EXPECT_NEAR(densityCloudSample(10, 0.4F, 0, {}, settings).opacity, 0.2F, 1e-6);
}

// Both renderers with defaults, for what holds of every picture.
struct Renderer {
  const char* name;
  Layer (*render)(const Camera&, float scale, uint32_t seed, int samples_per_side);
};
const Renderer kRenderers[] = {
    {"distance",
     [](const Camera& camera, float scale, uint32_t seed, int n) {
       DistanceCloudSettings settings;
       settings.scale = scale, settings.seed = seed, settings.samples_per_side = n;
       return renderDistanceClouds(camera, {}, settings);
     }},
    {"density",
     [](const Camera& camera, float scale, uint32_t seed, int n) {
       DensityCloudSettings settings;
       settings.scale = scale, settings.seed = seed, settings.samples_per_side = n;
       return renderDensityClouds(camera, {}, settings);
     }},
};

void expectValid(const Layer& layer) {
  for (const LayerPixel& pixel : layer.pixels) {
    ASSERT_TRUE(isFinite(pixel.color));
    ASSERT_TRUE(pixel.opacity >= 0 && pixel.opacity <= 1);
    ASSERT_TRUE(pixel.distance >= 0);
    ASSERT_EQ(std::isfinite(pixel.distance), pixel.opacity > 0);
  }
}

double cover(const Layer& layer) {
  double sum = 0;
  for (const LayerPixel& pixel : layer.pixels) sum += pixel.opacity;
  return sum / double(layer.pixels.size());
}

TEST(MarchedClouds, SameBytesForAnyNumberOfThreadsAndOthersForOtherSeeds) {
  const Camera camera = marchedCamera(directionFromAngles(20, 40));
  for (const Renderer& renderer : kRenderers) {
    const auto render = [&](size_t threads, uint32_t seed) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return renderer.render(camera, 1, seed, 2);
    };
    const Layer one = render(1, 0), seven = render(7, 0), other = render(1, 1);
    const size_t bytes = one.pixels.size() * sizeof(LayerPixel);
    EXPECT_EQ(std::memcmp(one.pixels.data(), seven.pixels.data(), bytes), 0) << renderer.name;
    EXPECT_NE(std::memcmp(one.pixels.data(), other.pixels.data(), bytes), 0) << renderer.name;
    EXPECT_GT(cover(one), 0.05) << renderer.name;
    EXPECT_NEAR(cover(renderer.render(camera, 1, 0, 3)), cover(one), 0.02) << renderer.name;
  }
}

// A ray is the same alone and beside others, which ask for other noises and end earlier or later.
TEST(MarchedClouds, AreTheSameInAnyCompany) {
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.push_back({float(i) * 3.7F, 0.1F * float(i), float(i % 7) * 5.3F});
  const Vec3 to_light = directionFromAngles(20, 25);
  const auto expectSame = [&](const auto& pass) {
    std::vector<float> together(points.size(), 1), alone(points.size(), 1);
    pass(points, together);
    for (size_t i = 0; i < points.size(); ++i) pass({&points[i], 1}, std::span(&alone[i], 1));
    EXPECT_EQ(together, alone);
    EXPECT_GT(std::count_if(alone.begin(), alone.end(), [](float share) { return share > 0.01F && share < 0.99F; }), 10);
  };
  expectSame([&](std::span<const Vec3> some, std::span<float> shares) { passDistanceClouds(some, to_light, {}, shares); });
  expectSame([&](std::span<const Vec3> some, std::span<float> shares) { passDensityClouds(some, to_light, {}, shares); });
}

// A world four times as large, seen from a place four times as far, is the same picture; distances are four times as long.
TEST(MarchedClouds, ScaleOnlyScales) {
  const Camera camera = marchedCamera(directionFromAngles(20, 40), {1, 0.5F, 2});
  Camera larger = camera;
  larger.look_from = camera.look_from * 4;
  larger.look_at = larger.look_from + (camera.look_at - camera.look_from);
  for (const Renderer& renderer : kRenderers) {
    const Layer a = renderer.render(camera, 1, 0, 1), b = renderer.render(larger, 4, 0, 1);
    for (size_t i = 0; i < a.pixels.size(); ++i) {
      ASSERT_NEAR(a.pixels[i].opacity, b.pixels[i].opacity, 0.02) << renderer.name;
      if (a.pixels[i].opacity < 0.1F) continue;
      ASSERT_NEAR(a.pixels[i].distance * 4, b.pixels[i].distance, 0.02 * b.pixels[i].distance);
    }
  }
}

TEST(MarchedClouds, LieAtTheHeightOfTheirLayerAndNotBelowTheHorizon) {
  const Vec3 from{0, 0.5F, 0};
  for (const Renderer& renderer : kRenderers) {
    const Camera up = marchedCamera(directionFromAngles(20, 45), from), down = marchedCamera({0, -1, 0}, from);
    const Layer layer = renderer.render(up, 1, 0, 1);
    // Bands of 8 ± 0.4/0.06 and 10.8 ± 1/0.15: a mean of places in it lies in it.
    const float low = 1.3F, high = 17.5F;
    for (int y = 0; y < up.height; ++y)
      for (int x = 0; x < up.width; ++x) {
        if (layer.at(x, y).opacity <= 0) continue;
        const float height = from.y + layer.at(x, y).distance * cameraRay(up, float(x) + 0.5F, float(y) + 0.5F).direction.y;
        EXPECT_TRUE(height > low && height < high) << renderer.name << ' ' << height;
      }
    EXPECT_EQ(cover(renderer.render(down, 1, 0, 1)), 0) << renderer.name;
    // From above, clouds lie below.
    EXPECT_GT(cover(renderer.render(marchedCamera({0, -1, 0}, {0, 25, 0}), 1, 0, 1)), 0.02) << renderer.name;
    EXPECT_EQ(cover(renderer.render(marchedCamera({0, 1, 0}, {0, 25, 0}), 1, 0, 1)), 0) << renderer.name;
  }
}

// From inside the layer, where the search begins at the camera: every pixel is the sum of its samples.
TEST(MarchedClouds, PicturesAreTheSumsOfTheirSamples) {
  SkySettings sky;
  sky.to_sun = directionFromAngles(70, 35);
  const Camera camera = marchedCamera(directionFromAngles(20, 30), {0, 3, 0}, 16, 12);
  const auto expectSums = [&](const DistanceCloudSettings& distance, const DensityCloudSettings& density) {
    const Layer by_distance = renderDistanceClouds(camera, sky, distance), by_density = renderDensityClouds(camera, sky, density);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
        const auto at = [&](float t) { return ray.origin + ray.direction * t; };
        const auto expectPixel = [&](const LayerPixel& found, const LayerPixel& expected) {
          EXPECT_NEAR(found.opacity, expected.opacity, 1e-5);
          expectNear(found.color, expected.color, 1e-4);
          if (std::isfinite(expected.distance)) {
            EXPECT_NEAR(found.distance, expected.distance, 1e-3);
          }
        };
        const float first = findDistanceCloud([&](float t) { return distanceCloudField(at(t), distance); }, 0, distance);
        expectPixel(by_distance.at(x, y), accumulateSamples(first, 128, 0.99F, [&](float t) {
                      const float there = distanceCloudDensity(at(t), distance);
                      return distanceCloudSample(t, there, distanceCloudDensity(at(t) + sky.to_sun, distance), distance);
                    }));
        const float cosine = dot(ray.direction, sky.to_sun);
        expectPixel(by_density.at(x, y), accumulateSamples(0.1F, 64 * 16, 0.99F, [&](float t) {
                      return densityCloudSample(t, densityCloudDensity(at(t), density), cosine, skyColor(ray.direction, sky), density);
                    }));
      }
    EXPECT_GT(cover(by_distance), 0.05);
    EXPECT_GT(cover(by_density), 0.1);
  };
  DistanceCloudSettings distance;
  distance.dither = 0;
  DensityCloudSettings density;
  density.dither = 0;
  expectSums(distance, density);
  // Clouds up to the ends of the band of heights, seen from its middle.
  distance.cloud_height = density.cloud_height = camera.look_from.y;
  distance.noise_offset = 9, distance.flatness = 1, distance.opacity_factor = 0.02F;
  density.noise_strength = 0, density.opacity_factor = 0.05F;
  expectSums(distance, density);
}

// A deck with openings, white in the sun: neither a haze nor a lid.
TEST(DensityClouds, DefaultsAreADeckWithOpenings) {
  const auto shareOf = [](const DensityCloudSettings& settings, float opacity) {
    size_t over = 0, all = 0;
    for (const float azimuth : {20.0F, 140.0F, 260.0F}) {
      const Layer layer = renderDensityClouds(marchedCamera(directionFromAngles(azimuth, 40), {0, 2, 0}), {}, settings);
      for (const LayerPixel& pixel : layer.pixels) over += pixel.opacity > opacity, ++all;
    }
    return double(over) / double(all);
  };
  EXPECT_GT(shareOf({}, 0.5F), 0.3) << "clouds that hide the sky";
  EXPECT_LT(shareOf({}, 0.1F), 0.95) << "openings";
  EXPECT_LT(shareOf(publishedDensityClouds(), 0.5F), 0.5 * shareOf({}, 0.5F)) << "the source's constants are a haze under this sky";
  float brightest = 0;
  for (const LayerPixel& pixel : renderDensityClouds(marchedCamera(directionFromAngles(20, 40)), {}).pixels)
    if (pixel.opacity > 0.5F) brightest = std::max(brightest, pixel.color.y);
  EXPECT_GT(brightest, 0.7F);
}

// Seen along the layer's own plane without noise: the closed sum of the published samples.
TEST(DensityClouds, HomogeneousFogIsTheClosedSum) {
  DensityCloudSettings settings;
  settings.noise_strength = 0, settings.flatness = 0, settings.opacity_factor = 0.02F, settings.dither = 0;
  const Camera camera = marchedCamera({0, 0, -1}, {0, 10.8F, 0}, 3, 3);
  for (const int parts : {1, 16}) {
    settings.parts = parts;
    settings.samples = 10;
    const Layer layer = renderDensityClouds(camera, {}, settings);
    // With parts 160 samples, of which those before t = 2.67 are whole steps.
    double clear = 1, t = 0.1;
    for (int i = 0; i < 10 * parts; ++i) {
      const double whole = std::max(0.1, 0.3 * t), n = std::clamp(std::floor(whole / 0.4), 1.0, double(parts));
      clear *= std::pow(0.98, 1 / n);
      t += whole / n;
    }
    for (const LayerPixel& pixel : layer.pixels) EXPECT_NEAR(pixel.opacity, std::min(1 - clear, 1.0), 0.02 * (1 - clear)) << parts;
  }
}

// Homogeneous fog of the opacity a per step h has T(t) = (1 − a)^(t/h) up to a surface at t, and the rest behind it, wherever the surface
// is between two samples.
TEST(DensityClouds, FogIsCutAtASurface) {
  DensityCloudSettings settings;
  settings.noise_strength = 0, settings.flatness = 0, settings.opacity_factor = 0.01F, settings.dither = 0;
  settings.first_t = 1e-6F, settings.least_step = 2, settings.step_growth = 1e-9F, settings.parts = 1, settings.samples = 50;
  settings.fade_density = 0;
  const Camera camera = marchedCamera({0, 0, -1}, {0, 10.8F, 0}, 3, 3);
  for (const float scale : {1.0F, 20.0F}) {
    settings.scale = scale;
    settings.cloud_height = 10.8F / scale;
    for (const float distance : {0.3F, 4.0F, 4.99F, 77.7F, 150.0F}) {
      Layer near = blankLayer(3, 3), far = near;
      for (LayerPixel& pixel : near.pixels) pixel = {{}, 0.5F, distance * scale};
      for (LayerPixel& pixel : far.pixels) pixel = {{}, 0.5F, 90 * scale};
      const std::vector<Layer> parts = renderDensityClouds(camera, {}, settings, std::vector{far, near});
      ASSERT_EQ(parts.size(), 3U);
      const double cuts[]{0, std::min(distance, 90.0F), std::min(100.0F, std::max(distance, 90.0F)), 100};
      for (size_t part = 0; part < 3; ++part) {
        const double clear = std::pow(0.99, (std::max(cuts[part], cuts[part + 1]) - cuts[part]) / 2);
        for (const LayerPixel& pixel : parts[part].pixels) {
          EXPECT_NEAR(pixel.opacity, 1 - clear, 2e-5) << distance << " part " << part;
          EXPECT_TRUE(pixel.opacity == 0 ||
                      (pixel.distance >= cuts[part] * scale - 1e-3 && pixel.distance <= cuts[part + 1] * scale + 1e-3));
        }
      }
    }
  }
}

// The parts over each other are the whole, and an opaque surface leaves only what is before it.
template <typename Settings, typename Render>
void expectCuts(const Camera& camera, const Settings& settings, const Render& render) {
  const Layer whole = render(camera, settings, std::span<const Layer>()).front();
  int divided = 0;
  for (const float opacity : {0.5F, 1.0F})
    for (const float distance : {2.0F, 9.0F, 20.0F, 45.0F}) {
      Layer surface = blankLayer(camera.width, camera.height);
      for (LayerPixel& pixel : surface.pixels) pixel = {{}, opacity, distance};
      const std::vector<Layer> parts = render(camera, settings, std::span<const Layer>(&surface, 1));
      for (size_t i = 0; i < whole.pixels.size(); ++i) {
        const LayerPixel &front = parts[0].pixels[i], &back = parts[1].pixels[i], &all = whole.pixels[i];
        EXPECT_TRUE(front.opacity == 0 || front.distance <= distance) << front.distance;
        if (opacity == 1) {
          EXPECT_EQ(back.opacity, 0);
          EXPECT_LE(front.opacity, all.opacity + 1e-6F);
          continue;
        }
        EXPECT_TRUE(back.opacity == 0 || back.distance >= distance) << back.distance;
        ASSERT_NEAR(1 - (1 - front.opacity) * (1 - back.opacity), all.opacity, 2e-5);
        const Vec3 color = front.color * front.opacity + back.color * (back.opacity * (1 - front.opacity));
        ASSERT_LT(length(color - all.color * all.opacity), 2e-5F);
        divided += front.opacity > 0.02F && back.opacity > 0.02F;
      }
    }
  EXPECT_GT(divided, 20);
}

TEST(MarchedClouds, AreCutAtASurface) {
  const Camera camera = marchedCamera(directionFromAngles(20, 20), {0, 3, 0}, 24, 18);
  expectCuts(camera, DistanceCloudSettings{},
             [](const Camera& from, const DistanceCloudSettings& settings, std::span<const Layer> surfaces) {
               return renderDistanceClouds(from, {}, settings, surfaces);
             });
  expectCuts(camera, DensityCloudSettings{}, [](const Camera& from, const DensityCloudSettings& settings, std::span<const Layer> surfaces) {
    return renderDensityClouds(from, {}, settings, surfaces);
  });
}

// Far clouds have the sky's own colour.
TEST(DensityClouds, FadeIntoTheSkyOfTheirDirection) {
  DensityCloudSettings settings;
  settings.fade_density = 100;
  const Camera camera = marchedCamera(directionFromAngles(20, 40));
  const Layer layer = renderDensityClouds(camera, {}, settings);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (layer.at(x, y).opacity > 0)
        expectNear(layer.at(x, y).color, skyColor(cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F).direction, {}), 1e-3);
}

TEST(MarchedClouds, FiniteEverywhereAndForExtremeSettings) {
  std::vector<DistanceCloudSettings> distance(7);
  distance[1].flatness = 0;
  distance[2].flatness = 100;
  distance[3].noise_frequency = 1e3F;
  distance[4].scale = 1e-6F;
  distance[5].scale = 1e9F;
  distance[6].noise_offset = 100;
  std::vector<DensityCloudSettings> density(8);
  density[1].flatness = 0;
  density[2].flatness = 100;
  density[3].noise_frequency = 1e3F;
  density[4].scale = 1e-6F;
  density[5].scale = 1e9F;
  density[6].opacity_factor = 1, density[6].noise_strength = 0;
  density[7].fade_density = 0;
  for (const Vec3 from : {Vec3{0, 0.5F, 0}, Vec3{0, 8, 0}, Vec3{0, 10.8F, 0}, Vec3{1e30F, -1e30F, 3}, Vec3{0, 900, 0}})
    for (const Vec3 towards : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0.6F, 0.8F, 0}}) {
      const Camera camera = marchedCamera(towards, from, 5, 3);
      for (const DistanceCloudSettings& settings : distance) expectValid(renderDistanceClouds(camera, {}, settings));
      for (const DensityCloudSettings& settings : density) expectValid(renderDensityClouds(camera, {}, settings));
    }
}

TEST(MarchedClouds, RefuseSettingsOutOfRange) {
  const Camera camera = marchedCamera({0, 1, 0}, {}, 2, 2);
  const auto expectDistanceRefused = [&](const auto& change) {
    DistanceCloudSettings settings;
    change(settings);
    EXPECT_THROW(renderDistanceClouds(camera, {}, settings), std::invalid_argument);
  };
  expectDistanceRefused([](auto& s) { s.scale = 0; });
  expectDistanceRefused([](auto& s) { s.octaves = 0; });
  expectDistanceRefused([](auto& s) { s.least_step = 0; });
  expectDistanceRefused([](auto& s) { s.samples = 0; });
  expectDistanceRefused([](auto& s) { s.flatness = NAN; });
  expectDistanceRefused([](auto& s) { s.shadow_tuning = -4; });
  const auto expectDensityRefused = [&](const auto& change) {
    DensityCloudSettings settings;
    change(settings);
    EXPECT_THROW(renderDensityClouds(camera, {}, settings), std::invalid_argument);
  };
  expectDensityRefused([](auto& s) { s.scale = -1; });
  expectDensityRefused([](auto& s) { s.parts = 0; });
  expectDensityRefused([](auto& s) { s.opacity_factor = 1.5F; });
  expectDensityRefused([](auto& s) { s.least_step = 0; });
  expectDensityRefused([](auto& s) { s.samples_per_side = 0; });
}

// Light comes through as much as an eye sees of it: homogeneous fog by its closed sum, noise by the samples of a ray.
TEST(MarchedClouds, LetThroughWhatIsNotOpaque) {
  const Vec3 light = directionFromAngles(40, 70);
  std::vector<Vec3> points;
  for (float x = -30; x < 30; x += 2.5F) points.push_back({x, 1, 0.3F * x});
  std::vector<float> by_distance(points.size(), 0.5F), by_density(points.size(), 0.5F);
  DistanceCloudSettings distance;
  DensityCloudSettings density;
  density.scale = 2;
  passDistanceClouds(points, light, distance, by_distance);
  passDensityClouds(points, light, density, by_density);
  float darkest = 1, lightest = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const float first = findDistanceCloud([&](float t) { return distanceCloudField(points[i] + light * t, distance); }, 0, distance);
    const LayerPixel seen = accumulateSamples(first, distance.samples, distance.stop_opacity, [&](float t) {
      const Vec3 p = points[i] + light * t;
      return distanceCloudSample(t, distanceCloudDensity(p, distance), distanceCloudDensity(p + light, distance), distance);
    });
    EXPECT_NEAR(by_distance[i], 0.5F * (1 - seen.opacity), 0.02F);
    const LayerPixel through = accumulateSamples(density.first_t, density.samples * density.parts, density.stop_opacity, [&](float t) {
      return densityCloudSample(t, densityCloudDensity(points[i] / density.scale + light * t, density), 0, {}, density);
    });
    EXPECT_NEAR(by_density[i], 0.5F * (1 - through.opacity), 1e-4F);
    darkest = std::min(darkest, by_density[i]), lightest = std::max(lightest, by_density[i]);
  }
  EXPECT_LT(darkest, 0.2F);
  EXPECT_GT(lightest, 0.3F);
}

// Where no light comes the sky's share of the colour is left, sample by sample.
TEST(MarchedClouds, AreShadowedAtTheirSamples) {
  const Camera camera = marchedCamera(directionFromAngles(20, 30), {0, 3, 0}, 16, 12);
  const Vec3 left{0.2F, 0.3F, 0.4F};
  const MarchedShadow all{[](std::span<const Vec3>, std::span<float> shares) { std::fill(shares.begin(), shares.end(), 0.0F); }, left};
  const auto above = [&](float height) {
    return MarchedShadow{[height](std::span<const Vec3> points, std::span<float> shares) {
                           for (size_t i = 0; i < points.size(); ++i) shares[i] *= points[i].y > height ? 0.0F : 1.0F;
                         },
                         left};
  };
  DensityCloudSettings density;
  density.fade_density = 0;
  const auto compare = [&](const Layer& plain, const Layer& dark, const Layer& partly) {
    int between = 0;
    for (size_t i = 0; i < plain.pixels.size(); ++i) {
      ASSERT_EQ(plain.pixels[i].opacity, dark.pixels[i].opacity);
      const Vec3 p = plain.pixels[i].color, d = dark.pixels[i].color, some = partly.pixels[i].color;
      expectNear(d, {p.x * left.x, p.y * left.y, p.z * left.z}, 1e-5);
      EXPECT_TRUE(some.x <= p.x + 1e-5F && some.x >= d.x - 1e-5F);
      between += some.x < 0.95F * p.x && some.x > 1.2F * d.x;
    }
    EXPECT_GT(between, 10);
  };
  compare(renderDistanceClouds(camera, {}, {}, {}).front(), renderDistanceClouds(camera, {}, {}, {}, all).front(),
          renderDistanceClouds(camera, {}, {}, {}, above(7)).front());
  compare(renderDensityClouds(camera, {}, density, {}).front(), renderDensityClouds(camera, {}, density, {}, all).front(),
          renderDensityClouds(camera, {}, density, {}, above(9)).front());
}

}  // namespace
}  // namespace cloudbake
