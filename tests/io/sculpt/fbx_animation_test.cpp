// Moments of animations of FBX. tests/blender/animations has skins and morphs.
#include <cmath>

#include "tests/io/sculpt/fbx_helpers.h"
#include "tests/io/sculpt/read_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

namespace {

constexpr int64_t kSecond = 46186158000;

// Adds the curves of a property, such as "Lcl Translation", to the animation `stack`: numbers along x, y and z, one of each per second.
struct AnimatedFbx {
  std::vector<FbxElement> elements;
  int64_t next = 5000;

  FbxElement& objects() { return elements[3]; }
  FbxElement& links() { return elements[4]; }

  // Returns its layer.
  int64_t stack(const std::string& name) {
    const int64_t id = next++, layer = next++;
    objects().children.push_back({"AnimationStack", {id, "AnimStack::" + name, ""}, {{"Properties70"}}});
    objects().children.push_back({"AnimationLayer", {layer, "AnimLayer::" + name, ""}, {{"Properties70"}}});
    links().children.push_back({"C", {"OO", layer, id}});
    return layer;
  }
  void curves(int64_t layer, int64_t model, const std::string& property, const std::vector<std::array<double, 3>>& values) {
    const int64_t node = next++;
    objects().children.push_back({"AnimationCurveNode", {node, "AnimCurveNode::", ""}, {{"Properties70"}}});
    links().children.push_back({"C", {"OO", node, layer}});
    links().children.push_back({"C", {"OP", node, model, property}});
    for (size_t axis = 0; axis < 3; ++axis) {
      std::vector<int64_t> times;
      std::vector<double> numbers;
      for (const auto& value : values) times.push_back(kSecond * int64_t(times.size())), numbers.push_back(value[axis]);
      const int64_t curve = next++;
      objects().children.push_back({"AnimationCurve",
                                    {curve, "AnimCurve::", ""},
                                    {{"KeyVer", {int64_t(4008)}}, {"KeyTime", {times}}, {"KeyValueFloat", {numbers}}}});
      links().children.push_back({"C", {"OP", curve, node, std::string("d|") + "XYZ"[axis]}});
    }
  }
  ReadSculpt at(double seconds, const std::string& name = "") const {
    ReadSettings settings;
    settings.moment = {name, seconds};
    return readBytes("walk.fbx", fbxText(elements), settings);
  }
};

void expectBox(const ReadSculpt& found, Vec3 low, Vec3 high) {
  const Corners box = boxOf(found.positions());
  expectNear(box.low, low, 1e-5);
  expectNear(box.high, high, 1e-5);
}

}  // namespace

TEST(FbxAnimation, MovesTurnsAndScalesModels) {
  AnimatedFbx fbx{fbxOf({{1, "parent", 0, {}, false}, {2, "cube", 1, {{"Lcl Translation", {0, 500, 0}}}}})};
  const int64_t layer = fbx.stack("Walk");
  fbx.curves(layer, 1, "Lcl Translation", {{0, 0, 0}, {100, 0, 0}, {100, 0, 300}});
  fbx.curves(layer, 2, "Lcl Rotation", {{0, 0, 0}, {0, 0, 90}, {0, 0, 90}});
  fbx.curves(layer, 2, "Lcl Scaling", {{1, 1, 1}, {1, 1, 1}, {1, 4, 1}});
  const ReadSculpt first = fbx.at(0);
  EXPECT_EQ(first.sculpt.animation_seconds, 2);
  EXPECT_EQ(countOf(first.warnings, WarningKind::kPoseIgnored), 0U);
  EXPECT_EQ(countOf(first.warnings, WarningKind::kTransformGuessed), 0U);
  expectBox(first, {-0.5F, 4.5F, -0.5F}, {0.5F, 5.5F, 0.5F});
  const float half = std::sqrt(0.5F);
  expectBox(fbx.at(0.5), {0.5F - half, 5 - half, -0.5F}, {0.5F + half, 5 + half, 0.5F});
  expectBox(fbx.at(2), {1 - 2, 4.5F, 2.5F}, {1 + 2, 5.5F, 3.5F});
  expectBox(fbx.at(7), {1 - 2, 4.5F, 2.5F}, {1 + 2, 5.5F, 3.5F});
}

// A model with pivots is a chain of nodes of assimp.
TEST(FbxAnimation, TurnsAboutPivots) {
  AnimatedFbx fbx{fbxOf({{1, "cube", 0, {{"RotationPivot", {0, 50, 0}}, {"PreRotation", {0, 90, 0}}}}})};
  fbx.curves(fbx.stack("Turn"), 1, "Lcl Rotation", {{0, 0, 0}, {0, 0, 180}});
  expectBox(fbx.at(0), {-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F});
  expectBox(fbx.at(1), {-0.5F, 0.5F, -0.5F}, {0.5F, 1.5F, 0.5F});
}

TEST(FbxAnimation, AnAnimationIsChosenByItsName) {
  AnimatedFbx fbx{fbxOf({{1, "cube", 0, {}}, {2, "empty", 0, {}, false}})};
  fbx.curves(fbx.stack("Walk"), 1, "Lcl Translation", {{0, 0, 0}, {100, 0, 0}});
  fbx.curves(fbx.stack("Jump"), 1, "Lcl Translation", {{0, 0, 0}, {0, 100, 0}});
  fbx.curves(fbx.stack("Other"), 2, "Lcl Translation", {{0, 0, 0}, {0, 100, 0}});
  expectBox(fbx.at(1), {0.5F, -0.5F, -0.5F}, {1.5F, 0.5F, 0.5F});
  expectBox(fbx.at(1, "Jump"), {-0.5F, 0.5F, -0.5F}, {0.5F, 1.5F, 0.5F});
  expectError<InputError>([&] { fbx.at(1, "Run"); }, "has no animation 'Run': for --animation, give one of 'Walk', 'Jump', 'Other'");
  expectError<InputError>([&] { fbx.at(1, "Other"); }, "its animation 'Other' moves none of the meshes that are baked");
}

TEST(FbxAnimation, RefusesWhatItCannotPlay) {
  AnimatedFbx still{fbxOf({{1, "cube", 0, {}}})};
  expectError<InputError>([&] { still.at(0); }, "it has no animation: export it with one");
  AnimatedFbx twins{fbxOf({{1, "cube", 0, {}}, {2, "cube", 0, {}}})};
  twins.curves(twins.stack("Walk"), 1, "Lcl Translation", {{0, 0, 0}, {100, 0, 0}});
  expectError<InputError>([&] { twins.at(0); }, "several of its nodes are named 'cube'");
  ReadSettings settings;
  settings.moment = {"", 0};
  expectError<InputError>([&] { readBytes("a.obj", "v 0 0 0\n", settings); }, "animations of this format cannot be read");
}

// Where the scale of a parent does not reach its child, assimp's nodes are elsewhere.
TEST(FbxAnimation, CountsModelsThatInheritInAnotherWay) {
  AnimatedFbx fbx{fbxOf({{1, "joint", 0, {{"Lcl Scaling", {2, 2, 2}}}, false}, {2, "cube", 1, {{"InheritType", {2}}}}})};
  fbx.curves(fbx.stack("Walk"), 2, "Lcl Translation", {{0, 0, 0}, {100, 0, 0}});
  EXPECT_EQ(countOf(fbx.at(0).warnings, WarningKind::kTransformGuessed), 1U);
}
