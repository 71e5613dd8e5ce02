// Slab clouds: every number of their definition, and pictures that hold together.
#include "preview/backdrop/slab_clouds.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "preview/camera.h"
#include "tests/preview/preview_helpers.h"

namespace cloudbake {
namespace {

Camera slabCamera(Vec3 direction, Vec3 from = {0, 0.5F, 0}, int width = 48, int height = 36) {
  return {from, from + direction, 70, width, height};
}

// Any mixture becomes noise 1, so that v is 1 everywhere: the slab is full from bottom to top.
SlabSettings fullSlab() {
  SlabSettings settings;
  settings.threshold = 0, settings.smooth_low = 0, settings.smooth_high = 1e-6F;
  settings.dither = 0;
  return settings;
}

TEST(SlabClouds, DefaultsAreThePublishedConstants) {
  const SlabSettings settings;
  EXPECT_EQ(settings.shadow_limit, 0.33F);
  EXPECT_EQ(settings.middle_limit, 0.66F);
  EXPECT_EQ(settings.self_shadow, 0.85F);
  EXPECT_EQ(settings.self_shadow_gain, 0.5F);
  EXPECT_EQ(settings.outline_strength, 0.3F);
  EXPECT_EQ(settings.horizon_start, 0.05F);
  EXPECT_EQ(settings.horizon_gain, 5);
}

TEST(SlabClouds, ProfileSwellsAroundTheMiddleAboveTheThreshold) {
  SlabSettings settings;
  settings.bottom = 2, settings.center = 3, settings.top = 7, settings.threshold = 0.5F;
  const auto expectProfile = [&](float noise, float lower, float upper) {
    EXPECT_NEAR(slabProfile(noise, settings).lower, lower, 1e-5) << noise;
    EXPECT_NEAR(slabProfile(noise, settings).upper, upper, 1e-5) << noise;
  };
  expectProfile(1, 2, 7);
  expectProfile(0.5F, 3, 3);
  expectProfile(0.75F, 2.5F, 5);    // v = 1/2
  expectProfile(0.6F, 2.8F, 3.8F);  // v = 1/5
  EXPECT_GT(slabProfile(0.4F, settings).lower, slabProfile(0.4F, settings).upper);
}

TEST(SlabClouds, ThicknessGrowsByTheSmallerOfStepAndCloud) {
  const SlabProfile profile{4, 6};
  EXPECT_EQ(slabThickening(5, 0.3F, profile, 0.2F), 0.3F);
  EXPECT_EQ(slabThickening(5, 9, profile, 0.2F), 2);
  // The skin: Hermite's step from all at the surface to nothing at its width.
  for (const float y : {6.0F, 4.0F}) EXPECT_NEAR(slabThickening(y, 0.3F, profile, 0.2F), 0.3F, 1e-6);
  for (const float y : {6.1F, 3.9F}) EXPECT_NEAR(slabThickening(y, 0.3F, profile, 0.2F), 0.15F, 1e-5);
  for (const float y : {6.05F, 3.95F}) EXPECT_NEAR(slabThickening(y, 0.3F, profile, 0.2F), 0.3F * 0.84375F, 1e-4);
  for (const float y : {6.21F, 3.79F, 100.0F}) EXPECT_EQ(slabThickening(y, 0.3F, profile, 0.2F), 0);
  // Clear sky has no skin.
  EXPECT_EQ(slabThickening(5, 0.3F, {5, 5}, 0.2F), 0);
  EXPECT_EQ(slabThickening(5, 0.3F, {5.1F, 4.9F}, 0.2F), 0);
}

TEST(SlabClouds, OpacityIsTheClampedThickness) {
  SlabSettings slab;
  slab.edge_width = 0.25F;
  EXPECT_NEAR(slabOpacity(0.3F, 1, slab), 0.6F, 1e-6);
  EXPECT_NEAR(slabOpacity(0.3F, 0.5F, slab), 0.3F, 1e-6);
  EXPECT_EQ(slabOpacity(0.51F, 1, slab), 1);
  EXPECT_EQ(slabOpacity(1e9F, 0.1F, slab), 1);
  EXPECT_EQ(slabOpacity(0, 0.5F, slab), 0);
}

TEST(SlabClouds, DenIsTheDepthUnderTheUpperSurfaceClamped) {
  SlabSettings settings;
  settings.bottom = 2, settings.center = 3, settings.top = 6;
  EXPECT_NEAR(slabDen(3, 5, settings), 0.5F, 1e-6);
  EXPECT_NEAR(slabDen(2, 6, settings), 1, 1e-6);
  EXPECT_EQ(slabDen(5, 5, settings), 1e-4F);
  EXPECT_EQ(slabDen(7, 5, settings), 1e-4F);
  EXPECT_EQ(slabDen(-9, 5, settings), 1);
}

Vec3 selfShadowed(Vec3 tone, float den) { return tone * (1 - 0.15F * 0.5F * den * den); }

TEST(SlabClouds, TonesChangeAtTheirLimits) {
  SlabSettings settings;
  settings.tone_softness = 0;
  const SlabTones& tones = settings.tones;
  for (const float den : {1e-4F, 0.2F, 0.3299F}) expectNear(slabTone(den, 1, settings), selfShadowed(tones.shadow, den));
  for (const float den : {0.3301F, 0.5F, 0.6599F}) expectNear(slabTone(den, 1, settings), selfShadowed(tones.middle, den));
  for (const float den : {0.6601F, 0.8F, 1.0F}) {
    expectNear(slabTone(den, -0.5F, settings), selfShadowed(tones.light, den));
    expectNear(slabTone(den, 0, settings), selfShadowed(tones.light, den));
    expectNear(slabTone(den, 0.25F, settings), selfShadowed(tones.light * 0.75F + tones.highlight * 0.25F, den));
    expectNear(slabTone(den, 1, settings), selfShadowed(tones.highlight, den));
  }
  settings.bright = 0.5F;
  expectNear(slabTone(0.7F, 1, settings), selfShadowed(tones.light * 0.5F + tones.highlight * 0.5F, 0.7F));
}

TEST(SlabClouds, SoftTonesMeetHalfwayAtTheirLimits) {
  SlabSettings settings;
  settings.tone_softness = 0.05F;
  const SlabTones& tones = settings.tones;
  expectNear(slabTone(0.33F, 0, settings), selfShadowed((tones.shadow + tones.middle) * 0.5F, 0.33F));
  expectNear(slabTone(0.66F, 0, settings), selfShadowed((tones.middle + tones.light) * 0.5F, 0.66F));
  expectNear(slabTone(0.279F, 0, settings), selfShadowed(tones.shadow, 0.279F));
  expectNear(slabTone(0.381F, 0, settings), selfShadowed(tones.middle, 0.381F));
  expectNear(slabTone(0.711F, 0, settings), selfShadowed(tones.light, 0.711F));
}

TEST(SlabClouds, HorizonFadesInByTheFormula) {
  const SlabSettings settings;
  for (const float y : {-1.0F, 0.0F, 0.05F}) EXPECT_EQ(slabHorizonFade(y, settings), 0);
  EXPECT_NEAR(slabHorizonFade(0.07F, settings), 0.1F, 1e-6);
  EXPECT_NEAR(slabHorizonFade(0.15F, settings), 0.5F, 1e-6);
  EXPECT_NEAR(slabHorizonFade(0.25F, settings), 1, 1e-6);
  EXPECT_EQ(slabHorizonFade(0.8F, settings), 1);
}

TEST(SlabClouds, NightIsDarkerThanDay) {
  const SlabSettings settings;
  EXPECT_EQ(slabNightFactor(skyColorsForSun(0.5F), settings), 1);
  SkyColors black;
  EXPECT_EQ(slabNightFactor(black, settings), settings.night_light);
  black.zenith = {0.1F, 0.1F, 0.1F};  // the mean with the horizon has the luminance 0.05
  EXPECT_NEAR(slabNightFactor(black, settings), settings.night_light + (1 - settings.night_light) * 0.05F / settings.day_luminance, 1e-5);
}

TEST(SlabClouds, NoiseHasItsDerivatives) {
  SlabSettings settings;
  settings.noise_scale = 2;
  settings.time_seconds = 30;
  settings.low_share = 0.3F;
  double largest = 0;
  for (float x = -7.3F; x < 8; x += 1.7F)
    for (float z = -5.1F; z < 6; z += 1.3F) {
      const float h = 0.004F;
      const Noise2 noise = slabNoise(x, z, settings);
      EXPECT_GE(noise.value, 0);
      EXPECT_LE(noise.value, 1);
      EXPECT_NEAR(noise.gradient.x, (slabNoise(x + h, z, settings).value - slabNoise(x - h, z, settings).value) / (2 * h), 0.02);
      EXPECT_NEAR(noise.gradient.y, (slabNoise(x, z + h, settings).value - slabNoise(x, z - h, settings).value) / (2 * h), 0.02);
      largest = std::max(largest, std::hypot(double(noise.gradient.x), double(noise.gradient.y)));
    }
  EXPECT_GT(largest, 0.3);
}

// Each noise alone is carried by its drift; the low one is read with x and z exchanged.
TEST(SlabClouds, TimeMovesBothNoisesByTheirDrifts) {
  SlabSettings now, later;
  later.time_seconds = 50;
  for (const float share : {0.0F, 1.0F}) {
    now.low_share = later.low_share = share;
    Vec2 drift = share == 0 ? now.high_drift : Vec2{now.low_drift.y, now.low_drift.x};
    drift = {drift.x * 50 * now.noise_scale, drift.y * 50 * now.noise_scale};
    for (float x = -9; x < 9; x += 2.3F)
      EXPECT_NEAR(slabNoise(x + drift.x, 3 + drift.y, later).value, slabNoise(x, 3, now).value, 1e-4) << share;
  }
  // Two noises, not one and its mirror image.
  SlabSettings high, low;
  high.low_share = 0, low.low_share = 1;
  EXPECT_GT(std::abs(slabNoise(3, 8, high).value - slabNoise(8, 3, low).value), 1e-3);
}

TEST(SlabClouds, NoiseEndsFarOutsideFloat) {
  const SlabSettings settings;
  for (const float far : {1e7F, -1e7F, -1e20F, INFINITY, NAN}) {
    EXPECT_EQ(slabNoise(far, 0, settings).value, 0);
    EXPECT_EQ(slabNoise(0, far, settings).value, 0);
  }
}

TEST(SlabClouds, RayThroughAFullSlabMeetsItsBottom) {
  const SlabSettings settings = fullSlab();
  for (const float elevation : {90.0F, 40.0F, 10.0F}) {
    const Vec3 view = directionFromAngles(20, elevation);
    const SlabHit hit = marchSlab({{1, 0.5F, 2}, view}, 0, settings);
    EXPECT_NEAR(hit.distance, 3.5F / view.y, 1e-3 * hit.distance);
    EXPECT_NEAR(hit.den, 1, 1e-4);
    EXPECT_NEAR(hit.facing, view.y, 1e-4);  // its normal points down
    EXPECT_EQ(hit.opacity, 1);
  }
  // From inside it begins at the camera; from above there is nothing.
  const SlabHit inside = marchSlab({{0, 5.5F, 0}, {0, 1, 0}}, 0, settings);
  EXPECT_EQ(inside.distance, 0);
  EXPECT_NEAR(inside.den, 0.5F, 1e-5);
  EXPECT_EQ(marchSlab({{0, 7.5F, 0}, {0, 1, 0}}, 0, settings).opacity, 0);
}

TEST(SlabClouds, ThicknessIsThePathUntilItIsOpaque) {
  SlabSettings settings = fullSlab();
  settings.edge_width = 5;  // opaque from 10 units of height on; the slab has 3
  for (const float elevation : {90.0F, 40.0F, 20.0F}) {
    const Vec3 view = directionFromAngles(0, elevation);
    const SlabHit hit = marchSlab({{0, 0, 0}, view}, 0.5F, settings);
    // The cloud is 3 high, more than a step.
    EXPECT_NEAR(hit.thickness, 3 / view.y, 1e-3 / view.y);
    EXPECT_NEAR(hit.opacity, 0.3F, 1e-3);
  }
}

// Of any cloud: the distance lies on its skin, whatever the steps and their jitter.
TEST(SlabClouds, FirstContactIsOnTheSkin) {
  SlabSettings settings;
  int found = 0;
  for (float azimuth = 0; azimuth < 360; azimuth += 7) {
    const Ray ray{{0, 0.5F, 0}, directionFromAngles(azimuth, 35)};
    const SlabHit hit = marchSlab(ray, 0.3F, settings);
    if (hit.opacity <= 0) continue;
    const Vec3 p = ray.origin + ray.direction * hit.distance, before = p - ray.direction * 0.002F;
    const auto thickening = [&](Vec3 q) {
      return slabThickening(q.y, 1, slabProfile(slabNoise(q.x, q.z, settings).value, settings), settings.edge_width);
    };
    EXPECT_GT(thickening(p), 0);
    EXPECT_EQ(before.y > settings.bottom ? thickening(before) : 0, 0);
    ++found;
  }
  EXPECT_GT(found, 10);
}

TEST(SlabClouds, RaysThatDoNotRiseMeetNothing) {
  const SlabSettings settings = fullSlab();
  for (const float y : {0.0F, -0.0F, -0.1F, -1.0F})
    EXPECT_EQ(marchSlab({{0, 0.5F, 0}, {std::sqrt(1 - y * y), y, 0}}, 0, settings).opacity, 0) << y;
  EXPECT_EQ(marchSlab({{0, 5.5F, 0}, {1, 1e-39F, 0}}, 0.5F, settings).opacity, 0) << "from inside, it leaves beyond the range of float";
  const Camera camera = slabCamera({0, 0, -1});
  const Layer layer = renderSlabClouds(camera, settings);
  int above = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const float view_y = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F).direction.y;
      EXPECT_NEAR(layer.at(x, y).opacity, std::clamp((view_y - 0.05F) * 5, 0.0F, 1.0F), 1e-5);
      EXPECT_EQ(std::isfinite(layer.at(x, y).distance), view_y > 0.05F);
      above += view_y > 0.1F;
    }
  EXPECT_GT(above, 100);
}

TEST(SlabClouds, OutlineDarkensWhereTheOpacityChanges) {
  SlabSettings settings;
  EXPECT_EQ(slabEdge(0, settings), 0);
  EXPECT_EQ(slabEdge(settings.outline_start, settings), 0);
  EXPECT_NEAR(slabEdge((settings.outline_start + settings.outline_full) / 2, settings), 0.5F, 1e-5);
  EXPECT_EQ(slabEdge(settings.outline_full, settings), 1);

  const Camera camera = slabCamera(directionFromAngles(20, 40), {0, 0.5F, 0}, 160, 120);
  const Layer drawn = renderSlabClouds(camera, settings);
  settings.outline_strength = 0;
  const Layer plain = renderSlabClouds(camera, settings);
  int outlined = 0, same = 0;
  for (size_t i = 0; i < drawn.pixels.size(); ++i) {
    if (drawn.pixels[i].opacity <= 0) continue;
    const Vec3 change = drawn.pixels[i].color - plain.pixels[i].color;
    EXPECT_LE(length(change), 0.301F * length(settings.tones.outline - plain.pixels[i].color));
    (length(change) > 0.05F ? outlined : same) += 1;
  }
  EXPECT_GT(outlined, 50);
  EXPECT_GT(same, outlined);
}

TEST(SlabClouds, MeanOfSamplesKeepsThePicture) {
  const Camera camera = slabCamera(directionFromAngles(20, 30));
  SlabSettings settings;
  const auto cover = [&](int n) {
    settings.samples_per_side = n;
    double sum = 0;
    for (const LayerPixel& pixel : renderSlabClouds(camera, settings).pixels) sum += pixel.opacity;
    return sum / (camera.width * camera.height * n * n);
  };
  const double one = cover(1);
  EXPECT_GT(one, 0.1);
  EXPECT_NEAR(cover(3), one, 0.01);
}

// A surface that a cloud passes through: the parts before and behind it over each other are the cloud, wherever the surface is. An opaque
// one leaves only what is before it, and that grows with its distance.
TEST(SlabClouds, AreCutAtASurface) {
  const Camera camera = slabCamera(directionFromAngles(20, 35), {0, 1, 0}, 40, 30);
  SlabSettings settings;
  settings.outline_strength = 0;
  const Layer whole = renderSlabClouds(camera, settings);
  double last = 0;
  int divided = 0;
  for (const float distance : {3.0F, 6.0F, 8.0F, 10.0F, 14.0F, 100.0F}) {
    Layer surface = blankLayer(camera.width, camera.height);
    for (LayerPixel& pixel : surface.pixels) pixel = {{}, 0.25F, distance};
    const std::vector<Layer> parts = renderSlabClouds(camera, settings, {&surface, 1});
    ASSERT_EQ(parts.size(), 2U);
    double before = 0;
    for (size_t i = 0; i < whole.pixels.size(); ++i) {
      const LayerPixel &front = parts[0].pixels[i], &back = parts[1].pixels[i];
      ASSERT_NEAR(1 - (1 - front.opacity) * (1 - back.opacity), whole.pixels[i].opacity, 1e-5);
      if (front.opacity > 0) {
        EXPECT_LE(front.distance, distance);
        EXPECT_LT(length(front.color - whole.pixels[i].color), 1e-5F) << "the first contact is the same";
      }
      EXPECT_TRUE(back.opacity == 0 || back.distance >= distance) << back.distance;
      divided += front.opacity > 0.05F && back.opacity > 0.05F;
      before += front.opacity;
    }
    EXPECT_GE(before, last);
    last = before;
  }
  EXPECT_GT(divided, 50);
  EXPECT_GT(last, 50);
}

// The ground's outline in the picture is no outline of the cloud.
TEST(SlabClouds, ASurfaceDrawsNoOutlines) {
  const Camera camera = slabCamera(directionFromAngles(20, 40), {0, 0.5F, 0}, 80, 60);
  Layer surface = blankLayer(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 40; x < camera.width; ++x) surface.at(x, y) = {{}, 1, 1};
  const Layer whole = renderSlabClouds(camera, {}), left = renderSlabClouds(camera, {}, {&surface, 1}).front();
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const bool is_open = x < 40;
      EXPECT_EQ(left.at(x, y).opacity, is_open ? whole.at(x, y).opacity : 0);
      EXPECT_EQ(left.at(x, y).color, is_open ? whole.at(x, y).color : Vec3{});
    }
}

TEST(SlabClouds, SameBytesForAnyNumberOfThreadsAndOthersForOtherSeeds) {
  const Camera camera = slabCamera(directionFromAngles(20, 30));
  const auto render = [&](size_t threads, uint32_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    SlabSettings settings;
    settings.seed = seed;
    settings.samples_per_side = 2;
    return renderSlabClouds(camera, settings);
  };
  const Layer one = render(1, 0), seven = render(7, 0), other = render(1, 1);
  const size_t bytes = one.pixels.size() * sizeof(LayerPixel);
  EXPECT_EQ(std::memcmp(one.pixels.data(), seven.pixels.data(), bytes), 0);
  EXPECT_NE(std::memcmp(one.pixels.data(), other.pixels.data(), bytes), 0);
}

TEST(SlabClouds, FiniteEverywhereAndForExtremeSettings) {
  std::vector<SlabSettings> all(9);
  all[1].noise_scale = 1e-6F;
  all[2].noise_scale = 1e9F;
  all[3].edge_width = 1e-6F;
  all[4].samples = 1;
  all[5].bottom = -1e9F, all[5].top = 1e9F;
  all[6].time_seconds = 1e9;
  all[7].horizon_start = 0, all[7].horizon_gain = 1e3F;
  all[8].threshold = 0.99F;
  for (const SlabSettings& settings : all)
    for (const Vec3 from : {Vec3{0, 0.5F, 0}, Vec3{0, 5, 0}, Vec3{0, 4, 0}, Vec3{1e30F, -1e30F, 3}, Vec3{0, 900, 0}})
      for (const Vec3 towards : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0.6F, 0.8F, 0}}) {
        Camera camera = slabCamera(towards, from, 12, 9);
        for (const LayerPixel& pixel : renderSlabClouds(camera, settings).pixels) {
          ASSERT_TRUE(isFinite(pixel.color));
          ASSERT_TRUE(pixel.opacity >= 0 && pixel.opacity <= 1);
          ASSERT_TRUE(pixel.distance >= 0);
          ASSERT_EQ(std::isfinite(pixel.distance), pixel.opacity > 0);
        }
      }
}

TEST(SlabClouds, RefusesSettingsOutOfRange) {
  const auto expectRefused = [](const auto& change) {
    SlabSettings settings;
    change(settings);
    EXPECT_THROW(renderSlabClouds(slabCamera({0, 1, 0}), settings), std::invalid_argument);
  };
  expectRefused([](SlabSettings& s) { s.center = s.top; });
  expectRefused([](SlabSettings& s) { s.bottom = NAN; });
  expectRefused([](SlabSettings& s) { s.samples = 0; });
  expectRefused([](SlabSettings& s) { s.dither = 1.5F; });
  expectRefused([](SlabSettings& s) { s.threshold = 1; });
  expectRefused([](SlabSettings& s) { s.edge_width = 0; });
  expectRefused([](SlabSettings& s) { s.noise_scale = -1; });
  expectRefused([](SlabSettings& s) { s.octaves = 9; });
  expectRefused([](SlabSettings& s) { s.samples_per_side = 0; });
  for (const float limit : {0.0F, 1.0F}) {
    SlabSettings settings;
    settings.dither = settings.low_share = settings.outline_strength = settings.night_light = limit;
    settings.tone_softness = settings.bright = settings.horizon_start = 0;
    EXPECT_NO_THROW(renderSlabClouds(slabCamera({0, 1, 0}), settings));
  }
}

// Light comes through as much as an eye sees of it.
TEST(SlabClouds, LetThroughWhatIsNotOpaque) {
  SlabSettings settings;
  const Vec3 light = directionFromAngles(40, 50), low = directionFromAngles(40, 1);
  std::vector<Vec3> points;
  for (float x = -20; x < 20; x += 1.5F) points.push_back({x, 0.5F * float(points.size() % 3), 2 * x});
  points.push_back({0, 30, 0});
  std::vector<float> shares(points.size(), 0.5F), at_horizon(points.size(), 1);
  passSlab(points, light, settings, shares);
  int dark = 0, clear = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const float opacity = marchSlab({points[i], light}, 0.5F, settings).opacity;
    EXPECT_NEAR(shares[i], 0.5F * (1 - opacity * slabHorizonFade(light.y, settings)), 1e-6);
    dark += opacity > 0.5F;
    clear += opacity == 0;
  }
  EXPECT_GT(dark, 3);
  EXPECT_GT(clear, 3);
  EXPECT_EQ(shares.back(), 0.5F) << "above the slab";
  passSlab(points, low, settings, at_horizon);
  for (const float share : at_horizon) EXPECT_EQ(share, 1) << "where the slab has faded, so has its shadow";
}

}  // namespace
}  // namespace cloudbake
