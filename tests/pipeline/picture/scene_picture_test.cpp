// How a scene becomes a picture: its camera, its layers, and what is done to the whole.
#include "pipeline/picture/scene_picture.h"

#include "pipeline/picture/picture_memory.h"
#include "preview/mesh_clouds/render.h"
#include "tests/pipeline/picture_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

constexpr int kWidth = 24, kHeight = 16;

PictureSettings smallView() {
  PictureSettings view;
  view.width = kWidth;
  view.height = kHeight;
  return view;
}

const BakedMesh& ball() {
  static const BakedMesh mesh = bakedBall(1, {}, 3);
  return mesh;
}

// A ball at a place, as drawn by few samples.
Scenery ballScene(Vec3 position = {}) {
  Scenery scenery;
  scenery.scene.view = smallView();
  scenery.scene.post.sky_samples_per_side = 1;
  scenery.instances.push_back({&ball(), placement(position, {}, {1, 1, 1})});
  return scenery;
}

struct Drawn {
  Image image;
  DrawnParts parts;
};
Drawn draw(const Scenery& scenery, const PictureSettings& view = smallView(), const CameraTurn& turn = {}) {
  Drawn drawn;
  SceneFile scene = scenery.scene;
  scene.view = view;
  scene.light = lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees);
  if (scene.fog.density == 0) scene.fog.color = scene.light.sky.colors.horizon;
  drawn.image = drawScene(scene, scenery.instances, turn, drawn.parts);
  return drawn;
}

Camera cameraOf(const Scenery& scenery, const PictureSettings& view, float turn = 0) {
  SceneFile scene = scenery.scene;
  scene.view = view;
  return cameraFor(scene, scenery.instances, turn);
}

std::vector<std::string> renderersOf(const Drawn& drawn) {
  std::vector<std::string> names;
  for (const auto& [name, seconds] : drawn.parts.seconds) names.push_back(name);
  return names;
}

Image skyOf(const Scenery& scenery, const PictureSettings& view = smallView()) {
  const LightSettings light = lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees);
  return drawSky(cameraOf(scenery, view), light.sky, scenery.scene.post);
}

// --- The camera ---

TEST(SceneCamera, FramesAllClouds) {
  Scenery scenery = ballScene({10, 0, 0});
  scenery.instances.push_back({&ball(), placement({-10, 0, 0}, {}, {1, 1, 1})});
  PictureSettings view = smallView();
  view.camera_azimuth_degrees = 0, view.camera_elevation_degrees = 0;
  const Camera camera = cameraOf(scenery, view);
  expectNear(camera.look_at, {0, 0, 0}, 1e-4);
  EXPECT_NEAR(camera.look_from.x, 0, 1e-4);
  EXPECT_GT(camera.look_from.z, 10);
  EXPECT_EQ(camera.width, kWidth);
  EXPECT_EQ(camera.height, kHeight);
  EXPECT_EQ(camera.vertical_fov_degrees, view.field_of_view_degrees);
  view.camera_azimuth_degrees = 90;
  EXPECT_GT(cameraOf(scenery, view).look_from.x, 11) << "azimuth 90 is +X";
}

TEST(SceneCamera, AtADistance) {
  Scenery scenery = ballScene({0, 5, 0});
  scenery.scene.camera_distance = 40;
  PictureSettings view = smallView();
  view.camera_azimuth_degrees = 90, view.camera_elevation_degrees = 0;
  const Camera camera = cameraOf(scenery, view);
  expectNear(camera.look_at, {0, 5, 0}, 1e-4);
  expectNear(camera.look_from, {40, 5, 0}, 1e-4);
  expectNear(cameraOf(scenery, view, -90).look_from, {0, 5, 40}, 1e-4);
}

TEST(SceneCamera, AtAPlace) {
  Scenery scenery = ballScene();
  scenery.scene.camera = CameraPlace{{3, 2, 30}, {3, 5, 0}};
  const Camera still = cameraOf(scenery, smallView());
  EXPECT_EQ(still.look_from, (Vec3{3, 2, 30}));
  EXPECT_EQ(still.look_at, (Vec3{3, 5, 0}));
  const Camera turned = cameraOf(scenery, smallView(), 90);
  expectNear(turned.look_from, {33, 2, 0}, 1e-4);
  EXPECT_EQ(turned.look_at, still.look_at);
}

TEST(SceneCamera, OnTheTerrainsPath) {
  Scenery scenery;
  scenery.scene.terrain.emplace();
  scenery.scene.camera_path = true;
  PictureSettings view = smallView();
  for (const double time : {0.0, 12.0}) {
    view.time_seconds = time;
    const TerrainCamera path = terrainPath(time, *scenery.scene.terrain);
    const Camera camera = cameraOf(scenery, view);
    EXPECT_EQ(camera.look_from, path.position);
    EXPECT_EQ(camera.look_at, path.target);
    EXPECT_EQ(camera.roll_radians, path.roll_radians);
    EXPECT_NE(camera.roll_radians, 0);
  }
}

// --- Drafts ---

TEST(Draft, HasFewerSamplesAndCoarserSteps) {
  SceneFile scene;
  scene.post = publishedPost();
  scene.post.published->channels.samples_per_side = 4;
  scene.post.sky_samples_per_side = 4;
  scene.terrain.emplace().samples_per_side = 4;
  scene.terrain->shape.normal_octaves = 16;
  scene.terrain->march.tolerance = 0.001F;
  scene.slabs.resize(2);
  for (SlabSettings& slab : scene.slabs) slab.samples_per_side = 4, slab.samples = 64;
  scene.slabs[1].samples = 2;
  scene.distance_clouds.emplace_back().samples_per_side = 4;
  scene.density_clouds.emplace_back().samples_per_side = 4;
  scene.distance_clouds[0].octaves = scene.density_clouds[0].octaves = 8;
  scene.density_clouds[0].parts = 16;
  scene.density_clouds[0].part_length = 3;
  makeDraft(scene);
  EXPECT_EQ(scene.post.published->channels.samples_per_side, 1);
  EXPECT_EQ(scene.post.sky_samples_per_side, 1);
  EXPECT_EQ(scene.terrain->samples_per_side, 1);
  EXPECT_LT(scene.terrain->shape.normal_octaves, 16);
  EXPECT_GT(scene.terrain->march.tolerance, 0.001F);
  for (const SlabSettings& slab : scene.slabs) EXPECT_EQ(slab.samples_per_side, 1);
  EXPECT_EQ(scene.slabs[0].samples, 16);
  EXPECT_EQ(scene.slabs[1].samples, 1) << "there is at least one";
  EXPECT_EQ(scene.distance_clouds[0].samples_per_side, 1);
  EXPECT_LT(scene.distance_clouds[0].octaves, 8);
  EXPECT_EQ(scene.density_clouds[0].samples_per_side, 1);
  EXPECT_LT(scene.density_clouds[0].octaves, 8);
  EXPECT_LT(scene.density_clouds[0].parts, 16);
  EXPECT_EQ(scene.density_clouds[0].part_length, 6);
}

TEST(Draft, NeverAddsDetail) {
  SceneFile scene;
  scene.terrain.emplace().shape.normal_octaves = 2;
  scene.terrain->march.tolerance = 0.05F;
  scene.distance_clouds.emplace_back().octaves = 1;
  scene.density_clouds.emplace_back().octaves = 1;
  scene.density_clouds[0].parts = 2;
  makeDraft(scene);
  EXPECT_EQ(scene.terrain->shape.normal_octaves, 2);
  EXPECT_EQ(scene.terrain->march.tolerance, 0.05F);
  EXPECT_EQ(scene.distance_clouds[0].octaves, 1);
  EXPECT_EQ(scene.density_clouds[0].octaves, 1);
  EXPECT_EQ(scene.density_clouds[0].parts, 2);
}

// --- Pictures ---

// Mesh clouds alone are the chain, tone mapped.
TEST(DrawScene, MeshCloudsAloneAreTheChain) {
  const Scenery scenery = ballScene();
  PictureSettings view = smallView();
  view.exposure = 1.5F;
  view.time_seconds = 3;
  const Drawn drawn = draw(scenery, view);
  PostSettings post = scenery.scene.post;
  post.distort.time_seconds = 3;
  const LightSettings light = lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees);
  EXPECT_EQ(drawn.image.pixels, toneMap(renderMeshClouds(scenery.instances, cameraOf(scenery, view), light, post), 1.5F).pixels);
  EXPECT_EQ(renderersOf(drawn), (std::vector<std::string>{"sky", "mesh clouds"}));
  EXPECT_FALSE(drawn.parts.steps.empty());
  view.time_seconds = 4;
  EXPECT_NE(draw(scenery, view).image.pixels, drawn.image.pixels) << "the swirls move";
}

TEST(DrawScene, ExposureAndGammaBySquareRoot) {
  Scenery scenery;
  scenery.scene.camera = CameraPlace{{0, 0, 0}, {0, 0, -1}};
  scenery.scene.fog.density = 1e-6F;  // it alone makes this a scene of layers, without any layer
  scenery.scene.grade.sqrt_gamma = true;
  PictureSettings view = smallView();
  view.exposure = 0.25F;
  const Drawn drawn = draw(scenery, view);
  const Image sky = skyOf(scenery, view);
  ASSERT_EQ(drawn.image.pixels.size(), sky.pixels.size());
  for (size_t i = 0; i < sky.pixels.size(); ++i) {
    const Vec3 c = sky.pixels[i];
    expectNear(drawn.image.pixels[i], 0.5F * Vec3{std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)}, 1e-4);
  }
  EXPECT_EQ(renderersOf(drawn), std::vector<std::string>{"sky"});
  scenery.scene.grade.sqrt_gamma = false;
  EXPECT_EQ(draw(scenery, view).image.pixels, toneMap(sky, 0.25F).pixels);
}

TEST(DrawScene, GradesInTheirOrder) {
  Scenery scenery;
  scenery.scene.camera = CameraPlace{{0, 0, 0}, {0, 0, -1}};
  scenery.scene.fog.density = 1e-6F;
  const Image plain = draw(scenery).image;
  scenery.scene.grade.vignette = VignetteSettings{0.2F, 0.5F};
  EXPECT_EQ(draw(scenery).image.pixels, vignette(plain, {0.2F, 0.5F}).pixels);
  scenery.scene.grade.contrast = ContrastSettings{0.75F, {0.1F, 0, 0.2F}};
  EXPECT_EQ(draw(scenery).image.pixels, contrast(vignette(plain, {0.2F, 0.5F}), {0.75F, {0.1F, 0, 0.2F}}).pixels);
}

// Fog that hides everything behind it: at the ball only its own colour is left, and the sky stays.
TEST(DrawScene, FogHidesWhatIsFar) {
  Scenery scenery = ballScene();
  PostSettings& post = scenery.scene.post;  // without anything that mixes pixels
  post.painted = {.depth_spread = 0, .soften = {0, 0}, .erode = {.shrink = 0, .darkening = 0}};
  post.distort.swirl_strength = 0;
  scenery.scene.fog = {1000, {0.5F, 0.25F, 0.125F}};
  scenery.scene.grade.sqrt_gamma = true;
  const Drawn drawn = draw(scenery);
  expectNear(drawn.image.at(kWidth / 2, kHeight / 2), {std::sqrt(0.5F), 0.5F, std::sqrt(0.125F)}, 1e-3);
  const Vec3 sky = skyOf(scenery).at(0, 0);
  expectNear(drawn.image.at(0, 0), {std::sqrt(sky.x), std::sqrt(sky.y), std::sqrt(sky.z)}, 1e-4);
  EXPECT_EQ(renderersOf(drawn), (std::vector<std::string>{"sky", "mesh clouds"}));
}

// Flat ground: level 20 above it, all below the horizon is terrain and all above it is sky.
Scenery flatTerrain() {
  Scenery scenery;
  scenery.scene.camera = CameraPlace{{0, 20, 0}, {0, 20, -1}};
  TerrainSettings& terrain = scenery.scene.terrain.emplace();
  terrain.scale = 1;
  terrain.shape.amplitude = 0;
  terrain.use_own_fog = terrain.use_sun_scatter = false;
  return scenery;
}

TEST(DrawScene, TerrainLiesUnderItsSky) {
  Scenery scenery = flatTerrain();
  const Drawn drawn = draw(scenery);
  EXPECT_EQ(renderersOf(drawn), (std::vector<std::string>{"sky", "terrain"}));
  const Image sky = toneMap(skyOf(scenery), 1);
  EXPECT_EQ(drawn.image.at(3, 0), sky.at(3, 0));
  EXPECT_GT(length(drawn.image.at(3, kHeight - 1) - sky.at(3, kHeight - 1)), 0.01F);
  scenery.scene.terrain_sky = true;
  const Image own = draw(scenery).image;
  const LightSettings light = lightForSun(smallView().sun_azimuth_degrees, smallView().sun_elevation_degrees);
  const Image expected = toneMap(renderTerrainSky(cameraOf(scenery, smallView()), light.sky.to_sun, *scenery.scene.terrain), 1);
  EXPECT_EQ(own.at(3, 0), expected.at(3, 0));
  EXPECT_EQ(own.at(3, kHeight - 1), drawn.image.at(3, kHeight - 1)) << "the ground is the same";
}

TEST(DrawScene, CloudsBeforeAndBelowTheTerrain) {
  Scenery scenery = flatTerrain();
  const Image ground = draw(scenery).image;
  const auto with = [&](Vec3 position) {
    Scenery all = scenery;
    all.scene.post.distort.swirl_strength = 0;
    all.instances.push_back({&ball(), placement(position, {}, {6, 6, 6})});
    return draw(all).image;
  };
  const int x = kWidth / 2, y = kHeight - 3;
  EXPECT_GT(length(with({0, 12, -30}).at(x, y) - ground.at(x, y)), 0.05F);
  expectNear(with({0, -30, -30}).at(x, y), ground.at(x, y), 1e-6);
}

// What stands beside a mesh cloud, out of view, changes nothing of it: neither its fog, nor how its pixels are averaged.
TEST(DrawScene, MeshCloudsAreTheSameBesideOtherLayers) {
  for (const bool published : {false, true})
    for (const ChannelMean mean : {ChannelMean::kCovered, ChannelMean::kAll}) {
      Scenery scenery = ballScene();
      if (published) {
        scenery.scene.post = publishedPost();
        setChannelMean(scenery.scene.post, mean);
      }
      scenery.scene.post.composite.fog_density = 2;
      const Image alone = draw(scenery).image;
      Scenery other = scenery;
      other.scene.post.composite.fog_density = 0;
      EXPECT_NE(draw(other).image.pixels, alone.pixels) << "there is no fog";
      scenery.scene.slabs.resize(1);
      scenery.scene.slabs[0].bottom = -30, scenery.scene.slabs[0].center = -20, scenery.scene.slabs[0].top = -10;  // no ray rises to it
      const Drawn beside = draw(scenery);
      EXPECT_EQ(renderersOf(beside).back(), "slab clouds");
      EXPECT_EQ(beside.image.pixels, alone.pixels) << (published ? "published" : "painted");
      // Fog over distance comes in place of the chain's.
      scenery.scene.fog = {1e-9F, {1, 0, 0}};
      EXPECT_LT(length(draw(scenery).image.at(kWidth / 2, kHeight / 2) - draw(other).image.at(kWidth / 2, kHeight / 2)), 1e-4F);
    }
}

// A picture that is drawn a few rows at a time has the same bits: with every layer, blurred, and as a sheet.
TEST(DrawScene, RowsAreDrawnAlikeInAnyGroups) {
  Scenery scenery = ballScene({0, 2, 0});
  SceneFile& scene = scenery.scene;
  scene.camera = CameraPlace{{0, 3, 12}, {0, 3.5F, 0}};
  scene.terrain.emplace().samples_per_side = 2;
  scene.terrain->scale = 0.1F;
  scene.slabs.resize(2);
  scene.slabs[0].samples_per_side = 3, scene.slabs[0].bottom = 6, scene.slabs[0].center = 7, scene.slabs[0].top = 9;
  scene.distance_clouds.emplace_back();
  scene.density_clouds.emplace_back().parts = 2;
  scene.clouds.resize(1);
  HarmonicLattice lattice{{-2, 0, -2}, 2, {3, 3, 3}, 1, 1, {}};
  for (int i = 0; i < 27 * 4; ++i) lattice.coefficients.push_back(i % 4 == 0 ? 1.0F : 0.2F);
  scene.dust.push_back({"", std::make_shared<const HarmonicLattice>(lattice), {}, {}});
  for (const bool published : {false, true})
    for (const bool sheet : {false, true}) {
      if (published) scene.post = publishedPost();
      scene.compares_techniques = sheet;
      scene.grade.motion_blur.emplace();
      PictureSettings roomy = smallView(), scarce = smallView();
      roomy.height = scarce.height = 37;
      scarce.memory_limit = 1;
      Camera camera;
      camera.width = kWidth, camera.height = 37;
      scene.view = scarce;
      ASSERT_EQ(rowsTogether(scene, camera), 8);
      scene.view = roomy;
      ASSERT_EQ(rowsTogether(scene, camera), 37);
      const CameraTurn turn{0, -5};
      EXPECT_EQ(draw(scenery, scarce, turn).image.pixels, draw(scenery, roomy, turn).image.pixels) << published << sheet;
    }
}

// Marched clouds that lie half under the ground are seen down to the ground.
TEST(DrawScene, MarchedCloudsAreCutAtTheGround) {
  Scenery scenery = flatTerrain();
  scenery.scene.camera = CameraPlace{{0, 20, 0}, {0, 14, -20}};
  scenery.scene.grade.sqrt_gamma = true;
  scenery.scene.shadows.are_drawn = false;
  const Image ground = draw(scenery).image;
  DensityCloudSettings& clouds = scenery.scene.density_clouds.emplace_back();
  clouds.cloud_height = 0, clouds.dither = 0, clouds.parts = 64, clouds.part_length = 0.05F, clouds.fade_density = 0;
  const Image picture = draw(scenery).image;
  Scenery floating = scenery;
  floating.scene.density_clouds[0].cloud_height = -20;
  EXPECT_EQ(draw(floating).image.pixels, ground.pixels) << "clouds under the ground show";
  const Camera camera = cameraOf(scenery, smallView());
  const LightSettings light = lightForSun(smallView().sun_azimuth_degrees, smallView().sun_elevation_degrees);
  int seen = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const auto hit = marchTerrain(ray, *scenery.scene.terrain);
      if (!hit) continue;
      // By hand: samples count as long as they are before the ground.
      const float cosine = dot(ray.direction, light.sky.to_sun);
      const LayerPixel expected = accumulateSamples(clouds.first_t, clouds.samples * clouds.parts, 0.99F, [&](float t) {
        const float density = t < float(hit->distance) ? densityCloudDensity(ray.origin + ray.direction * t, clouds) : 0;
        return densityCloudSample(t, density, cosine, skyColor(ray.direction, light.sky), clouds);
      });
      const Vec3 g = ground.at(x, y), behind{g.x * g.x, g.y * g.y, g.z * g.z};
      const Vec3 color = expected.color * expected.opacity + behind * (1 - expected.opacity), found = picture.at(x, y);
      EXPECT_LT(length(Vec3{found.x * found.x, found.y * found.y, found.z * found.z} - color), 0.02F) << x << " " << y;
      seen += expected.opacity > 0.2F;
    }
  EXPECT_GT(seen, 20);
}

TEST(DrawScene, EveryKindOfCloudIsALayer) {
  Scenery scenery = ballScene();
  scenery.scene.slabs.resize(1);
  scenery.scene.slabs[0].samples = 4;
  scenery.scene.distance_clouds.resize(1);
  scenery.scene.distance_clouds[0].samples = 4;
  scenery.scene.density_clouds.resize(1);
  scenery.scene.density_clouds[0].samples = 4;
  EXPECT_EQ(renderersOf(draw(scenery)),
            (std::vector<std::string>{"shadows", "sky", "mesh clouds", "slab clouds", "distance clouds", "density clouds"}));
  // The sheet has each alone, in two columns, and is larger than a picture.
  scenery.scene.compares_techniques = true;
  const Image sheet = draw(scenery).image;
  EXPECT_GT(sheet.width, 2 * kWidth);
  EXPECT_GT(sheet.height, 2 * kHeight);
  scenery.scene.density_clouds.clear();
  scenery.scene.distance_clouds.clear();
  EXPECT_LT(draw(scenery).image.height, sheet.height) << "a row less";
}

TEST(DrawScene, MotionBlursAlongThePathOnly) {
  Scenery scenery = flatTerrain();
  const Image still = draw(scenery).image;
  scenery.scene.grade.motion_blur.emplace();
  EXPECT_EQ(draw(scenery).image.pixels, still.pixels) << "a camera at a place does not move";
  scenery.scene.camera.reset();
  scenery.scene.camera_path = true;
  const Image blurred = draw(scenery).image;
  scenery.scene.grade.motion_blur.reset();
  EXPECT_NE(draw(scenery).image.pixels, blurred.pixels);
}

}  // namespace
}  // namespace cloudbake
