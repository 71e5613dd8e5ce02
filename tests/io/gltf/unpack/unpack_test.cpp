// Compressed glTF is baked like the plain file that it was made of, and the asset is plain.
#include <draco/compression/encode.h>
#include <meshoptimizer.h>

#include <functional>

#include "tests/io/gltf/gltf_helpers.h"

using namespace cloudbake;

namespace {

// A bumpy grid of n×n vertices, closed at the back so that it has a volume.
struct Lump {
  std::vector<Vec3> positions;
  std::vector<uint32_t> indices;
};

Lump lump(uint32_t n = 12) {
  Lump l;
  for (uint32_t side = 0; side < 2; ++side)
    for (uint32_t i = 0; i < n; ++i)
      for (uint32_t j = 0; j < n; ++j)
        l.positions.push_back({float(i) / 4, float(j) / 4, side == 0 ? 0 : 1 + 0.25F * std::sin(float(i * j))});
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) { l.indices.insert(l.indices.end(), {a, b, c, a, c, d}); };
  const auto at = [&](uint32_t side, uint32_t i, uint32_t j) { return side * n * n + i * n + j; };
  for (uint32_t i = 0; i + 1 < n; ++i)
    for (uint32_t j = 0; j + 1 < n; ++j) {
      quad(at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1));
      quad(at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j));
    }
  for (uint32_t i = 0; i + 1 < n; ++i) {
    quad(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));
    quad(at(0, i + 1, n - 1), at(0, i, n - 1), at(1, i, n - 1), at(1, i + 1, n - 1));
    quad(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
    quad(at(0, n - 1, i), at(0, n - 1, i + 1), at(1, n - 1, i + 1), at(1, n - 1, i));
  }
  return l;
}

void setBounds(Json& accessor, const std::vector<Vec3>& positions) {
  Box box;
  for (const Vec3 p : positions) box.add(p);
  accessor["min"] = {box.low.x, box.low.y, box.low.z};
  accessor["max"] = {box.high.x, box.high.y, box.high.z};
}

GltfBuilder plainLump() {
  const Lump l = lump();
  GltfBuilder gltf;
  const int position = gltf.accessor(l.positions, 5126, "VEC3", l.positions.size());
  setBounds(gltf.json["accessors"].back(), l.positions);
  const int indices = gltf.accessor(l.indices, 5125, "SCALAR", l.indices.size(), 34963);
  gltf.mesh({{{"attributes", {{"POSITION", position}}}, {"indices", indices}}});
  gltf.node({{"mesh", 0}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  return gltf;
}

// --- meshopt ---

constexpr const char* kMeshopt = "EXT_meshopt_compression";

// Replaces the bytes of a view by compressed ones, and points the view itself into a buffer without bytes.
void compressView(GltfBuilder& gltf, size_t view, const std::string& compressed, size_t count, size_t stride, const std::string& mode,
                  const std::string& filter = "NONE", const std::string& name = kMeshopt) {
  gltf.binary.append((4 - gltf.binary.size() % 4) % 4, '\0');
  Json& json = gltf.json["bufferViews"][view];
  json["extensions"][name] = {
      {"buffer", 0},   {"byteOffset", gltf.binary.size()}, {"byteLength", compressed.size()}, {"byteStride", stride}, {"mode", mode},
      {"count", count}};
  if (filter != "NONE") json["extensions"][name]["filter"] = filter;
  json["buffer"] = 1;
  json["byteOffset"] = 0;
  json["byteLength"] = count * stride;
  gltf.binary += compressed;
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {name};
}

std::string encodedVertices(const void* data, size_t count, size_t stride) {
  std::string bytes(meshopt_encodeVertexBufferBound(count, stride), '\0');
  bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), data, count, stride));
  return bytes;
}

std::string encodedIndices(const std::vector<uint32_t>& indices, bool as_triangles) {
  const size_t bound =
      as_triangles ? meshopt_encodeIndexBufferBound(indices.size(), 1000) : meshopt_encodeIndexSequenceBound(indices.size(), 1000);
  std::string bytes(bound, '\0');
  auto* out = reinterpret_cast<unsigned char*>(bytes.data());
  bytes.resize(as_triangles ? meshopt_encodeIndexBuffer(out, bound, indices.data(), indices.size())
                            : meshopt_encodeIndexSequence(out, bound, indices.data(), indices.size()));
  return bytes;
}

std::string meshoptGlb(GltfBuilder gltf) {
  gltf.json["buffers"] =
      Json::array({{{"byteLength", gltf.binary.size()}}, {{"byteLength", 1000000}, {"extensions", {{kMeshopt, {{"fallback", true}}}}}}});
  return joinGlb("test", gltf.json.dump(), gltf.binary);
}

// Positions by the vertex codec, triangles by one of the index codecs.
GltfBuilder meshoptLump(bool as_triangles, const std::string& name = kMeshopt) {
  const Lump l = lump();
  GltfBuilder gltf = plainLump();
  gltf.binary.clear();  // only compressed bytes are left
  compressView(gltf, 0, encodedVertices(l.positions.data(), l.positions.size(), 12), l.positions.size(), 12, "ATTRIBUTES", "NONE", name);
  compressView(gltf, 1, encodedIndices(l.indices, as_triangles), l.indices.size(), 4, as_triangles ? "TRIANGLES" : "INDICES", "NONE", name);
  return gltf;
}

void expectPlain(const Trip& trip) {
  EXPECT_FALSE(trip.json.contains("extensionsUsed")) << trip.json["extensionsUsed"];
  EXPECT_FALSE(trip.json.contains("extensionsRequired"));
  const std::string text = trip.json.dump();
  for (const char* name : {"meshopt", "draco", "instancing", "fallback"}) EXPECT_EQ(text.find(name), std::string::npos) << name;
  EXPECT_EQ(trip.json["buffers"].size(), 1U);
}

// --- Draco ---

constexpr const char* kDraco = "KHR_draco_mesh_compression";

std::string dracoBytes(const Lump& l, bool edgebreaker, int position_bits) {
  draco::Mesh mesh;
  mesh.set_num_points(uint32_t(l.positions.size()));
  draco::GeometryAttribute type;
  type.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int id = mesh.AddAttribute(type, true, uint32_t(l.positions.size()));
  for (uint32_t v = 0; v < l.positions.size(); ++v) mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), &l.positions[v]);
  for (size_t i = 0; i < l.indices.size(); i += 3)
    mesh.AddFace({draco::PointIndex(l.indices[i]), draco::PointIndex(l.indices[i + 1]), draco::PointIndex(l.indices[i + 2])});
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  if (position_bits > 0) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, position_bits);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

GltfBuilder dracoLump(bool edgebreaker, int position_bits) {
  GltfBuilder gltf = plainLump();
  const std::string bytes = dracoBytes(lump(), edgebreaker, position_bits);
  gltf.binary = bytes;
  gltf.json["bufferViews"] = Json::array({{{"buffer", 0}, {"byteLength", bytes.size()}}});
  for (Json& accessor : gltf.json["accessors"]) accessor.erase("bufferView");
  Json& primitive = gltf.json["meshes"][0]["primitives"][0];
  primitive["extensions"] = {{kDraco, {{"bufferView", 0}, {"attributes", {{"POSITION", 0}}}}}};
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {kDraco};
  return gltf;
}

void refuse(const TestFolder& folder, const std::string& glb, const std::string& text, const ReadSettings& settings = {}) {
  Warnings warnings;
  expectError<InputError>([&] { readMesh(folder.write("a.glb", glb), settings, warnings); }, text);
}

}  // namespace

TEST(Unpack, MeshoptGivesThePlainMesh) {
  const TestFolder folder;
  const Trip plain = roundTrip(folder, "plain.glb", plainLump().glb());
  for (const bool as_triangles : {true, false})
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      const Trip trip =
          roundTrip(folder, std::string(name) + (as_triangles ? "_t.glb" : "_i.glb"), meshoptGlb(meshoptLump(as_triangles, name)));
      expectSameLobes(trip);
      expectPlain(trip);
      EXPECT_EQ(trip.baked.surface.positions, plain.baked.surface.positions);
      if (!as_triangles) {
        EXPECT_EQ(trip.baked.surface.triangles, plain.baked.surface.triangles);
      }
      EXPECT_FLOAT_EQ(float(signedVolume(trip.baked.surface.positions, trip.baked.surface.triangles)),
                      float(signedVolume(plain.baked.surface.positions, plain.baked.surface.triangles)));
      EXPECT_NE(trip.sculpt.frame_note.find(std::string("; ") + name + " unpacked"), std::string::npos) << trip.sculpt.frame_note;
      EXPECT_TRUE(trip.warnings.empty());
    }
}

// The three filters, each against what it stands for.
TEST(Unpack, MeshoptUndoesItsFilters) {
  const TestFolder folder;
  const Lump l = lump();
  GltfBuilder gltf = meshoptLump(true);
  std::vector<float> normals, rotations;
  for (size_t v = 0; v < l.positions.size(); ++v) {
    const Vec3 n = *normalized(Vec3{std::sin(float(v)), std::cos(float(v)), 0.5F});
    normals.insert(normals.end(), {n.x, n.y, n.z, 0});
  }
  std::vector<int16_t> octahedral(4 * l.positions.size());
  meshopt_encodeFilterOct(octahedral.data(), l.positions.size(), 8, 16, normals.data());
  std::vector<uint32_t> exponential(3 * l.positions.size());
  meshopt_encodeFilterExp(exponential.data(), l.positions.size(), 12, 20, &l.positions[0].x);
  const auto add = [&](const std::string& bytes, size_t stride, const char* filter) {
    gltf.json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 0}, {"byteStride", stride}, {"target", 34962}});
    compressView(gltf, gltf.json["bufferViews"].size() - 1, bytes, l.positions.size(), stride, "ATTRIBUTES", filter);
    return gltf.json["bufferViews"].size() - 1;
  };
  const size_t exp_view = add(encodedVertices(exponential.data(), l.positions.size(), 12), 12, "EXPONENTIAL"),
               oct_view = add(encodedVertices(octahedral.data(), l.positions.size(), 8), 8, "OCTAHEDRAL");
  gltf.json["accessors"][0]["bufferView"] = exp_view;
  gltf.json["accessors"].push_back(
      {{"bufferView", oct_view}, {"componentType", 5122}, {"normalized", true}, {"count", l.positions.size()}, {"type", "VEC3"}});
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {kMeshopt, "KHR_mesh_quantization"};
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.glb", meshoptGlb(gltf)), {}, warnings);
  for (size_t v = 0; v < l.positions.size(); ++v) {
    EXPECT_LT(length(sculpt.parts[0].positions[v] - l.positions[v]), 1e-5F);
    EXPECT_LT(angleDegrees(sculpt.parts[0].normals[v], {normals[4 * v], normals[4 * v + 1], normals[4 * v + 2]}), 0.01);
  }
}

TEST(Unpack, DracoGivesThePlainMesh) {
  const TestFolder folder;
  const Trip plain = roundTrip(folder, "plain.glb", plainLump().glb());
  const auto volumeOf = [](const Trip& trip) { return signedVolume(trip.baked.surface.positions, trip.baked.surface.triangles); };
  for (const bool edgebreaker : {false, true})
    for (const int bits : {0, 16}) {
      const std::string name = std::string(edgebreaker ? "edgebreaker" : "sequential") + std::to_string(bits) + ".glb";
      SCOPED_TRACE(name);
      const Trip trip = roundTrip(folder, name, dracoLump(edgebreaker, bits).glb());
      expectSameLobes(trip);
      expectPlain(trip);
      ASSERT_EQ(trip.baked.surface.positions.size(), plain.baked.surface.positions.size());
      EXPECT_EQ(trip.baked.surface.triangles.size(), plain.baked.surface.triangles.size());
      EXPECT_NEAR(volumeOf(trip), volumeOf(plain), bits == 0 ? 1e-6 : 1e-3);
      if (!edgebreaker && bits == 0) {  // the same order, not a bit lost
        EXPECT_EQ(trip.baked.surface.positions, plain.baked.surface.positions);
        EXPECT_EQ(trip.baked.surface.triangles, plain.baked.surface.triangles);
      }
      EXPECT_NE(trip.sculpt.frame_note.find("KHR_draco_mesh_compression unpacked"), std::string::npos);
    }
}

TEST(Unpack, APlainPrimitiveBesideADracoOne) {
  const TestFolder folder;
  GltfBuilder gltf = dracoLump(false, 0);
  const int points = gltf.accessor(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 5126, "VEC3", 4);
  const int corners = gltf.accessor(std::vector<uint16_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, 5123, "SCALAR", 12, 34963);
  gltf.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", points}}}, {"indices", corners}});
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.glb", gltf.glb()), {}, warnings);
  ASSERT_EQ(sculpt.parts.size(), 2U);
  EXPECT_EQ(sculpt.parts[0].positions, lump().positions);
  EXPECT_EQ(sculpt.parts[1].positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
}

// Every instance becomes a node below the one that had them, with lobes of its own.
TEST(Unpack, InstancesBecomeNodes) {
  const TestFolder folder;
  GltfBuilder gltf = oneTetrahedron();
  const int moves = gltf.accessor(std::vector<Vec3>{{0, 0, 0}, {5, 0, 0}, {0, 5, 0}}, 5126, "VEC3", 3, 0);
  const int turns = gltf.accessor(std::vector<int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0, 0, 0, 0, 32767}, 5122, "VEC4", 3, 0);
  gltf.json["accessors"].back()["normalized"] = true;
  const int sizes = gltf.accessor(std::vector<Vec3>{{1, 1, 1}, {1, 1, 1}, {2, 2, 3}}, 5126, "VEC3", 3, 0);
  const int ids = gltf.accessor(std::vector<float>{1, 2, 3}, 5126, "SCALAR", 3, 0);
  gltf.json["nodes"][0].update({{"name", "puff"}, {"scale", {2, 2, 2}}});
  gltf.json["nodes"][0]["extensions"] = {
      {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}, {"ROTATION", turns}, {"SCALE", sizes}, {"_ID", ids}}}}}};
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);
  expectPlain(trip);
  ASSERT_EQ(trip.sculpt.parts.size(), 3U);
  EXPECT_EQ(trip.baked.surface.positions[1], (Vec3{2, 0, 0}));
  EXPECT_LT(length(trip.baked.surface.positions[5] - Vec3{8, 0, 0}), 1e-5F);  // half a turn about z
  EXPECT_EQ(trip.baked.surface.positions[9], (Vec3{4, 10, 0}));
  EXPECT_EQ(trip.json["nodes"].size(), 4U);
  EXPECT_FALSE(trip.json["nodes"][0].contains("mesh"));
  EXPECT_EQ(trip.json["nodes"][0]["children"], Json({1, 2, 3}));
  EXPECT_EQ(trip.json["nodes"][3]["name"], "puff 2");
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kPartIgnored), 1U);  // _ID
  EXPECT_NE(trip.sculpt.frame_note.find("3 instances became nodes"), std::string::npos);
}

TEST(Unpack, RefusesDamagedMeshopt) {
  const TestFolder folder;
  const auto damage = [&](const std::function<void(Json&)>& change, const std::string& text) {
    GltfBuilder gltf = meshoptLump(true);
    change(gltf.json["bufferViews"][0]["extensions"][kMeshopt]);
    refuse(folder, meshoptGlb(gltf), text);
  };
  damage([](Json& view) { view["count"] = 4000000000U; }, "declares 4000000000 elements of 12 bytes");
  damage([](Json& view) { view["count"] = uint64_t(1) << 62; }, "declares 4611686018427387904 elements");
  damage([](Json& view) { view["count"] = -1; }, "EXT_meshopt_compression.count is -1, not a whole number");
  damage([](Json& view) { view["byteStride"] = 0; }, "elements of 0 bytes");
  damage([](Json& view) { view["byteStride"] = 260; }, "elements of 260 bytes");
  damage([](Json& view) { view["byteLength"] = view["byteLength"].get<size_t>() - 5; }, "are damaged");
  damage([](Json& view) { view["byteOffset"] = uint64_t(1) << 62; }, "ends beyond its buffer");
  damage([](Json& view) { view["buffer"] = 5; }, "buffer 5 of 2");
  damage([](Json& view) { view["mode"] = "POINTS"; }, "no mode 'POINTS'");
  damage([](Json& view) { view["mode"] = 3; }, "EXT_meshopt_compression.mode is 3, not a text");
  damage([](Json& view) { view["filter"] = "COLOR"; }, "the filter 'COLOR' is unknown or does not fit");
  damage([](Json& view) { view["filter"] = "OCTAHEDRAL"; }, "the filter 'OCTAHEDRAL'");
  damage([](Json& view) { view = 1; }, "EXT_meshopt_compression is 1, not an object");
  GltfBuilder newer = meshoptLump(true);
  newer.binary[newer.json["bufferViews"][0]["extensions"][kMeshopt]["byteOffset"].get<size_t>()] = '\xA1';
  refuse(folder, meshoptGlb(newer), "uses version 1 of the vertex codec");
  ReadSettings small;
  small.memory_limit = 5000;
  refuse(folder, meshoptGlb(meshoptLump(true)), "of memory, over the limit of 5 kB (--memory): use fewer vertices", small);
}

TEST(Unpack, RefusesDamagedDraco) {
  const TestFolder folder;
  const auto damage = [&](const std::function<void(GltfBuilder&)>& change, const std::string& text, const ReadSettings& settings = {}) {
    GltfBuilder gltf = dracoLump(false, 0);
    change(gltf);
    refuse(folder, gltf.glb(), text, settings);
  };
  const auto extension = [](GltfBuilder& g) -> Json& { return g.json["meshes"][0]["primitives"][0]["extensions"][kDraco]; };
  damage([](GltfBuilder& g) { g.binary[0] = 'X'; }, "its Draco header is damaged");
  damage([](GltfBuilder& g) { g.binary[5] = 1; }, "bitstream 1.2");
  damage([](GltfBuilder& g) { g.binary[7] = 0; }, "is not a mesh of Draco");
  damage([](GltfBuilder& g) { g.binary.replace(11, 5, "\xFF\xFF\xFF\xFF\x0F"); }, "declares");
  damage([](GltfBuilder& g) { g.json["bufferViews"][0]["byteLength"] = 500; }, "its Draco data is damaged");
  damage([&](GltfBuilder& g) { extension(g)["bufferView"] = 7; }, "buffer view that does not exist");
  damage([&](GltfBuilder& g) { extension(g)["attributes"]["POSITION"] = 9; }, "no attribute 9 for POSITION");
  damage([&](GltfBuilder& g) { extension(g)["attributes"]["NORMAL"] = 0; }, "has no attribute NORMAL");
  damage([&](GltfBuilder& g) { extension(g) = Json::object(); }, "lacks a buffer view or attributes");
  damage([](GltfBuilder& g) { g.json["accessors"][0]["type"] = "MAT4"; }, "unknown type");
  ReadSettings small;
  small.memory_limit = 50000;
  damage([](GltfBuilder&) {}, "of memory, over the limit of 50 kB (--memory): use fewer vertices", small);
}

TEST(Unpack, RefusesDamagedInstances) {
  const TestFolder folder;
  const auto damage = [&](const Json& attributes, const std::string& text) {
    GltfBuilder gltf = oneTetrahedron();
    gltf.accessor(std::vector<float>(12, 1), 5126, "VEC3", 4, 0);
    gltf.accessor(std::vector<float>(20, 1), 5126, "VEC4", 5, 0);
    gltf.json["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}};
    refuse(folder, gltf.glb(), text);
  };
  damage({{"TRANSLATION", 2}, {"ROTATION", 3}}, "different lengths");
  damage({{"TRANSLATION", 30}}, "does not exist");
  damage({{"ROTATION", 2}}, "wrong type");
  damage({{"TRANSLATION", 1.5}}, "attributes.TRANSLATION is 1.5, not a whole number");
  damage(Json::object(), "have no attributes");
}

// A megabyte can ask for a terabyte: instances and nodes are counted before anything is copied.
TEST(Unpack, ManyDrawingsOfAMeshAreRefusedBeforeTheyAreMade) {
  const TestFolder folder;
  GltfBuilder gltf = plainLump();
  gltf.json["scenes"][0]["nodes"] = Json::array();
  gltf.json["nodes"] = Json::array();
  for (int i = 0; i < 2000; ++i) {
    gltf.json["nodes"].push_back({{"mesh", 0}, {"translation", {4 * i, 0, 0}}});
    gltf.json["scenes"][0]["nodes"].push_back(i);
  }
  ReadSettings settings;
  settings.memory_limit = 64 << 20;
  refuse(folder, gltf.glb(), "the 576000 vertices that its 2000 nodes with meshes draw would take about", settings);
  GltfBuilder instanced = plainLump();
  const int moves = instanced.accessor(std::vector<Vec3>(200000), 5126, "VEC3", 200000, 0);
  instanced.json["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}};
  refuse(folder, instanced.glb(), "the 57600000 vertices that its 200000 nodes with meshes draw would take about");
}
