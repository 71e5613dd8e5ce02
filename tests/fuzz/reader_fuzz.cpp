// Every reader of ours on bytes, and the promises of its header on what it read.
#include "tests/fuzz/reader_fuzz.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "core/level_set_type.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/write.h"
#include "io/gltf/document.h"
#include "io/image/image.h"
#include "io/report/batch_report.h"
#include "io/sculpt/check_xml.h"
#include "io/sculpt/fbx_models.h"
#include "io/sculpt/file_frame.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/referenced_files.h"
#include "io/volume/lattice.h"
#include "io/volume/spheres.h"
#include "io/volume/vdb.h"
#include "lsystem/recipe.h"
#include "pipeline/batch/manifest.h"
#include "pipeline/scene/scene_file.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "/nonexistent/";  // so that no file lies beside the input

void require(bool holds, const char* what) { requirePromise(holds, what); }

template <class Read>
bool succeeds(const Read& read, std::string& message) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    message = error.what();
    return false;
  }
}

// --- Sculpts ---

void checkMaterials(const Sculpt& sculpt) {
  for (size_t i = 0; i < sculpt.nodes.size(); ++i) require(sculpt.nodes[i].parent < int(i), "a node comes before its parent");
  const auto within = [](auto x) { return x >= 0 && x <= 1; };
  for (const SculptMaterial& m : sculpt.materials) {
    for (const float c : m.base_color) require(within(c), "a colour is out of range");
    for (const float c : m.emission) require(c >= 0 && std::isfinite(c), "an emission is out of range");
    require(within(m.metallic) && within(m.roughness) && std::isfinite(m.normal_scale), "a value of a material is out of range");
    for (const SculptTexture* t :
         {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.occlusion_texture, &m.emissive_texture}) {
      require(t->image < int(sculpt.images.size()), "a texture has no such image");
      for (const float x : {t->offset.x, t->offset.y, t->scale.x, t->scale.y}) require(std::isfinite(x), "a texture is nowhere");
    }
  }
}

void checkSculpt(const Sculpt& sculpt) {
  size_t triangles = 0;
  for (const SculptPart& part : sculpt.parts) {
    const size_t count = part.positions.size();
    require(part.normals.empty() || part.normals.size() == count, "the number of normals differs");
    require(part.uvs.empty() || part.uvs.size() == count, "the number of UVs differs");
    require(part.vertex_to_scene.empty() || part.vertex_to_scene.size() == count, "the number of maps differs");
    for (size_t v = 0; v < count; ++v) {
      const Vec3 p = part.positions[v];
      require(isFinite(p) && isFinite(transformPoint(part.toScene(v), p)), "a position is not finite");
      require(inverted(part.toScene(v)).has_value(), "a transform is singular");
    }
    for (const Vec3& n : part.normals) require(std::fabs(length(n) - 1) < 1e-4F, "a normal is no unit vector");
    for (const Vec2& uv : part.uvs) require(std::isfinite(uv.x) && std::isfinite(uv.y), "a UV is not finite");
    for (const Triangle& triangle : part.triangles)
      for (const uint32_t index : triangle) require(index < count, "an index is out of range");
    triangles += part.triangles.size();
    require(part.colors.empty() || part.colors.size() == count, "the number of colours differs");
    for (const auto& uvs : part.more_uvs) require(uvs.size() == count, "the number of further UVs differs");
    require(part.node < int(sculpt.nodes.size()) && part.material < int(sculpt.materials.size()), "a part has no such node or material");
  }
  checkMaterials(sculpt);
  require(triangles > 0, "there are no triangles");
  for (const Vec3& p : surfaceInScene(sculpt).positions) require(isFinite(p), "a position is not finite in the scene");
}

template <char... extension>
bool runMesh(const std::string& bytes, std::string& message) {
  constexpr char kName[] = {'a', '.', extension..., '\0'};
  return succeeds(
      [&] {
        Warnings warnings;
        checkSculpt(readMesh(fs::path(kFolder) / kName, bytes, {}, warnings));
      },
      message);
}

// A folder in memory, because a material library is a file beside its sculpt.
struct LibraryFolder {
  LibraryFolder() {
    std::string name = "/dev/shm/cloudbake-fuzz-XXXXXX";
    require(::mkdtemp(name.data()), "there is no folder in memory");
    path = name;
    std::ofstream(path / "dot.png", std::ios::binary) << encodePng({1, 1, {{0, 0, 0}}});
  }
  ~LibraryFolder() { fs::remove_all(path); }
  fs::path path;
};

bool runMtl(const std::string& bytes, std::string& message) {
  static const LibraryFolder folder;
  std::ofstream(folder.path / "a.mtl", std::ios::binary) << bytes;
  return succeeds(
      [&] {
        Warnings warnings;
        const std::string obj = "mtllib a.mtl\n" + objSeeds()[0] + "usemtl a\nf 1 3 2\nusemtl b c\nf 1 2 4\n";
        const fs::path file = folder.path / "a.obj";
        const bool is_strict = bytes.size() % 16 == 0;  // seldom, because most of the time goes into looking where files lie
        ReadSettings settings;
        settings.allow_outside = !is_strict;
        checkSculpt(readMesh(file, obj, settings, warnings));
        if (!is_strict) return;
        for (const fs::path& named : referencedFiles(file, obj, {}))
          require(named == folder.path / "a.mtl" || liesBeside(file, named), "a file outside the folder is named");
      },
      message);
}

// What we read of an FBX; assimp reads the rest, in a process of its own.
bool runFbx(const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        const FbxModels models = readFbxModels("a.fbx", bytes);
        frameOfFbx("a.fbx", models.settings);
        for (const size_t root : models.roots) require(root < models.models.size(), "a root is no model");
        for (const FbxModel& model : models.models) {
          bool hides = false;
          model.isHidden(false, hides);
          const FbxPlace place = placeFbxModel(model, {});
          for (const size_t child : model.children) {
            require(child < models.models.size(), "a child is no model");
            placeFbxModel(models.models[child], place);
          }
        }
      },
      message);
}

// Archives and their XML.
bool run3mf(const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        Warnings warnings;
        const std::string model = bytes.starts_with("PK") ? modelOf3mf("a.3mf", bytes, 1 << 20) : bytes;
        check3mf("a.3mf", model, warnings);
        checkAmf("a.amf", model);
        checkCollada("a.dae", model);
        const double metres = frameOf3mf("a.3mf", model).metres_per_unit;
        require(metres > 0 && metres <= 1, "no unit of the format");
      },
      message);
}

// --- glTF ---

// What is read is written with some lobe, and that read as a baked asset.
void writeAgain(const fs::path& file, const Sculpt& sculpt) {
  size_t vertices = 0;
  std::vector<std::vector<Lobe>> lobes;
  for (const SculptPart& part : sculpt.parts) {
    lobes.emplace_back(part.positions.size(), Lobe{{0, 0, 1}, 0.5F});
    vertices += part.positions.size();
  }
  Warnings warnings;
  GltfSettings settings;
  settings.attribute = vertices % 2 == 1;
  settings.keep_alive_texture = KeepAliveTexture(vertices % 3);
  const std::string glb = encodeGlb(sculpt, lobes, {}, settings, warnings);
  try {
    require(decodeGlb(file, glb, warnings).lobes.size() == vertices, "a written asset has another number of lobes");
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    require(false, "what was written cannot be read");
  }
}

bool runGltf(const std::string& bytes, std::string& message) {
  const fs::path file = fs::path(kFolder) / (bytes.starts_with("glTF") ? "a.glb" : "a.gltf");
  Warnings warnings;
  ReadSettings settings;
  settings.memory_limit = 64 << 20;
  try {
    std::string other_message;
    succeeds([&] { decodeGlb(file, bytes, warnings, settings); }, other_message);
    ReadSettings animated = settings;
    animated.moment = {"", 0.4};
    succeeds([&] { checkSculpt(readMesh(file, bytes, animated, warnings)); }, other_message);
    return succeeds(
        [&] {
          const Sculpt sculpt = readMesh(file, bytes, settings, warnings);
          checkSculpt(sculpt);
          writeAgain(file, sculpt);
        },
        message);
  } catch (const IoError& error) {  // a buffer beside the file
    message = error.what();
    return false;
  }
}

// A number of the JSON becomes another.
std::string changeNumber(std::string json, uint64_t draw) {
  constexpr std::array<const char*, 12> kNumbers{"0",          "1",    "-1",   "2",    "65536", "2147483647",
                                                 "4294967295", "1e39", "1e-9", "5123", "5126",  "18446744073709551615"};
  const size_t begin = json.find_first_of("0123456789", json.empty() ? 0 : draw % json.size());
  if (begin == std::string::npos) return json;
  const size_t end = std::min(json.find_first_not_of("0123456789.", begin), json.size());
  return json.replace(begin, end - begin, kNumbers[(draw >> 32) % kNumbers.size()]);
}

// The container stays whole, so that what is damaged is the document or its buffer.
std::string mutateGltf(std::string bytes, uint64_t draw, const Damage& damage) {
  const uint64_t kind = draw % 16, rest = draw >> 4;
  if (kind == 0) return damage(std::move(bytes));
  GlbChunks chunks;
  try {
    chunks = splitGlb("", bytes);
  } catch (const InputError&) {
    return damage(std::move(bytes));
  }
  std::string json(chunks.json), binary(chunks.binary);
  if (kind < 3)
    binary = damage(std::move(binary));
  else if (kind < 6)
    json = changeNumber(std::move(json), rest);
  else
    json = damage(std::move(json));
  return bytes.starts_with("glTF") ? joinGlb("", json, binary) : json;
}

// --- Volumes ---

bool runVdb(const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        VdbSettings settings;
        settings.memory_limit = 32 << 20;
        Warnings warnings;
        const LevelSet level_set = decodeVdb("a.vdb", bytes, settings, warnings).level_set;
        require(level_set.grid && level_set.grid->vdb, "there is no level set");
        require(std::isfinite(level_set.frame.voxel_size) && level_set.frame.voxel_size > 0, "the voxels have no size");
        for (const double x : level_set.frame.origin) require(std::isfinite(x), "the origin is not finite");
        require(level_set.grid->vdb->background() == kBandHalfWidth_voxels, "the background is not the band's half width");
        require(level_set.grid->vdb->activeVoxelCount() > 0, "the level set is empty");
        for (auto leaf = level_set.grid->vdb->tree().cbeginLeaf(); leaf; ++leaf)
          for (auto value = leaf->cbeginValueAll(); value; ++value)
            require(std::fabs(*value) <= kBandHalfWidth_voxels, "a distance is beyond the band, or none");
      },
      message);
}

// --- Spheres ---

bool runSpheres(const char* name, const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        constexpr size_t kMost = 100;
        const std::vector<Sphere> spheres = decodeSpheres(name, bytes, kMost);
        require(!spheres.empty() && spheres.size() <= kMost, "the number of spheres is out of range");
        for (const Sphere& s : spheres)
          require(isFinite(s.center) && std::isfinite(s.radius) && s.radius > 0, "a sphere is not finite or has no radius");
        const std::vector<Sphere> again = decodeSpheres(name, encodeSpheres(spheres, sphereFormatOf(name)), kMost);
        require(again.size() == spheres.size() && std::memcmp(again.data(), spheres.data(), again.size() * sizeof(Sphere)) == 0,
                "what was written reads back as other spheres");
      },
      message);
}

// --- Lattices ---

// The description, and after each "\n\n" a texture.
bool runLattice(const std::string& bytes, std::string& message) {
  const size_t end = bytes.find("\n\n");
  const std::string textures = end == std::string::npos ? "" : bytes.substr(end + 2);
  return succeeds(
      [&] {
        const HarmonicLattice lattice = decodeLattice(fs::path(kFolder) / "a.json", bytes.substr(0, end), [&](const std::string& name) {
          const size_t number = name.size() > 2 ? size_t(name[2] - '0') % 4 : 0;  // a.0.ktx2
          const size_t each = textures.size() / 4;
          return textures.substr(number * each, each);
        });
        const size_t cells = size_t(lattice.cells[0]) * size_t(lattice.cells[1]) * size_t(lattice.cells[2]);
        require(lattice.coefficients.size() == cells * size_t(lattice.order + 1) * size_t(lattice.order + 1), "a coefficient is missing");
        for (const float coefficient : lattice.coefficients) require(std::isfinite(coefficient), "a coefficient is not finite");
        require(std::isfinite(latticeTransmittance(lattice, {0.1F, 0.2F, 0.3F}, {0.6F, 0.8F, 0})), "the light is not finite");
      },
      message);
}

// --- Scenes ---

bool runScene(const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        const SceneFile scene = readSceneFile("a.toml", bytes, [](const PictureSettings& view) { return view; });
        require(scene.view.width > 0 && scene.view.height > 0, "the picture has no size");
        require(std::isfinite(scene.view.time_seconds) && isFinite(scene.light.sky.to_sun), "the time or the sun is nowhere");
        require(std::fabs(length(scene.light.sky.to_sun) - 1) < 1e-4F, "the direction to the sun is no unit vector");
        for (const SceneCloud& cloud : scene.clouds) {
          require(cloud.file.empty() != cloud.preset.empty(), "a cloud has no source, or two");
          require(inverted(cloud.to_world).has_value(), "a cloud's placement is singular");
        }
        for (const SlabSettings& slab : scene.slabs) require(slab.bottom < slab.center && slab.center < slab.top, "a slab is upside down");
        for (const SceneDust& dust : scene.dust) require(inverted(dust.to_world).has_value(), "the dust's placement is singular");
        const std::vector<SkyHour>& hours = scene.light.sky.ramp.hours;
        for (size_t i = 1; i < hours.size(); ++i) require(hours[i - 1].sun_height < hours[i].sun_height, "the hours are out of order");
      },
      message);
}

// --- Recipes ---

bool runToml(const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        Warnings warnings;
        parseGrammar(parseRecipe(bytes, "a.toml").grammar, warnings);
      },
      message);
}

// --- Batches ---

bool runManifest(const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        const Manifest manifest = parseManifest(bytes, "a.toml");
        require(!manifest.clouds.empty(), "there is no cloud");
        for (const ManifestCloud& cloud : manifest.clouds) {
          require(cloud.line > 0 && !cloud.sources.empty() && !cloud.sources[0].value.empty(), "a cloud has no place or no source");
          require(cloud.kind == SourceKind::kSculpt || cloud.sources.size() == 1, "a cloud has two sources");
          for (const ManifestValue& option : cloud.options) require(option.line > 0 && option.column > 0, "an option has no place");
        }
        const Box box{{0, 0, 0}, {1, 1, 1}};
        if (manifest.scene)
          require(pixelSize(*manifest.scene, box) > 0 && std::isfinite(pixelSize(*manifest.scene, box)),
                  "a pixel of the scene has no size");
      },
      message);
}

bool runBatchReport(const std::string& bytes, std::string& message) {
  return succeeds(
      [&] {
        const std::string text = batchJson(readBatchJson(bytes, "a.json"));
        require(batchJson(readBatchJson(text, "a.json")) == text, "what was written reads back as another report");
      },
      message);
}

}  // namespace

void requirePromise(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "reader_fuzz: %s\n", what);
  std::abort();
}

// OpenVDB forgets the node under way where a file ends early.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer looks for this name
extern "C" const char* __lsan_default_suppressions() { return "leak:readTopology\n"; }

std::span<const ReaderTarget> readerTargets() {
  static const std::vector<std::string> kGltfTokens{"\"nodes\":",
                                                    "\"meshes\":",
                                                    "\"primitives\":",
                                                    "\"attributes\":",
                                                    "\"POSITION\":",
                                                    "\"NORMAL\":",
                                                    "\"TEXCOORD_0\":",
                                                    "\"targets\":",
                                                    "\"weights\":",
                                                    "\"accessors\":",
                                                    "\"bufferView\":",
                                                    "\"bufferViews\":",
                                                    "\"byteOffset\":",
                                                    "\"byteStride\":",
                                                    "\"componentType\":",
                                                    "\"sparse\":",
                                                    "\"children\":",
                                                    "\"matrix\":",
                                                    "\"skin\":",
                                                    "\"materials\":",
                                                    "\"extensions\":",
                                                    "\"uri\":",
                                                    "\"images\":",
                                                    "\"extras\":",
                                                    "null",
                                                    "[]",
                                                    "{}",
                                                    "\"\"",
                                                    "-1",
                                                    "true",
                                                    ",",
                                                    "\"mode\":5",
                                                    "\"JOINTS_0\":",
                                                    "\"WEIGHTS_0\":",
                                                    "\"inverseBindMatrices\":",
                                                    "\"animations\":",
                                                    "\"samplers\":",
                                                    "\"interpolation\":\"CUBICSPLINE\"",
                                                    "\"path\":\"weights\"",
                                                    "\"EXT_meshopt_compression\":",
                                                    "\"KHR_draco_mesh_compression\":",
                                                    "\"EXT_mesh_gpu_instancing\":",
                                                    "\"filter\":\"EXPONENTIAL\"",
                                                    "\"filter\":\"OCTAHEDRAL\"",
                                                    "\"filter\":\"QUATERNION\"",
                                                    "\"ATTRIBUTES\"",
                                                    "\"INDICES\"",
                                                    "DRACO"};
  static const std::vector<std::string> kAssetTokens{"\"extras\":",
                                                     "\"cloudbake\":",
                                                     "\"layout\":",
                                                     "\"version\":",
                                                     "\"uv_sets\":",
                                                     "\"lobe\":\"fit\"",
                                                     "\"lobe\":\"mean\"",
                                                     "\"exponent\":",
                                                     "\"bias\":",
                                                     "\"extinction\":",
                                                     "\"rays\":",
                                                     "\"ray_length\":",
                                                     "\"voxel_size\":",
                                                     "\"harmonic_order\":",
                                                     "\"separate\":true",
                                                     "\"smooth\":",
                                                     "\"seal\":",
                                                     "\"fit_to\":\"volume\"",
                                                     "\"method\":\"rays\"",
                                                     "\"extinction_range\":[",
                                                     "\"TEXCOORD_0\":",
                                                     "\"TEXCOORD_1\":",
                                                     "\"POSITION\":",
                                                     "\"indices\":",
                                                     "\"_TRANSMITTANCE_SH_0\":",
                                                     "\"octaves\":",
                                                     "\"sun_elevation\":[",
                                                     "\"close\":\"wrap\"",
                                                     "null",
                                                     "[]",
                                                     "{}",
                                                     "-1",
                                                     "1e39"};
  static const std::vector<ReaderTarget> targets{
      {"obj",
       runMesh<'o', 'b', 'j'>,
       objSeeds,
       {"v ", "vt ", "vn ", "f ", "\nf 1 2 3", "1/1/1", "-1//-1", "\\\n", "g a", "usemtl a", "mtllib a"}},
      {"mtl", runMtl, mtlSeeds, {"newmtl a\n",    "newmtl b c\n",      "Kd ",        "Ks ",     "Ke ",     "Ns ",     "Ni ",        "d ",
                                 "Tr ",           "illum 3\n",         "Pr ",        "Pm ",     "map_Kd ", "map_Ke ", "map_d ",     "norm ",
                                 "map_Bump -bm ", "map_Kd -o 1 2 -s ", "-clamp on ", "dot.png", "1e39",    "nan",     "../dot.png", "\\"}},
      {"stl", runMesh<'s', 't', 'l'>, stlSeeds, {"solid", "endsolid", "facet normal", "outer loop", "vertex ", "endloop", "endfacet"}},
      {"off", runMesh<'o', 'f', 'f'>, offSeeds, {"OFF", "STCNOFF", "COFF", "BINARY", "# ", "3 0 1 2"}},
      {"ply",
       runMesh<'p', 'l', 'y'>,
       plySeeds,
       {"element ", "property ", "list ", "uchar ", "double ", "format ", "ascii", "binary_big_endian", "end_header\n", "vertex",
        "material", "texcoord\n", "texnumber\n", "material_index\n", "red\n", "comment TextureFile dot.png\n"}},
      {"fbx",
       runFbx,
       fbxSeeds,
       {"Model: ", "Objects: {", "Connections: {", "Properties70: {", "P: ", "\"Visibility\"", "\"InheritType\"", "C: \"OO\",", "}", "{",
        "\"", "; ", "1e999", "nan", "\xFF\xFF\xFF\xFF", std::string(13, '\0'), "L", "D", "S"}},
      {"3mf", run3mf, printedSeeds, {"PK\1\2",        "PK\3\4",    "PK\5\6",      "<model ",
                                     "unit=\"inch\"", "<item ",    "<component ", "transform=\"",
                                     "<object ",      "</object>", "<triangle ",  "<!--",
                                     "-->",           "<![CDATA[", "]]>",         "p:path=\"",
                                     "<rz>1</rz>",    "'",         "\"",          "/>"}},
      {"spheres_ply",
       [](const std::string& bytes, std::string& message) { return runSpheres("a.ply", bytes, message); },
       spherePlySeeds,
       {"element vertex ", "property ", "list ", "uint8 ", "double ", "ascii", "binary_little_endian", "end_header\n", "pscale", "radius"}},
      {"spheres_csv",
       [](const std::string& bytes, std::string& message) { return runSpheres("a.csv", bytes, message); },
       sphereCsvSeeds,
       {"P[x]", "Px", "P[0]", "pscale", "radius", "\"", ";", ",", "\t", "\n#", "\r\n", "\xEF\xBB\xBF"}},
      {"gltf", runGltf, gltfSeeds, kGltfTokens, mutateGltf},
      {"check", runCheckTarget, assetSeeds, kAssetTokens, mutateGltf, 20},
      {"preview", runPreviewTarget, assetSeeds, kAssetTokens, mutateGltf},
      {"view", runViewTarget, assetSeeds, kAssetTokens, mutateGltf},
      {"vdb",
       runVdb,
       vdbSeeds,
       {"level set", "fog volume", "unknown", "Tree_float_5_4_3", "Tree_double_5_4_3", "UniformScaleMap", "AffineMap", "class"},
       nullptr,
       4},  // a band that is not closed is made anew
      {"lattice",
       runLattice,
       latticeSeeds,
       {"\"order\":", "\"cells\":", "\"origin\":", "\"textures\":", "\"extinction\":", "\"cell_size\":", "1024", "1e39", "[]", "null",
        "a.1.ktx2"}},
      {"scene",
       runScene,
       sceneSeeds,
       {"[camera]\n", "[sun]\n", "[sky.moon]\n", "[[sky.hours]]\n", "[terrain.light]\n", "[[slab]]\n", "[[marched]]\n", "[[dust]]\n",
        "[chain]\n", "as_published = true\n", " = ", "inf", "nan", "1e39", "-1", "[0, 0, 0]", "[[", "]]"}},
      {"toml",
       runToml,
       tomlSeeds,
       {"[turtle]\n", "[spheres]\n", "[limits]\n", "[bake]\n", "[variables]\n", "'''", "\"\"\"", " = ", "inf", "nan", "0x", "1979-05-27",
        "[[", "]]", "\\u00e9"}},
      {"manifest",
       runManifest,
       manifestSeeds,
       {"[[cloud]]\n", "[defaults]\n", "[scene]\n", "preset = ", "sculpt = ", "seeds = ", "'1-3'", "name = ", "distance = ", "inf", "nan",
        "0x", "1979-05-27", "[[", "]]"}},
      {"batch_report",
       runBatchReport,
       batchReportSeeds,
       {"\"schema\":", "\"assets\":", "\"state\":", "\"key\":", "\"report\":", "\"figures\":", "\"seconds\":", "null", "[]", "{}", "-1",
        "1e999", "\"fresh\"", "18446744073709551615"}},
  };
  return targets;
}

const ReaderTarget* findReaderTarget(std::string_view name) {
  for (const ReaderTarget& target : readerTargets())
    if (target.name == name) return &target;
  return nullptr;
}

}  // namespace cloudbake
