// Which triangles the rays of pixels meet, against rays that look for them.
#include "preview/mesh_clouds/pixel_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/ray_scene.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

Camera cameraFrom(Vec3 place) {
  Camera camera{place, {}, 20};
  camera.width = 90, camera.height = 70;
  camera.roll_radians = 0.3F;
  return camera;
}

TEST(PixelTriangles, AreThoseThatRaysMeet) {
  for (const int subdivisions : {0, 2, 5}) {
    const SurfaceMesh ball = bakedBall(1, {}, subdivisions).surface;
    const RayScene scene(ball.positions, ball.triangles);
    const Camera camera = cameraFrom({3.1F, 1.7F, 4.3F});
    const auto pixels = PixelTriangles::of(ball.positions, ball.triangles, camera);
    ASSERT_TRUE(pixels);
    size_t met = 0;
    for (int y = 0; y < camera.height; ++y) {
      const PixelTriangles::Row row = pixels->row(y);
      for (int x = 0; x < camera.width; ++x) {
        std::vector<uint32_t> wanted;
        scene.forHits(cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F), [&](const RayHit& hit) { wanted.push_back(hit.triangle); });
        std::sort(wanted.begin(), wanted.end());
        const auto found = row.at(x);
        ASSERT_TRUE(std::equal(found.begin(), found.end(), wanted.begin(), wanted.end())) << subdivisions << ": " << x << ", " << y;
        met += found.size();
      }
    }
    EXPECT_GT(met, 2000U);
  }
}

// The vertex in the middle and points of edges are seen exactly at centres of pixels.
TEST(PixelTriangles, LeaveNoGapBetweenTriangles) {
  SurfaceMesh square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0}}, {}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  Camera camera{{0, 0, 10}, {}, 20};
  camera.width = camera.height = 51;  // the centre of the middle pixel is on the vertex
  const auto pixels = PixelTriangles::of(square.positions, square.triangles, camera);
  ASSERT_TRUE(pixels);
  const auto isInside = [](int at) { return std::abs(at - 25) <= 14; };  // half the square is 14.5 pixels
  for (int y = 0; y < 51; ++y) {
    const PixelTriangles::Row row = pixels->row(y);
    for (int x = 0; x < 51; ++x) EXPECT_EQ(row.at(x).empty(), !isInside(x) || !isInside(y)) << x << ", " << y;
  }
}

TEST(PixelTriangles, AreNotKnownBehindTheCamera) {
  const SurfaceMesh ball = bakedBall(1, {}, 2).surface;
  EXPECT_FALSE(PixelTriangles::of(ball.positions, ball.triangles, cameraFrom({0.2F, 0.1F, 0.5F})));
}

}  // namespace
}  // namespace cloudbake
