// Sequences from files to keys.
#include "pipeline/sequence/sequence.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>

#include "bake/field/level_set.h"
#include "io/file/write_file.h"
#include "io/gltf/sequence/sequence_file.h"
#include "io/volume/vdb.h"
#include "pipeline/check/measure_keys.h"
#include "pipeline/sequence/choose_keys.h"
#include "tests/io/gltf/gltf_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

class SequenceTest : public testing::Test {
 protected:
  SequenceTest() { setenv("XDG_CACHE_HOME", file("cache").c_str(), 1); }
  ~SequenceTest() override { unsetenv("XDG_CACHE_HOME"); }

  fs::path file(const std::string& name) const { return folder_.path / name; }
  void touch(const std::string& name) const {
    createFolder(file(name).parent_path());
    writeFileAtomically(file(name), "");
  }
  std::vector<std::string> namesOf(const std::string& input) const {
    std::vector<std::string> names;
    for (const FrameInput& frame : frameFiles(file(input)))
      names.push_back(fmt::format("{:g} {}", frame.frame, frame.file.filename().string()));
    return names;
  }
  std::string refusal(const std::string& input) const {
    return refusalOf<InputError>([&] { frameFiles(file(input)); });
  }

  // Frames of a body, as OBJ.
  void write(int frames, const std::function<SurfaceMesh(int)>& body) const {
    createFolder(file("f"));
    for (int i = 0; i < frames; ++i) writeFileAtomically(file(fmt::format("f/b.{:03}.obj", i)), objText(body(i)));
  }
  BakedSequence baked(const std::vector<std::string>& texts) const {
    const std::vector<FrameInput> frames = frameFiles(file("f"));
    std::vector<std::string> all{"vertices=400", "voxels=40", "pixels=64", "rays=32"};
    all.insert(all.end(), texts.begin(), texts.end());
    const std::vector<Given> given = options(all, kSequence);
    BakeReport report;
    Stopwatch watch;
    return bakeSequence(frames, resolve(sourceOf(SourceKind::kSculpt, frames.front().file), given), given, report, watch);
  }

  // A ball of radius 1 whose morph target makes it twice as large, and the keys of the target's weight.
  void writeBall(const std::vector<float>& times, const std::vector<float>& weights) const {
    GltfBuilder gltf;
    const SurfaceMesh ball = ballMesh(1, 4);
    const int positions = gltf.accessor(ball.positions, 5126, "VEC3", ball.positions.size());
    const int indices = gltf.accessor(ball.triangles, 5125, "SCALAR", 3 * ball.triangles.size(), 34963);
    gltf.mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"targets", {{{"POSITION", positions}}}}}});
    gltf.node({{"mesh", 0}});
    gltf.json["scenes"].push_back({{"nodes", {0}}});
    const int input = gltf.accessor(times, 5126, "SCALAR", times.size(), 0);
    const int output = gltf.accessor(weights, 5126, "SCALAR", weights.size(), 0);
    gltf.json["animations"] = Json::array({{{"name", "Grow"},
                                            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
                                            {"samplers", {{{"input", input}, {"output", output}}}}}});
    writeFileAtomically(file("ball.glb"), gltf.glb());
  }
  AnimationFrames animation(const std::vector<std::string>& texts = {}) const {
    return animationFrames(resolve(sourceOf(SourceKind::kSculpt, file("ball.glb")), options(texts, kSequence)));
  }
  BakedSequence bakedAnimation(std::vector<std::string> texts = {}) const {
    for (const char* text : {"vertices=400", "voxels=40", "pixels=64", "rays=32", "lobe=mean"}) texts.emplace_back(text);
    const std::vector<Given> given = options(texts, kSequence);
    Settings settings = resolve(sourceOf(SourceKind::kSculpt, file("ball.glb")), given);
    const AnimationFrames animation = animationFrames(settings);
    settings.sequence.frames_per_second = animation.frames_per_second;
    BakeReport report;
    Stopwatch watch;
    return bakeSequence(animation.frames, settings, given, report, watch);
  }

  TestFolder folder_;
};

TEST_F(SequenceTest, FramesAreFilesByTheirNumbers) {
  for (const char* name : {"a/s.8.vdb", "a/s.10.vdb", "a/s.0009.vdb", "a/t.10.vdb", "a/note.txt", "a/.s.11.vdb"}) touch(name);
  using Names = std::vector<std::string>;
  EXPECT_EQ(namesOf("a/s.#.vdb"), (Names{"0 s.8.vdb", "1 s.0009.vdb", "2 s.10.vdb"}));
  EXPECT_EQ(namesOf("a/s.%d.vdb"), namesOf("a/s.#.vdb"));
  EXPECT_EQ(namesOf("a/s.*.vdb"), namesOf("a/s.#.vdb"));
  EXPECT_EQ(namesOf("a/s.##.vdb"), (Names{"0 s.0009.vdb", "1 s.10.vdb"})) << "at least two digits";
  touch("b/x1.obj"), touch("b/x2.obj"), touch("b/x5.obj");
  EXPECT_EQ(namesOf("b"), (Names{"0 x1.obj", "1 x2.obj", "4 x5.obj"})) << "a gap in time";
  touch("p/a+b(1).1.obj"), touch("p/a+b(1).2.obj");
  EXPECT_EQ(namesOf("p/a+b(1).#.obj").size(), 2U) << "signs that patterns of other kinds know";
}

TEST_F(SequenceTest, RefusesFilesThatAreNoSequence) {
  for (const char* name : {"a/s.1.vdb", "a/t.1.vdb", "c/1.obj", "c/2.ply", "n/1.vdb", "n/s.vdb", "x/1.txt", "x/2.txt"}) touch(name);
  EXPECT_TRUE(contains(refusal("a"), "has the same number as s.1.vdb"));
  EXPECT_TRUE(contains(refusal("a/s.#.vdb"), "only one frame was found"));
  EXPECT_TRUE(contains(refusal("a/q.####.vdb"), "no frame was found"));
  EXPECT_TRUE(contains(refusal("c"), "has frames of several kinds (1.obj, 2.ply)"));
  EXPECT_TRUE(contains(refusal("n"), "s.vdb: has no number in its name"));
  EXPECT_TRUE(contains(refusal("x/#.txt"), "neither a volume (VDB) nor a sculpt"));
  EXPECT_THROW(frameFiles(file("missing/s.#.vdb")), IoError);
}

TEST_F(SequenceTest, AGrownCloudVariesEvenly) {
  SequenceSettings settings;
  settings.frames = 5;
  settings.varied = {{"size", 1, 3}, {"voxels", 40, 43}, {"boil", 0, 1}};
  const GrownSource source = readGrownSource(sourceOf(SourceKind::kPreset, "sprouting"));
  const std::vector<FrameInput> frames = grownFrames(settings, source);
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_EQ(frames[1].varied[0].value, "1.5");
  EXPECT_EQ(frames[4].varied[0].value, "3");
  EXPECT_EQ(frames[1].varied[1].value, "41") << "whole numbers are rounded";
  EXPECT_EQ(frames[1].varied[2].value, "boil=0.25") << "a variable of the recipe";
  settings.varied = {{"nonsense", 1, 3}};
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] { grownFrames(settings, source); }), "grow has no option 'nonsense'"));
}

TEST_F(SequenceTest, AGrownLoopGoesOnDuringItsFade) {
  SequenceSettings settings;
  settings.frames = 13;
  settings.fade = 4;
  settings.loops = true;
  settings.varied = {{"boil", 0, 1}};
  const std::vector<FrameInput> frames = grownFrames(settings, readGrownSource(sourceOf(SourceKind::kPreset, "sprouting")));
  EXPECT_EQ(frames[8].varied[0].value, "boil=1") << "after one period, which ends where the fade begins";
  EXPECT_EQ(frames[12].varied[0].value, "boil=1.5");
}

// A ball that grows by its own scale is blended exactly, so that two keys are enough, and its lobe is known: towards the centre, 2 r thick.
TEST_F(SequenceTest, AGrowingBallNeedsTwoKeys) {
  write(9, [](int i) { return ballMesh(1 + 0.1F * float(i), 4); });
  const BakedSequence sequence = baked({"lobe=mean"});
  ASSERT_EQ(sequence.sequence.segments.size(), 1U);
  const SequenceSegment& segment = sequence.sequence.segments.front();
  EXPECT_LE(segment.keys.size(), 3U);
  EXPECT_EQ(segment.last(), 8);
  EXPECT_EQ(sequence.sequence.pixels, 64);
  EXPECT_TRUE(sequence.events.empty());
  EXPECT_EQ(sequence.frames.size(), 9U);
  for (const FrameFigures& frame : sequence.frames) {
    EXPECT_LE(frame.change, 1);
    EXPECT_LT(frame.follow.distance.rms, 0.01);
  }
  for (const SequenceKey& key : segment.keys) {
    const float radius = 1 + 0.1F * float(key.frame);
    double angle = 0;
    for (size_t v = 0; v < key.positions.size(); ++v) {
      EXPECT_NEAR(length(key.positions[v]), radius, 0.03F * radius);
      angle = std::max(angle, angleDegrees(key.lobes[v].direction, *normalized(-key.positions[v])));
      EXPECT_NEAR(key.lobes[v].thickness, 2 * radius, 0.15F * radius) << "on this frame's own volume";
    }
    EXPECT_LT(angle, 8);
  }
}

// Frames of Blender have +Z up.
TEST_F(SequenceTest, VolumesAreFollowedWithAnotherAxisUp) {
  createFolder(file("v"));
  for (int i = 0; i < 3; ++i) {
    Warnings warnings;
    LevelSetSettings lattice;
    lattice.voxels = 40;
    const SurfaceMesh ball = ballMesh(1, 4, {0, 0, 5 + 0.05F * float(i)});
    writeFileAtomically(file(fmt::format("v/b.{}.vdb", i)), encodeVdb(levelSetFromMesh(ball, lattice, warnings)));
  }
  const std::vector<FrameInput> frames = frameFiles(file("v"));
  const std::vector<Given> given = options({"up=z", "vertices=300", "rays=32", "pixels=64"}, kSequence);
  BakeReport report;
  Stopwatch watch;
  const BakedSequence baked =
      bakeSequence(frames, resolve(sourceOf(SourceKind::kVolume, frames.front().file), given), given, report, watch);
  const Vec3 center = boxOf(baked.sequence.segments).center();
  EXPECT_NEAR(center.y, 5.05, 0.1);
  EXPECT_NEAR(center.z, 0, 0.1);
}

// A ball that becomes a plate. If each frame's lobes were fitted with another k and b than the file has, T would be off by over 0.05.
TEST_F(SequenceTest, OneShapeOfLobesIsFittedInAllFrames) {
  write(5, [](int i) {
    SurfaceMesh body = ballMesh(1, 4);
    for (Vec3& p : body.positions) p.y *= 1 - 0.2F * float(i);
    return body;
  });
  const BakedSequence sequence = baked({"change=0"});
  for (const KeyFigures& one : measureKeys(sequence.sequence, {}).keys) EXPECT_LT(one.transmittance_rms, 0.04) << one.frame;
}

TEST_F(SequenceTest, KeysAreWhereBlendingErrs) {
  // It grows, and stops growing in the middle.
  CloudSequence sequence;
  sequence.info = bakedBall().info;
  SequenceSegment all;
  for (int i = 0; i <= 8; ++i) {
    const BakedMesh ball = bakedBall(1 + 0.2F * float(std::min(i, 4)), {}, 4);
    all.triangles = ball.surface.triangles;
    all.keys.push_back({double(i), ball.surface.positions, ball.surface.normals, ball.lobes});
  }
  std::vector<BlendFigures> figures;
  EXPECT_EQ(chooseKeys(sequence, all, 64, 0.5, figures), (std::vector<size_t>{0, 4, 8}));
  for (const BlendFigures& one : figures) EXPECT_LE(one.change, 0.5);
  EXPECT_EQ(chooseKeys(sequence, all, 64, 255, figures), (std::vector<size_t>{0, 8}));
  EXPECT_GT(figures[4].change, 1) << "the change is told, also where it is allowed";
  EXPECT_GT(figures[4].transmittance_rms, 0.001);
  EXPECT_EQ(chooseKeys(sequence, all, 64, 0, figures).size(), 9U) << "also those between which nothing changes";
  EXPECT_EQ(figures[6].change, 0);
  // It grows ever faster.
  for (size_t i = 0; i < all.keys.size(); ++i) {
    const BakedMesh ball = bakedBall(1 + 0.003F * float(i * i), {}, 4);
    all.keys[i] = {double(i), ball.surface.positions, ball.surface.normals, ball.lobes};
  }
  size_t before = all.keys.size();
  for (const double most : {0.25, 0.5, 1.0, 2.0, 4.0}) {
    const size_t count = chooseKeys(sequence, all, 64, most, figures).size();
    EXPECT_LE(count, before);
    before = count;
    for (const BlendFigures& one : figures) EXPECT_LE(one.change, most);
  }
  EXPECT_EQ(before, 5U);
}

// A ball is born beside another.
SurfaceMesh withASecondBall(int i) {
  const SurfaceMesh ball = ballMesh(1, 4, {0.02F * float(i), 0, 0});
  return i < 4 ? ball : merged(ball, ballMesh(0.3F + 0.05F * float(i), 4, {2.5F, 0, 0}));
}

TEST_F(SequenceTest, ABirthBeginsASegmentThatFadesIn) {
  write(9, withASecondBall);
  const BakedSequence sequence = baked({"fade=2"});
  ASSERT_EQ(sequence.sequence.segments.size(), 2U);
  EXPECT_EQ(sequence.sequence.segments[0].last(), 4);
  EXPECT_EQ(sequence.sequence.segments[1].first(), 2);
  ASSERT_EQ(sequence.events.size(), 1U);
  EXPECT_EQ(sequence.events[0], "frame 4: 1 part, 0 holes become 2 parts, 0 holes; segment 2 has faded in since frame 2");
  // While it fades, no frame's pictures differ by more than its weight.
  EXPECT_FLOAT_EQ(seenAt(sequence.sequence, 3.0 / 24).back().weight, 0.5F);
}

TEST_F(SequenceTest, UnchangedFramesAreNotBakedAgain) {
  const auto growing = [](int i) { return ballMesh(1 + 0.05F * float(i), 4); };
  write(7, growing);
  const auto bytesOf = [](const BakedSequence& sequence) { return encodeSequence(sequence.sequence, SequenceForm::kMorph); };
  const auto keptOf = [](const BakedSequence& sequence) {
    return std::count_if(sequence.frames.begin(), sequence.frames.end(), [](const FrameFigures& frame) { return frame.was_kept; });
  };
  const BakedSequence first = baked({}), second = baked({});
  EXPECT_EQ(keptOf(first), 0);
  EXPECT_EQ(keptOf(second), 7);
  EXPECT_EQ(bytesOf(first), bytesOf(second));
  writeFileAtomically(file("f/b.005.obj"), objText(growing(6)));
  const BakedSequence third = baked({});
  EXPECT_EQ(keptOf(third), 5) << "the frame that has changed, and the one that is followed from it, are baked anew";
  EXPECT_NE(bytesOf(third), bytesOf(first));
  EXPECT_NE(third.sequence.info.input_hash, first.sequence.info.input_hash);
  EXPECT_EQ(keptOf(baked({"rays=64"})), 0) << "other settings";
  fs::remove_all(file("cache"));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(bytesOf(baked({})), bytesOf(third)) << "on one thread";
}

// Between two moments next to each other, no mesh appears or disappears, also not where a loop begins again.
void expectNoJumps(const CloudSequence& sequence) {
  constexpr int kSteps = 32;  // per frame
  const auto weightsAt = [&](int step) {
    std::vector<double> weights(sequence.segments.size());
    const double seconds = (step + 0.5) / kSteps / sequence.frames_per_second;
    for (const SeenSegment& seen : seenAt(sequence, seconds)) {
      const SequenceSegment& segment = sequence.segments[seen.segment];
      EXPECT_TRUE(seen.frame >= segment.first() && seen.frame <= segment.last()) << seconds;
      weights[seen.segment] += double(seen.weight);
    }
    return weights;
  };
  const int steps = int(sequence.period) * kSteps;
  for (int step = 0; step < steps; ++step) {
    const std::vector<double> now = weightsAt(step), next = weightsAt((step + 1) % steps);
    for (size_t s = 0; s < now.size(); ++s) EXPECT_NEAR(now[s], next[s], 0.1) << "frame " << double(step) / kSteps;
  }
}

TEST_F(SequenceTest, FadesOfALoopDoNotOverlap) {
  for (const int birth : {1, 3, 4, 5, 8, 11}) {  // of a second ball
    SCOPED_TRACE(birth);
    write(13, [&](int i) {
      const SurfaceMesh ball = ballMesh(1, 3, {0.02F * float(i), 0, 0});
      return i < birth ? ball : merged(ball, ballMesh(0.5F, 3, {2.5F, 0, 0}));
    });
    const CloudSequence sequence = baked({"loop", "fade=3"}).sequence;
    EXPECT_EQ(sequence.period, 9);
    EXPECT_EQ(sequence.segments.front().first(), 0);
    EXPECT_EQ(sequence.segments.back().last(), 12);
    expectNoJumps(sequence);
  }
}

TEST_F(SequenceTest, LoopsFadeTheirEnd) {
  write(9, [](int i) { return ballMesh(1 + 0.05F * float(i), 3); });
  const BakedSequence sequence = baked({"loop", "fade=3"});
  EXPECT_TRUE(sequence.sequence.loops);
  EXPECT_EQ(sequence.sequence.period, 5);
  EXPECT_EQ(seenAt(sequence.sequence, 6.0 / 24).size(), 2U);
}

TEST_F(SequenceTest, AnAnimationHasAFramePerMoment) {
  writeBall({1, 2, 3}, {0, 0.5F, 1});
  EXPECT_TRUE(mayBeAnimated(file("ball.glb")));
  EXPECT_FALSE(mayBeAnimated(file("missing.glb")));
  EXPECT_FALSE(mayBeAnimated(file("cache")));
  const AnimationFrames usual = animation();
  ASSERT_EQ(usual.frames.size(), 49U);
  EXPECT_EQ(usual.frames_per_second, 24);
  EXPECT_EQ(usual.frames[12].moment->seconds, 0.5);
  EXPECT_EQ(usual.frames[12].frame, 12);
  EXPECT_EQ(usual.frames[12].name, file("ball.glb").string() + ", frame 12");
  EXPECT_EQ(animation({"fps=10"}).frames.size(), 21U);
  const AnimationFrames five = animation({"frame-count=5"});
  ASSERT_EQ(five.frames.size(), 5U);
  EXPECT_EQ(five.frames[3].moment->seconds, 1.5);
  EXPECT_EQ(five.frames_per_second, 2) << "it takes as long as the animation";
  EXPECT_EQ(animation({"frame-count=5", "fps=8"}).frames_per_second, 8) << "it is shown faster";
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] { animation({"fps=0.1"}); }),
                       "ball.glb: at 0.1 frames per second, its animation of 2 seconds makes 1, and"));
  EXPECT_TRUE(contains(refusalOf<InputError>([&] { animation({"animation=Walk"}); }), "has no animation 'Walk'"));
  writeBall({0, 1e6F}, {0, 1});
  EXPECT_TRUE(contains(refusalOf<UsageError>([&] { animation(); }),
                       "its animation of 1e+06 seconds makes 24000001, and a sequence has 2 to 10000"));
}

// Its radius is 1 + the weight.
TEST_F(SequenceTest, AMorphingBallIsFollowed) {
  writeBall({0, 0.25F}, {0, 1});
  const BakedSequence first = bakedAnimation(), second = bakedAnimation();
  ASSERT_EQ(first.sequence.segments.size(), 1U);
  EXPECT_EQ(first.frames.size(), 7U);
  EXPECT_EQ(first.frames[3].name, file("ball.glb").string() + ", frame 3");
  for (const SequenceKey& key : first.sequence.segments.front().keys) {
    const float radius = 1 + float(key.frame) / 6;
    for (size_t v = 0; v < key.positions.size(); ++v) {
      EXPECT_NEAR(length(key.positions[v]), radius, 0.03F * radius);
      EXPECT_NEAR(key.lobes[v].thickness, 2 * radius, 0.15F * radius);
    }
  }
  const auto keptOf = [](const BakedSequence& sequence) {
    return std::count_if(sequence.frames.begin(), sequence.frames.end(), [](const FrameFigures& frame) { return frame.was_kept; });
  };
  EXPECT_EQ(keptOf(first), 0);
  EXPECT_EQ(keptOf(second), 7);
  EXPECT_EQ(encodeSequence(first.sequence, SequenceForm::kMorph), encodeSequence(second.sequence, SequenceForm::kMorph));
  EXPECT_LE(keptOf(bakedAnimation({"fps=48"})), 1) << "frames at other times are others";
}

TEST_F(SequenceTest, NamesTheMomentThatCannotBeRead) {
  writeBall({0, 0.25F, 0.375F}, {0, 1, 3e38F});
  EXPECT_TRUE(contains(refusalOf<InputError>([&] { bakedAnimation(); }), "ball.glb, frame 9: "));
}

TEST_F(SequenceTest, NamesTheFrameThatCannotBeFollowed) {
  write(3, [](int i) {
    SurfaceMesh ball = ballMesh(1, 3);
    if (i == 2) ball.triangles.resize(ball.triangles.size() / 2);
    return ball;
  });
  EXPECT_TRUE(contains(refusalOf<InputError>([&] { baked({"close=reject"}); }), "b.002.obj: "));
}

}  // namespace
}  // namespace cloudbake
