// A tetrahedron, or something as small, in every syntax of every format.
#include <draco/compression/encode.h>
#include <meshoptimizer.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "bake/mesh/repair.h"
#include "core/level_set_type.h"
#include "io/gltf/asset/write.h"
#include "io/gltf/document.h"
#include "io/report/batch_report.h"
#include "io/sculpt/read_mesh.h"
#include "io/volume/lattice.h"
#include "io/volume/spheres.h"
#include "io/volume/vdb_file.h"
#include "pipeline/library/cloudbake.h"
#include "tests/folders.h"
#include "tests/fuzz/reader_fuzz.h"
#include "tests/io/sculpt/fbx_helpers.h"
#include "tests/io/zip_helpers.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;
namespace vdb = openvdb;

constexpr const char* kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
constexpr std::array<std::array<float, 3>, 4> kPoints{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr std::array<std::array<uint16_t, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

template <class T>
std::string packed(const T& value, bool big_endian = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string readText(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string binaryPly(bool big_endian) {
  std::string ply = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                    "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar pscale\n"
                    "element face 4\nproperty list uchar short vertex_indices\nend_header\n";
  for (const auto& point : kPoints) {
    for (const float x : point) ply += packed(x, big_endian);
    ply += '\1';
  }
  for (const auto& face : kFaces) {
    ply += '\3';
    for (const uint16_t index : face) ply += packed(index, big_endian);
  }
  return ply;
}

std::string bakedGlb(const std::string& obj) {
  Warnings warnings;
  const Sculpt sculpt = readMesh("a.obj", obj, {}, warnings);
  const std::vector<std::vector<Lobe>> lobes{std::vector<Lobe>(sculpt.parts[0].positions.size(), Lobe{{0, 0, 1}, 0.5F})};
  return encodeGlb(sculpt, lobes, {}, {}, warnings);
}

// Most of what a reader of glTF knows: nodes within nodes, matrices, strips and fans, sparse accessors, integers, morph targets.
std::string richGlb() {
  constexpr const char* kJson = R"({"asset":{"version":"2.0","generator":"hand","extras":1},"scene":0,"scenes":[{"nodes":[0,3]}],
"nodes":[{"children":[1,2],"translation":[1,0,0],"rotation":[0,0,0.6,0.8],"scale":[1,2,-1]},{"mesh":0,"skin":0,"weights":[1]},
{"mesh":1,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,3,0,0,1]},{"mesh":1,"name":"b"}],"skins":[{"joints":[0]}],
"meshes":[{"weights":[0.5],"primitives":[{"attributes":{"POSITION":0,"NORMAL":2},"indices":1,"material":0,
"targets":[{"POSITION":2,"NORMAL":0}]}]},{"name":"m","primitives":[{"attributes":{"POSITION":3,"TEXCOORD_0":4},"mode":5},
{"attributes":{"POSITION":0},"mode":6,"material":1},{"attributes":{"POSITION":0},"mode":1}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1}}},
{"alphaMode":"MASK","emissiveTexture":{"index":0},"extensions":{"KHR_materials_unlit":{}}}],
"textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,iVBORw0KGgo="}],"animations":[{}],
"extensionsUsed":["KHR_materials_unlit"],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"},
{"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"byteOffset":2,"componentType":5123},
"values":{"bufferView":0,"byteOffset":12}}},{"bufferView":0,"componentType":5122,"normalized":true,"count":4,"type":"VEC3"},
{"bufferView":0,"byteOffset":8,"componentType":5121,"normalized":true,"count":4,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":48,"byteStride":12},{"buffer":0,"byteOffset":48,"byteLength":24}],"buffers":[{"byteLength":72}]})";
  std::string binary;
  for (const auto& point : kPoints)
    for (const float x : point) binary += packed(x);
  for (const auto& face : kFaces)
    for (const uint16_t index : face) binary += packed(index);
  return joinGlb("a.glb", kJson, binary);
}

// The tetrahedron as text, its buffer as a data URI.
constexpr const char* kTextGltf = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
"buffers":[{"byteLength":72,"uri":"data:application/octet-stream;base64,)"
                                  "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"
                                  "AAACAAEAAAABAAMAAAADAAIAAQACAAMA"
                                  R"("}]})";

// Joints with two influences, two scenes, instances, and an animation of the joints.
std::string posedGlb() {
  constexpr const char* kJson = R"({"asset":{"version":"2.0"},"scene":1,"scenes":[{"nodes":[3]},{"nodes":[0,1,4]}],
"nodes":[{"mesh":0,"skin":0,"scale":[0,0,0]},{"children":[2],"scale":[1,2,-1]},{"rotation":[0,0,0.6,0.8]},{"mesh":0},
{"mesh":0,"name":"i","extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0,"ROTATION":4,"SCALE":2,"_ID":5}}}}],
"skins":[{"joints":[1,2],"inverseBindMatrices":6}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":3,"WEIGHTS_0":4},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"},
{"bufferView":0,"byteOffset":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":2,"componentType":5121,"count":4,"type":"VEC4"},
{"bufferView":3,"componentType":5126,"count":4,"type":"VEC4"},{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"},
{"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"},
{"bufferView":0,"byteOffset":8,"componentType":5126,"count":2,"type":"SCALAR"},
{"bufferView":3,"componentType":5126,"count":2,"type":"VEC4"},
{"bufferView":0,"componentType":5126,"count":2,"type":"VEC3"}],
"animations":[{"name":"w","channels":[{"sampler":0,"target":{"node":1,"path":"translation"}},
{"sampler":1,"target":{"node":2,"path":"rotation"}}],"samplers":[{"input":7,"output":9,"interpolation":"STEP"},{"input":7,"output":8}]}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24},{"buffer":0,"byteOffset":72,"byteLength":16},
{"buffer":0,"byteOffset":88,"byteLength":64},{"buffer":0,"byteOffset":152,"byteLength":128}],
"extensionsUsed":["EXT_mesh_gpu_instancing"],"buffers":[{"byteLength":280}]})";
  std::string binary;
  for (const auto& point : kPoints)
    for (const float x : point) binary += packed(x);
  for (const auto& face : kFaces)
    for (const uint16_t index : face) binary += packed(index);
  for (int i = 0; i < 16; ++i) binary += char(i % 4 == 1);
  for (int i = 0; i < 16; ++i) binary += packed(i % 4 == 3 || i % 4 == 1 ? 0.5F : 0.0F);
  for (int i = 0; i < 32; ++i) binary += packed(i % 16 % 5 == 0 ? 1.0F : 0.0F);
  return joinGlb("a.glb", kJson, binary);
}

// The tetrahedron by the codecs of meshoptimizer, with a filter that rounds its positions.
std::string meshoptGlb(bool is_filtered, bool as_triangles) {
  std::array<uint32_t, 12> coded{}, indices{};
  meshopt_encodeFilterExp(coded.data(), 4, 12, 20, kPoints[0].data());
  for (size_t i = 0; i < 12; ++i) indices[i] = kFaces[i / 3][i % 3];
  std::string vertices(meshopt_encodeVertexBufferBound(4, 12), '\0'), triangles(1000, '\0');
  const void* source = is_filtered ? static_cast<const void*>(coded.data()) : kPoints.data();
  vertices.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(vertices.data()), vertices.size(), source, 4, 12));
  auto* out = reinterpret_cast<unsigned char*>(triangles.data());
  triangles.resize(as_triangles ? meshopt_encodeIndexBuffer(out, triangles.size(), indices.data(), 12)
                                : meshopt_encodeIndexSequence(out, triangles.size(), indices.data(), 12));
  const auto view = [](size_t begin, size_t length, int stride, int count, const std::string& mode) {
    return R"({"buffer":1,"byteLength":48,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteOffset":)" + std::to_string(begin) +
           R"(,"byteLength":)" + std::to_string(length) + R"(,"byteStride":)" + std::to_string(stride) + R"(,"count":)" +
           std::to_string(count) + R"(,"mode":)" + mode + "}}}";
  };
  const std::string json =
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":1,"componentType":5125,"count":12,"type":"SCALAR"}],
"extensionsRequired":["EXT_meshopt_compression"],"bufferViews":[)" +
      view(0, vertices.size(), 12, 4, is_filtered ? R"("ATTRIBUTES","filter":"EXPONENTIAL")" : R"("ATTRIBUTES")") + "," +
      view(vertices.size(), triangles.size(), 4, 12, as_triangles ? R"("TRIANGLES")" : R"("INDICES")") + R"(],"buffers":[{"byteLength":)" +
      std::to_string(vertices.size() + triangles.size()) +
      R"(},{"byteLength":96,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}]})";
  return joinGlb("a.glb", json, vertices + triangles);
}

std::string dracoGlb(bool edgebreaker) {
  draco::Mesh mesh;
  mesh.set_num_points(4);
  draco::GeometryAttribute type;
  type.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int id = mesh.AddAttribute(type, true, 4);
  for (uint32_t v = 0; v < 4; ++v) mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), kPoints[v].data());
  for (const auto& face : kFaces) mesh.AddFace({draco::PointIndex(face[0]), draco::PointIndex(face[1]), draco::PointIndex(face[2])});
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  if (edgebreaker) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 12);
  draco::EncoderBuffer buffer;
  encoder.EncodeMeshToBuffer(mesh, &buffer);
  const std::string length = std::to_string(buffer.size());
  return joinGlb("a.glb",
                 R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,
"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}]}],
"accessors":[{"componentType":5126,"count":4,"type":"VEC3"},{"componentType":5123,"count":12,"type":"SCALAR"}],
"extensionsRequired":["KHR_draco_mesh_compression"],"bufferViews":[{"buffer":0,"byteLength":)" +
                     length + R"(}],"buffers":[{"byteLength":)" + length + "}]}",
                 {buffer.data(), buffer.size()});
}

// A ball in the middle of one leaf, so that the file is small.
vdb::FloatGrid::Ptr ballGrid(bool is_fog) {
  constexpr float kRadius = 2.2F;
  auto grid = vdb::FloatGrid::create(is_fog ? 0 : kBandHalfWidth_voxels);
  grid->setName(is_fog ? "density" : "surface");
  grid->setGridClass(is_fog ? vdb::GRID_FOG_VOLUME : vdb::GRID_LEVEL_SET);
  auto access = grid->getAccessor();
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 8; ++k) {
        const auto phi = float(std::hypot(i - 3.5, j - 3.5, k - 3.5)) - kRadius;
        if (is_fog && phi < 0) access.setValue({i, j, k}, -phi / kRadius);
        if (!is_fog && phi < kBandHalfWidth_voxels) access.setValue({i, j, k}, phi);
      }
  return grid;
}

// Bytes of a .vdb, without the random name that OpenVDB gives it.
std::string withoutUuid(std::string bytes) {
  constexpr size_t kUuidAt = 8 + 3 * 4 + 1;
  return bytes.replace(kUuidAt, 36, "00000000-0000-0000-0000-000000000000");
}
std::string streamed(const vdb::GridCPtrVec& grids, uint32_t compression) {
  std::ostringstream out(std::ios::binary);
  vdb::io::Stream stream(out);
  stream.setCompression(compression);
  stream.write(grids);
  return withoutUuid(out.str());
}
// With the places of the grids, as openvdb::io::File alone writes them.
std::string asFile(const vdb::GridCPtrVec& grids) {
  const int memory = memfd_create("seed", 0);
  const std::string name = "/proc/self/fd/" + std::to_string(memory);
  {
    vdb::io::File file(name);
    file.setCompression(vdb::io::COMPRESS_ZIP | vdb::io::COMPRESS_ACTIVE_MASK);
    file.write(grids);
  }
  const std::string bytes = readText(name);
  close(memory);
  return withoutUuid(bytes);
}

std::vector<std::string> textsOf(const char* folder) {
  std::vector<std::string> texts;
  for (const auto& entry : fs::directory_iterator(sourceFolder() / folder)) texts.push_back(readText(entry.path()));
  std::sort(texts.begin(), texts.end());
  return texts;
}

}  // namespace

std::vector<std::string> objSeeds() {
  return {kObj,
          "# corners\nmtllib a.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl m\ns 1\n"
          "f 1/1/1 2/2/1 \\\n 3/3/1\r\nf -4//1 -2//1 -1//1\nf 1/1 2/2 3/3 4\nl 1 2\np 1\n",
          "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\ng b\nf 5 4 3 2 1\n"};
}

std::vector<std::string> mtlSeeds() {
  return {"newmtl a\nKd 1 0.5 0\nNs 10\nd 0.5\nillum 2\nmap_Kd dot.png\n",
          "# all\nnewmtl a\nKa 0 0 0\nKd 0.1 0.2 0.3\nKs 1 1 1\nKe 2 0 0\nNs 1e3\nNi 1.5\nTr 0.25\nPr 0.5\nPm 1\nmap_Kd -o 1 2 0 -s 2 2 1 "
          "-clamp on dot.png\nnorm dot.png\nmap_Ke dot.png\n\nnewmtl b c\nmap_Bump -bm 0.3 dot.png\nmap_d dot.png\nmap_Kd none.png\n"};
}

std::vector<std::string> fbxSeeds() {
  const auto elements = fbxOf({{1, "a", 0, {{"Visibility", {0}}, {"Lcl Scaling", {2, 1, 1}}}, false},
                               {2, "b", 1, {{"InheritType", {0}}, {"Lcl Rotation", {0, 0, 30}}, {"RotationPivot", {1, 2, 3}}}},
                               {3, "c", 1, {{"InheritType", {2}}, {"GeometricScaling", {0, 0, 0}}, {"RotationActive", {0}}}}},
                              kFbxCentimetres, {{"Show", {1}}});
  return {fbxText(elements), fbxBinary(elements, 7400), fbxBinary(elements, 7500)};
}

std::vector<std::string> printedSeeds() {
  const std::string model =
      "<?xml version=\"1.0\"?><!-- a --><model unit=\"inch\" requiredextensions=\"m\" "
      "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/"
      "material/2015/02\"><resources><m:texture2d/><object id=\"1\" pid='2' pindex=\"0\"><mesh><triangles><triangle v1=\"0\" pid=\"2\" "
      "p1=\"1\" p2=\"1\"/><triangle/></triangles></mesh></object></resources><build><item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 "
      "0\"/></build></model>";
  const std::string relations =
      "<Relationships><Relationship Target=\"/3D/3dmodel.model\" Id=\"r\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
  return {model, zipOf({{"_rels/.rels", relations}, {"3D/3dmodel.model", model}}),
          "<amf unit=\"feet\"><constellation><instance objectid=\"1\"><rz>0</rz></instance></constellation></amf>"};
}

std::vector<std::string> stlSeeds() {
  std::string text = "solid a\n", binary = std::string(80, ' ') + packed(uint32_t(kFaces.size()));
  for (const auto& face : kFaces) {
    text += "facet normal 0 0 0\nouter loop\n";
    binary += std::string(12, '\0');
    for (const uint16_t index : face) {
      text += "vertex";
      for (const float x : kPoints[index]) text += " " + std::to_string(int(x)), binary += packed(x);
      text += "\n";
    }
    text += "endloop\nendfacet\n";
    binary += std::string(2, '\0');
  }
  return {text + "endsolid a\n", binary};
}

std::vector<std::string> offSeeds() {
  return {"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
          "STCNOFF # all\n4 2 0\n0 0 0 0 0 1 255 0 0 255 0 0\n1 0 0 0 0 1 0 1\n1 1 0 0 0 1 1 1\n\n0 1 0 0 0 1 0.5 1 0\n4 0 1 2 3 255 0 "
          "0\n2 0 1\n",
          "OFF 5 1 0\n0 0 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0\n5 0 1 2 3 4\n"};
}

std::vector<std::string> plySeeds() {
  return {
      "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\nelement face 4\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
      binaryPly(false), binaryPly(true),
      "ply\nformat ascii 1.0\ncomment TextureFile dot.png\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty int texnumber\n"
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement material 1\nproperty uchar diffuse_red\n"
      "property uchar diffuse_green\nproperty uchar diffuse_blue\nproperty float specular_power\nend_header\n"
      "3 0 1 2 6 0 0 1 0 0 1 255 0 9 0\n3 2 1 0 0 0 255 9 1\n0 0 0\n1 0 0\n0 1 0\n255 9 0 30\n"};
}

std::vector<std::string> spherePlySeeds() {
  const std::vector<Sphere> spheres{{{1, 2, 3}, 0.5F}, {{-4, 5, -6}, 7}};
  return {encodeSpheres(spheres, SphereFormat::kPly), plySeeds()[1], plySeeds()[2],
          "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 2\nproperty float x\n"
          "property list uchar int neighbours\nproperty double y\nproperty float z\nproperty short radius\nend_header\n3 0 1 1\n"
          "1 0 2 3 4\n5 2 0 1 6 7 8\n"};
}

std::vector<std::string> sphereCsvSeeds() {
  const std::vector<Sphere> spheres{{{1, 2, 3}, 0.5F}, {{-4, 5, -6}, 7}};
  return {encodeSpheres(spheres, SphereFormat::kCsv), "1,2,3,0.5\n-4,5,-6,7",
          "\xEF\xBB\xBF\"P[x]\",\"P[y]\",\"P[z]\",\"pscale\"\r\n1,2,3,0.5\r\n",
          "# a\n\nid;name;P[0];P[1];P[2];r;g;scale\n0;\"b;c\";1;2;3;0;0;+.5e1\n", "radius\tZ\tY\tX\n0.5\t3\t2\t1\n"};
}

std::vector<std::string> gltfSeeds() {
  return {
      kTextGltf,       richGlb(),     bakedGlb(kObj), bakedGlb(objSeeds()[1]), posedGlb(), meshoptGlb(false, true), meshoptGlb(true, false),
      dracoGlb(false), dracoGlb(true)};
}

std::vector<std::string> assetSeeds() {
  const SurfaceMesh bar{
      {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {0, 1, 1}},
      {},
      {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4}, {3, 7, 6}, {3, 6, 2}, {0, 4, 7}, {0, 7, 3}, {1, 2, 6}, {1, 6, 5}}};
  std::vector<std::string> seeds;
  const std::vector<std::pair<std::string, std::string>> small{{"rays", "16"}, {"voxels", "12"}};
  std::vector<std::vector<std::pair<std::string, std::string>>> bakes{{},
                                                                      {{"lobe", "fit"}},
                                                                      {{"basis", "sh1"}},
                                                                      {{"method", "rays"}, {"attribute", "true"}},
                                                                      {{"lobe", "fit"}, {"fit-to", "volume"}, {"octaves", "2"}}};
  if (hasCgal()) bakes.push_back({{"smooth", "1"}, {"close", "wrap"}});
  for (const auto& options : bakes) {
    auto all = small;
    all.insert(all.end(), options.begin(), options.end());
    seeds.push_back(bake(bar, all).glb);
  }
  return seeds;
}

std::vector<std::string> vdbSeeds() {
  initializeVdb();
  const auto ball = ballGrid(false), fog = ballGrid(true);
  auto moved = fog->deepCopy();
  vdb::Mat4d matrix = vdb::Mat4d::identity();
  matrix.setToScale(vdb::Vec3d(0.5));
  matrix.setTranslation(vdb::Vec3d(1, 2, 3));
  moved->setTransform(vdb::math::Transform::createLinearTransform(matrix));
  auto halves = ball->deepCopy();
  halves->setSaveFloatAsHalf(true);
  auto clipped = ball->deepCopy();  // its band is open, beside an inside tile
  clipped->tree().clip({{0, 0, 0}, {7, 7, 3}});
  clipped->tree().addTile(1, {0, 8, 0}, -kBandHalfWidth_voxels, false);
  auto tile = vdb::FloatGrid::create(0);
  tile->setGridClass(vdb::GRID_FOG_VOLUME);
  tile->fill(vdb::CoordBBox({0, 0, 0}, {7, 7, 7}), 1);
  auto doubles = vdb::DoubleGrid::create(std::make_shared<vdb::DoubleTree>(fog->tree()));
  doubles->setGridClass(vdb::GRID_FOG_VOLUME);
  doubles->setName("doubles");
  constexpr uint32_t kMask = vdb::io::COMPRESS_ACTIVE_MASK, kZip = vdb::io::COMPRESS_ZIP | kMask;
  return {streamed({ball}, kZip),    streamed({fog}, kMask), streamed({moved}, kZip), streamed({halves}, kMask), streamed({tile}, kZip),
          streamed({doubles}, kZip), asFile({fog, ball}),    asFile({halves}),        streamed({clipped}, kZip)};
}

std::vector<std::string> latticeSeeds() {
  std::vector<std::string> seeds;
  for (const int order : {1, 3}) {
    HarmonicLattice lattice{{-1, 0, 1}, 0.5F, {2, 3, 2}, order, 1.5F, {}};
    lattice.coefficients.assign(12 * size_t(order + 1) * size_t(order + 1), 0.25F);
    const std::vector<LatticeFile> files = encodeLattice(lattice, "a");
    std::string seed = files.back().bytes + "\n";
    for (size_t t = 0; t < 4; ++t) seed += files[std::min(t, files.size() - 2)].bytes;
    seeds.push_back(std::move(seed));
  }
  return seeds;
}

std::vector<std::string> sceneSeeds() {
  std::vector<std::string> seeds = textsOf("data/scenes");
  seeds.push_back(
      "[sun]\nhour = 20\nday_seconds = 60\n[sky.moon]\npicture = 'moon.png'\nphase = 60\nup = [1, 0, 0]\n[[sky.hours]]\nelevation = "
      "-8\nsun = [0, 0, 1]\n"
      "[[sky.hours]]\nelevation = 30\nzenith = [0.05, 0.1, 0.35]\n[sky.stars]\ncount = 9\nturn = 3\n[sky.aurora]\ntop = "
      "60\n[[dust]]\nlattice = 'a.json'\nscale = 2\n");
  return seeds;
}

std::vector<std::string> tomlSeeds() {
  std::vector<std::string> seeds = textsOf("data/presets");
  seeds.push_back(
      "premise = 'F'\nrules = ['F=FF', \"F=A\"]\ngenerations = 3\ninner_shape = [[0, 0, 0, 1], [1, 0.5, -1, 2]]\n"
      "variables = {c = 0x10, 'd' = -1_000.5e-3}\nspheres.domain = [1, 2, 3]\nturtle.angle = 30 # \xC3\xA4\n");
  return seeds;
}

std::vector<std::string> manifestSeeds() {
  return {
      "name = '{stem}.glb'\n[defaults]\nrays = 64\nlobe = 'fit'\n[scene.camera]\ndistance = 200\nfov = 50.5\n[scene.picture]\nheight = "
      "1080\n[scene.sun]\nelevation = [5, 60]\n[[cloud]]\npreset = 'humilis'\nseeds = '1-12'\nname = 'humilis/{seed}.glb'\n"
      "vertices = 8000\n",
      "[[cloud]]\nsculpt = ['a/**/*.fbx', \"*.obj\"] # \xC3\xA4\nrepair = ['orient', 'fill']\nseparate = true\n[[cloud]]\nrules = "
      "'r.txt'\nseeds = [1, 5]\n",
      "[[cloud]]\nfrom_spheres = 'a.csv'\nblend = 0.02\nsun_azimuth = '0:90'\n"};
}

std::vector<std::string> batchReportSeeds() {
  BatchReport report;
  report.source = "clouds.toml";
  report.output = "baked";
  report.shard = 1, report.shards = 4;
  AssetRecord asset;
  asset.name = "a/b.glb";
  asset.source = "preset humilis, seed 7";
  asset.state = AssetState::kBaked;
  asset.reason = "new";
  asset.key = std::string(64, 'a');
  asset.report = {{"schema", "cloudbake-report-1"}, {"vertices", 12}, {"warnings", Json::array()}};
  asset.figures = BakeFigures{};
  report.assets = {asset, {}};
  report.assets[1].name = "c.glb";
  report.assets[1].state = AssetState::kFailed;
  report.assets[1].code = 3;
  report.assets[1].error = "c.obj:3: not a number: remove it";
  report.removed = {"old.glb"};
  return {batchJson(report), batchJson({})};
}

}  // namespace cloudbake
