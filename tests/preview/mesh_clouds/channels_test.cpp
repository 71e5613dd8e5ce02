// Channels of bodies whose surface, depth and lobes are known in closed form.
#include "preview/mesh_clouds/channels.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cstring>

#include "core/lobe_lighting.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

Camera cameraAt(float distance, int width, int height) { return {{0, 0, distance}, {0, 0, 0}, 30, width, height}; }

Affine moved(double x, double y, double z, double scale = 1) {
  Affine m;
  for (size_t i = 0; i < 3; ++i) m.linear[i][i] = scale;
  m.offset = {x, y, z};
  return m;
}

Image4 draw(const std::vector<Instance>& instances, const Camera& camera, const LightSettings& light, const ChannelSettings& settings) {
  return renderChannels(instances, camera, light, settings);
}

// Where a ray enters a ball; nothing where it passes by.
std::optional<double> entryOf(const Ray& ray, Vec3 center, double radius) {
  const Vec3 origin = ray.origin - center;
  const double middle = -dot(origin, ray.direction), miss = double(dot(origin, origin)) - middle * middle;
  if (miss >= radius * radius) return std::nullopt;
  return middle - std::sqrt(radius * radius - miss);
}

TEST(Channels, BoxOfTheClouds) {
  const auto sides = [](const PixelBox& box) { return std::array{box.left, box.top, box.right, box.bottom}; };
  Image4 image = filledImage4(40, 30, kNoCloud);
  EXPECT_EQ(sides(cloudBox(image, 3)), (std::array{0, 0, 0, 0}));
  image.at(7, 12)[2] = 0.1F;
  EXPECT_EQ(sides(cloudBox(image, 0)), (std::array{7, 12, 8, 13}));
  image.at(20, 9)[3] = 0.5F;  // a depth alone is something too
  image.at(15, 20)[2] = 1;
  EXPECT_EQ(sides(cloudBox(image, 0)), (std::array{7, 9, 21, 21}));
  EXPECT_EQ(sides(cloudBox(image, 1.5F)), (std::array{5, 7, 23, 23}));
  EXPECT_EQ(sides(cloudBox(image, 15)), (std::array{0, 0, 36, 30}));
  EXPECT_EQ(sides(cloudBox(image, INFINITY)), (std::array{0, 0, 40, 30}));
  image.at(0, 0)[2] = image.at(39, 29)[2] = 1;
  EXPECT_EQ(sides(cloudBox(image, 0)), (std::array{0, 0, 40, 30}));
}

TEST(Channels, BallHasItsLobesDepthAndCoverage) {
  const BakedMesh ball = bakedBall(1);
  const Camera camera = cameraAt(5, 121, 81);
  LightSettings light = lightForSun(70, 20);
  light.half_lambert = 0.4F;
  const Image4 image = draw({{&ball, {}}}, camera, light, {.divisor = 1, .samples_per_side = 1, .depth_range = DepthRange{4, 6}});
  ASSERT_EQ(image.width, 121);
  ASSERT_EQ(image.height, 81);

  int inside = 0, outside = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const Rgba& pixel = image.at(x, y);
      if (!entryOf(ray, {}, 1.002)) {
        EXPECT_EQ(pixel, kNoCloud);
        ++outside;
      }
      const auto t = entryOf(ray, {}, 0.99);  // clear of the icosphere's rim
      if (!t) continue;
      const Vec3 point = ray.origin + ray.direction * float(*entryOf(ray, {}, 1));
      const Vec3 to_sun = light.sky.to_sun;
      const auto thickness = [&](Vec3 l) { return std::pow(0.5 - dot(point, l) / 2.0, 3) * 2 - 0.006; };
      const double half_lambert = 0.4 + 0.6 * (dot(point, to_sun) / 2 + 0.5);
      EXPECT_NEAR(pixel[0], std::exp(-3.5 * std::max(0.0, thickness(to_sun))) * half_lambert, 0.01);
      EXPECT_NEAR(pixel[1], std::exp(-3.5 * std::max(0.0, thickness({0, 1, 0}))), 0.01);
      EXPECT_EQ(pixel[2], 1);
      EXPECT_NEAR(pixel[3], (5 - point.z - 4) / 2, 0.003);
      ++inside;
    }
  EXPECT_GT(inside, 1500);
  EXPECT_GT(outside, 3000);
}

// B adds up to the disc's area; R and A at the rim are those of the cloud, not mixed with the empty pixels'.
TEST(Channels, RimsCountWhatIsCoveredOnly) {
  BakedMesh ball = bakedBall(1);
  for (Lobe& lobe : ball.lobes) lobe = {{0, -1, 0}, 0};  // R = G = 1 everywhere
  ball.info.shape.bias = 0;
  const Camera camera = cameraAt(10, 64, 64);
  LightSettings light = lightForSun(0, 30);
  light.half_lambert = 1;
  const Image4 image = draw({{&ball, {}}}, camera, light, {.divisor = 1, .samples_per_side = 6});
  double area = 0;
  int partly = 0;
  for (const Rgba& pixel : image.pixels) {
    area += pixel[2];
    if (pixel[2] == 0) continue;
    EXPECT_NEAR(pixel[0], 1, 1e-5);
    EXPECT_NEAR(pixel[1], 1, 1e-5);
    EXPECT_LT(pixel[3], 0.52F);  // the outline lies at 9.9 of 9 … 11
    partly += pixel[2] < 1;
  }
  const double tangent = 1 / std::sqrt(99.0), radius = tangent / std::tan(15 * kPi / 180) * 32;
  EXPECT_NEAR(area / (kPi * radius * radius), 1, 0.005);
  EXPECT_GT(partly, 40);
}

TEST(Channels, HalfResolutionSeesTheSamePicture) {
  const BakedMesh ball = bakedBall(1, {0.4F, -0.2F, 0});
  const LightSettings light = lightForSun(60, 30);
  for (const auto& [width, height] : {std::pair{96, 64}, {97, 63}}) {
    const Camera camera = cameraAt(6, width, height);
    const Image4 whole = draw({{&ball, {}}}, camera, light, {.divisor = 1, .samples_per_side = 4});
    const Image4 half = draw({{&ball, {}}}, camera, light, {.samples_per_side = 8});
    ASSERT_EQ(half.width, (width + 1) / 2);
    ASSERT_EQ(half.height, (height + 1) / 2);
    // Where the ball lies in the picture, in shares of it.
    const auto centroid = [](const Image4& image) {
      double x = 0, y = 0, total = 0;
      for (int j = 0; j < image.height; ++j)
        for (int i = 0; i < image.width; ++i) {
          const double b = image.at(i, j)[2];
          x += b * (i + 0.5) / image.width;
          y += b * (j + 0.5) / image.height;
          total += b;
        }
      return std::array<double, 3>{x / total, y / total, total / (image.width * image.height)};
    };
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(centroid(whole)[i], centroid(half)[i], 0.001);
  }
}

// From the camera to ten times the clouds' size, wherever the clouds are; beyond, it goes on.
TEST(Channels, DepthIsThatOfTheSceneUnlessGiven) {
  const BakedMesh ball = bakedBall(1);
  const std::vector<Instance> two{{&ball, {}}, {&ball, moved(0, 0, -20, 2)}};  // 2 and 4 wide
  EXPECT_EQ(defaultDepthRange(two).near, 0);
  EXPECT_FLOAT_EQ(defaultDepthRange(two).far, 30);
  Affine stretched;
  stretched.linear[0][0] = 0.5, stretched.linear[1][1] = 2;
  const Instance turned{&ball, stretched};
  EXPECT_FLOAT_EQ(defaultDepthRange(std::span(&turned, 1)).far, 40) << "the longest side in the world";
  EXPECT_FLOAT_EQ(defaultDepthRange({}).far, 10);
  const ChannelSettings one_ray{.divisor = 1, .samples_per_side = 1};
  for (const float distance : {2.5F, 10.0F, 25.0F, 60.0F}) {
    const float expected = (distance - 1) / 20;
    EXPECT_NEAR(draw({{&ball, {}}}, cameraAt(distance, 40, 40), lightForSun(0, 30), one_ray).at(20, 20)[3], expected, 0.01F * expected);
  }
  EXPECT_NEAR(
      draw({{&ball, {}}}, cameraAt(10, 40, 40), lightForSun(0, 30), {.divisor = 1, .samples_per_side = 1, .depth_range = DepthRange{8, 12}})
          .at(20, 20)[3],
      0.25, 1e-3);
  EXPECT_EQ(draw({{&ball, {}}}, cameraAt(10, 40, 40), lightForSun(0, 30),
                 {.divisor = 1, .samples_per_side = 1, .depth_range = DepthRange{10, 12}})
                .at(20, 20)[3],
            0)
      << "nothing is nearer than near";
  EXPECT_EQ(draw({}, cameraAt(10, 40, 40), lightForSun(0, 30), one_ray).at(20, 20), kNoCloud);
}

TEST(Channels, NearerInstancesHideFartherOnes) {
  const BakedMesh ball = bakedBall(1);
  const Camera camera = cameraAt(10, 41, 41);
  const LightSettings light = lightForSun(90, 10);
  const ChannelSettings settings{.divisor = 1, .samples_per_side = 2, .depth_range = DepthRange{5, 20}};
  const Image4 alone = draw({{&ball, {}}}, camera, light, settings);
  const Image4 behind = draw({{&ball, moved(0, 0, -5, 1)}, {&ball, {}}}, camera, light, settings);
  EXPECT_NEAR(alone.at(20, 20)[0], behind.at(20, 20)[0], 1e-4);
  EXPECT_NEAR(alone.at(20, 20)[3], behind.at(20, 20)[3], 1e-4);
  const Image4 before = draw({{&ball, moved(0, 0, 4, 1)}, {&ball, {}}}, camera, light, settings);
  EXPECT_LT(before.at(20, 20)[3], alone.at(20, 20)[3] - 0.2F);
}

TEST(Channels, SameBytesForAnyNumberOfThreads) {
  const BakedMesh ball = bakedBall(1, {}, 3);
  const auto render = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return draw({{&ball, {}}, {&ball, moved(1, 1, -3, 1.5)}}, cameraAt(7, 80, 60), lightForSun(70, 20), {});
  };
  const Image4 one = render(1);
  for (const size_t threads : {2U, 7U})
    EXPECT_EQ(std::memcmp(one.pixels.data(), render(threads).pixels.data(), one.pixels.size() * sizeof(Rgba)), 0);
}

TEST(Channels, PictureOfAChannelShowsIt) {
  Image4 image = filledImage4(2, 1, {0.1F, 0.2F, 0.3F, 0.4F});
  for (int channel = 0; channel < 4; ++channel)
    EXPECT_EQ(channelPicture(image, channel).at(1, 0), (Vec3{1, 1, 1} * image.at(1, 0)[size_t(channel)]));
}

}  // namespace
}  // namespace cloudbake
