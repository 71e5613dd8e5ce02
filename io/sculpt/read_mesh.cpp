// Chooses the reader by extension. Then all counts, indices and numbers are checked, whatever the library reports.
#include "io/sculpt/read_mesh.h"

#include <algorithm>

#include "core/error.h"
#include "core/first_where.h"
#include "core/parallel.h"
#include "core/text/scan.h"
#include "core/text/utf8.h"
#include "core/vertex_normals.h"
#include "io/file/write_file.h"
#include "io/gltf/sculpt/read.h"
#include "io/sculpt/child_reader.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& file) {
  std::string extension = file.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  return lowerCase(extension);
}

// Formats that no packaged library can read, and scenes of programs that write formats which one can.
struct UnreadFormat {
  std::string_view extensions, name;
  bool is_tried = false;  ///< a library reads some versions of it, if the file is named
};
constexpr std::string_view kExportSculpt = "export the sculpt as glTF, FBX or OBJ", kExportVolume = "export the volume as OpenVDB (.vdb)";
constexpr UnreadFormat kUnreadFormats[] = {
    {" usd usda usdc usdz ", "USD"},
    {" abc ", "Alembic"},
    {" max ", "a 3ds Max scene"},
    {" ma mb ", "a Maya scene"},
    {" ztl zpr goz ", "a ZBrush project"},
    {" blend ", "a Blender scene", true},
    {" c4d ", "a Cinema 4D scene", true},
    {" hip hiplc hipnc bgeo geo ", "a Houdini file"},
    {" 3b ", "a 3DCoat scene"},
    {" mud ", "a Mudbox scene"},
    {" nom ", "a Nomad Sculpt scene"},
    {" spp ", "a Substance 3D Painter project"},
    {" sbs sbsar ", "a Substance material"},
    {" lxo ", "a Modo scene"},
    {" skp ", "a SketchUp model", true},
    {" 3dm ", "a Rhino model", true},
    {" step stp iges igs ", "a CAD model", true},
    {" uasset umap ", "an Unreal asset"},
    {" unity prefab unitypackage ", "a Unity asset"},
    {" tscn scn tres ", "a Godot scene"},
    {" nvdb ", "a NanoVDB volume"},
    {" f3d vol ", "a volume of this kind"},
};

const UnreadFormat* unreadFormatOf(const std::string& extension) {
  const auto found = std::find_if(std::begin(kUnreadFormats), std::end(kUnreadFormats), [&](const UnreadFormat& format) {
    return !extension.empty() && format.extensions.find(" " + extension + " ") != std::string_view::npos;
  });
  return found == std::end(kUnreadFormats) ? nullptr : &*found;
}

// Applies the user's frame (scale and axes) to a format without one.
Affine frameOf(const ReadSettings& settings) {
  Affine frame;
  const auto turn = turnOf(settings.up_axis.value_or(UpAxis::kY));
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) frame.linear[r][c] = turn[r][c] * settings.metres_per_unit.value_or(1);
  return frame;
}

const char* frameSource(const ReadSettings& settings) {
  if (settings.metres_per_unit && settings.up_axis) return "as given";
  return settings.metres_per_unit ? "unit as given, axis assumed"
         : settings.up_axis       ? "unit assumed, axis as given"
                                  : "assumed, the format does not say";
}

template <SculptPart (*read)(const fs::path&, const std::string&, Warnings&)>
Sculpt asSculpt(const fs::path& file, const std::string& bytes, const ReadSettings&, Warnings& warnings) {
  Sculpt sculpt;
  sculpt.parts.push_back(read(file, bytes, warnings));
  return sculpt;
}

// The formats of sculpts. Those without a reader of ours are read by assimp, which knows others too.
struct Format {
  std::string_view extension;
  Sculpt (*read)(const fs::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings) = nullptr;
};
constexpr Format kFormats[] = {
    {"gltf"}, {"glb"}, {"obj", readObj}, {"stl", asSculpt<readStl>}, {"ply", readPly}, {"off", asSculpt<readOff>}, {"fbx"},
    {"dae"},  {"3ds"}, {"3mf"}};

// Brings a sculpt of a format without a frame to metres, +Y up.
void applyFrame(const fs::path& file, const ReadSettings& settings, Sculpt& sculpt, Warnings& warnings) {
  const Affine frame = frameOf(settings);
  for (SculptPart& part : sculpt.parts) part.to_scene = frame;
  for (SculptNode& node : sculpt.nodes)
    if (node.parent < 0) node.local = frame;
  sculpt.frame_note =
      frameText(settings.metres_per_unit.value_or(1), "XYZ"[int(settings.up_axis.value_or(UpAxis::kY))], false, frameSource(settings));
  if (!settings.metres_per_unit || !settings.up_axis)
    warnings.add(WarningKind::kUnitsAssumed, unitsAssumedText(file, settings.metres_per_unit ? "" : "metres", !settings.up_axis));
}

Sculpt readByExtension(const fs::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings) {
  const std::string extension = lowerExtension(file);
  if (const UnreadFormat* format = unreadFormatOf(extension); format && !format->is_tried)
    throw InputError(file.string(), std::string(format->name) + " is not supported; " + cureWithoutReader(file));
  if (extension == "gltf" || extension == "glb") {
    if ((settings.metres_per_unit || settings.up_axis) && !settings.frame_if_unstated)
      throw InputError(file.string(), "glTF has a fixed unit and up axis; leave --units and --up out, or change the file's root node");
    return readGltf(file, bytes, settings, warnings);
  }
  if (settings.moment && extension != "fbx")
    throw InputError(file.string(), "animations of this format cannot be read; export the sculpt as glTF or FBX");
  if (settings.scene_index) throw InputError(file.string(), "only glTF has scenes to choose from; leave --scene-index out for this file");
  if (bytes.empty()) throw InputError(file.string(), "the file is empty; export it again");
  const auto format = std::find_if(std::begin(kFormats), std::end(kFormats), [&](const Format& one) { return one.extension == extension; });
  if (format == std::end(kFormats) || !format->read)
    return settings.child_program.empty() ? readWithAssimp(file, bytes, extension, settings, warnings)
                                          : readInChild(file, bytes, extension, settings, warnings, ChildLimits(settings.memory_limit));

  Sculpt sculpt = format->read(file, bytes, settings, warnings);
  applyFrame(file, settings, sculpt, warnings);
  return sculpt;
}

[[noreturn]] void failAt(const fs::path& file, const SculptPart& part, const std::string& what) {
  throw InputError(file.string(), (part.name.empty() ? "" : "in '" + part.name + "': ") + what);
}

// Normalises all normals. A missing (zero) normal is replaced by the normal of the surface.
void completeNormals(const fs::path& file, SculptPart& part, Warnings& warnings) {
  constexpr size_t kGrain = 1 << 14;
  const auto needs_help = [&](size_t i) { return !isFinite(part.normals[i]) || !normalized(part.normals[i]); };
  const size_t sound = firstWhere(part.normals.size(), needs_help);
  parallelBlocks(sound, kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) part.normals[i] = *normalized(part.normals[i]);
  });
  std::vector<Vec3> computed;
  for (size_t i = sound; i < part.normals.size(); ++i) {
    Vec3& normal = part.normals[i];
    if (!isFinite(normal)) failAt(file, part, "the normal of vertex " + std::to_string(i) + " is not finite; repair the file");
    if (const auto unit = normalized(normal)) {
      normal = *unit;
      continue;
    }
    if (computed.empty()) computed = vertexNormals(part.positions, part.triangles);
    normal = normalized(computed[i]).value_or(Vec3{0, 1, 0});
    warnings.add(WarningKind::kZeroNormal, "a zero normal was replaced by the normal of the surface, first at vertex " + std::to_string(i));
  }
}

void checkExtras(const fs::path& file, const SculptPart& part) {
  const size_t count = part.positions.size();
  if (!part.colors.empty() && part.colors.size() != count)
    failAt(file, part, "the numbers of positions and colours differ; export the file again");
  for (size_t i = 0; i < part.colors.size(); ++i)
    for (const float value : part.colors[i])
      if (!std::isfinite(value)) failAt(file, part, "the colour of vertex " + std::to_string(i) + " is not finite; repair the file");
  for (const std::vector<Vec2>& set : part.more_uvs) {
    if (set.size() != count) failAt(file, part, "the numbers of positions and UVs differ; export the file again");
    for (size_t i = 0; i < count; ++i)
      if (!std::isfinite(set[i].x) || !std::isfinite(set[i].y))
        failAt(file, part, "the UV of vertex " + std::to_string(i) + " is not finite; repair the file");
  }
}

// Checks the guarantees of readMesh for one part.
void checkPart(const fs::path& file, SculptPart& part, Warnings& warnings) {
  const size_t count = part.positions.size();
  if ((!part.normals.empty() && part.normals.size() != count) || (!part.uvs.empty() && part.uvs.size() != count))
    failAt(file, part, "the numbers of positions, normals and UVs differ; export the file again");
  const auto is_far = [&](size_t i) { return !isFinite(transformPoint(part.toScene(i), part.positions[i])); };
  if (const size_t i = firstWhere(count, [&](size_t v) { return !isFinite(part.positions[v]) || is_far(v); }); i < count) {
    if (!isFinite(part.positions[i])) failAt(file, part, "the position of vertex " + std::to_string(i) + " is not finite; repair the file");
    failAt(file, part, "vertex " + std::to_string(i) + " lies beyond the range of float32 in the scene; scale the sculpt down");
  }
  for (size_t i = 0; i < part.uvs.size(); ++i)
    if (!std::isfinite(part.uvs[i].x) || !std::isfinite(part.uvs[i].y))
      failAt(file, part, "the UV of vertex " + std::to_string(i) + " is not finite; repair the file");
  const auto is_wrong = [&](size_t i) {
    const auto& [a, b, c] = part.triangles[i];
    return a >= count || b >= count || c >= count;
  };
  if (const size_t i = firstWhere(part.triangles.size(), is_wrong); i < part.triangles.size())
    for (const uint32_t index : part.triangles[i])
      if (index >= count)
        failAt(file, part,
               "triangle " + std::to_string(i) + " uses vertex " + std::to_string(index) + " of " + std::to_string(count) +
                   "; the file is damaged, export it again");
  if (!inverted(part.to_scene)) failAt(file, part, "the node's transform is singular (a scale is 0); correct the scale");
  checkExtras(file, part);
  completeNormals(file, part, warnings);
}

// Parents come before their children, and every index is in range. A child process may have been led astray by its library.
void checkHierarchy(const fs::path& file, const Sculpt& sculpt) {
  const auto in_range = [](int index, size_t count, bool may_miss) { return index < 0 ? may_miss && index == -1 : size_t(index) < count; };
  bool sound = true;
  for (size_t i = 0; i < sculpt.nodes.size(); ++i) sound &= sculpt.nodes[i].parent >= -1 && sculpt.nodes[i].parent < int(i);
  for (const SculptPart& part : sculpt.parts)
    sound &= in_range(part.node, sculpt.nodes.size(), sculpt.nodes.empty()) && in_range(part.material, sculpt.materials.size(), true);
  for (const SculptMaterial& m : sculpt.materials)
    for (const SculptTexture* texture :
         {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.occlusion_texture, &m.emissive_texture})
      sound &= in_range(texture->image, sculpt.images.size(), true);
  if (!sound) throw InputError(file.string(), "its nodes or materials are damaged; export it again");
}

// glTF holds names in UTF-8 alone.
void cleanNames(Sculpt& sculpt) {
  const auto clean = [](auto& things) {
    for (auto& thing : things) thing.name = asUtf8(thing.name);
  };
  clean(sculpt.parts), clean(sculpt.nodes), clean(sculpt.materials), clean(sculpt.images);
}

}  // namespace

std::string_view formatWithoutReader(const fs::path& file) {
  const UnreadFormat* format = unreadFormatOf(lowerExtension(file));
  return format ? format->name : std::string_view();
}

std::string cureWithoutReader(const fs::path& file) {
  return std::string(formatWithoutReader(file).find("volume") == std::string_view::npos ? kExportSculpt : kExportVolume);
}

std::string unitsAssumedText(const fs::path& file, const std::string& unit, bool axis) {
  const std::string both = unit + (!unit.empty() && axis ? ", " : "") + (axis ? "+Y up" : "");
  return file.string() + ": the file does not state its unit and up axis: assumed " + both + "; --units and --up choose";
}

bool isSculptFile(const fs::path& file) {
  const std::string extension = lowerExtension(file);
  return std::any_of(std::begin(kFormats), std::end(kFormats), [&](const Format& format) { return format.extension == extension; });
}

bool isReadByChild(const fs::path& file) {
  const std::string extension = lowerExtension(file);
  const auto format = std::find_if(std::begin(kFormats), std::end(kFormats), [&](const Format& one) { return one.extension == extension; });
  return extension != "gltf" && extension != "glb" && (format == std::end(kFormats) || !format->read);
}

std::string sculptExtensions() {
  std::string all;
  for (const Format& format : kFormats) all += (all.empty() ? "." : ", .") + std::string(format.extension);
  return all;
}

Sculpt readMesh(const fs::path& file, const ReadSettings& settings, Warnings& warnings) {
  return readMesh(file, settings.read_file(file), settings, warnings);
}

Sculpt readMesh(const fs::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings) {
  if (settings.metres_per_unit && !(*settings.metres_per_unit > 0 && std::isfinite(*settings.metres_per_unit)))
    throw UsageError("the unit must be a length above 0; give metres per unit, 0.01 for centimetres");
  Sculpt sculpt = readByExtension(file, bytes, settings, warnings);
  checkSculpt(file, sculpt, warnings);
  return sculpt;
}

void checkSculpt(const fs::path& file, Sculpt& sculpt, Warnings& warnings) {
  size_t triangles = 0;
  if (!sculpt.gltf) checkHierarchy(file, sculpt), cleanNames(sculpt);
  for (SculptPart& part : sculpt.parts) {
    checkPart(file, part, warnings);
    triangles += part.triangles.size();
  }
  if (triangles == 0) throw InputError(file.string(), "there are no triangles in it; export the sculpt's faces");
}

}  // namespace cloudbake
