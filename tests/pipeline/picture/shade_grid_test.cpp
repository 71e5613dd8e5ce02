// The grid by which many clouds shade each other, against exact chords through the other clouds.
#include "preview/mesh_clouds/shade_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "bake/truth/reference.h"
#include "core/parallel.h"
#include "pipeline/picture/picture.h"
#include "pipeline/picture/scene_picture.h"
#include "pipeline/picture/scene_shadows.h"
#include "preview/backdrop/sky.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/mesh_clouds.h"
#include "preview/mesh_clouds/render.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

BakedMesh shadingBall(float extinction, int splits = 5) {
  BakedMesh mesh;
  mesh.surface = ballMesh(1, splits);
  mesh.lobes.resize(mesh.surface.positions.size());
  mesh.info.extinction = extinction;
  return mesh;
}

struct CastingMesh {
  BakedMesh mesh;
  ShadowCaster caster;
  std::unique_ptr<Reference> reference;
};

CastingMesh casting(BakedMesh mesh) {
  Warnings warnings;
  CastingMesh made{std::move(mesh), {}, nullptr};
  made.caster = shadowCasterOf(made.mesh, warnings).value();
  made.reference = meshReference(made.mesh.surface);
  return made;
}

SceneFile shadedScene(Vec3 to_sun, CloudShade shade) {
  SceneFile scene;
  scene.light = lookOf(scene.post, {});
  scene.light.sky.to_sun = to_sun;
  scene.light.sky.colors = skyColorsFor(scene.post, to_sun.y);
  scene.clouds.resize(2);
  scene.shadows.softness_degrees = 0;
  scene.shadows.cloud_shade = shade;
  return scene;
}

// The truth: every chord through the other instances.
class ExactShade {
 public:
  ExactShade(std::span<const Instance> instances, std::span<const CastingMesh> meshes, Vec3 to_sun) : to_sun_(to_sun) {
    for (const Instance& instance : instances) {
      const auto mesh = std::find_if(meshes.begin(), meshes.end(), [&](const CastingMesh& one) { return &one.mesh == instance.mesh; });
      const Box box = placedBox(instance);
      casters_.push_back(
          {mesh->reference.get(), inverted(instance.to_world).value(), worldExtinction(instance, {}), box.center(), box.diagonal() / 2});
    }
  }
  double shareAt(Vec3 p, size_t owner) const {
    double depth = 0;
    for (size_t j = 0; j < casters_.size(); ++j) {
      const Caster& caster = casters_[j];
      const Vec3 way = caster.center - p;
      const double along = double(dot(way, to_sun_));
      if (j == owner || along < -double(caster.radius) || double(dot(way, way)) - along * along > double(caster.radius) * caster.radius)
        continue;
      const Vec3 own = transformVector(caster.to_own, to_sun_);
      const double stretch = length(own);
      depth +=
          caster.extinction * caster.reference->insideLength({transformPoint(caster.to_own, p), own / float(stretch)}, INFINITY) / stretch;
    }
    return std::exp(-depth);
  }

 private:
  struct Caster {
    const Reference* reference;
    Affine to_own;
    float extinction;
    Vec3 center;
    float radius;
  };
  std::vector<Caster> casters_;
  Vec3 to_sun_;
};

double rmsOf(const std::vector<double>& squares, size_t count) {
  double sum = 0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / double(std::max<size_t>(1, count)));
}

// A ball over another one, under two suns: exp(−σ chord) but at the rim, where cells are as large as what changes.
TEST(ShadeGrid, IsTheChordOfABall) {
  const CastingMesh ball = casting(shadingBall(1));
  for (const auto& [azimuth, elevation] : {std::pair(0.0F, 90.0F), {130.0F, 28.0F}, {200.0F, 4.0F}, {10.0F, -40.0F}}) {
    const Vec3 to_sun = directionFromAngles(azimuth, elevation);
    const Vec3 upper = to_sun * 9.0F;
    const Instance instances[] = {{&ball.mesh, placement(upper, {}, {1, 1, 1}), &ball.caster}, {&ball.mesh, {}, &ball.caster}};
    const SceneShade shade = shadeOf(instances, {}, {.softness_degrees = 0}, to_sun).value();
    const ShadeBlock block = shade.grid.pastOthers(1);
    std::vector<double> squares;
    for (const Vec3& p : ball.mesh.surface.positions) {
      const double across = length(cross(p, to_sun));
      const double off = std::exp(-2 * std::sqrt(std::max(0.0, 1 - across * across))) - double(block.shareAt(shade.grid.frame().place(p)));
      if (across < 0.85) {
        EXPECT_NEAR(off, 0, 0.1) << azimuth << " " << elevation;
      }
      squares.push_back(off * off);
    }
    EXPECT_LT(rmsOf(squares, squares.size()), 0.08);
    // Nothing is between the upper ball and the light, and of itself nothing is left.
    for (const float share : shade.grid.pastOthers(0).shares) ASSERT_EQ(share, 1.0F);
  }
}

// A cloud that is taken out of the grid leaves what is there without it, to the bit; the order of clouds and threads change nothing.
TEST(ShadeGrid, TheOwnPartIsLeftOutExactly) {
  const CastingMesh ball = casting(shadingBall(0.7F));
  const Vec3 to_sun = directionFromAngles(60, 35);
  std::vector<CloudShadow> shadows;
  Box box;
  for (int i = 0; i < 9; ++i) {
    const int row = i / 3;
    const Affine place = placement({0.4F * float(i % 3), 0.9F * float(i), 0.3F * float(row)}, {0, 30.0F * float(i), 0}, {1, 1.2F, 0.8F});
    shadows.emplace_back(coarserCaster(ball.caster, kShadeCoarser), place, 0.7F, to_sun, ShadowSettings{});
    for (const auto& c : shadows.back().corners()) box.add({float(c[0]), float(c[1]), float(c[2])});
  }
  const ShadeFrame frame = shadeFrame(box, to_sun, {});
  const ShadeGrid all(frame, shadows, to_sun);
  for (size_t own = 0; own < shadows.size(); ++own) {
    std::vector<CloudShadow> others = shadows;
    others.erase(others.begin() + ptrdiff_t(own));
    const ShadeBlock without = ShadeGrid(frame, others, to_sun).pastAll(), block = all.pastOthers(own);
    size_t at = 0;
    for (int z = 0; z < block.nodes[2]; ++z)
      for (int y = 0; y < block.nodes[1]; ++y)
        for (int x = 0; x < block.nodes[0]; ++x)
          ASSERT_EQ(
              block.shares[at++],
              without
                  .shares[(size_t(block.first[2] + z) * size_t(without.nodes[1]) + size_t(block.first[1] + y)) * size_t(without.nodes[0]) +
                          size_t(block.first[0] + x)]);
  }
  const std::vector<CloudShadow> reversed(shadows.rbegin(), shadows.rend());
  EXPECT_EQ(ShadeGrid(frame, reversed, to_sun).pastAll().shares, all.pastAll().shares);
  const ThreadLimit one(1);
  EXPECT_EQ(ShadeGrid(frame, shadows, to_sun).pastAll().shares, all.pastAll().shares);
}

// Fields of grown clouds against exact chords. The figures are in docs/previewer.md.
TEST(ShadeGrid, FieldsAreWithinTheirBoundOfExactChords) {
  std::vector<CastingMesh> meshes;
  for (const char* name : {"humilis", "mediocris", "congestus"}) {
    BakeReport report;
    meshes.push_back(
        casting(bakedMesh(sourceOf(sourceKindOf(name), name), options({"vertices=1500", "rays=64", "bake-voxels=24"}, kGrow), report)));
  }
  std::printf("clouds | sun | mean T | none | each | grid, MB | picture: none, each, grid of 255\n");
  for (const int count : {50, 200, 1000}) {
    Scenery scenery;
    DrawnField& field = scenery.fields.emplace_back();
    const float half = 8 * std::sqrt(float(count));
    field.settings.low = {-half, 20, -half}, field.settings.high = {half, 28, half};
    field.settings.count = uint32_t(count), field.settings.size = {0.6F, 1.4F}, field.settings.seed = 7;
    const double weights[] = {2, 2, 1};
    field.clouds = scatterClouds(field.settings, weights);
    for (const CastingMesh& mesh : meshes) {
      const float scale = 9 / drawnBox(mesh.mesh.surface).longestSide();
      field.meshes.push_back({&mesh.mesh, placement({}, {}, {scale, scale, scale}), &mesh.caster});
    }
    for (const float elevation : {17.0F, 45.0F}) {
      const Vec3 to_sun = directionFromAngles(98, elevation);
      Camera camera;
      camera.look_from = {0, 3, 0}, camera.look_at = {0, 22, -50}, camera.width = 320, camera.height = 180;
      camera.vertical_fov_degrees = 55;
      const std::vector<Instance> instances = withLevels(instancesAt(scenery, 0), camera);
      const ExactShade exact(instances, meshes, to_sun);
      const SceneFile scene = shadedScene(to_sun, CloudShade::kEach);
      const auto sharesBy = [&](CloudShade shade) {
        const SceneFile own = shadedScene(to_sun, shade);
        return SceneShadows(own, instances).sharesOfVertices();
      };
      const auto each = sharesBy(CloudShade::kEach), grid = sharesBy(CloudShade::kGrid);
      std::vector<std::vector<float>> truth(instances.size());
      parallelFor(instances.size(), [&](size_t i) {
        if (!instances[i].is_seen) return;
        for (const Vec3& p : worldPositions(instances[i])) truth[i].push_back(float(exact.shareAt(p, i)));
      });
      std::array<double, 3> squares{};
      double sum = 0;
      size_t n = 0;
      for (size_t i = 0; i < instances.size(); ++i)
        for (size_t v = 0; v < truth[i].size(); ++v, ++n) {
          const double t = truth[i][v], e = each[i].empty() ? 1 : each[i][v], g = grid[i].empty() ? 1 : grid[i][v];
          squares[0] += (1 - t) * (1 - t), squares[1] += (e - t) * (e - t), squares[2] += (g - t) * (g - t), sum += t;
        }
      const auto picture = [&](const std::vector<std::vector<float>>* shares) {
        std::vector<Instance> lit = instances;
        for (size_t i = 0; shares && i < lit.size(); ++i) lit[i].sun_shares = (*shares)[i];
        return toneMap(renderMeshClouds(lit, camera, scene.light, scene.post), 1);
      };
      const Image right = picture(&truth);
      const auto off = [&](const std::vector<std::vector<float>>* shares) {
        const Image drawn = picture(shares);
        double total = 0;
        for (size_t p = 0; p < right.pixels.size(); ++p)
          total += double(dot(drawn.pixels[p] - right.pixels[p], drawn.pixels[p] - right.pixels[p])) / 3;
        return 255 * std::sqrt(total / double(right.pixels.size()));
      };
      const auto rms = [&](int i) { return std::sqrt(squares[size_t(i)] / double(n)); };
      const auto shade = shadeOf(instances, scene.light, scene.shadows, to_sun);
      const auto& nodes = shade->grid.frame().nodes;
      std::printf("%zu | %g | %.3f | %.4f | %.4f | %.4f, %.1f (%d %d %d) | %.2f, %.2f, %.2f\n", instances.size(), double(elevation),
                  sum / double(n), rms(0), rms(1), rms(2), double(nodes[0]) * nodes[1] * nodes[2] * 2e-6, nodes[0], nodes[1], nodes[2],
                  off(nullptr), off(&each), off(&grid));
      // The ground below, at one place in 100 square units at most.
      const ShadeBlock& all = shade->grid.pastAll();
      constexpr int kSide = 48;
      std::vector<double> ground(size_t(kSide) * kSide), darkness(ground.size());
      parallelFor(kSide, [&](int row) {
        for (int column = 0; column < kSide; ++column) {
          const Vec3 place{half * (2 * (float(column) + 0.5F) / kSide - 1), 0, half * (2 * (float(row) + 0.5F) / kSide - 1)};
          const double t = exact.shareAt(place, instances.size()), g = double(all.shareAt(shade->grid.frame().place(place)));
          ground[size_t(row) * kSide + size_t(column)] = (g - t) * (g - t);
          darkness[size_t(row) * kSide + size_t(column)] = (1 - t) * (1 - t);
        }
      });
      std::printf("  ground: %.4f, without a shadow %.4f\n", rmsOf(ground, ground.size()), rmsOf(darkness, ground.size()));
      EXPECT_LT(rmsOf(ground, ground.size()), 0.14);
      EXPECT_LT(rms(2), 0.11);
      EXPECT_LT(rms(2), 0.5 * rms(0));
    }
  }
}

// Cells drift with the clouds, so that the light of a vertex changes no faster from frame to frame than by shadows of each cloud.
TEST(ShadeGrid, FieldsDriftWithoutAJump) {
  const CastingMesh ball = casting(shadingBall(2, 3));
  Scenery scenery;
  DrawnField& field = scenery.fields.emplace_back();
  field.settings.low = {-40, 20, -40}, field.settings.high = {40, 24, 40};
  field.settings.count = 150, field.settings.drift = {3, 0, 1};
  const double weights[] = {1};
  field.clouds = scatterClouds(field.settings, weights);
  field.meshes.push_back({&ball.mesh, placement({}, {}, {3, 2, 3}), &ball.caster});
  const Vec3 to_sun = directionFromAngles(98, 20);
  std::array<double, 2> largest{}, squares{};
  size_t changes = 0;
  for (size_t shade = 0; shade < 2; ++shade) {
    const SceneFile scene = shadedScene(to_sun, shade == 0 ? CloudShade::kEach : CloudShade::kGrid);
    std::vector<std::vector<float>> before;
    std::vector<Instance> placed;
    for (int frame = 0; frame < 6; ++frame) {
      const std::vector<Instance> instances = instancesAt(scenery, 7 + frame / 30.0);
      const auto now = SceneShadows(scene, instances).sharesOfVertices();
      for (size_t i = 0; i < before.size(); ++i)
        if (std::abs(instances[i].to_world.offset[0] - placed[i].to_world.offset[0]) > 1) before[i].clear();  // it has wrapped around
      for (size_t i = 0; i < before.size(); ++i)
        for (size_t v = 0; v < before[i].size(); ++v, ++changes) {
          const double change = std::abs(double(now[i][v]) - double(before[i][v]));
          largest[shade] = std::max(largest[shade], change), squares[shade] += change * change;
        }
      before = now, placed = instances;
    }
  }
  std::printf("largest change of T in 1/30 s: each %.4f, grid %.4f; rms %.5f, %.5f\n", largest[0], largest[1],
              std::sqrt(2 * squares[0] / double(changes)), std::sqrt(2 * squares[1] / double(changes)));
  EXPECT_LT(squares[1], squares[0]);
  EXPECT_LT(largest[1], largest[0]);
}

}  // namespace
}  // namespace cloudbake
