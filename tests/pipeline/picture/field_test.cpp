// Fields of clouds in pictures: the same clouds placed one by one look the same, and what is outside of the picture is not drawn.
#include <algorithm>
#include <cmath>

#include "pipeline/picture/scene_picture.h"
#include "pipeline/picture/scene_shadows.h"
#include "preview/mesh_clouds/levels.h"
#include "preview/mesh_clouds/render.h"
#include "tests/pipeline/picture_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

const BakedMesh& fieldBall() {
  static const BakedMesh mesh = [] {
    BakedMesh made = bakedBall(1, {}, 2);
    made.info.extinction = 2;
    return made;
  }();
  return mesh;
}

const ShadowCaster& fieldBallCaster() {
  static const ShadowCaster caster = [] {
    Warnings warnings;
    return shadowCasterOf(fieldBall(), warnings).value();
  }();
  return caster;
}

ScatterSettings smallField() {
  ScatterSettings settings;
  settings.low = {-30, 4, -30}, settings.high = {30, 10, 30};
  settings.count = 120, settings.size = {0.7F, 1.4F}, settings.drift = {1.5F, 0, 0.5F};
  settings.horizon_scale = 0.7F, settings.horizon_lower = 4;
  return settings;
}

// Balls in a field around the camera, drawn without what follows the mean size of the clouds.
Scenery fieldOf(const ScatterSettings& settings) {
  Scenery scenery;
  SceneFile& scene = scenery.scene;
  scene.view.width = 60, scene.view.height = 40, scene.view.field_of_view_degrees = 50;
  scene.camera = CameraPlace{{0, 1, 0}, {0, 5, -20}};
  scene.post.far_distance = 40;
  scene.post.painted.erode.shrink = scene.post.painted.erode.darkening = 0;
  scene.light = lightForSun(70, 14);
  scene.fog.color = scene.light.sky.colors.horizon;
  scene.fields.push_back({{SceneCloud{}}, {1}, settings});
  scenery.fields.push_back({settings,
                            scatterClouds(settings, scene.fields[0].weights),
                            {{&fieldBall(), placement({}, {0, 0, 20}, {1.5F, 1, 1}), &fieldBallCaster()}}});
  return scenery;
}

// The same clouds as if each had a [[cloud]] of its own.
std::vector<Instance> oneByOne(std::vector<Instance> instances) {
  for (Instance& instance : instances) instance.scattered.reset();
  return instances;
}

Image drawnField(const SceneFile& scene, std::span<const Instance> instances) {
  DrawnParts parts;
  return drawScene(scene, instances, {}, parts);
}

float largestDifference(const Image& a, const Image& b) {
  float largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const Vec3 off = a.pixels[i] - b.pixels[i];
    largest = std::max({largest, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
  }
  return largest;
}

size_t countSeen(std::span<const Instance> instances) {
  return size_t(std::count_if(instances.begin(), instances.end(), [](const Instance& one) { return one.is_seen; }));
}

TEST(Fields, LookLikeCloudsThatArePlacedOneByOne) {
  Scenery scenery = fieldOf(smallField());
  for (const bool has_shadows : {false, true})
    for (const double seconds : {0.0, 21.0}) {
      scenery.scene.shadows.are_drawn = has_shadows;
      const std::vector<Instance> instances = instancesAt(scenery, seconds);
      ASSERT_EQ(instances.size(), 120U);
      const Camera camera = cameraFor(scenery.scene, instances);
      const size_t seen = countSeen(withLevels(instances, camera));
      EXPECT_TRUE(seen > 5 && seen < 60) << seen << " of 120 are in the picture";
      const Image field = drawnField(scenery.scene, instances), placed = drawnField(scenery.scene, oneByOne(instances));
      EXPECT_LT(largestDifference(field, placed), 2.0F / 255) << has_shadows << " at " << seconds;
      EXPECT_GT(largestDifference(field, drawnField(scenery.scene, instancesAt(scenery, seconds + 1))), 0.1F) << "the wind";
    }
  // The shadows are those of clouds outside of the picture, too.
  std::vector<Instance> seen = withLevels(instancesAt(scenery, 0), cameraFor(scenery.scene, instancesAt(scenery, 0)));
  const Image whole = drawnField(scenery.scene, seen);
  for (Instance& instance : seen)
    if (!instance.is_seen) instance.caster = nullptr;
  EXPECT_GT(largestDifference(whole, drawnField(scenery.scene, seen)), 0.1F);
}

TEST(Fields, ChangeNeitherCameraNorDepthWhileTheyDrift) {
  Scenery scenery = fieldOf(smallField());
  scenery.scene.camera.reset();
  scenery.scene.post.far_distance.reset();
  const std::vector<Instance> now = instancesAt(scenery, 0), later = instancesAt(scenery, 33);
  const Camera camera = cameraFor(scenery.scene, now), camera_later = cameraFor(scenery.scene, later);
  EXPECT_EQ(camera.look_from, camera_later.look_from);
  EXPECT_EQ(camera.look_at, camera_later.look_at);
  for (const Instance& instance : later) EXPECT_TRUE(isInView(instance, camera)) << "a camera by angles frames the whole field";
  EXPECT_EQ(depthRangeOf(scenery.scene.post, now).far, depthRangeOf(scenery.scene.post, later).far);
  EXPECT_NEAR(meanLongestSide(now), 1.5F * 2 * 1.05F, 0.15) << "balls stretched by 1.5, of sizes 0.7 to 1.4, without the horizon";
  expectNear(noiseFrame(later, 0.1F).origin - noiseFrame(now, 0.1F).origin, {33 * 1.5F, 0, 33 * 0.5F}, 1e-3);
}

TEST(Fields, ComeAfterTheCloudsThatArePlaced) {
  Scenery scenery = fieldOf(smallField());
  scenery.instances.push_back({&fieldBall(), placement({1, 2, 3}, {}, {1, 1, 1})});
  const std::vector<Instance> all = instancesAt(scenery, 5);
  ASSERT_EQ(all.size(), 121U);
  EXPECT_FALSE(all[0].scattered);
  expectNear(noiseFrame(all, 0.1F).origin, {1, 2, 3}, 1e-6);
}

// --- In motion ---

Film filmOfField(double seconds, const ScatterSettings& settings, const std::function<void(SceneFile&)>& change) {
  SceneFile scene = fieldOf(settings).scene;
  scene.post.distort.swirl_strength = 0;
  scene.view.motion = PictureSettings::Motion::kAnimate;
  scene.view.frames_per_second = 4, scene.view.frame_count = int(4 * seconds);
  change(scene);
  return filmOf(scene, true);
}

TEST(Fields, LoopAfterWholeBoxes) {
  ScatterSettings settings = smallField();  // boxes of 60 units: 40 s along x, 120 s along z
  const auto same = [](SceneFile&) {};
  EXPECT_TRUE(filmOfField(120, settings, same).loops);
  EXPECT_FALSE(filmOfField(40, settings, same).loops);
  EXPECT_EQ(filmOfField(40, settings, same).moving, std::vector<std::string>{"fields of clouds"});
  settings.drift.z = 0;
  EXPECT_TRUE(filmOfField(40, settings, same).loops);
  EXPECT_FALSE(filmOfField(41, settings, same).loops);
  EXPECT_FALSE(filmOfField(40, settings, [](SceneFile& scene) { scene.post.painted.erode.shrink = 0.5F; }).loops)
      << "the noise at rims goes with the wind";
  EXPECT_TRUE(filmOfField(40, settings,
                          [](SceneFile& scene) {
                            scene.post.painted.erode.shrink = 0.5F;
                            scene.clouds.emplace_back();
                          })
                  .loops)
      << "it stays with a cloud that is placed";
  // Swirls have a period of 10 s; with another one they do not close.
  const auto swirling = [](float speed) {
    return [speed](SceneFile& scene) { scene.post.distort.swirl_strength = 0.1F, scene.post.distort.swirl_speed = speed; };
  };
  EXPECT_TRUE(filmOfField(40, settings, swirling(0.1F)).loops);
  EXPECT_FALSE(filmOfField(40, settings, swirling(0.11F)).loops);
  EXPECT_FALSE(filmOfField(40, settings, [](SceneFile& scene) { scene.slabs.emplace_back().high_drift = {1, 0}; }).loops);
  settings.drift = {};
  EXPECT_TRUE(filmOfField(40, settings, same).moving.empty());
}

}  // namespace
}  // namespace cloudbake
