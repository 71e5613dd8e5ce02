#include "bake/field/winding.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

// Every column of a closed mesh must close: the signs of its crossings add up to 0.
int unclosedColumns(const WindingColumns& columns) {
  int unclosed = 0;
  for (size_t i = 0; i + 1 < columns.first.size(); ++i) {
    int sum = 0;
    for (uint32_t c = columns.first[i]; c < columns.first[i + 1]; ++c) sum += columns.crossings[c].sign;
    unclosed += sum != 0;
  }
  return unclosed;
}

}  // namespace

// Faces, edges and corners of this box all lie on lattice columns: each column must be counted once.
TEST(Winding, BoxOnTheLatticeClosesInEveryColumn) {
  const SurfaceMesh box = boxMesh({-3, -4, -5}, {3, 4, 5});
  const WindingColumns columns = windingColumns(latticePoints(box.positions), box.triangles);
  EXPECT_EQ(unclosedColumns(columns), 0);
  EXPECT_EQ(columns.crossings.size() / 2, 6U * 8U);  // half-open: 6 × 8 of the 7 × 9 feet
  EXPECT_EQ(windingNumber(columns, 0, 0, 0), 1);
  EXPECT_EQ(windingNumber(columns, 0, 0, 6), 0);
  EXPECT_EQ(windingNumber(columns, 0, 0, -6), 0);
  EXPECT_EQ(windingNumber(columns, 5, 0, 0), 0);
  EXPECT_EQ(windingNumber(columns, 1000, -1000, 0), 0);
}

// Vertices snapped to half voxels put edges and corners onto columns by the hundred.
TEST(Winding, SnappedBallsCloseInEveryColumn) {
  for (int n = 0; n < 20; ++n) {
    SurfaceMesh ball = ballMesh(5 + 0.37F * float(n), 3);
    for (Vec3& p : ball.positions) p = {std::round(2 * p.x) / 2, std::round(2 * p.y) / 2, std::round(2 * p.z) / 2};
    EXPECT_EQ(unclosedColumns(windingColumns(latticePoints(ball.positions), ball.triangles)), 0) << n;
  }
}

// Inside a ball the winding number is 1, in an overlap 2, in a reversed inner shell 0, of a reversed ball −1.
TEST(Winding, CountsShells) {
  const SurfaceMesh ball = ballMesh(8, 4);
  SurfaceMesh inner = ballMesh(4, 4);
  const auto atCenter = [](const SurfaceMesh& mesh) {
    return windingNumber(windingColumns(latticePoints(mesh.positions), mesh.triangles), 0, 0, 0);
  };
  EXPECT_EQ(atCenter(ball), 1);
  EXPECT_EQ(atCenter(merged(ball, inner)), 2);
  reverse(inner);
  EXPECT_EQ(atCenter(merged(ball, inner)), 0);
  EXPECT_EQ(atCenter(inner), -1);
}

// Against the closed form |x| < R, away from the facets' sagitta.
TEST(Winding, AgreesWithTheBall) {
  const float radius = 20;
  const SurfaceMesh ball = ballMesh(radius, 5, {0.3F, -0.2F, 0.1F});
  const WindingColumns columns = windingColumns(latticePoints(ball.positions), ball.triangles);
  int checked = 0;
  for (int x = -22; x <= 22; ++x)
    for (int y = -22; y <= 22; ++y)
      for (int z = -22; z <= 22; ++z) {
        const float distance = length(Vec3{float(x), float(y), float(z)} - Vec3{0.3F, -0.2F, 0.1F});
        if (std::fabs(distance - radius) < 0.05F) continue;
        ASSERT_EQ(windingNumber(columns, x, y, float(z)), distance < radius ? 1 : 0) << x << ' ' << y << ' ' << z;
        ++checked;
      }
  EXPECT_GT(checked, 80000);
}

TEST(Winding, NothingGivesNothing) {
  const WindingColumns columns = windingColumns(latticePoints({}), {});
  EXPECT_EQ(windingNumber(columns, 0, 0, 0), 0);
}
