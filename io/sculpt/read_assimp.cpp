// Reads all formats without a reader of our own, by assimp 5.2. Its behaviour was tested with its own test models. It converts Collada to
// +Y up and metres by the transform of the root, which is undone here. For FBX, 3MF and AMF it applies neither axes nor unit, so both are
// applied here (io/sculpt/file_frame.h). Of an FBX it hands over neither what is hidden nor how scale is inherited: its models are read
// again (io/sculpt/fbx_models.h) and take the place of assimp's nodes, in which a pivoted model is a chain of helpers. It gives every
// polygon corner its own vertex. Its materials are converted by io/sculpt/assimp_materials.h.
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
#include <optional>
#include <unordered_map>

#include "core/error.h"
#include "core/text/plain_text.h"
#include "core/text/scan.h"
#include "io/file/neighbour.h"
#include "io/file/write_file.h"
#include "io/sculpt/assimp_animation.h"
#include "io/sculpt/assimp_fbx.h"
#include "io/sculpt/assimp_joints.h"
#include "io/sculpt/assimp_materials.h"
#include "io/sculpt/assimp_types.h"
#include "io/sculpt/check_xml.h"
#include "io/sculpt/file_frame.h"
#include "io/sculpt/read_mesh.h"
#include "io/sculpt/triangulate.h"
#include "io/sculpt/vertex_colors.h"

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

int metaInteger(const aiScene& scene, const char* key, int otherwise) {
  int32_t value = otherwise;
  return scene.mMetaData && scene.mMetaData->Get(key, value) ? value : otherwise;
}

// What assimp says of an FBX that our reader cannot read. assimp fills in defaults, so look for the words themselves.
FbxProperties assimpSettings(const aiScene& scene, const std::string& bytes) {
  FbxProperties settings;
  for (const char* key : {"UpAxis", "UpAxisSign", "CoordAxis", "CoordAxisSign", "FrontAxis", "FrontAxisSign"})
    if (bytes.find(key) != bytes.npos) settings[key] = {double(metaInteger(scene, key, 99))};
  float centimetres = 1;
  if (bytes.find("UnitScaleFactor") != bytes.npos && scene.mMetaData && scene.mMetaData->Get("UnitScaleFactor", centimetres))
    settings["UnitScaleFactor"] = {centimetres};
  return settings;
}

// From the file's frame to metres, +Y up.
Affine sceneFrame(const fs::path& file, const FileFrame& found, const ReadSettings& asked, std::string& text, Warnings& warnings) {
  const ReadSettings settings = found.wanted(asked);
  const bool assumes_unit = !found.says_unit && !settings.metres_per_unit, assumes_axis = !found.says_axes && !settings.up_axis;
  if (assumes_unit || assumes_axis)
    warnings.add(WarningKind::kUnitsAssumed, unitsAssumedText(file, assumes_unit ? found.unit_name : "", assumes_axis));
  text = found.text(settings);
  return found.replacedBy(settings).toScene();
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

// Whether programs take colours of vertices in this format as sRGB: Blender 3.4 writes them so by default, and three.js reads them so.
// Those of glTF are linear.
bool hasSrgbColors(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  return extension == ".fbx" || extension == ".dae" || extension == ".zae";
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
  if (hasSrgbColors(file)) decodeVertexColors(part.colors, 1);
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
  return part;
}

void countPose(const fs::path& file, const aiMesh& mesh, bool is_posed, bool is_morphed, Warnings& warnings) {
  warnings.add(WarningKind::kPoseIgnored, file.string() + ": bones or morph targets are ignored; the stored pose was read",
               (mesh.HasBones() && !is_posed) || (mesh.mNumAnimMeshes > 0 && !is_morphed));
}

// Whether a node is one of the helpers that assimp makes of an FBX node's pivots: NAME_$AssimpFbx$_Translation and so on.
bool isPivotHelper(const aiNode& node) { return std::string_view(node.mName.C_Str()).find("_$AssimpFbx$_") != std::string_view::npos; }

// What is known of a scene beside what assimp hands over.
struct Extras {
  bool skip_root = false;  // its transform is the frame, which is applied already
  const JointPoses* joints = nullptr;
  std::optional<std::vector<FbxNode>> fbx;
  std::optional<AssimpPose> pose;  // of the nodes, by an animation
  Affine frame;                    // from below the root to metres, +Y up
};

// A node with its parts. `shown`: whether they are part of the sculpt.
void addNode(const fs::path& file, const aiScene& scene, const aiNode& node, SculptNode added, const Extras& extras, bool shown,
             std::vector<Affine>& to_scene, Sculpt& sculpt, Warnings& warnings) {
  const int index = int(sculpt.nodes.size());
  to_scene.push_back(added.parent < 0 ? added.local : compose(to_scene[size_t(added.parent)], added.local));
  sculpt.nodes.push_back(std::move(added));
  if (!shown) {
    warnings.add(WarningKind::kHiddenPart, file.string() + ": '" + sculpt.nodes.back().name + "' is hidden in the file and was left out",
                 node.mNumMeshes > 0);
    return;
  }
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    SculptPart part = partFromMesh(file, mesh, warnings);
    if (part.triangles.empty()) continue;
    if (extras.pose) extras.pose->morph(mesh, node, part);
    countPose(file, mesh, extras.joints && extras.joints->pose(node.mMeshes[i], mesh, node, part, file, warnings), extras.pose.has_value(),
              warnings);
    part.name = sculpt.nodes.back().name;
    part.to_scene = extras.pose ? compose(extras.frame, belowRoot(node)) : to_scene.back();
    part.object = part.node = index;
    part.material = int(mesh.mMaterialIndex);  // of the scene until keepMaterials
    sculpt.parts.push_back(weldCorners(part));
  }
}

// Nodes and their parts, depth first. The stack is explicit, because a file may be nested arbitrarily deep. A helper is joined with the
// node below it, unless it has something else to hold.
void collectNodes(const fs::path& file, const aiScene& scene, const Extras& extras, Sculpt& sculpt, Warnings& warnings) {
  struct Visit {
    const aiNode* node;
    int parent;
    Affine before;  // transforms of helpers between the parent and this node, or the frame
  };
  std::vector<Affine> to_scene;
  std::vector<Visit> stack{{scene.mRootNode, -1, extras.frame}};
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const aiNode& node = *visit.node;
    const Affine local =
        extras.skip_root && &node == scene.mRootNode ? visit.before : compose(visit.before, toAffine(node.mTransformation));
    const bool is_root = &node == scene.mRootNode && node.mNumChildren > 0;
    if (node.mNumMeshes == 0 && (is_root || (isPivotHelper(node) && node.mNumChildren == 1))) {
      for (unsigned i = node.mNumChildren; i-- > 0;) stack.push_back({node.mChildren[i], visit.parent, local});
      continue;
    }
    const int index = int(sculpt.nodes.size());
    addNode(file, scene, node, {node.mName.C_Str(), visit.parent, local}, extras, true, to_scene, sculpt, warnings);
    for (unsigned i = node.mNumChildren; i-- > 0;) stack.push_back({node.mChildren[i], index, {}});
  }
}

// The same from the models of an FBX. A node of the output has its model's geometric transform too, which its children must not get.
void collectModels(const fs::path& file, const aiScene& scene, const Extras& extras, Sculpt& sculpt, Warnings& warnings) {
  std::vector<Affine> to_scene;
  std::vector<FbxPlace> places;
  std::vector<bool> hides;  // children
  uint64_t guessed = 0;
  for (const FbxNode& found : *extras.fbx) {
    const bool is_root = found.parent < 0;
    FbxPlace place = placeFbxModel(*found.model, is_root ? FbxPlace() : places[size_t(found.parent)]);
    const auto undone = is_root ? std::optional(extras.frame) : inverted(places[size_t(found.parent)].geometric);
    guessed += !place.is_exact || !undone;
    bool hides_children = false;
    const bool shown = !found.model->isHidden(!is_root && hides[size_t(found.parent)], hides_children);
    const Affine local = compose(undone.value_or(Affine()), compose(place.to_parent, place.geometric));
    addNode(file, scene, *found.node, {found.model->name, found.parent, local}, extras, shown, to_scene, sculpt, warnings);
    places.push_back(place);
    hides.push_back(hides_children);
  }
  warnings.add(WarningKind::kTransformGuessed,
               file.string() + ": a model's rotation order, or how it inherits scale, has no exact meaning here; its place may differ",
               guessed);
}

// Counts models that assimp places elsewhere than our rules do. An animation moves assimp's nodes.
void countOtherPlaces(const fs::path& file, const std::vector<FbxNode>& nodes, Warnings& warnings) {
  constexpr double kTolerance = 1e-4;  // of the largest number of the transform
  std::vector<FbxPlace> places;
  uint64_t others = 0;
  for (const FbxNode& one : nodes) {
    places.push_back(placeFbxModel(*one.model, one.parent < 0 ? FbxPlace() : places[size_t(one.parent)]));
    const Affine ours = compose(places.back().global, places.back().geometric), theirs = belowRoot(*one.node);
    double off = 0, largest = 0;
    const auto compare = [&](double a, double b) { off = std::max(off, std::fabs(a - b)), largest = std::max(largest, std::fabs(a)); };
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) compare(ours.linear[r][c], theirs.linear[r][c]);
      compare(ours.offset[r], theirs.offset[r]);
    }
    others += off > kTolerance * largest;
  }
  warnings.add(WarningKind::kTransformGuessed,
               file.string() + ": how a model inherits scale, or its rotation order, does not count in an animation; its place may differ",
               others);
}

// The models of an FBX in the order of assimp's nodes, and its settings.
FbxProperties matchModels(const fs::path& file, const std::string& bytes, const aiScene& scene, FbxModels& models, Extras& extras,
                          Warnings& warnings) {
  std::string why = "differ from the nodes of the library";
  bool is_read = false;
  try {
    models = readFbxModels(file.string(), bytes);
    is_read = true;
    extras.fbx = matchFbxNodes(scene, models);
  } catch (const InputError& error) {
    why = "cannot be read (" + error.message.substr(0, error.message.find(';')) + ")";
  }
  if (!extras.fbx)
    warnings.add(WarningKind::kTransformGuessed,
                 file.string() + ": its models " + why + ": hidden ones may be shown, and inherited scales wrong");
  return is_read ? models.settings : assimpSettings(scene, bytes);
}

// A root that only carries the file's frame and name adds nothing to a file of one mesh without a hierarchy.
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

// The settings of every importer, and the file as its only way to the disk.
const aiScene* readScene(Assimp::Importer& importer, const fs::path& file, const std::string& bytes, const ReadSettings& settings,
                         bool collada_names) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES,
                           true);  // otherwise it makes meshes for the bones, cameras and lights of a file without meshes
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, collada_names);
  importer.SetIOHandler(new NeighboursOnly(file, bytes, settings));  // the importer owns it
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
  return scene;
}

bool hasBones(const aiScene& scene) {
  return std::any_of(scene.mMeshes, scene.mMeshes + scene.mNumMeshes, [](const aiMesh* mesh) { return mesh->HasBones(); });
}

// The textures of a 3MF do not arrive, and assimp gives one triangle UVs and the material of a texture black.
void dropTextures(const aiScene& scene, Sculpt& sculpt) {
  for (SculptPart& part : sculpt.parts) {
    part.uvs.clear();
    if (unsigned(part.material) < scene.mNumMaterials && scene.mMaterials[part.material]->GetTextureCount(aiTextureType_DIFFUSE) > 0)
      part.material = -1;
  }
}

// A text file as assimp reads it right: plain, and an FBX with short numbers. Nothing if it is stored like that, or is binary.
std::optional<std::string> mendedText(const fs::path& file, const std::string& bytes, const std::string& extension) {
  const bool is_fbx = extension == "fbx" && !isBinaryFbx(bytes);
  if (!is_fbx && extension != "dae" && extension != "amf") return std::nullopt;
  std::string storage;
  const std::string_view text = plainText(bytes, file.string(), storage);
  if (auto shortened = is_fbx ? withShortNumbers(text) : std::nullopt) return shortened;
  return text.data() == bytes.data() ? std::nullopt : std::optional(std::string(text));
}

}  // namespace

Sculpt readWithAssimp(const fs::path& file, const std::string& as_stored, const std::string& extension, const ReadSettings& settings,
                      Warnings& warnings) {
  const std::optional<std::string> mended = mendedText(file, as_stored, extension);
  const std::string& bytes = mended ? *mended : as_stored;
  Assimp::Importer importer, by_id;
  if (extension.empty() || !importer.IsExtensionSupported("." + extension))
    throw InputError(file.string(), (extension.empty() ? "the file has no extension" : "'." + extension + "' is not a known mesh format") +
                                        "; export the sculpt as glTF, FBX, OBJ, PLY, STL or OFF");
  const bool is_collada = extension == "dae" || extension == "zae";
  FileFrame found;
  if (extension == "3mf") {
    const std::string model = modelOf3mf(file, bytes, settings.memory_limit);
    check3mf(file, model, warnings);
    found = frameOf3mf(file, model);
  } else if (extension == "dae") {
    checkCollada(file, bytes);
  } else if (extension == "amf") {
    checkAmf(file, bytes);
    found = frameOfAmf(file, bytes);
  }
  const aiScene* scene = readScene(importer, file, bytes, settings, true);
  warnings.add(WarningKind::kPoseIgnored, file.string() + ": animations are ignored; the stored pose was read",
               settings.moment ? 0 : scene->mNumAnimations);
  warnings.add(WarningKind::kCameraIgnored, file.string() + ": cameras are not kept", scene->mNumCameras);
  warnings.add(WarningKind::kLightIgnored, file.string() + ": lights are not kept", scene->mNumLights);

  Sculpt sculpt;
  Extras extras;
  FbxModels models;
  JointPoses joints;
  if (extension == "fbx") found = frameOfFbx(file, matchModels(file, bytes, *scene, models, extras, warnings));
  if (is_collada) {
    extras.skip_root = true;
    found = frameOfCollada(file, toAffine(scene->mRootNode->mTransformation));
    if (hasBones(*scene)) {
      joints.find(*readScene(by_id, file, bytes, settings, false), bytes.find("<authoring_tool>Blender") != bytes.npos);
      extras.joints = &joints;
    }
  }
  extras.frame = sceneFrame(file, found, settings, sculpt.frame_note, warnings);
  if (settings.moment) {
    if (extras.fbx) countOtherPlaces(file, *extras.fbx, warnings);
    extras.pose = poseByAnimation(file, *settings.moment, const_cast<aiScene&>(*scene));  // the importer's own scene is not const
    sculpt.animation_seconds = extras.pose->animation_seconds;
    joints.find(*scene, false);
    extras.joints = &joints;
  }
  (extras.fbx ? collectModels : collectNodes)(file, *scene, extras, sculpt, warnings);
  if (sculpt.parts.empty() && warnings.entries().contains(WarningKind::kHiddenPart))
    throw InputError(file.string(), "all its meshes are hidden; show them and export the file again");
  dropNamelessHierarchy(file, sculpt);
  if (extension == "3mf") dropTextures(*scene, sculpt);
  keepMaterials(file, *scene, settings, sculpt, warnings);
  return sculpt;
}

}  // namespace cloudbake
