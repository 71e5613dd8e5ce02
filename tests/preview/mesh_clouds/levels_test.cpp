// A cloud's size on screen, and the level of detail that belongs to it.
#include "preview/mesh_clouds/levels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/shapes.h"

namespace cloudbake {
namespace {

// 1000 pixels per unit at distance 1.
Camera cameraAt(Vec3 eye, Vec3 target = {}) {
  Camera camera{eye, target};
  camera.vertical_fov_degrees = 90;
  camera.height = 2000;
  return camera;
}

BakedMesh ballOf(int switch_pixels) {
  BakedMesh mesh = bakedBall(1, {}, 2);
  mesh.info.switch_pixels = switch_pixels;
  return mesh;
}

Affine scaled(double factor, Vec3 offset = {}) {
  Affine m;
  for (size_t i = 0; i < 3; ++i) m.linear[i][i] = factor;
  m.offset = {offset.x, offset.y, offset.z};
  return m;
}

}  // namespace

TEST(PixelsAcross, AreThoseOfTheLongestSideWhereTheBoxIsNearest) {
  const BakedMesh ball = ballOf(0);  // 2 units across
  EXPECT_NEAR(pixelsAcross({&ball, {}}, cameraAt({0, 0, 11})), 200, 0.5);
  EXPECT_NEAR(pixelsAcross({&ball, {}}, cameraAt({0, 0, 11}, {5, 0, 0})), 200, 0.5) << "a turn of the camera changes nothing";
  EXPECT_NEAR(pixelsAcross({&ball, scaled(3)}, cameraAt({0, 0, 13})), 600, 1.5);
  EXPECT_NEAR(pixelsAcross({&ball, scaled(1, {0, 0, -9})}, cameraAt({0, 0, 11})), 2000 / 19.0, 0.3);
  EXPECT_EQ(pixelsAcross({&ball, {}}, cameraAt({0, 0.5F, 0}, {5, 0, 0})), INFINITY);
  Affine stretched = scaled(1);
  stretched.linear[0][0] = 5;
  EXPECT_NEAR(pixelsAcross({&ball, stretched}, cameraAt({0, 0, 11})), 1000, 3);
}

TEST(LevelAt, IsTheCoarsestThatTheSizeAllows) {
  const BakedMesh full = ballOf(0), fine = ballOf(400), coarse = ballOf(100), never = ballOf(0);
  const BakedMesh* levels[] = {&fine, &coarse, &never};
  const auto at = [&](float pixels) { return &levelAt({&full, {}, nullptr, {}, levels}, cameraAt({0, 0, 1 + 2000 / pixels})); };
  EXPECT_EQ(at(420), &full);
  EXPECT_EQ(at(380), &fine);
  EXPECT_EQ(at(105), &fine);
  EXPECT_EQ(at(95), &coarse);
  EXPECT_EQ(at(0.001F), &coarse) << "a level without a size is never drawn";
  EXPECT_EQ(&levelAt({&full, {}}, cameraAt({0, 0, 1000})), &full);
}

// What the camera sees and what it does not, in a picture as wide as high whose sides are at 45 degrees.
TEST(IsInView, LeavesOutWhatIsBehindOrBeyondASide) {
  const BakedMesh ball = ballOf(0);  // 2 units across
  Camera camera = cameraAt({0, 0, 10});
  camera.width = camera.height;
  const auto sees = [&](Vec3 at) { return isInView({&ball, scaled(1, at)}, camera); };
  EXPECT_TRUE(sees({}));
  EXPECT_TRUE(sees({10.5F, 0, 0}) && sees({-10.5F, 0, 0}) && sees({0, 10.5F, 0}) && sees({0, -10.5F, 0})) << "cut by a side";
  EXPECT_FALSE(sees({12.5F, 0, 0}) || sees({-12.5F, 0, 0}) || sees({0, 12.5F, 0}) || sees({0, -12.5F, 0}));
  EXPECT_TRUE(sees({0, 0, 10.5F})) << "around the camera";
  EXPECT_FALSE(sees({0, 0, 12}));
}

}  // namespace cloudbake
