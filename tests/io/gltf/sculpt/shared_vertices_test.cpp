// Many primitives over one vertex buffer, as exporters write them for materials and pieces: they cost what one primitive costs.
#include <numeric>

#include "io/gltf/sculpt/part_per_primitive.h"
#include "tests/io/gltf/gltf_helpers.h"

namespace cloudbake {

namespace {

constexpr size_t kCorners = 4;

// Tetrahedra in a row, in one set of accessors.
struct Row {
  GltfBuilder gltf;
  Json attributes = Json::object();
  size_t count = 0;

  explicit Row(size_t tetrahedra) : count(tetrahedra) {
    std::vector<Vec3> positions;
    std::vector<Vec2> uvs;
    for (size_t i = 0; i < count; ++i) {
      const Vec3 origin{float(3 * i), 0, 0};
      for (const Vec3 corner : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        positions.push_back(origin + corner);
        uvs.push_back({float(uvs.size()), 0.5F});
      }
    }
    attributes["POSITION"] = gltf.accessor(positions, 5126, "VEC3", positions.size());
    gltf.json["accessors"].back()["min"] = {0, 0, 0};
    gltf.json["accessors"].back()["max"] = {3 * (count - 1) + 1, 1, 1};
    attributes["TEXCOORD_0"] = gltf.accessor(uvs, 5126, "VEC2", uvs.size());
  }
  size_t vertices() const { return kCorners * count; }
  int indicesOf(size_t first, size_t tetrahedra = 1) {
    std::vector<uint16_t> indices;
    for (size_t i = first; i < first + tetrahedra; ++i)
      for (const size_t v : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) indices.push_back(uint16_t(kCorners * i + v));
    return gltf.accessor(indices, 5123, "SCALAR", indices.size(), 34963);
  }
  // The primitive of one tetrahedron.
  Json piece(size_t index) { return {{"attributes", attributes}, {"indices", indicesOf(index)}}; }
  std::vector<Json> pieces() {
    std::vector<Json> all;
    for (size_t i = 0; i < count; ++i) all.push_back(piece(i));
    return all;
  }
  void draw(const std::vector<Json>& nodes) {
    gltf.json["scenes"] = Json::array({{{"nodes", Json::array()}}});
    for (const Json& node : nodes) gltf.json["scenes"][0]["nodes"].push_back(gltf.node(node));
  }
};

size_t bufferBytes(const Trip& trip) { return trip.json["buffers"][0]["byteLength"]; }

std::vector<Triangle> movedBy(std::vector<Triangle> triangles, uint32_t by) {
  for (Triangle& t : triangles)
    for (uint32_t& v : t) v += by;
  return triangles;
}

}  // namespace

TEST(SharedVertices, PrimitivesOfAMeshAreOnePart) {
  const TestFolder folder;
  Row row(5), whole(5);
  const int piece_bytes = 12 * sizeof(uint16_t);
  std::vector<Json> pieces = row.pieces();
  row.gltf.json["materials"] = Json::array({{{"name", "a"}}, {{"name", "b"}}});
  for (size_t i = 0; i < pieces.size(); ++i) pieces[i]["material"] = i % 2;
  row.gltf.mesh(pieces);
  row.draw({{{"mesh", 0}}});
  whole.gltf.mesh({{{"attributes", whole.attributes}, {"indices", whole.indicesOf(0, 5)}}});
  whole.draw({{{"mesh", 0}}});

  const Trip trip = roundTrip(folder, "a.glb", row.gltf.glb()), one = roundTrip(folder, "b.glb", whole.gltf.glb());
  expectSameLobes(trip);
  EXPECT_TRUE(trip.warnings.empty());
  ASSERT_EQ(trip.sculpt.parts.size(), 1U);
  EXPECT_EQ(trip.sculpt.parts[0].positions.size(), row.vertices());
  EXPECT_EQ(trip.sculpt.parts[0].triangles, one.sculpt.parts[0].triangles);
  EXPECT_EQ(trip.baked.surface.triangles, one.baked.surface.triangles);
  // One pair of accessors has the lobes of all primitives, which keep their indices and materials.
  EXPECT_EQ(trip.json["accessors"].size(), row.gltf.json["accessors"].size() + 2);
  EXPECT_EQ(bufferBytes(trip), bufferBytes(one) + size_t(5 * piece_bytes - 60 * int(sizeof(uint16_t))));
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(attributesOf(trip.json, 0, i), attributesOf(trip.json, 0, 0));
    EXPECT_EQ(attributesOf(trip.json, 0, i)["POSITION"], row.attributes["POSITION"]);
    EXPECT_TRUE(attributesOf(trip.json, 0, i).contains("TEXCOORD_2"));
    EXPECT_EQ(trip.json["meshes"][0]["primitives"][i]["indices"], pieces[i]["indices"]);
    EXPECT_EQ(trip.json["meshes"][0]["primitives"][i]["material"], i % 2);
  }
}

// Some exporters write accessors of the same bytes for every primitive.
TEST(SharedVertices, AccessorsOfTheSameBytesAreTheSame) {
  const TestFolder folder;
  Row row(3);
  std::vector<Json> pieces = row.pieces();
  for (size_t i = 1; i < pieces.size(); ++i)
    for (auto& [name, accessor] : pieces[i]["attributes"].items()) {
      row.gltf.json["accessors"].push_back(Json(row.gltf.json["accessors"][accessor.get<size_t>()]));
      accessor = row.gltf.json["accessors"].size() - 1;
    }
  row.gltf.json["bufferViews"][0]["byteStride"] = 12, row.gltf.json["bufferViews"][1]["byteStride"] = 8;
  row.gltf.mesh(pieces);
  row.draw({{{"mesh", 0}}});
  const Trip trip = roundTrip(folder, "a.glb", row.gltf.glb());
  expectSameLobes(trip);
  EXPECT_EQ(trip.sculpt.parts.size(), 1U);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(attributesOf(trip.json, 0, i)["POSITION"], pieces[i]["attributes"]["POSITION"]);
    EXPECT_EQ(attributesOf(trip.json, 0, i)["TEXCOORD_1"], attributesOf(trip.json, 0, 0)["TEXCOORD_1"]);
  }
}

TEST(SharedVertices, OtherAttributesMakeAnotherPart) {
  const TestFolder folder;
  Row row(4);
  std::vector<Json> pieces = row.pieces();
  pieces[1]["attributes"]["COLOR_0"] = row.gltf.accessor(std::vector<Vec3>(row.vertices()), 5126, "VEC3", row.vertices());
  pieces[3]["targets"] = Json::array({{{"POSITION", row.attributes["POSITION"]}}});
  row.gltf.mesh({pieces[0], pieces[1], pieces[2]});
  row.gltf.mesh({pieces[3]});  // all primitives of a mesh have the same number of targets
  row.draw({{{"mesh", 0}}, {{"mesh", 1}}});
  const Trip trip = roundTrip(folder, "a.glb", row.gltf.glb());
  expectSameLobes(trip);
  // The first and the third use half of the positions, each other one a quarter, and get these as their own.
  ASSERT_EQ(trip.sculpt.parts.size(), 3U);
  EXPECT_EQ(trip.sculpt.parts[0].positions.size(), 2 * kCorners);
  EXPECT_EQ(trip.sculpt.parts[0].triangles.size(), 8U);
  EXPECT_EQ(trip.sculpt.parts[1].positions.size(), kCorners);
  EXPECT_EQ(trip.sculpt.parts[2].positions.size(), kCorners);
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kPoseIgnored), 1U);
  const Json& target = trip.json["meshes"][1]["primitives"][0]["targets"][0]["POSITION"];
  EXPECT_EQ(trip.json["accessors"][target.get<size_t>()]["count"], kCorners);
}

// Each node needs lobes of its own, but not for the vertices of the others.
TEST(SharedVertices, NodesGetTheVerticesThatTheyUse) {
  const TestFolder folder;
  constexpr size_t kNodes = 40;
  Row row(kNodes);
  std::vector<Json> nodes;
  for (size_t i = 0; i < kNodes; ++i) {
    row.gltf.mesh({row.piece(i)});
    nodes.push_back({{"mesh", i}, {"rotation", {0, 0.6, 0, 0.8}}, {"translation", {0, i, 0}}});
  }
  row.draw(nodes);
  const size_t source_bytes = row.gltf.binary.size();
  const Trip trip = roundTrip(folder, "a.glb", row.gltf.glb());
  expectSameLobes(trip);
  EXPECT_TRUE(trip.warnings.empty());
  ASSERT_EQ(trip.sculpt.parts.size(), kNodes);
  EXPECT_NE(trip.sculpt.frame_note.find("40 primitives got vertices of their own"), std::string::npos) << trip.sculpt.frame_note;
  for (size_t i = 0; i < kNodes; ++i) {
    const SculptPart& part = trip.sculpt.parts[i];
    ASSERT_EQ(part.positions.size(), kCorners);
    EXPECT_EQ(part.positions[3], (Vec3{float(3 * i), 0, 1}));
    EXPECT_EQ(part.triangles, trip.sculpt.parts[0].triangles);
    EXPECT_EQ(floatsOf(trip, attributesOf(trip.json, i)["TEXCOORD_0"], 2)[2], float(kCorners * i + 1));
  }
  EXPECT_EQ(bufferBytes(trip), source_bytes + 16 * row.vertices() + 69);  // the lobes, and the white texture
}

TEST(SharedVertices, ManyDrawingsNeedTheMemoryOfTheirVertices) {
  const TestFolder folder;
  constexpr size_t kPieces = 2000;
  ReadSettings settings;
  settings.memory_limit = 64 << 20;
  Warnings warnings;
  Row mesh(kPieces), apart(kPieces);
  mesh.gltf.mesh(mesh.pieces());
  mesh.draw({{{"mesh", 0}}});
  EXPECT_EQ(readMesh(folder.write("a.glb", mesh.gltf.glb()), settings, warnings).parts.at(0).triangles.size(), 4 * kPieces);
  std::vector<Json> nodes;
  for (size_t i = 0; i < kPieces; ++i) {
    apart.gltf.mesh({apart.piece(i)});
    nodes.push_back({{"mesh", i}});
  }
  apart.draw(nodes);
  EXPECT_EQ(readMesh(folder.write("b.glb", apart.gltf.glb()), settings, warnings).parts.size(), kPieces);
  EXPECT_TRUE(warnings.empty());
  // A mesh of few vertices that all instances draw.
  Row instanced(kPieces);
  instanced.gltf.mesh({instanced.piece(7)});
  const int moves = instanced.gltf.accessor(std::vector<Vec3>(500), 5126, "VEC3", 500, 0);
  instanced.draw({{{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}}}}});
  const Sculpt sculpt = readMesh(folder.write("c.glb", instanced.gltf.glb()), settings, warnings);
  ASSERT_EQ(sculpt.parts.size(), 500U);
  EXPECT_EQ(sculpt.parts.back().positions.size(), kCorners);
}

// What is drawn once keeps every vertex, used or not, and so does what uses most of its vertices.
TEST(SharedVertices, OthersKeepAllVertices) {
  const TestFolder folder;
  Row once(3), most(3);
  once.gltf.mesh({once.piece(1)});
  once.draw({{{"mesh", 0}}});
  EXPECT_EQ(roundTrip(folder, "a.glb", once.gltf.glb()).sculpt.parts.at(0).positions.size(), once.vertices());
  most.gltf.mesh({{{"attributes", most.attributes}, {"indices", most.indicesOf(0, 2)}}});
  most.gltf.mesh({{{"attributes", most.attributes}, {"indices", most.indicesOf(1, 2)}}});
  most.draw({{{"mesh", 0}}, {{"mesh", 1}, {"scale", {2, 1, 1}}}});
  const Trip trip = roundTrip(folder, "b.glb", most.gltf.glb());
  expectSameLobes(trip);
  for (const SculptPart& part : trip.sculpt.parts) EXPECT_EQ(part.positions.size(), most.vertices());
  EXPECT_EQ(attributesOf(trip.json, 0)["POSITION"], attributesOf(trip.json, 1)["POSITION"]);
}

// Joints and weights go with their vertices.
TEST(SharedVertices, SkinnedPrimitivesKeepTheirJoints) {
  const TestFolder folder;
  Row row(4);
  std::vector<uint8_t> joints;
  std::vector<float> weights;
  for (size_t v = 0; v < row.vertices(); ++v) {
    joints.insert(joints.end(), {uint8_t(v / kCorners % 2), 0, 0, 0});
    weights.insert(weights.end(), {1, 0, 0, 0});
  }
  row.attributes["JOINTS_0"] = row.gltf.accessor(joints, 5121, "VEC4", row.vertices());
  row.attributes["WEIGHTS_0"] = row.gltf.accessor(weights, 5126, "VEC4", row.vertices());
  row.gltf.mesh({row.piece(1), row.piece(3)});
  row.gltf.mesh({row.piece(2)});
  row.gltf.json["skins"] = Json::array({{{"joints", {3, 4}}}});
  row.draw({{{"mesh", 0}, {"skin", 0}}, {{"mesh", 1}, {"skin", 0}}, {{"children", {3, 4}}}});
  row.gltf.node({{"translation", {0, 10, 0}}}), row.gltf.node({{"translation", {0, 0, 50}}});
  const Trip trip = roundTrip(folder, "a.glb", row.gltf.glb());
  expectSameLobes(trip);
  const SurfaceMesh scene = surfaceInScene(trip.sculpt);
  ASSERT_EQ(trip.sculpt.parts.size(), 2U);
  ASSERT_EQ(scene.positions.size(), 3 * kCorners);
  EXPECT_EQ(scene.positions[0], (Vec3{3, 0, 50}));
  EXPECT_EQ(scene.positions[kCorners], (Vec3{9, 0, 50}));
  EXPECT_EQ(scene.positions[2 * kCorners], (Vec3{6, 10, 0}));
}

TEST(SharedVertices, PartsCanBeTakenApart) {
  const TestFolder folder;
  Row row(3);
  row.gltf.mesh(row.pieces());
  row.draw({{{"mesh", 0}}, {{"mesh", 0}, {"translation", {0, 5, 0}}}});
  Warnings warnings;
  const Sculpt shared = readMesh(folder.write("a.glb", row.gltf.glb()), {}, warnings);
  ASSERT_EQ(shared.parts.size(), 2U);
  std::vector<PartSource> sources;
  const auto apart = withPartPerPrimitive(
      shared, [](size_t part) { return part == 1; }, &sources);
  ASSERT_TRUE(apart);
  ASSERT_EQ(apart->parts.size(), 4U);
  EXPECT_EQ(apart->parts[0].positions, shared.parts[0].positions);
  EXPECT_EQ(sources[3].part, 1U);
  EXPECT_EQ(sources[3].vertices, (std::vector<uint32_t>{8, 9, 10, 11}));
  EXPECT_EQ(apart->parts[3].to_scene.offset, shared.parts[1].to_scene.offset);
  EXPECT_EQ(movedBy(apart->parts[3].triangles, 8),
            std::vector<Triangle>(shared.parts[1].triangles.end() - 4, shared.parts[1].triangles.end()));
  const std::string glb = encodeGlb(*apart, fakeLobes(*apart), sampleInfo(), {}, warnings);
  const Sculpt again = readMesh(folder.write("b.glb", glb), {}, warnings);
  ASSERT_EQ(again.parts.size(), 4U);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(again.parts[i].positions, apart->parts[i].positions);
  EXPECT_FALSE(withPartPerPrimitive(*apart, [](size_t part) { return part > 0; }));
}

}  // namespace cloudbake
