#include "io/sculpt/fbx_models.h"
#include "tests/io/sculpt/fbx_helpers.h"
#include "tests/io/sculpt/read_helpers.h"
#include "tests/warnings.h"

using namespace cloudbake;

namespace {

using FbxNumbers = std::vector<std::pair<std::string, std::vector<double>>>;

std::vector<std::string> formsOf(const std::vector<FbxElement>& elements) {
  return {"; FBX 7.4.0 project file\n" + fbxText(elements), fbxBinary(elements, 7400), fbxBinary(elements, 7500)};
}

ReadSculpt readFbx(const std::string& bytes, const ReadSettings& settings = {}) { return readBytes("a.fbx", bytes, settings); }

std::vector<std::string> namesOf(const Sculpt& sculpt) {
  std::vector<std::string> names;
  for (const SculptPart& part : sculpt.parts) names.push_back(part.name);
  return names;
}

// Every form must give the box, in metres.
void expectBox(const std::vector<TestModel>& models, Vec3 low, Vec3 high, uint64_t guessed = 0, const FbxNumbers& defaults = {}) {
  for (const std::string& bytes : formsOf(fbxOf(models, kFbxCentimetres, defaults))) {
    const ReadSculpt found = readFbx(bytes);
    const Corners box = boxOf(found.positions());
    expectNear(box.low, low, 1e-6);
    expectNear(box.high, high, 1e-6);
    EXPECT_EQ(countOf(found.warnings, WarningKind::kTransformGuessed), guessed);
  }
}

}  // namespace

// tests/data/hidden_hull.fbx, and what hides a model beside its own visibility.
TEST(Fbx, LeavesHiddenModelsOut) {
  const std::vector<TestModel> models{{1, "cloud", 0, {}},
                                      {2, "UCX_cloud", 0, {{"Visibility", {0}}, {"Show", {0}}}},
                                      {3, "unseen", 0, {{"Visibility", {0}}}, false},
                                      {4, "below", 3, {{"Visibility", {1}}}},
                                      {5, "further", 4, {}},
                                      {6, "apart", 3, {{"Visibility Inheritance", {0}}}},
                                      {7, "off", 0, {{"Show", {0}}}},
                                      {8, "on", 7, {}},
                                      {9, "cloud", 0, {{"Visibility", {0}}}}};  // names repeat
  for (const std::string& bytes : formsOf(fbxOf(models))) {
    const ReadSculpt found = readFbx(bytes);
    EXPECT_EQ(namesOf(found.sculpt), (std::vector<std::string>{"cloud", "apart", "on"}));
    EXPECT_EQ(countOf(found.warnings, WarningKind::kHiddenPart), 5U);
    EXPECT_EQ(countOf(found.warnings, WarningKind::kTransformGuessed), 0U);
    EXPECT_EQ(found.sculpt.nodes.size(), models.size()) << "the nodes stay";
  }
}

TEST(Fbx, LeavesModelsOfHiddenLayersOut) {
  std::vector<FbxElement> elements = fbxOf({{1, "cloud", 0, {}}, {2, "hull", 0, {}}, {3, "guide", 0, {}}});
  for (const int64_t layer : {50, 51}) {
    elements[3].children.push_back(
        {"CollectionExclusive", {layer, "DisplayLayer::l", "DisplayLayer"}, {fbxProperties({{"Show", {layer == 50 ? 0.0 : 1.0}}})}});
    elements[4].children.push_back({"C", {"OO", layer == 50 ? int64_t(2) : int64_t(3), layer}});
  }
  const ReadSculpt found = readFbx(fbxText(elements));
  EXPECT_EQ(namesOf(found.sculpt), (std::vector<std::string>{"cloud", "guide"}));
  EXPECT_EQ(countOf(found.warnings, WarningKind::kHiddenPart), 1U);
}

TEST(Fbx, RefusesAFileOfHiddenModels) {
  expectError<InputError>([] { readFbx(fbxText(fbxOf({{1, "a", 0, {{"Visibility", {0}}}}}))); }, "all its meshes are hidden; show them");
}

// tests/data/inherit.fbx: the parent's scale moves the child, and does not scale it.
TEST(Fbx, FollowsTheInheritanceOfScale) {
  const auto pair = [](double type, const FbxNumbers& parent, FbxNumbers child) {
    child.push_back({"InheritType", {type}});
    return std::vector<TestModel>{{1, "joint", 0, parent, false}, {2, "cloud", 1, child}};
  };
  const FbxNumbers twice{{"Lcl Scaling", {2, 2, 2}}}, wide{{"Lcl Scaling", {4, 1, 1}}}, moved{{"Lcl Translation", {100, 0, 0}}},
      turned{{"Lcl Translation", {100, 0, 0}}, {"Lcl Rotation", {0, 0, 90}}};
  expectBox(pair(1, twice, moved), {1, -1, -1}, {3, 1, 1});
  expectBox(pair(0, twice, moved), {1, -1, -1}, {3, 1, 1});
  expectBox(pair(2, twice, moved), {1.5F, -0.5F, -0.5F}, {2.5F, 0.5F, 0.5F});
  // R·S·r·s stretches along the parent's axis, R·r·S·s along the child's.
  expectBox(pair(1, wide, turned), {2, -0.5F, -0.5F}, {6, 0.5F, 0.5F});
  expectBox(pair(0, wide, turned), {3.5F, -2, -0.5F}, {4.5F, 2, 0.5F});
  expectBox(pair(2, wide, turned), {3.5F, -0.5F, -0.5F}, {4.5F, 0.5F, 0.5F});
  // The scale of the parent's parent reaches the child in its own axes.
  std::vector<TestModel> three = pair(2, twice, turned);
  three[0].parent = 3;
  three.insert(three.begin(), {3, "top", 0, wide, false});
  expectBox(three, {7.5F, -2, -0.5F}, {8.5F, 2, 0.5F});
  // A type that does not exist, and a scale that has no inverse, are counted.
  expectBox(pair(7, twice, moved), {1, -1, -1}, {3, 1, 1}, 1);
}

TEST(Fbx, TakesPropertiesFromTheTemplate) {
  const std::vector<TestModel> models{{1, "joint", 0, {{"Lcl Scaling", {2, 2, 2}}}, false}, {2, "cloud", 1, {}}};
  expectBox(models, {-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F}, 0, {{"InheritType", {2}}});
}

TEST(Fbx, TakesTheLastOfPropertiesOfOneName) {
  const std::vector<TestModel> models{{1, "a", 0, {{"Lcl Scaling", {2, 2, 2}}, {"Lcl Scaling", {3, 3, 3}}}}};
  expectBox(models, {-1.5F, -1.5F, -1.5F}, {1.5F, 1.5F, 1.5F});
}

// A box of 1 × 2 × 3 m shows every turn.
TEST(Fbx, TurnsByPreRotationAndOrderOnlyIfTheyAreActive) {
  const auto box = [](FbxNumbers properties) {
    properties.push_back({"Lcl Scaling", {1, 2, 3}});
    return std::vector<TestModel>{{1, "box", 0, properties}};
  };
  const Vec3 as_is{0.5F, 1, 1.5F}, about_x{0.5F, 1.5F, 1};
  const auto expectHalf = [&](const FbxNumbers& properties, Vec3 half, uint64_t guessed = 0) {
    expectBox(box(properties), {-half.x, -half.y, -half.z}, half, guessed);
  };
  expectHalf({{"PreRotation", {90, 0, 0}}}, about_x);
  expectHalf({{"PreRotation", {90, 0, 0}}, {"RotationActive", {1}}}, about_x);
  expectHalf({{"PreRotation", {90, 0, 0}}, {"RotationActive", {0}}}, as_is);
  expectHalf({{"PostRotation", {90, 0, 0}}}, about_x);
  expectHalf({{"PostRotation", {90, 0, 0}}, {"RotationActive", {0}}}, as_is);
  // x first, then y: (1, 2, 3) → (1, 3, 2) → (2, 3, 1); y first, then x: (3, 2, 1) → (3, 1, 2).
  expectHalf({{"Lcl Rotation", {90, 90, 0}}}, {1, 1.5F, 0.5F});
  expectHalf({{"Lcl Rotation", {90, 90, 0}}, {"RotationOrder", {5}}}, {1.5F, 0.5F, 1});
  expectHalf({{"Lcl Rotation", {90, 90, 0}}, {"RotationOrder", {5}}, {"RotationActive", {0}}}, {1, 1.5F, 0.5F});
}

TEST(Fbx, SphericOrderIsCounted) {
  const ReadSculpt found = readFbx(fbxText(fbxOf({{1, "a", 0, {{"Lcl Rotation", {90, 90, 0}}, {"RotationOrder", {6}}}}})));
  EXPECT_EQ(countOf(found.warnings, WarningKind::kTransformGuessed), 1U);
}

TEST(Fbx, PivotsAndGeometricTransforms) {
  // Turned about (100, 0, 0), then scaled from (0, 100, 0).
  expectBox({{1, "a", 0, {{"RotationPivot", {100, 0, 0}}, {"Lcl Rotation", {0, 0, 180}}}}}, {1.5F, -0.5F, -0.5F}, {2.5F, 0.5F, 0.5F});
  expectBox({{1, "a", 0, {{"ScalingPivot", {0, 100, 0}}, {"Lcl Scaling", {1, 3, 1}}}}}, {-0.5F, -3.5F, -0.5F}, {0.5F, -0.5F, 0.5F});
  // The geometric transform moves the mesh of its model alone, which has two children.
  const FbxNumbers geometric{{"GeometricTranslation", {0, 0, 1000}}, {"GeometricScaling", {2, 2, 2}}};
  for (const bool pivots : {false, true}) {
    std::vector<TestModel> family{{1, "a", 0, geometric, false}, {2, "b", 1, {}}, {3, "c", 1, {{"Lcl Translation", {300, 0, 0}}}}};
    if (pivots) family[0].properties.push_back({"RotationPivot", {50, 0, 0}});
    expectBox(family, {-0.5F, -0.5F, -0.5F}, {3.5F, 0.5F, 0.5F});
  }
  expectBox({{1, "a", 0, geometric}}, {-1, -1, 9}, {1, 1, 11});
}

TEST(Fbx, ReadsLeftHandedFrames) {
  FbxNumbers settings = kFbxCentimetres;
  settings[3].second = {-1};  // FrontAxisSign
  for (const std::string& bytes : formsOf(fbxOf({{1, "a", 0, {{"Lcl Translation", {100, 200, 300}}}}}, settings))) {
    const ReadSculpt found = readFbx(bytes);
    const SurfaceMesh surface = surfaceInScene(found.sculpt);
    EXPECT_NEAR(signedVolume(surface.positions, surface.triangles), 1, 1e-5) << "triangles face outwards";
    EXPECT_EQ(transformPoint(found.sculpt.parts[0].to_scene, {}), (Vec3{1, 2, -3}));
    EXPECT_EQ(found.sculpt.frame_note, "0.01 m per unit, +Y up (as the file says); left-handed");
  }
  // --up says a right-handed frame.
  ReadSettings given;
  given.up_axis = UpAxis::kY;
  EXPECT_EQ(
      transformPoint(
          readFbx(fbxText(fbxOf({{1, "a", 0, {{"Lcl Translation", {100, 200, 300}}}}}, settings)), given).sculpt.parts[0].to_scene, {}),
      (Vec3{1, 2, 3}));
}

TEST(Fbx, SaysWhereTheFrameComesFrom) {
  const std::vector<TestModel> cube{{1, "a", 0, {}}};
  const auto noteOf = [&](const FbxNumbers& settings, uint64_t assumed) {
    const ReadSculpt found = readFbx(fbxText(fbxOf(cube, settings)));
    EXPECT_EQ(countOf(found.warnings, WarningKind::kUnitsAssumed), assumed);
    return found.sculpt.frame_note;
  };
  const FbxNumbers z_up{{"UpAxis", {2}},         {"UpAxisSign", {1}}, {"FrontAxis", {1}},
                        {"FrontAxisSign", {-1}}, {"CoordAxis", {0}},  {"CoordAxisSign", {1}}};
  FbxNumbers inches = z_up;
  inches.push_back({"UnitScaleFactor", {2.54}});
  EXPECT_EQ(noteOf(inches, 0), "0.0254 m per unit, +Z up (as the file says)");
  FbxNumbers original = z_up;
  original.push_back({"OriginalUnitScaleFactor", {100}});  // of the program that made the file; not of the file
  EXPECT_EQ(noteOf(original, 1), "0.01 m per unit, +Z up (one as the file says, the other assumed)");
  EXPECT_EQ(noteOf({}, 1), "0.01 m per unit, +Y up (assumed, the file does not say)");
}

// assimp gives a model of a very long name none.
TEST(Fbx, CountsTreesThatDiffer) {
  const ReadSculpt found = readFbx(fbxText(fbxOf({{1, std::string(2000, 'a'), 0, {{"Visibility", {0}}}}})));
  EXPECT_EQ(countOf(found.warnings, WarningKind::kTransformGuessed), 1U);
  EXPECT_EQ(found.sculpt.parts.size(), 1U);
}

// Every prefix, and every byte replaced by several others.
TEST(Fbx, DamagedFilesAreReadOrRefused) {
  for (const std::string& whole :
       formsOf(fbxOf({{1, "a", 0, {{"Visibility", {0}}}, false}, {2, "b", 1, {{"Lcl Scaling", {2, 2, 2}}}, false}}, kFbxCentimetres,
                     {{"InheritType", {2}}}))) {
    EXPECT_EQ(readFbxModels("a.fbx", whole).models.size(), 2U);
    const auto attempt = [](const std::string& bytes) {
      try {
        const std::vector<char> exact(bytes.begin(), bytes.end());  // a sanitizer sees a read behind its end
        readFbxModels("a.fbx", {exact.data(), exact.size()});
      } catch (const InputError& error) {
        EXPECT_NE(error.message.find("damaged"), std::string::npos);
      }
    };
    for (size_t size = 0; size < whole.size(); ++size) attempt(whole.substr(0, size));
    for (size_t at = 0; at < whole.size(); ++at)
      for (const char c : {'\0', '\1', '\x7F', '\xFF', '{', '}', '"', ':', '\n'}) {
        std::string changed = whole;
        changed[at] = c;
        attempt(changed);
      }
  }
}

// assimp 5.2 copies 31 characters of a number, and takes the rest for something else.
TEST(Fbx, ReadsNumbersOfManyDigits) {
  std::string text = "; FBX 7.4.0 project file\n" + fbxText(fbxOf({{1, "cloud", 0, {}}}));
  for (const auto& [number, longer] : {std::pair{",50.000000", ",49.9999999999999999999999999999999999999999999999999999"},
                                       {",-50.000000", ",-50.0000000000000000000000000000000000000000000000000001"}})
    for (size_t at = 0; (at = text.find(number, at)) != text.npos; at += 50) text.replace(at, std::string_view(number).size(), longer);
  const ReadSculpt found = readFbx(text);
  const Corners box = boxOf(found.positions());
  expectNear(box.low, {-0.5, -0.5, -0.5}, 1e-6);
  expectNear(box.high, {0.5, 0.5, 0.5}, 1e-6);
}
