#include "io/sculpt/read_mesh.h"

#include <cstring>

#include "core/srgb.h"
#include "io/sculpt/triangulate.h"
#include "tests/io/io_helpers.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

namespace {

Sculpt read(const std::filesystem::path& file, const ReadSettings& settings = {}) {
  Warnings warnings;
  return readMesh(file, settings, warnings);
}

const std::vector<Vec3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> kFaces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

const std::string kTetrahedronOff = "OFF # a tetrahedron\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2\n3 1 2 3\n";
const std::string kTetrahedronPly =
    "ply\nformat ascii 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string asciiStl() {
  std::string text = "solid tetrahedron\n";
  for (const Triangle& t : kFaces) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const uint32_t i : t)
      text +=
          "  vertex " + std::to_string(kCorners[i].x) + " " + std::to_string(kCorners[i].y) + " " + std::to_string(kCorners[i].z) + "\n";
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

template <typename T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binaryStl(uint32_t claimed = 4) {
  std::string bytes = "solid by title only";
  bytes.resize(80, ' ');
  append(bytes, claimed);
  for (const Triangle& t : kFaces) {
    for (int i = 0; i < 3; ++i) append(bytes, 0.0F);
    for (const uint32_t i : t) append(bytes, kCorners[i].x), append(bytes, kCorners[i].y), append(bytes, kCorners[i].z);
    append(bytes, uint16_t(0));
  }
  return bytes;
}

std::string binaryPly() {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3 p : kCorners) append(bytes, p.x), append(bytes, p.y), append(bytes, p.z);
  for (const Triangle& t : kFaces) {
    append(bytes, uint8_t(3));
    for (const uint32_t i : t) append(bytes, int32_t(i));
  }
  return bytes;
}

// A cube of ±1 file units as quads without normals, under a model moved by (0, 0, 30).
std::string cubeFbx(const std::string& settings) {
  return "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}\n" + settings +
         "Objects:  {\n\tGeometry: 10, \"Geometry::cube\", \"Mesh\" {\n"
         "\t\tVertices: *24 {\n\t\t\ta: -1,-1,-1,1,-1,-1,1,1,-1,-1,1,-1,-1,-1,1,1,-1,1,1,1,1,-1,1,1\n\t\t}\n"
         "\t\tPolygonVertexIndex: *24 {\n\t\t\ta: 0,3,2,-2,4,5,6,-8,0,1,5,-5,1,2,6,-6,2,3,7,-7,3,0,4,-8\n\t\t}\n\t}\n"
         "\tModel: 20, \"Model::cube\", \"Mesh\" {\n\t\tVersion: 232\n\t\tProperties70:  {\n"
         "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",0,0,30\n\t\t}\n\t}\n}\n"
         "Connections:  {\n\tC: \"OO\",20,0\n\tC: \"OO\",10,20\n}\n";
}

std::string globalSettings(int up, int front, int front_sign, double unit) {
  const auto line = [](const std::string& name, const std::string& type, const std::string& value) {
    return "\t\tP: \"" + name + "\", " + type + ", \"\"," + value + "\n";
  };
  const std::string integer = "\"int\", \"Integer\"";
  return "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n" + line("UpAxis", integer, std::to_string(up)) +
         line("UpAxisSign", integer, "1") + line("FrontAxis", integer, std::to_string(front)) +
         line("FrontAxisSign", integer, std::to_string(front_sign)) + line("CoordAxis", integer, "0") +
         line("CoordAxisSign", integer, "1") + line("UnitScaleFactor", "\"double\", \"Number\"", std::to_string(unit)) + "\t}\n}\n";
}

}  // namespace

TEST(ReadMesh, KeepsVerticesAndOrderInEveryPlainFormat) {
  const TestFolder folder;
  const std::pair<std::string, std::string> files[] = {
      {"a.obj", kTetrahedronObj}, {"a.off", kTetrahedronOff}, {"A.PLY", kTetrahedronPly}, {"b.ply", binaryPly()}};
  for (const auto& [name, bytes] : files) {
    const Sculpt sculpt = read(folder.write(name, bytes));
    ASSERT_EQ(sculpt.parts.size(), 1U) << name;
    EXPECT_EQ(sculpt.parts[0].positions, kCorners) << name;
    EXPECT_EQ(sculpt.parts[0].triangles, kFaces) << name;
    EXPECT_TRUE(sculpt.parts[0].normals.empty() && sculpt.parts[0].uvs.empty()) << name;
  }
}

TEST(ReadMesh, WeldsStlInOrderOfFirstUse) {
  const TestFolder folder;
  for (const std::string& bytes : {asciiStl(), binaryStl()}) {
    const SculptPart part = read(folder.write("a.stl", bytes)).parts.at(0);
    EXPECT_EQ(part.positions, (std::vector<Vec3>{kCorners[0], kCorners[2], kCorners[1], kCorners[3]}));
    EXPECT_EQ(part.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}}));
    EXPECT_NEAR(signedVolume(part.positions, part.triangles), 1.0 / 6, 1e-7);
  }
}

// Text, whatever follows "solid"; and no text just because the title says so.
TEST(ReadMesh, TellsAsciiStlByItsFacets) {
  const TestFolder folder;
  const std::string text = asciiStl();
  for (const std::string title : {"solid\ttab", "solid", "solid  two words", "\n  solid late"}) {
    std::string changed = text;
    EXPECT_EQ(read(folder.write("a.stl", changed.replace(0, text.find('\n'), title))).parts.at(0).triangles.size(), 4U) << title;
  }
  EXPECT_EQ(read(folder.write("b.stl", binaryStl())).parts.at(0).triangles.size(), 4U);
}

TEST(ReadMesh, KeepsUnreferencedVerticesOfAPlainObj) {
  const TestFolder folder;
  const SculptPart part = read(folder.write("a.obj", "v 9 9 9\n" + kTetrahedronObj + "f -4 -2 -3\n")).parts.at(0);
  ASSERT_EQ(part.positions.size(), 5U);
  EXPECT_EQ(part.positions[0], (Vec3{9, 9, 9}));
  EXPECT_EQ(part.triangles.back(), (Triangle{1, 3, 2}));  // negative indices count from the end
}

TEST(ReadMesh, SplitsObjCornersInOrderOfFirstUse) {
  const TestFolder folder;
  Warnings warnings;
  const auto file = folder.write("a.obj",
                                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 7 7 7\nvt 0 0\nvt 1 0.25\nvt 0 1\nvn 0 0 2\n"
                                 "f 1/1/1 2/2/1 3/3/1\nf 3/3/1 2/1/1 \\\n 4/2/1\n");
  const SculptPart part = readMesh(file, {}, warnings).parts.at(0);
  EXPECT_EQ(part.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(part.uvs, (std::vector<Vec2>{{0, 1}, {1, 0.75F}, {0, 0}, {0, 1}, {1, 0.75F}}));  // v turned to glTF's sense
  EXPECT_EQ(part.normals, std::vector<Vec3>(5, Vec3{0, 0, 1}));                              // unit length
  EXPECT_EQ(part.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 3, 4}}));
  EXPECT_EQ(countOf(warnings, WarningKind::kUnreferencedVertex), 1U);
}

TEST(ReadMesh, CutsPolygons) {
  const std::vector<Vec3> square{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, arrow{{0, 0, 0}, {2, 0, 0}, {0.5F, 0.5F, 0}, {0, 2, 0}};
  const std::vector<uint32_t> corners{0, 1, 2, 3};
  std::vector<Triangle> triangles;
  EXPECT_TRUE(triangulatePolygon(corners, square, triangles));
  EXPECT_EQ(triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  // A dart: the fan would leave the polygon. The areas of an exact cut are all positive and sum to the polygon's, 1 (shoelace).
  triangles.clear();
  EXPECT_TRUE(triangulatePolygon(std::vector<uint32_t>{1, 2, 3, 0}, arrow, triangles));
  double area = 0;
  for (const Triangle& t : triangles) {
    const double z = cross(arrow[t[1]] - arrow[t[0]], arrow[t[2]] - arrow[t[0]]).z / 2;
    EXPECT_GT(z, 0);
    area += z;
  }
  EXPECT_NEAR(area, 1, 1e-6);
}

TEST(ReadMesh, ReadsHeadersOfOffAsTheyAreWritten) {
  const TestFolder folder;
  const auto partOf = [&](const std::string& text) { return read(folder.write("a.off", text)).parts.at(0); };
  const std::string square = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const char* header : {"OFF3 1 0\n", "3 1 0\n", "OFF 3 1\n", "OFF\r3 1 0\r", "\xEF\xBB\xBFOFF\n3 1 0\n"})
    EXPECT_EQ(partOf(header + square).triangles.size(), 1U) << header;
  const SculptPart colored = partOf("COFF3 1 0\n0 0 0 255 128 0 51\n1 0 0 0 0 0 255\n0 1 0\n3 0 1 2 255 0 0\n");
  EXPECT_EQ(colored.colors[0], (std::array<float, 4>{1, linearOfSrgb(128.0F / 255), 0, 0.2F}));
  const SculptPart all = partOf("NCSTOFF 3 1 0\n0 0 0 0 0 1 1 0 0 1 0 0\n1 0 0 0 0 1 1 0 0 1 1 0\n0 1 0 0 0 1 1 0 0 1 0 1\n3 0 1 2\n");
  EXPECT_EQ(all.uvs[2], (Vec2{0, 0}));
  EXPECT_EQ(all.normals[2], (Vec3{0, 0, 1}));
  EXPECT_EQ(all.colors[2], (std::array<float, 4>{1, 0, 0, 1}));
  expectError<InputError>([&] { partOf("4OFF\n3 1 0\n" + square); }, "not an OFF text in three dimensions ('4OFF')");
  expectError<InputError>([&] { partOf("OFF BINARY\n"); }, "binary OFF is not supported");
}

TEST(ReadMesh, ReadsStlInCapitals) {
  const TestFolder folder;
  const std::string facet = "FACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nENDSOLID\n";
  for (const std::string begin : {"SOLID a\n", "\xEF\xBB\xBFSolid a\n", "\r\n solid\n"})
    EXPECT_EQ(read(folder.write("a.stl", begin + facet)).parts.at(0).triangles.size(), 1U) << begin;
  expectError<InputError>(
      [&] { read(folder.write("b.stl", "this is no model, only some words of a text, more than a header has" + facet)); },
      "neither a text that begins with 'solid' nor a binary file");
}

TEST(ReadMesh, ReadsOffVariants) {
  const TestFolder folder;
  const SculptPart part =
      read(folder.write("a.off",
                        "STCNOFF\n3 1 0\n# vertex: xyz normal rgba st\n0 0 0  0 0 1  1 0 0 1  0 0\n1 0 0  0 0 1  1 0 0 1  1 0\n"
                        "0 1 0  0 0 1  1 0 0 1  0 0.75\n3 0 1 2 0.5 0.5 0.5\n"))
          .parts.at(0);
  EXPECT_EQ(part.normals, std::vector<Vec3>(3, Vec3{0, 0, 1}));
  EXPECT_EQ(part.uvs, (std::vector<Vec2>{{0, 1}, {1, 1}, {0, 0.25F}}));
}

// FBX: axes and unit of the file, whatever assimp does with them, against the cube's known corners.
TEST(ReadMesh, BringsFbxToMetresAndYUp) {
  const TestFolder folder;
  const auto boxOf = [&](const std::string& settings, Warnings& warnings) {
    const Sculpt sculpt = readMesh(folder.write("cube.fbx", cubeFbx(settings)), {}, warnings);
    EXPECT_EQ(sculpt.parts.at(0).positions.size(), 8U);  // no normals, no UVs: the cube's own corners
    const SurfaceMesh surface = surfaceInScene(sculpt);
    Box box;
    for (const Vec3 p : surface.positions) box.add(p);
    EXPECT_GT(signedVolume(surface.positions, surface.triangles), 0);
    return box;
  };
  Warnings warnings;
  const Box metres = boxOf(globalSettings(1, 2, 1, 100), warnings);
  EXPECT_LT(length(metres.low - Vec3{-1, -1, 29}), 1e-5F);
  EXPECT_LT(length(metres.high - Vec3{1, 1, 31}), 1e-5F);
  const Box inches_z_up = boxOf(globalSettings(2, 1, -1, 2.54), warnings);  // (x, y, z) → (x, z, −y)
  EXPECT_LT(length(inches_z_up.low - Vec3{-0.0254F, 29 * 0.0254F, -0.0254F}), 1e-5F);
  EXPECT_LT(length(inches_z_up.high - Vec3{0.0254F, 31 * 0.0254F, 0.0254F}), 1e-5F);
  EXPECT_EQ(countOf(warnings, WarningKind::kUnitsAssumed), 0U);
  const Box silent = boxOf("", warnings);
  EXPECT_NEAR(silent.high.z, 0.31, 1e-6);  // FBX's default unit is the centimetre
  EXPECT_EQ(countOf(warnings, WarningKind::kUnitsAssumed), 1U);
}

TEST(ReadMesh, AppliesTheGivenFrame) {
  const TestFolder folder;
  const auto file = folder.write("a.obj", kTetrahedronObj);
  const Sculpt sculpt = read(file, {0.5, UpAxis::kZ});
  EXPECT_EQ(transformPoint(sculpt.parts.at(0).to_scene, {1, 2, 3}), (Vec3{0.5F, 1.5F, -1}));
  EXPECT_EQ(transformPoint(read(file, {{}, UpAxis::kX}).parts.at(0).to_scene, {1, 2, 3}), (Vec3{-2, 1, 3}));
  expectError<UsageError>([&] { read(file, {0.0, {}}); }, "above 0");
  // An FBX has a frame of its own, which the given one replaces.
  const auto fbx = folder.write("a.fbx", cubeFbx(globalSettings(1, 2, 1, 100)));
  const SculptPart plain = read(fbx, {1.0, UpAxis::kY}).parts.at(0), lying = read(fbx, {1.0, UpAxis::kX}).parts.at(0);
  const Vec3 p = transformPoint(plain.to_scene, {1, 2, 3});
  EXPECT_EQ(transformPoint(lying.to_scene, {1, 2, 3}), (Vec3{-p.y, p.x, p.z}));
}

TEST(ReadMesh, NamesTheVertexThatIsNotFinite) {
  const TestFolder folder;
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  expectError<InputError>([&] { read(folder.write("a.obj", replaced(kTetrahedronObj, "v 0 1 0", "v 0 nan 0"))); },
                          ":4: a coordinate of vertex 2");
  expectError<InputError>([&] { read(folder.write("b.obj", replaced(kTetrahedronObj, "v 0 1 0", "v 0 1e999 0"))); }, "vertex 2");
  expectError<InputError>([&] { read(folder.write("c.obj", replaced(kTetrahedronObj, "v 0 1 0", "v 0 1,5 0"))); }, "vertex 2");
  expectError<InputError>([&] { read(folder.write("d.obj", replaced(kTetrahedronObj, "v 0 1 0", "v 0 1"))); }, "needs 3 numbers");
  expectError<InputError>([&] { read(folder.write("a.off", replaced(kTetrahedronOff, "0 1 0", "0 inf 0"))); }, ":5: a number of vertex 2");
  expectError<InputError>([&] { read(folder.write("a.ply", replaced(kTetrahedronPly, "0 1 0", "0 nan 0"))); }, "vertex 2 is not finite");
  expectError<InputError>([&] { read(folder.write("a.stl", replaced(asciiStl(), "vertex 1.0", "vertex nan"))); }, "vertex 2");
  std::string binary = binaryStl();
  const float nan = NAN;
  std::memcpy(binary.data() + 84 + 50 + 12 + 4, &nan, 4);
  expectError<InputError>([&] { read(folder.write("b.stl", binary)); }, "vertex 3 (facet 1)");
}

TEST(ReadMesh, RefusesAnFbxWithAnInvalidFrame) {
  const TestFolder folder;
  const std::string good = globalSettings(1, 2, 1, 100);
  const auto with = [&](const std::string& key, const std::string& value) {
    const size_t line = good.find("\"" + key + "\""), end = good.find('\n', line), comma = good.rfind(',', end);
    return std::string(good).replace(comma + 1, end - comma - 1, value);
  };
  EXPECT_EQ(read(folder.write("good.fbx", cubeFbx(good))).parts.size(), 1U);
  for (const char* key : {"UpAxisSign", "CoordAxisSign"})
    EXPECT_EQ(read(folder.write("down.fbx", cubeFbx(with(key, "-1")))).parts.size(), 1U);
  const std::pair<const char*, const char*> broken[] = {{"UpAxis", "-1"},
                                                        {"UpAxis", "3"},
                                                        {"UpAxis", "0"},
                                                        {"UpAxisSign", "2"},
                                                        {"UpAxisSign", "0"},
                                                        {"CoordAxis", "-1"},
                                                        {"CoordAxis", "3"},
                                                        {"CoordAxisSign", "0"},
                                                        {"CoordAxisSign", "-2"},
                                                        {"UnitScaleFactor", "-1"},
                                                        {"UnitScaleFactor", "1e999"}};
  for (const auto& [key, value] : broken) {
    SCOPED_TRACE(std::string(key) + " " + value);
    expectError<InputError>([&, &k = key, &v = value] { read(folder.write("broken.fbx", cubeFbx(with(k, v)))); },
                            "the axes or the unit in the FBX are invalid");
  }
}

TEST(ReadMesh, RefusesWhatHasNoTriangles) {
  const TestFolder folder;
  const std::string empty_stl = std::string(80, ' ') + std::string(4, '\0');
  const std::pair<std::string, std::string> files[] = {{"a.obj", "v 0 0 0\nl 1 1\n"},
                                                       {"b.obj", "\n"},
                                                       {"a.off", "OFF\n1 0 0\n0 0 0\n"},
                                                       {"a.stl", "solid a\nendsolid a\n"},
                                                       {"b.stl", empty_stl}};
  for (const auto& [name, bytes] : files) expectError<InputError>([&, n = name, b = bytes] { read(folder.write(n, b)); }, "no triangles");
  expectError<InputError>([&] { read(folder.write("empty.ply", "")); }, "is empty");
}

TEST(ReadMesh, RefusesIndicesOutOfRange) {
  const TestFolder folder;
  expectError<InputError>([&] { read(folder.write("a.obj", kTetrahedronObj + "f 1 2 5\n")); }, ":10: a face uses vertex 5 of 4");
  expectError<InputError>([&] { read(folder.write("b.obj", kTetrahedronObj + "f 1 2 -5\n")); }, ":10: a face uses vertex -5");
  expectError<InputError>([&] { read(folder.write("c.obj", kTetrahedronObj + "f 1//1 2 3\n")); }, "normal 1 of 0");
  // Faces without corners are counted, and do not move the line of what follows.
  expectError<InputError>([&] { read(folder.write("d.obj", kTetrahedronObj + "f\nf \nf 1 2\nf 1 2 5\n")); },
                          ":13: a face uses vertex 5 of 4");
  Warnings warnings;
  readMesh(folder.write("e.obj", kTetrahedronObj + "f\nf \nf 1 2\n"), {}, warnings);
  EXPECT_EQ(countOf(warnings, WarningKind::kDegenerateTriangle), 3U);
  std::string off = kTetrahedronOff, ply = kTetrahedronPly;
  expectError<InputError>([&] { read(folder.write("a.off", off.replace(off.rfind("3\n"), 1, "4"))); }, "face 3 uses vertex 4 of 4");
  expectError<InputError>([&] { read(folder.write("a.ply", ply.replace(ply.rfind("3\n"), 1, "4"))); }, "uses vertex 4");
}

// Numbers that no integer holds are named as the file has them.
TEST(ReadMesh, NamesNumbersThatAreTooLarge) {
  const TestFolder folder;
  const std::string large = "99999999999999999999", points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto expectRefused = [&](const std::string& name, const std::string& text, const std::string& what) {
    expectError<InputError>([&] { read(folder.write(name, text)); }, name + ":" + what);
  };
  expectRefused("a.obj", points + "f 1 2 " + large + "\n", "4: a face uses vertex '" + large + "' of 3");
  expectRefused("a.obj", points + "f 1 2 -" + large + "\n", "4: a face uses vertex '-" + large + "' of 3");
  expectRefused("a.obj", points + "f 1 2 4294967297\n", "4: a face uses vertex 4294967297 of 3");
  expectRefused("a.obj", points + "f 1 2 -9223372036854775808\n", "4: a face uses vertex -9223372036854775808 of 3");
  expectRefused("a.obj", points + "f 1/" + large + " 2 3\n", "4: a face uses UV '" + large + "' of 0");
  expectRefused("a.obj", points + "f 1//" + large + " 2 3\n", "4: a face uses normal '" + large + "' of 0");
  expectRefused("a.obj", points + "f 1 2 3x\n", "4: a face uses vertex '3x' of 3");
  expectRefused("a.obj", points + "f 1 2 +-3\n", "4: a face uses vertex '+-3' of 3");
  expectRefused("a.obj", points + "f 1 2 /3\n", "4: a face uses vertex '' of 3");
  expectRefused("a.off", "OFF\n" + large + " 1 0\n", "2: the number of vertices is '" + large + "', which is no count");
  expectRefused("a.off", "OFF\n3\n", "2: the number of faces is missing");
  expectRefused("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n" + large + " 0 1 2\n", "6: the number of corners is '" + large);
  expectRefused("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 " + large + "\n", "6: face 0 uses vertex '" + large + "' of 3");
  expectRefused("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "6: face 0 has fewer corners than it claims");
}

TEST(ReadMesh, HoldsDeclaredCountsAgainstTheFileSize) {
  const TestFolder folder;
  expectError<InputError>([&] { read(folder.write("a.off", "OFF\n4000000000 1 0\n0 0 0\n")); }, "claims 4000000000 vertices");
  expectError<InputError>([&] { read(folder.write("b.off", "OFF\n1 1 0\n0 0 0\n4000000000 0\n")); }, "claims 4000000000 corners");
  // A download that broke off after 100 of 120 vertices, the shortest that OFF can write.
  std::string cut = "OFF\n120 2 0\n";
  for (int i = 0; i < 100; ++i) cut += "0 0 0\n";
  expectError<InputError>([&] { read(folder.write("c.off", cut)); }, "claims 120 vertices and 2 faces in a file of 612 bytes");
  expectError<InputError>([&] { read(folder.write("a.stl", binaryStl(4000000000U))); }, "claims 4000000000 facets");
  std::string ply = binaryPly();
  expectError<InputError>([&] { read(folder.write("a.ply", ply.replace(ply.find("vertex 4"), 8, "vertex 4000000000"))); },
                          "after 8 of 4000000000 rows");
}

// Cut anywhere, a file is refused as such or (a text cut at a line's end) read as less: never a crash, never another kind of error.
TEST(ReadMesh, SurvivesEveryTruncation) {
  const TestFolder folder;
  const std::pair<std::string, std::string> files[] = {{"a.obj", kTetrahedronObj},
                                                       {"a.off", kTetrahedronOff},
                                                       {"a.ply", kTetrahedronPly},
                                                       {"b.ply", binaryPly()},
                                                       {"a.stl", asciiStl()},
                                                       {"b.stl", binaryStl()},
                                                       {"a.fbx", cubeFbx(globalSettings(1, 2, 1, 100))}};
  for (const auto& [name, bytes] : files) {
    size_t refused = 0;
    for (size_t size = 0; size<bytes.size(); size += bytes.size()> 1000 ? 7 : 1) {
      try {
        read(folder.write(name, bytes.substr(0, size)));
      } catch (const InputError& error) {
        refused += error.code == ExitCode::kInput;
      }
    }
    EXPECT_GT(refused, 0U) << name;
  }
  // A PLY is refused at every cut of its data, binary or text (the last line's own end may be missing).
  const std::string binary = binaryPly(), text = kTetrahedronPly;
  for (size_t size = binary.find("end_header\n") + 11; size < binary.size(); ++size)
    expectError<InputError>([&] { read(folder.write("cut.ply", binary.substr(0, size))); }, "of 4 rows of an element");
  for (size_t size = text.find("end_header\n") + 11; size < text.size() - 2; ++size)
    expectError<InputError>([&] { read(folder.write("cut.ply", text.substr(0, size))); }, "the file is damaged or truncated");
}

TEST(ReadMesh, RefusesUnknownFormatsByName) {
  const TestFolder folder;
  const std::pair<const char*, const char*> formats[] = {{"usd", "USD"},
                                                         {"usda", "USD"},
                                                         {"usdc", "USD"},
                                                         {"usdz", "USD"},
                                                         {"abc", "Alembic"},
                                                         {"max", "a 3ds Max scene"},
                                                         {"ma", "a Maya scene"},
                                                         {"mb", "a Maya scene"},
                                                         {"ztl", "a ZBrush project"},
                                                         {"zpr", "a ZBrush project"}};
  for (const auto& [extension, name] : formats)
    expectError<InputError>([&, &e = extension] { read(folder.write(std::string("a.") + e, "x")); },
                            std::string(name) + " is not supported");
  expectError<InputError>([&] { read(folder.write("a.docx", "x")); }, "not a known mesh format");
  expectError<InputError>([&] { read(folder.write("noextension", "x")); }, "no extension");
  expectError<InputError>([&] { read(folder.write("a.fbx", "not an fbx")); }, "cannot be read");
  expectError<InputError>([&] { read(folder.write("a.obj", std::string("v\0 \0", 4))); }, "UTF-8");
  for (const char* name : {"none.obj", "none.glb", "none.fbx", "none.ply"})
    expectError<IoError>([&] { read(folder.path / name); }, "No such file");
}

TEST(SurfaceInScene, KeepsMirroredPartsFacingOutwards) {
  Sculpt sculpt;
  for (const double sign : {1.0, -1.0})
    sculpt.parts.push_back({"t", kCorners, {}, {}, kFaces, {{{{sign, 0, 0}, {0, 2, 0}, {0, 0, 1}}}, {5, 0, 0}}});
  const SurfaceMesh surface = surfaceInScene(sculpt);
  ASSERT_EQ(surface.positions.size(), 8U);
  ASSERT_EQ(surface.normals.size(), 8U);
  EXPECT_NEAR(signedVolume(surface.positions, surface.triangles), 2 * 2.0 / 6, 1e-6);
  // The corner at the origin: all three faces are coordinate planes, so the normal points away from the solid.
  EXPECT_LT(dot(surface.normals[0], {1, 1, 1}), 0);
  EXPECT_LT(dot(surface.normals[4], {-1, 1, 1}), 0);
}
