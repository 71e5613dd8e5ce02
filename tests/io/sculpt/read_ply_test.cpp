#include <bit>

#include "io/sculpt/read_mesh.h"
#include "tests/io/io_helpers.h"
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
    const SculptPart expected = readWithAssimp(folder.write("a.ply", text), text, "ply", {}, warnings).parts.at(0);
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
    EXPECT_EQ(part.colors, (std::vector<std::array<float, 4>>(3, {1, 1, 0.5F, 0.2F}))) << little_endian;
    EXPECT_EQ(part.triangles, (std::vector<Triangle>{{2, 0, 1}})) << little_endian;
  }
}

TEST(ReadPly, KeepsColoursAndSaysWhatItAssumes) {
  const TestFolder folder;
  const auto file = folder.write("dot.ply", plyText("ascii", 3, kXyz + "property uchar red\nproperty uchar green\nproperty uchar blue\n", 2,
                                                    "0 0 0 255 0 0\n1 0 0 0 255 0\n\n0 1 0 0 0 51\n3 0 1 2\n2 0 1\n"));
  Warnings warnings;
  const Sculpt sculpt = readMesh(file, {}, warnings);
  EXPECT_EQ(sculpt.parts.at(0).colors, (std::vector<std::array<float, 4>>{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 0.2F, 1}}));
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

// What is rarer goes to assimp.
TEST(ReadPly, ReadsUvsOfCorners) {
  const TestFolder folder;
  const SculptPart part = readOne(
      folder, plyText("ascii", 3, kXyz, 1, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n", kList + "property list uchar float texcoord\n"));
  EXPECT_EQ(part.triangles.size(), 1U);
  EXPECT_FALSE(part.uvs.empty());
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
