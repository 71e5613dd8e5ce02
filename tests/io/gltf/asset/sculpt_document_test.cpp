#include "io/gltf/asset/sculpt_document.h"

#include <array>
#include <filesystem>

#include "io/gltf/asset/write.h"
#include "io/gltf/document.h"
#include "io/gltf/sculpt/read.h"
#include "tests/folders.h"
#include "tests/io/io_helpers.h"

using namespace cloudbake;

namespace {

// One orange pixel.
constexpr std::array<unsigned char, 69> kPngBytes{0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
                                                  0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00,
                                                  0x00, 0x90, 0x77, 0x53, 0xde, 0x00, 0x00, 0x00, 0x0c, 0x49, 0x44, 0x41, 0x54, 0x78,
                                                  0x9c, 0x63, 0xf8, 0x7f, 0x80, 0x01, 0x00, 0x04, 0x81, 0x01, 0xc0, 0x77, 0xd9, 0x03,
                                                  0x1d, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const std::string kPng(kPngBytes.begin(), kPngBytes.end());

Affine moved(double x, double y, double z) { return {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {x, y, z}}; }

SculptPart tetrahedron(int node, int material, const Affine& to_scene) {
  SculptPart part;
  part.name = "t";
  part.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  part.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  part.node = node;
  part.material = material;
  part.to_scene = to_scene;
  return part;
}

// An empty with two children; the second one's parts have two materials, colours and two UV sets.
Sculpt sample() {
  Sculpt sculpt;
  sculpt.nodes = {{"Empty", -1, moved(1, 0, 0)}, {"A", 0, moved(0, 2, 0)}, {"B", 0, moved(0, 0, 3)}};
  sculpt.images = {{"unused.png", kPng, "image/png"}, {"skin.png", kPng, "image/png"}};
  SculptMaterial clay, glow;
  clay.name = "clay", clay.base_color = {0.1F, 0.2F, 0.3F, 0.5F}, clay.blended = true, clay.base_color_texture.image = 1;
  clay.base_color_texture.scale = {2, 4}, clay.base_color_texture.offset = {0.25F, 0};
  glow.name = "glow", glow.emission = {4, 2, 0}, glow.metallic = 0.5F, glow.roughness = 0.25F, glow.normal_texture.image = 1;
  glow.normal_texture.uv_set = 1;
  sculpt.materials = {clay, glow};
  sculpt.parts = {tetrahedron(1, 0, moved(1, 2, 0)), tetrahedron(2, 0, moved(1, 0, 3)), tetrahedron(2, 1, moved(1, 0, 3))};
  for (SculptPart& part : sculpt.parts) {
    part.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    part.more_uvs = {{{0, 0}, {0.5F, 0}, {0, 0.5F}, {0.5F, 0.5F}}};
    part.colors.assign(4, {1, 0.5F, 0, 1});
  }
  return sculpt;
}

struct Written {
  Json json;
  std::string binary;
  Warnings warnings;
  std::string bytesOf(const Json& view) const { return binary.substr(view.value("byteOffset", size_t(0)), view["byteLength"]); }
};

Written encode(const Sculpt& sculpt, const std::string& name = "") {
  Written written;
  std::vector<std::vector<Lobe>> lobes;
  for (const SculptPart& part : sculpt.parts) lobes.emplace_back(part.positions.size(), Lobe{{0, 0, 1}, 0.5F});
  const std::string glb = encodeGlb(sculpt, lobes, {}, {}, written.warnings);
  if (!name.empty()) {  // for the Khronos validator
    std::filesystem::create_directories(glbFolder());
    std::ofstream(glbFolder() / name, std::ios::binary) << glb;
  }
  const GlbChunks chunks = splitGlb("t.glb", glb);
  written.json = Json::parse(chunks.json);
  written.binary = chunks.binary;
  return written;
}

}  // namespace

TEST(SculptDocument, HoldsNodesMaterialsImagesColoursAndUvSets) {
  const Written w = encode(sample(), "sculpt_document.glb");
  const Json& j = w.json;
  EXPECT_EQ(j["scenes"][0]["nodes"], Json::array({0}));
  ASSERT_EQ(j["nodes"].size(), 3U);
  EXPECT_EQ(j["nodes"][0]["name"], "Empty");
  EXPECT_EQ(j["nodes"][0]["children"], (Json{1, 2}));
  EXPECT_FALSE(j["nodes"][0].contains("mesh"));
  EXPECT_EQ(j["nodes"][2]["matrix"][14], 3);
  ASSERT_EQ(j["meshes"].size(), 2U);
  EXPECT_EQ(j["meshes"][1]["name"], "B");
  ASSERT_EQ(j["meshes"][1]["primitives"].size(), 2U);
  EXPECT_EQ(j["meshes"][1]["primitives"][1]["material"], 1);
  const Json& attributes = j["meshes"][0]["primitives"][0]["attributes"];
  for (const char* key : {"POSITION", "TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2", "TEXCOORD_3", "COLOR_0"})
    EXPECT_TRUE(attributes.contains(key)) << key;
  EXPECT_EQ(j["asset"]["extras"]["cloudbake"]["uv_sets"][0], 2) << j["asset"].dump();

  ASSERT_EQ(j["materials"].size(), 2U);
  const Json &clay = j["materials"][0], &glow = j["materials"][1];
  EXPECT_EQ(clay["name"], "clay");
  EXPECT_EQ(clay["alphaMode"], "BLEND");
  EXPECT_EQ(clay["pbrMetallicRoughness"]["baseColorFactor"], (Json{0.1, 0.2, 0.3, 0.5}));
  EXPECT_EQ(clay["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"]["scale"], (Json{2.0, 4.0}));
  EXPECT_EQ(glow["emissiveFactor"], (Json{1.0, 0.5, 0.0}));
  EXPECT_EQ(glow["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 4.0);
  EXPECT_EQ(glow["normalTexture"]["texCoord"], 1);
  EXPECT_EQ(glow["pbrMetallicRoughness"]["roughnessFactor"], 0.25);
  EXPECT_EQ(j["extensionsUsed"], (Json{"KHR_texture_transform", "KHR_materials_emissive_strength"}));
  EXPECT_EQ(j["images"][0]["name"], "skin.png") << "an image that no material uses is left out";
  EXPECT_EQ(w.bytesOf(j["bufferViews"][j["images"][0]["bufferView"].get<size_t>()]), kPng);
}

TEST(SculptDocument, ColorsKeepTheirAlphaWhereOneHasIt) {
  Sculpt sculpt = sample();
  sculpt.parts[1].colors[2][3] = 0.5F;
  const Written w = encode(sculpt);
  const auto typeOf = [&](size_t mesh, size_t primitive) {
    return w.json["accessors"][w.json["meshes"][mesh]["primitives"][primitive]["attributes"]["COLOR_0"].get<size_t>()]["type"];
  };
  EXPECT_EQ(typeOf(0, 0), "VEC3");
  EXPECT_EQ(typeOf(1, 0), "VEC4");
  EXPECT_EQ(typeOf(1, 1), "VEC3");
}

// What is written is where it was: read back, every part has the same transform.
TEST(SculptDocument, MaterialsHaveAllTheirTexturesAndNoFactorsOfOne) {
  Sculpt sculpt = sample();
  SculptMaterial &plain = sculpt.materials[0], &rich = sculpt.materials[1];
  plain = {};
  rich.base_color = {1, 1, 1, 0.5F};
  rich.metallic_roughness_texture.image = rich.occlusion_texture.image = rich.emissive_texture.image = 1;
  rich.normal_scale = 0.25F, rich.emission = {0.5F, 1, 0}, rich.double_sided = true;
  const Written w = encode(sculpt);
  const Json &white = w.json["materials"][0], &all = w.json["materials"][1];
  EXPECT_FALSE(white["pbrMetallicRoughness"].contains("baseColorFactor"));
  for (const char* key : {"emissiveFactor", "normalTexture", "alphaMode", "extensions"}) EXPECT_FALSE(white.contains(key)) << key;
  EXPECT_EQ(white["doubleSided"], false);
  EXPECT_EQ(all["pbrMetallicRoughness"]["baseColorFactor"], (Json{1.0, 1.0, 1.0, 0.5}));
  EXPECT_EQ(all["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"], 0);
  EXPECT_EQ(all["normalTexture"]["scale"], 0.25);
  EXPECT_EQ(all["occlusionTexture"]["index"], 0);
  EXPECT_EQ(all["emissiveTexture"]["index"], 0);
  EXPECT_EQ(all["emissiveFactor"], (Json{0.5, 1.0, 0.0}));
  EXPECT_FALSE(all.contains("extensions")) << "an emission of at most 1 needs none";
  EXPECT_EQ(all["doubleSided"], true);
}

TEST(SculptDocument, PartsStayInTheirPlace) {
  Sculpt sculpt = sample();
  sculpt.parts[2].positions[1].x = 2;  // with the same vertices as the second it would become one part
  Warnings warnings;
  std::vector<std::vector<Lobe>> lobes(3, std::vector<Lobe>(4, Lobe{{0, 0, 1}, 0.5F}));
  const Sculpt back = readGltf("t.glb", encodeGlb(sculpt, lobes, {}, {}, warnings), {}, warnings);
  ASSERT_EQ(back.parts.size(), 3U);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(back.parts[i].to_scene.offset, sculpt.parts[i].to_scene.offset) << i;
}

// A sheared node loses its parent, or its vertices move to scene space; where it lies does not change.
TEST(SculptDocument, ShearedNodesBecomeRoots) {
  const Affine stretched{{{{1, 0, 0}, {0, 3, 0}, {0, 0, 1}}}, {0, 0, 0}}, turned{{{{0.6, -0.8, 0}, {0.8, 0.6, 0}, {0, 0, 1}}}, {1, 2, 3}};
  Sculpt sculpt;
  sculpt.nodes = {{"stretched", -1, stretched}, {"turned", 0, turned}, {"sheared", 1, {{{{1, 1, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 0}}}};
  Affine to_scene = stretched;
  for (int i = 1; i < 3; ++i) to_scene = compose(to_scene, sculpt.nodes[size_t(i)].local);
  sculpt.parts = {tetrahedron(2, -1, to_scene)};
  const SurfaceMesh before = surfaceInScene(sculpt);
  const Written w = encode(sculpt, "sheared_document.glb");
  EXPECT_EQ(w.json["scenes"][0]["nodes"], (Json{0, 2}));
  EXPECT_EQ(w.json["nodes"][1]["name"], "turned");
  EXPECT_FALSE(w.json["nodes"][2].contains("matrix"));
  ASSERT_TRUE(w.warnings.entries().contains(WarningKind::kHierarchyChanged));
  EXPECT_EQ(w.warnings.entries().at(WarningKind::kHierarchyChanged).count, 1U);
  Warnings warnings;
  std::vector<std::vector<Lobe>> lobes(1, std::vector<Lobe>(4, Lobe{{0, 0, 1}, 0.5F}));
  const SurfaceMesh after = surfaceInScene(readGltf("t.glb", encodeGlb(sculpt, lobes, {}, {}, warnings), {}, warnings));
  for (size_t i = 0; i < 4; ++i) EXPECT_LT(length(after.positions[i] - before.positions[i]), 1e-5F) << i;
}

// Without a description there is a node and mesh per part and one material, as for a grown cloud.
TEST(SculptDocument, PlainPartsGetANodeEachAndOneMaterial) {
  Sculpt sculpt;
  sculpt.parts = {tetrahedron(-1, -1, {}), tetrahedron(-1, -1, moved(5, 0, 0))};
  const Json j = encode(sculpt).json;
  EXPECT_EQ(j["nodes"].size(), 2U);
  EXPECT_EQ(j["meshes"].size(), 2U);
  ASSERT_EQ(j["materials"].size(), 1U);
  EXPECT_EQ(j["materials"][0]["name"], "cloud");
}
