// Skinned meshes are baked in the pose of their joints, and their lobes are stored in bind space.
#include <cmath>
#include <functional>

#include "tests/io/gltf/gltf_helpers.h"

using namespace cloudbake;

namespace {

const std::vector<Vec3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

// Column-major, as glTF stores it.
std::vector<float> floatsOfMatrix(const Affine& m) {
  std::vector<float> floats;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) floats.push_back(r == 3 ? float(c == 3) : c == 3 ? float(m.offset[r]) : float(m.linear[r][c]));
  return floats;
}

struct Influence {
  uint8_t joint = 0;
  float weight = 1;
};

// A tetrahedron under node 0, with a normal per corner. Joints are nodes that the test adds.
struct SkinBuilder : GltfBuilder {
  explicit SkinBuilder(Json mesh_node = Json::object()) {
    Json primitive = tetrahedron();
    primitive["attributes"]["NORMAL"] = accessor(std::vector<float>{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0.6F, 0.8F}, 5126, "VEC3", 4);
    mesh({primitive});
    mesh_node["mesh"] = 0;
    node(mesh_node);
    json["scenes"].push_back({{"nodes", {0}}});
  }
  Json& attributes() { return json["meshes"][0]["primitives"][0]["attributes"]; }
  int root(Json value) {
    const int index = node(std::move(value));
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }
  void skin(const std::vector<int>& joints, const std::vector<Affine>& inverse_bind = {}) {
    Json skin = {{"joints", joints}};
    std::vector<float> floats;
    for (const Affine& m : inverse_bind)
      for (const float x : floatsOfMatrix(m)) floats.push_back(x);
    if (!floats.empty()) skin["inverseBindMatrices"] = accessor(floats, 5126, "MAT4", inverse_bind.size(), 0);
    json["skins"].push_back(skin);
    json["nodes"][0]["skin"] = json["skins"].size() - 1;
  }
  // Up to four influences per corner.
  void bind(const std::vector<std::vector<Influence>>& corners, int set = 0) {
    std::vector<uint8_t> joints;
    std::vector<float> weights;
    for (const auto& influences : corners)
      for (size_t i = 0; i < 4; ++i) {
        joints.push_back(i < influences.size() ? influences[i].joint : uint8_t(0));
        weights.push_back(i < influences.size() ? influences[i].weight : 0);
      }
    attributes()["JOINTS_" + std::to_string(set)] = accessor(joints, 5121, "VEC4", 4);
    attributes()["WEIGHTS_" + std::to_string(set)] = accessor(weights, 5126, "VEC4", 4);
  }
};

const Json kMoved = {{"translation", {1, 2, 3}}, {"rotation", {0.5, 0.5, 0.5, 0.5}}, {"scale", {2, 3, -4}}};

// M·(o·d) must be the lobe, by a matrix that the test computes itself.
void expectStored(const Trip& trip, const std::vector<Affine>& maps) {
  const Json& attributes = attributesOf(trip.json, 0);
  const auto first = floatsOf(trip, attributes["TEXCOORD_0"], 2), second = floatsOf(trip, attributes["TEXCOORD_1"], 2);
  for (size_t v = 0; v < 4; ++v) {
    const Lobe& lobe = trip.lobes[0][v];
    const Vec3 stored = Vec3{first[2 * v], first[2 * v + 1], second[2 * v]} * second[2 * v + 1];
    EXPECT_LT(length(transformVector(maps[v], stored) - lobe.direction * lobe.thickness), 1e-5F * lobe.thickness) << v;
    EXPECT_LT(length(trip.baked.surface.positions[v] - transformPoint(maps[v], kCorners[v])), 1e-5F) << v;
  }
}

Affine blended(const Affine& a, const Affine& b, double weight) {
  Affine m;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m.linear[r][c] = (1 - weight) * a.linear[r][c] + weight * b.linear[r][c];
    m.offset[r] = (1 - weight) * a.offset[r] + weight * b.offset[r];
  }
  return m;
}

}  // namespace

// One rigid joint is the same as a node: not a bit differs, wherever the node of the skinned mesh is.
TEST(Skin, ARigidJointIsLikeANode) {
  const TestFolder folder;
  SkinBuilder plain(kMoved);
  const Trip expected = roundTrip(folder, "plain.glb", plain.glb());
  SkinBuilder skinned(Json{{"translation", {50, 60, 70}}, {"scale", {0.01, 0.01, 0.01}}});
  skinned.skin({skinned.root(kMoved)});
  skinned.bind({{{0, 1}}, {{0, 1}}, {{0, 1}}, {{0, 1}}});
  const Trip trip = roundTrip(folder, "a.glb", skinned.glb(), {}, false);
  expectSameLobes(trip);
  EXPECT_EQ(trip.baked.surface.positions, expected.baked.surface.positions);
  EXPECT_EQ(trip.baked.surface.normals, expected.baked.surface.normals);
  EXPECT_EQ(trip.baked.surface.triangles, expected.baked.surface.triangles);
  EXPECT_EQ(floatsOf(trip, attributesOf(trip.json, 0)["TEXCOORD_0"], 2),
            floatsOf(expected, attributesOf(expected.json, 0)["TEXCOORD_0"], 2));
  EXPECT_EQ(floatsOf(trip, attributesOf(trip.json, 0)["TEXCOORD_1"], 2),
            floatsOf(expected, attributesOf(expected.json, 0)["TEXCOORD_1"], 2));
  EXPECT_GT(signedVolume(trip.baked.surface.positions, trip.baked.surface.triangles), 0);
  EXPECT_TRUE(trip.warnings.empty());
  EXPECT_NE(trip.sculpt.frame_note.find("; 1 skinned node posed by joints"), std::string::npos) << trip.sculpt.frame_note;
  EXPECT_EQ(trip.json["nodes"], skinned.json["nodes"]);
}

// Joints below joints and below a moved, turned and scaled armature, with inverse bind matrices.
TEST(Skin, JointsFollowTheirAncestors) {
  const TestFolder folder;
  SkinBuilder gltf(Json{{"scale", {0, 0, 0}}});
  const int armature = gltf.root({{"translation", {1, 0, 0}}, {"scale", {2, 2, 2}}});
  const int upper = gltf.node({{"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}});
  const int lower = gltf.node({{"translation", {0, 5, 0}}, {"scale", {1, 3, 1}}});
  gltf.json["nodes"][size_t(armature)]["children"] = {upper};
  gltf.json["nodes"][size_t(upper)]["children"] = {lower};
  const Affine inverse_bind{{{{1, 0, 0}, {0, 0.5, 0}, {0, 0, 1}}}, {0, -2, 0}};
  gltf.skin({upper, lower}, {Affine{}, inverse_bind});
  gltf.bind({{{0, 1}}, {{1, 1}}, {{1, 1}}, {{0, 1}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb(), {}, false);
  expectSameLobes(trip);
  // upper: x → 1 − 2y, y → 2x, z → 2z. lower: upper after (x, 5 + 3y, z), after the inverse bind matrix.
  const Affine of_upper{{{{0, -2, 0}, {2, 0, 0}, {0, 0, 2}}}, {1, 0, 0}};
  const Affine of_lower = compose(compose(of_upper, Affine{{{{1, 0, 0}, {0, 3, 0}, {0, 0, 1}}}, {0, 5, 0}}), inverse_bind);
  expectStored(trip, {of_upper, of_lower, of_lower, of_upper});
  // Normals by the inverse transpose.
  Affine transpose;
  const Affine inverse = *inverted(of_lower);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) transpose.linear[r][c] = inverse.linear[c][r];
  EXPECT_LT(length(trip.baked.surface.normals[1] - *normalized(transformVector(transpose, {0, 1, 0}))), 1e-6F);
}

TEST(Skin, BlendsJointsOfEverySet) {
  const TestFolder folder;
  SkinBuilder gltf;
  const int a = gltf.root({{"translation", {0, 0, 4}}});
  const int b = gltf.root({{"scale", {3, 1, 2}}, {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}});
  gltf.skin({a, b});
  gltf.bind({{{0, 0.75F}, {1, 0.25F}}, {{0, 0.5F}}, {{1, 2}, {0, 6}}, {{1, 1}}});  // corner 1 goes on in set 1, corner 2 sums to 8
  gltf.bind({{}, {{1, 0.5F}}, {}, {}}, 1);
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb(), {}, false);
  expectSameLobes(trip);
  const Affine of_a{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 4}}, of_b{{{{0, 0, 2}, {0, 1, 0}, {-3, 0, 0}}}, {0, 0, 0}};
  expectStored(trip, {blended(of_a, of_b, 0.25), blended(of_a, of_b, 0.5), blended(of_a, of_b, 0.25), of_b});
}

TEST(Skin, ReadsWeightsAndJointsOfEveryType) {
  const TestFolder folder;
  const Affine up{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 8, 0}};
  for (const int type : {5121, 5123}) {
    SkinBuilder gltf;
    const int lower = gltf.root(Json::object()), upper = gltf.node({{"translation", {0, 8, 0}}});
    gltf.json["nodes"][size_t(lower)]["children"] = {upper};
    gltf.skin({lower, upper});
    std::vector<uint16_t> joints, weights;
    for (int v = 0; v < 4; ++v)
      for (const int i : {0, 1, 0, 0}) joints.push_back(uint16_t(i)), weights.push_back(0);
    for (size_t v = 0; v < 4; ++v)
      weights[4 * v] = uint16_t(type == 5121 ? 204 : 52428), weights[4 * v + 1] = uint16_t(type == 5121 ? 51 : 13107);
    const std::vector<uint8_t> narrow_joints(joints.begin(), joints.end()), narrow(weights.begin(), weights.end());
    gltf.attributes()["JOINTS_0"] = type == 5121 ? gltf.accessor(narrow_joints, 5121, "VEC4", 4) : gltf.accessor(joints, 5123, "VEC4", 4);
    gltf.attributes()["WEIGHTS_0"] = type == 5121 ? gltf.accessor(narrow, 5121, "VEC4", 4) : gltf.accessor(weights, 5123, "VEC4", 4);
    gltf.json["accessors"].back()["normalized"] = true;
    const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
    expectSameLobes(trip);
    expectStored(trip, std::vector<Affine>(4, blended(Affine{}, up, 0.2)));
  }
}

// A mesh that two nodes draw with two skins has two poses.
TEST(Skin, TwoSkinsPoseOneMeshTwice) {
  const TestFolder folder;
  SkinBuilder gltf;
  gltf.bind({{{0, 1}}, {{0, 1}}, {{0, 1}}, {{0, 1}}});
  gltf.root({{"mesh", 0}, {"skin", 1}});
  const int left = gltf.root({{"translation", {-5, 0, 0}}}), right = gltf.root({{"translation", {5, 0, 0}}, {"scale", {2, 2, 2}}});
  gltf.json["skins"] = Json::array({{{"joints", {left}}}, {{"joints", {right}}}});
  gltf.json["nodes"][0]["skin"] = 0;
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);
  ASSERT_EQ(trip.baked.surface.positions.size(), 8U);
  EXPECT_EQ(trip.baked.surface.positions[1], (Vec3{-4, 0, 0}));
  EXPECT_EQ(trip.baked.surface.positions[5], (Vec3{7, 0, 0}));
  EXPECT_NE(trip.json["nodes"][0]["mesh"], trip.json["nodes"][1]["mesh"]);
  EXPECT_NE(trip.sculpt.frame_note.find("2 skinned nodes"), std::string::npos);
}

// A mesh without joints cannot be posed: its node places it, and that is counted.
TEST(Skin, WithoutJointsTheNodePlacesTheMesh) {
  const TestFolder folder;
  SkinBuilder gltf(Json{{"translation", {3, 0, 0}}});
  gltf.skin({gltf.root({{"translation", {0, 9, 0}}})});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb(), {}, false);
  expectSameLobes(trip);
  EXPECT_EQ(trip.baked.surface.positions[1], (Vec3{4, 0, 0}));
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kPoseIgnored), 1U);
}

TEST(Skin, FlattenedAndWeightlessVerticesKeepALobe) {
  const TestFolder folder;
  SkinBuilder gltf;
  // Half a turn between the joints: their mean flattens everything onto the x axis. Joint 2 hides what it has.
  const int a = gltf.root({{"scale", {2, 2, 2}}}), b = gltf.root({{"scale", {2, 2, 2}}, {"rotation", {1, 0, 0, 0}}}),
            hidden = gltf.root({{"scale", {0, 0, 0}}, {"translation", {0, 3, 0}}});
  gltf.skin({a, b, hidden});
  gltf.bind({{{0, 0.5F}, {1, 0.5F}}, {{1, 0}}, {{2, 1}}, {{0, 1}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb(), {}, false);
  expectSameLobes(trip);
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kJointFallback), 3U);
  EXPECT_EQ(trip.baked.surface.positions[0], (Vec3{0, 0, 0}));
  EXPECT_EQ(trip.baked.surface.positions[1], (Vec3{2, 0, 0}));  // its first joint, 1
  EXPECT_EQ(trip.baked.surface.positions[2], (Vec3{0, 3, 0}));
  EXPECT_EQ(trip.sculpt.parts[0].vertex_to_scene[0].linear[1][1], 2);
  EXPECT_EQ(trip.sculpt.parts[0].vertex_to_scene[2].linear[1][1], 1);
}

// A mirrored joint turns its own triangles round, so that they face outwards again.
TEST(Skin, MirroredJointsTurnTheirTriangles) {
  const TestFolder folder;
  SkinBuilder gltf;
  gltf.skin({gltf.root({{"scale", {-1, 1, 1}}})});
  gltf.bind({{{0, 1}}, {{0, 1}}, {{0, 1}}, {{0, 1}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  EXPECT_NEAR(signedVolume(trip.baked.surface.positions, trip.baked.surface.triangles), 1.0 / 6, 1e-6);
}

TEST(Skin, RefusesDamagedSkins) {
  const TestFolder folder;
  const auto refuse = [&](const std::function<void(SkinBuilder&)>& damage, const std::string& text) {
    SkinBuilder gltf;
    gltf.skin({gltf.root(Json::object())}, {Affine{}});
    gltf.bind({{{0, 1}}, {{0, 1}}, {{0, 1}}, {{0, 1}}});
    damage(gltf);
    Warnings warnings;
    expectError<InputError>([&] { readMesh(folder.write("a.glb", gltf.glb()), {}, warnings); }, text);
  };
  refuse([](SkinBuilder& g) { g.bind({{}, {}, {{7, 0}}, {}}); }, "vertex 2 uses joint 7 of 1");
  refuse([](SkinBuilder& g) { g.bind({{{0, -1}}, {}, {}, {}}); }, "vertex 0 has a weight that is negative or not finite");
  refuse([](SkinBuilder& g) { g.bind({{{0, NAN}}, {}, {}, {}}); }, "vertex 0 has a weight that is negative or not finite");
  refuse([](SkinBuilder& g) { g.attributes().erase("WEIGHTS_0"); }, "has JOINTS_0 but no WEIGHTS_0");
  refuse([](SkinBuilder& g) { g.attributes()["JOINTS_0"] = g.attributes()["WEIGHTS_0"]; }, "not unsigned integers");
  refuse([](SkinBuilder& g) { g.json["accessors"][g.attributes()["WEIGHTS_0"].get<size_t>()]["count"] = 3; }, "another number of vertices");
  refuse([](SkinBuilder& g) { g.json["nodes"][0]["skin"] = 4; }, "skin 4 does not exist");
  refuse([](SkinBuilder& g) { g.json["skins"][0]["joints"] = {0, 1}; }, "2 joints but 1 inverse bind matrices");
  refuse([](SkinBuilder& g) { g.json["skins"][0]["joints"] = {9}; }, "joint 0 of skin 0 is node 9");
  refuse([](SkinBuilder& g) { g.skin({1}, {Affine{{{{NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}}}); }, "is not finite");
}
