#include "io/gltf/asset/pack.h"

#include <algorithm>
#include <set>

#include "core/certificate.h"
#include "core/seal.h"
#include "tests/io/gltf/gltf_helpers.h"

using namespace cloudbake;

namespace {

GltfSettings packedAs(PackForm form) {
  GltfSettings settings;
  settings.pack = true;
  settings.pack_form = form;
  return settings;
}

// A lattice of n × n vertices, bent so that it is no plane, with normals: as so many primitives that share the vertices. With a distance,
// there is a second one so far above it.
std::string bentSheet(int n, Vec3 origin, size_t pieces = 1, float second = 0) {
  GltfBuilder gltf;
  std::vector<Vec3> positions, normals;
  std::vector<uint16_t> indices;
  for (int i = 0; i < n * n; ++i) {
    const int row = i / n;
    const float x = float(i % n) / float(n), y = float(row) / float(n);
    positions.push_back(origin + Vec3{x, y, 0.2F * x * y});
    normals.push_back(*normalized({-0.2F * y, -0.2F * x, 1}));
  }
  for (int row = 0; row + 1 < n; ++row)
    for (int column = 0; column + 1 < n; ++column) {
      const auto v = uint16_t(row * n + column), up = uint16_t(v + n);
      for (const uint16_t corner : {v, uint16_t(v + 1), up, uint16_t(v + 1), uint16_t(up + 1), up}) indices.push_back(corner);
    }
  if (second > 0) {
    const size_t vertices = positions.size(), corners = indices.size();
    for (size_t v = 0; v < vertices; ++v) positions.push_back(positions[v] + Vec3{0, 0, second}), normals.push_back(normals[v]);
    for (size_t c = 0; c < corners; ++c) indices.push_back(uint16_t(indices[c] + vertices));
  }
  const int position = gltf.accessor(positions, 5126, "VEC3", positions.size());
  gltf.json["accessors"].back()["min"] = {origin.x, origin.y, origin.z};
  gltf.json["accessors"].back()["max"] = {origin.x + 1, origin.y + 1, origin.z + 1};
  const int normal = gltf.accessor(normals, 5126, "VEC3", normals.size());
  Json primitives = Json::array();
  for (size_t piece = 0, triangles = indices.size() / 3; piece < pieces; ++piece) {
    const auto at = [&](size_t end) { return indices.begin() + ptrdiff_t(3 * (end * triangles / pieces)); };
    const std::vector<uint16_t> own(at(piece), at(piece + 1));
    primitives.push_back(
        {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", gltf.accessor(own, 5123, "SCALAR", own.size(), 34963)}});
  }
  gltf.mesh(primitives);
  gltf.node({{"mesh", 0}, {"rotation", {0, 0.6, 0, 0.8}}, {"translation", {3, 2, 1}}, {"scale", {2, 2, 2}}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  return gltf.glb();
}

// The triangles by the places of their corners, so that orders of vertices do not matter.
std::vector<std::array<float, 9>> placesOf(const SurfaceMesh& surface) {
  std::vector<std::array<float, 9>> all;
  for (Triangle t : surface.triangles) {
    const auto less = [&](uint32_t a, uint32_t b) {
      const Vec3 p = surface.positions[a], q = surface.positions[b];
      return std::tuple(p.x, p.y, p.z) < std::tuple(q.x, q.y, q.z);
    };
    std::rotate(t.begin(), std::min_element(t.begin(), t.end(), less), t.end());
    auto& places = all.emplace_back();
    for (size_t c = 0; c < 3; ++c) {
      const Vec3 p = surface.positions[t[c]];
      places[3 * c] = p.x, places[3 * c + 1] = p.y, places[3 * c + 2] = p.z;
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

double areaOf(const SurfaceMesh& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles)
    sum += 0.5 * length(cross(surface.positions[b] - surface.positions[a], surface.positions[c] - surface.positions[a]));
  return sum;
}

void expectNearLobes(const Trip& trip) {
  size_t vertex = 0;
  for (const auto& part : trip.lobes)
    for (const Lobe& lobe : part) {
      EXPECT_LT(angleDegrees(trip.baked.lobes[vertex].direction, lobe.direction), 0.005);
      EXPECT_NEAR(std::sqrt(trip.baked.lobes[vertex].thickness), std::sqrt(lobe.thickness), 1e-4 * std::sqrt(60.0));
      ++vertex;
    }
}

}  // namespace

TEST(Pack, TakesSixteenBytesPerVertex) {
  const TestFolder folder;
  const Trip trip = roundTrip(folder, "packed.glb", bentSheet(40, {100, 0, 0}), packedAs(PackForm::kList));
  expectNearLobes(trip);
  const Json& attributes = trip.json["meshes"][0]["primitives"][0]["attributes"];
  size_t view = 99;
  for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0", "TEXCOORD_1"}) {
    const Json& accessor = trip.json["accessors"][attributes[name].get<size_t>()];
    if (view == 99) view = accessor["bufferView"];
    EXPECT_EQ(accessor["bufferView"], view) << name;
  }
  EXPECT_EQ(trip.json["bufferViews"][view]["byteStride"], 16);
  EXPECT_EQ(trip.json["bufferViews"][view]["byteLength"], 16 * 1600);
  EXPECT_EQ(trip.json["asset"]["extras"]["cloudbake"]["layout"], "lobe-packed");
  EXPECT_EQ(trip.json["extensionsRequired"], Json({"KHR_mesh_quantization"}));
  ASSERT_TRUE(trip.baked.info.certificate);
  EXPECT_LE(double(trip.baked.info.certificate->transmittance), kMostPackedError);
  // Positions move by at most half a step of the grid, here a power of two below 2 / 65532.
  const SurfaceMesh before = surfaceInScene(trip.sculpt);
  for (size_t v = 0; v < before.positions.size(); ++v)
    EXPECT_LT(length(trip.baked.surface.positions[v] - before.positions[v]), 2 * 1.8F / 65532);
}

TEST(Pack, HasTheSameTrianglesInEveryForm) {
  const TestFolder folder;
  const std::string bytes = bentSheet(40, {});
  const Trip list = roundTrip(folder, "list.glb", bytes, packedAs(PackForm::kList)),
             strip = roundTrip(folder, "strip.glb", bytes, packedAs(PackForm::kStrip)),
             meshopt = roundTrip(folder, "meshopt.glb", bytes, packedAs(PackForm::kMeshopt), false);
  EXPECT_EQ(placesOf(list.baked.surface), placesOf(strip.baked.surface));
  EXPECT_EQ(list.baked.surface.triangles.size(), meshopt.baked.surface.triangles.size());
  EXPECT_EQ(strip.json["meshes"][0]["primitives"][0]["mode"], 5);
  EXPECT_LT(strip.glb.size(), list.glb.size());
  EXPECT_LT(meshopt.glb.size(), strip.glb.size());
  EXPECT_EQ(meshopt.json["extensionsRequired"], Json({"KHR_mesh_quantization", "EXT_meshopt_compression"}));
}

// The codec wants vertices in another order. Those that several primitives share keep theirs, or the triangles of some would be torn.
TEST(Pack, KeepsTheTrianglesOfPrimitivesThatShareVertices) {
  const TestFolder folder;
  for (const PackForm form : {PackForm::kList, PackForm::kStrip, PackForm::kMeshopt})
    for (const size_t pieces : {size_t(1), size_t(2), size_t(5)}) {
      const Trip trip = roundTrip(folder, "pieces.glb", bentSheet(20, {}, pieces), packedAs(form), false);
      EXPECT_NEAR(areaOf(trip.baked.surface), areaOf(surfaceInScene(trip.sculpt)), 0.01) << int(form) << ", " << pieces << " pieces";
    }
}

// Sheets that are nearer to each other than a step of the grid stay apart, by a step, and what was one place stays one.
TEST(Pack, KeepsSheetsApart) {
  const TestFolder folder;
  for (const PackForm form : {PackForm::kList, PackForm::kMeshopt}) {
    const Trip trip = roundTrip(folder, "sheets.glb", bentSheet(20, {}, 2, 2e-7F), packedAs(form), false);
    const SurfaceMesh before = surfaceInScene(trip.sculpt);
    std::set<std::array<float, 3>> distinct, kept;
    for (const Vec3& p : before.positions) distinct.insert({p.x, p.y, p.z});
    for (const Vec3& p : trip.baked.surface.positions) kept.insert({p.x, p.y, p.z});
    EXPECT_GT(distinct.size(), 700U);  // floats do not tell all of them apart
    EXPECT_EQ(kept.size(), distinct.size()) << int(form);
  }
}

// Whoever reads the file can tell a change: the seal is made of what is stored.
TEST(Pack, SealsWhatIsStored) {
  const TestFolder folder;
  for (const PackForm form : {PackForm::kList, PackForm::kStrip, PackForm::kMeshopt}) {
    const Trip trip = roundTrip(folder, "sealed.glb", bentSheet(20, {}), packedAs(form), false);
    Warnings none;
    const StoredAsset stored = readStoredAsset("a.glb", trip.glb, none);
    SealMaker maker;
    std::vector<LobeUvs> uvs;
    const auto &first = stored.sets[0].at(0), &second = stored.sets[0].at(1);
    for (size_t v = 0; v < first.values.size(); ++v)
      uvs.push_back(dequantisedLobe({first.values[v], second.values[v]}, stored.info->density_max));
    maker.add(stored.sculpt.parts[0], uvs);
    const SealDifference difference = differenceOf(*stored.info->seal, maker.finished(*stored.info));
    EXPECT_FALSE(difference.mesh || difference.constants || difference.isReshaped());
    EXPECT_EQ(difference.lobes, 0);
  }
}

// What was packed can be baked and packed again, and then nothing changes.
TEST(Pack, OfAPackedAssetIsTheSame) {
  const TestFolder folder;
  const Trip once = roundTrip(folder, "once.glb", bentSheet(20, {7, 8, 9}), packedAs(PackForm::kList), false);
  Warnings warnings;
  const Sculpt again = readMesh(folder.write("again.glb", once.glb), {}, warnings);
  const std::string twice = encodeGlb(again, once.lobes, sampleInfo(), packedAs(PackForm::kList), warnings);
  const BakedMesh baked = decodeGlb("twice.glb", twice, warnings);
  for (size_t v = 0; v < baked.surface.positions.size(); ++v) EXPECT_EQ(baked.surface.positions[v], once.baked.surface.positions[v]);
  const std::string plain = encodeGlb(again, once.lobes, sampleInfo(), {}, warnings);
  EXPECT_EQ(decodeGlb("plain.glb", plain, warnings).info.density_max, 0);
}

// A node that others depend on keeps its transform, and the mesh goes below it.
TEST(Pack, LeavesNodesWithChildrenAlone) {
  const TestFolder folder;
  GltfBuilder gltf;
  gltf.mesh({gltf.tetrahedron({5, 0, 0})});
  gltf.mesh({gltf.tetrahedron()});
  gltf.node({{"mesh", 0}, {"children", {1}}, {"scale", {1, 2, -3}}});
  gltf.node({{"mesh", 1}, {"matrix", {0.5, 0, 0, 0, 0, 0, 2, 0, 0, -1, 0, 0, 7, 8, 9, 1}}});
  gltf.node({{"mesh", 1}, {"translation", {0, 0, 9}}});
  gltf.json["scenes"].push_back({{"nodes", {0, 2}}});
  const Trip trip = roundTrip(folder, "nodes.glb", gltf.glb(), packedAs(PackForm::kList));
  expectNearLobes(trip);
  EXPECT_EQ(trip.json["nodes"][0]["scale"], Json({1, 2, -3}));
  EXPECT_FALSE(trip.json["nodes"][0].contains("mesh"));
  EXPECT_EQ(trip.json["nodes"][0]["children"], Json({3, 1}));
  const SurfaceMesh before = surfaceInScene(trip.sculpt);
  ASSERT_EQ(trip.baked.surface.positions.size(), before.positions.size());
  for (size_t v = 0; v < before.positions.size(); ++v) EXPECT_LT(length(trip.baked.surface.positions[v] - before.positions[v]), 0.001F);
}

TEST(Pack, KeepsPositionsThatMorphTargetsMove) {
  const TestFolder folder;
  GltfBuilder gltf;
  Json primitive = gltf.tetrahedron();
  const int moved = gltf.accessor(std::vector<Vec3>(4, {0, 1, 0}), 5126, "VEC3", 4);
  gltf.json["accessors"].back()["min"] = {0, 1, 0}, gltf.json["accessors"].back()["max"] = {0, 1, 0};
  primitive["targets"] = Json::array({{{"POSITION", moved}}});
  gltf.mesh({primitive});
  gltf.node({{"mesh", 0}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  const Trip trip = roundTrip(folder, "morph.glb", gltf.glb(), packedAs(PackForm::kList));
  expectNearLobes(trip);
  EXPECT_EQ(trip.warnings.entries().at(WarningKind::kPartNotPacked).count, 1U);
  const Json& attributes = trip.json["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(trip.json["accessors"][attributes["POSITION"].get<size_t>()]["componentType"], 5126);
  EXPECT_EQ(trip.json["accessors"][attributes["TEXCOORD_0"].get<size_t>()]["componentType"], 5122);
}

TEST(Pack, RefusesWhatChangesTooMuch) {
  const TestFolder folder;
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("thick.glb", bentSheet(20, {})), {}, warnings);
  auto lobes = fakeLobes(sculpt);
  lobes[0][3].thickness = 1e12F;
  try {
    encodeGlb(sculpt, lobes, sampleInfo(), packedAs(PackForm::kList), warnings);
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    EXPECT_NE(error.message.find("more than 1/255"), std::string::npos) << error.message;
  }
}
