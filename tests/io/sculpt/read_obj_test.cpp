#include <algorithm>

#include "core/srgb.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/referenced_files.h"
#include "tests/io/io_helpers.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

namespace {

struct Read {
  Sculpt sculpt;
  Warnings warnings;
  uint64_t count(WarningKind kind) const { return countOf(warnings, kind); }
  std::string text(WarningKind kind) const {
    const auto found = warnings.entries().find(kind);
    return found == warnings.entries().end() ? "" : found->second.first;
  }
};

Read readWithWarnings(const std::filesystem::path& file, const ReadSettings& settings = {1.0, UpAxis::kY, {}, {}}) {
  Read result;
  result.sculpt = readMesh(file, settings, result.warnings);
  return result;
}

std::vector<std::string> namesOf(const auto& things) {
  std::vector<std::string> names;
  for (const auto& thing : things) names.push_back(thing.name);
  return names;
}

using Names = std::vector<std::string>;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\n";

}  // namespace

TEST(ReadObj, ObjectsAndGroupsAreNodes) {
  const TestFolder folder;
  const Read r = readWithWarnings(
      folder.write("a.obj", kSquare + "f 1 2 3\no Body  \nf 1 3 4\ng left arm\nf 1 2 5\no Empty\no Tail\ng default\nf 2 3 5\n"
                                      "o Body\nf 3 4 5\ng left arm\nf 4 1 5\n"));
  EXPECT_EQ(namesOf(r.sculpt.nodes), (Names{"a", "Body", "left arm", "Empty", "Tail", "Body", "left arm"}));
  const std::vector<int> parents{-1, -1, 1, -1, -1, -1, 5};
  for (size_t i = 0; i < parents.size(); ++i) EXPECT_EQ(r.sculpt.nodes[i].parent, parents[i]) << i;
  EXPECT_EQ(namesOf(r.sculpt.parts), (Names{"a", "Body", "left arm", "Tail", "Body", "left arm"}));
  EXPECT_NE(r.sculpt.parts[1].object, r.sculpt.parts[4].object) << "two objects may have one name";
  EXPECT_EQ(r.sculpt.parts[1].object, r.sculpt.parts[2].object) << "a group belongs to its object";
  EXPECT_NE(r.sculpt.parts[1].object, r.sculpt.parts[3].object);
}

TEST(ReadObj, GroupsOfOneNameAndObjectAreOne) {
  const TestFolder folder;
  const Read r = readWithWarnings(folder.write("a.obj", kSquare + "o A\ng x\nf 1 2 3\ng y\nf 1 3 4\ng x\nf 1 2 5\no B\ng x\nf 2 3 5\n"));
  EXPECT_EQ(namesOf(r.sculpt.parts), (Names{"x", "y", "x"}));
  EXPECT_EQ(r.sculpt.parts[0].triangles.size(), 2U);
}

// A face in a smoothing group has the normals of the group's surface; the others in such a file have their own.
TEST(ReadObj, SmoothingGroupsGiveNormals) {
  const TestFolder folder;
  const std::string roof = "v 0 0 0\nv 2 0 0\nv 2 1 1\nv 0 1 1\nv 2 0 2\nv 0 0 2\n", left = "f 1 4 3 2\n", right = "f 4 6 5 3\n";
  const SculptPart smooth = readWithWarnings(folder.write("a.obj", roof + "s 1\n" + left + right)).sculpt.parts.at(0);
  EXPECT_EQ(smooth.positions.size(), 6U) << "the file's vertices";
  ASSERT_EQ(smooth.normals.size(), 6U);
  EXPECT_NEAR(smooth.normals[2].y, 1, 1e-6) << "the ridge points up";
  EXPECT_NEAR(smooth.normals[0].z, -std::sqrt(0.5F), 1e-6);
  const SculptPart two = readWithWarnings(folder.write("b.obj", roof + "s 1\n" + left + "s 2\n" + right)).sculpt.parts.at(0);
  EXPECT_EQ(two.positions.size(), 8U) << "the ridge has a normal per group";
  const SculptPart half = readWithWarnings(folder.write("c.obj", roof + "s 1\n" + left + "s off\n" + right)).sculpt.parts.at(0);
  EXPECT_EQ(half.positions.size(), 8U);
  for (const char* none : {"", "s off\n", "s 0\n"})
    EXPECT_TRUE(readWithWarnings(folder.write("d.obj", roof + none + left + right)).sculpt.parts.at(0).normals.empty()) << none;
  const std::string given = "vn 0 1 0\ns 1\nf 1//1 4//1 3//1 2//1\n" + right;
  const SculptPart own = readWithWarnings(folder.write("e.obj", roof + given)).sculpt.parts.at(0);
  EXPECT_EQ(own.normals.at(0), (Vec3{0, 1, 0})) << "a normal of the file stays";
}

// Each part keeps the vertices that it uses, in the order of the file.
TEST(ReadObj, PartsKeepTheirVerticesInOrder) {
  const TestFolder folder;
  const Read r = readWithWarnings(folder.write("a.obj", kSquare + "o A\nf 3 2 1\no B\nf 5 3 4\n"));
  EXPECT_EQ(r.sculpt.parts[0].positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(r.sculpt.parts[0].triangles, (std::vector<Triangle>{{2, 1, 0}}));
  EXPECT_EQ(r.sculpt.parts[1].positions, (std::vector<Vec3>{{1, 1, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(r.count(WarningKind::kUnreferencedVertex), 1U) << "no part uses 9 9 9";
}

TEST(ReadObj, APartPerMaterialOfAnObject) {
  const TestFolder folder;
  const Read r =
      readWithWarnings(folder.write("a.obj", kSquare + "usemtl red clay\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl red clay\nf 1 2 5\n"));
  EXPECT_EQ(namesOf(r.sculpt.materials), (Names{"red clay", "blue"})) << "a material that no library defines keeps its name";
  ASSERT_EQ(r.sculpt.parts.size(), 2U);
  EXPECT_EQ(r.sculpt.parts[0].triangles.size(), 2U);
  EXPECT_EQ(r.sculpt.parts[0].material, 0);
  EXPECT_EQ(r.sculpt.parts[1].material, 1);
  EXPECT_EQ(r.sculpt.parts[0].node, r.sculpt.parts[1].node);
  EXPECT_EQ(namesOf(r.sculpt.nodes), Names{"a"});
  EXPECT_EQ(r.count(WarningKind::kMaterialIgnored), 2U);
}

TEST(ReadObj, MaterialsBecomeThoseOfGltf) {
  const TestFolder folder;
  folder.write("c.png", kPng), folder.write("r.png", kPng + "r");
  folder.write("a.mtl",
               "newmtl phong\nKd 0.25 0.5 1\nKs 1 1 1\nNs 98\nd 0.5\nKe 4 2 0\nmap_Kd -o 0.25 0.5 0 -s 2 4 1 c.png\n"
               "newmtl pbr\r\nPr 0.3\r\nPm 0.75\r\nmap_Kd -clamp on c.png\r\nmap_Ke c.png\r\n"
               "newmtl rough\nmap_Pr r.png\nnewmtl clear\nTr 0.75\nnewmtl plain\n");
  std::string obj = "mtllib a.mtl\n" + kSquare;
  for (const char* name : {"phong", "pbr", "rough", "clear", "plain"}) obj += "usemtl " + std::string(name) + "\nf 1 2 3\nf 1 3 4\n";
  const Read r = readWithWarnings(folder.write("a.obj", obj));
  ASSERT_EQ(r.sculpt.materials.size(), 5U);
  const SculptMaterial &phong = r.sculpt.materials[0], &pbr = r.sculpt.materials[1], &rough = r.sculpt.materials[2];
  EXPECT_EQ(phong.base_color, (std::array<float, 4>{0.25F, 0.5F, 1, 0.5F}));
  EXPECT_TRUE(phong.blended);
  EXPECT_FLOAT_EQ(phong.roughness, std::sqrt(2.0F / 100));
  EXPECT_EQ(phong.metallic, 0);
  EXPECT_EQ(phong.emission, (std::array<float, 3>{4, 2, 0}));
  // u' = 2 u + 0.25, and v' = 4 v + 0.5 for v that grows upwards.
  EXPECT_EQ(phong.base_color_texture.scale, (Vec2{2, 4}));
  EXPECT_EQ(phong.base_color_texture.offset, (Vec2{0.25F, 1 - 4 - 0.5F}));
  EXPECT_EQ(pbr.roughness, 0.3F);
  EXPECT_EQ(pbr.metallic, 0.75F);
  EXPECT_EQ(pbr.base_color, (std::array<float, 4>{1, 1, 1, 1})) << "a texture alone is not darkened";
  EXPECT_EQ(pbr.base_color_texture.wrap, TextureWrap::kClamp);
  EXPECT_EQ(pbr.emission, (std::array<float, 3>{1, 1, 1})) << "map_Ke without Ke shines";
  EXPECT_EQ(pbr.emissive_texture.image, pbr.base_color_texture.image) << "a file is read once";
  EXPECT_EQ(rough.metallic_roughness_texture.image, 1);
  EXPECT_EQ(rough.roughness, 1) << "the texture alone decides";
  EXPECT_EQ(r.sculpt.materials[3].base_color[3], 0.25F);
  EXPECT_EQ(r.sculpt.materials[4].roughness, 1);
  EXPECT_FALSE(r.sculpt.materials[4].blended);
  EXPECT_EQ(namesOf(r.sculpt.images), (Names{"c.png", "r.png"}));
  EXPECT_EQ(r.sculpt.images[0].bytes, kPng);
  EXPECT_EQ(r.warnings.entries().size(), 1U) << "vertices that no face uses; " << r.text(WarningKind::kTextureIgnored)
                                             << r.text(WarningKind::kMaterialIgnored);
}

// Each thing that is not kept is counted, and says why.
TEST(ReadObj, CountsWhatIsNotKept) {
  const TestFolder folder;
  folder.write("c.tga", "a tga"), folder.write("c.png", kPng);
  folder.write("a.mtl",
               "newmtl a\nmap_Kd c.tga\nKd 2 0 0\nTf 1 0.5 1\nmap_Ks c.png\nmap_d c.png\nmap_Pm c.png\nmap_Ke gone.png\nmap_Bump c.png\n");
  const Read r = readWithWarnings(
      folder.write("a.obj", "mtllib a.mtl\nmtllib gone.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nf 1 3 4\nl 1 2\nvp 1 2\ncurv2 1 2\n"));
  EXPECT_EQ(r.count(WarningKind::kImageNotEmbedded), 2U) << "c.tga and gone.png";
  EXPECT_EQ(r.count(WarningKind::kMaterialIgnored), 3U) << "gone.mtl, Kd out of range, Tf";
  EXPECT_EQ(r.count(WarningKind::kTextureIgnored), 4U) << "map_Ks, map_d, map_Pm, and a bump map that is no normal map";
  EXPECT_EQ(r.count(WarningKind::kPartIgnored), 1U);
  EXPECT_EQ(r.count(WarningKind::kCurveIgnored), 2U);
  EXPECT_EQ(r.sculpt.materials.at(0).base_color[0], 1);
  const Read other = readWithWarnings(folder.write("b.obj", "mtllib a.mtl\n" + kSquare + "usemtl b\nf 1 2 3\n"));
  EXPECT_NE(other.text(WarningKind::kMaterialIgnored).find("no library defines material 'b'"), std::string::npos);
}

TEST(ReadObj, AnImageThatIsNotKeptIsInNoMaterial) {
  const TestFolder folder;
  folder.write("c.png", kPng), folder.write("d.png", kPng + "2"), folder.write("c.tga", "a tga");
  folder.write("a.mtl", "newmtl a\nmap_Kd c.png\nnewmtl b\nmap_Kd d.png\nnewmtl c\nmap_Kd c.tga\nnewmtl d\nmap_Kd c.tga\n");
  const Read r = readWithWarnings(
      folder.write("a.obj", "mtllib a.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 3\nusemtl d\nf 1 3 4\n"));
  ASSERT_EQ(r.sculpt.materials.size(), 4U);
  for (const size_t m : {2, 3}) EXPECT_EQ(r.sculpt.materials[m].base_color_texture.image, -1) << r.sculpt.materials[m].name;
}

TEST(ReadObj, PlacesOfTexturesAreFinite) {
  const TestFolder folder;
  folder.write("c.png", kPng);
  folder.write("a.mtl", "newmtl a\nmap_Kd -s 1e39 2 1 c.png\n");
  const Read r = readWithWarnings(folder.write("a.obj", "mtllib a.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nf 1 3 4\n"));
  ASSERT_EQ(r.sculpt.materials.size(), 1U);
  EXPECT_EQ(r.sculpt.materials[0].base_color_texture.scale.x, 1);
  EXPECT_EQ(r.sculpt.materials[0].base_color_texture.image, 0);
  EXPECT_EQ(r.count(WarningKind::kMaterialIgnored), 1U);
}

TEST(ReadObj, LibrariesAndTexturesOutsideAreRefusedUnlessAllowed) {
  const TestFolder folder;
  std::filesystem::create_directories(folder.path / "in");
  folder.write("a.mtl", "newmtl a\nKd 0 0 1\nmap_Kd c.png\n"), folder.write("in/b.mtl", "newmtl b\nmap_Kd ../c.png\n");
  folder.write("c.png", kPng);
  const auto file = folder.write("in/a.obj", "mtllib ../a.mtl\nmtllib b.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n");
  const Read refused = readWithWarnings(file);
  EXPECT_EQ(refused.sculpt.materials[0].base_color[0], 1) << "only the name was kept";
  EXPECT_NE(refused.text(WarningKind::kMaterialIgnored).find("--allow-outside"), std::string::npos);
  EXPECT_NE(refused.text(WarningKind::kImageNotEmbedded).find("--allow-outside"), std::string::npos);
  EXPECT_TRUE(refused.sculpt.images.empty());
  ReadSettings allow{.metres_per_unit = 1.0, .up_axis = UpAxis::kY, .allow_outside = true};
  const Read allowed = readWithWarnings(file, allow);
  EXPECT_EQ(allowed.sculpt.materials[0].base_color[0], 0);
  EXPECT_EQ(allowed.sculpt.images.size(), 1U) << "one file, named relative to each library";
  EXPECT_EQ(allowed.warnings.entries().size(), 1U) << "vertices that no face uses";
}

TEST(ReadObj, ALibraryMayHaveBlanksInItsName) {
  const TestFolder folder;
  folder.write("my clay.mtl", "newmtl a\nPr 0.5\n"), folder.write("x.mtl", "newmtl b\nPr 0.25\n"),
      folder.write("y.mtl", "newmtl c\nPr 0.125\n");
  const Read r = readWithWarnings(folder.write(
      "a.obj", "mtllib my clay.mtl\nmtllib x.mtl y.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 5\n"));
  EXPECT_EQ(r.sculpt.materials[0].roughness, 0.5F);
  EXPECT_EQ(r.sculpt.materials[1].roughness, 0.25F);
  EXPECT_EQ(r.sculpt.materials[2].roughness, 0.125F);
}

TEST(ReadObj, NamesOfOtherEncodingsBecomeUtf8) {
  const TestFolder folder;
  const Read r = readWithWarnings(folder.write("a.obj", kSquare + "o tr\xE6\nusemtl gr\xF8n\nf 1 2 3\n"));
  EXPECT_EQ(r.sculpt.nodes.at(0).name, "træ");
  EXPECT_EQ(r.sculpt.parts.at(0).name, "træ");
  EXPECT_EQ(r.sculpt.materials.at(0).name, "grøn");
}

TEST(ReadObj, KeepsVertexColours) {
  const TestFolder folder;
  const Read r =
      readWithWarnings(folder.write("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 0 1 0\nv 0 1 0\nv 0 0 1 1\no a\nf 1 2 3\no b\nf 4 3 3\nf 4 4 3\n"));
  EXPECT_EQ(r.sculpt.parts[0].colors, (std::vector<std::array<float, 4>>{{1, linearOfSrgb(0.5F), 0, 1}, {0, 1, 0, 1}, {1, 1, 1, 1}}));
  EXPECT_TRUE(r.sculpt.parts[1].colors.empty()) << "a fourth number is a weight, not a colour";
  EXPECT_EQ(r.count(WarningKind::kMissingColor), 1U);
}

TEST(ReadObj, ScalesColoursUpTo255) {
  const TestFolder folder;
  const Read r = readWithWarnings(folder.write("a.obj", "v 0 0 0 255 128 0\nv 1 0 0 1 0 0\nv 0 1 0 0 0 255\nf 1 2 3\n"));
  EXPECT_EQ(r.sculpt.parts[0].colors[0], (std::array<float, 4>{1, linearOfSrgb(128.0F / 255), 0, 1}));
  EXPECT_EQ(r.sculpt.parts[0].colors[1], (std::array<float, 4>{linearOfSrgb(1.0F / 255), 0, 0, 1}));
}

TEST(ReadObj, KeywordsMayBeIndentedAndFollowAMark) {
  const TestFolder folder;
  folder.write("a.mtl", "\xEF\xBB\xBF newmtl\tred\r\tKd\t1 0 0\r");
  const std::string obj = "\xEF\xBB\xBF\tmtllib\ta.mtl\n v\t0 0 0\n\tv 1 0 0\n  v 0 1 0\n\tusemtl\tred\n  f\t1 2 3\n";
  const Read r = readWithWarnings(folder.write("a.obj", obj));
  EXPECT_EQ(r.sculpt.materials.at(0).base_color, (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_EQ(r.count(WarningKind::kMaterialIgnored), 0U);
  EXPECT_EQ(referencedFiles(folder.path / "a.obj", obj, {}).size(), 1U);
}

// Lines as old programs end them, and words between odd blanks.
TEST(ReadObj, LinesEndInACarriageReturnToo) {
  const TestFolder folder;
  std::string obj = "v 0 0 0 1 0 0\nv\f1 0 0 0 1 0\nv 0\v1 0 0 0 1\nf 1 2 3\n";
  std::replace(obj.begin(), obj.end(), '\n', '\r');
  const Read r = readWithWarnings(folder.write("a.obj", obj + "f 1 2 \\\r3\r"));
  ASSERT_EQ(r.sculpt.parts.size(), 1U);
  EXPECT_EQ(r.sculpt.parts[0].triangles.size(), 2U);
  EXPECT_EQ(r.sculpt.parts[0].colors.size(), 3U);
  expectError<InputError>([&] { readWithWarnings(folder.write("b.obj", "v 0 0 0\rv 1 0 nan\rv 0 1 0\rf 1 2 3\r")); }, "b.obj:2");
  // A word that only one of two parsers takes for a key must not shift the colours.
  expectError<InputError>([&] { readWithWarnings(folder.write("c.obj", "v 1 0 0\nusemtl a\rv \nv 1 1 0 1 0 0\nv 0 1 0\nf 1 2 3\n")); },
                          "c.obj:3");
}

// Positions are the floats nearest to what is written, also where a sum of digits in double precision is not.
TEST(ReadObj, NumbersAreRoundedCorrectly) {
  const TestFolder folder;
  const Read r = readWithWarnings(
      folder.write("a.obj", "v 0.3000000119 16777217 -1.17549435e-38\nv +1. .5 1e-60\nv 8388609.49999999999 0.1 123456.789\nf 1 2 3\n"));
  EXPECT_EQ(r.sculpt.parts[0].positions,
            (std::vector<Vec3>{{0.3F, 16777216.0F, -1.17549435e-38F}, {1, 0.5F, 0}, {8388609.0F, 0.1F, 123456.789F}}));
}

// Every form of a corner, counted from the front and from the end.
TEST(ReadObj, CornersHaveFourForms) {
  const TestFolder folder;
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.5\nvt 0.75\nvn 0 0 1\nvn 1 0 0\n";
  const Read r = readWithWarnings(folder.write("a.obj", points + "f 1/1/1 2/-1/2 3//-2\nf 1/1/1 -2/2/-1 +3//1\n"));
  const SculptPart& part = r.sculpt.parts.at(0);
  EXPECT_EQ(part.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << "equal corners are one vertex";
  EXPECT_EQ(part.uvs, (std::vector<Vec2>{{0.25F, 0.5F}, {0.75F, 1}, {0, 0}}));
  EXPECT_EQ(part.normals, (std::vector<Vec3>{{0, 0, 1}, {1, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(part.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}}));
  const Read other = readWithWarnings(folder.write("b.obj", points + "f 1/1 2/1/1 3\nf 1//1 2/1/1 3/2\n"));
  EXPECT_EQ(other.sculpt.parts.at(0).positions.size(), 5U) << "a position is one vertex per UV and normal";
  for (const char* face : {"f 1 2 x", "f 1 2 0", "f 1 2 4", "f 1 2 -4", "f 1/3 2 3", "f 1//3 2 3", "f 1/1/-3 2 3", "f 1 2 99999999999",
                           "f 1/1/1/1 2 3", "f 1/1/1/ 2 3", "f 1//1/1 2 3"})
    expectError<InputError>([&] { readWithWarnings(folder.write("c.obj", points + "f 1 2 3\n" + face + "\n")); }, "c.obj:9");
}

// The numbers after one that is not finite do not take its place.
TEST(ReadObj, NumbersOfMaterialsThatAreNotFiniteAreCounted) {
  const TestFolder folder;
  folder.write("a.mtl", "newmtl a\nKd 1e99 0.25 0.5\nPr nan\nPm 0.5\n");
  const Read r = readWithWarnings(folder.write("a.obj", "mtllib a.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nf 1 3 4\n"));
  EXPECT_EQ(r.count(WarningKind::kMaterialIgnored), 2U);
  const std::string first = r.text(WarningKind::kMaterialIgnored);
  EXPECT_NE(first.find("a.mtl:2: Kd of material 'a' has '1e99', which is not finite"), std::string::npos) << first;
  EXPECT_EQ(r.sculpt.materials.at(0).base_color, SculptMaterial().base_color);
  EXPECT_EQ(r.sculpt.materials.at(0).metallic, 0.5F);
}

// Corners that two parts share are vertices of both.
TEST(ReadObj, PartsWithNormalsShareNoVertices) {
  const TestFolder folder;
  const Read r = readWithWarnings(
      folder.write("a.obj", kSquare + "vn 0 0 1\no A\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\no B\nf 3//1 1//1 2//1\nf 5//1 3//1 1//1\n"));
  ASSERT_EQ(r.sculpt.parts.size(), 2U);
  EXPECT_EQ(r.sculpt.parts[1].positions, (std::vector<Vec3>{{1, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(r.sculpt.parts[1].triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 0, 1}}));
}

// A face of two corners leaves nothing behind: the file still has positions alone, whose order is kept.
TEST(ReadObj, AFaceOfTwoCornersIsNone) {
  const TestFolder folder;
  const Read r = readWithWarnings(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 3 2 1\nf 1/1 2/1\n"));
  EXPECT_EQ(r.sculpt.parts[0].positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(r.sculpt.parts[0].triangles, (std::vector<Triangle>{{2, 1, 0}}));
  EXPECT_EQ(r.count(WarningKind::kDegenerateTriangle), 1U);
}

TEST(ReadObj, UnitsAndAxisAreAssumedAloud) {
  const TestFolder folder;
  const auto file = folder.write("a.obj", kTetrahedronObj);
  EXPECT_NE(readWithWarnings(file, {}).text(WarningKind::kUnitsAssumed).find("assumed metres, +Y up; --units and --up choose"),
            std::string::npos);
  EXPECT_NE(readWithWarnings(file, {0.01, {}, {}, {}}).text(WarningKind::kUnitsAssumed).find("assumed +Y up;"), std::string::npos);
  EXPECT_NE(readWithWarnings(file, {{}, UpAxis::kZ, {}, {}}).text(WarningKind::kUnitsAssumed).find("assumed metres;"), std::string::npos);
  EXPECT_TRUE(readWithWarnings(file).warnings.empty());
}
