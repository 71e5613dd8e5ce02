#include "bake/lobe/sliced_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bake/field/coverage.h"
#include "bake/lobe/directions.h"
#include "core/random.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

Vec3 someShift(uint32_t n) {
  const auto draw = [&](uint32_t axis) { return uniformFloat(hashDraw(5, n, axis)); };
  return {draw(1), draw(2), draw(3)};
}

SurfaceMesh movedBall(int subdivisions, float radius, Vec3 shift) {
  SurfaceMesh ball = ballMesh(1, subdivisions);
  for (Vec3& p : ball.positions) p = shift + p * radius;
  return ball;
}

}  // namespace

// From a point on a ball no cloud lies ahead of a direction that leaves it. A blur of σ = ½ cell alone would leave σ/√(2π) = 0.2 cells over
// the cosine to the normal. The sharpening takes that back: in the mean over points, places of the lattice and directions of a cosine above
// 0.3, over which 1/cosine is 1.72 in the mean, less than a tenth of it is left.
TEST(SlicedField, ChordsThatLeaveABallAreZeroInTheMean) {
  const double blurred = 0.5 / std::sqrt(2 * kPi) * std::log(1 / 0.3) / 0.7;
  for (const float radius : {12.0F, 24.0F, 48.0F}) {
    double sum = 0;
    size_t count = 0;
    for (uint32_t trial = 0; trial < 4; ++trial) {
      const SurfaceMesh ball = movedBall(5, radius, someShift(trial));
      const CoverageField field = coverageFromMesh(ball, GridFrame{}).value();
      std::vector<Vec3> directions(ball.positions.size());
      for (uint32_t i = 0; i < directions.size(); ++i) {
        uniformDirections(hashDraw(13, trial, i), {&directions[i], 1});
        if (dot(directions[i], ball.normals[i]) < 0) directions[i] = -directions[i];
      }
      uint64_t moved = 0;
      const std::vector<Vec3> cells = cellPositions(ball.positions, field, moved);
      EXPECT_EQ(moved, 0U);
      const std::vector<float> lengths = slicedLengths(cells, directions, 4 * radius, slicedFields(field));
      for (size_t i = 0; i < lengths.size(); ++i)
        if (dot(directions[i], ball.normals[i]) > 0.3F) sum += double(lengths[i]), ++count;
    }
    EXPECT_NEAR(sum / double(count), 0, 0.1 * blurred) << radius;
  }
}

// Sharpening moves cloud between neighbouring cells and adds none, so that lines through the whole cloud keep their length.
TEST(SlicedField, SharpeningKeepsTheVolume) {
  const CoverageField field = coverageFromMesh(movedBall(3, 9, someShift(7)), GridFrame{}).value();
  const SlicedFields sliced = slicedFields(field);
  double fractions = 0, differing = 0;
  for (const float fraction : field.fractions) fractions += double(fraction);
  for (size_t i = 0; i < field.fractions.size(); ++i) differing += sliced.along_x[i] != field.fractions[i];
  EXPECT_GT(differing, 100);
  for (const auto& values : {sliced.along_x, sliced.along_z}) {
    double sum = 0;
    for (const float value : values) sum += double(value);
    EXPECT_NEAR(sum / fractions, 1, 1e-6);
  }
}

// The three stacks of slices hold the same cells: the value at (x, y, z) is found at (column, row, slice) of each axis, and what a row's
// span leaves out is 0.
TEST(SlicedField, EveryAxisHoldsTheSameCells) {
  const CoverageField field = coverageFromMesh(boxMesh({-3.2F, -1.1F, -6.7F}, {2.4F, 4.3F, 1.9F}), GridFrame{}).value();
  const SlicedFields sliced = slicedFields(field);
  const auto [nx, ny, nz] = field.cells;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const int at[3] = {x, y, z};
        const float expected = sliced.along_x[(size_t(z) * size_t(ny) + size_t(y)) * size_t(nx) + size_t(x)];
        for (const SlicedField& across : sliced.across) {
          const int column = at[across.axes[0]], row = at[across.axes[1]], slice = at[across.axes[2]];
          const SliceView view = across.slice(slice);
          ASSERT_EQ(view.cells[size_t(row) * view.row_stride + size_t(column)], expected);
          if (column < view.spans[row][0] || column >= view.spans[row][1]) {
            ASSERT_EQ(expected, 0);
          }
        }
      }
}
