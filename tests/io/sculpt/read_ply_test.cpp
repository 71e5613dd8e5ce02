#include <algorithm>
#include <bit>

#include "core/srgb.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/vertex_colors.h"
#include "tests/io/io_helpers.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

namespace {

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n", kList = "property list uchar int vertex_indices\n";

std::string plyText(const std::string& format, int vertices, const std::string& properties, int faces, const std::string& rows,
                    const std::string& face_properties = kList) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) + "\n" + properties + "element face " +
         std::to_string(faces) + "\n" + face_properties + "end_header\n" + rows;
}

SculptPart readOne(const TestFolder& folder, const std::string& text) {
  Warnings warnings;
  return readMesh(folder.write("a.ply", text), {}, warnings).parts.at(0);
}

void append(std::string& bytes, uint64_t bits, int count, bool little_endian) {
  for (int i = 0; i < count; ++i) bytes += char(bits >> (8 * (little_endian ? i : count - 1 - i)));
}

// Each vertex has a double, colours of three types and a list that nobody reads; each face an unsigned index.
std::string mixedBinary(bool little_endian) {
  std::string rows;
  for (int v = 0; v < 3; ++v) {
    append(rows, std::bit_cast<uint64_t>(double(v == 1)), 8, little_endian);
    append(rows, std::bit_cast<uint32_t>(v == 2 ? 1.0F : 0.0F), 4, little_endian);
    append(rows, uint16_t(int16_t(-v)), 2, little_endian);
    append(rows, 255, 1, little_endian), append(rows, 65535, 2, little_endian);
    append(rows, std::bit_cast<uint32_t>(0.5F), 4, little_endian), append(rows, 51, 1, little_endian);
    append(rows, 2, 2, little_endian), append(rows, 7, 1, little_endian), append(rows, 8, 1, little_endian);
  }
  append(rows, 9, 4, little_endian);
  append(rows, 3, 4, little_endian);
  for (const uint16_t corner : {2, 0, 1}) append(rows, corner, 2, little_endian);
  return "ply\nformat binary_" + std::string(little_endian ? "little" : "big") +
         "_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\nproperty short z\nproperty uchar red\nproperty ushort green\n"
         "property float blue\nproperty uint8 alpha\nproperty list ushort uchar tags\nelement other 1\nproperty int a\nelement face 1\n"
         "property list int ushort vertex_index\nend_header\n" +
         rows;
}

}  // namespace

// assimp is a reader of its own.
TEST(ReadPly, AgreesWithAssimp) {
  const TestFolder folder;
  const std::string rows =
      "0 0 0 0 0 1 0.25 0.75 255 0 51\n1 0 0 0 0 1 0.5 0.25 0 255 0\n1 1 0.125 0 1 0 1 1 1 2 3\n0 1 0 0 0 1 0 0 9 8 7\n0.3 0.7 2 1 0 0 0.1 "
      "0.9 4 5 6\n"
      "4 0 1 2 3\n3 4 0 1\n";
  const std::string attributes =
      "property float nx\nproperty float ny\nproperty float nz\nproperty float UU\nproperty float VV\nproperty uchar red\nproperty uchar "
      "green\nproperty uchar blue\n";
  for (const auto& [u, v] : {std::pair{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}}) {
    std::string text = plyText("ascii", 5, kXyz + attributes, 2, rows);
    text.replace(text.find("UU"), 2, u), text.replace(text.find("VV"), 2, v);
    Warnings warnings;
    SculptPart expected = readWithAssimp(folder.write("a.ply", text), text, "ply", {}, warnings).parts.at(0);
    decodeVertexColors(expected.colors);  // assimp divides by 255 alone
    const SculptPart part = readOne(folder, text);
    EXPECT_EQ(part.positions, expected.positions);
    EXPECT_EQ(part.normals, expected.normals);
    EXPECT_EQ(part.uvs, expected.uvs) << u;
    EXPECT_EQ(part.colors, expected.colors);
    EXPECT_EQ(part.triangles, expected.triangles);
    EXPECT_EQ(part.uvs.size() + part.colors.size(), 10U);
  }
}

TEST(ReadPly, ReadsEveryTypeAndByteOrder) {
  const TestFolder folder;
  for (const bool little_endian : {true, false}) {
    const SculptPart part = readOne(folder, mixedBinary(little_endian));
    EXPECT_EQ(part.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, -1}, {0, 1, -2}})) << little_endian;
    EXPECT_EQ(part.colors, (std::vector<std::array<float, 4>>(3, {1, 1, linearOfSrgb(0.5F), 0.2F}))) << little_endian;
    EXPECT_EQ(part.triangles, (std::vector<Triangle>{{2, 0, 1}})) << little_endian;
  }
}

TEST(ReadPly, KeepsColoursAndSaysWhatItAssumes) {
  const TestFolder folder;
  const auto file = folder.write("dot.ply", plyText("ascii", 3, kXyz + "property uchar red\nproperty uchar green\nproperty uchar blue\n", 2,
                                                    "0 0 0 255 0 0\n1 0 0 0 255 0\n\n0 1 0 0 0 51\n3 0 1 2\n2 0 1\n"));
  Warnings warnings;
  const Sculpt sculpt = readMesh(file, {}, warnings);
  EXPECT_EQ(sculpt.parts.at(0).colors, (std::vector<std::array<float, 4>>{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, linearOfSrgb(0.2F), 1}}));
  EXPECT_EQ(sculpt.parts[0].material, -1);
  EXPECT_EQ(sculpt.parts[0].name, "dot");
  EXPECT_EQ(countOf(warnings, WarningKind::kUnitsAssumed), 1U);
  EXPECT_EQ(countOf(warnings, WarningKind::kPartIgnored), 1U) << "a line";
  Warnings none;
  readMesh(file, {1.0, UpAxis::kY, {}, {}}, none);
  EXPECT_EQ(countOf(none, WarningKind::kUnitsAssumed), 0U);
}

TEST(ReadPly, ReadsStrips) {
  const TestFolder folder;
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 0\n";
  const std::string element = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  const std::vector<int> corners{0, 1, 2, 3, -1, 1, 4, 3, -1, 0, 1, 1, 2, 3, -1, 2, 4, 2};
  std::string text = std::to_string(corners.size());
  for (const int corner : corners) text += " " + std::to_string(corner);
  std::string binary;
  for (size_t i = 0; i < vertices.size(); i += 2) append(binary, std::bit_cast<uint32_t>(float(vertices[i] - '0')), 4, true);
  append(binary, corners.size(), 4, true);
  for (const int corner : corners) append(binary, uint32_t(corner), 4, true);
  for (const auto& [format, rows] : {std::pair("ascii", vertices + text + "\n"), std::pair("binary_little_endian", binary)}) {
    const SculptPart part = readOne(folder, "ply\nformat " + std::string(format) + " 1.0\nelement vertex 5\n" + kXyz + element + rows);
    EXPECT_EQ(part.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {1, 4, 3}, {1, 2, 3}})) << format;
  }
}

// Two triangles share an edge, whose corners have a UV on each side.
TEST(ReadPly, SplitsVerticesWhereUvsOfCornersDiffer) {
  const TestFolder folder;
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n", uv_list = kList + "property list uchar float texcoord\n";
  const SculptPart seam =
      readOne(folder, plyText("ascii", 4, kXyz, 2, square + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0.5 0 1 1 0 1\n", uv_list));
  EXPECT_EQ(seam.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(seam.uvs, (std::vector<Vec2>{{0, 1}, {1, 1}, {1, 0}, {0.5F, 1}, {0, 0}}));
  EXPECT_EQ(seam.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 2, 4}}));
  // Without a seam the file's vertices stay in their order.
  const SculptPart whole = readOne(folder, plyText("ascii", 4, kXyz, 1, square + "4 3 0 1 2 8 0 1 0 0 1 0 1 1\n", uv_list));
  EXPECT_EQ(whole.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(whole.uvs, (std::vector<Vec2>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}));
}

TEST(ReadPly, CountsUvsThatDoNotFit) {
  const TestFolder folder;
  Warnings warnings;
  const std::string properties = "property float uv_layer_2\n", list = kList + "property list uchar float texcoord\n";
  const auto file = folder.write("a.ply", plyText("ascii", 3, kXyz + properties, 3,
                                                  "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2 6 0 0 1 0 0 1\n"
                                                  "3 0 1 2 4 0 0 1 0\n3 0 2 1 0\n",
                                                  list));
  const SculptPart part = readMesh(file, {}, warnings).parts.at(0);
  EXPECT_EQ(countOf(warnings, WarningKind::kMissingUvSet), 4U) << "three vertices without a UV, one face with two of three";
  EXPECT_EQ(countOf(warnings, WarningKind::kTextureIgnored), 1U) << "uv_layer_2";
  EXPECT_EQ(part.positions.size(), 6U);
}

TEST(ReadPly, MakesAPartPerTexture) {
  const TestFolder folder;
  folder.write("one.png", kPng), folder.write("two.png", kPng);
  std::string text =
      plyText("ascii", 4, kXyz + "property float s\nproperty float t\n", 3,
              "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2 1\n3 0 2 3 0\n3 0 1 3 7\n", kList + "property int texnumber\n");
  text.insert(text.find("element"), "comment TextureFile one.png\ncomment TextureFile two.png\n");
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.ply", text), {}, warnings);
  ASSERT_EQ(sculpt.parts.size(), 3U);
  EXPECT_EQ(sculpt.parts[0].material, 1);
  EXPECT_EQ(sculpt.parts[1].material, 0);
  EXPECT_EQ(sculpt.parts[2].material, -1);
  EXPECT_EQ(sculpt.parts[1].positions, (std::vector<Vec3>{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  ASSERT_EQ(sculpt.materials.size(), 2U);
  EXPECT_EQ(sculpt.images.at(size_t(sculpt.materials[1].base_color_texture.image)).name, "two.png");
  EXPECT_EQ(countOf(warnings, WarningKind::kMaterialIgnored), 1U) << "texture 7";
  ASSERT_EQ(sculpt.nodes.size(), 1U);
}

TEST(ReadPly, ReadsMaterials) {
  const TestFolder folder;
  const std::string material =
      "element material 2\nproperty uchar diffuse_red\nproperty uchar diffuse_green\nproperty uchar diffuse_blue\n"
      "property float specular_power\nproperty float opacity\n";
  std::string text = plyText("ascii", 3, kXyz, 2, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1\n3 0 2 1 0\n255 255 255 0 1\n128 0 255 30 0.5\n",
                             kList + "property int material_index\n");
  text.insert(text.find("end_header"), material);
  const Sculpt sculpt = [&] {
    Warnings warnings;
    return readMesh(folder.write("a.ply", text), {}, warnings);
  }();
  ASSERT_EQ(sculpt.materials.size(), 2U);
  EXPECT_EQ(sculpt.parts.at(0).material, 1);
  EXPECT_EQ(sculpt.materials[1].base_color, (std::array<float, 4>{linearOfSrgb(128.0F / 255), 0, 1, 0.5F}));
  EXPECT_TRUE(sculpt.materials[1].blended);
  EXPECT_FLOAT_EQ(sculpt.materials[1].roughness, 0.25F);
}

TEST(ReadPly, KeepsColoursOfFacesUnlessVerticesHaveSome) {
  const TestFolder folder;
  const std::string square = "0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 0 9 9 9\n",
                    rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string faces = "3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";
  const SculptPart part =
      readOne(folder, plyText("ascii", 4, kXyz + "property int a\nproperty int b\nproperty int c\n", 2, square + faces, kList + rgb));
  ASSERT_EQ(part.colors.size(), 6U);
  EXPECT_EQ(part.colors[0], (VertexColor{1, 0, 0, 1}));
  EXPECT_EQ(part.colors[5], (VertexColor{0, 0, 1, 1}));
  Warnings warnings;
  const SculptPart both =
      readMesh(folder.write("b.ply", plyText("ascii", 4, kXyz + rgb, 2, square + faces, kList + rgb)), {}, warnings).parts.at(0);
  EXPECT_EQ(both.colors,
            std::vector<VertexColor>(4, VertexColor{linearOfSrgb(9.0F / 255), linearOfSrgb(9.0F / 255), linearOfSrgb(9.0F / 255), 1}));
  EXPECT_EQ(countOf(warnings, WarningKind::kMaterialIgnored), 2U);
}

// 16 bits run to 65535; other numbers to 255 if one is above 1.
TEST(ReadPly, ScalesColoursByTheirType) {
  const TestFolder folder;
  const auto colorOf = [&](const std::string& type, const std::string& numbers) {
    const std::string rgb = "property " + type + " red\nproperty " + type + " green\nproperty " + type + " blue\n";
    return readOne(folder, plyText("ascii", 3, kXyz + rgb, 1, "0 0 0 " + numbers + "\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n")).colors.at(0);
  };
  const VertexColor expected{linearOfSrgb(128.0F / 255), linearOfSrgb(64.0F / 255), linearOfSrgb(32.0F / 255), 1};
  for (const char* type : {"uchar", "int", "ushort", "float", "double"}) EXPECT_EQ(colorOf(type, "128 64 32"), expected) << type;
  EXPECT_EQ(colorOf("ushort", "65535 0 257"), (VertexColor{1, 0, linearOfSrgb(257.0F / 65535), 1}));
  EXPECT_EQ(colorOf("float", "1 0 0.5"), (VertexColor{1, 0, linearOfSrgb(0.5F), 1}));
}

TEST(ReadPly, ReadsElementsInAnyOrderAndOldLineEnds) {
  const TestFolder folder;
  const std::string header = "ply\nformat ascii 1.0\nelement face 1\n" + kList + "element vertex 3\n" + kXyz + "end_header\n";
  std::string text = header + "3 2 0 1\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(readOne(folder, text).triangles, (std::vector<Triangle>{{2, 0, 1}}));
  std::replace(text.begin(), text.end(), '\n', '\r');
  EXPECT_EQ(readOne(folder, text).triangles, (std::vector<Triangle>{{2, 0, 1}}));
  expectError<InputError>([&] { readOne(folder, header + "3 3 0 1\n0 0 0\n1 0 0\n0 1 0\n"); }, "a face uses vertex 3 of 3");
  expectError<InputError>([&] { readOne(folder, header + "3 -1 0 1\n0 0 0\n1 0 0\n0 1 0\n"); }, "face 0 uses vertex -1; the file");
  // A binary file whose data begins with a line feed.
  std::string binary = mixedBinary(true);
  const size_t data = binary.find("end_header") + 11;
  std::replace(binary.begin(), binary.begin() + ptrdiff_t(data), '\n', '\r');
  binary[data] = '\n';
  EXPECT_EQ(readOne(folder, binary).triangles, (std::vector<Triangle>{{2, 0, 1}}));
}

TEST(ReadPly, NamesWhatIsWrongAndWhere) {
  const TestFolder folder;
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  const auto expectRefused = [&](const std::string& text, const std::string& what) {
    expectError<InputError>([&] { readOne(folder, text); }, what);
  };
  expectRefused(plyText("ascii", 3, kXyz, 1, "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"),
                "a.ply:11: a value of vertex 1 is not a number ('zero')");
  expectRefused(plyText("ascii", 3, kXyz, 1, vertices + "3 0 1 3\n"), "a.ply:13: face 0 uses vertex 3 of 3");
  expectRefused(plyText("ascii", 3, kXyz, 1, vertices + "3 0 1 -1\n"), "face 0 uses vertex -1 of 3");
  expectRefused(plyText("ascii", 3, kXyz, 1, vertices + "3 0 1 1.5\n"), "face 0 uses vertex '1.5' of 3");
  expectRefused(plyText("ascii", 3, kXyz, 1, vertices + "3 0 1 99999999999999999999\n"), "face 0 uses vertex '99999999999999999999' of 3");
  expectRefused(plyText("ascii", 3, kXyz, 1, vertices + "99999999999999999999 0 1 2\n"),
                "a.ply:13: the length of a list is '99999999999999999999', which is no count");
  expectRefused(plyText("ascii", 3, kXyz, 1, vertices + "x 0 1 2\n"), "the length of a list is 'x', which is no count");
  expectRefused("ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n" + kXyz + "end_header\n",
                "a.ply:3: the number of rows of an element is '99999999999999999999', not a whole number from 0 to 4294967295");
  expectRefused(plyText("ascii", 3, kXyz, 1, vertices + "3 0 1 2\n", "property list uchar int corners\n"),
                "a.ply:7: the faces have no list vertex_indices");
  expectRefused(plyText("ascii", 3, "property float x\nproperty float y\nproperty float w\n", 1, vertices + "3 0 1 2\n"),
                "a.ply:3: the vertices have no x, y and z");
  expectRefused(plyText("ascii", 3, kXyz, 2, vertices + "3 0 1 2\n"), "the PLY ends after 1 of 2 rows");
  expectRefused("ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz + "end_header\n" + vertices, "no triangles");
}
