// Reads sculpts of all formats that artists use, as parts with their own vertices in their own order.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// Reads a sculpt. The extension (in any case) chooses the reader: gltf, glb, obj, stl, ply, off, and the formats of assimp (fbx, dae, 3ds,
/// …).
///
/// Objects, groups and nodes become Sculpt::nodes, and there is a part per node and material that it uses.
/// Vertices: a file of one part without attributes of corners keeps its vertices and their order, including unreferenced ones (STL: its
/// distinct positions). With several parts, each keeps those that it uses, in their order. Otherwise there is one vertex per distinct
/// (position, normal, UV) corner of a part in order of first use. glTF keeps its own vertices.
/// With settings.moment, a glTF or FBX is posed by its animation, and its length is in Sculpt::animation_seconds; Sculpt::nodes stay as
/// they are without it. Other formats are then refused. Normals are unit vectors, v of the UVs grows downwards, and colours are linear.
/// Polygons become triangles, as described in io/sculpt/triangulate.h. Guaranteed: at least one triangle, every index in range, every
/// position, normal and UV finite, every `to_scene` invertible. Counts kUnitsAssumed, kPoseIgnored, kPartIgnored, kMaterialIgnored,
/// kTextureIgnored, kImageNotEmbedded, kCameraIgnored, kLightIgnored, kCurveIgnored, kMissingColor, kUnreferencedVertex,
/// kDegenerateTriangle, kZeroNormal, kMissingUvSet. Throws IoError if the file cannot be read, InputError if its bytes are unusable or its
/// format is not supported.
Sculpt readMesh(const std::filesystem::path& file, const ReadSettings& settings, Warnings& warnings);

/// The same from the bytes of `file`. Its name is used for messages, for choosing the reader and for finding buffers.
Sculpt readMesh(const std::filesystem::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings);

/// Whether the extension is that of a sculpt's usual formats, and their names: ".gltf, .glb, …". readMesh tries others too.
bool isSculptFile(const std::filesystem::path& file);
std::string sculptExtensions();
/// What a file of this name is, if it is of a known program and no reader takes it: "a Maya scene"; else empty. And what to do with it.
std::string_view formatWithoutReader(const std::filesystem::path& file);
std::string cureWithoutReader(const std::filesystem::path& file);
/// Whether a file of this name is always read in a child process, if there is a program for it (ReadSettings::child_program).
bool isReadByChild(const std::filesystem::path& file);

/// The guarantees of readMesh for a sculpt from elsewhere: checks it, and completes its normals. Throws InputError; `file` is for messages.
void checkSculpt(const std::filesystem::path& file, Sculpt& sculpt, Warnings& warnings);

/// The text of kUnitsAssumed. `unit` is the one assumed, empty if it was given; `axis`: whether +Y up was assumed.
std::string unitsAssumedText(const std::filesystem::path& file, const std::string& unit, bool axis);

// One reader per format. `bytes` is the whole file; `file` is for messages and for files beside it.
/// Parts of one node and one material each. Their space is the scene's.
Sculpt readObj(const std::filesystem::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings);
SculptPart readStl(const std::filesystem::path& file, const std::string& bytes, Warnings& warnings);
SculptPart readOff(const std::filesystem::path& file, const std::string& bytes, Warnings& warnings);
/// One part, or parts of one node with a material each. Vertices are split where the UVs of corners or the colours of faces differ.
Sculpt readPly(const std::filesystem::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings);
/// Reads all other formats. `extension` is in lower case, without the dot.
Sculpt readWithAssimp(const std::filesystem::path& file, const std::string& bytes, const std::string& extension,
                      const ReadSettings& settings, Warnings& warnings);

}  // namespace cloudbake
