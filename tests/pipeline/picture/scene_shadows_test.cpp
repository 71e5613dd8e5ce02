// Shadows between the things of a scene, where each of them stands where it must.
#include "pipeline/picture/scene_shadows.h"

#include <cmath>

#include "tests/pipeline/picture_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

using Kind = SceneShadows::Kind;

BakedMesh ballCloud(float radius) {
  BakedMesh mesh;
  mesh.surface = ballMesh(radius, 4);
  mesh.lobes.resize(mesh.surface.positions.size());
  mesh.info.extinction = 2;
  return mesh;
}

// A scene under a sun straight above, or another one.
SceneFile sceneUnder(float azimuth = 0, float elevation = 90) {
  SceneFile scene;
  scene.light = lightForSun(azimuth, elevation);
  return scene;
}

TEST(ShadowCaster, IsTheMeshInCells) {
  const BakedMesh ball = ballCloud(1.5F);
  Warnings warnings;
  const auto caster = shadowCasterOf(ball, warnings);
  ASSERT_TRUE(caster);
  EXPECT_TRUE(warnings.empty());
  double volume = 0;
  Vec3 mean;
  size_t cell = 0;
  for (int k = 0; k < caster->cells[2]; ++k)
    for (int j = 0; j < caster->cells[1]; ++j)
      for (int i = 0; i < caster->cells[0]; ++i) {
        const float fraction = caster->fractions[cell++] / 255.0F;
        volume += fraction;
        mean += (caster->origin + Vec3{float(i), float(j), float(k)} * caster->cell_size) * fraction;
      }
  EXPECT_EQ(cell, caster->fractions.size());
  const double size = caster->cell_size;
  EXPECT_NEAR(volume * size * size * size, 4.0 / 3 * kPi * 1.5 * 1.5 * 1.5, 0.1);
  expectNear(mean / float(volume), {0, 0, 0}, 0.01);
  EXPECT_NEAR(size, 3.0 / kCasterVoxels, 0.01);
  // Nothing casts no shadow, and that is said.
  EXPECT_FALSE(shadowCasterOf(BakedMesh{}, warnings));
  EXPECT_EQ(warnings.entries().at(WarningKind::kFieldFallback).count, 1U);
}

// Two clouds above each other: the lower one lies in the shadow of the upper one, not the other way round, and none in its own.
TEST(SceneShadows, MeshCloudsShadowEachOther) {
  const BakedMesh upper = ballCloud(1), lower = ballCloud(1);
  Warnings warnings;
  const ShadowCaster one = *shadowCasterOf(upper, warnings), other = *shadowCasterOf(lower, warnings);
  SceneFile scene = sceneUnder();
  scene.clouds.resize(2);
  scene.shadows.softness_degrees = 0;
  const Instance instances[] = {{&upper, placement({0, 9, 0}, {}, {1, 1, 1}), &one}, {&lower, {}, &other}};
  const auto shares = SceneShadows(scene, instances).sharesOfVertices();
  ASSERT_EQ(shares.size(), 2U);
  for (const float share : shares[0]) EXPECT_EQ(share, 1);
  int dark = 0;
  for (size_t v = 0; v < shares[1].size(); ++v) {
    const Vec3 p = lower.surface.positions[v];
    const double square = double(p.x) * p.x + double(p.z) * p.z;
    EXPECT_NEAR(shares[1][v], std::exp(-4 * std::sqrt(std::max(0.0, 1 - square))), square < 0.9 ? 0.1 : 0.6);
    dark += shares[1][v] < 0.1F;
  }
  EXPECT_GT(dark, 100);
  // Apart they leave each other alone; and so they do where the scene does not want shadows.
  const Instance apart[] = {{&upper, placement({4, 9, 0}, {}, {1, 1, 1}), &one}, {&lower, {}, &other}};
  for (const auto& all : SceneShadows(scene, apart).sharesOfVertices())
    for (const float share : all) EXPECT_EQ(share, 1);
  scene.shadows.are_drawn = false;
  for (const auto& all : SceneShadows(scene, instances).sharesOfVertices()) EXPECT_TRUE(all.empty());
}

// At night it is the moon that casts shadows.
TEST(SceneShadows, AreThoseOfTheKeyLight) {
  const BakedMesh upper = ballCloud(1), lower = ballCloud(1);
  Warnings warnings;
  const ShadowCaster caster = *shadowCasterOf(upper, warnings);
  SceneFile scene = sceneUnder(0, -30);
  scene.clouds.resize(2);
  const Instance instances[] = {{&upper, placement({0, 9, 0}, {}, {1, 1, 1}), &caster}, {&lower, {}, &caster}};
  const auto darkest = [&] {
    const auto shares = SceneShadows(scene, instances).sharesOfVertices();
    return *std::min_element(shares[1].begin(), shares[1].end());
  };
  EXPECT_EQ(darkest(), 1) << "the sun is below, and nothing is between";
  scene.light.sky.moon.emplace().direction = {0, 1, 0};
  EXPECT_LT(darkest(), 0.1F);
}

SceneFile flatGround() {
  SceneFile scene = sceneUnder(90, 45);
  TerrainSettings& terrain = scene.terrain.emplace();
  terrain.scale = 1;
  terrain.shape.amplitude = 0;
  return scene;
}

// Under a sun at 45 degrees from +X the shadow of a cloud at a height lies as far towards −X.
TEST(SceneShadows, ACloudShadowsTheGround) {
  const BakedMesh ball = ballCloud(2);
  Warnings warnings;
  const ShadowCaster caster = *shadowCasterOf(ball, warnings);
  SceneFile scene = flatGround();
  scene.clouds.resize(1);
  const Instance instances[] = {{&ball, placement({0, 30, 5}, {}, {1, 1, 1}), &caster}};
  const SceneShadows shadows(scene, instances);
  const LightPassage passage = shadows.past(Kind::kTerrain);
  ASSERT_TRUE(passage);
  const Vec3 points[]{{-30, 0, 5}, {-30, 0, 12}, {30, 0, 5}, {0, 0, 5}, {-36, 0, 5}};
  float shares[]{1, 1, 1, 1, 1};
  passage(points, shares);
  EXPECT_LT(shares[0], 0.01F);
  for (size_t i = 1; i < 5; ++i) EXPECT_EQ(shares[i], 1) << i;
  // The picture has it there, and the ground elsewhere is as without the cloud.
  const Camera camera{{-30, 40, 5}, {-30, 0, 4.9F}, 40, 41, 41};
  const Vec3 to_sun = scene.light.sky.to_sun;
  const Layer with = renderTerrain(camera, to_sun, *scene.terrain, passage), without = renderTerrain(camera, to_sun, *scene.terrain);
  EXPECT_LT(with.at(20, 20).color.x, 0.5F * without.at(20, 20).color.x);
  EXPECT_EQ(with.at(2, 2).color, without.at(2, 2).color);
}

// A ridge between a cloud and a low sun leaves the cloud's foot dark and its top lit.
TEST(SceneShadows, TheGroundShadowsACloud) {
  const BakedMesh ball = ballCloud(100);
  SceneFile scene = sceneUnder(90, 2);
  scene.clouds.resize(1);
  TerrainSettings& terrain = scene.terrain.emplace();
  terrain.scale = 10;
  terrain.shadow.steps = 1000;
  // Behind the highest ridge on a line towards the sun.
  float x = 0, highest = 0;
  for (float at = 0; at < 40000; at += 20)
    if (const auto height = float(terrainHeight(at, 0, 9, terrain)); height > highest) highest = height, x = at;
  const float ground = float(terrainHeight(x - 1500, 0, 9, terrain));
  ASSERT_GT(highest - ground, 200);
  const auto mean = [&](float height) {
    const Instance instances[] = {{&ball, placement({x - 1500, height, 0}, {}, {0.3F, 0.3F, 0.3F})}};
    const std::vector<float> shares = SceneShadows(scene, instances).sharesOfVertices().front();
    double sum = 0;
    for (const float share : shares) sum += share;
    return sum / double(shares.size());
  };
  EXPECT_LT(mean(ground + 50), 0.2);
  EXPECT_GT(mean(2500), 0.99);
}

TEST(SceneShadows, CloudsOfNoiseShadowTheGround) {
  SceneFile scene = flatGround();
  scene.slabs.resize(1);
  scene.slabs[0].bottom = 30, scene.slabs[0].center = 32, scene.slabs[0].top = 36;
  std::vector<Vec3> points;
  for (float x = -60; x < 60; x += 4) points.push_back({x, 0, 0.5F * x});
  const auto at = [&] {
    std::vector<float> shares(points.size(), 1);
    const SceneShadows shadows(scene, {});
    shadows.past(Kind::kTerrain)(points, shares);
    return shares;
  };
  const std::vector<float> full = at();
  EXPECT_LT(*std::min_element(full.begin(), full.end()), 0.05F);
  EXPECT_EQ(*std::max_element(full.begin(), full.end()), 1);
  scene.shadows.strength = 0.5F;
  const std::vector<float> weak = at();
  for (size_t i = 0; i < full.size(); ++i) EXPECT_NEAR(weak[i], 0.5F + 0.5F * full[i], 1e-6);
  scene.shadows.strength = 1;
  scene.slabs.clear();
  scene.density_clouds.emplace_back().cloud_height = 20;
  const std::vector<float> marched = at();
  EXPECT_LT(*std::min_element(marched.begin(), marched.end()), 0.7F);
}

// A mesh cloud's shadow on a slab above it lies on the slab's contact; a slab is not darkened by itself.
TEST(SceneShadows, CloudsShadowASlab) {
  const BakedMesh ball = ballCloud(6);
  Warnings warnings;
  const ShadowCaster caster = *shadowCasterOf(ball, warnings);
  SceneFile scene = sceneUnder();
  scene.slabs.resize(1);
  scene.slabs[0].threshold = 0, scene.slabs[0].smooth_low = 0, scene.slabs[0].smooth_high = 1e-6F,
  scene.slabs[0].outline_strength = 0;  // full
  scene.clouds.resize(1);
  const Camera camera{{0, 0, 0}, {0, 1, 0}, 90, 21, 21};
  const auto draw = [&](Vec3 place) {
    const Instance instances[] = {{&ball, placement(place, {}, {1, 1, 1}), &caster}};
    std::vector<Layer> layers = renderSlabClouds(camera, scene.slabs[0], {});
    SceneShadows(scene, instances).darken(layers, Kind::kSlab, 0, camera);
    return layers.front();
  };
  const Layer below = draw({0, -20, 0}), above = draw({0, 40, 0});
  EXPECT_GT(below.at(10, 10).color.y, 1.5F * above.at(10, 10).color.y);
  EXPECT_EQ(renderSlabClouds(camera, scene.slabs[0], {}).front().at(10, 10).color, below.at(10, 10).color);
  const SkyColors colors = scene.light.sky.colors;
  const float sky_share = colors.ambient_sky.y / (colors.ambient_sky.y + colors.sun_color.y);
  EXPECT_NEAR(above.at(10, 10).color.y / below.at(10, 10).color.y, sky_share, 0.01);
  // A smaller cloud darkens the places under it, and no others.
  const Instance small[] = {{&ball, placement({2.5F, 8, -1}, {}, {0.1F, 0.1F, 0.1F}), &caster}};
  const std::vector<Layer> alone = renderSlabClouds(camera, scene.slabs[0], {});
  std::vector<Layer> layers = alone;
  SceneShadows(scene, small).darken(layers, Kind::kSlab, 0, camera);
  const CameraRays rays(camera);
  int dark = 0;
  for (int y = 0; y < 21; ++y)
    for (int x = 0; x < 21; ++x) {
      const LayerPixel& pixel = alone[0].at(x, y);
      const Ray ray = rays.at(float(x) + 0.5F, float(y) + 0.5F);
      const Vec3 place = ray.origin + ray.direction * pixel.distance;
      const float away = std::hypot(place.x - 2.5F, place.z + 1), factor = layers[0].at(x, y).color.y / pixel.color.y;
      if (away < 0.3F) {
        EXPECT_LT(factor, 0.9F) << x << " " << y;
        ++dark;
      } else if (away > 1) {
        EXPECT_EQ(factor, 1) << x << " " << y;
      }
    }
  EXPECT_GT(dark, 0);
}

// Marched clouds take the shadows of mesh clouds at their samples, and those of other things elsewhere.
TEST(SceneShadows, MeshCloudsShadowSamples) {
  const BakedMesh ball = ballCloud(2);
  Warnings warnings;
  const ShadowCaster caster = *shadowCasterOf(ball, warnings);
  SceneFile scene = sceneUnder();
  scene.slabs.resize(1);
  scene.slabs[0].threshold = 0, scene.slabs[0].smooth_low = 0, scene.slabs[0].smooth_high = 1e-6F;  // full
  scene.density_clouds.resize(1);
  scene.clouds.resize(1);
  const Instance instances[] = {{&ball, placement({0, 30, 0}, {}, {1, 1, 1}), &caster}};
  const SceneShadows shadows(scene, instances);
  const MarchedShadow shadow = shadows.onSamples();
  ASSERT_TRUE(shadow.passage);
  const Vec3 points[]{{0, 20, 0}, {0, 2, 0}, {9, 2, 0}};
  float shares[]{1, 1, 1};
  shadow.passage(points, shares);
  EXPECT_LT(shares[0], 0.01F);
  EXPECT_LT(shares[1], 0.01F);
  EXPECT_EQ(shares[2], 1) << "under the slab alone";
  EXPECT_FALSE(SceneShadows(scene, {}).onSamples().passage);
}

}  // namespace
}  // namespace cloudbake
