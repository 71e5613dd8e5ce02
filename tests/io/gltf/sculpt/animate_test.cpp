// Moments of animations, against positions that the tests work out themselves.
#include "io/gltf/sculpt/animate.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/io/gltf/gltf_helpers.h"

using namespace cloudbake;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const std::vector<Vec3> kAtRest{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

// A tetrahedron under node 0, and an animation to which channels are added.
struct AnimatedBuilder : GltfBuilder {
  explicit AnimatedBuilder(Json mesh_node = Json::object()) {
    mesh({tetrahedron()});
    mesh_node["mesh"] = 0;
    node(std::move(mesh_node));
    json["scenes"].push_back({{"nodes", {0}}});
    json["animations"] = Json::array();
    add("Move");
  }
  void add(const std::string& name) {
    json["animations"].push_back({{"name", name}, {"channels", Json::array()}, {"samplers", Json::array()}});
  }
  Json& animation() { return json["animations"].back(); }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }
  void channel(const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
               const std::string& interpolation = "LINEAR", int of_node = 0) {
    const int input = accessor(times, 5126, "SCALAR", times.size(), 0);
    json["accessors"].back()["min"] = {times.front()};
    json["accessors"].back()["max"] = {times.back()};
    const size_t width = path == "weights" ? 1 : path == "rotation" ? 4 : 3;
    const int output = accessor(values, 5126, width == 1 ? "SCALAR" : width == 4 ? "VEC4" : "VEC3", values.size() / width, 0);
    animation()["channels"].push_back({{"sampler", animation()["samplers"].size()}, {"target", {{"node", of_node}, {"path", path}}}});
    animation()["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  }
  // Adds a morph target.
  void target(const std::vector<Vec3>& moves) {
    const int position = accessor(moves, 5126, "VEC3", 4);
    primitive()["targets"].push_back({{"POSITION", position}});
  }

  Sculpt at(double seconds, const std::string& name = "") {
    ReadSettings settings;
    settings.moment = {name, seconds};
    warnings = {};
    return readMesh("walk.glb", glb(), settings, warnings);
  }
  // Corners in the scene.
  std::vector<Vec3> cornersAt(double seconds) { return surfaceInScene(at(seconds)).positions; }
  Vec3 firstAt(double seconds) { return cornersAt(seconds).front(); }
  std::string refusal(const std::string& name = "") {
    try {
      at(0, name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  Warnings warnings;
};

void expectNear(Vec3 found, Vec3 wanted, float tolerance = 1e-6F) {
  EXPECT_NEAR(found.x, wanted.x, tolerance);
  EXPECT_NEAR(found.y, wanted.y, tolerance);
  EXPECT_NEAR(found.z, wanted.z, tolerance);
}

bool contains(const std::string& text, const std::string& piece) {
  EXPECT_NE(text.find(piece), text.npos) << text;
  return text.find(piece) != text.npos;
}

}  // namespace

TEST(Animate, LinearKeysAreBlendedAndHeldOutside) {
  AnimatedBuilder gltf;
  gltf.channel("translation", {1, 2, 4}, {0, 0, 0, 2, 4, 6, 4, 4, 4});
  EXPECT_EQ(gltf.at(0).animation_seconds, 3);
  EXPECT_TRUE(gltf.warnings.empty());
  expectNear(gltf.firstAt(0), {0, 0, 0});
  expectNear(gltf.firstAt(0.25), {0.5F, 1, 1.5F});
  expectNear(gltf.firstAt(1), {2, 4, 6});
  expectNear(gltf.firstAt(2.5), {3.5F, 4, 4.5F});
  expectNear(gltf.firstAt(9), {4, 4, 4});
}

// The earliest key of all channels is the start, and a channel that begins later waits at its first key.
TEST(Animate, ChannelsShareTheirTime) {
  AnimatedBuilder gltf(Json{{"scale", {9, 9, 9}}});
  gltf.channel("translation", {1, 3}, {0, 0, 0, 2, 0, 0});
  gltf.channel("scale", {2, 5}, {1, 1, 1, 4, 1, 1});
  EXPECT_EQ(gltf.at(0).animation_seconds, 4);
  expectNear(gltf.cornersAt(0.5)[1], {1.5F, 0, 0});
  expectNear(gltf.cornersAt(2)[1], {4, 0, 0});
  expectNear(gltf.cornersAt(4)[1], {6, 0, 0});
}

TEST(Animate, StepsStayUntilTheNextKey) {
  AnimatedBuilder gltf;
  gltf.channel("translation", {0, 1, 2}, {1, 0, 0, 2, 0, 0, 3, 0, 0}, "STEP");
  EXPECT_EQ(gltf.firstAt(0.99).x, 1);
  EXPECT_EQ(gltf.firstAt(1).x, 2);
  EXPECT_EQ(gltf.firstAt(1.99).x, 2);
  EXPECT_EQ(gltf.firstAt(2).x, 3);
}

// The formula of appendix C.5 with numbers put in by hand. A cubic polynomial is its own spline.
TEST(Animate, CubicSplinesFollowTheirTangents) {
  const auto x = [](double t) { return float(t * t * t - 2 * t * t + 3); };
  const auto slope = [](double t) { return float(3 * t * t - 4 * t); };
  AnimatedBuilder gltf;
  std::vector<float> values;
  for (const float t : {0.0F, 2.0F, 3.0F})
    for (const float value : {slope(t), x(t), slope(t)}) values.insert(values.end(), {value, -value, 0});
  gltf.channel("translation", {0, 2, 3}, values, "CUBICSPLINE");
  for (const double t : {0.0, 0.3, 1.0, 1.9, 2.0, 2.5, 3.0}) expectNear(gltf.firstAt(t), {x(t), -x(t), 0}, 3e-6F);

  AnimatedBuilder broken;  // another slope after the key than before it
  broken.channel("translation", {0, 2, 3}, {9, 9, 9, 0, 0, 0, 1, 0, 0, -1, 0, 0, 4, 0, 0, 2, 0, 0, 0, 0, 0, 5, 0, 0, 9, 9, 9},
                 "CUBICSPLINE");
  EXPECT_NEAR(broken.firstAt(1).x, 0.125 * 2 * 1 + 0.5 * 4 - 0.125 * 2 * -1, 1e-6);
  EXPECT_NEAR(broken.firstAt(2.5).x, 0.5 * 4 + 0.125 * 2 + 0.5 * 5, 1e-6);
}

TEST(Animate, RotationsTurnEvenlyAndTheShorterWay) {
  const float half = std::sqrt(0.5F);
  AnimatedBuilder gltf;
  gltf.channel("rotation", {0, 3}, {0, 0, 0, 1, 0, 0, -half, -half});  // 90°, by the quaternion of the longer way
  for (const double t : {0.0, 1.0, 1.5, 2.7, 3.0}) {
    const double angle = t * std::numbers::pi / 6;
    expectNear(gltf.cornersAt(t)[1], {float(std::cos(angle)), float(std::sin(angle)), 0});
  }
  // A cubic one blends the numbers, here without tangents, and makes them unit.
  AnimatedBuilder cubic;
  cubic.channel("rotation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, half, half, 0, 0, 0, 0}, "CUBICSPLINE");
  for (const double t : {0.0, 0.4, 1.0}) {
    const double share = 3 * t * t - 2 * t * t * t, angle = 2 * std::atan2(share * half, 2 * (1 - share) + share * half);
    expectNear(cubic.cornersAt(t)[1], {float(std::cos(angle)), float(std::sin(angle)), 0});
  }
}

TEST(Animate, MorphWeightsMoveCorners) {
  AnimatedBuilder gltf(Json{{"weights", {1, 1}}});
  gltf.target({{1, 0, 0}, {}, {}, {}});
  gltf.target({{0, 2, 0}, {0, 0, 3}, {}, {}});
  gltf.channel("weights", {0, 1}, {0, 0, 1, 0.5F});
  EXPECT_EQ(gltf.cornersAt(0), kAtRest);
  expectNear(gltf.cornersAt(0.5)[0], {0.5F, 0.5F, 0});
  expectNear(gltf.cornersAt(1)[1], {1, 0, 1.5F});
  EXPECT_TRUE(gltf.warnings.empty());
}

// Two bones, the lower below the upper, with inverse bind matrices; the test multiplies the matrices itself.
TEST(Animate, BonesCarryTheirSkin) {
  AnimatedBuilder gltf;
  const int upper = gltf.node({{"translation", {0, 1, 0}}, {"children", {2}}}), lower = gltf.node({{"translation", {0, 2, 0}}});
  gltf.json["scenes"][0]["nodes"].push_back(upper);
  const std::vector<float> inverse_bind{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -3, 0, 1};
  gltf.json["skins"].push_back({{"joints", {upper, lower}}, {"inverseBindMatrices", gltf.accessor(inverse_bind, 5126, "MAT4", 2, 0)}});
  gltf.json["nodes"][0]["skin"] = 0;
  gltf.json["nodes"][0]["translation"] = {50, 60, 70};  // has no effect
  Json& attributes = gltf.primitive()["attributes"];
  attributes["JOINTS_0"] = gltf.accessor(std::vector<uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] =
      gltf.accessor(std::vector<float>{1, 0, 0, 0, 0.25F, 0.75F, 0, 0, 0.5F, 0.5F, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
  const float half = std::sqrt(0.5F);
  gltf.channel("rotation", {0, 1}, {0, 0, 0, 1, 0, 0, half, half}, "LINEAR", lower);  // 90° about z
  gltf.channel("translation", {0, 1}, {0, 1, 0, 1, 1, 0}, "LINEAR", upper);
  for (const double t : {0.0, 0.5, 1.0}) {
    const double angle = t * std::numbers::pi / 2, sin = std::sin(angle), cos = std::cos(angle);
    const auto byUpper = [&](Vec3 p) { return Vec3{float(p.x + t), p.y, p.z}; };
    const auto byLower = [&](Vec3 p) { return Vec3{float(cos * p.x - sin * (p.y - 3) + t), float(sin * p.x + cos * (p.y - 3) + 3), p.z}; };
    const std::vector<Vec3> found = gltf.cornersAt(t);
    expectNear(found[0], byUpper(kAtRest[0]));
    expectNear(found[1], byUpper(kAtRest[1]) * 0.25F + byLower(kAtRest[1]) * 0.75F);
    expectNear(found[2], byUpper(kAtRest[2]) * 0.5F + byLower(kAtRest[2]) * 0.5F);
    expectNear(found[3], byLower(kAtRest[3]));
  }
}

TEST(Animate, ReadsNormalisedNumbers) {
  AnimatedBuilder gltf;
  gltf.target({{1, 0, 0}, {}, {}, {}});
  gltf.channel("weights", {0, 1}, {0, 1});
  gltf.json["accessors"].push_back(gltf.json["accessors"].back());
  const int output = gltf.accessor(std::vector<uint8_t>{0, 51}, 5121, "SCALAR", 2, 0);
  gltf.json["accessors"].back()["normalized"] = true;
  gltf.animation()["samplers"][0]["output"] = output;
  EXPECT_FLOAT_EQ(gltf.firstAt(1).x, 0.2F);
}

TEST(Animate, AnAnimationIsChosenByItsName) {
  AnimatedBuilder gltf;
  gltf.channel("translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  gltf.add("Jump");
  gltf.channel("translation", {0, 2}, {0, 0, 0, 0, 5, 0});
  gltf.add("");
  gltf.channel("translation", {0, 1}, {0, 0, 0, 0, 0, 7});
  expectNear(gltf.firstAt(1), {1, 0, 0});
  EXPECT_EQ(gltf.at(0, "Jump").animation_seconds, 2);
  expectNear(surfaceInScene(gltf.at(2, "Jump")).positions[0], {0, 5, 0});
  expectNear(surfaceInScene(gltf.at(1, "animation 2")).positions[0], {0, 0, 7});
  EXPECT_TRUE(
      contains(gltf.refusal("Run"), "walk.glb: it has no animation 'Run': for --animation, give one of 'Move', 'Jump', 'animation 2'"));
}

TEST(Animate, RefusesFilesInWhichNothingMoves) {
  EXPECT_TRUE(contains(AnimatedBuilder().refusal(), "its animation 'Move' moves none of the meshes"));
  AnimatedBuilder camera;
  camera.channel("translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "LINEAR", camera.node(Json::object()));
  EXPECT_TRUE(contains(camera.refusal(), "moves none of the meshes that are baked: export it with"));
  camera.add("Walk");
  EXPECT_TRUE(contains(camera.refusal(), "for --animation, give one of 'Move', 'Walk'"));
  AnimatedBuilder still;
  still.channel("translation", {0, 1}, {1, 2, 3, 1, 2, 3});
  EXPECT_TRUE(contains(still.refusal(), "moves none"));
  AnimatedBuilder none;
  none.json.erase("animations");
  EXPECT_TRUE(contains(none.refusal(), "walk.glb: it has no animation: export it with one"));
  AnimatedBuilder parent;  // of the mesh
  parent.node({{"children", {0}}});
  parent.json["scenes"][0]["nodes"] = {1};
  parent.channel("translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "LINEAR", 1);
  EXPECT_EQ(parent.refusal(), "");
}

TEST(Animate, CountsChannelsThatMoveNoNode) {
  AnimatedBuilder gltf;
  gltf.channel("translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  gltf.animation()["channels"].push_back(
      {{"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/x"}}}}}}}});
  gltf.at(0);
  EXPECT_EQ(gltf.warnings.entries().at(WarningKind::kPoseIgnored).count, 1U);
}

TEST(Animate, DamagedAnimationsAreNamed) {
  const auto refusal = [](const std::function<void(AnimatedBuilder&)>& damage) {
    AnimatedBuilder gltf;
    gltf.channel("translation", {0, 1}, {0, 0, 0, 1, 0, 0});
    damage(gltf);
    return gltf.refusal();
  };
  const auto ofSampler = [&](const char* key, const Json& value) {
    return refusal([&](AnimatedBuilder& gltf) { gltf.animation()["samplers"][0][key] = value; });
  };
  const auto ofTimes = [&](const std::vector<float>& times) {
    return refusal(
        [&](AnimatedBuilder& gltf) { gltf.animation()["samplers"][0]["input"] = gltf.accessor(times, 5126, "SCALAR", times.size(), 0); });
  };
  EXPECT_TRUE(contains(ofSampler("output", 99), "walk.glb: animations[0].samplers[0].output: uses an accessor that does not exist"));
  EXPECT_TRUE(contains(ofSampler("input", 0), "animations[0].samplers[0].input: an accessor has the wrong type"));
  EXPECT_TRUE(contains(ofSampler("interpolation", "BEZIER"), "animations[0].samplers[0] has the unknown interpolation 'BEZIER'"));
  EXPECT_TRUE(contains(ofSampler("interpolation", "CUBICSPLINE"), "samplers[0].output has 6 numbers for 2 keys, which need 18"));
  EXPECT_TRUE(contains(ofTimes({0, kNan}), "samplers[0].input has a time that is not finite or not after the one before, at key 1"));
  EXPECT_TRUE(contains(ofTimes({1, 1}), "at key 1"));
  EXPECT_TRUE(contains(ofTimes({0, 1, 2}), "samplers[0].output has 6 numbers for 3 keys, which need 9"));
  EXPECT_TRUE(
      contains(refusal([](AnimatedBuilder& gltf) { gltf.animation()["samplers"][0].erase("input"); }), "uses an accessor that does"));
  EXPECT_TRUE(contains(refusal([](AnimatedBuilder& gltf) { gltf.animation()["channels"][0].erase("sampler"); }),
                       "animations[0].channels[0] uses a sampler that does not exist"));
  EXPECT_TRUE(contains(refusal([](AnimatedBuilder& gltf) { gltf.animation()["channels"][0]["target"]["node"] = 9; }),
                       "channels[0] moves node 9, which does not exist"));
  EXPECT_TRUE(contains(refusal([](AnimatedBuilder& gltf) {
                         gltf.channel("translation", {0}, {0, 0, 0});
                       }),
                       "channels[1] is the second one that moves the translation of node 0"));
  EXPECT_TRUE(
      contains(refusal([](AnimatedBuilder& gltf) { gltf.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }),
               "which has a matrix instead"));
  EXPECT_TRUE(contains(refusal([](AnimatedBuilder& gltf) { gltf.channel("weights", {0}, {0}); }),
                       "moves the morph weights of node 0, which has no morph targets"));
  EXPECT_TRUE(contains(refusal([](AnimatedBuilder& gltf) {
                         gltf.channel("scale", {0}, {1, kNan, 1});
                       }),
                       "samplers[1].output has a value that is not finite, at key 0"));
  EXPECT_TRUE(contains(refusal([](AnimatedBuilder& gltf) {
                         gltf.channel("rotation", {0}, {0, 0, 0, 0});
                       }),
                       "samplers[1].output has a rotation of zeros, at key 0"));
}
