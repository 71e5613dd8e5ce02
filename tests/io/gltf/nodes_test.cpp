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
