// A baked asset that is baked again: its lobes are replaced, not added to, and what is the artist's stays.
#include "io/gltf/sculpt/earlier_bake.h"

#include <algorithm>
#include <set>

#include "core/harmonics.h"
#include "io/gltf/keep_alive.h"
#include "io/gltf/sculpt/read.h"
#include "tests/io/gltf/gltf_helpers.h"

namespace cloudbake {
namespace {

const GltfSettings kAttribute{{}, true, KeepAliveTexture::kAuto};

struct Baked {
  std::string glb;
  Json json;
  std::string_view binary() const { return splitGlb("a.glb", glb).binary; }
};

// Bakes by imagination, with harmonics of this order.
Baked bake(const std::string& glb, const GltfSettings& settings = {}, int order = 0, unsigned seed = 1) {
  Warnings warnings;
  const Sculpt sculpt = readMesh("a.glb", glb, {}, warnings);
  AssetInfo info = sampleInfo();
  info.input_hash = sourceHash(sculpt, glb);
  info.harmonic_order = order;
  size_t vertices = 0;
  for (const SculptPart& part : sculpt.parts) vertices += part.positions.size();
  std::vector<float> harmonics;
  for (size_t i = 0; order > 0 && i < vertices * harmonicCount(order); ++i) harmonics.push_back(float(i) / 256);
  Baked baked{encodeGlb(sculpt, fakeLobes(sculpt, seed), info, settings, warnings, harmonics), {}};
  baked.json = Json::parse(splitGlb("a.glb", baked.glb).json);
  std::filesystem::create_directories(glbFolder());
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  writeFileAtomically(glbFolder() / (std::string(test->name()) + "_" + std::to_string(baked.glb.size()) + ".glb"), baked.glb);
  Warnings again;
  EXPECT_EQ(decodeGlb("a.glb", baked.glb, again).lobes.size(), vertices);
  return baked;
}

// A tetrahedron with two UV sets, a material with a texture of its own, and a second tetrahedron without a material, and maybe without UVs.
GltfBuilder artists(bool all_have_uvs = true) {
  GltfBuilder builder;
  Json first = builder.tetrahedron(), second = builder.tetrahedron({5, 0, 0});
  first["attributes"]["TEXCOORD_0"] = builder.uvs(0.25F), first["attributes"]["TEXCOORD_1"] = builder.uvs(0.75F);
  if (all_have_uvs) second["attributes"]["TEXCOORD_0"] = builder.uvs(0.5F), second["attributes"]["TEXCOORD_1"] = builder.uvs(1);
  first["material"] = 0;
  const std::string png = readFileBytes(sourceFolder() / "tests/data/cloud.png");
  builder.accessor(std::vector<char>(png.begin(), png.end()), 5121, "SCALAR", png.size(), 0);
  builder.json["accessors"].erase(builder.json["accessors"].size() - 1);
  builder.json["images"] = Json::array({{{"mimeType", "image/png"}, {"bufferView", builder.json["bufferViews"].size() - 1}}});
  builder.json["textures"] = Json::array({{{"source", 0}}});
  builder.json["materials"] =
      Json::array({{{"name", "clay"}, {"emissiveTexture", {{"index", 0}, {"texCoord", 1}}}, {"emissiveFactor", {1, 1, 1}}}});
  builder.json["scenes"].push_back({{"nodes", {0}}});
  builder.node({{"mesh", builder.mesh({first, second})}});
  return builder;
}

// Moves what a bake has put at the end of an array to its beginning, as a tool might, with the numbers that refer to it.
void turnAround(Json& node, const std::string& key, size_t size) {
  if (!node.is_structured()) return;
  for (auto item = node.begin(); item != node.end(); ++item)
    if (node.is_object() && item.key() == key && item->is_number())
      *item = size - 1 - item->get<size_t>();
    else
      turnAround(*item, key, size);
}

// Everything that bakes write, again and again: the second bake gives the bytes that all later ones give, no more than the first.
TEST(EarlierBake, IsReplaced) {
  for (const int order : {0, 2})
    for (const GltfSettings& settings : {GltfSettings{}, kAttribute, GltfSettings{4, false, KeepAliveTexture::kForce}}) {
      const Baked first = bake(artists().glb(), settings, order), second = bake(first.glb, settings, order),
                  third = bake(second.glb, settings, order);
      EXPECT_EQ(second.glb.size(), first.glb.size());
      EXPECT_EQ(second.binary() == first.binary(), true);
      EXPECT_EQ(third.glb == second.glb, true);
      for (const char* same : {"accessors", "bufferViews", "images", "textures", "samplers", "materials", "meshes"})
        EXPECT_EQ(second.json[same], first.json[same]) << same;
    }
}

// Zeros that fill the gaps of a part without UVs are its UVs from then on.
TEST(EarlierBake, FillersStay) {
  const Baked first = bake(artists(false).glb()), second = bake(first.glb), third = bake(second.glb);
  EXPECT_EQ(second.glb.size(), first.glb.size());
  EXPECT_EQ(second.json["meshes"], first.json["meshes"]);
  EXPECT_EQ(third.glb == second.glb, true);
}

// Nothing of a first bake is left that the second does not write: neither attributes nor textures nor bytes.
TEST(EarlierBake, LeavesNothing) {
  const Baked plain = bake(artists().glb(), {{}, false, KeepAliveTexture::kOff}),
              again = bake(bake(artists().glb(), kAttribute, 3).glb, {{}, false, KeepAliveTexture::kOff});
  Json expected = plain.json, found = again.json;
  expected["asset"].erase("extras"), found["asset"].erase("extras");
  // The second primitive got a material, which has become the artist's.
  ASSERT_EQ(found["materials"].size(), 2U);
  found["materials"].erase(1);
  found["meshes"][0]["primitives"][1].erase("material");
  for (auto item = expected.begin(); item != expected.end(); ++item) EXPECT_EQ(found[item.key()], item.value()) << item.key();
  EXPECT_EQ(again.binary() == plain.binary(), true);
}

TEST(EarlierBake, MovesToAnotherSet) {
  const Baked first = bake(artists().glb(), {2, false, KeepAliveTexture::kForce}),
              moved = bake(first.glb, {3, false, KeepAliveTexture::kForce});
  const Json& attributes = moved.json["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_TRUE(attributes.contains("TEXCOORD_3") && attributes.contains("TEXCOORD_4") && !attributes.contains("TEXCOORD_5"));
  EXPECT_EQ(moved.json["textures"].size(), 2U) << "the artist's and one white";
  EXPECT_EQ(moved.json["materials"][0]["occlusionTexture"]["texCoord"], 4);
  EXPECT_EQ(bake(moved.glb).json["asset"]["extras"]["cloudbake"]["uv_sets"], Json({3, 4})) << "an asset keeps its sets";
}

// An artist has bound a texture to the sets of the lobes: they are UVs now. Lobes get other sets, and keep those.
TEST(EarlierBake, SetsThatAnArtistUsesStay) {
  const Baked first = bake(artists().glb(), kAttribute);
  ASSERT_EQ(first.json["asset"]["extras"]["cloudbake"]["uv_sets"], Json({2, 3}));
  for (const Json& texture : {Json{{"index", 0}, {"texCoord", 3}},
                              Json{{"index", 0}, {"texCoord", 0}, {"extensions", {{"KHR_texture_transform", {{"texCoord", 2}}}}}}}) {
    Json json = first.json;
    json["materials"][0]["normalTexture"] = texture;
    if (texture.contains("extensions")) json["extensionsUsed"] = Json::array({"KHR_texture_transform"});
    const std::string used = joinGlb("a.glb", json.dump(), first.binary());
    const Baked second = bake(used, kAttribute), third = bake(second.glb, kAttribute), fourth = bake(third.glb, kAttribute);
    EXPECT_EQ(second.json["asset"]["extras"]["cloudbake"]["uv_sets"], Json({4, 5}));
    const Json& attributes = second.json["meshes"][0]["primitives"][0]["attributes"];
    for (const char* theirs : {"TEXCOORD_2", "TEXCOORD_3"})
      EXPECT_EQ(attributes[theirs], first.json["meshes"][0]["primitives"][0]["attributes"][theirs]) << theirs;
    EXPECT_EQ(second.json["materials"][0]["normalTexture"], texture);
    EXPECT_EQ(fourth.glb == third.glb, true);
    EXPECT_EQ(third.glb.size(), second.glb.size());
  }
}

// An attribute of that name which is no lobe, and an image that is white otherwise, are the artist's.
TEST(EarlierBake, LooksAtWhatItRemoves) {
  GltfBuilder builder = artists();
  builder.json["meshes"][0]["primitives"][0]["attributes"]["_OCCLUSION"] = builder.accessor(std::vector<float>(4, 0.5F), 5126, "SCALAR", 4);
  const Baked first = bake(builder.glb()), second = bake(first.glb);
  EXPECT_EQ(second.json["meshes"][0]["primitives"][0]["attributes"]["_OCCLUSION"],
            first.json["meshes"][0]["primitives"][0]["attributes"]["_OCCLUSION"]);
  EXPECT_EQ(second.json["images"].size(), 2U);
}

// A tool has put the arrays into another order, so that what a bake wrote is no longer at the end. Nothing may be renumbered then: the
// places are used again.
TEST(EarlierBake, WritesIntoTheSamePlaces) {
  const Baked first = bake(artists().glb(), kAttribute);
  Json json = first.json;
  for (const auto& [array, key] : {std::pair{"bufferViews", "bufferView"}, {"textures", "index"}, {"images", "source"}}) {
    turnAround(json, key, json[array].size());
    std::reverse(json[array].begin(), json[array].end());
  }
  Json& accessors = json["accessors"];
  for (Json& primitive : json["meshes"][0]["primitives"]) {
    for (Json& accessor : primitive["attributes"]) accessor = accessors.size() - 1 - accessor.get<size_t>();
    primitive["indices"] = accessors.size() - 1 - primitive["indices"].get<size_t>();
  }
  std::reverse(accessors.begin(), accessors.end());
  const Baked turned{joinGlb("a.glb", json.dump(), first.binary()), json};
  const Baked second = bake(turned.glb, kAttribute), third = bake(second.glb, kAttribute);
  for (const char* array : {"accessors", "bufferViews", "textures", "images"})
    EXPECT_EQ(second.json[array].size(), json[array].size()) << array;
  const auto numbersIn = [](const Json& of) {
    std::set<size_t> numbers;
    for (const Json& primitive : of["meshes"][0]["primitives"])
      for (const Json& accessor : primitive["attributes"]) numbers.insert(accessor.get<size_t>());
    return numbers;
  };
  EXPECT_EQ(numbersIn(second.json), numbersIn(json));
  EXPECT_EQ(third.glb == second.glb, true);
  // With less to write, what is free stays as a stub, which is sound.
  const Baked less = bake(turned.glb, {{}, false, KeepAliveTexture::kOff}), same = bake(less.glb, {{}, false, KeepAliveTexture::kOff});
  EXPECT_LT(less.binary().size(), second.binary().size());
  EXPECT_EQ(same.glb.size(), less.glb.size());
}

// Views that share bytes, as of tools that store vertices interleaved: nothing of the artist's is cut.
TEST(EarlierBake, SharedBytesStay) {
  const Baked first = bake(artists().glb());
  Json json = first.json;
  const Json attributes = json["meshes"][0]["primitives"][0]["attributes"];
  const auto view_of = [&](const char* name) { return json["accessors"][attributes[name].get<size_t>()]["bufferView"].get<size_t>(); };
  // The view of the normals' neighbour reaches into the lobes.
  Json& lobes = json["bufferViews"][view_of("TEXCOORD_2")];
  json["bufferViews"][view_of("TEXCOORD_1")] = lobes;
  const Baked second = bake(joinGlb("a.glb", json.dump(), first.binary()), {}, 0, 2);
  const auto uvs = [](const Baked& baked, const char* name) {
    const Json& accessor = baked.json["accessors"][baked.json["meshes"][0]["primitives"][0]["attributes"][name].get<size_t>()];
    const Json& view = baked.json["bufferViews"][accessor["bufferView"].get<size_t>()];
    return std::string(baked.binary().substr(view["byteOffset"].get<size_t>(), 32));
  };
  EXPECT_EQ(uvs(second, "TEXCOORD_1"), uvs(first, "TEXCOORD_2"));
  EXPECT_EQ(uvs(second, "TEXCOORD_0"), uvs(first, "TEXCOORD_0"));
}

// What identifies the source of a bake is the same before and after it is baked again; a change of the mesh changes it.
TEST(EarlierBake, IsNoPartOfTheSource) {
  const auto hashOf = [](const Baked& baked) { return baked.json["asset"]["extras"]["cloudbake"]["input_hash"].get<std::string>(); };
  const Baked first = bake(artists().glb()), second = bake(first.glb), third = bake(second.glb, kAttribute, 2), fourth = bake(third.glb);
  EXPECT_EQ(hashOf(first), hashBytes(artists().glb()));
  EXPECT_EQ(hashOf(third), hashOf(second));
  EXPECT_EQ(hashOf(fourth), hashOf(second));
  EXPECT_EQ(fourth.glb == second.glb, true);
  Json json = second.json;
  json["nodes"][0]["scale"] = {2, 2, 2};
  EXPECT_NE(hashOf(bake(joinGlb("a.glb", json.dump(), second.binary()))), hashOf(second));
}

TEST(EarlierBake, DamageIsAnError) {
  const Baked first = bake(artists().glb());
  const auto refusal = [&](const Json& json) {
    try {
      Warnings warnings;
      readMesh("a.glb", joinGlb("a.glb", json.dump(), first.binary()), {}, warnings);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Json json = first.json;
  json["textures"][1]["source"] = "white";
  EXPECT_NE(refusal(json).find("a.glb: textures[1].source is \"white\""), std::string::npos) << refusal(json);
  json = first.json;
  json["images"][1]["bufferView"] = 999;
  EXPECT_NE(refusal(json).find("damaged"), std::string::npos) << refusal(json);
}

}  // namespace
}  // namespace cloudbake
