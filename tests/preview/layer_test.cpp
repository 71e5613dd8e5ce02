// Layers over each other and in the fog, against sums done by hand.
#include "preview/layer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/random.h"
#include "tests/preview/preview_helpers.h"

namespace cloudbake {
namespace {

constexpr int kWidth = 5, kHeight = 4;

Layer layerOf(const LayerPixel& pixel) { return {kWidth, kHeight, std::vector<LayerPixel>(size_t(kWidth * kHeight), pixel)}; }

Image someBackground() {
  Image image = blankImage(kWidth, kHeight);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = {0.1F * float(i), 0.3F, -0.0F};
  return image;
}

TEST(Layers, NearestComesFirstWhateverTheOrder) {
  const Image background = someBackground();
  const Layer red = layerOf({{1, 0, 0}, 0.5F, 2}), green = layerOf({{0, 1, 0}, 0.25F, 1}), blue = layerOf({{0, 0, 1}, 0.8F, 3});
  const float clear = 0.75F * 0.5F * 0.2F;
  for (const std::vector<Layer>& layers : {std::vector{red, green, blue}, std::vector{blue, red, green}, std::vector{green, blue, red}}) {
    const Image image = composeLayers(layers, background);
    for (size_t i = 0; i < image.pixels.size(); ++i)
      expectNear(image.pixels[i], Vec3{0.75F * 0.5F, 0.25F, 0.75F * 0.5F * 0.8F} + background.pixels[i] * clear, 1e-6);
  }
}

TEST(Layers, EquallyFarOnesKeepTheirOrder) {
  std::vector<Layer> layers;
  for (int i = 0; i < 40; ++i) layers.push_back(layerOf({{float(i), 0, 0}, 1, 7}));
  EXPECT_EQ(composeLayers(layers, someBackground()).at(2, 1), (Vec3{0, 0, 0}));
  layers.front().at(2, 1).opacity = 0;
  EXPECT_EQ(composeLayers(layers, someBackground()).at(2, 1), (Vec3{1, 0, 0}));
}

TEST(Layers, OrderIsEveryPixelsOwn) {
  Layer a = layerOf({{1, 0, 0}, 1, 1}), b = layerOf({{0, 1, 0}, 1, 2});
  b.at(3, 2).distance = 0.5F;
  const Image image = composeLayers(std::vector{a, b}, someBackground());
  EXPECT_EQ(image.at(3, 2), (Vec3{0, 1, 0}));
  EXPECT_EQ(image.at(2, 2), (Vec3{1, 0, 0}));
}

TEST(Layers, WithoutOpacityTheBackgroundStaysBitForBit) {
  const Image background = someBackground();
  const std::vector<Layer> layers{blankLayer(kWidth, kHeight), layerOf({{NAN, INFINITY, 3}, 0, 4})};
  for (const std::span<const Layer> some : {std::span<const Layer>(layers), std::span<const Layer>()}) {
    const Image image = composeLayers(some, background, {0.3F, {1, 1, 1}});
    EXPECT_EQ(std::memcmp(image.pixels.data(), background.pixels.data(), background.pixels.size() * sizeof(Vec3)), 0);
  }
}

TEST(Layers, FogFadesALayerByItsDistance) {
  const Vec3 color{1, 0.5F, 0.25F}, fog{0.1F, 0.2F, 0.9F};
  for (const double distance : {0.0, 0.5, 3.0, 40.0}) {
    const Image image = composeLayers(std::vector{layerOf({color, 1, float(distance)})}, someBackground(), {0.2F, fog});
    const float fogged = float(1 - std::exp(-0.2 * distance));
    expectNear(image.at(1, 1), color * (1 - fogged) + fog * fogged, 1e-6);
  }
  // Half of it is background, which has no fog.
  expectNear(composeLayers(std::vector{layerOf({color, 0.5F, 1e9F})}, someBackground(), {0.2F, fog}).at(0, 0), {0.05F, 0.25F, 0.45F}, 1e-6);
  // Endlessly far: all fog, or none where there is no fog.
  expectNear(composeLayers(std::vector{layerOf({color, 1, INFINITY})}, someBackground(), {0.2F, fog}).at(1, 1), fog, 1e-6);
  EXPECT_EQ(composeLayers(std::vector{layerOf({color, 1, INFINITY})}, someBackground()).at(1, 1), color);
}

// Around the sun the fog is brighter, by the power of the cosine.
TEST(Layers, FogScattersTheLight) {
  const Vec3 light{1, 0.7F, 0.3F}, fog{0.1F, 0.2F, 0.9F};
  expectNear(scatteredLight({0, 0, 1}, {0, 0, 1}, light, {0.3F, 8}), light * 0.3F, 1e-6);
  expectNear(scatteredLight({0, 0.6F, 0.8F}, {0, 0, 1}, light, {0.3F, 8}), light * float(0.3 * std::pow(0.8, 8)), 1e-6);
  EXPECT_EQ(scatteredLight({0, 0, -1}, {0, 0, 1}, light, {0.3F, 8}), Vec3{});
  EXPECT_EQ(scatteredLight({0, 0, 1}, {0, 0, 1}, light, {}), Vec3{});
  std::vector<Vec3> scattered(size_t(kWidth * kHeight));
  scattered[size_t(kWidth) + 2] = {0.5F, 0.25F, 0};
  const Image image = composeLayers(std::vector{layerOf({{1, 1, 1}, 1, INFINITY})}, someBackground(), {0.2F, fog}, scattered);
  expectNear(image.at(2, 1), fog + Vec3{0.5F, 0.25F, 0}, 1e-6);
  expectNear(image.at(1, 1), fog, 1e-6);
  EXPECT_THROW(composeLayers({}, someBackground(), {0.2F, fog}, std::vector<Vec3>(3)), std::invalid_argument);
}

// A ridge before a cloud before a ridge, in different samples of one pixel: the mean of what each sample sees.
TEST(Layers, AreComposedSampleBySample) {
  const Image background = someBackground();
  Layer ground = blankLayer(kWidth, kHeight, 2), cloud = layerOf({{0, 1, 0}, 0.5F, 10});
  ground.at(2, 1, 0) = {{1, 0, 0}, 1, 2};
  ground.at(2, 1, 1) = {{0, 0, 1}, 1, 50};
  const Image image = composeLayers(std::vector{cloud, ground}, background);
  const Vec3 behind_cloud = background.at(2, 1) * 0.5F + Vec3{0, 0.5F, 0};
  expectNear(image.at(2, 1), (Vec3{1, 0, 0} + Vec3{0, 0.5F, 0.5F} + behind_cloud * 2) / 4, 1e-6);
  expectNear(image.at(0, 0), background.at(0, 0) * 0.5F + Vec3{0, 0.5F, 0}, 1e-6);
  // Of 3 × 3 samples and 2 × 2, those in the same part of the pixel meet.
  EXPECT_EQ(ground.sampleFor(0, 3), 0);
  EXPECT_EQ(ground.sampleFor(2, 3), 1);
  EXPECT_EQ(ground.sampleFor(4, 3), 0);
  EXPECT_EQ(ground.sampleFor(8, 3), 3);
  EXPECT_EQ(cloud.sampleFor(8, 3), 0);
  // Nothing at all: the background, bit for bit, for any number of samples.
  const std::vector<Layer> nothing{blankLayer(kWidth, kHeight, 3)};
  EXPECT_EQ(composeLayers(nothing, background).pixels, background.pixels);
}

TEST(Layers, CutsAreSortedAndOfTheSample) {
  Layer ground = blankLayer(kWidth, kHeight, 2), cloud = layerOf({{}, 0.5F, 10});
  ground.at(1, 1, 3) = {{}, 1, 4};
  ground.at(1, 1, 2) = {{}, 1, 40};
  const std::vector<Layer> surfaces{cloud, ground};
  const Cuts near = cutsAt(surfaces, 1, 1, 3, 2), far = cutsAt(surfaces, 1, 1, 2, 2), sky = cutsAt(surfaces, 1, 1, 0, 2);
  ASSERT_EQ(near.count, 2);
  EXPECT_EQ(near.cuts[0].distance, 4);
  EXPECT_EQ(near.cuts[1].distance, 10);
  EXPECT_EQ(near.hiddenFrom(), 4);
  EXPECT_EQ(far.cuts[0].distance, 10);
  EXPECT_EQ(far.hiddenFrom(), 40);
  EXPECT_EQ(sky.count, 1);
  EXPECT_EQ(sky.hiddenFrom(), INFINITY);
  EXPECT_THROW(cutsAt(std::vector{cloud, cloud, ground}, 0, 0, 0, 1), std::invalid_argument);
}

TEST(Layers, RefusesWhatDoesNotFit) {
  const Image background = someBackground();
  EXPECT_THROW(composeLayers(std::vector{blankLayer(kWidth, kHeight - 1)}, background), std::invalid_argument);
  EXPECT_THROW(composeLayers(std::vector{blankLayer(kWidth + 1, kHeight)}, background), std::invalid_argument);
  EXPECT_THROW(composeLayers(std::vector{Layer{kWidth, kHeight, {}}}, background), std::invalid_argument);
  for (const float density : {-1.0F, NAN, INFINITY})
    EXPECT_THROW(composeLayers(std::vector{blankLayer(kWidth, kHeight)}, background, {density, {}}), std::invalid_argument);
}

TEST(Layers, SameBytesForAnyNumberOfThreads) {
  const int width = 41, height = 67;
  std::vector<Layer> layers(5, blankLayer(width, height));
  for (uint32_t l = 0; l < layers.size(); ++l)
    for (uint32_t i = 0; i < layers[l].pixels.size(); ++i) {
      const auto draw = [&](uint32_t what) { return uniformFloat(hashDraw(l, i, what)); };
      layers[l].pixels[i] = {{draw(0), draw(1), draw(2)}, draw(3), 10 * draw(4)};
    }
  const auto compose = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return composeLayers(layers, blankImage(width, height), {0.1F, {1, 1, 1}});
  };
  const Image one = compose(1), seven = compose(7);
  EXPECT_EQ(std::memcmp(one.pixels.data(), seven.pixels.data(), one.pixels.size() * sizeof(Vec3)), 0);
  EXPECT_GT(one.at(20, 30).x, 0);
}

}  // namespace
}  // namespace cloudbake
