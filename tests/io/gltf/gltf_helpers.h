// glTF documents put together by hand, and the round trip that every asset of the tests goes through.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/write.h"
#include "io/gltf/document.h"
#include "io/gltf/gltf_settings.h"
#include "io/sculpt/read_mesh.h"
#include "tests/folders.h"
#include "tests/io/io_helpers.h"
#include "tests/warnings.h"

namespace cloudbake {

// A glTF document and its buffer, put together by hand.
struct GltfBuilder {
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "by hand"}}}, {"scene", 0}, {"scenes", Json::array()}};
  std::string binary;

  GltfBuilder() {
    for (const char* key : {"nodes", "meshes", "accessors", "bufferViews"}) json[key] = Json::array();
  }
  template <typename T>
  int accessor(const std::vector<T>& values, int component, const std::string& type, size_t count, int target = 34962) {
    binary.append((4 - binary.size() % 4) % 4, '\0');
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}});
    if (target != 0) json["bufferViews"].back()["target"] = target;
    binary.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    json["accessors"].push_back(
        {{"bufferView", json["bufferViews"].size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
    return int(json["accessors"].size()) - 1;
  }
  // A tetrahedron with corner 0 at `origin`.
  Json tetrahedron(Vec3 origin = {}) {
    const std::vector<Vec3> positions{origin, origin + Vec3{1, 0, 0}, origin + Vec3{0, 1, 0}, origin + Vec3{0, 0, 1}};
    const int position = accessor(positions, 5126, "VEC3", 4);
    json["accessors"].back()["min"] = {origin.x, origin.y, origin.z};
    json["accessors"].back()["max"] = {origin.x + 1, origin.y + 1, origin.z + 1};
    const int indices = accessor(std::vector<uint16_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, 5123, "SCALAR", 12, 34963);
    return {{"attributes", {{"POSITION", position}}}, {"indices", indices}};
  }
  int uvs(float value = 0.5F) { return accessor(std::vector<Vec2>(4, {value, value}), 5126, "VEC2", 4); }
  int mesh(const std::vector<Json>& primitives) {
    json["meshes"].push_back({{"name", "mesh"}, {"primitives", primitives}});
    return int(json["meshes"].size()) - 1;
  }
  int node(Json value) {
    json["nodes"].push_back(std::move(value));
    return int(json["nodes"].size()) - 1;
  }
  std::string glb() {
    json["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    return joinGlb("test", json.dump(), binary);
  }
};

// A lobe per vertex that no accident reproduces.
inline std::vector<std::vector<Lobe>> fakeLobes(const Sculpt& sculpt, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> density(0.001F, 50.0F);
  std::vector<std::vector<Lobe>> lobes;
  for (const SculptPart& part : sculpt.parts) {
    lobes.emplace_back();
    for (size_t i = 0; i < part.positions.size(); ++i)
      lobes.back().push_back({normalized({normal(random), normal(random), normal(random)}).value_or(Vec3{1, 0, 0}), density(random)});
  }
  return lobes;
}

inline AssetInfo sampleInfo() {
  AssetInfo info;
  info.shape = {3, -0.012F};
  info.extinction = 2.25F;
  info.sampler = "stratified";
  info.quadrature = "crossing";
  info.rays = 100;
  info.steps = 100;
  info.ray_length = 3.5F;
  info.voxel_size = 0.01F;
  info.seed = 1;
  info.input_hash = "99aa06d3014798d86001c324468d497f";
  return info;
}

struct Trip {
  Sculpt sculpt;
  std::vector<std::vector<Lobe>> lobes;
  std::string glb;
  Json json;
  BakedMesh baked;
  Warnings warnings;
};

// Every asset goes through here: read, bake by imagination, encode, keep for the validator, decode. An asset is not kept if the sculpt
// itself is one that the validator complains about.
inline Trip roundTrip(const TestFolder& folder, const std::string& name, const std::string& bytes, const GltfSettings& settings = {},
                      bool is_kept = true) {
  Trip trip;
  trip.sculpt = readMesh(folder.write(name, bytes), {}, trip.warnings);
  trip.lobes = fakeLobes(trip.sculpt);
  trip.glb = encodeGlb(trip.sculpt, trip.lobes, sampleInfo(), settings, trip.warnings);
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  std::filesystem::create_directories(glbFolder());
  writeFileAtomically(glbFolder() / "cloud.png",
                      readFileBytes(sourceFolder() / "tests/data/cloud.png"));  // some assets use it
  std::string kept = std::string(test->name()) + "_" + name + (settings.keep_alive_texture == KeepAliveTexture::kForce ? "_force" : "") +
                     (settings.attribute ? "_attribute" : "") + ".glb";
  if (is_kept) writeFileAtomically(glbFolder() / kept, trip.glb);
  trip.json = Json::parse(splitGlb(name, trip.glb).json);
  Warnings again;
  trip.baked = decodeGlb(name, trip.glb, again);
  return trip;
}

inline void expectSameLobes(const Trip& trip) {
  const SurfaceMesh expected = surfaceInScene(trip.sculpt);
  size_t vertex = 0;
  for (const auto& part : trip.lobes)
    for (const Lobe& lobe : part) {
      ASSERT_LT(vertex, trip.baked.lobes.size());
      EXPECT_LT(angleDegrees(trip.baked.lobes[vertex].direction, lobe.direction), 1e-4);
      EXPECT_NEAR(trip.baked.lobes[vertex].thickness, lobe.thickness, 1e-6 * lobe.thickness);
      EXPECT_LE(length(trip.baked.surface.positions[vertex] - expected.positions[vertex]),
                1e-6F * (1 + length(expected.positions[vertex])));
      ++vertex;
    }
  EXPECT_GT(vertex, 0U);
  EXPECT_EQ(trip.baked.lobes.size(), vertex);
  EXPECT_EQ(trip.baked.surface.positions.size(), vertex);
}

inline const Json& attributesOf(const Json& json, size_t mesh, size_t primitive = 0) {
  return json["meshes"][mesh]["primitives"][primitive]["attributes"];
}

// Raw floats of an accessor, read by the test itself.
inline std::vector<float> floatsOf(const Trip& trip, int accessor, int components) {
  const Json& a = trip.json["accessors"][size_t(accessor)];
  const Json& view = trip.json["bufferViews"][a["bufferView"].get<size_t>()];
  std::vector<float> floats(a["count"].get<size_t>() * size_t(components));
  const size_t offset = view.value("byteOffset", size_t(0)) + a.value("byteOffset", size_t(0));
  std::memcpy(floats.data(), splitGlb("test", trip.glb).binary.data() + offset, floats.size() * 4);
  return floats;
}

inline GltfBuilder oneTetrahedron() {
  GltfBuilder gltf;
  gltf.mesh({gltf.tetrahedron()});
  gltf.node({{"mesh", 0}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  return gltf;
}

}  // namespace cloudbake
