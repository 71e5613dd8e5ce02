// Vertices that --refine added to parts of a glTF: what is stored for them, in which types, and which parts must stay as they are.
#include <array>
#include <cmath>

#include "tests/io/gltf/gltf_helpers.h"

namespace cloudbake {
namespace {

// The components of an accessor as stored, element by element, with the view's stride.
template <class Component>
std::vector<std::vector<Component>> elementsOf(const std::string& glb, int index, size_t width) {
  const GlbChunks chunks = splitGlb("test", glb);
  const Json json = Json::parse(chunks.json);
  const Json& accessor = json["accessors"][size_t(index)];
  const Json& view = json["bufferViews"][accessor["bufferView"].get<size_t>()];
  const size_t stride = view.value("byteStride", width * sizeof(Component));
  EXPECT_EQ(stride % 4, 0U);
  std::vector<std::vector<Component>> elements(accessor["count"].get<size_t>(), std::vector<Component>(width));
  for (size_t i = 0; i < elements.size(); ++i)
    std::memcpy(elements[i].data(), chunks.binary.data() + view["byteOffset"].get<size_t>() + i * stride, width * sizeof(Component));
  return elements;
}

// Adds a vertex in the middle of the edge from 0 to 1, as pipeline/asset/refine.cpp does.
void splitFirstEdge(SculptPart& part) {
  part.midpoints.push_back({0, 1});
  part.positions.push_back(0.5F * (part.positions[0] + part.positions[1]));
  if (!part.normals.empty()) part.normals.push_back(*normalized(part.normals[0] + part.normals[1]));
  part.triangles = {{0, 2, 4}, {4, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 3, 2}, {1, 2, 3}};
}

TEST(GltfMidpoints, EveryAttributeIsBlendedInItsOwnType) {
  GltfBuilder builder;
  Json primitive = builder.tetrahedron({0, 0, 0});
  Json& attributes = primitive["attributes"];
  const float s = std::sqrt(0.5F);
  attributes["NORMAL"] = builder.accessor(std::vector<Vec3>{{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 5126, "VEC3", 4);
  attributes["TANGENT"] =
      builder.accessor(std::vector<std::array<float, 4>>{{1, 0, 0, -1}, {0, 0, 1, -1}, {1, 0, 0, -1}, {1, 0, 0, -1}}, 5126, "VEC4", 4);
  attributes["TEXCOORD_0"] = builder.accessor(std::vector<Vec2>{{0, 1}, {0.5F, 0}, {1, 1}, {0, 0}}, 5126, "VEC2", 4);
  attributes["TEXCOORD_1"] = builder.accessor(std::vector<uint16_t>{0, 65535, 65534, 32767, 7, 9, 11, 13}, 5123, "VEC2", 4);
  builder.json["accessors"].back()["normalized"] = true;
  attributes["COLOR_0"] = builder.accessor(std::vector<uint8_t>{0, 100, 255, 0, 254, 200, 253, 0, 1, 2, 3, 0, 4, 5, 6, 0}, 5121, "VEC3", 4);
  builder.json["accessors"].back()["normalized"] = true;
  builder.json["bufferViews"].back()["byteStride"] = 4;
  attributes["_HEAT"] = builder.accessor(std::vector<float>{1, 4, 0, 0}, 5126, "SCALAR", 4);
  builder.json["materials"] = Json::array({{{"name", "skin"}}});
  primitive["material"] = 0;
  builder.node({{"name", "Body"}, {"mesh", builder.mesh({primitive})}});
  builder.json["scenes"].push_back({{"nodes", {0}}});

  const TestFolder folder;
  Warnings warnings;
  Sculpt sculpt = readMesh(folder.write("a.glb", builder.glb()), {}, warnings);
  ASSERT_EQ(sculpt.parts.at(0).fixed, "");
  splitFirstEdge(sculpt.parts[0]);
  const std::string glb = encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), {}, warnings);
  std::filesystem::create_directories(glbFolder());
  writeFileAtomically(glbFolder() / "EveryAttributeIsBlendedInItsOwnType.glb", glb);  // for the validator

  const Json json = Json::parse(splitGlb("a", glb).json);
  const Json& stored = attributesOf(json, 0);
  EXPECT_EQ(json["nodes"][0]["name"], "Body");
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["material"], 0);
  const auto last = [&](const char* name, auto component, size_t width) {
    const auto elements = elementsOf<decltype(component)>(glb, stored[name], width);
    EXPECT_EQ(elements.size(), 5U) << name;
    return elements.back();
  };
  EXPECT_EQ(last("POSITION", 0.0F, 3), (std::vector<float>{0.5F, 0, 0}));
  const std::vector<float> normal = last("NORMAL", 0.0F, 3), tangent = last("TANGENT", 0.0F, 4);
  const std::array<float, 3> wanted_normal{s, -s, 0};
  const std::array<float, 4> wanted_tangent{s, 0, s, -1};
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(normal[i], wanted_normal[i], 1e-6);
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(tangent[i], wanted_tangent[i], 1e-6);
  EXPECT_EQ(last("TEXCOORD_0", 0.0F, 2), (std::vector<float>{0.25F, 0.5F}));
  EXPECT_EQ(last("TEXCOORD_1", uint16_t(0), 2), (std::vector<uint16_t>{32767, 49151}));
  EXPECT_EQ(last("COLOR_0", uint8_t(0), 3), (std::vector<uint8_t>{127, 150, 254}));
  EXPECT_EQ(last("_HEAT", 0.0F, 1), (std::vector<float>{2.5F}));
  EXPECT_EQ(elementsOf<uint16_t>(glb, stored["TEXCOORD_1"], 2)[2], (std::vector<uint16_t>{7, 9}));
  EXPECT_EQ(elementsOf<uint8_t>(glb, stored["COLOR_0"], 3)[1], (std::vector<uint8_t>{254, 200, 253}));
  EXPECT_TRUE(json["accessors"][stored["COLOR_0"].get<size_t>()]["normalized"].get<bool>());
  EXPECT_EQ(json["accessors"][stored["COLOR_0"].get<size_t>()]["type"], "VEC3");

  Warnings again;
  const Sculpt read = readMesh(folder.write("b.glb", glb), {}, again);
  EXPECT_EQ(read.parts[0].positions, sculpt.parts[0].positions);
  EXPECT_EQ(read.parts[0].triangles, sculpt.parts[0].triangles);
}

TEST(GltfMidpoints, WholeNumbersThatStandForAPlaceGetFractions) {
  GltfBuilder builder;
  Json primitive = builder.tetrahedron({0, 0, 0});
  primitive["attributes"]["POSITION"] =
      builder.accessor(std::vector<int16_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 5122, "VEC3", 4);
  builder.json["bufferViews"].back()["byteStride"] = 8;
  builder.json["accessors"].back()["min"] = {0, 0, 0};
  builder.json["accessors"].back()["max"] = {1, 1, 1};
  primitive["attributes"]["TEXCOORD_0"] = builder.accessor(std::vector<uint16_t>{0, 0, 3, 1, 0, 0, 0, 0}, 5123, "VEC2", 4);
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  builder.node({{"mesh", builder.mesh({primitive})}});
  builder.json["scenes"].push_back({{"nodes", {0}}});
  const TestFolder folder;
  Warnings warnings;
  Sculpt sculpt = readMesh(folder.write("a.glb", builder.glb()), {}, warnings);
  splitFirstEdge(sculpt.parts.at(0));
  const std::string glb = encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), {}, warnings);
  const Json json = Json::parse(splitGlb("a", glb).json);
  EXPECT_EQ(elementsOf<float>(glb, attributesOf(json, 0)["POSITION"], 3).back(), (std::vector<float>{0.5F, 0, 0}));
  EXPECT_EQ(elementsOf<float>(glb, attributesOf(json, 0)["TEXCOORD_0"], 2).back(), (std::vector<float>{1.5F, 0.5F}));
}

TEST(GltfMidpoints, OtherPartsMustStayAsTheyAre) {
  const TestFolder folder;
  const auto fixedWith = [&](const auto& change) {
    GltfBuilder builder;
    Json primitive = builder.tetrahedron({0, 0, 0});
    Json node = {{"name", "Body"}};
    change(builder, primitive);
    if (primitive["attributes"].contains("WEIGHTS_0")) node["skin"] = 0;
    node["mesh"] = builder.mesh({primitive});
    builder.node(node);
    builder.json["scenes"].push_back({{"nodes", {0}}});
    Warnings warnings;
    return readMesh(folder.write("a.glb", builder.glb()), {}, warnings).parts.at(0).fixed;
  };
  EXPECT_EQ(fixedWith([](GltfBuilder&, Json&) {}), "");
  EXPECT_EQ(fixedWith([](GltfBuilder& builder, Json& primitive) {
              primitive["attributes"]["JOINTS_0"] = builder.accessor(std::vector<uint8_t>(16), 5121, "VEC4", 4);
              primitive["attributes"]["WEIGHTS_0"] = builder.accessor(std::vector<std::array<float, 4>>(4, {1, 0, 0, 0}), 5126, "VEC4", 4);
              builder.json["skins"] = {{{"joints", {0}}}};
            }),
            "is skinned");
  EXPECT_EQ(fixedWith([](GltfBuilder& builder, Json& primitive) {
              const int target = builder.accessor(std::vector<Vec3>(4), 5126, "VEC3", 4);
              primitive["targets"] = Json::array({{{"POSITION", target}}});
            }),
            "has morph targets");
  EXPECT_EQ(fixedWith([](GltfBuilder& builder, Json& primitive) {
              primitive["attributes"]["_KIND"] = builder.accessor(std::vector<uint8_t>(16), 5121, "VEC4", 4);
            }),
            "has the attribute _KIND, which cannot be blended");
  EXPECT_EQ(fixedWith([](GltfBuilder& builder, Json& primitive) {
              primitive["attributes"]["_FEATURE_ID_0"] = builder.accessor(std::vector<float>(4), 5126, "SCALAR", 4);
            }),
            "has the attribute _FEATURE_ID_0, which cannot be blended");
  EXPECT_EQ(fixedWith([](GltfBuilder&, Json& primitive) {
              primitive["extensions"] = {{"FB_ngon_encoding", Json::object()}};
            }),
            "has the extension FB_ngon_encoding");
  EXPECT_EQ(fixedWith([](GltfBuilder& builder, Json& primitive) {
              primitive["attributes"]["COLOR_0"] = builder.accessor(std::vector<float>(12), 5126, "VEC3", 3);
            }),
            "has a damaged attribute COLOR_0");
  EXPECT_EQ(fixedWith([](GltfBuilder& builder, Json& primitive) {
              primitive["attributes"]["JOINTS_0"] = builder.accessor(std::vector<uint8_t>(16), 5121, "VEC4", 4);
            }),
            "has the attribute JOINTS_0, which cannot be blended");
}

}  // namespace
}  // namespace cloudbake
