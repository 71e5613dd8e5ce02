// What readStoredAsset finds in materials that other tools have changed. KHR_texture_transform: "texCoord: Overrides the textureInfo
// texCoord value if supplied, and if this extension is supported."

#include "io/gltf/asset/decode.h"
#include "io/gltf/document.h"
#include "tests/io/gltf/gltf_helpers.h"

using namespace cloudbake;

namespace {

Json scaledBy(float factor, const Json& more = Json::object()) {
  Json own = {{"offset", {0.25, -1.0}}, {"scale", {factor, 2.0}}};
  own.update(more);
  return {{"KHR_texture_transform", own}};
}

// A tetrahedron with four UV sets and a material.
StoredAsset storedWith(const Json& material, const Json& attributes = Json::object()) {
  GltfBuilder gltf;
  Json primitive = gltf.tetrahedron();
  primitive["attributes"].update(attributes);
  primitive["material"] = 0;
  for (int set = 0; set < 4; ++set) primitive["attributes"][uvSetName(set)] = gltf.uvs();
  gltf.mesh({primitive});
  gltf.node({{"mesh", 0}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  gltf.json["materials"] = Json::array({material});
  Warnings warnings;
  return readStoredAsset("a.glb", gltf.glb(), warnings);
}

// The UV sets under a transform, with its scale along u.
std::map<int, float> scalesOf(const StoredAsset& asset) {
  std::map<int, float> scales;
  for (const auto& [set, uvs] : asset.sets.at(0))
    if (uvs.transform) {
      EXPECT_EQ(uvs.transform->first, (Vec2{0.25F, -1}));
      EXPECT_EQ(uvs.transform->second.y, 2);
      scales[set] = uvs.transform->second.x;
    }
  return scales;
}

}  // namespace

TEST(Decode, ATransformIsOfTheSetOfItsTexture) {
  const Json material = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"extensions", scaledBy(3)}}}}},
                         {"occlusionTexture", {{"index", 0}, {"texCoord", 2}, {"extensions", scaledBy(5)}}},
                         {"emissiveTexture", {{"index", 0}, {"texCoord", 3}}}};
  EXPECT_EQ(scalesOf(storedWith(material)), (std::map<int, float>{{0, 3}, {2, 5}}));
}

TEST(Decode, ATransformThatNamesAnotherSetIsOfThatSet) {
  const Json material = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"extensions", scaledBy(3, {{"texCoord", 1}})}}}}},
                         {"occlusionTexture", {{"index", 0}, {"texCoord", 2}, {"extensions", scaledBy(5, {{"texCoord", 3}})}}}};
  EXPECT_EQ(scalesOf(storedWith(material)), (std::map<int, float>{{1, 3}, {3, 5}}));
}

TEST(Decode, OcclusionInAnAccessorThatIsNotThereIsRefused) {
  for (const int index : {13, -1})
    expectError<InputError>(
        [&] {
          storedWith(Json::object(), {{"_OCCLUSION", index}});
        },
        index < 0 ? "" : "_OCCLUSION: uses an accessor that does not exist");
  EXPECT_TRUE(storedWith(Json::object(), {{"_OCCLUSION", 0}}).occlusion.empty()) << "positions are no lobes";
}
