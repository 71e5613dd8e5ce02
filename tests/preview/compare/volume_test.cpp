// The volume's truth against closed forms of a ball, against its own plain lengths, and against the sweep.
#include "preview/compare/volume.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <stdexcept>

#include "bake/field/coverage.h"
#include "bake/field/level_set.h"
#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "preview/compare/image_error.h"
#include "preview/shading_math.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

// The inside fractions of a ball in the middle of a lattice whose cells are 1/`cells` of its radius, by 6³ points in every cell of its
// skin.
CoverageField ballField(int cells, double radius = 1, Vec3 center = {}) {
  const int n = 2 * cells + 6, half = n / 2;
  CoverageField field{{{center.x, center.y, center.z}, radius / cells}, {-half, -half, -half}, {n, n, n}, {}};
  for (int k = -half; k < half; ++k)
    for (int j = -half; j < half; ++j)
      for (int i = -half; i < half; ++i) {
        const Vec3 middle{float(i), float(j), float(k)};
        const float beyond = length(middle) - float(cells);
        int count = beyond < 0 ? 216 : 0;
        for (int s = 0; s < 216 && std::abs(beyond) < 1; ++s) {
          const Vec3 place{float(s % 6) - 2.5F, float(s / 6 % 6) - 2.5F, float(s / 36) - 2.5F};
          const int inside = length(middle + place / 6) < float(cells);
          count = s == 0 ? inside : count + inside;
        }
        field.fractions.push_back(float(count) / 216);
      }
  return field;
}

// ℓ of a ball of radius 1 at the origin, from anywhere.
double ballLength(Vec3 from, Vec3 direction) {
  const double along = dot(from, direction), square = along * along - dot(from, from) + 1;
  return square > 0 ? std::max(0.0, std::sqrt(square) - along) - std::max(0.0, -std::sqrt(square) - along) : 0;
}

std::vector<float> ballLengths(const CoverageField& field, Vec3 direction) {
  std::vector<float> lengths;
  for (const Vec3& p : cellCenters(field)) lengths.push_back(float(ballLength(p, direction)));
  return lengths;
}

// A white sun in black air: a pixel is the integral of R along the ray.
LightSettings sunOnly(Vec3 to_sun) {
  LightSettings light;
  light.sky.to_sun = to_sun;
  light.sky.colors = {{}, {}, {}, {1, 1, 1}, {}, {}, {}};
  light.sky.disc.gain = light.sky.glow = 0;
  light.samples_per_side = 1;
  return light;
}

VolumeSettings withExtinction(float extinction) {
  VolumeSettings settings;
  settings.extinction = extinction;
  return settings;
}

// What a camera on +Z sees through the centre of the ball, with exact lengths.
struct Center {
  explicit Center(int cells = 25) : ball(ballField(cells)) {}
  CoverageField ball;
  std::vector<float> to_sky = ballLengths(ball, {0, 1, 0});

  Vec3 color(const LightSettings& light, const VolumeSettings& settings) const {
    const std::vector<float> to_sun = ballLengths(ball, light.sky.to_sun);
    return renderVolume({&ball, to_sun, to_sky}, Camera{{0, 0, 5}, {}, 1, 1, 1}, light, settings).at(0, 0);
  }
  float sun(Vec3 to_sun, const VolumeSettings& settings) const { return color(sunOnly(to_sun), settings).x; }
};

// Light across: half the chord through the ball at the depth t is √(1 − (1 − t)²).
double litAcross(double sigma) {
  double sum = 0;
  for (int i = 0; i < 10000; ++i) {
    const double t = (i + 0.5) / 5000;
    sum += sigma / 5000 * std::exp(-sigma * (t + std::sqrt(1 - (1 - t) * (1 - t))));
  }
  return sum;
}

TEST(Volume, HomogeneousBallHasItsClosedForm) {
  const Center center(50);
  for (const double sigma : {0.5, 2.0, 3.5}) {
    const VolumeSettings settings = withExtinction(float(sigma));
    // Light from the viewer, from behind, and across.
    EXPECT_NEAR(center.sun({0, 0, 1}, settings) / (0.5 * (1 - std::exp(-4 * sigma))), 1, 0.01) << sigma;
    EXPECT_NEAR(center.sun({0, 0, -1}, settings) / (2 * sigma * std::exp(-2 * sigma)), 1, 0.01) << sigma;
    EXPECT_NEAR(center.sun({1, 0, 0}, settings), litAcross(sigma), 0.01) << sigma;
    EXPECT_NEAR(center.sun({0, 1, 0}, settings), litAcross(sigma), 0.01) << sigma;
  }
}

// Grazing light finds the skin of half filled cells: what is wrong there goes with the cells.
TEST(Volume, GrazingLightConvergesWithTheCells) {
  const auto error = [](int cells) { return std::abs(Center(cells).sun({1, 0, 0}, withExtinction(3.5F)) / litAcross(3.5) - 1); };
  const double coarse = error(12), fine = error(24), finest = error(48);
  EXPECT_LT(fine, 0.55 * coarse);
  EXPECT_LT(finest, 0.55 * fine);
}

TEST(Volume, ViewHasAnExtinctionOfItsOwn) {
  VolumeSettings settings = withExtinction(0.7F);
  settings.light.view_extinction = 3;
  EXPECT_NEAR(Center().sun({0, 0, 1}, settings) / (0.75 * (1 - std::exp(-5.6))), 1, 0.01);
}

// Light that meets no cloud on its way: the cloud has one colour, and the sky is seen through it.
TEST(Volume, LiesOverTheSkyInTheColoursOfSunAndSky) {
  LightSettings light = sunOnly({0, 0, 1});
  light.sky.colors = {
      {0.1F, 0.2F, 0.3F}, {0.2F, 0.3F, 0.4F}, {0.4F, 0.5F, 0.6F}, {1, 0.8F, 0.6F}, {0.1F, 0.2F, 0.4F}, {0.03F, 0.02F, 0.01F}, {}};
  VolumeSettings settings = withExtinction(1e-5F);
  settings.light.view_extinction = 0.5e5F;
  const Center center;
  const Vec3 sky = skyColor({0, 0, -1}, light.sky), lit = Vec3{1.1F, 1, 1};
  EXPECT_NEAR(length(center.color(light, settings) - (lit * (1 - std::exp(-1.0F)) + sky * std::exp(-1.0F))), 0, 0.005);
  // In thick cloud the sky's light stops at the surface: G alone, then neither.
  light.sky.colors.sun_color = light.sky.colors.ambient_ground = {};
  light.sky.colors.ambient_sky = {1, 1, 1};
  settings = withExtinction(2);
  EXPECT_NEAR(center.color(light, settings).x, center.sun({0, 1, 0}, settings) + skyColor({0, 0, -1}, light.sky).x * std::exp(-4.0F), 1e-4);
  light.sky.colors.ambient_sky = {};
  light.sky.colors.ambient_ground = {1, 1, 1};
  settings = withExtinction(1000);
  settings.light.view_extinction = 0.5e-3F;
  EXPECT_NEAR(center.color(light, settings).x, 2 * (1 - std::exp(-1.0F)), 0.1);
}

TEST(Volume, BackgroundIsTheSky) {
  const CoverageField ball = ballField(25);
  const std::vector<float> lengths(ball.fractions.size(), 1.0F);
  const Camera camera{{0, 0, 6}, {0, 0.4F, 0}, 35, 60, 45};
  LightSettings light = lightForSun(150, 20);
  light.samples_per_side = 1;
  const Image image = renderVolume({&ball, lengths, lengths}, camera, light, withExtinction(3));
  int outside = 0, around = 0, inside = 0, within = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const float miss = length(cross(ray.origin, ray.direction)), difference = length(image.at(x, y) - skyColor(ray.direction, light.sky));
      around += miss > 1.08F && difference < 1e-4F;
      outside += miss > 1.08F;
      within += miss < 0.96F && difference > 1e-2F;
      inside += miss < 0.96F;
    }
  EXPECT_GT(outside, 1000);
  EXPECT_EQ(around, outside);
  EXPECT_GT(inside, 300);
  EXPECT_EQ(within, inside);
}

TEST(Volume, HalfFilledCellsAbsorbHalf) {
  CoverageField box{GridFrame{}, {-10, -10, -10}, {20, 20, 20}, std::vector<float>(8000, 0.0F)};
  for (int k = 4; k < 16; ++k)
    for (int j = 4; j < 16; ++j)
      for (int i = 4; i < 16; ++i) box.fractions[size_t(k * 400 + j * 20 + i)] = 0.5F;
  const std::vector<float> none(8000, 0.0F);
  const VolumeSettings settings = withExtinction(0.25F);
  const float lit = renderVolume({&box, none, none}, Camera{{0, 0, 50}, {}, 1, 1, 1}, sunOnly({0, 1, 0}), settings).at(0, 0).x;
  EXPECT_NEAR(lit, 1 - std::exp(-0.25 * 0.5 * 12), 1e-4);
  EXPECT_NEAR(plainLengths(box, std::vector<Vec3>{{0, 0, 50}}, {0, 0, -1}).front(), 6, 1e-3);
}

TEST(Volume, PhaseScattersForwardAndKeepsItsMean) {
  for (const float g : {-0.7F, 0.0F, 0.3F, 0.8F}) {
    double mean = 0;
    for (int i = 0; i < 20000; ++i) mean += henyeyGreenstein((float(i) + 0.5F) / 10000 - 1, g) / 20000;
    EXPECT_NEAR(mean, 1, 1e-3) << g;
  }
  EXPECT_EQ(henyeyGreenstein(-0.3F, 0), 1);
  EXPECT_NEAR(henyeyGreenstein(1, 0.5F), 6, 1e-5);  // (1 − g²)/(1 − g)³
  // Towards the sun it is the forward lobe that is seen.
  const Center center;
  VolumeSettings settings = withExtinction(1);
  const float towards = center.sun({0, 0, -1}, settings), away = center.sun({0, 0, 1}, settings);
  settings.light.asymmetry = 0.5F;
  EXPECT_NEAR(center.sun({0, 0, -1}, settings) / towards, 6, 1e-4);
  EXPECT_NEAR(center.sun({0, 0, 1}, settings) / away, 0.75 / 3.375, 1e-4);
}

TEST(Volume, OctavesAddTheirClosedForms) {
  // Σᵢ bⁱ p(cⁱ g) (1 − e^{−(1 + aⁱ) τ})/(1 + aⁱ) / Σᵢ bⁱ with light from the viewer, τ = 2 σ.
  VolumeSettings settings = withExtinction(3);
  settings.light.asymmetry = 0.4F;
  settings.light.octaves = {2, 0.5F, 0.6F, 0.7F};
  double expected = 0;
  for (int i = 0; i < 3; ++i) {
    const double a = 1 + std::pow(0.5, i), g = 0.4 * std::pow(0.7, i);
    expected += std::pow(0.6, i) * (1 - g * g) / std::pow(1 + g, 3) * (1 - std::exp(-6 * a)) / a;
  }
  EXPECT_NEAR(Center().sun({0, 0, 1}, settings) / (expected / (1 + 0.6 + 0.36)), 1, 0.01);
}

// C along a diameter D of the ball that is lit from the eye, (1 − e^{−(σ_v + σ)D}) σ_v/(σ_v + σ) / (1 − e^{−σ_v D}), and from behind,
// σ D e^{−σD} / (1 − e^{−σD}) for σ_v = σ. The sky has the octaves, but not the phase.
TEST(Volume, LightAlongARayHasItsClosedForm) {
  const CoverageField ball = ballField(60);
  const Ray diameter{{0, 0, 1}, {0, 0, -1}};
  const auto along = [&](Vec3 to_sun, const VolumeSettings& settings) {
    const std::vector<float> lengths = ballLengths(ball, to_sun);
    return lightAlong({&ball, lengths, lengths}, {&diameter, 1}, to_sun, settings).front();
  };
  VolumeSettings settings = withExtinction(1.5F);
  settings.light.view_extinction = 2;
  const SeenLight front = along({0, 0, 1}, settings);
  EXPECT_NEAR(front.opacity, 1 - std::exp(-6.0), 2e-3);
  EXPECT_NEAR(front.shade.sun, (1 - std::exp(-9.0)) * 3 / 4.5 / (1 - std::exp(-6.0)), 0.01);
  EXPECT_EQ(front.shade.sky, front.shade.sun);
  settings.light.view_extinction = 1;
  EXPECT_NEAR(along({0, 0, -1}, settings).shade.sun, 3 * std::exp(-3.0) / (1 - std::exp(-3.0)), 0.01);
  const float single = along({0, 0, 1}, settings).shade.sun;
  settings.light.asymmetry = 0.5F;
  EXPECT_NEAR(along({0, 0, 1}, settings).shade.sun / single, 0.75 / 3.375, 1e-4);
  EXPECT_EQ(along({0, 0, 1}, settings).shade.sky, single);
  settings.light.octaves.count = 1;
  EXPECT_GT(along({0, 0, 1}, settings).shade.sky, single * 1.1F);
  // A ray that finds no cloud shows the light at its start.
  const Ray away{{0, 0, 3}, {0, 0, 1}};
  const std::vector<float> none(ball.fractions.size(), 0.0F);
  const SeenLight nothing = lightAlong({&ball, none, none}, {&away, 1}, {0, 0, 1}, withExtinction(1)).front();
  EXPECT_EQ(nothing.opacity, 0);
  EXPECT_EQ(nothing.shade.sun, 1);
}

// Root mean square of a − b as a share of b's own, over the pixels with cloud or those of a mask.
double relativeRms(const Image& a, const Image& b, PixelMask mask = {}) {
  const Image black = blankImage(a.width, a.height);
  if (mask.empty()) mask = cloudMask(a, b, black, 1e-3F);
  return imageRms(a, b, mask) / imageRms(b, black, mask);
}

// Every pixel of the ball by its closed form, integrated along the ray, and which pixels lie clear of its rim.
struct ExactBall {
  Image image;
  PixelMask clear;
};
ExactBall exactBall(const Camera& camera, Vec3 to_sun, double sigma) {
  ExactBall ball{blankImage(camera.width, camera.height), {}};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const double chord = ballLength(ray.origin, ray.direction), middle = -dot(ray.origin, ray.direction);
      double sum = 0;
      for (int i = 0; i < 1000; ++i) {
        const double t = chord * (i + 0.5) / 1000;
        const Vec3 p = ray.origin + ray.direction * float(middle - chord / 2 + t);
        sum += sigma * chord / 1000 * std::exp(-sigma * (t + ballLength(p, to_sun)));
      }
      ball.image.at(x, y) = Vec3{1, 1, 1} * float(sum);
      ball.clear.push_back(chord > 0.8);
    }
  return ball;
}

TEST(Volume, AgreesWithThePlainMarchAndTheClosedForm) {
  const CoverageField ball = ballField(50);
  const std::vector<Vec3> centers = cellCenters(ball);
  const Camera camera{{0, 0, 5}, {}, 30, 48, 48};
  for (const Vec3 to_sun : {directionFromAngles(40, 25), directionFromAngles(160, 10)}) {
    const std::vector<float> plain = plainLengths(ball, centers, to_sun), exact = ballLengths(ball, to_sun);
    const VolumeSettings settings = withExtinction(2);
    const Image by_plain = renderVolume({&ball, plain, plain}, camera, sunOnly(to_sun), settings);
    const Image by_exact = renderVolume({&ball, exact, exact}, camera, sunOnly(to_sun), settings);
    EXPECT_LT(relativeRms(by_plain, by_exact), 0.01);
    const ExactBall truth = exactBall(camera, to_sun, 2);
    EXPECT_LT(relativeRms(by_exact, truth.image, truth.clear), 0.015);
    EXPECT_LT(relativeRms(by_plain, truth.image, truth.clear), 0.015);
  }
}

TEST(Volume, SweptLengthsShowTheSamePicture) {
  const SurfaceMesh shapes[] = {ballMesh(1, 4), torusMesh(1, 0.4F, 64, 32),
                                merged(ballMesh(0.7F, 4, {-0.5F, 0, 0}), ballMesh(0.5F, 4, {0.5F, 0.3F, 0.2F}))};
  for (const SurfaceMesh& shape : shapes) {
    LevelSetSettings lattice;
    lattice.voxels = 60;
    const Box box = boundingBox(shape);
    const CoverageField field = coverageFromMesh(shape, frameFor(box, lattice)).value();
    const std::vector<Vec3> centers = cellCenters(field);
    const std::array<Vec3, 2> lights{directionFromAngles(50, 35), Vec3{0, 1, 0}};

    // Rows of the sweep: ω and −ω of each axis.
    const std::vector<float> swept = sweptLengths(centers, lights, field, box.diagonal());
    const auto row = [&](size_t n) { return std::span(swept).subspan(n * centers.size(), centers.size()); };
    const std::vector<float> to_sun = plainLengths(field, centers, lights[0]), to_sky = plainLengths(field, centers, lights[1]);

    LightSettings light = sunOnly(lights[0]);
    light.sky.colors.ambient_sky = {0.3F, 0.4F, 0.5F};
    const Camera camera = frameCamera(box, 10, 15, 30, 60, 45);
    const VolumeSettings settings = withExtinction(7 / box.longestSide());
    const Image by_sweep = renderVolume({&field, row(0), row(2)}, camera, light, settings);
    EXPECT_LT(relativeRms(by_sweep, renderVolume({&field, to_sun, to_sky}, camera, light, settings)), 0.01);
  }
}

TEST(Volume, PlainLengthsOfABall) {
  const CoverageField ball = ballField(25);
  const Vec3 direction = directionFromAngles(70, -20);
  std::vector<Vec3> points = cellCenters(ball);
  points.push_back({9, 0, 0});
  points.push_back(-direction * 9);
  const std::vector<float> lengths = plainLengths(ball, points, direction);
  double squares = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double error = lengths[i] - ballLength(points[i], direction);
    squares += error * error;
  }
  EXPECT_LT(std::sqrt(squares / double(points.size())), 0.4 / 25);
  EXPECT_EQ(lengths[points.size() - 2], 0);
  // Along an axis: past the ball, and through its middle.
  const std::vector<float> along = plainLengths(ball, std::vector<Vec3>{{0, 3, 0}, {3, 0, 0}, {0, 0, 0}, {0, -5, 0}}, {0, 1, 0});
  EXPECT_EQ(along[0], 0);
  EXPECT_EQ(along[1], 0);
  EXPECT_NEAR(along[2], 1, 0.01);
  EXPECT_NEAR(along[3], 2, 0.01);
  EXPECT_NEAR(lengths.back(), 2, 0.01);
  // The number of steps counts.
  EXPECT_GT(std::abs(plainLengths(ball, std::vector<Vec3>{{0.3F, 0.1F, 0}}, direction, 2).front() - ballLength({0.3F, 0.1F, 0}, direction)),
            0.01);
}

TEST(Volume, CellCentersAreWhereTheFieldSays) {
  const CoverageField field{{{10, 20, 30}, 0.5}, {-1, 0, 2}, {2, 2, 2}, std::vector<float>(8)};
  const std::vector<Vec3> centers = cellCenters(field);
  ASSERT_EQ(centers.size(), 8U);
  EXPECT_EQ(centers.front(), (Vec3{9.5F, 20, 31}));
  EXPECT_EQ(centers[1], (Vec3{10, 20, 31}));
  EXPECT_EQ(centers[2], (Vec3{9.5F, 20.5F, 31}));
  EXPECT_EQ(centers.back(), (Vec3{10, 20.5F, 31.5F}));
}

Image pictureOfBall(float radius, Vec3 center, VolumeSettings settings = {}) {
  const CoverageField ball = ballField(25, double(radius), center);
  const LightSettings light = lightForSun(60, 30);
  const std::vector<Vec3> centers = cellCenters(ball);
  const std::vector<float> to_sun = plainLengths(ball, centers, light.sky.to_sun, 50), to_sky = plainLengths(ball, centers, {0, 1, 0}, 50);
  settings.extinction = 3 / radius;
  Box box;
  box.add(center - Vec3{1, 1, 1} * radius);
  box.add(center + Vec3{1, 1, 1} * radius);
  return renderVolume({&ball, to_sun, to_sky}, frameCamera(box, 30, 10, 35, 24, 20), light, settings);
}

TEST(Volume, SizeAndPlaceDoNotMatter) {
  const Image one = pictureOfBall(1, {});
  for (const float radius : {0x1p-20F, 0x1p+20F}) EXPECT_EQ(pictureOfBall(radius, {}).pixels, one.pixels) << radius;
  for (const float radius : {1e-6F, 1e6F}) EXPECT_LT(imageRms(pictureOfBall(radius, {}), one), 1e-3) << radius;
  EXPECT_LT(imageRms(pictureOfBall(1, {100, -50, 25}), one), 1e-3);
}

TEST(Volume, StepsConvergeAndJitterHidesThem) {
  const auto with = [](int steps, bool jitter) {
    VolumeSettings settings;
    settings.steps = steps;
    settings.jitter = jitter;
    return pictureOfBall(1, {}, settings);
  };
  const Image fine = with(1000, false);
  EXPECT_LT(imageRms(with(200, false), fine), 1e-3);
  EXPECT_GT(imageRms(with(5, false), fine), 1e-2);
  EXPECT_NE(with(200, true).pixels, with(200, false).pixels);
  EXPECT_LT(imageRms(with(200, true), fine), 5e-3);
  EXPECT_EQ(with(20, true).pixels, with(20, true).pixels);
}

TEST(Volume, SameBytesForAnyNumberOfThreads) {
  const auto render = [](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    VolumeSettings settings;
    settings.jitter = true;
    settings.light.octaves.count = 2;
    return pictureOfBall(1, {}, settings);
  };
  const Image one = render(1);
  for (const size_t threads : {2U, 7U}) {
    const Image other = render(threads);
    EXPECT_EQ(std::memcmp(one.pixels.data(), other.pixels.data(), one.pixels.size() * sizeof(Vec3)), 0) << threads;
  }
}

TEST(Volume, AnEmptyFieldIsTheSky) {
  const CoverageField empty{GridFrame{}, {0, 0, 0}, {4, 4, 4}, std::vector<float>(64, 0.0F)};
  const std::vector<float> none(64, 0.0F);
  const Camera camera{{0, 0, 9}, {}, 40, 16, 12};
  const LightSettings light = lightForSun(90, 45);
  EXPECT_EQ(renderVolume({&empty, none, none}, camera, light, {}).pixels, renderSky(camera, light.sky, light.samples_per_side).pixels);
  EXPECT_EQ(plainLengths(empty, std::vector<Vec3>{{1, 1, 1}}, {0, 1, 0}), std::vector<float>{0});
}

TEST(Volume, RefusesWhatDoesNotFit) {
  const CoverageField field{GridFrame{}, {0, 0, 0}, {4, 4, 4}, std::vector<float>(64, 0.0F)};
  const std::vector<float> none(64, 0.0F), few(63, 0.0F);
  const auto render = [&](std::span<const float> to_sun, std::span<const float> to_sky, const VolumeSettings& settings) {
    renderVolume({&field, to_sun, to_sky}, Camera{{0, 0, 9}, {}, 40, 2, 2}, {}, settings);
  };
  EXPECT_NO_THROW(render(none, none, {}));
  EXPECT_THROW(render(few, none, {}), std::invalid_argument);
  EXPECT_THROW(render(none, few, {}), std::invalid_argument);
  VolumeSettings settings;
  settings.steps = 0;
  EXPECT_THROW(render(none, none, settings), std::invalid_argument);
  settings = {};
  for (const float one : {1.0F, -1.0F}) {
    settings.light.asymmetry = one;
    EXPECT_THROW(render(none, none, settings), std::invalid_argument);
  }
  settings = {};
  settings.light.octaves.count = 16;
  EXPECT_THROW(render(none, none, settings), std::invalid_argument);
  EXPECT_THROW(plainLengths(field, std::vector<Vec3>{{}}, {0, 1, 0}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
