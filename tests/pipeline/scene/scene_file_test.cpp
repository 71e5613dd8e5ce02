// Scenes as docs/previewer.md describes them.
#include "pipeline/scene/scene_file.h"

#include <cmath>

#include "io/image/image.h"
#include "tests/pipeline/picture_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

PictureSettings same(const PictureSettings& view) { return view; }

SceneFile scene(const std::string& text) { return readSceneFile("/scenes/a.toml", text, same); }
// The smallest cloud, for scenes in which something else matters.
SceneFile withCloud(const std::string& text) { return scene(text + "\n[[cloud]]\nfile = 'a.glb'\n"); }

void expectRefusal(const std::string& text, const std::string& says) {
  expectError<InputError>([&] { scene(text); }, says);
}

SceneNeeds needs(const std::string& text) {
  const TestFolder folder;
  return readSceneNeeds(folder.write("bake.toml", text));
}

// --- Placement ---

TEST(Placement, ScaleThenRotationThenPosition) {
  const Affine still = placement({1, 2, 3}, {}, {2, 3, 4});
  expectNear(transformPoint(still, {1, 1, 1}), {3, 5, 7}, 1e-5);
  expectNear(transformVector(still, {1, 1, 1}), {2, 3, 4}, 1e-5);
  // A quarter turn about each axis takes the next axis to the one after.
  expectNear(transformVector(placement({}, {90, 0, 0}, {1, 1, 1}), {0, 1, 0}), {0, 0, 1}, 1e-5);
  expectNear(transformVector(placement({}, {0, 90, 0}, {1, 1, 1}), {0, 0, 1}), {1, 0, 0}, 1e-5);
  expectNear(transformVector(placement({}, {0, 0, 90}, {1, 1, 1}), {1, 0, 0}), {0, 1, 0}, 1e-5);
  // The scale comes first: x is stretched before it turns to y.
  expectNear(transformVector(placement({}, {0, 0, 90}, {5, 1, 1}), {1, 0, 0}), {0, 5, 0}, 1e-5);
  // About x, then about y: y goes to z and from there to x. In the other order it would stay z.
  expectNear(transformVector(placement({}, {90, 90, 0}, {1, 1, 1}), {0, 1, 0}), {1, 0, 0}, 1e-5);
  // About y, then about z: z goes to x and from there to y.
  expectNear(transformVector(placement({}, {0, 90, 90}, {1, 1, 1}), {0, 0, 1}), {0, 1, 0}, 1e-5);
}

// --- Whole scenes ---

TEST(SceneFile, Defaults) {
  const SceneFile s = withCloud("");
  const PictureSettings plain;
  EXPECT_EQ(s.view.width, plain.width);
  EXPECT_EQ(s.view.sun_azimuth_degrees, kPaintedView.sun_azimuth);
  EXPECT_EQ(s.view.sun_elevation_degrees, kPaintedView.sun_elevation);
  EXPECT_FALSE(s.camera || s.camera_distance || s.camera_path || s.terrain || s.terrain_sky || s.compares_techniques);
  EXPECT_FALSE(s.grade.vignette || s.grade.contrast || s.grade.sqrt_gamma || s.grade.motion_blur);
  EXPECT_FALSE(s.light.sky.moon);
  EXPECT_EQ(s.fog.density, 0);
  EXPECT_EQ(s.fog.color, s.light.sky.colors.horizon) << "unset: the sky's horizon";
  ASSERT_EQ(s.clouds.size(), 1U);
  EXPECT_EQ(s.clouds[0].file, "/scenes/a.glb");
  EXPECT_TRUE(s.clouds[0].preset.empty());
  expectNear(transformPoint(s.clouds[0].to_world, {1, 2, 3}), {1, 2, 3}, 1e-5);
}

TEST(SceneFile, PictureCameraAndSun) {
  const SceneFile s = withCloud(R"(
    [picture]
    width = 320
    height = 200
    exposure = 1.5
    time = 7
    layout = "techniques"
    [camera]
    azimuth = 20
    elevation = -10
    fov = 50
    distance = 40
    [sun]
    azimuth = [60, 120]
    elevation = [10, 40])");
  EXPECT_EQ(s.view.width, 320);
  EXPECT_EQ(s.view.height, 200);
  EXPECT_EQ(s.view.exposure, 1.5F);
  EXPECT_EQ(s.view.time_seconds, 7);
  EXPECT_TRUE(s.compares_techniques);
  EXPECT_EQ(s.view.camera_azimuth_degrees, 20);
  EXPECT_EQ(s.view.camera_elevation_degrees, -10);
  EXPECT_EQ(s.view.field_of_view_degrees, 50);
  EXPECT_EQ(s.camera_distance, 40);
  EXPECT_EQ(s.view.sun_azimuth_degrees, 90) << "a picture has the sun in the middle of its range";
  EXPECT_EQ(s.view.sun_elevation_degrees, 25);
  const float up = std::sin(float(25 * kPi / 180)), along = std::cos(float(25 * kPi / 180));
  expectNear(s.light.sky.to_sun, {along, up, 0}, 1e-5);
}

// The light follows the sun that the command line gives.
TEST(SceneFile, TheCommandLineWins) {
  const SceneFile s =
      readSceneFile("a.toml", "[picture]\nwidth = 320\n[sun]\nelevation = 10\n[[cloud]]\nfile = 'a.glb'\n", [](PictureSettings view) {
        EXPECT_EQ(view.width, 320);
        view.height = 99;
        view.sun_elevation_degrees = 90;
        return view;
      });
  EXPECT_EQ(s.view.width, 320);
  EXPECT_EQ(s.view.height, 99);
  expectNear(s.light.sky.to_sun, {0, 1, 0}, 1e-5);
  EXPECT_EQ(s.light.sky.colors.zenith, skyColorsForSun(1).zenith);
}

TEST(SceneFile, CameraByPlace) {
  const SceneFile s = withCloud("[camera]\nposition = [0, 2, 30]\ntarget = [0, 5, 0]\n");
  ASSERT_TRUE(s.camera);
  EXPECT_EQ(s.camera->look_from, (Vec3{0, 2, 30}));
  EXPECT_EQ(s.camera->look_at, (Vec3{0, 5, 0}));
}

TEST(SceneFile, CamerasThatContradictThemselves) {
  const std::string cloud = "[[cloud]]\nfile = 'a.glb'\n[camera]\n";
  expectRefusal(cloud + "position = [0, 2, 30]\n", "a position but no target");
  expectRefusal(cloud + "target = [0, 2, 30]\n", "a target but no position");
  for (const char* angle : {"azimuth = 1", "elevation = 1", "distance = 1"})
    expectRefusal(cloud + "position = [0, 2, 30]\ntarget = [0, 0, 0]\n" + angle + "\n", "a position and angles");
  expectRefusal(cloud + "position = [1, 2, 3]\ntarget = [1, 2, 3]\n", "the same point");
  EXPECT_TRUE(contains(refusalOf<InputError>([&] { scene(cloud + "path = 'terrain'\n"); }), "needs a [terrain]"));
  expectRefusal("[terrain]\n[camera]\npath = 'terrain'\nposition = [0, 2, 30]\ntarget = [0, 0, 0]\n", "a path and a position");
  expectRefusal("[terrain]\n", "no cloud to frame");
  EXPECT_TRUE(scene("[terrain]\n[camera]\npath = 'terrain'\n").camera_path);
}

TEST(SceneFile, ErrorsNameTheirPlace) {
  const std::string said = refusalOf<InputError>([] { scene("[picture]\n\nwidth = 0\n"); });
  EXPECT_TRUE(contains(said, "/scenes/a.toml:3:")) << said;
  EXPECT_TRUE(contains(said, "width")) << said;
  expectRefusal("[picture]\nwidht = 3\n", "widht");
  expectRefusal("colour = 3\n[[cloud]]\nfile = 'a.glb'\n", "colour");
  expectRefusal("", "the scene is empty");
  EXPECT_FALSE(refusalOf<InputError>([] { scene("[picture\n"); }).empty());
}

TEST(SceneFile, Clouds) {
  const SceneFile s = scene(R"(
    [[cloud]]
    file = "../b.glb"
    position = [14, 3, -20]
    rotation = [0, 90, 0]
    scale = 0.5
    [[cloud]]
    preset = "congestus"
    seed = 3
    vertices = 500
    lobe = "mean"
    scale = [-1.5, -1, -1]
    [[cloud]]
    preset = "own/recipe.toml")");
  ASSERT_EQ(s.clouds.size(), 3U);
  EXPECT_EQ(s.clouds[0].file, "/scenes/../b.glb");
  expectNear(transformPoint(s.clouds[0].to_world, {0, 0, 2}), {15, 3, -20}, 1e-5);
  EXPECT_EQ(s.clouds[1].preset, "congestus");
  EXPECT_EQ(s.clouds[1].seed, 3U);
  EXPECT_EQ(s.clouds[1].vertices, 500U);
  EXPECT_FALSE(s.clouds[1].fit);
  expectNear(transformPoint(s.clouds[1].to_world, {1, 1, 1}), {-1.5F, -1, -1}, 1e-5);
  EXPECT_EQ(s.clouds[2].preset, "/scenes/own/recipe.toml") << "recipes are named from the scene's folder";
  EXPECT_TRUE(s.clouds[2].fit);
  EXPECT_EQ(s.clouds[2].seed, 1U);
  EXPECT_EQ(s.clouds[2].vertices, 10000U);
}

TEST(SceneFile, CloudsThatCannotBe) {
  expectRefusal("[[cloud]]\n", "either a file");
  expectRefusal("[[cloud]]\nfile = 'a.glb'\npreset = 'hero'\n", "either a file");
  expectRefusal("[[cloud]]\nfile = 'a.glb'\nseed = 3\n", "seed");
  expectRefusal("[[cloud]]\nfile = 'a.glb'\nscale = [1, 0, 1]\n", "flattens the cloud");
  expectRefusal("[[cloud]]\nfile = 'a.glb'\nscale = 0\n", "flattens the cloud");
}

// --- Fields of clouds ---

const std::string kBox = "[cloud.scatter]\nlow = [-5, 1, -5]\nhigh = [5, 2, 5]\n";

TEST(SceneFields, AreCloudsWithABox) {
  const SceneFile s = scene("[[cloud]]\nfiles = ['a.glb', 'b.glb']\nweights = [3, 1]\nlevels = true\nrotation = [0, 90, 0]\n" + kBox +
                            "count = 7\ndrift = [1, 0, 0]\nsize = [0.5, 2]\n[[cloud]]\npreset = 'hero'\nseed = 4\n" + kBox +
                            "[[cloud]]\npresets = ['hero', 'own.toml']\n" + kBox + "[[cloud]]\nfile = 'c.glb'\n");
  ASSERT_EQ(s.fields.size(), 3U);
  ASSERT_EQ(s.clouds.size(), 1U);
  EXPECT_EQ(s.clouds[0].file, "/scenes/c.glb");
  const SceneField& first = s.fields[0];
  ASSERT_EQ(first.clouds.size(), 2U);
  EXPECT_EQ(first.clouds[1].file, "/scenes/b.glb");
  EXPECT_TRUE(first.clouds[1].levels);
  EXPECT_EQ(first.weights, (std::vector<double>{3, 1}));
  EXPECT_EQ(first.scatter.low, (Vec3{-5, 1, -5}));
  EXPECT_EQ(first.scatter.high, (Vec3{5, 2, 5}));
  EXPECT_EQ(first.scatter.count, 7U);
  EXPECT_EQ(first.scatter.drift, (Vec3{1, 0, 0}));
  expectNear(transformVector(first.clouds[1].to_world, {0, 0, 1}), {1, 0, 0}, 1e-6);
  EXPECT_EQ(s.fields[1].clouds[0].seed, 4U);
  EXPECT_EQ(s.fields[1].weights, std::vector<double>{1});
  ASSERT_EQ(s.fields[2].clouds.size(), 2U);
  EXPECT_EQ(s.fields[2].clouds[1].preset, "/scenes/own.toml");
}

TEST(SceneFields, AreRefusedWithACure) {
  const std::string cloud = "[[cloud]]\nfile = 'a.glb'\n", two = "[[cloud]]\nfiles = ['a.glb', 'b.glb']\n";
  expectRefusal(two, "add a [cloud.scatter] with its box");
  expectRefusal("[[cloud]]\npresets = ['hero']\n", "add a [cloud.scatter] with its box");
  expectRefusal(cloud + "files = ['b.glb']\n" + kBox, "either a file");
  expectRefusal("[[cloud]]\nfiles = []\n" + kBox, "files must be a list of names");
  expectRefusal("[[cloud]]\nfiles = ['a.glb', 3]\n" + kBox, "files must be a list of names");
  expectRefusal("[[cloud]]\nfiles = 'a.glb'\n" + kBox, "files must be a list of names");
  expectRefusal(cloud + "weights = [1]\n" + kBox, "'weights' belongs to several clouds");
  expectRefusal(cloud + "weights = [1]\n", "'weights' belongs to several clouds");
  expectRefusal(two + "weights = [1]\n" + kBox, "weights must be a list of 2 numbers");
  expectRefusal(two + "weights = [1, 2, 3]\n" + kBox, "weights must be a list of 2 numbers");
  expectRefusal(two + "weights = 3\n" + kBox, "weights must be a list of 2 numbers");
  expectRefusal(two + "weights = [1, 0]\n" + kBox, "numbers above 0");
  expectRefusal(two + "weights = [1, 'x']\n" + kBox, "weights must be");
  expectRefusal(cloud + "drift = [1, 0, 0]\n", "'drift' belongs to [cloud.scatter]");
  expectRefusal(cloud + "position = [1, 0, 0]\n" + kBox, "leave 'position' out");
  const std::string scatter = cloud + "[cloud.scatter]\n";
  expectRefusal(scatter, "[cloud.scatter] has no low");
  expectRefusal(scatter + "low = [0, 0, 0]\n", "[cloud.scatter] has no high");
  for (const char* high : {"[0, 1, 1]", "[1, -1, 1]", "[1, 1, 0]"})
    expectRefusal(scatter + "low = [0, 0, 0]\nhigh = " + high + "\n", "the box is empty");
  EXPECT_NO_THROW(scene(scatter + "low = [0, 0, 0]\nhigh = [1, 0, 1]\n"));
  expectRefusal(scatter + "low = [0, 0, 0]\nhigh = [1, 0, 1]\ndrift = [0, 1, 0]\n", "a box without a height");
  expectRefusal(cloud + kBox + "size = [2, 1]\n", "swap its numbers");
  expectRefusal(cloud + kBox + "probability = 1.5\n", "probability must be a number from 0 to 1");
  expectRefusal(cloud + kBox + "cuont = 3\n", "cuont");
  try {
    scene(two + "weights = [1]\n" + kBox);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).find("/scenes/a.toml:3:11") != std::string::npos) << error.what();
  }
}

TEST(SceneFile, SkyMoonAndLight) {
  const SceneFile s = withCloud(R"(
    [sky]
    disc = "smooth"
    glow = 0.75
    horizon_exponent = 12
    viewer_height = 0.25
    smooth_radius = 2
    smooth_softness = 3
    smooth_gain = 4
    [sky.colors]
    sun = [1, 2, 3]
    zenith = [4, 5, 6]
    horizon = [7, 8, 9]
    ground = [10, 11, 12]
    ambient_sky = [13, 14, 15]
    ambient_ground = [16, 17, 18]
    [sky.moon]
    azimuth = 270
    elevation = 0
    phase = 60
    color = [1, 0, 0]
    [light]
    extinction = 0.5
    half_lambert = 0.25
    lobes_only = true)");
  const SkySettings& sky = s.light.sky;
  EXPECT_EQ(sky.sun_disc, DiscKind::kSmooth);
  EXPECT_EQ(sky.glow, 0.75F);
  EXPECT_EQ(sky.horizon_exponent, 12);
  EXPECT_EQ(sky.viewer_height, 0.25F);
  EXPECT_EQ(sky.smooth_disc.radius, 2);
  EXPECT_EQ(sky.smooth_disc.softness, 3);
  EXPECT_EQ(sky.smooth_disc.gain, 4);
  EXPECT_EQ(sky.colors.sun_color, (Vec3{1, 2, 3}));
  EXPECT_EQ(sky.colors.zenith, (Vec3{4, 5, 6}));
  EXPECT_EQ(sky.colors.horizon, (Vec3{7, 8, 9}));
  EXPECT_EQ(sky.colors.ground, (Vec3{10, 11, 12}));
  EXPECT_EQ(sky.colors.ambient_sky, (Vec3{13, 14, 15}));
  EXPECT_EQ(sky.colors.ambient_ground, (Vec3{16, 17, 18}));
  ASSERT_TRUE(sky.moon);
  expectNear(sky.moon->direction, {-1, 0, 0}, 1e-5);
  EXPECT_EQ(sky.moon->phase_degrees, 60);
  EXPECT_EQ(sky.moon->color, (Vec3{1, 0, 0}));
  EXPECT_EQ(s.fog.color, (Vec3{7, 8, 9}));
  EXPECT_EQ(s.light.extinction, 0.5F);
  EXPECT_EQ(s.light.half_lambert, 0.25F);
  EXPECT_TRUE(s.light.lobes_only);
  EXPECT_EQ(withCloud("[sky]\ndisc = 'none'\ndisc_gain = 9\n").light.sky.disc.gain, 0);
  const SceneFile zenith = withCloud("[sky.moon]\nelevation = 90\n");
  EXPECT_LT(std::abs(dot(zenith.light.sky.moon->direction, zenith.light.sky.moon->up)), 0.1F) << "its top is not along the view";
}

// --- The sky over a day ---

TEST(Day, TheClockHasHoursAndMinutes) {
  const auto clockAt = [](double hour, double day_seconds = 0, double time_seconds = 0) {
    return Day{hour, day_seconds, {}}.clockAt(time_seconds);
  };
  EXPECT_EQ(clockAt(8.5), "08:30");
  EXPECT_EQ(clockAt(0), "00:00");
  EXPECT_EQ(clockAt(5.99), "05:59") << "before sunrise";
  EXPECT_EQ(clockAt(12), "12:00");
  EXPECT_EQ(clockAt(17.75), "17:45");
  EXPECT_EQ(clockAt(23.999), "00:00") << "to the nearest minute";
  EXPECT_EQ(clockAt(24), "00:00");
  EXPECT_EQ(clockAt(20, 48, 10), "01:00") << "an hour takes two seconds";
}

TEST(SunCircle, RisesCulminatesAndSets) {
  const SunCircle circle({130, 50});
  expectNear(circle.directionAt(0), directionFromAngles(40, 0), 1e-6);
  expectNear(circle.directionAt(90), directionFromAngles(130, 50), 1e-6);
  expectNear(circle.directionAt(180), directionFromAngles(220, 0), 1e-6);
  EXPECT_LT(circle.directionAt(200).y, 0);
  for (const double degrees : {-20.0, 10.0, 75.0, 133.0, 290.0}) {
    EXPECT_NEAR(dot(circle.directionAt(degrees), circle.axis()), 0, 1e-6) << "it leaves its circle";
    const SunAngles angles = circle.anglesAt(degrees);
    expectNear(directionFromAngles(angles.azimuth_degrees, angles.elevation_degrees), circle.directionAt(degrees), 2e-5);
  }
}

TEST(SceneFile, TheHourPlacesSunMoonAndStars) {
  const auto at = [](const std::string& hour, const std::string& more = "", double time = 0) {
    return readSceneFile("/scenes/a.toml", "[sun]\nazimuth = 120\nelevation = 60\n" + hour + "\n[[cloud]]\nfile = 'a.glb'\n" + more,
                         [&](PictureSettings view) {
                           view.time_seconds = time;
                           return view;
                         });
  };
  const SunCircle circle({120, 60});
  expectNear(at("hour = 12").light.sky.to_sun, directionFromAngles(120, 60), 1e-4);
  expectNear(at("hour = 6").light.sky.to_sun, directionFromAngles(30, 0), 1e-4);
  expectNear(at("hour = 9").light.sky.to_sun, circle.directionAt(45), 1e-4);
  expectNear(at("hour = 0").light.sky.to_sun, -directionFromAngles(120, 60), 1e-4);
  expectNear(at("hour = 9\nday_seconds = 240", "", 10).light.sky.to_sun, circle.directionAt(60), 1e-4);  // an hour later
  EXPECT_EQ(at("hour = 9").view.sun_elevation_degrees, circle.anglesAt(45).elevation_degrees);
  EXPECT_EQ(at("hour = 0").light.sky.colors.zenith, skyColorsForSun(-0.9F).zenith);

  // The full moon is opposite; a half moon that grows is a quarter of a turn behind, one that wanes before, and both show the sun their lit
  // side.
  const auto moonAt = [&](const std::string& phase) { return *at("hour = 14", "[sky.moon]\nphase = " + phase).light.sky.moon; };
  const Vec3 sun = circle.directionAt(120);
  expectNear(moonAt("0").direction, -sun, 1e-4);
  expectNear(moonAt("90").direction, circle.directionAt(30), 1e-4);
  expectNear(moonAt("-90").direction, circle.directionAt(210), 1e-4);
  for (const std::string phase : {"90", "-90", "40", "-130"}) {
    const MoonSettings moon = moonAt(phase);
    EXPECT_NEAR(dot(moon.up, moon.direction), 0, 1e-5);
    const Vec3 right = cross(moon.direction, moon.up);
    EXPECT_GT(dot(right, sun) * (phase.starts_with("-") ? -1 : 1), 0.5F) << phase;
    EXPECT_NEAR(dot(sun, moon.direction), -std::cos(std::stod(phase) * kPi / 180), 1e-4) << "phase and place do not agree";
  }
  // A moon that is placed stays; without an hour there is nothing to follow.
  expectNear(at("hour = 3", "[sky.moon]\nazimuth = 200\nelevation = 30").light.sky.moon->direction, directionFromAngles(200, 30), 1e-5);
  expectNear(withCloud("[sky.moon]").light.sky.moon->direction, directionFromAngles(180, 45), 1e-5);
  // Stars turn with the sun.
  const StarSettings stars = *at("hour = 22", "[sky.stars]").light.sky.stars;
  expectNear(stars.pole, circle.axis(), 1e-5);
  EXPECT_NEAR(stars.day_turn_degrees, 240, 1e-3);
  EXPECT_EQ(stars.turn_degrees, 0);
  // --sun goes before the hour.
  const SceneFile asked = readSceneFile("/scenes/a.toml", "[sun]\nhour = 3\n[[cloud]]\nfile = 'a.glb'\n", [](PictureSettings view) {
    view.sun_azimuth_degrees = 10, view.sun_elevation_degrees = 20;
    return view;
  });
  expectNear(asked.light.sky.to_sun, directionFromAngles(10, 20), 1e-5);
}

TEST(SceneFile, TheTopOfTheMoon) {
  const auto upOf = [](const std::string& keys) { return withCloud("[sky.moon]\n" + keys).light.sky.moon->up; };
  EXPECT_EQ(upOf(""), (Vec3{0, 1, 0}));
  expectNear(upOf("up = [3, 0, 0]"), {1, 0, 0}, 1e-6);
  const std::string day = "[sun]\nhour = 20\n[sky.moon]\nphase = 50\n";
  EXPECT_NE(withCloud(day).light.sky.moon->up, (Vec3{0, 1, 0})) << "by the sun";
  EXPECT_EQ(withCloud(day + "up = [0, 1, 0]").light.sky.moon->up, (Vec3{0, 1, 0}));
  EXPECT_EQ(withCloud(day + "up = [0, 1, 0]").light.sky.moon->direction, withCloud(day).light.sky.moon->direction);
  expectRefusal("[sky.moon]\nup = [0, 0, 0]\n", "a.toml:2:6: [sky.moon]: 'up' has no length");
  expectRefusal("[sky.moon]\nazimuth = 90\nelevation = 0\nup = [-2, 0, 0]\n", "a.toml:4:6: [sky.moon]: 'up' is the direction to the moon");
}

TEST(SceneFile, TheDiscOfTheMoon) {
  const MoonSettings moon = *withCloud("[sky.moon]\ndisc = 'smooth'\nsmooth_radius = 1\nsmooth_gain = 0.5\n").light.sky.moon;
  EXPECT_EQ(moon.disc_kind, DiscKind::kSmooth);
  EXPECT_EQ(moon.smooth_disc.radius, 1);
  EXPECT_EQ(moon.smooth_disc.gain, 0.5F);
  EXPECT_EQ(withCloud("[sky.moon]").light.sky.moon->disc_kind, DiscKind::kSimple);
  expectRefusal("[sky.moon]\ndisc = 'none'\n", "one of simple, smooth");
  expectRefusal("[sky.moon]\ndisc = 'smooth'\npicture = 'moon.png'\n", "a.toml:3:11: [sky.moon] has a picture and a smooth disc");
}

TEST(SceneFile, StarsTurn) {
  const auto starsOf = [](const std::string& text) { return *withCloud(text).light.sky.stars; };
  const StarSettings turned = starsOf("[sky.stars]\npole = [0, 0, -4]\nturn = 70\n");
  EXPECT_EQ(turned.pole, (Vec3{0, 0, -1}));
  EXPECT_EQ(turned.turn_degrees, 70);
  EXPECT_EQ(turned.day_turn_degrees, 0);
  const StarSettings of_day = starsOf("[sun]\nhour = 22\n[sky.stars]\nturn = 70\n");
  EXPECT_EQ(of_day.turn_degrees, 70);
  EXPECT_NEAR(of_day.day_turn_degrees, 240, 1e-3) << "of the hour, in addition";
  EXPECT_EQ(starsOf("[sun]\nhour = 22\n[sky.stars]\npole = [1, 0, 0]\n").pole, (Vec3{1, 0, 0}));
  expectRefusal("[sky.stars]\npole = [0, 0, 0]\n", "a.toml:2:8: [sky.stars]: 'pole' has no length");
}

TEST(SceneFile, TheAurora) {
  EXPECT_FALSE(withCloud("").light.sky.aurora);
  const AuroraSettings aurora = *withCloud("[picture]\ntime = 9\ntime_offset = 3\n[sky.aurora]\ntop = 60\n").light.sky.aurora;
  EXPECT_EQ(aurora.top_degrees, 60);
  EXPECT_EQ(aurora.time_seconds, 12);
  expectRefusal("[sky.aurora]\nbottom = 50\ntop = 50\n", "a.toml:2:10: [sky.aurora]: bottom is not below top");
  expectRefusal("[sky.aurora]\nhigh_height = -0.5\n", "a.toml:2:15: [sky.aurora]: low_height is not below high_height");
}

// Everything that the wind moves is ahead of the time, and the hour is not.
TEST(SceneFile, AnOffsetOfTime) {
  const SceneFile s = scene(
      "[picture]\ntime = 9\ntime_offset = 3\n[sun]\nhour = 9\nday_seconds = 240\n[camera]\nposition = [0, 0, 9]\ntarget = [0, 0, 0]\n"
      "[[slab]]\n[[marched]]\n[[marched]]\nfield = 'density'\n");
  EXPECT_EQ(s.slabs.at(0).time_seconds, 12);
  EXPECT_EQ(s.distance_clouds.at(0).time_seconds, 12);
  EXPECT_EQ(s.density_clouds.at(0).time_seconds, 12);
  EXPECT_EQ(s.view.time_seconds, 9);
  EXPECT_NEAR(s.day->degreesAt(s.view.time_seconds), 45 + 9 * 1.5, 1e-9);
}

TEST(SceneFile, ARampMayBeAPicture) {
  const TestFolder folder;
  Image strip = blankImage(4, 2);
  strip.at(0, 0) = {1, 0, 0}, strip.at(0, 1) = {0, 0, 1}, strip.at(3, 0) = {0, 1, 0}, strip.at(1, 0) = {0.5F, 0.5F, 0.5F};
  folder.write("ramp.png", encodePng(strip));
  const auto read = [&](const std::string& text) {
    return readSceneFile(folder.path / "a.toml", text + "\n[[cloud]]\nfile = 'a.glb'\n", same).light.sky;
  };
  const std::string ramp = "[sky]\nramp = 'ramp.png'\n";
  const SkySettings noon = read("[sun]\nelevation = 90\n" + ramp), night = read("[sun]\nelevation = -30\n" + ramp);
  EXPECT_EQ(noon.colors.zenith, (Vec3{1, 0, 0}));
  EXPECT_EQ(noon.colors.ground, (Vec3{0, 1, 0}));
  EXPECT_NEAR(noon.colors.low_sky.x, 0.2158F, 1e-3) << "sRGB becomes linear";
  EXPECT_EQ(noon.colors.sun_color, skyColorsForSun(1).sun_color);
  EXPECT_EQ(noon.colors.ambient_sky, withAmbientOfSky(noon.colors, 1).ambient_sky) << "of the painted sky";
  EXPECT_EQ(night.colors.zenith, (Vec3{0, 0, 1}));
  EXPECT_EQ(read("[sun]\nelevation = 10\n" + ramp + "ramp_low = -5\nramp_high = 10\nramp_gain = 3\n").colors.zenith, (Vec3{3, 0, 0}));
  EXPECT_EQ(read("[sun]\nelevation = 90\n" + ramp + "[sky.colors]\nzenith = [5, 5, 5]\n").colors.zenith, (Vec3{5, 5, 5}));
  const auto expectRefused = [&](const std::string& text, const std::string& says) { expectError<InputError>([&] { read(text); }, says); };
  expectRefused(ramp + "[[sky.hours]]\nelevation = 5\n", "a.toml:2:8: [sky] has a ramp and [[sky.hours]]: give one of the two");
  expectRefused(ramp + "ramp_low = 50\nramp_high = 20\n", "a.toml:3:12: [sky]: ramp_low is not below ramp_high");
  expectRefused(ramp + "ramp_columns = 5\n", "a.toml:2:8: [sky]: ramp.png has 4 pixels in a row, and the ramp 5 columns");
  expectRefused("[sky]\nramp = 'none.png'\n", "a.toml:2:8: [sky]: the picture of the ramp cannot be read: ");
  folder.write("text.png", "no picture");
  expectRefused("[sky]\nramp = 'text.png'\n", "text.png: is not a PNG picture");
  // A bake for the scene needs no colours.
  EXPECT_NO_THROW(needs("[sky]\nramp = 'none.png'\n"));
}

TEST(SceneFile, HoursOfTheSky) {
  const std::string hours =
      "[[sky.hours]]\nelevation = -10\nzenith = [1, 0, 0]\n[[sky.hours]]\nelevation = 50\nzenith = [0, 0, 1]\nground = [9, 9, 9]\n";
  const SceneFile low = withCloud("[sun]\nelevation = -20\n" + hours), high = withCloud("[sun]\nelevation = 60\n" + hours);
  EXPECT_EQ(low.light.sky.colors.zenith, (Vec3{1, 0, 0}));
  EXPECT_EQ(high.light.sky.colors.zenith, (Vec3{0, 0, 1}));
  const Vec3 horizon = skyColorsForSun(float(std::sin(50 * kPi / 180))).horizon;
  EXPECT_EQ(high.light.sky.colors.horizon, horizon) << "what an hour does not say is that of the default sky";
  EXPECT_EQ(high.light.sky.colors.ground, (Vec3{9, 9, 9})) << "a ground of its own is not that of the light";
  EXPECT_EQ(high.light.sky.colors.ambient_sky, withAmbientOfSky(high.light.sky.colors, 1).ambient_sky);
  expectRefusal("[[sky.hours]]\nzenith = [1, 0, 0]\n", "[[sky.hours]] has no elevation");
  expectRefusal("[[sky.hours]]\nelevation = 5\n[[sky.hours]]\nelevation = 5\n", "do not rise");
  expectRefusal("[[sky.hours]]\nelevation = 5\nzenit = [1, 0, 0]\n", "unknown key 'zenit' in [[sky.hours]]");
}

TEST(SceneFile, SnowLiesAwayFromTheSun) {
  const auto side = [](const std::string& text) {
    return scene("[camera]\nposition = [0, 1, 9]\ntarget = [0, 1, 0]\n" + text).terrain->ground.snow_side;
  };
  expectNear(side("[sun]\nazimuth = 90\n[terrain]\n"), {-1, 0, 0}, 1e-5);
  expectNear(side("[sun]\nazimuth = 0\n[terrain]\n"), {0, 0, -1}, 1e-5);
  expectNear(side("[sun]\nazimuth = 0\n[terrain]\n[terrain.ground]\nsnow_side = 90\n"), {1, 0, 0}, 1e-5);
  expectNear(side("[sun]\nelevation = 90\n[terrain]\n"), {1, 0, 0}, 1e-5);
}

// The chain as published brings its own view and light, so that old pictures stay as they were.
TEST(SceneFile, AsPublishedIsTheLookOfBefore) {
  const SceneFile s = withCloud("[chain]\nas_published = true\n"), painted = withCloud("[chain]\nas_published = false\n");
  const PostSettings defaults;
  ASSERT_TRUE(s.post.published);
  EXPECT_EQ(s.post.published->divisor, 4);
  EXPECT_EQ(s.post.composite.phase.share, 0);
  EXPECT_EQ(s.view.sun_azimuth_degrees, kPlainView.sun_azimuth);
  EXPECT_EQ(s.view.sun_elevation_degrees, kPlainView.sun_elevation);
  EXPECT_EQ(s.view.camera_elevation_degrees, kPlainView.camera_elevation);
  const LightSettings plain = lightForSun(kPlainView.sun_azimuth, kPlainView.sun_elevation);
  EXPECT_EQ(s.light.sky.colors.ambient_sky, plain.sky.colors.ambient_sky);
  EXPECT_EQ(s.light.half_lambert, plain.half_lambert);
  EXPECT_FALSE(painted.post.published);
  EXPECT_EQ(painted.post.composite.phase.share, defaults.composite.phase.share);
  EXPECT_EQ(painted.view.camera_elevation_degrees, kPaintedView.camera_elevation);
  for (const char* key : {"draw_divisor = 2", "near_sigma = 3", "mean = 'all'", "blur_as_quoted = true", "depth_blur_radius = 1"})
    expectRefusal("[[cloud]]\nfile = 'a.glb'\n[chain]\n" + std::string(key) + "\n", "add as_published = true");
}

TEST(SceneFile, PaintedChain) {
  const SceneFile s = withCloud(R"(
    [light]
    phase = 0.25
    phase_asymmetry = 0.5
    phase_limit = 3
    [chain]
    depth_spread = 0.125
    near_width = 0.25
    far_width = 0.5
    detail_size = 2
    detail_shrink = 0.375
    detail_darkening = 0.75
    seed = 7)");
  EXPECT_EQ(s.post.composite.phase.share, 0.25F);
  EXPECT_EQ(s.post.composite.phase.asymmetry, 0.5F);
  EXPECT_EQ(s.post.composite.phase.limit, 3);
  EXPECT_EQ(s.post.painted.depth_spread, 0.125F);
  EXPECT_EQ(s.post.painted.soften.near_width, 0.25F);
  EXPECT_EQ(s.post.painted.soften.far_width, 0.5F);
  EXPECT_EQ(s.post.painted.detail_size, 2);
  EXPECT_EQ(s.post.painted.erode.shrink, 0.375F);
  EXPECT_EQ(s.post.painted.erode.darkening, 0.75F);
  EXPECT_EQ(s.post.painted.erode.seed, 7U);
  EXPECT_EQ(s.post.distort.seed, 7U);
}

// What the scene does not say about ambient light and ground follows from the sky that it gives.
TEST(SceneFile, AmbientLightIsThatOfTheSky) {
  const SceneFile s = withCloud("[sky.colors]\nzenith = [1, 0, 0]\nhorizon = [1, 0.5, 0]\nground = [0, 0, 1]\n");
  const SkyColors lit = withAmbientOfSky(s.light.sky.colors, s.light.sky.to_sun.y);
  EXPECT_EQ(s.light.sky.colors.ambient_sky, lit.ambient_sky);
  EXPECT_EQ(s.light.sky.colors.ambient_ground, lit.ambient_ground);
  EXPECT_EQ(s.light.sky.colors.ground, (Vec3{0, 0, 1}));
  EXPECT_GT(lit.ambient_sky.x, 2 * lit.ambient_sky.z);
  EXPECT_EQ(s.light.sky.colors.low_sky, (Vec3{1, 0.5F, 0})) << "a sky with a horizon of its own begins there";
  EXPECT_EQ(withCloud("[sky.colors]\nhorizon = [1, 0, 0]\nlow_sky = [0, 1, 0]\n").light.sky.colors.low_sky, (Vec3{0, 1, 0}));
  const SkyColors ground = withCloud("[sky.colors]\nground = [0, 0, 1]\n").light.sky.colors, own = withCloud("").light.sky.colors;
  EXPECT_EQ(ground.ambient_sky, own.ambient_sky) << "the default sky has ambient light of its own";
  EXPECT_EQ(ground.low_sky, own.low_sky);
  const SceneFile old = withCloud("[chain]\nas_published = true\n[sky.colors]\nzenith = [1, 0, 0]\n");
  EXPECT_EQ(old.light.sky.colors.ambient_sky, skyColorsForSun(0.5F).ambient_sky);
}

TEST(SceneFile, ChainFogAndGrade) {
  const SceneFile s = withCloud(R"(
    [chain]
    as_published = true
    draw_divisor = 3
    samples_per_side = 5
    divisor = 6
    near_sigma = 7
    far_sigma = 0.5
    blur_as_quoted = true
    depth_blur_radius = 2
    tile_size = 0.25
    far_tiles = 8
    swirl_strength = 0.125
    far_strength = 0.75
    swirl_speed = 0.5
    seed = 11
    mean = "all"
    [fog]
    density = 0.375
    per_unit = 0.0625
    color = [1, 2, 3]
    [grade]
    gamma = "sqrt"
    motion_blur = true
    vignette = 0.25
    contrast = 0.75
    lift = [0.125, 0, 0.5])");
  EXPECT_EQ(s.post.published->channels.divisor, 3);
  EXPECT_EQ(s.post.published->channels.samples_per_side, 5);
  EXPECT_EQ(s.post.published->divisor, 6);
  EXPECT_EQ(s.post.published->blur.near_sigma, 7);
  EXPECT_EQ(s.post.published->blur.far_sigma, 0.5F);
  EXPECT_TRUE(s.post.published->blur.as_quoted);
  EXPECT_EQ(s.post.published->depth_blur.radius, 2);
  EXPECT_EQ(s.post.distort.tile_size, 0.25F);
  EXPECT_EQ(s.post.distort.far_tiles, 8);
  EXPECT_EQ(s.post.distort.swirl_strength, 0.125F);
  EXPECT_EQ(s.post.distort.far_strength, 0.75F);
  EXPECT_EQ(s.post.distort.swirl_speed, 0.5F);
  EXPECT_EQ(s.post.distort.seed, 11U);
  for (const ChannelMean mean : {s.post.published->downsample_mean, s.post.published->blur.mean, s.post.published->depth_blur.mean,
                                 s.post.distort.mean, s.post.composite.mean})
    EXPECT_EQ(mean, ChannelMean::kAll);
  EXPECT_EQ(s.post.composite.fog_density, 0.375F);
  EXPECT_EQ(s.fog.density, 0.0625F);
  EXPECT_EQ(s.fog.color, (Vec3{1, 2, 3}));
  EXPECT_TRUE(s.grade.sqrt_gamma && s.grade.motion_blur);
  ASSERT_TRUE(s.grade.vignette && s.grade.contrast);
  EXPECT_EQ(s.grade.vignette->corner, 0.25F);
  EXPECT_EQ(s.grade.contrast->amount, 0.75F);
  EXPECT_EQ(s.grade.contrast->lift, (Vec3{0.125F, 0, 0.5F}));
  EXPECT_TRUE(withCloud("[grade]\nlift = [0, 0, 0]\n").grade.contrast) << "a lift alone is contrast too";
}

TEST(SceneFile, TerrainSlabsAndMarchedClouds) {
  const SceneFile s = scene(R"(
    [picture]
    time = 4
    [camera]
    position = [0, 1, 9]
    target = [0, 1, 0]
    [terrain]
    scale = 2
    origin = [1, 2, 3]
    seed = 5
    own_sky = true
    sun_scatter = false
    [terrain.ground]
    snow_low = 10
    snow_high = 20
    grass = [1, 2, 3]
    [[slab]]
    bottom = 1
    center = 2
    top = 4
    samples = 9
    [[slab]]
    [[marched]]
    field = "density"
    wind = [1, 0, -2]
    noise_strength = 3
    [[marched]]
    scale = 7
    farthest = 50
    tint = 0.5)");
  ASSERT_TRUE(s.terrain);
  EXPECT_EQ(s.terrain->scale, 2);
  EXPECT_EQ(s.terrain->origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(s.terrain->seed, 5U);
  EXPECT_TRUE(s.terrain_sky);
  EXPECT_TRUE(s.terrain->use_own_fog) << "as its own sky";
  EXPECT_FALSE(s.terrain->use_sun_scatter);
  EXPECT_EQ(s.terrain->ground.snow_low, 10);
  EXPECT_EQ(s.terrain->ground.snow_high, 20);
  EXPECT_EQ(s.terrain->ground.grass, (Vec3{1, 2, 3}));
  ASSERT_EQ(s.slabs.size(), 2U);
  EXPECT_EQ(s.slabs[0].bottom, 1);
  EXPECT_EQ(s.slabs[0].samples, 9);
  EXPECT_EQ(s.slabs[1].samples, SlabSettings{}.samples);
  EXPECT_EQ(s.slabs[0].time_seconds, 4);
  ASSERT_EQ(s.density_clouds.size(), 1U);
  EXPECT_EQ(s.density_clouds[0].noise_strength, 3);
  EXPECT_EQ(s.density_clouds[0].wind, (Vec3{1, 0, -2}));
  EXPECT_EQ(s.density_clouds[0].time_seconds, 4);
  expectNear(s.density_clouds[0].tint, {1, 1, 1}, 1e-5);
  ASSERT_EQ(s.distance_clouds.size(), 1U);
  EXPECT_EQ(s.distance_clouds[0].scale, 7);
  EXPECT_EQ(s.distance_clouds[0].farthest, 50);
  EXPECT_EQ(s.distance_clouds[0].tint, (Vec3{0.5F, 0.5F, 0.5F}));
  EXPECT_FALSE(scene("[terrain]\n[camera]\npath = 'terrain'\n").terrain->use_own_fog);
}

// A sun of another colour than day's colours the terrain and the marched clouds.
TEST(SceneFile, TheHourTintsTheBackdrops) {
  const SkyColors day = withCloud("").light.sky.colors;
  const auto at = [&](Vec3 sun) {
    const auto text = [](float x) { return shortestText(x); };
    return scene("[sky.colors]\nsun = [" + text(sun.x) + ", " + text(sun.y) + ", " + text(sun.z) +
                 "]\n[camera]\nposition = [0, 1, 9]\ntarget = [0, 1, 0]\n[terrain]\n[[marched]]\n");
  };
  const SceneFile plain = at(day.sun_color), half = at(0.5F * day.sun_color);
  expectNear(plain.terrain->light.sun, TerrainSettings{}.light.sun, 1e-5);
  expectNear(half.terrain->light.sun, 0.5F * TerrainSettings{}.light.sun, 1e-5);
  expectNear(half.terrain->light.sky, plain.terrain->light.sky, 1e-5);
  EXPECT_LT(half.distance_clouds[0].tint.x, plain.distance_clouds[0].tint.x);
  EXPECT_GT(half.distance_clouds[0].tint.x, 0.5F * plain.distance_clouds[0].tint.x) << "the ambient light stays";
}

TEST(SceneFile, MarchedDensityNumbers) {
  const SceneFile s = scene(R"(
    [camera]
    position = [0, 1, 9]
    target = [0, 1, 0]
    [[marched]]
    field = "density"
    noise_strength = 2
    noise_contrast = 3
    glow_strength = 4
    fade_density = 5)");
  ASSERT_EQ(s.density_clouds.size(), 1U);
  EXPECT_EQ(s.density_clouds[0].noise_strength, 2);
  EXPECT_EQ(s.density_clouds[0].noise_contrast, 3);
  EXPECT_EQ(s.density_clouds[0].glow_strength, 4);
  EXPECT_EQ(s.density_clouds[0].fade_density, 5);
}

TEST(SceneFile, MarchedNumbersOfEitherSign) {
  const std::string start = "[camera]\nposition = [0, 1, 9]\ntarget = [0, 1, 0]\n[[marched]]\n";
  const SceneFile least = scene(start + "shadow_tuning = -100\nnoise_offset = -100\n");
  EXPECT_EQ(least.distance_clouds[0].shadow_tuning, -100);
  EXPECT_EQ(least.distance_clouds[0].noise_offset, -100);
  for (const std::string key : {"shadow_tuning", "noise_offset"})
    for (const std::string value : {"-101", "101"}) expectRefusal(start + key + " = " + value + "\n", key);
}

TEST(SceneFile, HeightsOutOfOrder) {
  expectRefusal("[[slab]]\ntop = 4.5\n", "out of order");
  expectRefusal("[[slab]]\nbottom = 4.9\n", "out of order");
  expectRefusal("[terrain.ground]\nsnow_low = 90\n", "snow_low is not below snow_high");
  expectRefusal("[terrain.ground]\nsnow_high = 55\n", "snow_low is not below snow_high");
}

// --- For a bake ---

TEST(SceneNeedsFile, CameraPictureAndSun) {
  const SceneNeeds found = needs("[camera]\ndistance = 12\nfov = 40\n[picture]\nheight = 99\n[sun]\nazimuth = [60, 120]\nelevation = 20\n");
  EXPECT_EQ(found.camera_distance, 12);
  EXPECT_EQ(found.view.field_of_view_degrees, 40);
  EXPECT_EQ(found.view.height, 99);
  ASSERT_TRUE(found.sun_arc);
  EXPECT_EQ(found.sun_arc->azimuth_low_degrees, 60);
  EXPECT_EQ(found.sun_arc->azimuth_high_degrees, 120);
  EXPECT_EQ(found.sun_arc->elevation_low_degrees, 20);
  EXPECT_EQ(found.sun_arc->elevation_high_degrees, 20);
}

TEST(SceneNeedsFile, AnEmptySceneNeedsNothing) {
  const SceneNeeds found = needs("");
  EXPECT_FALSE(found.sun_arc || found.camera_distance);
}

TEST(SceneNeedsFile, TheDistanceOfACameraByPlace) {
  EXPECT_EQ(needs("[camera]\nposition = [3, 4, 7]\ntarget = [0, 0, 7]\n").camera_distance, 5);
}

// --- Lamps ---

TEST(SceneFile, Lamps) {
  const SceneFile s = withCloud(
      "[[lamp]]\nplace = [1, 2, 3]\ncolor = [1, 0.5, 0.25]\nstrength = 4\nrange = 9\n[[lamp]]\nlook_at = [0, -2, 0]\ninner_angle = 0\n"
      "outer_angle = 60\n[[lightning]]\nplace = [5, 6, 7]\nat = 100\n[[lightning]]\nat = 0\nstrength = 2\ncolor = [1, 1, 1]\n");
  ASSERT_EQ(s.lamps.size(), 2U);
  ASSERT_EQ(s.lightning.size(), 2U);
  ASSERT_EQ(s.light.lamps.size(), 3U) << "the flash of 100 s is not there at 0 s";
  const Lamp &point = s.light.lamps[0], &spot = s.light.lamps[1], &flash = s.light.lamps[2];
  EXPECT_EQ(point.place, (Vec3{1, 2, 3}));
  EXPECT_EQ(point.color, (Vec3{4, 2, 1}));
  EXPECT_EQ(point.range, 9);
  EXPECT_LE(point.cone.y, -1);
  EXPECT_EQ(spot.axis, (Vec3{0, -1, 0}));
  EXPECT_FLOAT_EQ(spot.cone.x, 1);
  EXPECT_NEAR(spot.cone.y, 0.5F, 1e-6F);
  EXPECT_EQ(flash.color, (Vec3{2, 2, 2}));
  EXPECT_TRUE(withCloud("").light.lamps.empty());
  EXPECT_EQ(withCloud("[picture]\ntime = 100.01\n[[lightning]]\nat = 100\n").light.lamps.size(), 1U);
}

TEST(SceneFile, RefusesLampsThatCannotBe) {
  expectRefusal("[[lamp]]\nouter_angle = 20\n", "does not say where it shines to");
  expectRefusal("[[lamp]]\nlook_at = [1, 0, 0]\ninner_angle = 40\n", "inner_angle is not below outer_angle");
  expectRefusal("[[lamp]]\nlook_at = [0, 0, 0]\n", "the same point");
  expectRefusal("[[lamp]]\nbrightness = 2\n", "brightness");
  expectRefusal("[[lamp]]\nradius = 0\n", "radius");
  expectRefusal("[[lightning]]\nat = 2\nevery = 8\n", "a single flash (at) and many (every)");
  std::string many;
  for (int i = 0; i < 17; ++i) many += "[[lamp]]\n";
  expectRefusal(many, "there are more than 16 [[lamp]] and [[lightning]]");
}

// Clouds are read but not opened, and a key that no scene has is refused here too.
TEST(SceneNeedsFile, TheRestOfTheScene) {
  EXPECT_NO_THROW(needs("[terrain]\n[[cloud]]\nfile = 'there/is/none.glb'\n"));
  expectError<InputError>([] { needs("[camera]\nfoc = 3\n"); }, "foc");
  EXPECT_FALSE(refusalOf<IoError>([&] { readSceneNeeds("/no/such/scene.toml"); }).empty());
}

TEST(SceneNeedsFile, TheVolumeOfAFit) {
  const VolumeChoices none = needs("").volume;
  EXPECT_FALSE(none.octaves || none.view_extinction || none.asymmetry);
  const VolumeLight all =
      needs("[volume]\nview_extinction = 2\nphase = -0.25\noctaves = 6\noctave_extinction = 0.75\noctave_contribution = 0.125\n")
          .volume.over({});
  EXPECT_EQ(all.view_extinction, 2);
  EXPECT_EQ(all.asymmetry, -0.25F);
  EXPECT_EQ(all.octaves.count, 6);
  EXPECT_EQ(all.octaves.extinction, 0.75F);
  EXPECT_EQ(all.octaves.contribution, 0.125F);
  EXPECT_EQ(needs("[volume]\noctaves = 2\n").volume.octaves->extinction, 0.5F);
  expectError<InputError>([] { needs("[volume]\noctaves = 16\n"); }, "15");
  expectError<InputError>([] { needs("[volume]\nphase = 1\n"); }, "phase");
  expectError<InputError>([] { needs("[volume]\nsteps = 1\n"); }, "steps");
}

}  // namespace
}  // namespace cloudbake
