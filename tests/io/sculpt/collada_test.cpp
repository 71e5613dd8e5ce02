#include "tests/io/sculpt/read_helpers.h"
#include "tests/io/sculpt/sculpt_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

namespace {

ReadSculpt readDae(const std::string& text, const ReadSettings& settings = {}) { return readBytes("a.dae", text, settings); }

const std::string kTallPositions = "0 0 0 1 0 0 0 1 0 1 1 0 0 0 3 1 0 3 0 1 3 1 1 3";

// A box of 1 × 1 × 3 units, below `scene`, with what the asset says.
std::string tallBox(const std::string& asset, const std::string& scene, const std::string& libraries = "") {
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset>" + asset +
         "</asset><library_geometries><geometry id=\"g\" name=\"g\"><mesh>" + daeSource("p", kTallPositions, 8, "XYZ") +
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><polylist count=\"6\"><input semantic=\"VERTEX\" "
         "source=\"#v\" offset=\"0\"/><vcount>4 4 4 4 4 4</vcount><p>0 2 3 1 4 5 7 6 0 1 5 4 2 6 7 3 0 4 6 2 1 3 7 5</p></polylist></mesh>"
         "</geometry></library_geometries>" +
         libraries + "<library_visual_scenes><visual_scene id=\"s\">" + scene +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

std::string tallBox(const std::string& asset) { return tallBox(asset, daeNode("n", "<instance_geometry url=\"#g\"/>")); }

void expectSize(const Sculpt& sculpt, Vec3 wanted, double tolerance = 1e-7) {
  const SurfaceMesh surface = surfaceInScene(sculpt);
  const Corners box = boxOf(surface.positions);
  expectNear({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z}, wanted, tolerance);
  EXPECT_GT(signedVolume(surface.positions, surface.triangles), 0);
}

ReadSettings given(std::optional<double> unit, std::optional<UpAxis> up) {
  ReadSettings settings;
  settings.metres_per_unit = unit, settings.up_axis = up;
  return settings;
}

// A box that two joints hold: the lower four vertices by the first, the upper by the second. The bind shape matrix moves by (10, 0, 0),
// both joints are bound where they are, and the second is `moved` by the file.
std::string skinnedBox(const std::string& moved, const std::string& root_names = "A B", const std::string& tool = "") {
  const auto name_array = [&] {
    return "<source id=\"j\"><Name_array id=\"ja\" count=\"2\">" + root_names +
           "</Name_array><technique_common><accessor source=\"#ja\" count=\"2\" stride=\"1\"><param name=\"JOINT\" type=\"Name\"/>"
           "</accessor></technique_common></source>";
  };
  const std::string bind =
      "<source id=\"b\"><float_array id=\"ba\" count=\"32\">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 0 1 0 0 0 0 1 -3 0 "
      "0 0 1</float_array><technique_common><accessor source=\"#ba\" count=\"2\" stride=\"16\"><param "
      "name=\"TRANSFORM\" type=\"float4x4\"/></accessor></technique_common></source>";
  const std::string skin =
      "<library_controllers><controller id=\"c\"><skin source=\"#g\"><bind_shape_matrix>1 0 0 10 0 1 0 0 0 0 1 0 0 0 0 1"
      "</bind_shape_matrix>" +
      name_array() + bind +
      "<source id=\"w\"><float_array id=\"wa\" count=\"1\">0.5</float_array><technique_common><accessor source=\"#wa\" "
      "count=\"1\" stride=\"1\"><param name=\"WEIGHT\" type=\"float\"/></accessor></technique_common></source>"
      "<joints><input semantic=\"JOINT\" source=\"#j\"/><input semantic=\"INV_BIND_MATRIX\" source=\"#b\"/></joints>"
      "<vertex_weights count=\"8\"><input semantic=\"JOINT\" source=\"#j\" offset=\"0\"/><input semantic=\"WEIGHT\" source=\"#w\" "
      "offset=\"1\"/><vcount>1 1 1 1 1 1 1 1</vcount><v>0 0 0 0 0 0 0 0 1 0 1 0 1 0 1 0</v></vertex_weights></skin></controller>"
      "</library_controllers>";
  const auto joint = [](const std::string& id, const std::string& content) {
    return "<node id=\"" + id + "\" sid=\"" + id + "\" name=\"same\" type=\"JOINT\">" + content + "</node>";
  };
  // The node of the skin has a transform, which has no part in where the skin lies.
  return tallBox("<contributor><authoring_tool>" + tool + "</authoring_tool></contributor><unit meter=\"1\"/><up_axis>Y_UP</up_axis>",
                 joint("A", joint("B", "<translate>0 0 3</translate>" + moved)) +
                     daeNode("n",
                             "<translate>0 77 0</translate><instance_controller url=\"#c\"><skeleton>#A</skeleton>"
                             "</instance_controller>"),
                 skin);
}

}  // namespace

// tests/data/tall_zup_inch.dae: an inch, +Z up.
TEST(Collada, UnitAndAxisTakeThePlaceOfTheFiles) {
  const std::string inch_z = tallBox("<unit name=\"inch\" meter=\"0.0254\"/><up_axis>Z_UP</up_axis>");
  const Vec3 standing{0.0254F, 0.0762F, 0.0254F};
  for (const ReadSettings& settings : {given({}, {}), given(0.0254, UpAxis::kZ), given(0.0254, {}), given({}, UpAxis::kZ)})
    expectSize(readDae(inch_z, settings).sculpt, standing);
  expectSize(readDae(inch_z, given(1, {})).sculpt, {1, 3, 1}, 1e-6);
  expectSize(readDae(inch_z, given({}, UpAxis::kY)).sculpt, {0.0254F, 0.0254F, 0.0762F});
  expectSize(readDae(inch_z, given(0.01, UpAxis::kX)).sculpt, {0.01F, 0.01F, 0.03F});
  EXPECT_EQ(readDae(inch_z).sculpt.frame_note, "0.0254 m per unit, +Z up (as the file says)");
  EXPECT_EQ(readDae(inch_z, given(2, {})).sculpt.frame_note, "2 m per unit, +Z up (one given, the other as the file says)");
  EXPECT_EQ(readDae(inch_z, given(2, UpAxis::kY)).sculpt.frame_note, "2 m per unit, +Y up (as given)");
  EXPECT_EQ(countOf(readDae(inch_z).warnings, WarningKind::kUnitsAssumed), 0U);
}

TEST(Collada, ReadsEveryAxisAndTheDefaults) {
  const std::string x_up = tallBox("<unit meter=\"0.01\"/><up_axis>X_UP</up_axis>"), plain = tallBox("");
  EXPECT_EQ(readDae(x_up).sculpt.frame_note, "0.01 m per unit, +X up (as the file says)");
  expectSize(readDae(x_up).sculpt, {0.01F, 0.01F, 0.03F});
  expectSize(readDae(x_up, given({}, UpAxis::kZ)).sculpt, {0.01F, 0.03F, 0.01F});
  // x is up, −y right.
  expectNear(transformPoint(readDae(x_up).sculpt.parts[0].to_scene, {1, 2, 3}), {-0.02F, 0.01F, 0.03F}, 1e-9);
  EXPECT_EQ(readDae(plain).sculpt.frame_note, "1 m per unit, +Y up (as the file says)");
  expectSize(readDae(plain, given(0.5, UpAxis::kZ)).sculpt, {0.5F, 1.5F, 0.5F});
}

TEST(Collada, RefusesAnInvalidUnit) {
  for (const char* unit : {"0", "-1"})
    expectError<InputError>([&] { readDae(tallBox(std::string("<unit meter=\"") + unit + "\"/>")); },
                            "the unit of the Collada scene is invalid");
}

TEST(Collada, JointsPlaceASkin) {
  // Bound where the joints are: only the bind shape matrix moves the box.
  const ReadSculpt still = readDae(skinnedBox(""));
  expectSize(still.sculpt, {1, 1, 3}, 1e-5);
  EXPECT_EQ(countOf(still.warnings, WarningKind::kPoseIgnored), 0U);
  expectNear(boxOf(still.positions()).low, {10, 0, 0}, 1e-5);
  // The upper joint is moved by 4 along z, and so are the upper vertices.
  expectSize(readDae(skinnedBox("<translate>0 0 4</translate>")).sculpt, {1, 1, 7}, 1e-5);
}

TEST(Collada, CountsASkinWithoutItsJoints) {
  const ReadSculpt found = readDae(skinnedBox("", "A missing"));
  EXPECT_EQ(countOf(found.warnings, WarningKind::kPoseIgnored), 1U);
}

// Its bind shape matrix lacks the transform of the armature: here that of the skin's node, which moves it by 77.
TEST(Collada, CountsSkinsOfBlenderBelowAMovedArmature) {
  EXPECT_EQ(countOf(readDae(skinnedBox("", "A B", "Blender 3.4.1")).warnings, WarningKind::kTransformGuessed), 1U);
  EXPECT_EQ(countOf(readDae(skinnedBox("", "A B", "Maya")).warnings, WarningKind::kTransformGuessed), 0U);
}

TEST(Collada, RefusesSourcesThatAreTooShort) {
  std::string text = tallBox("");
  expectError<InputError>([&] { readDae(text.replace(text.find("count=\"24\""), 10, "count=\"23\"")); }, "has 23 values of 24");
}
