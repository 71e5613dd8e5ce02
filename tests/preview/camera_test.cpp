// Angles, framing and pixel coordinates, against what they are defined to be.
#include "preview/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace cloudbake {
namespace {

void expectSameDirection(Vec3 a, Vec3 b) { EXPECT_LE(length(a - b), 1e-6F) << a.x << " " << a.y << " " << a.z; }

TEST(Camera, AnglesFollowTheConvention) {
  EXPECT_EQ(directionFromAngles(0, 0), (Vec3{0, 0, 1}));
  EXPECT_EQ(directionFromAngles(90, 0), (Vec3{1, 0, 0}));
  EXPECT_EQ(directionFromAngles(-90, 0), (Vec3{-1, 0, 0}));
  EXPECT_EQ(directionFromAngles(450, 0), (Vec3{1, 0, 0}));
  EXPECT_EQ(directionFromAngles(123, 90), (Vec3{0, 1, 0}));
  EXPECT_EQ(directionFromAngles(180, 0).z, -1);
  expectSameDirection(directionFromAngles(0, 45), {0, std::sqrt(0.5F), std::sqrt(0.5F)});
  expectSameDirection(directionFromAngles(30, -30), {std::sqrt(3.0F) / 4, -0.5F, 0.75F});
  for (float azimuth = -700; azimuth < 700; azimuth += 37)
    for (float elevation = -90; elevation <= 90; elevation += 11) EXPECT_NEAR(length(directionFromAngles(azimuth, elevation)), 1, 1e-6);
}

TEST(Camera, CentreRayMeetsTheTarget) {
  const Camera camera{{3, 2, 5}, {-1, 0.5F, 0.25F}, 40, 641, 359};
  const Ray ray = cameraRay(camera, 320.5F, 179.5F);
  EXPECT_EQ(ray.origin, camera.look_from);
  expectSameDirection(ray.direction, *normalized(camera.look_at - camera.look_from));
}

TEST(Camera, FieldOfViewIsTheHeightsAngleAndYGrowsDown) {
  const Camera camera{{0, 0, 4}, {}, 60, 300, 200};
  const Vec3 top = cameraRay(camera, 150, 0).direction, bottom = cameraRay(camera, 150, 200).direction;
  EXPECT_NEAR(angleDegrees(top, bottom), 60, 1e-4);
  EXPECT_GT(top.y, 0);
  EXPECT_GT(cameraRay(camera, 300, 100).direction.x, 0);
  // Pixels are square.
  const Vec3 right = cameraRay(camera, 250, 100).direction;
  EXPECT_NEAR(right.x / -right.z, top.y / -top.z, 1e-6);
}

TEST(Camera, LooksStraightUpAndDown) {
  const CameraAxes down = cameraAxes({{0, 5, 0}, {}, 40, 10, 10}), up = cameraAxes({{0, -5, 0}, {}, 40, 10, 10});
  EXPECT_EQ(down.right, (Vec3{1, 0, 0}));
  EXPECT_EQ(down.up, (Vec3{0, 0, -1}));
  EXPECT_EQ(up.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(cameraAxes({{1, 2, 3}, {1, 2, 3}, 40, 10, 10}).forward, (Vec3{0, 0, -1})) << "it looks at its own place";
}

// Where a point lands in the picture: (-1, -1) … (1, 1) is inside. Behind the camera: far outside.
Vec2 project(const Camera& camera, Vec3 point) {
  const CameraAxes axes = cameraAxes(camera);
  const Vec3 v = point - camera.look_from;
  const float depth = dot(v, axes.forward), half = std::tan(camera.vertical_fov_degrees * float(kPi / 360));
  if (depth <= 0) return {1e9F, 1e9F};
  return {dot(v, axes.right) / depth / half * float(camera.height) / float(camera.width), dot(v, axes.up) / depth / half};
}

TEST(Camera, WholeBoxIsInViewAndFillsThePicture) {
  const Box boxes[] = {
      {{-1, -1, -1}, {1, 1, 1}}, {{10, 20, 30}, {14, 20.5F, 31}}, {{-3e5F, 0, 0}, {3e5F, 4e5F, 1}}, {{0, 0, 0}, {0, 1e-6F, 0}}};
  int views = 0;
  for (const Box& box : boxes)
    for (const auto& [width, height] : {std::pair{1920, 1080}, std::pair{512, 512}, std::pair{200, 900}, std::pair{3000, 100}})
      for (const float azimuth : {0.0F, 33.0F, 180.0F, 271.0F})
        for (const float elevation : {-90.0F, -20.0F, 0.0F, 55.0F, 90.0F}) {
          const Camera camera = frameCamera(box, azimuth, elevation, 35, width, height);
          float widest = 0;
          for (int i = 0; i < 8; ++i) {
            const Vec2 at =
                project(camera, {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z});
            widest = std::max({widest, std::abs(at.x), std::abs(at.y)});
          }
          const bool end_on = box.longestSide() == box.diagonal() && std::abs(elevation) == 90;  // the segment, seen as a point
          EXPECT_NEAR(widest, end_on ? 0.0F : 0.88F, 0.01F) << width << "×" << height << " from " << azimuth << ", " << elevation;
          ++views;
        }
  EXPECT_EQ(views, 4 * 4 * 4 * 5);
}

TEST(Camera, BoxWithoutSizeStillHasAView) {
  for (const Box& box : {Box{}, Box{{7, 7, 7}, {7, 7, 7}}}) {
    const Camera camera = frameCamera(box, 10, 10, 35, 64, 64);
    EXPECT_TRUE(isFinite(camera.look_from));
    EXPECT_NE(camera.look_from, camera.look_at);
    EXPECT_TRUE(isFinite(cameraRay(camera, 1, 1).direction));
  }
}

// n·n places: one in each of the n·n squares, one in each of the n·n columns and rows; the centre alone for n = 1.
TEST(PixelPlaces, AreSpreadInBothDirections) {
  EXPECT_EQ(pixelPlaces(1), (std::vector<Vec2>{{0.5F, 0.5F}}));
  EXPECT_EQ(pixelPlaces(0), pixelPlaces(1));
  for (const int n : {2, 3, 5}) {
    const std::vector<Vec2> places = pixelPlaces(n);
    std::set<int> squares, columns, rows;
    for (const Vec2 p : places) {
      squares.insert(int(p.x * float(n)) * n + int(p.y * float(n)));
      columns.insert(int(p.x * float(n * n)));
      rows.insert(int(p.y * float(n * n)));
    }
    for (const auto& set : {squares, columns, rows}) {
      EXPECT_EQ(int(set.size()), n * n);
      EXPECT_EQ(*set.begin(), 0);
      EXPECT_EQ(*set.rbegin(), n * n - 1);
    }
  }
}

TEST(Camera, RollTurnsThePictureAboutItsCentre) {
  const Camera level{{1, 2, 3}, {4, 1, -3}, 50, 80, 60};
  Camera rolled = level;
  rolled.roll_radians = 0.3F;
  const CameraAxes axes = cameraAxes(rolled), plain = cameraAxes(level);
  EXPECT_NEAR(dot(axes.up, plain.right), std::sin(0.3), 1e-6);  // the top leans to the right
  EXPECT_NEAR(dot(axes.up, axes.right), 0, 1e-6);
  EXPECT_LT(length(cross(axes.right, axes.forward) - axes.up), 1e-5F);
  for (const Vec2 p : {Vec2{40, 30}, Vec2{0, 0}, Vec2{79, 11}}) {
    const double per_pixel = 2 * std::tan(25 * kPi / 180) / 60;
    const Vec3 expected = *normalized(axes.forward + axes.right * float((p.x - 40) * per_pixel) + axes.up * float((30 - p.y) * per_pixel));
    EXPECT_LT(length(cameraRay(rolled, p.x, p.y).direction - expected), 1e-5F);
  }
}

}  // namespace
}  // namespace cloudbake
