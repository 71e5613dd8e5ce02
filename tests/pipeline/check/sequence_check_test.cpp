// Sequences whose right lobes are known, and what other programs may do to them.
#include <gtest/gtest.h>

#include <functional>

#include "core/sequence.h"
#include "io/file/write_file.h"
#include "io/gltf/sequence/sequence_file.h"
#include "pipeline/check/check.h"
#include "tests/pipeline/check/check_helpers.h"

namespace cloudbake {
namespace {

// A ball that grows: at frame f its radius is 1 + f / 10.
CloudSequence growingBall() {
  CloudSequence sequence;
  SequenceSegment segment;
  for (int frame = 0; frame <= 8; frame += 4) {
    const TestAsset ball = ballAsset(1 + 0.1F * float(frame), 3);
    segment.triangles = ball.mesh.triangles;
    segment.keys.push_back({double(frame), ball.mesh.positions, ball.mesh.normals, ball.lobes});
    sequence.info = ball.info;
  }
  sequence.info.layout = kSequenceLayout;
  sequence.segments.push_back(std::move(segment));
  sequence.period = 8;
  return sequence;
}

class SequenceCheck : public testing::TestWithParam<SequenceForm> {
 protected:
  CheckReport checked(const std::string& bytes) const {
    const std::filesystem::path file = folder_.path / "ball.glb";
    writeFileAtomically(file, bytes);
    Settings settings;
    settings.source.input = file;
    return checkAsset(settings);
  }
  // After a change that another program made to the keys, which keeps the seal of the bake.
  CheckReport changed(const std::function<void(CloudSequence&)>& change) const {
    const auto sealIn = [](const std::string& bytes) { return decodeSequence("", bytes).seal; };
    CloudSequence sequence = growingBall();
    const std::string before = sealIn(encodeSequence(sequence, GetParam()));
    change(sequence);
    std::string bytes = encodeSequence(sequence, GetParam());
    const std::string after = sealIn(bytes);
    EXPECT_EQ(after.size(), before.size());
    bytes.replace(bytes.find(after), after.size(), before);
    return checked(bytes);
  }
  TestFolder folder_;
};

TEST_P(SequenceCheck, AGrowingBallIsSound) {
  const CheckReport report = checked(encodeSequence(growingBall(), GetParam()));
  EXPECT_FALSE(report.verdict) << report.verdict->what;
  ASSERT_TRUE(report.sequence);
  EXPECT_EQ(report.sequence->keys.size(), 5U) << "three keys and two moments between them";
  EXPECT_EQ(report.sequence->seal, SequenceFigures::Seal::kWhole);
  for (const KeyFigures& one : report.sequence->keys) EXPECT_LT(one.transmittance_rms, 0.03) << one.frame;
  EXPECT_NE(checkText(report).find("3 keys, 1 segment; since the bake: the same"), std::string::npos) << checkText(report);
}

TEST_P(SequenceCheck, NamesTheFrameAndTheCause) {
  const CheckReport report = changed([](CloudSequence& sequence) {
    for (Lobe& lobe : sequence.segments[0].keys[1].lobes) lobe.direction = -lobe.direction;
  });
  ASSERT_TRUE(report.verdict);
  EXPECT_EQ(report.verdict->cause, "inverted");
  EXPECT_NE(report.verdict->what.find("the key at frame 4: "), std::string::npos) << report.verdict->what;
}

TEST_P(SequenceCheck, TellsThatKeysAreSwapped) {
  const CheckReport report = changed([](CloudSequence& sequence) {
    std::vector<SequenceKey>& keys = sequence.segments[0].keys;
    std::swap(keys[0].lobes, keys[2].lobes);
  });
  EXPECT_TRUE(report.verdict);
}

// Each key is right, but vertices change places from one to the next, so that the mesh collapses between them.
TEST_P(SequenceCheck, JudgesWhatIsBetweenKeys) {
  const CheckReport report = changed([](CloudSequence& sequence) {
    SequenceKey& last = sequence.segments[0].keys[2];
    for (auto* values : {&last.positions, &last.normals})
      for (Vec3& value : *values) value = {-value.x, value.y, -value.z};
    for (Lobe& lobe : last.lobes) lobe.direction = {-lobe.direction.x, lobe.direction.y, -lobe.direction.z};
  });
  ASSERT_TRUE(report.verdict);
  EXPECT_NE(report.verdict->what.find("frame 6, halfway between two keys"), std::string::npos) << report.verdict->what;
}

// The normals of a cap, which has an eighth of the triangles, are turned inwards.
TEST_P(SequenceCheck, SeesFolds) {
  const CheckReport report = changed([](CloudSequence& sequence) {
    SequenceKey& key = sequence.segments[0].keys[0];
    for (size_t v = 0; v < key.normals.size(); ++v)
      if (key.normals[v].y > 0.75F) key.normals[v] = -key.normals[v];
  });
  ASSERT_TRUE(report.verdict);
  EXPECT_EQ(report.verdict->cause, "folded");
  EXPECT_NE(report.verdict->what.find("the key at frame 0: "), std::string::npos) << report.verdict->what;
}

TEST_P(SequenceCheck, ASmallChangeBreaksTheSeal) {
  const CheckReport report = changed([](CloudSequence& sequence) {
    for (Lobe& lobe : sequence.segments[0].keys[0].lobes) lobe.thickness *= 1.02F;
  });
  ASSERT_TRUE(report.verdict);
  EXPECT_EQ(report.verdict->cause, "changed");
}

INSTANTIATE_TEST_SUITE_P(Forms, SequenceCheck, testing::Values(SequenceForm::kMorph, SequenceForm::kTexture));

}  // namespace
}  // namespace cloudbake
