// The picture of a shadow against exact chords, and against the shadow that the same cloud casts in a scene.
#include "pipeline/picture/shadow_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bake/truth/reference.h"
#include "core/error.h"
#include "core/parallel.h"
#include "io/image/image.h"
#include "pipeline/picture/picture.h"
#include "pipeline/picture/scene_shadows.h"
#include "preview/camera.h"
#include "tests/folders.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

constexpr std::pair<float, float> kSuns[] = {{0, 90}, {130, 28}, {-40, 5}, {200, -60}};

BakedMesh darkCloud(SurfaceMesh surface, float extinction) {
  BakedMesh mesh;
  mesh.surface = std::move(surface);
  mesh.lobes.resize(mesh.surface.positions.size());
  mesh.info.extinction = extinction;
  return mesh;
}

// The rms over the pixels against the mean of exp(−σ ℓ) over 8 × 8 places of each, with ℓ from `length(origin on the lit side)`.
template <typename Length>
double rmsAgainst(const ShadowPicture& picture, const Length& length) {
  const ShadowFrame& frame = picture.frame;
  constexpr int kPlaces = 8;
  std::vector<double> squares(size_t(picture.size), 0);
  parallelFor(picture.size, [&](int row) {
    for (int column = 0; column < picture.size; ++column) {
      double sum = 0;
      for (int j = 0; j < kPlaces; ++j)
        for (int i = 0; i < kPlaces; ++i) {
          const float x = (float(column) + (float(i) + 0.5F) / kPlaces) / float(picture.size) - 0.5F;
          const float y = 0.5F - (float(row) + (float(j) + 0.5F) / kPlaces) / float(picture.size);
          const Vec3 at = frame.origin + frame.right * (x * frame.width) + frame.up * (y * frame.height) + frame.to_sun * (2 * frame.top);
          sum += std::exp(-double(picture.extinction) * length(at));
        }
      const double off = double(picture.transmittance[size_t(row) * size_t(picture.size) + size_t(column)]) - sum / (kPlaces * kPlaces);
      squares[size_t(row)] += off * off;
    }
  });
  double total = 0;
  for (const double square : squares) total += square;
  return std::sqrt(total / (double(picture.size) * picture.size));
}

// The chord of a ball of radius 1.5 about a place is known.
TEST(ShadowPicture, IsTheTransmittanceOfABall) {
  const Vec3 center{3, -1, 2};
  const BakedMesh ball = darkCloud(ballMesh(1.5F, 5, center), 0.8F);
  for (const auto& [azimuth, elevation] : kSuns) {
    const Vec3 to_sun = directionFromAngles(azimuth, elevation);
    const ShadowPicture picture = drawShadow(ball, to_sun, 96, std::nullopt);
    EXPECT_FLOAT_EQ(picture.extinction, 0.8F);
    EXPECT_LE(rmsAgainst(picture,
                         [&](Vec3 at) {
                           const double across = length(cross(at - center, to_sun));
                           return across < 1.5 ? 2 * std::sqrt(1.5 * 1.5 - across * across) : 0;
                         }),
              0.01);
    EXPECT_LT(length(picture.frame.origin - center), 0.01F);
    EXPECT_NEAR(picture.frame.top, 1.5F, 0.01F);
    EXPECT_NEAR(picture.frame.bottom, -1.5F, 0.01F);
    for (int i = 0; i < 96; ++i)  // a sampler repeats the outermost pixels
      for (const int at : {i, 95 * 96 + i, i * 96, i * 96 + 95}) ASSERT_EQ(picture.transmittance[size_t(at)], 1.0F);
  }
}

// The bound for a shape with a hole, against Embree's chords.
TEST(ShadowPicture, IsWithinItsBoundOfExactChords) {
  const BakedMesh torus = darkCloud(torusMesh(1, 0.4F, 96, 48), 3);
  const auto reference = meshReference(torus.surface);
  for (const auto& [azimuth, elevation] : kSuns) {
    const Vec3 to_sun = directionFromAngles(azimuth, elevation);
    const double rms = rmsAgainst(drawShadow(torus, to_sun, 64, std::nullopt), [&](Vec3 at) {
      return reference->insideLength({at, -to_sun}, INFINITY);
    });
    EXPECT_LE(rms, 0.03) << azimuth << ", " << elevation;
  }
}

// A grown cloud and a sculpt. The figures are in docs/shadows.md.
TEST(ShadowPicture, OfCloudsIsWithinItsBoundOfExactChords) {
  const auto baked = [](const std::filesystem::path& input, const std::vector<std::string>& texts) {
    BakeReport report;
    const SourceKind kind = sourceKindOf(input);
    return bakedMesh(sourceOf(kind, input), options(texts, isGrown(kind) ? kGrow : kBake), report);
  };
  const std::pair<const char*, BakedMesh> clouds[] = {
      {"hero", baked("hero", {"vertices=6000", "rays=64", "bake-voxels=24"})},
      {"wuson.obj", baked(sourceFolder() / "data/sculpts/wuson.obj", {"repair=orient,fill", "rays=64", "bake-voxels=24"})}};
  for (const auto& [name, cloud] : clouds) {
    const auto reference = meshReference(cloud.surface);
    for (const auto& [azimuth, elevation] : kSuns) {
      const Vec3 to_sun = directionFromAngles(azimuth, elevation);
      const double rms = rmsAgainst(drawShadow(cloud, to_sun, 128, std::nullopt), [&](Vec3 at) {
        return reference->insideLength({at, -to_sun}, INFINITY);
      });
      EXPECT_LE(rms, 0.03) << name << " " << azimuth << ", " << elevation;
      std::printf("%s, sun %g,%g: rms of T %.4f\n", name, double(azimuth), double(elevation), rms);
    }
  }
}

// What an engine computes with the picture is what a scene has at the same places.
TEST(ShadowPicture, IsTheShadowOfScenes) {
  const BakedMesh torus = darkCloud(torusMesh(1, 0.4F, 96, 48), 3);
  const Vec3 to_sun = directionFromAngles(130, 50);
  const ShadowPicture picture = drawShadow(torus, to_sun, 128, std::nullopt);
  const ShadowSettings settings{.strength = 0.8F, .softness_degrees = 0};
  const CloudShadow shadow(shadowCasterOf(torus, kCasterVoxels), Affine{}, 3, to_sun, settings);
  double squares = 0, darkest = 1;
  int points = 0;
  for (int i = -40; i <= 40; ++i)
    for (int j = -40; j <= 40; ++j) {
      const Vec3 ground = picture.frame.origin - to_sun * 6 + Vec3{float(i) * 0.07F, 0, float(j) * 0.07F};
      const Vec2 at = shadowPlace(ground, picture.frame);
      const auto texel = [&](float x) { return std::clamp(int(x * float(picture.size)), 0, picture.size - 1); };
      const float transmittance = picture.transmittance[size_t(texel(1 - at.y)) * size_t(picture.size) + size_t(texel(at.x))];
      ASSERT_EQ(shadowDepth(ground, picture.frame), 1.0F);
      const float share = shadowFactor(transmittance, at, settings.strength * shadowDepth(ground, picture.frame));
      const double off = double(share) - double(shadow.shareAt(ground));
      squares += off * off, ++points;
      darkest = std::min(darkest, double(share));
    }
  EXPECT_LE(std::sqrt(squares / points), 0.02);
  EXPECT_LT(darkest, 0.3);
  // Towards the sun nothing is dark.
  const Vec3 above = picture.frame.origin + to_sun * 2.0F;
  EXPECT_EQ(shadowDepth(above, picture.frame), 0.0F);
  EXPECT_EQ(shadow.shareAt(above), 1.0F);
}

// Two balls, one of which is partly behind the other: the shadows of a scene multiply each other.
TEST(ShadowPicture, OfASceneIsTheTransmittanceOfItsClouds) {
  const BakedMesh ball = darkCloud(ballMesh(1.5F, 5), 0.6F);
  Warnings warnings;
  const ShadowCaster caster = shadowCasterOf(ball, warnings).value();
  const Vec3 to_sun = directionFromAngles(130, 40), second = to_sun * -7.0F + Vec3{1, 0.2F, 0.5F};
  for (const auto& [shade, bound] : {std::pair(CloudShade::kEach, 0.02), {CloudShade::kGrid, 0.05}}) {
    Scenery scenery;
    scenery.scene.light.sky.to_sun = to_sun;
    scenery.scene.clouds.resize(2);
    scenery.scene.shadows.cloud_shade = shade;
    scenery.instances = {{&ball, {}, &caster}, {&ball, placement(second, {}, {1, 1, 1}), &caster}};
    const ShadowPicture picture = drawShadow(scenery, {128, std::nullopt});
    double squares = 0, darkest = 1;
    for (int row = 0; row < 128; ++row)
      for (int column = 0; column < 128; ++column) {
        const float x = (float(column) + 0.5F) / 128 - 0.5F, y = 0.5F - (float(row) + 0.5F) / 128;
        const Vec3 at =
            picture.frame.origin + picture.frame.right * (x * picture.frame.width) + picture.frame.up * (y * picture.frame.height);
        double chords = 0;
        for (const Vec3 center : {Vec3{}, second}) {
          const double across = length(cross(at - center, to_sun));
          chords += across < 1.5 ? 2 * std::sqrt(1.5 * 1.5 - across * across) : 0;
        }
        const double share = double(picture.transmittance[size_t(row) * 128 + size_t(column)]), off = share - std::exp(-0.6 * chords);
        squares += off * off, darkest = std::min(darkest, share);
      }
    EXPECT_LT(std::sqrt(squares / (128 * 128)), bound);
    EXPECT_NEAR(darkest, std::exp(-0.6 * 5.8), 0.03);
    for (int i = 0; i < 128; ++i)
      for (const int at : {i, 127 * 128 + i, i * 128, i * 128 + 127}) ASSERT_EQ(picture.transmittance[size_t(at)], 1.0F);
    EXPECT_FALSE(nlohmann::json::parse(encodeShadow(picture).frame).contains("sigma"));
  }
  EXPECT_THROW(drawShadow(Scenery{}, {16, std::nullopt}), InputError);
}

TEST(ShadowPicture, IsTheSameForAnyNumberOfThreads) {
  const BakedMesh ball = darkCloud(ballMesh(1, 3), 2);
  const ShadowPicture all = drawShadow(ball, directionFromAngles(20, 40), 40, std::nullopt);
  const ThreadLimit one(1);
  EXPECT_EQ(drawShadow(ball, directionFromAngles(20, 40), 40, std::nullopt).transmittance, all.transmittance);
}

TEST(ShadowPicture, IsStoredWithItsFrame) {
  const ShadowPicture picture = drawShadow(darkCloud(ballMesh(1, 3), 2), directionFromAngles(20, 40), 40, 1.5F);
  const ShadowFiles files = encodeShadow(picture);
  const Image image = decodePng(files.png);
  ASSERT_EQ(image.width, 40);
  ASSERT_EQ(image.height, 40);
  for (size_t i = 0; i < image.pixels.size(); ++i) EXPECT_NEAR(image.pixels[i].x, picture.transmittance[i], 0.5F / 255 + 1e-6F);
  const auto json = nlohmann::json::parse(files.frame);
  EXPECT_EQ(json["schema"], "cloudbake-shadow-1");
  EXPECT_EQ(json["sigma"], 1.5);
  EXPECT_FLOAT_EQ(json["width"].get<float>(), picture.frame.width);
  EXPECT_FLOAT_EQ(json["to_sun"][1].get<float>(), picture.frame.to_sun.y);
  EXPECT_NE(files.png.find(std::string(kShadowKeyword) + '\0' + "{\"schema\""), std::string::npos);
  EXPECT_EQ(shadowFrameFile("a/b.png"), "a/b.json");
}

// Without an inside there is no shadow to draw.
TEST(ShadowPicture, NeedsAnInside) { EXPECT_THROW(drawShadow(BakedMesh{}, {0, 1, 0}, 32, std::nullopt), InputError); }

}  // namespace
}  // namespace cloudbake
