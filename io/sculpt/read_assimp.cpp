// Reads all formats without a reader of our own, by assimp 5.2. Its behaviour was tested with its own test models. It applies node
// transforms. It converts Collada to +Y up and metres. For FBX it reports axes and unit as metadata and applies neither, so both are
// applied here ("UpAxis", "CoordAxis": 0 x, 1 y, 2 z; "UnitScaleFactor": centimetres per unit, FBX SDK documentation, FbxGlobalSettings
// and FbxSystemUnit). It gives every polygon corner its own vertex, except for PLY. It splits a pivoted FBX node into a chain of helper
// nodes, which are joined again here. Its materials are converted by io/sculpt/assimp_materials.h.
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <assimp/version.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <bit>
#include <cmath>
#include <memory>
#include <unordered_map>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/file/neighbour.h"
#include "io/file/write_file.h"
#include "io/sculpt/assimp_materials.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/triangulate.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

using CornerBits = std::vector<uint32_t>;  // position, normal, UV sets, colour

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
                                             : extension == "dae" || extension == "zae";
  if (!says_frame && !(settings.metres_per_unit && settings.up_axis))
    warnings.add(WarningKind::kUnitsAssumed, unitsAssumedText(file,
                                                              settings.metres_per_unit ? ""
                                                              : extension == "fbx"     ? "centimetres"
                                                                                       : "metres",
                                                              !settings.up_axis));

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

void readBits(const SculptPart& part, size_t vertex, CornerBits& bits) {
  bits.clear();
  const auto put = [&](float value) { bits.push_back(std::bit_cast<uint32_t>(value + 0.0F)); };  // −0 counts as 0
  const Vec3 p = part.positions[vertex];
  put(p.x), put(p.y), put(p.z);
  if (!part.normals.empty()) put(part.normals[vertex].x), put(part.normals[vertex].y), put(part.normals[vertex].z);
  if (!part.uvs.empty()) put(part.uvs[vertex].x), put(part.uvs[vertex].y);
  for (const std::vector<Vec2>& set : part.more_uvs) put(set[vertex].x), put(set[vertex].y);
  if (!part.colors.empty())
    for (const float value : part.colors[vertex]) put(value);
}

// A part without vertices and triangles, with room for the same attributes.
SculptPart emptied(const SculptPart& from) {
  SculptPart part;
  part.name = from.name;
  part.to_scene = from.to_scene;
  part.object = from.object;
  part.node = from.node;
  part.material = from.material;
  part.more_uvs.resize(from.more_uvs.size());
  return part;
}

void copyVertex(const SculptPart& from, size_t vertex, SculptPart& to) {
  to.positions.push_back(from.positions[vertex]);
  if (!from.normals.empty()) to.normals.push_back(from.normals[vertex]);
  if (!from.uvs.empty()) to.uvs.push_back(from.uvs[vertex]);
  for (size_t set = 0; set < from.more_uvs.size(); ++set) to.more_uvs[set].push_back(from.more_uvs[set][vertex]);
  if (!from.colors.empty()) to.colors.push_back(from.colors[vertex]);
}

// Makes one vertex per distinct corner, in order of first use by a triangle.
SculptPart weldCorners(const SculptPart& split) {
  SculptPart part = emptied(split);
  std::unordered_map<CornerBits, uint32_t, CornerBitsHash> known;
  CornerBits bits;
  for (const Triangle& triangle : split.triangles) {
    Triangle welded;
    for (int corner = 0; corner < 3; ++corner) {
      readBits(split, triangle[corner], bits);
      const auto [entry, added] = known.try_emplace(bits, uint32_t(part.positions.size()));
      welded[corner] = entry->second;
      if (added) copyVertex(split, triangle[corner], part);
    }
    part.triangles.push_back(welded);
  }
  return part;
}

// UV sets and colours. glTF has no third texture coordinate, no gaps between sets, and engines read one set of colours.
void readSets(const fs::path& file, const aiMesh& mesh, SculptPart& part, Warnings& warnings) {
  uint64_t cubic = 0;
  for (unsigned set = 0; set < mesh.GetNumUVChannels(); ++set) {
    std::vector<Vec2>& uvs = set == 0 ? part.uvs : part.more_uvs.emplace_back();
    cubic += mesh.mNumUVComponents[set] == 3;
    // In assimp v grows upwards.
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) uvs.push_back({mesh.mTextureCoords[set][i].x, 1 - mesh.mTextureCoords[set][i].y});
  }
  warnings.add(WarningKind::kTextureIgnored, file.string() + ": the third coordinate of a UV set is not kept", cubic);
  if (!mesh.HasVertexColors(0)) return;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiColor4D& c = mesh.mColors[0][i];
    part.colors.push_back({c.r, c.g, c.b, c.a});
  }
  warnings.add(WarningKind::kMissingColor, file.string() + ": only the first set of vertex colours is kept",
               mesh.GetNumColorChannels() - 1);
}

// Converts one mesh as stored, with polygons cut into triangles.
SculptPart partFromMesh(const fs::path& file, const aiMesh& mesh, Warnings& warnings) {
  SculptPart part;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    part.positions.push_back(toVec3(mesh.mVertices[i]));
    if (mesh.HasNormals()) part.normals.push_back(toVec3(mesh.mNormals[i]));
  }
  readSets(file, mesh, part, warnings);
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

// Whether a node is one of the helpers that assimp makes of an FBX node's pivots: NAME_$AssimpFbx$_Translation and so on.
bool isPivotHelper(const aiNode& node) { return std::string_view(node.mName.C_Str()).find("_$AssimpFbx$_") != std::string_view::npos; }

// Nodes and their parts, depth first. The stack is explicit, because a file may be nested arbitrarily deep. A helper is joined with the
// node below it, unless it has something else to hold.
void collectNodes(const fs::path& file, const aiScene& scene, const Affine& frame, bool weld, Sculpt& sculpt, Warnings& warnings) {
  struct Visit {
    const aiNode* node;
    int parent;
    Affine before;  // transforms of helpers between the parent and this node, or the frame
  };
  std::vector<Affine> to_scene;
  std::vector<Visit> stack{{scene.mRootNode, -1, frame}};
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const aiNode& node = *visit.node;
    const Affine local = compose(visit.before, toAffine(node.mTransformation));
    const bool is_root = &node == scene.mRootNode && node.mNumChildren > 0;
    if (node.mNumMeshes == 0 && (is_root || (isPivotHelper(node) && node.mNumChildren == 1))) {
      for (unsigned i = node.mNumChildren; i-- > 0;) stack.push_back({node.mChildren[i], visit.parent, local});
      continue;
    }
    const int index = int(sculpt.nodes.size());
    sculpt.nodes.push_back({node.mName.C_Str(), visit.parent, local});
    to_scene.push_back(visit.parent < 0 ? local : compose(to_scene[size_t(visit.parent)], local));
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
      SculptPart part = partFromMesh(file, mesh, warnings);
      if (part.triangles.empty()) continue;
      part.name = node.mName.C_Str();
      part.to_scene = to_scene.back();
      part.object = part.node = index;
      part.material = int(mesh.mMaterialIndex);  // of the scene until keepMaterials
      sculpt.parts.push_back(weld ? weldCorners(part) : std::move(part));
    }
    for (unsigned i = node.mNumChildren; i-- > 0;) stack.push_back({node.mChildren[i], index, {}});
  }
}

// A root that only carries the file's frame and name adds nothing to a file of one mesh without a hierarchy (PLY and the like).
void dropNamelessHierarchy(const fs::path& file, Sculpt& sculpt) {
  if (sculpt.nodes.size() != 1 || sculpt.parts.size() != 1) return;
  if (sculpt.nodes[0].name.empty()) sculpt.nodes[0].name = sculpt.parts[0].name = file.stem().string();
}

// Gives the library the bytes of the file itself, and of files that it may refer to.
class NeighboursOnly : public Assimp::DefaultIOSystem {
 public:
  NeighboursOnly(const fs::path& file, const std::string& bytes, const ReadSettings& settings)
      : file_(file), bytes_(bytes), settings_(settings) {}
  bool Exists(const char* name) const override { return isItself(name) || (mayRead(name) && DefaultIOSystem::Exists(name)); }
  Assimp::IOStream* Open(const char* name, const char*) override {
    if (isItself(name)) return new Assimp::MemoryIOStream(reinterpret_cast<const uint8_t*>(bytes_.data()), bytes_.size());
    if (!mayRead(name)) return nullptr;
    try {
      const std::string other = settings_.read_file(name);
      auto copy = std::make_unique<uint8_t[]>(other.size());
      std::copy(other.begin(), other.end(), copy.get());
      return new Assimp::MemoryIOStream(copy.release(), other.size(), true);
    } catch (const Error&) {  // the library reports it
      return nullptr;
    }
  }

 private:
  bool isItself(const char* name) const { return fs::path(name).lexically_normal() == file_.lexically_normal(); }
  bool mayRead(const char* name) const { return !refusalOfNeighbour(file_, name, settings_.allow_outside); }
  const fs::path& file_;
  const std::string& bytes_;
  const ReadSettings& settings_;
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
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);  // not the ids
  importer.SetIOHandler(new NeighboursOnly(file, bytes, settings));            // the importer owns it
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (!scene && importer.GetException()) try {
      std::rethrow_exception(importer.GetException());
    } catch (const std::bad_alloc&) {
      throw;  // this file needs more memory; it may be sound
    } catch (...) {
      // Reported below
    }
  if (!scene || !scene->mRootNode)
    throw InputError(file.string(), std::string("cannot be read: ") + importer.GetErrorString() + "; export it again");
  warnings.add(WarningKind::kPoseIgnored, file.string() + ": animations are ignored; the stored pose was read", scene->mNumAnimations);
  warnings.add(WarningKind::kCameraIgnored, file.string() + ": cameras are not kept", scene->mNumCameras);
  warnings.add(WarningKind::kLightIgnored, file.string() + ": lights are not kept", scene->mNumLights);

  Sculpt sculpt;
  const Affine frame = sceneFrame(file, bytes, *scene, extension, settings, sculpt.frame_note, warnings);
  collectNodes(file, *scene, frame, extension != "ply", sculpt, warnings);
  dropNamelessHierarchy(file, sculpt);
  keepMaterials(file, *scene, settings, sculpt, warnings);
  return sculpt;
}

}  // namespace cloudbake
