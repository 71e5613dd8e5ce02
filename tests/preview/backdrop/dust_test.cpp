// Dust against the closed form of a homogeneous medium.
#include "preview/backdrop/dust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "preview/shading_math.h"

namespace cloudbake {
namespace {

const Box kBox{{-2, -1, -1}, {2, 1, 1}};

float allLight(Vec3, Vec3) { return 1; }

SkySettings sunFrom(float azimuth, float elevation) {
  SkySettings sky;
  sky.to_sun = directionFromAngles(azimuth, elevation);
  return sky;
}

// Full up to its rim, dust of the extinction σ along a chord c shows a (phase S + A)(1 − exp(−σ c)).
TEST(Dust, HomogeneousDustIsTheClosedForm) {
  const Camera camera{{0, 0, 9}, {0, 0, 0}, 30, 31, 21};
  const SkySettings sky = sunFrom(60, 30);
  const DustSettings settings{
      .reach = 1, .thickness = 1.5F, .fade_start = 0.999F, .color = {1, 0.5F, 0.25F}, .asymmetry = 0.6F, .ambient = 2, .samples = 200};
  Affine placed;
  placed.linear = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};  // y and z change places
  placed.offset = {0.3, -0.2, 0.1};
  const Layer layer = renderDust(camera, sky, kBox, placed, settings, allLight).front();
  int inside = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const Vec3 from = ray.origin - Vec3{0.3F, -0.2F, 0.1F}, scale{0.5F, 1, 1};  // into the unit ball
      const Vec3 p = from * scale, d = ray.direction * scale;
      const double a = dot(d, d), b = dot(p, d), c = double(dot(p, p)) - 1, root = b * b - a * c;
      const LayerPixel& pixel = layer.at(x, y);
      if (root <= 0) {
        EXPECT_EQ(pixel.opacity, 0);
        continue;
      }
      const double chord = 2 * std::sqrt(root) / a, opacity = 1 - std::exp(-1.5 / 4 * chord);
      EXPECT_NEAR(pixel.opacity, opacity, 0.01);
      const float phase = henyeyGreenstein(dot(ray.direction, sky.to_sun), 0.6F);
      const Vec3 light = settings.color * (sky.colors.sun_color * phase + sky.colors.ambient_sky * 2);
      EXPECT_LT(length(pixel.color - light), 1e-4F * length(light));
      EXPECT_TRUE(pixel.distance > 6 && pixel.distance < 12);
      ++inside;
    }
  EXPECT_GT(inside, 100);
}

TEST(Dust, ThinsOutTowardsItsRimAndReachesAsFarAsAsked) {
  const Camera camera{{0, 0, 20}, {0, 0, 0}, 50, 101, 3};
  const auto widthOf = [&](const DustSettings& settings) {
    const Layer layer = renderDust(camera, sunFrom(0, 30), kBox, {}, settings, allLight).front();
    int count = 0;
    for (int x = 0; x < camera.width; ++x) count += layer.at(x, 1).opacity > 0;
    return count;
  };
  const int one = widthOf({.reach = 1, .fade_start = 0}), two = widthOf({.reach = 2, .fade_start = 0});
  EXPECT_NEAR(two, 2 * one, 3);
  const Layer layer = renderDust(camera, sunFrom(0, 30), kBox, {}, {.reach = 2, .fade_start = 0.2F, .dither = 0}, allLight).front();
  for (int x = 51; x < camera.width; ++x) EXPECT_LE(layer.at(x, 1).opacity, layer.at(x - 1, 1).opacity + 1e-6F);
}

// Where a thing is in the way only the sky's light is left; in another part of the dust nothing changes.
TEST(Dust, ShowsShadows) {
  const Camera camera{{0, 0, 9}, {0, 0, 0}, 40, 41, 31};
  const SkySettings sky = sunFrom(0, 90);
  const auto half = [](Vec3 point, Vec3) { return point.x < 0 ? 0.0F : 1.0F; };
  const DustSettings settings{.ambient = 0};
  const Layer lit = renderDust(camera, sky, kBox, {}, settings, allLight).front(),
              dark = renderDust(camera, sky, kBox, {}, settings, half).front();
  EXPECT_EQ(dark.at(12, 15).color, Vec3{});
  EXPECT_GT(dark.at(12, 15).opacity, 0);
  EXPECT_EQ(dark.at(30, 15).color, lit.at(30, 15).color);
  EXPECT_GT(lit.at(12, 15).color.x, 0);
}

TEST(Dust, IsCutAtSurfaces) {
  const Camera camera{{0, 0, 9}, {0, 0, 0}, 30, 11, 9};
  const DustSettings settings{.thickness = 1};
  const Layer whole = renderDust(camera, sunFrom(40, 30), kBox, {}, settings, allLight).front();
  Layer surface = blankLayer(11, 9);
  for (LayerPixel& pixel : surface.pixels) pixel = {{}, 0.3F, 9.3F};
  const std::vector<Layer> parts = renderDust(camera, sunFrom(40, 30), kBox, {}, settings, allLight, {&surface, 1});
  int both = 0;
  for (size_t i = 0; i < whole.pixels.size(); ++i) {
    const LayerPixel &front = parts[0].pixels[i], &back = parts[1].pixels[i];
    EXPECT_NEAR(1 - (1 - front.opacity) * (1 - back.opacity), whole.pixels[i].opacity, 1e-5);
    both += front.opacity > 0.01F && back.opacity > 0.01F && front.distance < 9.3F && back.distance >= 9.3F;
  }
  EXPECT_GT(both, 30);
}

TEST(Dust, RefusesSettingsOutOfRange) {
  const Camera camera{{0, 0, 9}, {0, 0, 0}, 30, 3, 3};
  Affine flat;
  flat.linear[1][1] = 0;
  EXPECT_THROW(renderDust(camera, {}, Box{}, {}, {}, allLight), std::invalid_argument);
  EXPECT_THROW(renderDust(camera, {}, kBox, flat, {}, allLight), std::invalid_argument);
  for (const DustSettings& bad : {DustSettings{.reach = 0}, DustSettings{.thickness = -1}, DustSettings{.fade_start = 1},
                                  DustSettings{.asymmetry = 1}, DustSettings{.samples = 0}, DustSettings{.samples_per_side = 0}})
    EXPECT_THROW(renderDust(camera, {}, kBox, {}, bad, allLight), std::invalid_argument);
  // From within, and looking away.
  const Layer within = renderDust({{0.1F, 0, 0}, {1, 0, 0}, 60, 5, 5}, {}, kBox, {}, {}, allLight).front(),
              away = renderDust({{0, 0, 9}, {0, 0, 20}, 60, 5, 5}, {}, kBox, {}, {}, allLight).front();
  for (const LayerPixel& pixel : within.pixels) EXPECT_GT(pixel.opacity, 0);
  for (const LayerPixel& pixel : away.pixels) EXPECT_EQ(pixel.opacity, 0);
}

}  // namespace
}  // namespace cloudbake
