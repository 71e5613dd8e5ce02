// Reads all formats without a reader of our own, by assimp 5.2. Its behaviour was tested with its own test models. It applies node
// transforms. It converts Collada to +Y up and metres. For FBX it reports axes and unit as metadata and applies neither, so both are
// applied here ("UpAxis", "CoordAxis": 0 x, 1 y, 2 z; "UnitScaleFactor": centimetres per unit, FBX SDK documentation, FbxGlobalSettings
// and FbxSystemUnit). It gives every polygon corner its own vertex, except for PLY.
#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <assimp/version.h>

#include <array>
#include <assimp/Importer.hpp>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/triangulate.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

using CornerBits = std::array<uint32_t, 8>;  // position, normal, UV

struct CornerBitsHash {
  size_t operator()(const CornerBits& bits) const {
    uint64_t h = 0;
    for (const uint32_t b : bits) h = (h ^ b) * 0x9E3779B97F4A7C15ULL, h ^= h >> 29;
    return size_t(h);
  }
};

Vec3 toVec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Affine toAffine(const aiMatrix4x4& m) { return {{{{m.a1, m.a2, m.a3}, {m.b1, m.b2, m.b3}, {m.c1, m.c2, m.c3}}}, {m.a4, m.b4, m.c4}}; }

Affine scaled(Affine frame, double scale) {
  for (auto& row : frame.linear)
    for (double& value : row) value *= scale;
  return frame;
}

// Axes are given by number: `right` becomes +x, `up` becomes +y, and z completes a right-handed frame.
Affine frameFromAxes(int right, double right_sign, int up, double up_sign) {
  std::array<double, 3> x{}, y{};
  x[size_t(right)] = right_sign;
  y[size_t(up)] = up_sign;
  return {{{x, y, {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]}}}, {0, 0, 0}};
}

int metaInteger(const aiScene& scene, const char* key, int otherwise) {
  int32_t value = otherwise;
  return scene.mMetaData && scene.mMetaData->Get(key, value) ? value : otherwise;
}

// From the file's frame to metres, +Y up.
Affine sceneFrame(const fs::path& file, const std::string& bytes, const aiScene& scene, const std::string& extension,
                  const ReadSettings& settings, std::string& text, Warnings& warnings) {
  int right = 0, up = 1;
  double right_sign = 1, up_sign = 1, unit = 1;
  if (extension == "fbx") {
    right = metaInteger(scene, "CoordAxis", 0), up = metaInteger(scene, "UpAxis", 1);
    right_sign = metaInteger(scene, "CoordAxisSign", 1), up_sign = metaInteger(scene, "UpAxisSign", 1);
    double centimetres = 1;
    float single = 1;
    if (scene.mMetaData && !scene.mMetaData->Get("UnitScaleFactor", centimetres) && scene.mMetaData->Get("UnitScaleFactor", single))
      centimetres = single;
    unit = centimetres / 100;
    if (right < 0 || right > 2 || up < 0 || up > 2 || right == up || std::abs(right_sign) != 1 || std::abs(up_sign) != 1 || !(unit > 0) ||
        !std::isfinite(unit))
      throw InputError(file.string(), "the axes or the unit in the FBX are invalid; export it again");
  }
  // assimp fills in FBX's defaults if a file states nothing, so look for the words themselves.
  const bool says_frame = extension == "fbx" ? bytes.find("UnitScaleFactor") != bytes.npos && bytes.find("UpAxis") != bytes.npos
                                             : extension == "dae" || extension == "zae" || extension == "ply";
  if (!says_frame && !(settings.metres_per_unit && settings.up_axis))
    warnings.add(WarningKind::kUnitsAssumed, file.string() + ": it states no unit or up axis; assumed " +
                                                 (extension == "fbx" ? "centimetres" : "metres") + " and +Y up");

  if (settings.up_axis) {
    up = int(*settings.up_axis), up_sign = 1;
    right = up == 0 ? 1 : 0, right_sign = up == 0 ? -1 : 1;
  }
  const bool given = settings.up_axis || settings.metres_per_unit;
  text = frameText(settings.metres_per_unit.value_or(unit), "XYZ"[up], up_sign < 0,
                   settings.up_axis && settings.metres_per_unit ? "as given"
                   : given      ? (says_frame ? "one given, the other as the file says" : "one given, the other assumed")
                   : says_frame ? "as the file says"
                                : "assumed, the file does not say");
  return scaled(frameFromAxes(right, right_sign, up, up_sign), settings.metres_per_unit.value_or(unit));
}

CornerBits bitsOf(const SculptPart& part, size_t vertex) {
  CornerBits bits{};
  const auto put = [&](size_t at, float value) { bits[at] = std::bit_cast<uint32_t>(value + 0.0F); };  // −0 counts as 0
  const Vec3 p = part.positions[vertex], n = part.normals.empty() ? Vec3{} : part.normals[vertex];
  const Vec2 uv = part.uvs.empty() ? Vec2{} : part.uvs[vertex];
  put(0, p.x), put(1, p.y), put(2, p.z), put(3, n.x), put(4, n.y), put(5, n.z), put(6, uv.x), put(7, uv.y);
  return bits;
}

// Makes one vertex per distinct corner, in order of first use by a triangle.
SculptPart weldCorners(const SculptPart& split) {
  SculptPart part{split.name, {}, {}, {}, {}, split.to_scene, split.object};
  std::unordered_map<CornerBits, uint32_t, CornerBitsHash> known;
  for (const Triangle& triangle : split.triangles) {
    Triangle welded;
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t from = triangle[corner];
      const auto [entry, added] = known.try_emplace(bitsOf(split, from), uint32_t(part.positions.size()));
      welded[corner] = entry->second;
      if (!added) continue;
      part.positions.push_back(split.positions[from]);
      if (!split.normals.empty()) part.normals.push_back(split.normals[from]);
      if (!split.uvs.empty()) part.uvs.push_back(split.uvs[from]);
    }
    part.triangles.push_back(welded);
  }
  return part;
}

// Converts one mesh as stored, with polygons cut into triangles.
SculptPart partFromMesh(const fs::path& file, const aiMesh& mesh, Warnings& warnings) {
  SculptPart part;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    part.positions.push_back(toVec3(mesh.mVertices[i]));
    if (mesh.HasNormals()) part.normals.push_back(toVec3(mesh.mNormals[i]));
    // In assimp v grows upwards.
    if (mesh.HasTextureCoords(0)) part.uvs.push_back({mesh.mTextureCoords[0][i].x, 1 - mesh.mTextureCoords[0][i].y});
  }
  uint64_t flat = 0, crossed = 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    for (unsigned k = 0; k < face.mNumIndices; ++k)
      if (face.mIndices[k] >= mesh.mNumVertices)
        throw InputError(file.string(), "face " + std::to_string(f) + " uses vertex " + std::to_string(face.mIndices[k]) + " of " +
                                            std::to_string(mesh.mNumVertices) + "; the file is damaged, export it again");
    if (face.mNumIndices < 3)
      ++flat;
    else
      crossed += !triangulatePolygon({face.mIndices, face.mNumIndices}, part.positions, part.triangles);
  }
  warnings.add(WarningKind::kPartIgnored, file.string() + ": points and lines have no surface and were ignored", flat);
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": polygons that intersect themselves were cut as a fan", crossed);
  warnings.add(WarningKind::kPoseIgnored, file.string() + ": bones or morph targets are ignored; the stored pose was read",
               mesh.HasBones() || mesh.mNumAnimMeshes > 0);
  return part;
}

// Parts in order of the nodes, depth first. The stack is explicit, because a file may be nested arbitrarily deep.
void collectParts(const fs::path& file, const aiScene& scene, const Affine& frame, bool weld, Sculpt& sculpt, Warnings& warnings) {
  struct Visit {
    const aiNode* node;
    Affine parent;
  };
  std::vector<Visit> stack{{scene.mRootNode, frame}};
  int object = 0;
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const Affine to_scene = compose(visit.parent, toAffine(visit.node->mTransformation));
    for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
      SculptPart part = partFromMesh(file, *scene.mMeshes[visit.node->mMeshes[i]], warnings);
      if (part.triangles.empty()) continue;
      part.name = visit.node->mName.C_Str();
      part.to_scene = to_scene;
      part.object = object;
      sculpt.parts.push_back(weld ? weldCorners(part) : std::move(part));
    }
    ++object;
    for (unsigned i = visit.node->mNumChildren; i-- > 0;) stack.push_back({visit.node->mChildren[i], to_scene});
  }
}

// Lets the library open only the file itself and files in its folder or below.
class FolderOnly : public Assimp::DefaultIOSystem {
 public:
  explicit FolderOnly(fs::path file) : file_(std::move(file)) {}
  bool Exists(const char* name) const override { return liesBeside(file_, name) && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return liesBeside(file_, name) ? DefaultIOSystem::Open(name, mode) : nullptr;
  }

 private:
  fs::path file_;
};

}  // namespace

Sculpt readWithAssimp(const fs::path& file, const std::string& bytes, const std::string& extension, const ReadSettings& settings,
                      Warnings& warnings) {
  Assimp::Importer importer;
  if (extension.empty() || !importer.IsExtensionSupported("." + extension))
    throw InputError(file.string(), (extension.empty() ? "the file has no extension" : "'." + extension + "' is not a known mesh format") +
                                        "; export the sculpt as glTF, FBX, OBJ, PLY, STL or OFF");
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES,
                           true);  // otherwise it makes meshes for the bones, cameras and lights of a file without meshes
  if (!settings.allow_outside) importer.SetIOHandler(new FolderOnly(file));  // the importer owns it
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (!scene || !scene->mRootNode)
    throw InputError(file.string(), std::string("cannot be read: ") + importer.GetErrorString() + "; export it again");
  warnings.add(WarningKind::kPoseIgnored, file.string() + ": animations are ignored; the stored pose was read", scene->mNumAnimations);

  Sculpt sculpt;
  const Affine frame = sceneFrame(file, bytes, *scene, extension, settings, sculpt.frame_note, warnings);
  collectParts(file, *scene, frame, extension != "ply", sculpt, warnings);
  return sculpt;
}

std::string assimpVersion() {
  return std::to_string(aiGetVersionMajor()) + "." + std::to_string(aiGetVersionMinor()) + "." + std::to_string(aiGetVersionPatch());
}

}  // namespace cloudbake
