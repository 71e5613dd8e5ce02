// Values of wrong types anywhere in a glTF.
#include "io/gltf/value_types.h"

#include <algorithm>

#include "io/gltf/keep_alive.h"
#include "io/gltf/sculpt/reduce_sculpt.h"
#include "tests/io/gltf/gltf_helpers.h"

namespace cloudbake {
namespace {

// Something of everything that glTF 2.0 has. Whole numbers are counts, all others have a point.
GltfBuilder everything() {
  GltfBuilder gltf;
  Json& json = gltf.json;
  json = {{"asset", {{"version", "2.0"}, {"minVersion", "2.0"}, {"generator", "hand"}, {"copyright", "c"}, {"extras", {{"a", 1}}}}},
          {"extensionsUsed", {"KHR_materials_unlit", "KHR_texture_transform", "EXT_mesh_gpu_instancing", "EXT_new"}},
          {"extensionsRequired", {"KHR_texture_transform"}},
          {"extensions", {{"EXT_new", {{"list", {1, "text"}}}}}},
          {"extras", {{"own", 1}}},
          {"scene", 0},
          {"scenes", {{{"name", "s"}, {"nodes", {0, 3, 4, 5, 6}}}}},
          {"meshes", Json::array()},
          {"accessors", Json::array()},
          {"bufferViews", Json::array()}};
  Json whole = gltf.tetrahedron();
  const int positions = whole["attributes"]["POSITION"], indices = whole["indices"];
  json["bufferViews"][0].update({{"byteStride", 12}, {"name", "v"}});
  json["accessors"][0].update({{"byteOffset", 0}, {"name", "a"}, {"normalized", false}});
  for (const char* bound : {"min", "max"})
    for (Json& number : json["accessors"][0][bound]) number = number.get<double>();
  const int colors = gltf.accessor(std::vector<uint8_t>(16, 255), 5121, "VEC4", 4);
  json["accessors"].back()["normalized"] = true;
  const int joints = gltf.accessor(std::vector<uint8_t>(16, 0), 5121, "VEC4", 4);
  const int weights = gltf.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
  const int bind = gltf.accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 5126, "MAT4", 1, 0);
  const int moves = gltf.accessor(std::vector<float>(12, 0.1F), 5126, "VEC3", 4);
  const int places = gltf.accessor(std::vector<float>{0, 0, 0, 3, 0, 0}, 5126, "VEC3", 2, 0);
  const int times = gltf.accessor(std::vector<float>{0, 1}, 5126, "SCALAR", 2, 0);
  json["accessors"].push_back({{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  const int sparse = int(json["accessors"].size()) - 1;
  json["accessors"].back()["sparse"] = {{"count", 1},
                                        {"indices", {{"bufferView", 1}, {"byteOffset", 0}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", 0}, {"byteOffset", 0}}}};
  whole["attributes"]["COLOR_0"] = colors, whole["attributes"]["TEXCOORD_0"] = gltf.uvs();
  whole.update({{"material", 0}, {"mode", 4}, {"extensions", {{"EXT_new", {{"material", 1}}}}}});
  gltf.mesh({whole});
  json["meshes"][0]["extras"] = {{"targetNames", {"x"}}};
  gltf.mesh({{{"attributes", {{"POSITION", sparse}}}, {"indices", indices}, {"material", 1}}});
  gltf.mesh({{{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}, {"indices", indices}}});
  gltf.mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"targets", {{{"POSITION", moves}}}}}});
  json["meshes"][3]["weights"] = {0.5};
  json["nodes"] = {{{"name", "a"},
                    {"children", {1, 2}},
                    {"translation", {1.0, 0.0, 0.0}},
                    {"rotation", {0.0, 0.0, 0.6, 0.8}},
                    {"scale", {1.0, 2.0, 1.0}},
                    {"extras", {{"k", 1}}}},
                   {{"name", "b"}, {"mesh", 0}},
                   {{"mesh", 1}, {"matrix", {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 1.0}}},
                   {{"mesh", 2}, {"skin", 0}},
                   {{"mesh", 3}, {"weights", {0.5}}},
                   {{"mesh", 1}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}},
                   {{"camera", 0}, {"extensions", {{"EXT_new", {{"light", 0}}}}}}};
  json["cameras"] = {
      {{"name", "c"}, {"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}, {"zfar", 10.5}, {"aspectRatio", 1.5}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1.5}, {"ymag", 1.5}, {"znear", 0.1}, {"zfar", 2.5}}}}};
  json["skins"] = {{{"name", "rig"}, {"joints", {2}}, {"skeleton", 2}, {"inverseBindMatrices", bind}}};
  const Json transform = {{"offset", {0.5, 0.5}}, {"rotation", 0.5}, {"scale", {1.5, 1.5}}, {"texCoord", 0}};
  json["materials"] = {{{"name", "p"},
                        {"pbrMetallicRoughness",
                         {{"baseColorFactor", {1.0, 1.0, 1.0, 1.0}},
                          {"baseColorTexture", {{"index", 0}, {"texCoord", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}},
                          {"metallicFactor", 0.5},
                          {"roughnessFactor", 0.5}}},
                        {"alphaMode", "MASK"},
                        {"alphaCutoff", 0.5},
                        {"doubleSided", true},
                        {"emissiveFactor", {0.5, 0.5, 0.5}}},
                       {{"name", "q"},
                        {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
                        {"pbrMetallicRoughness", {{"metallicRoughnessTexture", {{"index", 0}}}}},
                        {"extensions", {{"KHR_materials_unlit", Json::object()}}}}};
  json["textures"] = {{{"name", "t"}, {"source", 0}, {"sampler", 0}}};
  json["samplers"] = {{{"name", "s"}, {"magFilter", 9729}, {"minFilter", 9729}, {"wrapS", 10497}, {"wrapT", 10497}}};
  json["images"] = {{{"name", "i"}, {"uri", "data:image/png;base64,iVBORw0KGgo="}, {"mimeType", "image/png"}}};
  json["animations"] = {{{"name", "w"},
                         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
                         {"samplers", {{{"input", times}, {"output", places}, {"interpolation", "LINEAR"}}}}}};
  return gltf;
}

// A value of the document by the keys and places on the way to it.
struct Visited {
  std::vector<std::string> path;
  Json::json_pointer pointer{};
  std::string text;  // as messages have it
};

void visitAll(const Json& value, const Visited& here, std::vector<Visited>& all) {
  if (!here.path.empty()) all.push_back(here);
  if (!value.is_structured()) return;
  for (const auto& [key, inner] : value.items()) {
    Visited next = here;
    next.path.push_back(key);
    if (value.is_array())
      next.pointer /= std::stoul(key), next.text += "[" + key + "]";
    else
      next.pointer /= key, next.text += (here.text.empty() ? "" : ".") + key;
    visitAll(inner, next, all);
    if (value.is_array() && inner.is_number()) break;  // the others are like the first
  }
}

// Whether glTF leaves the type of a value to whoever wrote it: below extras, and inside extensions that are not read.
bool isFree(const std::vector<std::string>& path) {
  if (std::find(path.begin(), path.end(), "extras") != path.end()) return true;
  const auto extensions = std::find(path.begin(), path.end(), "extensions");
  const bool is_inside = extensions != path.end() && path.end() - extensions > 2;
  return is_inside && extensions[1] != "KHR_texture_transform" && extensions[1] != "EXT_mesh_gpu_instancing";
}

// Values of other types, and numbers that are no counts.
std::vector<Json> othersThan(const Json& value) {
  std::vector<Json> others;
  for (const Json& other : {Json(), Json(true), Json("text"), Json::array({5}), Json{{"a", 1}}})
    if (other.type() != value.type()) others.push_back(other);
  if (!value.is_number()) others.emplace_back(5);
  if (value.is_number_integer()) others.insert(others.end(), {Json(-1), Json(1.5), Json(1e39)});
  return others;
}

// Reads a document in every way that a command does.
void readEveryWay(const std::filesystem::path& file, const Json& json, const std::string& binary) {
  Warnings warnings;
  const std::string bytes = joinGlb(file, json.dump(), binary);
  const Sculpt sculpt = readMesh(file, bytes, {}, warnings);
  GltfSettings settings;
  settings.keep_alive_texture = KeepAliveTexture::kForce;
  const std::string glb = encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), settings, warnings);
  decodeGlb(file, glb, warnings);
  readStoredAsset(file, bytes, warnings);
  firstAlike(sculpt);
  std::vector<std::vector<Triangle>> triangles;
  for (size_t i = 0; i < sculpt.parts.size(); ++i)
    triangles.push_back(isDeformed(sculpt, i) ? std::vector<Triangle>{} : sculpt.parts[i].triangles);
  withTriangles(sculpt, triangles);
}

TEST(ValueTypes, AWrongOneAnywhereIsRefusedWithItsPlace) {
  GltfBuilder gltf = everything();
  gltf.glb();
  readEveryWay("a.glb", gltf.json, gltf.binary);
  std::vector<Visited> all;
  visitAll(gltf.json, Visited(), all);
  size_t refused = 0, free = 0;
  for (const Visited& one : all)
    for (const Json& other : othersThan(gltf.json[one.pointer])) {
      Json damaged = gltf.json;
      damaged[one.pointer] = other;
      const std::string what = one.text + " = " + other.dump();
      try {
        readEveryWay("a.glb", damaged, gltf.binary);
        EXPECT_TRUE(isFree(one.path)) << what;
        ++free;
      } catch (const InputError& error) {
        EXPECT_NE(error.message.find(one.text + " is "), std::string::npos) << what << ": " << error.message;
        EXPECT_EQ(error.file, "a.glb") << what;
        ++refused;
      } catch (const std::exception& error) {
        ADD_FAILURE() << what << ": " << error.what();
      }
    }
  EXPECT_GT(refused, 1000U);
  EXPECT_GT(free, 50U);
}

TEST(ValueTypes, WhatReadersNeedIsNamedIfItIsMissing) {
  const GltfBuilder gltf = everything();
  for (const auto& [pointer, text] : std::initializer_list<std::pair<const char*, const char*>>{
           {"/asset", "the glTF has no asset"},
           {"/asset/version", "asset has no version"},
           {"/meshes/0/primitives", "meshes[0] has no primitives"},
           {"/meshes/1/primitives/0/attributes", "meshes[1].primitives[0] has no attributes"},
           {"/accessors/2/componentType", "accessors[2] has no componentType"},
           {"/accessors/2/count", "accessors[2] has no count"},
           {"/bufferViews/1/buffer", "bufferViews[1] has no buffer"},
           {"/skins/0/joints", "skins[0] has no joints"}}) {
    Json damaged = gltf.json;
    const Json::json_pointer at(pointer);
    damaged[at.parent_pointer()].erase(at.back());
    expectError<InputError>([&] { checkValueTypes("a.glb", damaged); }, text);
  }
  Json short_matrix = gltf.json;
  short_matrix["nodes"][2]["matrix"].erase(3);
  expectError<InputError>([&] { checkValueTypes("a.glb", short_matrix); }, "nodes[2].matrix is a list of 15, not a list of 16 numbers");
}

TEST(ValueTypes, ALargeIndexIsNotTakenForASmallOne) {
  Json json = everything().json;
  json["accessors"][0]["bufferView"] = uint64_t(1) << 32;
  expectError<InputError>([&] { checkValueTypes("a.glb", json); }, "accessors[0].bufferView is 4294967296, not a whole number from 0 to");
}

// What an artist keeps in extras is no texture.
TEST(ValueTypes, ExtrasAreNotLookedAt) {
  GltfBuilder gltf = everything();
  gltf.json["materials"][0]["extras"] = {{"index", "none"}, {"texCoord", "text"}, {"TEXCOORD_7", {{"index", 3}, {"texCoord", 1.5}}}};
  gltf.glb();
  readEveryWay("a.glb", gltf.json, gltf.binary);
}

}  // namespace
}  // namespace cloudbake
