#include "pipeline/options/scene_needs.h"

#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

SceneNeeds sceneAt(std::optional<double> distance, float fov_degrees, int width, int height) {
  SceneNeeds scene;
  scene.camera_distance = distance;
  scene.view.field_of_view_degrees = fov_degrees;
  scene.view.camera_elevation_degrees = 0;
  scene.view.width = width;
  scene.view.height = height;
  return scene;
}

constexpr Box kCube{{-1, -1, -1}, {1, 1, 1}};

// 2 · d · tan(fov / 2) / height, whatever the cloud's size.
TEST(SceneNeeds, APixelAtAKnownDistance) {
  EXPECT_NEAR(pixelSize(sceneAt(200, 50, 1920, 1080), kCube), 2 * 200 * 0.46630765815499859 / 1080, 1e-7);
  EXPECT_NEAR(pixelSize(sceneAt(1, 90, 10, 100), kCube), 0.02, 1e-9);
  EXPECT_EQ(pixelSize(sceneAt(200, 50, 1920, 1080), kCube), pixelSize(sceneAt(200, 50, 1920, 1080), {{-9, -9, -9}, {9, 9, 9}}));
}

// Straight in front of the cube at 90°: its near face, 1 in front of the middle and 1 high above it, fills 88 % of the half picture, so
// that the camera stands 1 + 1/0.88 from the middle.
TEST(SceneNeeds, WithoutADistanceTheCloudFillsThePicture) {
  const double distance = 1 + 1 / 0.88;
  EXPECT_NEAR(pixelSize(sceneAt({}, 90, 100, 100), kCube), 2 * distance / 100, 0.02 * 2 * distance / 100);
  // Twice the cloud, twice the pixel; twice the pixels, half of it.
  const double one = pixelSize(sceneAt({}, 35, 300, 200), kCube);
  EXPECT_NEAR(pixelSize(sceneAt({}, 35, 300, 200), {{-2, -2, -2}, {2, 2, 2}}), 2 * one, 1e-5 * one);
  EXPECT_NEAR(pixelSize(sceneAt({}, 35, 600, 400), kCube), one / 2, 1e-5 * one);
}

TEST(SceneNeeds, VerticesPerAreaOfEvenTriangles) {
  // A pixel of 1/80 makes edges of 0.1; a box of 2 × 3 × 4 has 52 of area.
  const SceneNeeds scene = sceneAt(0.625, 90, 100, 100);
  const double expected = 52 / (std::sqrt(3.0) / 2 * 0.1 * 0.1);
  EXPECT_NEAR(double(vertexBudget(scene, boxMesh({0, 0, 0}, {2, 3, 4}))), expected, 1);
}

// The second route: a mesh whose edges do span eight pixels has about the vertices that are asked for.
TEST(SceneNeeds, AMeshOfThoseEdgesHasThatManyVertices) {
  const SurfaceMesh ball = ballMesh(3, 4);
  const double pixel = meanEdgeLength(ball) / 8;
  const SceneNeeds scene = sceneAt(pixel * 500, 90, 1000, 1000);
  ASSERT_NEAR(pixelSize(scene, boundingBox(ball)), pixel, 1e-9);
  EXPECT_NEAR(double(vertexBudget(scene, ball)) / double(ball.positions.size()), 1, 0.03);
}

TEST(SceneNeeds, ATetrahedronIsTheLeast) { EXPECT_EQ(vertexBudget(sceneAt(1e6, 90, 10, 10), boxMesh({0, 0, 0}, {1, 1, 1})), 4U); }

}  // namespace
}  // namespace cloudbake
