
#include <cstring>
#include <functional>

#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/write.h"
#include "io/gltf/document.h"
#include "io/gltf/gltf_settings.h"
#include "io/gltf/named_files.h"
#include "io/sculpt/read_mesh.h"
#include "tests/folders.h"
#include "tests/io/gltf/gltf_helpers.h"
#include "tests/io/io_helpers.h"

using namespace cloudbake;

TEST(Gltf, RoundTripsForeignFormats) {
  const TestFolder folder;
  const std::string obj_with_uvs =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 3/2/1 2/3/1\nf 1/1 2/2 4/3\nf 1 4 3\nf 2 3 4\n";
  const std::pair<std::string, std::string> files[] = {
      {"a.obj", kTetrahedronObj},
      {"uv.obj", obj_with_uvs},
      {"a.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
       "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"}};
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    const Trip trip = roundTrip(folder, name, bytes);
    expectSameLobes(trip);
    EXPECT_EQ(trip.baked.surface.triangles, surfaceInScene(trip.sculpt).triangles);
    const int set = name == "uv.obj" ? 1 : 0;
    EXPECT_EQ(trip.baked.info.first_uv_set, set);
    const Json& material = trip.json["materials"][0];
    // The sculpt's own UVs are bound as well, or else prune would move ours down.
    const std::string own = set == 1 ? R"(,"metallicRoughnessTexture":{"index":0,"texCoord":0})" : "";
    EXPECT_EQ(
        material["pbrMetallicRoughness"].dump(),
        R"({"metallicFactor":0,"roughnessFactor":1,"baseColorTexture":{"index":0,"texCoord":)" + std::to_string(set) + "}" + own + "}");
    EXPECT_EQ(material["occlusionTexture"].dump(), R"({"index":0,"texCoord":)" + std::to_string(set + 1) + "}");
  }
}

TEST(Gltf, RoundTripsFbxWithItsUnit) {
  const TestFolder folder;
  const std::string bytes = readFileBytes(sourceFolder() / "tests/data/two_quads.fbx");
  const Trip trip = roundTrip(folder, "a.fbx", bytes);
  expectSameLobes(trip);
  ASSERT_EQ(trip.sculpt.parts.size(), 2U);
  Box box;
  for (const Vec3 p : trip.baked.surface.positions) box.add(p);
  EXPECT_LT(length(box.high - Vec3{0.01F, 0.03F, 0}), 1e-6F);  // centimetres, Z up; see the file
}

// The space rule: nested, mirrored and non-uniform transforms, against vectors moved by hand.
TEST(Gltf, StoresLobesInTheSpaceOfTheirMesh) {
  const TestFolder folder;
  GltfBuilder gltf;
  gltf.mesh({gltf.tetrahedron()});
  gltf.mesh({gltf.tetrahedron({5, 0, 0})});
  const double h = std::sqrt(0.5);
  gltf.node({{"scale", {2, 3, -4}}, {"children", {1, 2}}});
  gltf.node({{"mesh", 0}, {"rotation", {0, 0, h, h}}, {"translation", {1, 2, 3}}});
  gltf.node({{"mesh", 1}, {"matrix", {0.5, 0, 0, 0, 0, 0, 2, 0, 0, -1, 0, 0, 7, 8, 9, 1}}, {"children", {3}}});
  gltf.node({{"mesh", 0}, {"rotation", {h, 0, 0, h}}, {"scale", {1, 0.001, 1}}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);
  EXPECT_GT(signedVolume(trip.baked.surface.positions, trip.baked.surface.triangles), 0);

  // Node 1: M = S·R, R turns x to y: M maps (x,y,z) to (−2y, 3x, −4z).
  const Json& attributes = attributesOf(trip.json, trip.json["nodes"][1]["mesh"]);
  const auto first = floatsOf(trip, attributes["TEXCOORD_0"], 2), second = floatsOf(trip, attributes["TEXCOORD_1"], 2);
  for (size_t v = 0; v < 4; ++v) {
    const Vec3 stored = Vec3{first[2 * v], first[2 * v + 1], second[2 * v]} * second[2 * v + 1];
    const Lobe& lobe = trip.lobes[0][v];
    EXPECT_LT(length(Vec3{-2 * stored.y, 3 * stored.x, -4 * stored.z} - lobe.direction * lobe.thickness), 1e-5F * lobe.thickness);
    EXPECT_NEAR(first[2 * v] * first[2 * v] + first[2 * v + 1] * first[2 * v + 1] + second[2 * v] * second[2 * v], 1, 1e-6);
  }
}

TEST(Gltf, GivesEveryNodeOfASharedMeshItsOwnLobes) {
  const TestFolder folder;
  GltfBuilder gltf;
  gltf.mesh({gltf.tetrahedron()});
  for (int i = 0; i < 3; ++i) gltf.node({{"mesh", 0}, {"translation", {3 * i, 0, 0}}});
  gltf.json["scenes"].push_back({{"nodes", {0, 1, 2}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);
  EXPECT_EQ(trip.json["meshes"].size(), 3U);
  EXPECT_EQ(trip.json["nodes"][2]["mesh"], 2);
  EXPECT_EQ(attributesOf(trip.json, 0)["POSITION"], attributesOf(trip.json, 2)["POSITION"]);
  EXPECT_NE(attributesOf(trip.json, 0)["TEXCOORD_0"], attributesOf(trip.json, 2)["TEXCOORD_0"]);
}

TEST(Gltf, LeavesTheSculptsOwnUvsAndFillsGaps) {
  const TestFolder folder;
  GltfBuilder gltf;
  Json with_uv = gltf.tetrahedron(), without = gltf.tetrahedron({3, 0, 0});
  with_uv["attributes"]["TEXCOORD_0"] = gltf.uvs(0.25F);
  gltf.mesh({with_uv, without});
  gltf.node({{"mesh", 0}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);
  EXPECT_EQ(trip.json["asset"]["extras"]["cloudbake"]["uv_sets"].dump(), "[1,2]");
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kMissingUvSet), 1U);
  EXPECT_EQ(floatsOf(trip, attributesOf(trip.json, 0, 0)["TEXCOORD_0"], 2), std::vector<float>(8, 0.25F));
  EXPECT_EQ(floatsOf(trip, attributesOf(trip.json, 0, 1)["TEXCOORD_0"], 2), std::vector<float>(8, 0.0F));
}

TEST(Gltf, ChoosesUvSets) {
  const TestFolder folder;
  GltfBuilder gltf = oneTetrahedron();
  for (const char* set : {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2"})
    gltf.json["meshes"][0]["primitives"][0]["attributes"][set] = gltf.uvs();
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.glb", gltf.glb()), {}, warnings);
  EXPECT_EQ(chooseUvSet(sculpt, {}), 3);
  EXPECT_EQ(chooseUvSet(sculpt, {5, false, KeepAliveTexture::kAuto}), 5);
  expectError<InputError>([&] { chooseUvSet(sculpt, {2, false, KeepAliveTexture::kAuto}); }, "taken or beyond 7");
  expectError<InputError>([&] { chooseUvSet(sculpt, {7, false, KeepAliveTexture::kAuto}); }, "taken or beyond 7");
  for (int set = 3; set < 7; ++set) gltf.json["meshes"][0]["primitives"][0]["attributes"][uvSetName(set)] = gltf.uvs();
  const Sculpt full = readMesh(folder.write("b.glb", gltf.glb()), {}, warnings);
  expectError<InputError>([&] { chooseUvSet(full, {}); }, "no two neighbouring UV sets");
  const Trip trip = roundTrip(folder, "c.obj", kTetrahedronObj, {4, false, KeepAliveTexture::kAuto});
  expectSameLobes(trip);
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kMissingUvSet), 4U);
}

// What lobes were fitted to is recorded and read again.
TEST(Gltf, RecordsTheVolumeOfAFit) {
  const TestFolder folder;
  const Sculpt sculpt = [&] {
    Warnings warnings;
    return readMesh(folder.write("a.obj", kTetrahedronObj), {}, warnings);
  }();
  const auto trip = [&](const std::optional<VolumeLight>& volume) {
    AssetInfo info;
    info.lobe = "fit";
    info.volume = volume;
    const std::vector<std::vector<Lobe>> lobes{std::vector<Lobe>(sculpt.parts[0].positions.size(), Lobe{{0, 1, 0}, 1})};
    Warnings warnings;
    return decodeGlb("a.glb", encodeGlb(sculpt, lobes, info, {}, warnings), warnings).info.volume;
  };
  EXPECT_FALSE(trip({}));
  for (const VolumeLight& volume : {VolumeLight{}, VolumeLight{0.5F, {6}, -0.25F}, VolumeLight{2, {3, 0.75F, 0.125F}, 0}}) {
    const std::optional<VolumeLight> read = trip(volume);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->view_extinction, volume.view_extinction);
    EXPECT_EQ(read->asymmetry, volume.asymmetry);
    EXPECT_EQ(read->octaves.count, volume.octaves.count);
    EXPECT_EQ(read->octaves.extinction, volume.octaves.extinction);
    EXPECT_EQ(read->octaves.contribution, volume.octaves.contribution);
  }
}

TEST(Gltf, WritesOverAnEarlierBake) {
  const TestFolder folder;
  const Trip first = roundTrip(folder, "a.glb", oneTetrahedron().glb()), second = roundTrip(folder, "b.glb", first.glb);
  expectSameLobes(second);
  EXPECT_EQ(second.baked.info.first_uv_set, 0);
  EXPECT_EQ(second.json["materials"], first.json["materials"]);
  EXPECT_EQ(second.json["asset"], first.json["asset"]);
}

// The attributes of the harmonics of an asset are those of its last bake: fewer for a lower order, none for a bake without harmonics.
TEST(Gltf, HarmonicsOfAnEarlierBakeAreErased) {
  const TestFolder folder;
  const auto bakeAgain = [&](const std::string& bytes, int order) {
    Warnings warnings;
    const Sculpt sculpt = readMesh(folder.write("a.glb", bytes), {}, warnings);
    AssetInfo info = sampleInfo();
    info.harmonic_order = order;
    const size_t count = order > 0 ? size_t((order + 1) * (order + 1)) : 0;
    std::vector<float> harmonics;
    for (size_t i = 0; i < 4 * count; ++i) harmonics.push_back(float(order) + float(i) / 256);
    std::string glb = encodeGlb(sculpt, fakeLobes(sculpt), info, {}, warnings, harmonics);
    EXPECT_EQ(decodeGlb("a.glb", glb, warnings).harmonics, harmonics) << order;
    return glb;
  };
  const auto harmonicsIn = [](const std::string& glb) {
    std::string names;
    const Json json = Json::parse(splitGlb("a.glb", glb).json);
    for (const auto& [name, accessor] : attributesOf(json, 0).items())
      if (name.starts_with("_TRANSMITTANCE_SH_")) names += name.substr(18);
    return names;
  };
  // 16, 9 and 4 coefficients, in attributes of four
  const std::string third = bakeAgain(oneTetrahedron().glb(), 3);
  EXPECT_EQ(harmonicsIn(third), "0123");
  const std::string second = bakeAgain(third, 2);
  EXPECT_EQ(harmonicsIn(second), "012");
  EXPECT_EQ(harmonicsIn(bakeAgain(second, 1)), "0");
  EXPECT_EQ(harmonicsIn(bakeAgain(third, 0)), "");
}

// Everything that is no lobe must come out as it went in.
TEST(Gltf, KeepsTheRestOfTheDocument) {
  const TestFolder folder;
  GltfBuilder gltf;
  Json primitive = gltf.tetrahedron();
  primitive["attributes"]["TEXCOORD_0"] = gltf.uvs();
  primitive["attributes"]["JOINTS_0"] = gltf.accessor(std::vector<uint8_t>(16, 0), 5121, "VEC4", 4);
  primitive["attributes"]["WEIGHTS_0"] = gltf.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
  primitive["material"] = 0;
  primitive["extras"] = {{"note", "a primitive"}};
  gltf.mesh({primitive});
  gltf.node({{"name", "skinned"}, {"mesh", 0}, {"skin", 0}, {"extras", {{"big", 9007199254740993}, {"list", {1, 2.5, nullptr, "ü"}}}}});
  gltf.node({{"name", "joint"}, {"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  Json& json = gltf.json;
  json["scenes"] = Json::array({{{"nodes", {0, 1}}, {"name", "all"}, {"extras", {{"a", 1}}}}});
  json["skins"] = Json::array({{{"joints", {1}}, {"name", "skin"}}});
  json["cameras"] = Json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.01}}}}});
  const int times = gltf.accessor(std::vector<float>{0, 1}, 5126, "SCALAR", 2, 0),
            moves = gltf.accessor(std::vector<float>(6, 0.5F), 5126, "VEC3", 2, 0);
  json["accessors"][size_t(times)]["min"] = {0};
  json["accessors"][size_t(times)]["max"] = {1};
  json["animations"] = Json::array({{{"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}})},
                                     {"samplers", Json::array({{{"input", times}, {"output", moves}}})}}});
  json["images"] = Json::array({{{"uri", "cloud.png"}}});
  json["textures"] = Json::array({{{"source", 0}}});
  json["materials"] =
      Json::array({{{"name", "m"},
                    {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {0.1, 0.2, 0.3, 1}}}},
                    {"emissiveFactor", {0.5, 0, 0}}}});
  json["extensionsUsed"] = {"KHR_lights_punctual"};
  json["extensions"] = {{"KHR_lights_punctual", {{"lights", Json::array({{{"type", "point"}, {"intensity", 20.5}}})}}}};
  json["extras"] = {{"project", "sky"}};
  json["asset"]["minVersion"] = "2.0";
  json["asset"]["copyright"] = "nobody";
  json["asset"]["extras"] = {{"tool", "x"}};
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);

  for (const char* key : {"scene", "scenes", "nodes", "skins", "cameras", "animations", "extensionsUsed", "extensions", "extras"})
    EXPECT_EQ(trip.json[key], json[key]) << key;
  for (const char* key : {"images", "textures", "accessors", "bufferViews"})
    for (size_t i = 0; i < json[key].size(); ++i) EXPECT_EQ(trip.json[key][i], json[key][i]) << key << i;
  EXPECT_EQ(trip.json["asset"]["minVersion"], "2.0");
  EXPECT_EQ(trip.json["asset"]["copyright"], "nobody");
  EXPECT_EQ(trip.json["asset"]["extras"]["tool"], "x");
  EXPECT_EQ(trip.json["asset"]["extras"]["cloudbake"]["source_generator"], "by hand");
  EXPECT_EQ(trip.json["meshes"][0]["primitives"][0]["extras"], primitive["extras"]);
  for (const auto& [name, accessor] : primitive["attributes"].items()) EXPECT_EQ(attributesOf(trip.json, 0)[name], accessor) << name;
  EXPECT_EQ(splitGlb("a", trip.glb).binary.substr(0, gltf.binary.size()), gltf.binary);
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kPoseIgnored), 1U);  // an animation
  // The material keeps what it had; only free slots were taken.
  Json material = trip.json["materials"][0];
  EXPECT_EQ(material["occlusionTexture"]["texCoord"], 1);
  EXPECT_EQ(material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["texCoord"], 2);
  material.erase("occlusionTexture");
  material["pbrMetallicRoughness"].erase("metallicRoughnessTexture");
  EXPECT_EQ(material, json["materials"][0]);
}

TEST(Gltf, FoldsOutsideBuffersIntoTheGlb) {
  const TestFolder folder;
  GltfBuilder gltf = oneTetrahedron();
  Json text = gltf.json;
  // Positions in a file whose name needs escaping, indices in a data URI.
  folder.write("my buffer.bin", gltf.binary.substr(0, 48));
  text["buffers"] = Json::array({{{"uri", "my%20buffer.bin"}, {"byteLength", 48}},
                                 {{"uri", "data:application/octet-stream;base64,AAACAAEAAAABAAMAAAADAAIAAQACAAMA"}, {"byteLength", 24}}});
  const std::string png = readFileBytes(sourceFolder() / "tests/data/cloud.png");
  text["images"] = Json::array(
      {{{"uri",
         "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAAAAABX3VL4AAAADklEQVR42mNwaGA48B8ABcUCgEX+dL0AAAAASUVORK5CYII="}}});
  text["textures"] = Json::array({{{"source", 0}}});
  text["bufferViews"][1]["buffer"] = 1;
  text["bufferViews"][1]["byteOffset"] = 0;
  const Trip trip = roundTrip(folder, "a.gltf", text.dump());
  expectSameLobes(trip);
  EXPECT_EQ(trip.json["buffers"].size(), 1U);
  EXPECT_FALSE(trip.json["buffers"][0].contains("uri"));
  const Json& image = trip.json["images"][0];
  EXPECT_FALSE(image.contains("uri"));
  EXPECT_EQ(image["mimeType"], "image/png");
  const Json& view = trip.json["bufferViews"][image["bufferView"].get<size_t>()];
  EXPECT_EQ(splitGlb("a", trip.glb).binary.substr(view["byteOffset"], view["byteLength"]), png);
  EXPECT_NEAR(signedVolume(trip.baked.surface.positions, trip.baked.surface.triangles), 1.0 / 6, 1e-7);
}

TEST(Gltf, BindsTexturesOnlyWhereTheyChangeNothing) {
  const TestFolder folder;
  const auto withMaterial = [](const Json& material, bool points) {
    GltfBuilder gltf;
    Json primitive = gltf.tetrahedron();
    primitive["material"] = 0;
    primitive["attributes"]["TEXCOORD_0"] = gltf.uvs();
    primitive["attributes"]["NORMAL"] = gltf.accessor(std::vector<Vec3>(4, {0, 0, 1}), 5126, "VEC3", 4);
    std::vector<Json> primitives{primitive};
    if (points)
      primitives.push_back(
          {{"attributes", {{"POSITION", primitive["attributes"]["POSITION"]}, {"TEXCOORD_0", primitive["attributes"]["TEXCOORD_0"]}}},
           {"mode", 0},
           {"material", 0}});
    gltf.mesh(primitives);
    gltf.node({{"mesh", 0}});
    gltf.json["scenes"].push_back({{"nodes", {0}}});
    gltf.json["materials"] = Json::array({material});
    gltf.json["images"] = Json::array({{{"uri", "cloud.png"}}});
    gltf.json["textures"] = Json::array({{{"source", 0}}});
    return gltf.glb();
  };
  const Json used = {{"index", 0}};
  const Json full = {{"pbrMetallicRoughness", {{"baseColorTexture", used}, {"metallicRoughnessTexture", used}}},
                     {"emissiveTexture", used},
                     {"emissiveFactor", {1, 1, 1}}};
  const Trip automatic = roundTrip(folder, "a.glb", withMaterial(full, false));
  EXPECT_EQ(automatic.json["materials"][0], full);
  EXPECT_EQ(automatic.json["textures"].size(), 1U);
  EXPECT_EQ(countOf(automatic.warnings, WarningKind::kKeepAlive), 1U);

  const Trip forced = roundTrip(folder, "a.glb", withMaterial(full, false), {{}, false, KeepAliveTexture::kForce});
  EXPECT_EQ(forced.json["materials"][0]["occlusionTexture"]["texCoord"], 1);
  EXPECT_EQ(forced.json["materials"][0]["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]["texCoord"], 2);
  EXPECT_EQ(forced.json["extensionsUsed"].dump(), R"(["KHR_materials_clearcoat"])");
  EXPECT_EQ(countOf(forced.warnings, WarningKind::kKeepAlive), 0U);

  const Trip off = roundTrip(folder, "b.glb", withMaterial(Json::object(), false), {{}, false, KeepAliveTexture::kOff});
  EXPECT_EQ(off.json["materials"][0], Json::object());

  // The texture's alpha is not 1 everywhere, so a material that reads alpha keeps its base colour slot free.
  for (const char* mode : {"BLEND", "MASK", "OPAQUE"}) {
    const Trip trip = roundTrip(folder, std::string(mode) + ".glb", withMaterial({{"alphaMode", mode}}, false));
    const Json& slots = trip.json["materials"][0]["pbrMetallicRoughness"];
    EXPECT_EQ(slots.contains("baseColorTexture"), std::string(mode) == "OPAQUE") << mode;
    EXPECT_TRUE(slots.contains("metallicRoughnessTexture")) << mode;
  }

  // Points share the material but get no UV sets: they keep the material as it was.
  const Trip shared = roundTrip(folder, "c.glb", withMaterial({{"name", "both"}}, true));
  EXPECT_EQ(shared.json["materials"][0].dump(), R"({"name":"both"})");
  EXPECT_EQ(shared.json["meshes"][0]["primitives"][0]["material"], 1);
  EXPECT_EQ(shared.json["meshes"][0]["primitives"][1]["material"], 0);
  EXPECT_EQ(countOf(shared.warnings, WarningKind::kPartIgnored), 1U);
}

TEST(Gltf, WritesTheAttributeWhenAsked) {
  const TestFolder folder;
  const Trip trip = roundTrip(folder, "a.obj", kTetrahedronObj, {{}, true, KeepAliveTexture::kAuto});
  const Json& attributes = attributesOf(trip.json, 0);
  const auto all = floatsOf(trip, attributes["_OCCLUSION"], 4), first = floatsOf(trip, attributes["TEXCOORD_0"], 2),
             second = floatsOf(trip, attributes["TEXCOORD_1"], 2);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_EQ((Vec2{all[4 * v], all[4 * v + 1]}), (Vec2{first[2 * v], first[2 * v + 1]}));
    EXPECT_EQ((Vec2{all[4 * v + 2], all[4 * v + 3]}), (Vec2{second[2 * v], second[2 * v + 1]}));
  }
}

TEST(Gltf, RecordsTheBake) {
  const TestFolder folder;
  const Trip trip = roundTrip(folder, "a.obj", kTetrahedronObj);
  EXPECT_EQ(trip.json["asset"]["generator"], "cloudbake " CLOUDBAKE_VERSION);
  Json metadata = trip.json["asset"]["extras"]["cloudbake"];
  EXPECT_EQ(metadata["seal"]["mesh"].get<std::string>().size(), 16U);
  ASSERT_TRUE(trip.baked.info.seal);
  EXPECT_EQ(trip.baked.info.seal->mesh, metadata["seal"]["mesh"]);
  EXPECT_EQ(trip.baked.info.seal->constants, metadata["seal"]["constants"]);
  EXPECT_FLOAT_EQ(trip.baked.info.seal->size, 1.5381892F) << "the root of three halves and a triangle of side √2";
  EXPECT_FALSE(trip.baked.info.seal->harmonics);
  metadata.erase("seal");
  EXPECT_EQ(
      metadata.dump(),
      R"({"layout":"lobe-uv","version":1,"uv_sets":[0,1],"lobe":"mean","exponent":3.0,"bias":-0.012,"extinction":2.25,"method":"rays",)"
      R"("field":"","sampler":"stratified","quadrature":"crossing","rays":100,"steps":100,"ray_length":3.5,"voxel_size":0.01,"seed":1,)"
      R"("input_hash":"99aa06d3014798d86001c324468d497f"})");
  EXPECT_EQ(trip.baked.info.shape.bias, -0.012F);
  EXPECT_EQ(trip.baked.info.input_hash, "99aa06d3014798d86001c324468d497f");
}

TEST(Gltf, RecordsSmoothingAndLevels) {
  Sculpt sculpt;
  sculpt.parts.push_back({"t", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}, {}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}});
  AssetInfo info = sampleInfo();
  info.smooth = 5, info.level = 2, info.switch_pixels = 340;
  Warnings warnings;
  const AssetInfo back = decodeGlb("t.glb", encodeGlb(sculpt, fakeLobes(sculpt), info, {}, warnings), warnings).info;
  EXPECT_EQ(back.smooth, 5);
  EXPECT_EQ(back.level, 2);
  EXPECT_EQ(back.switch_pixels, 340);
}

TEST(Gltf, GivesTheSameBytesTwice) {
  const TestFolder one, two;
  EXPECT_EQ(roundTrip(one, "a.obj", kTetrahedronObj).glb, roundTrip(two, "a.obj", kTetrahedronObj).glb);
  EXPECT_EQ(roundTrip(one, "a.glb", oneTetrahedron().glb()).glb, roundTrip(two, "a.glb", oneTetrahedron().glb()).glb);
}

// A shear has no place in a glTF matrix: the vertices move instead, mirrored ones turned round.
TEST(Gltf, MovesShearedPartsToTheScene) {
  Sculpt sculpt;
  sculpt.parts.push_back({"t", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}, {}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}});
  sculpt.parts[0].to_scene = {{{{-1, 0.5, 0}, {0, 2, 0}, {0, 0, 1}}}, {4, 0, 0}};
  Warnings warnings;
  const auto lobes = fakeLobes(sculpt);
  const std::string glb = encodeGlb(sculpt, lobes, sampleInfo(), {}, warnings);
  writeFileAtomically(glbFolder() / "sheared.glb", glb);
  const BakedMesh baked = decodeGlb("t.glb", glb, warnings);
  EXPECT_NEAR(signedVolume(baked.surface.positions, baked.surface.triangles), 2.0 / 6, 1e-6);
  for (size_t v = 0; v < 4; ++v) EXPECT_LT(angleDegrees(baked.lobes[v].direction, lobes[0][v].direction), 1e-4);
}

TEST(Gltf, ReadsStripsFansAndSparseAndQuantisedPositions) {
  const TestFolder folder;
  GltfBuilder gltf;
  const int strip = gltf.accessor(std::vector<int16_t>{0, 0, 0, 0, 16384, 0, 0, 0, 0, 16384, 0, 0, 16384, 16384, 0, 0}, 5122, "VEC3", 4);
  gltf.json["accessors"].back().update({{"normalized", true}, {"min", {0, 0, 0}}, {"max", {16384, 16384, 0}}});
  gltf.json["bufferViews"].back()["byteStride"] = 8;
  const int fan = gltf.accessor(std::vector<Vec3>(4), 5126, "VEC3", 4);
  const int where = gltf.accessor(std::vector<uint16_t>{1, 2, 3}, 5123, "SCALAR", 3, 0);
  const int what = gltf.accessor(std::vector<Vec3>{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 5126, "VEC3", 3, 0);
  const auto view = [&](int accessor) { return gltf.json["accessors"][size_t(accessor)]["bufferView"]; };
  gltf.json["accessors"][size_t(fan)].update(
      {{"min", {0, 0, 0}},
       {"max", {1, 1, 0}},
       {"sparse",
        {{"count", 3}, {"indices", {{"bufferView", view(where)}, {"componentType", 5123}}}, {"values", {{"bufferView", view(what)}}}}}});
  gltf.json["accessors"].erase(gltf.json["accessors"].begin() + what);
  gltf.json["accessors"].erase(gltf.json["accessors"].begin() + where);
  gltf.mesh({{{"attributes", {{"POSITION", strip}}}, {"mode", 5}}, {{"attributes", {{"POSITION", fan}}}, {"mode", 6}}});
  gltf.node({{"mesh", 0}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  ASSERT_EQ(trip.sculpt.parts.size(), 2U);
  EXPECT_NEAR(trip.sculpt.parts[0].positions[3].x, 16384 / 32767.0, 1e-7);
  EXPECT_EQ(trip.sculpt.parts[1].positions[2], (Vec3{1, 1, 0}));
  for (const SculptPart& part : trip.sculpt.parts) {
    ASSERT_EQ(part.triangles.size(), 2U);
    for (const Triangle& t : part.triangles)
      EXPECT_GT(cross(part.positions[t[1]] - part.positions[t[0]], part.positions[t[2]] - part.positions[t[0]]).z, 0);
  }
}

// A tetrahedron whose mesh goes half of the way to a place two units higher.
static GltfBuilder halfMorphedTetrahedron() {
  GltfBuilder gltf = oneTetrahedron();
  const int target = gltf.accessor(std::vector<Vec3>(4, {0, 2, 0}), 5126, "VEC3", 4);
  gltf.json["accessors"].back().update({{"min", {0, 2, 0}}, {"max", {0, 2, 0}}});
  gltf.json["meshes"][0]["primitives"][0]["targets"] = Json::array({{{"POSITION", target}}});
  gltf.json["meshes"][0]["weights"] = {0.5};
  return gltf;
}

TEST(Gltf, BakesTheFilesMorphWeights) {
  const TestFolder folder;
  const Trip trip = roundTrip(folder, "a.glb", halfMorphedTetrahedron().glb());
  EXPECT_EQ(trip.sculpt.parts.at(0).positions[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(countOf(trip.warnings, WarningKind::kPoseIgnored), 1U);
}

// glTF 2.0, section 3.7.2.2: the weights of a node replace those of its mesh, also where they are 0. Each node is posed by its own.
TEST(Gltf, ANodesMorphWeightsGoBeforeItsMeshs) {
  const TestFolder folder;
  GltfBuilder gltf = halfMorphedTetrahedron();
  gltf.node({{"mesh", 0}, {"weights", {0.125}}});
  gltf.node({{"mesh", 0}, {"weights", {0.0}}});
  gltf.json["scenes"][0]["nodes"] = {0, 1, 2};
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  ASSERT_EQ(trip.sculpt.parts.size(), 3U);
  EXPECT_EQ(trip.sculpt.parts[0].positions[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(trip.sculpt.parts[1].positions[0], (Vec3{0, 0.25F, 0}));
  EXPECT_EQ(trip.sculpt.parts[2].positions[0], (Vec3{0, 0, 0}));
}

TEST(Gltf, RefusesDamagedContainers) {
  const TestFolder folder;
  const std::string good = oneTetrahedron().glb();
  Warnings warnings;
  const auto read = [&](const std::string& bytes) { readMesh(folder.write("a.glb", bytes), {}, warnings); };
  for (size_t size = 1; size < good.size(); ++size) expectError<InputError>([&] { read(good.substr(0, size)); }, "a.glb: ");
  std::string magic = good, version = good;
  magic[0] = 'x';
  version[4] = 1;
  expectError<InputError>([&] { read(magic); }, "not a GLB");
  expectError<InputError>([&] { read(version); }, "GLB version 1");
  expectError<InputError>([&] { read(joinGlb("a", R"({"asset":{"version":"1.0"}})", "")); }, "glTF version 1.0 is not supported");
  std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '[') + std::string(100000, ']') + "}";
  expectError<InputError>([&] { read(joinGlb("a", deep, "")); }, "is nested more than");
  EXPECT_TRUE(filesNamedByGltf("a.glb", joinGlb("a", deep, "")).empty());
  EXPECT_FALSE(isBakedAsset("a.glb", joinGlb("a", deep, "")));
  expectError<InputError>([&] { read(joinGlb("a", "[]", "")); }, "is not an object");
}

TEST(Gltf, RefusesDamagedDocuments) {
  const TestFolder folder;
  Warnings warnings;
  const auto refuse = [&](const std::function<void(GltfBuilder&)>& damage, const std::string& text) {
    GltfBuilder gltf = oneTetrahedron();
    damage(gltf);
    expectError<InputError>([&] { readMesh(folder.write("a.glb", gltf.glb()), {}, warnings); }, text);
  };
  const auto floatAt = [](GltfBuilder& gltf, size_t index, float value) { std::memcpy(gltf.binary.data() + 4 * index, &value, 4); };
  refuse([&](GltfBuilder& g) { floatAt(g, 7, NAN); }, "position of vertex 2 is not finite");
  refuse([](GltfBuilder& g) { g.binary[48 + 4] = 9; }, "uses vertex 9 of 4");
  refuse([](GltfBuilder& g) { g.json["accessors"][1]["count"] = 11; }, "not a multiple of 3");
  refuse([](GltfBuilder& g) { g.json["accessors"][0]["count"] = 4000000000U; }, "ends beyond its buffer view");
  refuse([](GltfBuilder& g) { g.json["accessors"][0]["byteOffset"] = 4000000000U; }, "ends beyond its buffer view");
  refuse([](GltfBuilder& g) { g.json["accessors"][0].erase("bufferView"), g.json["accessors"][0]["count"] = 4000000000U; },
         "implausibly large for this file");
  refuse([](GltfBuilder& g) { g.json["bufferViews"][0]["byteLength"] = 4000000000U; }, "ends beyond its buffer");
  refuse([](GltfBuilder& g) { g.json["bufferViews"][0]["buffer"] = 3; }, "buffer that does not exist");
  refuse([](GltfBuilder& g) { g.json["accessors"][0]["bufferView"] = 30; }, "buffer view that does not exist");
  refuse([](GltfBuilder& g) { g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 30; }, "accessor that does not exist");
  refuse([](GltfBuilder& g) { g.json["meshes"][0]["primitives"][0]["indices"] = 30; }, "");
  refuse([](GltfBuilder& g) { g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 1e39; },
         "meshes[0].primitives[0].attributes.POSITION is 1e+39, not a whole number");
  refuse([](GltfBuilder& g) { g.json["nodes"][0]["mesh"] = 5; }, "mesh that does not exist");
  refuse([](GltfBuilder& g) { g.json["nodes"][0]["children"] = {0}; }, "its own ancestor");
  refuse([](GltfBuilder& g) { g.json["scenes"][0]["nodes"] = {0, 0}; }, "two parents");
  refuse([](GltfBuilder& g) { g.json["scenes"][0]["nodes"] = {7}; }, "node 7 of 1");
  refuse(
      [](GltfBuilder& g) {
        g.json["nodes"][0].update({{"name", "flat"}, {"scale", {1, 0, 1}}});
      },
      "node 0 ('flat') has a singular transform");
  refuse([](GltfBuilder& g) { g.json["scenes"][0]["nodes"] = Json::array(); }, "no triangles");
  refuse([](GltfBuilder& g) { g.json["meshes"][0]["primitives"][0]["mode"] = 9; }, "unknown mode");
  refuse([](GltfBuilder& g) { g.json["extensionsRequired"] = {"EXT_future"}; }, "EXT_future");
  refuse([](GltfBuilder& g) { g.json["bufferViews"] = g.json["accessors"] = Json::array(), g.binary.clear(); }, "");
  GltfBuilder gltf = oneTetrahedron();
  gltf.json["buffers"] = Json::array({{{"uri", "gone.bin"}, {"byteLength", 72}}});
  expectError<IoError>([&] { readMesh(folder.write("a.gltf", gltf.json.dump()), {}, warnings); }, "gone.bin");
}

// A buffer may lie below the folder, not outside it.
TEST(Gltf, ReadsBuffersOfItsFolderAlone) {
  const TestFolder folder;
  Warnings warnings;
  GltfBuilder gltf = oneTetrahedron();
  std::filesystem::create_directories(folder.path / "in" / "below");
  folder.write("a.bin", gltf.binary), folder.write("in/a.bin", gltf.binary), folder.write("in/below/a.bin", gltf.binary);
  const auto read = [&](const std::string& uri, const ReadSettings& settings = {}) {
    gltf.json["buffers"] = Json::array({{{"uri", uri}, {"byteLength", gltf.binary.size()}}});
    return readMesh(folder.write("in/a.gltf", gltf.json.dump()), settings, warnings).parts.at(0).triangles.size();
  };
  for (const char* uri : {"a.bin", "below/a.bin", "./a.bin", "below/../a.bin", "below%2Fa.bin"}) EXPECT_EQ(read(uri), 4U) << uri;
  for (const std::string uri : {"../a.bin", "below/../../a.bin", "..%2Fa.bin", "/../a.bin"})
    expectError<InputError>([&] { read(uri); }, "it lies outside the file's folder: move it there, or give --allow-outside");
  std::filesystem::create_symlink(folder.path / "a.bin", folder.path / "in" / "link.bin");
  expectError<InputError>([&] { read("link.bin"); }, "outside the file's folder");
  ReadSettings anywhere;
  anywhere.allow_outside = true;
  for (const char* uri : {"../a.bin", "link.bin"}) EXPECT_EQ(read(uri, anywhere), 4U) << uri;
}

// Images in files become bytes of the GLB, the same bytes; what may not or cannot be read keeps its name, and is counted.
TEST(Gltf, EmbedsImagesOfItsFolder) {
  const TestFolder folder;
  const std::string png = readFileBytes(sourceFolder() / "tests/data/cloud.png"), jpeg = "\xFF\xD8\xFF\xE0 and so on";
  std::filesystem::create_directories(folder.path / "in");
  folder.write("in/my cloud.png", png), folder.write("in/b.dat", jpeg), folder.write("out.png", png), folder.write("in/c.txt", "text");
  GltfBuilder gltf = oneTetrahedron();
  gltf.json["images"] = Json::array({{{"uri", "my%20cloud.png"}, {"name", "a"}},
                                     {{"uri", "b.dat"}, {"mimeType", "image/jpeg"}},
                                     {{"uri", "../out.png"}},
                                     {{"uri", "none.png"}},
                                     {{"uri", "c.txt"}},
                                     {{"uri", "https://a.b/c.png"}}});
  const auto bake = [&](const ReadSettings& settings, Warnings& warnings) {
    const Sculpt sculpt = readMesh(folder.write("in/a.glb", gltf.glb()), settings, warnings);
    return encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), {}, warnings);
  };
  Warnings warnings;
  const std::string glb = bake({}, warnings);
  const Json images = Json::parse(splitGlb("a", glb).json)["images"], views = Json::parse(splitGlb("a", glb).json)["bufferViews"];
  const auto bytesOfImage = [&](size_t i) {
    const Json& view = views[images[i]["bufferView"].get<size_t>()];
    return std::string(splitGlb("a", glb).binary.substr(view["byteOffset"], view["byteLength"]));
  };
  EXPECT_EQ(bytesOfImage(0), png);
  EXPECT_EQ(images[0]["mimeType"], "image/png");
  EXPECT_EQ(images[0]["name"], "a");
  EXPECT_FALSE(images[0].contains("uri"));
  EXPECT_EQ(bytesOfImage(1), jpeg);
  for (size_t i = 2; i < 6; ++i) EXPECT_EQ(images[i], gltf.json["images"][i]);
  EXPECT_EQ(countOf(warnings, WarningKind::kImageNotEmbedded), 4U);

  ReadSettings anywhere;
  anywhere.allow_outside = true;
  Warnings fewer;
  bake(anywhere, fewer);
  EXPECT_EQ(countOf(fewer, WarningKind::kImageNotEmbedded), 3U);
}

// The file may be named in Latin-1, which a URI can say and JSON cannot.
TEST(Gltf, EmbedsImagesWhoseNameIsNotUtf8) {
  const TestFolder folder;
  folder.write("h\xE4lfte.png", readFileBytes(sourceFolder() / "tests/data/cloud.png"));
  GltfBuilder gltf = oneTetrahedron();
  gltf.json["images"] = Json::array({{{"uri", "h%E4lfte.png"}}, {{"uri", "f%FCnf.png"}}});
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.glb", gltf.glb()), {}, warnings);
  const Json images = Json::parse(splitGlb("a", encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), {}, warnings)).json)["images"];
  EXPECT_EQ(images[0]["name"], "h\u00E4lfte");
  EXPECT_TRUE(images[0].contains("bufferView"));
  EXPECT_EQ(images[1]["uri"], "f%FCnf.png");
}

TEST(Gltf, KnowsImagesByTheirBytes) {
  using namespace std::string_view_literals;
  EXPECT_EQ(imageMimeType("\x89PNG\r\n\x1A\n rest"sv), "image/png");
  EXPECT_EQ(imageMimeType("\xABKTX 20\xBB\r\n"sv), "image/ktx2");
  EXPECT_EQ(imageMimeType("RIFF\1\2\3\4WEBPVP8 "sv), "image/webp");
  EXPECT_EQ(imageMimeType("DDS |"sv), "image/vnd-ms.dds");
  EXPECT_EQ(imageMimeType("\0\0\0\x20"
                          "ftypavif"sv),
            "image/avif");
  for (const std::string_view other : {""sv, "\x89PN"sv, "RIFF"sv, "GIF89a"sv, "\0\0"sv}) EXPECT_EQ(imageMimeType(other), "");
}

// What --repair changes of a part replaces its indices and normals; every other accessor stays, and other nodes of the mesh keep theirs.
TEST(Gltf, WritesRepairedTriangles) {
  const TestFolder folder;
  GltfBuilder gltf;
  Json primitive = gltf.tetrahedron();
  primitive["attributes"]["NORMAL"] = gltf.accessor(std::vector<float>{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1}, 5126, "VEC3", 4);
  primitive["attributes"]["COLOR_0"] = gltf.accessor(std::vector<float>(16, 0.5F), 5126, "VEC4", 4);
  gltf.mesh({primitive});
  for (int i = 0; i < 2; ++i) gltf.node({{"mesh", 0}, {"translation", {3 * i, 0, 0}}});
  gltf.json["scenes"].push_back({{"nodes", {0, 1}}});
  Warnings warnings;
  Sculpt sculpt = readMesh(folder.write("a.glb", gltf.glb()), {}, warnings);
  SculptPart& part = sculpt.parts.at(1);
  std::swap(part.triangles[2][1], part.triangles[2][2]);
  part.triangles.push_back({0, 1, 2});
  part.normals[3] = {0, 0, -1};
  part.repaired = true;
  const std::string glb = encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), {}, warnings);
  const BakedMesh baked = decodeGlb("a.glb", glb, warnings);
  EXPECT_EQ(baked.surface.triangles, surfaceInScene(sculpt).triangles);
  EXPECT_EQ(baked.surface.normals, surfaceInScene(sculpt).normals);
  const Json json = Json::parse(splitGlb("a", glb).json);
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["indices"], primitive["indices"]);
  EXPECT_EQ(attributesOf(json, 1)["POSITION"], primitive["attributes"]["POSITION"]);
  EXPECT_EQ(attributesOf(json, 1)["COLOR_0"], primitive["attributes"]["COLOR_0"]);
  EXPECT_NE(attributesOf(json, 1)["NORMAL"], primitive["attributes"]["NORMAL"]);
}

// The largest number of a type is no index. Exporters that do not know it get a wider type.
TEST(Gltf, WidensIndicesThatEndAStrip) {
  const TestFolder folder;
  const auto trip = [&](size_t vertices, const auto zero, int type) {
    using Index = std::decay_t<decltype(zero)>;
    GltfBuilder gltf;
    std::vector<Vec3> positions;
    for (size_t v = 0; v < vertices; ++v) positions.push_back({float(v % 7), float(v % 11), float(v)});
    const int position = gltf.accessor(positions, 5126, "VEC3", vertices);
    for (const char* bound : {"min", "max"})
      gltf.json["accessors"][0][bound] = {bound[1] == 'i' ? 0 : 6, bound[1] == 'i' ? 0 : 10, bound[1] == 'i' ? 0 : vertices - 1};
    std::vector<Index> indices;
    for (const size_t v : {size_t(0), size_t(1), size_t(2), vertices - 3, vertices - 2, vertices - 1}) indices.push_back(Index(v));
    const int index = gltf.accessor(indices, type, "SCALAR", 6, 34963);
    gltf.mesh({{{"attributes", {{"POSITION", position}}}, {"indices", index}}});
    gltf.node({{"mesh", 0}});
    gltf.json["scenes"].push_back({{"nodes", {0}}});
    const Trip there = roundTrip(folder, "a.glb", gltf.glb());
    EXPECT_EQ(there.baked.surface.triangles, surfaceInScene(there.sculpt).triangles);
    const Json& primitive = there.json["meshes"][0]["primitives"][0];
    EXPECT_EQ(primitive["attributes"]["POSITION"], position);
    return there.json["accessors"][primitive["indices"].get<size_t>()]["componentType"].get<int>();
  };
  EXPECT_EQ(trip(255, uint8_t(), 5121), 5121);
  EXPECT_EQ(trip(256, uint8_t(), 5121), 5123);
  EXPECT_EQ(trip(65535, uint16_t(), 5123), 5123);
  EXPECT_EQ(trip(65536, uint16_t(), 5123), 5125);
}

// Everything that a primitive may carry beside positions.
TEST(Gltf, KeepsTangentsColoursUvsAndMorphTargets) {
  const TestFolder folder;
  GltfBuilder gltf;
  Json primitive = gltf.tetrahedron();
  Json attributes = primitive["attributes"];
  attributes["NORMAL"] = gltf.accessor(std::vector<float>{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1}, 5126, "VEC3", 4);
  attributes["TANGENT"] = gltf.accessor(std::vector<float>{1, 0, 0, 1, 1, 0, 0, -1, 0, 1, 0, 1, 1, 0, 0, 1}, 5126, "VEC4", 4);
  attributes["COLOR_0"] = gltf.accessor(std::vector<uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}, 5121, "VEC4", 4);
  gltf.json["accessors"].back()["normalized"] = true;
  for (int set = 0; set < 3; ++set) attributes[uvSetName(set)] = gltf.uvs();
  attributes["_ARTIST"] = gltf.accessor(std::vector<float>{1, 2, 3, 4}, 5126, "SCALAR", 4);
  primitive["attributes"] = attributes;
  primitive["targets"] = Json::array();
  for (int target = 0; target < 2; ++target) {
    const int moves = gltf.accessor(std::vector<float>(12, float(target)), 5126, "VEC3", 4);
    for (const char* bound : {"min", "max"}) gltf.json["accessors"][size_t(moves)][bound] = {target, target, target};
    primitive["targets"].push_back({{"POSITION", moves}, {"NORMAL", gltf.accessor(std::vector<float>(12, 0.0F), 5126, "VEC3", 4)}});
  }
  gltf.mesh({primitive});
  gltf.json["meshes"][0]["weights"] = {0.0, 0.25};
  gltf.json["meshes"][0]["extras"] = {{"targetNames", {"calm", "storm"}}};
  gltf.node({{"mesh", 0}, {"weights", {0.5, 0.0}}});
  gltf.json["scenes"].push_back({{"nodes", {0}}});
  const Trip trip = roundTrip(folder, "a.glb", gltf.glb());
  expectSameLobes(trip);
  const Json& kept = trip.json["meshes"][0]["primitives"][0];
  for (const auto& [name, accessor] : attributes.items()) EXPECT_EQ(kept["attributes"][name], accessor) << name;
  EXPECT_EQ(kept["attributes"].size(), attributes.size() + 2);
  EXPECT_TRUE(kept["attributes"].contains("TEXCOORD_3") && kept["attributes"].contains("TEXCOORD_4"));
  EXPECT_EQ(kept["targets"], primitive["targets"]);
  EXPECT_EQ(trip.json["meshes"][0]["weights"], gltf.json["meshes"][0]["weights"]);
  EXPECT_EQ(trip.json["meshes"][0]["extras"], gltf.json["meshes"][0]["extras"]);
  EXPECT_EQ(trip.json["nodes"], gltf.json["nodes"]);
  for (size_t i = 0; i < gltf.json["accessors"].size(); ++i) EXPECT_EQ(trip.json["accessors"][i], gltf.json["accessors"][i]);
  EXPECT_EQ(splitGlb("a", trip.glb).binary.substr(0, gltf.binary.size()), gltf.binary);
}

// Numbers that no integer holds, in places that only the writer and the asset's record look at.
TEST(Gltf, RefusesFractionsWhereWholeNumbersBelong) {
  const TestFolder folder;
  const auto refuse = [&](const std::function<void(Json&)>& damage, const std::string& text) {
    Warnings warnings;
    GltfBuilder gltf = oneTetrahedron();
    gltf.json["materials"] = {{{"extensions", {{"EXT_new", {{"newTexture", {{"index", 0}, {"texCoord", 0}}}}}}}}};
    gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
    damage(gltf.json);
    const Sculpt sculpt = readMesh(folder.write("a.glb", gltf.glb()), {}, warnings);
    expectError<InputError>([&] { encodeGlb(sculpt, fakeLobes(sculpt), sampleInfo(), {}, warnings); }, text);
  };
  refuse([](Json& json) { json["materials"][0]["extensions"]["EXT_new"]["newTexture"]["texCoord"] = 1e39; },
         "material 0: the texCoord of a texture is 1e+39, not a whole number");
  refuse([](Json& json) { json["meshes"][0]["primitives"][0]["material"] = 3; }, "material 3 of 1");

  const Trip trip = roundTrip(folder, "a.glb", oneTetrahedron().glb());
  for (const char* key : {"version", "rays", "steps", "smooth", "seed"})
    for (const Json& value : {Json(1e39), Json("1")}) {
      Json json = trip.json;
      json["asset"]["extras"]["cloudbake"][key] = value;
      EXPECT_FALSE(readInfo(json)) << key;
    }
  for (const Json& value : {Json(1e39), Json(-1), Json(2147483647), Json(4294967296)}) {
    Json json = trip.json;
    json["asset"]["extras"]["cloudbake"]["uv_sets"] = {value, 1};
    EXPECT_FALSE(readInfo(json)) << value;
  }
}

// Numbers that 32 bits do not hold reach no shader, page or report.
TEST(Gltf, NamesWhatIsWrongInTheMetadata) {
  const TestFolder folder;
  Warnings warnings;
  const Trip trip = roundTrip(folder, "a.glb", oneTetrahedron().glb());
  const std::string binary(splitGlb("a", trip.glb).binary);
  const auto refusal = [&](const char* key, const Json& value, const std::string& text) {
    Json json = trip.json;
    json["asset"]["extras"]["cloudbake"][key] = value;
    const std::string glb = joinGlb("a", json.dump(), binary);
    expectError<InputError>([&] { decodeGlb("a.glb", glb, warnings); }, "a.glb: asset.extras.cloudbake" + text);
    EXPECT_EQ(readStoredAsset("a.glb", glb, warnings).info_fault.substr(0, 22 + text.size()), "asset.extras.cloudbake" + text);
  };
  for (const char* key : {"exponent", "bias", "extinction", "ray_length", "voxel_size"}) {
    const std::string place = std::string(".") + key;
    refusal(key, 1e39, place + " is 1e+39, which is too large for 32 bits");
    refusal(key, -1e39, place + " is -1e+39, which is too large for 32 bits");
    refusal(key, "3", place + " is \"3\", not a number");
    refusal(key, Json(), place + " is null, not a number");
  }
  refusal("extinction_range", {1, 1e39}, ".extinction_range[1] is 1e+39, which is too large for 32 bits");
  refusal("extinction_range", {1}, ".extinction_range is a list of 1, not a list of 2 numbers");
  refusal("sun_elevation", {0, 1}, ".sun_azimuth is missing");
  refusal("rays", 1.5, ".rays is 1.5, not a whole number");
  refusal("separate", 1, ".separate is 1, not true or false");
  refusal("lobe", 5, ".lobe is 5, not a text");
  refusal("uv_sets", {0, 2}, ".uv_sets does not have two neighbouring UV sets");
  refusal("version", 2, " is of layout 'lobe-uv' 2, and this program reads 'lobe-uv' 1");
  EXPECT_EQ(readStoredAsset("a.glb", trip.glb, warnings).info_fault, "");
  // Only a fit to a volume has these
  const auto volumeRefusal = [&](const char* key, double value, const std::string& text) {
    Json json = trip.json;
    json["asset"]["extras"]["cloudbake"].update({{"fit_to", "volume"}, {key, value}});
    expectError<InputError>([&] { decodeGlb("a.glb", joinGlb("a", json.dump(), binary), warnings); },
                            "a.glb: asset.extras.cloudbake" + text);
  };
  volumeRefusal("phase", 1, ".phase is 1.0, not a number from -0.95 to 0.95");
  volumeRefusal("view_extinction", 0, ".view_extinction is 0.0, not a number from 0.01 to 100");
  volumeRefusal("octave_extinction", -1, ".octave_extinction is -1.0, not a number from 0 to 1");
  volumeRefusal("octave_contribution", 2, ".octave_contribution is 2.0, not a number from 0 to 1");
  Json odd = trip.json;
  odd["asset"]["extras"]["cloudbake"] = 5;
  expectError<InputError>([&] { decodeGlb("a.glb", joinGlb("a", odd.dump(), binary), warnings); },
                          "asset.extras.cloudbake is 5, not an object");
}

TEST(Gltf, DecodesOnlyBakedAssets) {
  const TestFolder folder;
  Warnings warnings;
  expectError<InputError>([&] { decodeGlb("a.glb", oneTetrahedron().glb(), warnings); }, "run `cloudbake bake`");
  const Trip trip = roundTrip(folder, "a.glb", oneTetrahedron().glb());
  Json stripped = trip.json;
  stripped["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_1");
  const std::string binary(splitGlb("a", trip.glb).binary);
  expectError<InputError>([&] { decodeGlb("a.glb", joinGlb("a", stripped.dump(), binary), warnings); }, "has no TEXCOORD_1");
  Json quantised = trip.json;
  quantised["accessors"][attributesOf(trip.json, 0)["TEXCOORD_0"].get<size_t>()].update({{"componentType", 5123}, {"normalized", true}});
  expectError<InputError>([&] { decodeGlb("a.glb", joinGlb("a", quantised.dump(), binary), warnings); }, "quantised");
}

TEST(Gltf, NeedsALobePerVertex) {
  const TestFolder folder;
  Warnings warnings;
  const Sculpt sculpt = readMesh(folder.write("a.obj", kTetrahedronObj), {}, warnings);
  EXPECT_THROW(encodeGlb(sculpt, std::vector<std::vector<Lobe>>(), {}, {}, warnings), Error);
}
