// Fewer vertices, and everything else as it was.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/gltf/sculpt/read.h"
#include "io/gltf/sculpt/reduce_sculpt.h"
#include "tests/io/gltf/gltf_helpers.h"

namespace cloudbake {
namespace {

// Two nodes share a mesh of two tetrahedra in one primitive, with odd attributes: normalised bytes with a stride, sparse floats, an unknown
// one; the UVs of both primitives are interleaved in one view.
GltfBuilder oddDocument() {
  GltfBuilder b;
  std::vector<Vec3> positions;
  for (const float x : {0.0F, 5.0F})
    for (const Vec3 p : {Vec3{x, 0, 0}, Vec3{x + 1, 0, 0}, Vec3{x, 1, 0}, Vec3{x, 0, 1}}) positions.push_back(p);
  const int position = b.accessor(positions, 5126, "VEC3", 8);
  b.json["accessors"].back()["min"] = {0, 0, 0}, b.json["accessors"].back()["max"] = {6, 1, 1};
  std::vector<uint16_t> corners;
  for (const uint16_t first : {0, 4})
    for (const int k : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) corners.push_back(uint16_t(first + k));
  const int indices = b.accessor(corners, 5123, "SCALAR", 24, 34963);
  std::vector<uint8_t> colors;
  for (uint8_t v = 0; v < 8; ++v) colors.insert(colors.end(), {uint8_t(10 * v), 1, 2, 0});  // three, and one that fills up
  const int color = b.accessor(colors, 5121, "VEC3", 8);
  b.json["accessors"].back()["normalized"] = true;
  b.json["bufferViews"].back()["byteStride"] = 4;
  std::vector<float> mixed;
  for (int v = 0; v < 8; ++v) mixed.insert(mixed.end(), {float(v), 0.5F, float(100 + v)});  // UV, and a scalar of the user
  const int uv = b.accessor(mixed, 5126, "VEC2", 8);
  b.json["bufferViews"].back()["byteStride"] = 12;
  const size_t mixed_view = b.json["bufferViews"].size() - 1;
  b.json["accessors"].push_back({{"bufferView", mixed_view}, {"byteOffset", 8}, {"componentType", 5126}, {"count", 8}, {"type", "SCALAR"}});
  const int heat = int(b.json["accessors"].size()) - 1;
  const int at = b.accessor(std::vector<uint16_t>{5}, 5123, "SCALAR", 1, 0), to = b.accessor(std::vector<float>{7}, 5126, "SCALAR", 1, 0);
  const Json at_view = b.json["accessors"][size_t(at)]["bufferView"], to_view = b.json["accessors"][size_t(to)]["bufferView"];
  b.json["accessors"].erase(b.json["accessors"].size() - 1), b.json["accessors"].erase(b.json["accessors"].size() - 1);
  b.json["accessors"].push_back(
      {{"componentType", 5126},
       {"count", 8},
       {"type", "SCALAR"},
       {"sparse", {{"count", 1}, {"indices", {{"bufferView", at_view}, {"componentType", 5123}}}, {"values", {{"bufferView", to_view}}}}}});
  const int sparse = int(b.json["accessors"].size()) - 1;
  const int mesh =
      b.mesh({{{"attributes", {{"POSITION", position}, {"COLOR_0", color}, {"TEXCOORD_0", uv}, {"_HEAT", heat}, {"_RARE", sparse}}},
               {"indices", indices},
               {"mode", 4},
               {"extras", {{"note", "kept"}}}}});
  const int left = b.node({{"mesh", mesh}, {"name", "left"}}),
            right = b.node({{"mesh", mesh}, {"name", "right"}, {"translation", {0, 9, 0}}});
  b.json["scenes"].push_back({{"nodes", {left, right}}});
  return b;
}

Sculpt read(const std::string& glb) {
  Warnings warnings;
  return readGltf("test.glb", glb, {}, warnings);
}
std::vector<float> floatsOf(const GltfDocument& document, const Json& primitive, const char* name, size_t components) {
  const Json& accessor = document.json["accessors"][primitive["attributes"][name].get<size_t>()];
  const Json& view = document.json["bufferViews"][accessor["bufferView"].get<size_t>()];
  std::vector<float> floats(accessor["count"].get<size_t>() * components);
  std::memcpy(floats.data(), &document.buffers[0][view["byteOffset"].get<size_t>()], floats.size() * sizeof(float));
  return floats;
}

}  // namespace

TEST(ReduceSculpt, KeepsTheRowsOfWhatRemains) {
  const Sculpt full = read(oddDocument().glb());
  ASSERT_EQ(full.parts.size(), 2U);
  // The left one keeps its second tetrahedron, the right one all.
  const std::vector<Triangle>& all = full.parts[0].triangles;
  const Sculpt half = withTriangles(full, std::vector<std::vector<Triangle>>{{all.begin() + 4, all.end()}, {}});
  EXPECT_EQ(half.parts[0].positions, std::vector<Vec3>(full.parts[0].positions.begin() + 4, full.parts[0].positions.end()));
  EXPECT_EQ(half.parts[1].positions, full.parts[1].positions);
  const Json& json = half.gltf->json;
  const GltfPlace& place = half.gltf->places[0];
  const Json& primitive = json["meshes"][size_t(place.mesh)]["primitives"][0];
  EXPECT_EQ(primitive["extras"]["note"], "kept");
  EXPECT_EQ(floatsOf(*half.gltf, primitive, "TEXCOORD_0", 2), (std::vector<float>{4, 0.5F, 5, 0.5F, 6, 0.5F, 7, 0.5F}));
  EXPECT_EQ(floatsOf(*half.gltf, primitive, "_HEAT", 1), (std::vector<float>{104, 105, 106, 107}));
  EXPECT_EQ(floatsOf(*half.gltf, primitive, "_RARE", 1), (std::vector<float>{0, 7, 0, 0}));
  const Json& color = json["accessors"][primitive["attributes"]["COLOR_0"].get<size_t>()];
  EXPECT_EQ(color["normalized"], true);
  EXPECT_EQ(color["componentType"], 5121);
  const Json& view = json["bufferViews"][color["bufferView"].get<size_t>()];
  EXPECT_EQ(view["byteStride"], 4);
  for (size_t v = 0; v < 4; ++v) EXPECT_EQ(half.gltf->buffers[0][view["byteOffset"].get<size_t>() + 4 * v], 10 * (4 + v));
  const Json& position = json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()];
  EXPECT_EQ(position["min"], Json({5.0, 0.0, 0.0}));
  EXPECT_EQ(position["max"], Json({6.0, 1.0, 1.0}));

  // What is written reads back as the same, and the validator sees it.
  const std::vector<std::vector<Lobe>> lobes = fakeLobes(half);
  Warnings warnings;
  const std::string glb = encodeGlb(half, lobes, sampleInfo(), {}, warnings);
  std::filesystem::create_directories(glbFolder());
  writeFileAtomically(glbFolder() / "reduced.glb", glb);
  const Sculpt again = read(glb);
  ASSERT_EQ(again.parts.size(), 2U);
  EXPECT_EQ(again.parts[0].positions, half.parts[0].positions);
  EXPECT_EQ(again.parts[0].triangles, half.parts[0].triangles);
  EXPECT_EQ(again.parts[1].positions, full.parts[1].positions);
  EXPECT_EQ(again.parts[1].triangles, full.parts[1].triangles);
}

// Nothing of what went is left in the file.
TEST(ReduceSculpt, DropsTheBytesOfWhatWent) {
  const Sculpt full = read(oddDocument().glb());
  const std::vector<Triangle> second(full.parts[0].triangles.begin() + 4, full.parts[0].triangles.end());
  const Sculpt half = withTriangles(full, std::vector<std::vector<Triangle>>{second, second});
  EXPECT_LT(half.gltf->buffers[0].size(), full.gltf->buffers[0].size() * 2 / 3);
  EXPECT_EQ(half.gltf->buffers.size(), 1U);
  EXPECT_EQ(half.gltf->json["accessors"].size(), full.gltf->json["accessors"].size() + 1);  // indices of the second node
}

TEST(ReduceSculpt, FindsVerticesThatAreAlikeInEverything) {
  const Sculpt full = read(oddDocument().glb());
  std::vector<uint32_t> own(16);
  for (uint32_t v = 0; v < 16; ++v) own[v] = v;
  EXPECT_EQ(firstAlike(full), own);  // equal nowhere: the UVs count up
  Sculpt plain;
  SculptPart part;
  part.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  part.uvs = {{0, 0}, {0, 0}, {0, 0}, {1, 0}};
  plain.parts = {part, part};
  EXPECT_EQ(firstAlike(plain), (std::vector<uint32_t>{0, 1, 0, 3, 4, 5, 4, 7}));
}

TEST(ReduceSculpt, KnowsWhatIsMoved) {
  GltfBuilder b;
  Json primitive = b.tetrahedron();
  primitive["targets"] = Json::array({{{"POSITION", primitive["attributes"]["POSITION"]}}});
  const int node = b.node({{"mesh", b.mesh({b.tetrahedron(), primitive})}});
  b.json["scenes"].push_back({{"nodes", {node}}});
  Sculpt sculpt = read(b.glb());
  EXPECT_FALSE(isDeformed(sculpt, 0));
  EXPECT_TRUE(isDeformed(sculpt, 1));
  sculpt.parts[0].vertex_to_scene.resize(4);
  EXPECT_TRUE(isDeformed(sculpt, 0));
}

TEST(ReduceSculpt, RefusesAnAttributeBeyondItsBuffer) {
  GltfBuilder b = oddDocument();
  b.json["accessors"][3]["byteOffset"] = 40;
  const Sculpt full = read(b.glb());
  EXPECT_THROW(withTriangles(full, std::vector<std::vector<Triangle>>{full.parts[0].triangles, {}}), InputError);
}

}  // namespace cloudbake
