#include "io/sculpt/child_reader.h"
#include "io/sculpt/read_mesh.h"
#include "tests/io/io_helpers.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

// Hierarchy, materials, textures, colours and UV sets, read here and by a child process.
TEST(ReadAssimp, KeepsWhatGltfCanHold) {
  const TestFolder folder;
  folder.write("skin.png", kPng);
  const auto file = folder.write("a.dae", texturedDae());
  for (const char* child : {"", "/proc/self/exe"}) {
    Warnings warnings;
    ReadSettings settings;
    settings.child_program = child;
    const Sculpt sculpt = readMesh(file, settings, warnings);
    std::vector<std::pair<std::string, int>> nodes;
    for (const SculptNode& one : sculpt.nodes) nodes.emplace_back(one.name, one.parent);
    EXPECT_EQ(nodes, (std::vector<std::pair<std::string, int>>{{"Empty", -1}, {"Body", 0}, {"Twin", 0}, {"Eye", -1}, {"Lamp", -1}}));
    ASSERT_EQ(sculpt.parts.size(), 2U);
    const SculptPart &body = sculpt.parts[0], &twin = sculpt.parts[1];
    EXPECT_EQ(body.node, 1);
    EXPECT_EQ(twin.node, 2);
    EXPECT_NE(body.object, twin.object);
    EXPECT_EQ(transformPoint(body.to_scene, {1, 1, 1}), (Vec3{2, 2, 7}));
    EXPECT_EQ(transformPoint(sculpt.nodes[1].local, {1, 1, 1}), (Vec3{2, 2, 2}));
    EXPECT_EQ(transformPoint(twin.to_scene, {1, 1, 1}), (Vec3{10, 1, 6}));
    // The corners in order of first use: 0 2 1 3.
    EXPECT_EQ(body.uvs, (std::vector<Vec2>{{0, 1}, {0, 0}, {1, 1}, {1, 0}}));
    ASSERT_EQ(body.more_uvs.size(), 1U);
    EXPECT_EQ(body.more_uvs[0], (std::vector<Vec2>{{0, 1}, {0, 0.5F}, {0.5F, 1}, {0.5F, 0.5F}}));
    EXPECT_EQ(body.colors, (std::vector<std::array<float, 4>>{{1, 0, 0, 1}, {0, 0, 1, 1}, {0, 1, 0, 1}, {1, 1, 1, 1}}));
    ASSERT_EQ(sculpt.materials.size(), 1U);
    EXPECT_EQ(body.material, 0);
    EXPECT_EQ(sculpt.materials[0].name, "clay");
    EXPECT_EQ(sculpt.materials[0].emission, (std::array<float, 3>{0, 0, 0.5F}));
    EXPECT_FLOAT_EQ(sculpt.materials[0].roughness, 0.25F) << "sqrt(2 / (30 + 2))";
    EXPECT_EQ(sculpt.materials[0].base_color_texture.image, 0);
    ASSERT_EQ(sculpt.images.size(), 1U);
    EXPECT_EQ(sculpt.images[0].name, "skin.png");
    EXPECT_EQ(sculpt.images[0].bytes, kPng);
    EXPECT_EQ(countOf(warnings, WarningKind::kCameraIgnored), 1U);
    EXPECT_EQ(countOf(warnings, WarningKind::kLightIgnored), 1U);
  }
}

TEST(ReadAssimp, CountsTexturesThatCannotBeStored) {
  const TestFolder folder;
  const auto file = folder.write("a.dae", texturedDae());
  const auto imagesOf = [&](const char* name, uint64_t expected) {
    std::string text = texturedDae();
    Warnings warnings;
    const Sculpt sculpt = readMesh(folder.write("a.dae", text.replace(text.find("skin.png"), 8, name)), {}, warnings);
    EXPECT_EQ(countOf(warnings, WarningKind::kImageNotEmbedded), expected) << name;
    EXPECT_EQ(sculpt.images.size(), expected == 0 ? 1U : 0U) << name;
    EXPECT_EQ(sculpt.materials.at(0).name, "clay");
  };
  folder.write("skin.png", kPng), folder.write("skin.tga", "tga");
  imagesOf("skin.png", 0);
  imagesOf("C:\\somewhere\\skin.png", 0);  // found beside the sculpt
  imagesOf("gone.png", 1);
  imagesOf("skin.tga", 1);
  imagesOf("../../../../../../../etc/hostname", 1);
}

// Every kind of texture that glTF has no place for is counted, unless it is the image that is kept anyway.
TEST(ReadAssimp, CountsTexturesThatAreNotKept) {
  const TestFolder folder;
  folder.write("skin.png", kPng), folder.write("other.png", kPng);
  const auto ignoredWith = [&](const std::string& phong, const std::string& sampler) {
    std::string text = texturedDae();
    const std::string own = "</newparam><technique";
    text.insert(
        text.find(own) + 11,
        "<newparam sid=\"g\"><surface type=\"2D\"><init_from>j</init_from></surface></newparam><newparam sid=\"y\"><sampler2D><source>g"
        "</source></sampler2D></newparam>");
    text.insert(text.find("</library_images>"), "<image id=\"j\" name=\"j\"><init_from>other.png</init_from></image>");
    text.insert(text.find("<shininess>"), "<" + phong + "><texture texture=\"" + sampler + "\" texcoord=\"a\"/></" + phong + ">");
    Warnings warnings;
    readMesh(folder.write("a.dae", text), {}, warnings);
    return countOf(warnings, WarningKind::kTextureIgnored);
  };
  for (const char* phong : {"ambient", "specular", "reflective", "transparent"}) {
    EXPECT_EQ(ignoredWith(phong, "y"), 1U) << phong;
    EXPECT_EQ(ignoredWith(phong, "x"), 0U) << phong;
  }
}
