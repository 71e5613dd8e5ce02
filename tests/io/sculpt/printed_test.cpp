#include "tests/io/sculpt/read_helpers.h"
#include "tests/io/zip_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

namespace {

const std::string kRelations =
    "<?xml version=\"1.0\"?><Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
    "Target=\"/3D/3dmodel.model\" Id=\"r\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

std::string packed3mf(const std::string& model) { return zipOf({{"_rels/.rels", kRelations}, {"3D/3dmodel.model", model}}); }

const std::string kVertices =
    "<vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"2\" z=\"0\"/>"
    "<vertex x=\"0\" y=\"0\" z=\"3\"/></vertices>";

std::string triangles(const std::string& last = "") {
  return "<triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"0\" v2=\"3\" v3=\"2\"/>"
         "<triangle v1=\"1\" v2=\"2\" v3=\"3\"" +
         last + "/></triangles>";
}

// A tetrahedron of 1 × 2 × 3 units, drawn by `build`.
std::string model3mf(const std::string& attributes, const std::string& build = "<item objectid=\"1\"/>", const std::string& last = "",
                     const std::string& resources = "", const std::string& object = "") {
  return "<?xml version=\"1.0\"?><!-- <model unit='meter'> --><model " + attributes +
         " xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>" + resources +
         "<object id=\"1\" name=\"body\" type=\"model\"" + object + "><mesh>" + kVertices + triangles(last) +
         "</mesh></object><object id=\"2\"><components><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/></components>"
         "</object></resources><build>" +
         build + "</build></model>";
}

std::string amfOf(const std::string& attributes, const std::string& more = "") {
  std::string text = "<?xml version=\"1.0\"?><amf" + attributes + "><object id=\"1\"><mesh><vertices>";
  for (const char* xyz : {"<x>0</x><y>0</y><z>0</z>", "<x>1</x><y>0</y><z>0</z>", "<x>0</x><y>2</y><z>0</z>", "<x>0</x><y>0</y><z>3</z>"})
    text += std::string("<vertex><coordinates>") + xyz + "</coordinates></vertex>";
  text += "</vertices><volume>";
  for (const char* corners : {"<v1>0</v1><v2>2</v2><v3>1</v3>", "<v1>0</v1><v2>1</v2><v3>3</v3>", "<v1>0</v1><v2>3</v2><v3>2</v3>",
                              "<v1>1</v1><v2>2</v2><v3>3</v3>"})
    text += std::string("<triangle>") + corners + "</triangle>";
  return text + "</volume></mesh></object>" + more + "</amf>";
}

// Where the farthest vertices along the file's axes lie.
void expectPoints(const Sculpt& sculpt, Vec3 x, Vec3 y, Vec3 z) {
  const Affine& to_scene = sculpt.parts.at(0).to_scene;
  expectNear(transformPoint(to_scene, {1, 0, 0}), x, 1e-9);
  expectNear(transformPoint(to_scene, {0, 2, 0}), y, 1e-9);
  expectNear(transformPoint(to_scene, {0, 0, 3}), z, 1e-9);
}

}  // namespace

TEST(Printed, ThreeMfHasItsUnitAndIsZUp) {
  const std::pair<const char*, double> units[] = {{"unit=\"micron\"", 1e-6},     {"unit=\"millimeter\"", 1e-3}, {"", 1e-3},
                                                  {"unit=\"centimeter\"", 1e-2}, {"unit=\"inch\"", 0.0254},     {"unit='foot'", 0.3048},
                                                  {"unit=\"meter\"", 1}};
  for (const auto& [unit, metres] : units) {
    const ReadSculpt found = readBytes("a.3mf", packed3mf(model3mf(unit)));
    const float m = float(metres);
    expectPoints(found.sculpt, {m, 0, 0}, {0, 0, -2 * m}, {0, 3 * m, 0});
    EXPECT_EQ(countOf(found.warnings, WarningKind::kUnitsAssumed), 0U);
    EXPECT_NE(found.sculpt.frame_note.find("+Z up (as the file says)"), std::string::npos) << found.sculpt.frame_note;
  }
  ReadSettings given;
  given.metres_per_unit = 0.5, given.up_axis = UpAxis::kY;
  const ReadSculpt found = readBytes("a.3mf", packed3mf(model3mf("unit=\"inch\"")), given);
  expectPoints(found.sculpt, {0.5F, 0, 0}, {0, 1, 0}, {0, 0, 1.5F});
  EXPECT_EQ(found.sculpt.frame_note, "0.5 m per unit, +Y up (as given)");
  expectError<InputError>([] { readBytes("a.3mf", packed3mf(model3mf("unit=\"ell\""))); }, "the 3MF has the unit 'ell'");
}

TEST(Printed, ThreeMfKeepsItsObjectsAndTransforms) {
  const ReadSculpt found = readBytes("a.3mf", packed3mf(model3mf("unit=\"meter\"",
                                                                 "<item objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 100\"/>"
                                                                 "<item objectid=\"1\"/>")));
  ASSERT_EQ(found.sculpt.parts.size(), 2U);
  // The component moves by 10 along x; the item turns x into y and moves by 100 along z, which is up.
  EXPECT_EQ(transformPoint(found.sculpt.parts[0].to_scene, {1, 0, 0}), (Vec3{0, 100, -11}));
  EXPECT_EQ(transformPoint(found.sculpt.parts[1].to_scene, {1, 0, 0}), (Vec3{1, 0, 0}));
}

TEST(Printed, ThreeMfKeepsBaseMaterials) {
  const std::string materials =
      "<basematerials id=\"5\"><base name=\"red clay\" displaycolor=\"#804020FF\"/><base name=\"blue\" "
      "displaycolor=\"#0000FF\"/></basematerials>";
  const auto with = [&](const std::string& last, const std::string& object, const std::string& more = "") {
    return readBytes("a.3mf", packed3mf(model3mf("", "<item objectid=\"1\"/>", last, materials + more, object)));
  };
  const ReadSculpt one = with("", " pid=\"5\" pindex=\"0\"");
  ASSERT_EQ(one.sculpt.materials.size(), 1U);
  EXPECT_EQ(one.sculpt.materials[0].name, "red clay");
  for (const auto& [is, wanted] : {std::pair{one.sculpt.materials[0].base_color[0], 0.2158605},
                                   {one.sculpt.materials[0].base_color[1], 0.0512695},
                                   {one.sculpt.materials[0].base_color[2], 0.0144438}})
    EXPECT_NEAR(is, wanted, 1e-6) << "128, 64 and 32 of sRGB";
  EXPECT_EQ(countOf(one.warnings, WarningKind::kMaterialIgnored), 0U);
  EXPECT_EQ(countOf(with(" pid=\"5\" p1=\"1\"", " pid=\"5\" pindex=\"0\"").warnings, WarningKind::kMaterialIgnored), 1U);
  EXPECT_EQ(countOf(with(" pid=\"5\" p1=\"0\"", " pid=\"5\" pindex=\"0\"").warnings, WarningKind::kMaterialIgnored), 0U);
  EXPECT_EQ(countOf(with("", "", "<m:colorgroup id=\"6\"/>").warnings, WarningKind::kMaterialIgnored), 1U);
}

TEST(Printed, ThreeMfTexturesAreCounted) {
  const std::string texture =
      "<texture2d id=\"3\" path=\"/3D/Textures/a.png\" contenttype=\"image/png\"/><texture2dgroup id=\"4\" texid=\"3\"><tex2coord u=\"0\" "
      "v=\"0\"/><tex2coord u=\"1\" v=\"0\"/><tex2coord u=\"0\" v=\"1\"/></texture2dgroup>";
  const ReadSculpt found =
      readBytes("a.3mf", packed3mf(model3mf("", "<item objectid=\"1\"/>", " pid=\"4\" p1=\"0\" p2=\"1\" p3=\"2\"", texture)));
  EXPECT_EQ(countOf(found.warnings, WarningKind::kTextureIgnored), 2U);
  EXPECT_TRUE(found.sculpt.parts[0].uvs.empty());
  EXPECT_EQ(found.sculpt.parts[0].material, -1);
}

TEST(Printed, ThreeMfThatWouldBeWrongIsRefused) {
  const auto refused = [](const std::string& model, const std::string& text) {
    expectError<InputError>([&] { readBytes("a.3mf", packed3mf(model)); }, text);
  };
  refused(model3mf("requiredextensions=\"b\" xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\""),
          "needs the extension 'http://schemas.microsoft.com/");
  refused(model3mf("", "<item objectid=\"1\" p:path=\"/3D/other.model\"/>"), "its parts in several files");
  refused(model3mf("", "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1\"/>"), "a transform that is not 12 numbers");
  const std::string harmless = "requiredextensions=\"m\" xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"";
  EXPECT_EQ(readBytes("a.3mf", packed3mf(model3mf(harmless))).sculpt.parts.size(), 1U);
  expectError<InputError>([] { readBytes("a.3mf", "no archive"); }, "the model of the 3MF cannot be unpacked");
}

TEST(Printed, AmfHasItsUnit) {
  for (const auto& [unit, metres] :
       {std::pair{" unit=\"inch\"", 0.0254}, {"", 1e-3}, {" unit=\"feet\"", 0.3048}, {" unit=\"Meter\"", 1.0}}) {
    const ReadSculpt found = readBytes("a.amf", amfOf(unit));
    const float m = float(metres);
    expectPoints(found.sculpt, {m, 0, 0}, {0, 2 * m, 0}, {0, 0, 3 * m});
    EXPECT_EQ(countOf(found.warnings, WarningKind::kUnitsAssumed), 1U) << "the axis";
    EXPECT_NE(found.sculpt.frame_note.find("(one as the file says, the other assumed)"), std::string::npos) << found.sculpt.frame_note;
  }
  ReadSettings given;
  given.metres_per_unit = 1, given.up_axis = UpAxis::kZ;
  expectPoints(readBytes("a.amf", amfOf(" unit=\"inch\""), given).sculpt, {1, 0, 0}, {0, 0, -2}, {0, 3, 0});
}

TEST(Printed, AmfThatTurnsInstancesIsRefused) {
  const auto turned = [](const std::string& rz) {
    return amfOf("", "<constellation id=\"2\"><instance objectid=\"1\"><deltax>5</deltax><rz>" + rz + "</rz></instance></constellation>");
  };
  expectError<InputError>([&] { readBytes("a.amf", turned("90")); }, "the AMF turns an instance (<rz>)");
}
