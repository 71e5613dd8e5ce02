// What a sequence shows at a moment.
#include "core/sequence.h"

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace cloudbake {
namespace {

SequenceKey keyOf(double frame, float radius) {
  const BakedMesh ball = bakedBall(radius, {}, 2);
  return {frame, ball.surface.positions, ball.surface.normals, ball.lobes};
}

// Segments over the frames 0 to 10, 6 to 20 and 16 to 30, one frame per second.
CloudSequence threeSegments() {
  CloudSequence sequence;
  sequence.frames_per_second = 1;
  sequence.period = 30;
  for (const auto& [first, last] : {std::pair(0, 10), {6, 20}, {16, 30}})
    sequence.segments.push_back({bakedBall(1, {}, 2).surface.triangles, {keyOf(first, 1), keyOf(last, 2)}});
  return sequence;
}

TEST(Sequence, KeysAreBlendedNumberByNumber) {
  const SequenceKey from = keyOf(2, 1), to = keyOf(6, 3), middle = blendedKey(from, to, 3);
  for (size_t v = 0; v < middle.positions.size(); ++v) {
    EXPECT_LT(length(middle.positions[v] - from.positions[v] * 1.5F), 1e-6F);
    EXPECT_LT(length(middle.normals[v] - from.normals[v]), 1e-6F);
    EXPECT_LT(length(middle.lobes[v].direction - from.lobes[v].direction), 1e-6F);
    EXPECT_NEAR(middle.lobes[v].thickness, 3, 1e-5F) << "between 2 and 6";
  }
  EXPECT_EQ(blendedKey(from, to, 2).positions, from.positions);
  EXPECT_EQ(blendedKey(from, to, 9).positions, to.positions) << "no farther than its keys";
}

TEST(Sequence, ASegmentFadesIntoTheNext) {
  const CloudSequence sequence = threeSegments();
  const auto weightAt = [&](double seconds, size_t segment) {
    float weight = 0, sum = 0;
    for (const SeenSegment& seen : seenAt(sequence, seconds)) {
      sum += seen.weight;
      if (seen.segment == segment) weight = seen.weight;
    }
    EXPECT_FLOAT_EQ(sum, 1) << seconds;
    return weight;
  };
  EXPECT_EQ(weightAt(0, 0), 1);
  EXPECT_EQ(weightAt(6, 0), 1) << "the next one begins";
  EXPECT_FLOAT_EQ(weightAt(7, 1), 0.25F);
  EXPECT_FLOAT_EQ(weightAt(7, 0), 0.75F);
  EXPECT_EQ(weightAt(10, 1), 1);
  EXPECT_EQ(weightAt(12, 1), 1);
  EXPECT_FLOAT_EQ(weightAt(19, 2), 0.75F);
  EXPECT_EQ(weightAt(100, 2), 1) << "stays at the end";
  EXPECT_EQ(seenAt(sequence, 100).front().frame, 30);
}

TEST(Sequence, ALoopFadesIntoItsBeginning) {
  CloudSequence sequence = threeSegments();
  sequence.loops = true;
  sequence.period = 26;
  for (const double turn : {0.0, 26.0, 52.0}) {
    const auto seen = seenAt(sequence, turn + 1);
    ASSERT_EQ(seen.size(), 2U) << turn;
    EXPECT_EQ(seen[0].segment, 2U);
    EXPECT_DOUBLE_EQ(seen[0].frame, 27);
    EXPECT_FLOAT_EQ(seen[0].weight, 0.75F);
    EXPECT_EQ(seen[1].segment, 0U);
    EXPECT_DOUBLE_EQ(seen[1].frame, 1);
  }
  EXPECT_EQ(seenAt(sequence, 25.99).size(), 1U);
  EXPECT_FLOAT_EQ(seenAt(sequence, 26)[0].weight, 1) << "the first frame is not there yet, so that nothing jumps";
}

TEST(Sequence, ShowsTheMeshOfASegment) {
  const CloudSequence sequence = threeSegments();
  const BakedMesh mesh = meshAt(sequence, {1, 13, 1});
  EXPECT_EQ(mesh.surface.triangles, sequence.segments[1].triangles);
  EXPECT_NEAR(length(mesh.surface.positions[0]), 1.5F, 1e-5F);
  EXPECT_EQ(mesh.lobes.size(), mesh.surface.positions.size());
}

}  // namespace
}  // namespace cloudbake
