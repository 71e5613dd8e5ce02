// The base colours of sculpts, as pictures read them from assets.
#include "io/gltf/asset/own_colors.h"

#include <functional>

#include "core/srgb.h"
#include "io/image/image.h"
#include "tests/io/gltf/gltf_helpers.h"

namespace cloudbake {
namespace {

/// A sculpt of one tetrahedron with a material, an image of 2 × 2 pixels, and its texture.
struct Painted {
  GltfBuilder gltf;
  Json primitive = gltf.tetrahedron();
  Json material = Json::object(), sampler = Json::object();
  std::string picture;

  explicit Painted(const std::vector<Vec2>& uvs = std::vector<Vec2>(4)) : picture(encodePng(image())) {
    primitive["attributes"]["TEXCOORD_0"] = gltf.accessor(uvs, 5126, "VEC2", 4);
  }
  // Red, green over blue, white.
  static Image image() { return {2, 2, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}}; }

  void setTexture(const Json& more = Json::object()) {
    material["pbrMetallicRoughness"]["baseColorTexture"] = more;
    material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  }

  std::string sculpt() {
    const bool has_texture = material.contains("pbrMetallicRoughness") && material["pbrMetallicRoughness"].contains("baseColorTexture");
    primitive["material"] = 0;
    gltf.json["materials"] = Json::array({material});
    if (has_texture) {
      const int view = gltf.json["accessors"][size_t(
          gltf.accessor(std::vector<char>(picture.begin(), picture.end()), 5121, "SCALAR", picture.size(), 0))]["bufferView"];
      gltf.json["accessors"].erase(gltf.json["accessors"].size() - 1);
      gltf.json["images"] = Json::array({{{"bufferView", view}, {"mimeType", "image/png"}}});
      gltf.json["samplers"] = Json::array({sampler});
      gltf.json["textures"] = Json::array({{{"source", 0}, {"sampler", 0}}});
    }
    gltf.mesh({primitive});
    gltf.node({{"mesh", 0}});
    gltf.json["scenes"].push_back({{"nodes", {0}}});
    return gltf.glb();
  }

  // The colours of its asset. A picture that cannot be read is no error, and nothing else asks for it.
  std::vector<Vec3> colors(uint64_t ignored = 0, const ReadSettings& settings = {}) {
    const TestFolder folder;
    Warnings warnings;
    const Sculpt read = readMesh(folder.write("a.glb", sculpt()), {}, warnings);
    const std::string glb = encodeGlb(read, fakeLobes(read), sampleInfo(), {}, warnings);
    Warnings plain, colored;
    EXPECT_TRUE(decodeGlb("a.glb", glb, plain).colors.empty());
    EXPECT_EQ(countOf(plain, WarningKind::kTextureIgnored), 0U);
    const BakedMesh mesh = decodeColoredGlb("a.glb", glb, colored, settings);
    EXPECT_EQ(countOf(colored, WarningKind::kTextureIgnored), ignored);
    EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == mesh.lobes.size());
    return mesh.colors;
  }
};

void expectColors(const std::vector<Vec3>& made, const std::vector<Vec3>& expected, float off = 1e-6F) {
  ASSERT_EQ(made.size(), expected.size());
  for (size_t i = 0; i < made.size(); ++i) EXPECT_LE(length(made[i] - expected[i]), off) << i << ": " << made[i].x << " " << made[i].y;
}

constexpr Vec3 kRed{1, 0, 0}, kGreen{0, 1, 0}, kBlue{0, 0, 1}, kWhite{1, 1, 1};

TEST(OwnColors, AreNoneWhereAllIsWhite) {
  EXPECT_TRUE(Painted().colors().empty());
  Painted white;
  white.material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  white.setTexture();
  white.picture = encodePng({1, 1, {{1, 1, 1}}});
  EXPECT_TRUE(white.colors().empty());
}

TEST(OwnColors, AreLinearFactors) {
  Painted painted;
  painted.material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 1, 1};
  expectColors(painted.colors(), std::vector<Vec3>(4, {0.5F, 0.25F, 1}));
  Painted unset;
  unset.material["pbrMetallicRoughness"]["baseColorFactor"] = {0.8, 0.8, 0.8, 1};
  EXPECT_TRUE(unset.colors().empty());
}

TEST(OwnColors, OfVerticesHaveEveryTypeOfComponent) {
  const std::vector<Vec3> colors{{1, 0.2F, 0}, {0, 0.4F, 0}, {0.6F, 0, 1}, {1, 1, 1}};
  const auto stored = [&]<typename T>(T most, bool has_alpha) {
    std::vector<T> values;
    for (const Vec3& color : colors) {
      for (const float x : {color.x, color.y, color.z}) values.push_back(T(std::lround(double(x) * 1e6) * double(most) / 1e6));
      if (has_alpha) values.push_back(most);
    }
    return values;
  };
  const auto expectStored = [&](const std::function<int(GltfBuilder&)>& accessor) {
    Painted painted;
    painted.primitive["attributes"]["COLOR_0"] = accessor(painted.gltf);
    expectColors(painted.colors(), colors, 1e-4F);
  };
  const auto normalized = [](GltfBuilder& gltf, int index) {
    gltf.json["accessors"][size_t(index)]["normalized"] = true;
    return index;
  };
  expectStored([&](GltfBuilder& gltf) { return gltf.accessor(stored(1.0F, false), 5126, "VEC3", 4); });
  expectStored([&](GltfBuilder& gltf) { return gltf.accessor(stored(1.0F, true), 5126, "VEC4", 4); });
  expectStored([&](GltfBuilder& gltf) { return normalized(gltf, gltf.accessor(stored(uint8_t(255), true), 5121, "VEC4", 4)); });
  expectStored([&](GltfBuilder& gltf) { return normalized(gltf, gltf.accessor(stored(uint16_t(65535), true), 5123, "VEC4", 4)); });
}

TEST(OwnColors, OfTexturesAreBilinearBetweenLinearColors) {
  Painted painted({{0.25F, 0.25F}, {0.75F, 0.25F}, {0.25F, 0.75F}, {0.5F, 0.25F}});
  painted.setTexture();
  expectColors(painted.colors(), {kRed, kGreen, kBlue, {0.5F, 0.5F, 0}});
  Painted grey;
  grey.setTexture();
  grey.picture = encodePng({1, 1, {{128 / 255.0F, 51 / 255.0F, 1}}});
  grey.material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1, 0.5, 1};
  expectColors(grey.colors(), std::vector<Vec3>(4, {0.5F * linearOfSrgb(128 / 255.0F), linearOfSrgb(0.2F), 0.5F}));
}

TEST(OwnColors, OfTexturesWrapAsTheirSamplerSays) {
  const std::vector<Vec2> uvs{{-0.25F, 0.25F}, {1.25F, 0.25F}, {2.25F, 0.25F}, {0.25F, 1.25F}};
  const auto wrappedBy = [&](Json sampler) {
    Painted painted(uvs);
    painted.setTexture();
    painted.sampler = std::move(sampler);
    return painted.colors();
  };
  expectColors(wrappedBy(Json::object()), {kGreen, kRed, kRed, kRed});
  expectColors(wrappedBy({{"wrapS", 33071}, {"wrapT", 33071}}), {kRed, kGreen, kGreen, kBlue});
  expectColors(wrappedBy({{"wrapS", 33648}, {"wrapT", 33648}}), {kRed, kGreen, kRed, kBlue});
}

TEST(OwnColors, OfTexturesAreTransformed) {
  const auto transformedBy = [](const Json& transform) {
    Painted painted({{0.25F, 0.25F}, {0.75F, 0.25F}, {0.25F, 0.75F}, {0.75F, 0.75F}});
    painted.setTexture({{"extensions", {{"KHR_texture_transform", transform}}}});
    return painted.colors();
  };
  expectColors(transformedBy({{"offset", {0.5, 0}}}), {kGreen, kRed, kWhite, kBlue});
  expectColors(transformedBy({{"scale", {3, 1}}}), {kGreen, kRed, kWhite, kBlue});
  // A quarter turn counter-clockwise takes the right of the image, +u, to its top, −v.
  expectColors(transformedBy({{"rotation", kPi / 2}}), {kBlue, kRed, kWhite, kGreen}, 1e-4F);
}

TEST(OwnColors, ReadJpegs) {
  Painted painted;
  painted.setTexture();
  painted.picture = encodeJpeg({8, 8, std::vector<Vec3>(64, {0.8F, 0.4F, 0.2F})}, 95);
  expectColors(painted.colors(), std::vector<Vec3>(4, {linearOfSrgb(0.8F), linearOfSrgb(0.4F), linearOfSrgb(0.2F)}), 0.03F);
}

TEST(OwnColors, AreWhiteWhereTheyCannotBeRead) {
  Painted damaged;
  damaged.setTexture();
  damaged.picture = "no picture";
  EXPECT_TRUE(damaged.colors(1).empty());
  Painted cut = Painted();
  cut.setTexture();
  cut.picture.resize(cut.picture.size() / 2);
  cut.material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 0.5, 1};
  expectColors(cut.colors(1), std::vector<Vec3>(4, {0.5F, 0.25F, 0.5F}));
  Painted large;
  large.setTexture();
  large.picture = encodePng({1000, 1000, std::vector<Vec3>(1000000)});
  ReadSettings little;
  little.memory_limit = 8 << 20;
  EXPECT_TRUE(large.colors(1, little).empty());
  Painted elsewhere;
  elsewhere.setTexture({{"texCoord", 5}});
  EXPECT_TRUE(elsewhere.colors(1).empty());
  Painted odd;
  odd.primitive["attributes"]["COLOR_0"] = odd.gltf.accessor(std::vector<Vec2>(4), 5126, "VEC2", 4);
  EXPECT_TRUE(odd.colors(1).empty());
}

}  // namespace
}  // namespace cloudbake
