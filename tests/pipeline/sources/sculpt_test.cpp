// Sculpts as artists leave them: what is told of them, what is repaired, and what bounds their volume.
#include "pipeline/sources/sculpt.h"

#include <algorithm>
#include <cmath>

#include "io/file/write_file.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

struct Read {
  Cloud cloud;
  BakeReport report;
};
Read read(const fs::path& file, const std::vector<std::string>& texts = {}) {
  Read r;
  r.report.input = file.string();
  Stopwatch watch;
  r.cloud = readSculpt(settingsFor(texts, SourceKind::kSculpt, file), r.report, watch);
  return r;
}

const Warnings::Entry* entry(const Warnings& warnings, WarningKind kind) {
  const auto found = warnings.entries().find(kind);
  return found == warnings.entries().end() ? nullptr : &found->second;
}

SurfaceMesh box() { return boxMesh({0, 0, 0}, {1, 1, 1}); }
// Triangle 4 is gone, 7 is turned, and more where that is asked for.
SurfaceMesh openBox() {
  SurfaceMesh mesh = box();
  mesh.triangles.erase(mesh.triangles.begin() + 4);
  return mesh;
}
SurfaceMesh turnedBox() {
  SurfaceMesh mesh = box();
  std::swap(mesh.triangles[7][1], mesh.triangles[7][2]);
  return mesh;
}

Affine mirrorAt(double x) {
  Affine node;
  node.linear[0][0] = -1;
  node.offset[0] = x;
  return node;
}

// --- What is told ---

TEST(Sculpt, PlacesAreCountedAsTheArtistDoes) {
  Sculpt sculpt;
  sculpt.parts = {partOf(box(), "Body", 0), partOf(ballMesh(1, 0), "", 1), partOf(box(), "Tail", 2)};
  EXPECT_EQ(placeInSculpt(sculpt, 0, false), "triangle 0 of 'Body'");
  EXPECT_EQ(placeInSculpt(sculpt, 11, false), "triangle 11 of 'Body'");
  EXPECT_EQ(placeInSculpt(sculpt, 12, false), "triangle 0");
  EXPECT_EQ(placeInSculpt(sculpt, 12 + 20 + 3, false), "triangle 3 of 'Tail'");
  EXPECT_EQ(placeInSculpt(sculpt, 8 + 12, true), "vertex 0 of 'Tail'");
  EXPECT_EQ(placeInSculpt(sculpt, 1000, true), "an unknown place");
}

TEST(Sculpt, DefectsAreCountedWithTheirPlace) {
  const TestFolder folder;
  SurfaceMesh mesh = merged(box(), openBox());
  for (size_t v = 8; v < 16; ++v) mesh.positions[v].x += 3;
  std::swap(mesh.triangles[5][1], mesh.triangles[5][2]);
  mesh.triangles.push_back(mesh.triangles[1]);
  const Read r = read(folder.write("odd.obj", objText(mesh)));
  const MeshDefects defects = findDefects(r.cloud.surface);
  const auto expectCount = [&](WarningKind kind, const Defect& defect) {
    ASSERT_TRUE(entry(r.report.warnings, kind));
    EXPECT_EQ(entry(r.report.warnings, kind)->count, defect.count);
    EXPECT_TRUE(contains(entry(r.report.warnings, kind)->first, "first at triangle " + std::to_string(defect.first) + " of 'odd'"))
        << entry(r.report.warnings, kind)->first;
  };
  EXPECT_EQ(defects.open_edges.count, 3U);
  expectCount(WarningKind::kOpenEdges, defects.open_edges);
  expectCount(WarningKind::kTurnedTriangles, defects.turned_edges);
  expectCount(WarningKind::kNonManifoldEdges, defects.non_manifold_edges);
  expectCount(WarningKind::kDuplicateTriangle, defects.duplicate_triangles);
  EXPECT_FALSE(entry(read(folder.write("sound.obj", objText(box()))).report.warnings, WarningKind::kOpenEdges));
}

TEST(Sculpt, IsAsInItsFile) {
  const TestFolder folder;
  const fs::path file = folder.write("a.obj", objText(box()));
  const Read r = read(file), tall = read(file, {"up=z", "units=0.01"});
  EXPECT_EQ(r.cloud.surface.positions, box().positions);
  EXPECT_EQ(r.cloud.surface.triangles, box().triangles);
  EXPECT_TRUE(r.cloud.closed && !r.cloud.filled && !r.cloud.wrapped && r.cloud.spheres.empty());
  EXPECT_EQ(r.report.volume_note, "");
  EXPECT_EQ(r.report.info.input_hash, hashBytes(readFileBytes(file)));
  EXPECT_TRUE(contains(r.report.frame_note, "+Y up"));
  EXPECT_TRUE(contains(tall.report.frame_note, "0.01 m per unit, +Z up")) << tall.report.frame_note;
  EXPECT_EQ(refusalOf<InputError>([&] { read(folder.write("b.obj", "v 0 0 nonsense\n")); }).find((folder.path / "b.obj").string() + ":1"),
            0U);
}

TEST(Sculpt, InspectionFindsWhatSpoilsNoBake) {
  const TestFolder folder;
  const SurfaceMesh outer = boxMesh({0, 0, 0}, {9, 9, 9}), inner = boxMesh({3, 3, 3}, {4, 4, 4});
  SurfaceMesh cavity = inner;
  reverse(cavity);
  const auto found = [&](const SurfaceMesh& mesh, WarningKind kind) {
    const Read r = read(folder.write("i.obj", objText(mesh)), {"inspect"});
    EXPECT_FALSE(entry(r.report.warnings, kind)) << "a finding is no warning";
    const Warnings::Entry* one = entry(r.report.findings, kind);
    return one ? std::to_string(one->count) + ": " + one->first : "";
  };
  EXPECT_EQ(found(merged(outer, inner), WarningKind::kInnerShell),
            "1: a shell lies inside another: it adds nothing, first at triangle 12 of 'i'");
  EXPECT_EQ(found(merged(outer, cavity), WarningKind::kInnerShell),
            "1: a shell lies inside another: a cavity, first at triangle 12 of 'i'");
  EXPECT_EQ(found(merged(outer, boxMesh({20, 0, 0}, {21, 1, 1})), WarningKind::kInnerShell), "");
  EXPECT_TRUE(contains(found(merged(outer, boxMesh({8, 1, 1}, {12, 2, 2})), WarningKind::kSelfIntersection),
                       "two triangles cut or touch each other, first at triangle "));
  EXPECT_EQ(found(merged(outer, inner), WarningKind::kSelfIntersection), "");
  EXPECT_TRUE(read(folder.write("i.obj", objText(merged(outer, inner)))).report.findings.empty()) << "only where it is asked for";
}

// --- What bounds the volume ---

TEST(Sculpt, AnOpenMeshIsFilledUnlessToldOtherwise) {
  const TestFolder folder;
  const fs::path open = folder.write("open.obj", objText(openBox())), turned = folder.write("turned.obj", objText(turnedBox()));
  const Read filled = read(open);
  EXPECT_FALSE(filled.cloud.closed);
  ASSERT_TRUE(filled.cloud.filled);
  EXPECT_NEAR(signedVolume(*filled.cloud.filled), 1, 1e-6);
  EXPECT_EQ(filled.cloud.surface.triangles.size(), 11U) << "the sculpt itself is not changed";
  EXPECT_EQ(filled.report.volume_note, "bounded by the sculpt with 1 holes filled");
  const Read oriented = read(turned);
  ASSERT_TRUE(oriented.cloud.filled);
  EXPECT_NEAR(signedVolume(*oriented.cloud.filled), 1, 1e-6);
  EXPECT_EQ(oriented.report.volume_note, "bounded by the sculpt with its triangles oriented alike");
  SurfaceMesh inside_out = openBox();
  for (Triangle& t : inside_out.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(read(folder.write("inside_out.obj", objText(inside_out))).cloud.filled);
  const Read wrapped = read(open, {"close=wrap"});
  EXPECT_TRUE(wrapped.cloud.wrapped && !wrapped.cloud.filled);
  EXPECT_TRUE(read(folder.write("box.obj", objText(box())), {"close=wrap"}).cloud.wrapped) << "always, then";
}

TEST(Sculpt, RejectSaysWhatIsOpenAndHowToCloseIt) {
  const TestFolder folder;
  const auto told = [&](const SurfaceMesh& mesh) {
    return refusalOf<InputError>([&] { read(folder.write("r.obj", objText(mesh)), {"close=reject"}); });
  };
  const std::string at = (folder.path / "r.obj").string() + ": --close reject: the mesh bounds no volume, ";
  EXPECT_EQ(told(box()), "");
  // The lowest number of a triangle at such an edge.
  EXPECT_EQ(told(openBox()), at + "3 edges are open, first at triangle 0 of 'r': close it, or use --repair orient,fill or --close auto");
  EXPECT_EQ(told(turnedBox()), at + "3 edges lie between triangles of opposite winding, first at triangle 3 of 'r': close it, or use "
                                    "--repair orient or --close auto");
  SurfaceMesh doubled = box();
  doubled.triangles.push_back(doubled.triangles[3]);
  EXPECT_EQ(told(doubled),
            at + "3 edges have more than two triangles, first at triangle 2 of 'r': close it, or use --repair orient or --close auto");
}

// Leaves of a tree: flat cones without a base, every other one inside out. The volume is that of all of them, and none is taken from
// another.
TEST(Sculpt, ManyOpenConesAreAVolume) {
  const TestFolder folder;
  SurfaceMesh leaves;
  constexpr int kLeaves = 100, kSides = 8;
  constexpr float kRadius = 0.15F, kHeight = 0.05F;
  for (int leaf = 0; leaf < kLeaves; ++leaf) {
    const auto apex = uint32_t(leaves.positions.size());
    const int column = leaf % 10, row = leaf / 10;
    const Vec3 at{0.5F * float(column), 0, 0.5F * float(row)};
    leaves.positions.push_back(at + Vec3{0, kHeight, 0});
    for (int i = 0; i < kSides; ++i)
      leaves.positions.push_back(at +
                                 Vec3{kRadius * std::cos(float(kPi) / 4 * float(i)), 0, kRadius * std::sin(float(kPi) / 4 * float(i))});
    for (uint32_t i = 0; i < kSides; ++i) {
      Triangle side{apex, apex + 1 + (i + 1) % kSides, apex + 1 + i};
      if (leaf % 2 == 1) std::swap(side[1], side[2]);
      leaves.triangles.push_back(side);
    }
  }
  const Read r = read(folder.write("leaves.obj", objText(leaves)));
  ASSERT_TRUE(r.cloud.filled);
  const double base = 0.5 * kSides * std::sin(2 * kPi / kSides) * kRadius * kRadius;
  EXPECT_NEAR(signedVolume(*r.cloud.filled), kLeaves * base * kHeight / 3, 1e-4 * kLeaves * base * kHeight);
}

TEST(Sculpt, AFlatSheetIsRefused) {
  const TestFolder folder;
  const fs::path sheet = folder.write("s.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  expectError<InputError>([&] { read(sheet); }, sheet.string() + ": the mesh is a flat sheet that encloses nothing");
  EXPECT_TRUE(read(sheet, {"close=wrap"}).cloud.wrapped);
  // A dome a tenth as high as it is wide holds something.
  const fs::path dome = folder.write("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.3 0.3 0.1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  EXPECT_TRUE(read(dome).cloud.filled);
}

// --- Repair ---

// Turned first, then filled, then closed: what is left to reject is nothing. What was odd before is told all the same.
TEST(Sculpt, RepairsComeBeforeTheMeshIsJudged) {
  const TestFolder folder;
  SurfaceMesh mesh = turnedBox();
  mesh.triangles.erase(mesh.triangles.begin() + 4);
  const fs::path file = folder.write("r.obj", objText(mesh));
  const Read r = read(file, {"repair=orient,fill", "close=reject"});
  EXPECT_TRUE(r.cloud.closed);
  EXPECT_NEAR(signedVolume(r.cloud.surface), 1, 1e-6);
  ASSERT_TRUE(r.report.repair);
  EXPECT_EQ(r.report.repair->turned_triangles, 1U);
  EXPECT_EQ(r.report.repair->filled_holes, 1U);
  EXPECT_EQ(r.report.repair->added_triangles, 1U);
  EXPECT_TRUE(entry(r.report.warnings, WarningKind::kOpenEdges) && entry(r.report.warnings, WarningKind::kTurnedTriangles));
  EXPECT_FALSE(read(file).report.repair);
  EXPECT_FALSE(read(file, {"repair=orient"}).cloud.closed);
  EXPECT_TRUE(read(file, {"repair=orient"}).cloud.filled) << "the volume is filled, the mesh is not";
  std::vector<std::string> stages;
  BakeReport report;
  Stopwatch watch([&](const std::string& stage) { stages.push_back(stage); });
  readSculpt(settingsFor({"repair=orient,fill", "inspect", "remesh=50%"}, SourceKind::kSculpt, file), report, watch);
  EXPECT_EQ(stages, (std::vector<std::string>{"read", "check", "inspect", "repair", "surface", "check"}));
}

// Vertices keep their number and order, new triangles go to the part of their corners, and nodes stay.
TEST(Sculpt, RepairKeepsTheParts) {
  const TestFolder folder;
  const Read r = read(writeParts(folder, "parts.glb", {partOf(box(), "whole", 0), partOf(openBox(), "open", 1, mirrorAt(5))}),
                      {"repair=fill", "close=reject"});
  ASSERT_EQ(r.cloud.sculpt.parts.size(), 2U);
  const SculptPart &whole = r.cloud.sculpt.parts[0], &open = r.cloud.sculpt.parts[1];
  EXPECT_EQ(whole.triangles, box().triangles);
  EXPECT_FALSE(whole.repaired);
  EXPECT_TRUE(open.repaired);
  EXPECT_EQ(open.name, "open");
  EXPECT_EQ(open.positions, box().positions);
  EXPECT_EQ(open.to_scene.linear[0][0], -1);
  ASSERT_EQ(open.triangles.size(), 12U);
  EXPECT_TRUE(std::equal(open.triangles.begin(), open.triangles.end() - 1, openBox().triangles.begin()));
  // In the scene both face outwards, the mirrored one and its new triangle too.
  EXPECT_NEAR(signedVolume(r.cloud.surface), 2, 1e-6);
  EXPECT_EQ(findDefects(r.cloud.surface).unmatched_edges, 0U);
}

TEST(Sculpt, NormalsTurnWithTheirTriangles) {
  const TestFolder folder;
  SurfaceMesh inverted = ballMesh(1, 1);
  reverse(inverted);
  const Read as_it_is = read(writeParts(folder, "parts.glb", {partOf(inverted, "ball", 0)})),
             oriented = read(writeParts(folder, "parts.glb", {partOf(inverted, "ball", 0)}), {"repair=orient"});
  EXPECT_LT(signedVolume(as_it_is.cloud.surface), 0);
  EXPECT_GT(signedVolume(oriented.cloud.surface), 0);
  for (size_t v = 0; v < inverted.positions.size(); ++v) {
    EXPECT_LT(dot(as_it_is.cloud.surface.normals[v], inverted.positions[v]), 0);
    EXPECT_GT(dot(oriented.cloud.surface.normals[v], inverted.positions[v]), 0.99F);
  }
}

// --- A mesh of ours ---

TEST(Sculpt, ANewMeshIsOnePart) {
  const TestFolder folder;
  const SurfaceMesh ball = ballMesh(1, 3);
  const fs::path file = writeParts(folder, "parts.glb", {partOf(ball, "first", 0), partOf(ball, "second", 1, mirrorAt(5))});
  const Read kept = read(file), reduced = read(file, {"vertices=200"}), even = read(file, {"remesh=5%"}),
             own = read(file, {"repair=remesh"});
  EXPECT_EQ(kept.cloud.sculpt.parts.size(), 2U);
  EXPECT_FALSE(kept.report.surface_error);
  for (const auto& [r, option] : {std::pair(&reduced, "--vertices"), std::pair(&even, "--remesh"), std::pair(&own, "--repair remesh")}) {
    ASSERT_EQ(r->cloud.sculpt.parts.size(), 1U) << option;
    EXPECT_EQ(r->cloud.sculpt.parts[0].name, "first");
    EXPECT_FALSE(r->cloud.sculpt.gltf);
    EXPECT_EQ(r->cloud.surface.normals.size(), r->cloud.surface.positions.size());
    ASSERT_TRUE(entry(r->report.warnings, WarningKind::kPartIgnored)) << option;
    EXPECT_EQ(entry(r->report.warnings, WarningKind::kPartIgnored)->first.find(std::string(option) + " makes one new mesh"), 0U);
    ASSERT_TRUE(r->report.surface_error);
    EXPECT_LT(r->report.surface_error->rms, 0.02) << option;
    EXPECT_TRUE(r->cloud.closed) << option;
    EXPECT_NEAR(signedVolume(r->cloud.surface), 2 * 4 * kPi / 3, 1) << option;
  }
  EXPECT_LE(reduced.cloud.surface.positions.size(), 200U);
  // Edges of a twentieth of the longest side, 7.
  EXPECT_NEAR(meanEdgeLength(even.cloud.surface), 0.35, 0.07);
  EXPECT_NEAR(meanEdgeLength(own.cloud.surface), meanEdgeLength(kept.cloud.surface), 0.2 * meanEdgeLength(kept.cloud.surface));
  // A budget that is not exceeded changes nothing.
  const Read roomy = read(file, {"vertices=100000"});
  EXPECT_EQ(roomy.cloud.sculpt.parts.size(), 2U);
  EXPECT_TRUE(roomy.cloud.sculpt.gltf);
}

// --- Objects apart ---

TEST(Sculpt, SeparateObjectsAreClosedOrOpenByThemselves) {
  Cloud cloud;
  cloud.sculpt.parts = {partOf(box(), "a", 0), partOf(openBox(), "b", 0, mirrorAt(5)), partOf(openBox(), "c", 1, mirrorAt(9)),
                        partOf(box(), "d", 2)};
  cloud.surface = surfaceInScene(cloud.sculpt);
  cloud.closed = false;
  BakeReport report;
  const std::vector<Cloud> objects = separateObjects(cloud, {}, report);
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[0].sculpt.parts.size(), 2U) << "parts of one object stay together";
  EXPECT_EQ(objects[0].surface.positions.size(), 16U);
  EXPECT_FALSE(objects[0].closed || objects[1].closed);
  EXPECT_TRUE(objects[0].filled && objects[1].filled && objects[2].closed);
  EXPECT_NEAR(boundingBox(objects[1].surface).low.x, 8, 1e-6) << "where it stands in the scene";
  MeshSettings reject;
  reject.close = CloseChoice::kReject;
  expectError<InputError>([&] { separateObjects(cloud, reject, report); }, "--close reject");
}

}  // namespace
}  // namespace cloudbake
