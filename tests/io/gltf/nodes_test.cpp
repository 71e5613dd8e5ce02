// Scenes of a glTF, and nodes that flatten what they draw.
#include "tests/io/gltf/gltf_helpers.h"

using namespace cloudbake;

namespace {

// Two scenes: node 0 in both, node 1 with its child 2 in the second alone.
GltfBuilder twoScenes() {
  GltfBuilder gltf;
  for (const float x : {0.0F, 3.0F, 6.0F}) gltf.mesh({gltf.tetrahedron({x, 0, 0})});
  gltf.node({{"mesh", 0}});
  gltf.node({{"mesh", 1}, {"name", "tower"}, {"children", {2}}});
  gltf.node({{"mesh", 2}});
  gltf.json["scenes"] = Json::array({{{"nodes", {0}}}, {{"nodes", {0, 1}}}});
  return gltf;
}

Sculpt readScene(const TestFolder& folder, const std::string& glb, std::optional<int> scene, Warnings& warnings) {
  ReadSettings settings;
  settings.scene_index = scene;
  return readMesh(folder.write("a.glb", glb), settings, warnings);
}

}  // namespace

TEST(Nodes, PartsOfOtherScenesAreCounted) {
  const TestFolder folder;
  const Trip trip = roundTrip(folder, "a.glb", twoScenes().glb());
  EXPECT_EQ(trip.sculpt.parts.size(), 1U);
  ASSERT_EQ(countOf(trip.warnings, WarningKind::kOtherScene), 2U);
  const std::string& text = trip.warnings.entries().at(WarningKind::kOtherScene).first;
  EXPECT_NE(text.find("node 1 ('tower') is only in scene 1"), std::string::npos) << text;
  EXPECT_NE(text.find("--scene-index 1"), std::string::npos) << text;
  EXPECT_FALSE(attributesOf(trip.json, 1).contains("TEXCOORD_0"));
}

// The chosen scene becomes the asset's default scene, so that whoever reads the asset sees the scene that has lobes.
TEST(Nodes, ASceneCanBeChosen) {
  const TestFolder folder;
  Warnings warnings;
  const Sculpt sculpt = readScene(folder, twoScenes().glb(), 1, warnings);
  EXPECT_EQ(sculpt.parts.size(), 3U);
  EXPECT_TRUE(warnings.empty());
  const std::string glb = encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), {}, warnings);
  EXPECT_EQ(Json::parse(splitGlb("a", glb).json)["scene"], 1);
  EXPECT_EQ(decodeGlb("a.glb", glb, warnings).lobes.size(), 12U);
  EXPECT_EQ(readScene(folder, twoScenes().glb(), 0, warnings).parts.size(), 1U);
}

TEST(Nodes, ASceneThatDoesNotExistIsRefused) {
  const TestFolder folder;
  Warnings warnings;
  expectError<InputError>([&] { readScene(folder, twoScenes().glb(), 2, warnings); }, "there is no scene 2: the file has 2 scenes, 0 to 1");
  expectError<InputError>([&] { readScene(folder, oneTetrahedron().glb(), 1, warnings); }, "the file has 1 scene, 0");
  GltfBuilder none = oneTetrahedron();
  none.json.erase("scenes");
  none.json.erase("scene");
  expectError<InputError>([&] { readScene(folder, none.glb(), 0, warnings); }, "the file has 0 scenes");
  ReadSettings settings;
  settings.scene_index = 0;
  expectError<InputError>([&] { readMesh(folder.write("a.obj", kTetrahedronObj), settings, warnings); }, "leave --scene-index out");
}

// A scale of 0 costs the parts below it, and no others.
TEST(Nodes, AFlatPartIsLeftOut) {
  const TestFolder folder;
  GltfBuilder gltf;
  gltf.mesh({gltf.tetrahedron()});
  gltf.mesh({gltf.tetrahedron({3, 0, 0})});
  gltf.node({{"mesh", 0}});
  gltf.node({{"mesh", 1}, {"name", "flat"}, {"scale", {1, 0, 1}}});
  gltf.json["scenes"].push_back({{"nodes", {1, 0}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);
  ASSERT_EQ(countOf(trip.warnings, WarningKind::kSingularTransform), 1U);
  EXPECT_NE(trip.warnings.entries().at(WarningKind::kSingularTransform).first.find("node 1 ('flat')"), std::string::npos);
  EXPECT_FALSE(attributesOf(trip.json, 1).contains("TEXCOORD_0"));
  EXPECT_TRUE(attributesOf(trip.json, 0).contains("TEXCOORD_0"));
}

// --- KHR_node_visibility ---

namespace {

Json visibility(bool visible) { return {{"KHR_node_visibility", {{"visible", visible}}}}; }

// A visible tower, a hidden group with a visible child and a hidden mesh of its own, and a node that says that it is visible.
GltfBuilder withHidden() {
  GltfBuilder gltf;
  for (const float x : {0.0F, 3.0F, 6.0F, 9.0F}) gltf.mesh({gltf.tetrahedron({x, 0, 0})});
  gltf.node({{"mesh", 0}});
  gltf.node({{"mesh", 1}, {"name", "hull"}, {"children", {2}}, {"extensions", visibility(false)}});
  gltf.node({{"mesh", 2}, {"extensions", visibility(true)}});
  gltf.node({{"mesh", 3}, {"extensions", {{"KHR_node_visibility", Json::object()}}}});
  gltf.json["scenes"] = Json::array({{{"nodes", {0, 1, 3}}}});
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {"KHR_node_visibility"};
  return gltf;
}

}  // namespace

TEST(Nodes, HiddenNodesShadeNothingAndStay) {
  const TestFolder folder;
  const GltfBuilder source = withHidden();
  const Trip trip = roundTrip(folder, "a.glb", withHidden().glb());
  expectSameLobes(trip);
  ASSERT_EQ(trip.sculpt.parts.size(), 2U);
  EXPECT_EQ(trip.sculpt.parts[1].object, 3);
  EXPECT_EQ(trip.baked.surface.positions.size(), 8U);
  ASSERT_EQ(countOf(trip.warnings, WarningKind::kHiddenPart), 2U);
  const std::string& text = trip.warnings.entries().at(WarningKind::kHiddenPart).first;
  EXPECT_NE(text.find("node 1 ('hull') is hidden by KHR_node_visibility"), std::string::npos) << text;
  EXPECT_EQ(trip.json["nodes"], source.json["nodes"]);
  EXPECT_EQ(trip.json["meshes"][1], source.json["meshes"][1]);
  EXPECT_EQ(trip.json["meshes"][2], source.json["meshes"][2]);
  EXPECT_EQ(trip.json["extensionsRequired"], source.json["extensionsRequired"]);
}

TEST(Nodes, AFileWithEverythingHiddenIsRefused) {
  const TestFolder folder;
  GltfBuilder gltf = withHidden();
  gltf.json["scenes"][0]["nodes"] = {1};
  Warnings warnings;
  expectError<InputError>([&] { readMesh(folder.write("a.glb", gltf.glb()), {}, warnings); },
                          "KHR_node_visibility hides every mesh (2 nodes with one); make what is to be baked visible");
}

// glTF ignores the node of a skinned mesh for its place, but not for whether it is seen.
TEST(Nodes, ASkinnedMeshIsHiddenByItsOwnNode) {
  const TestFolder folder;
  const auto skinned = [&](bool mesh_hidden, bool joint_hidden) {
    GltfBuilder gltf;
    Json primitive = gltf.tetrahedron();
    primitive["attributes"]["JOINTS_0"] = gltf.accessor(std::vector<uint8_t>(16, 0), 5121, "VEC4", 4);
    primitive["attributes"]["WEIGHTS_0"] =
        gltf.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
    gltf.mesh({primitive});
    gltf.mesh({gltf.tetrahedron({5, 0, 0})});
    gltf.node({{"mesh", 0}, {"skin", 0}, {"extensions", visibility(!mesh_hidden)}});
    gltf.node({{"translation", {0, 7, 0}}, {"extensions", visibility(!joint_hidden)}});
    gltf.node({{"mesh", 1}});
    gltf.json["skins"] = Json::array({{{"joints", {1}}}});
    gltf.json["scenes"] = Json::array({{{"nodes", {0, 1, 2}}}});
    gltf.json["extensionsUsed"] = {"KHR_node_visibility"};
    return roundTrip(folder, "a.glb", gltf.glb());
  };
  const Trip seen = skinned(false, true);
  ASSERT_EQ(seen.sculpt.parts.size(), 2U);
  EXPECT_EQ(seen.baked.surface.positions[0], (Vec3{0, 7, 0}));
  EXPECT_EQ(countOf(seen.warnings, WarningKind::kHiddenPart), 0U);
  EXPECT_EQ(skinned(true, false).sculpt.parts.size(), 1U);
}

// Instances of a hidden node are not made.
TEST(Nodes, HiddenInstancesStayInstances) {
  const TestFolder folder;
  GltfBuilder gltf = withHidden();
  const int moves = gltf.accessor(std::vector<Vec3>(50), 5126, "VEC3", 50, 0);
  const Json instances = {{"attributes", {{"TRANSLATION", moves}}}};
  gltf.json["nodes"][2]["extensions"]["EXT_mesh_gpu_instancing"] = instances;
  gltf.json["extensionsUsed"].push_back("EXT_mesh_gpu_instancing");
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  EXPECT_EQ(trip.sculpt.parts.size(), 2U);
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kHiddenPart), 2U);
  EXPECT_EQ(trip.json["nodes"], gltf.json["nodes"]);
  EXPECT_EQ(trip.json["extensionsUsed"], gltf.json["extensionsUsed"]);
}

TEST(Nodes, AVisibilityIsTrueOrFalse) {
  const TestFolder folder;
  GltfBuilder gltf = withHidden();
  gltf.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = 0;
  Warnings warnings;
  expectError<InputError>([&] { readMesh(folder.write("a.glb", gltf.glb()), {}, warnings); },
                          "nodes[1].extensions.KHR_node_visibility.visible is 0, not true or false");
}
