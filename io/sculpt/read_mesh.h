// Sculpts of every format the artists use, as parts with their own vertices, in their own order.
#pragma once

#include <filesystem>
#include <string>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// Reads a sculpt; the extension (any case) chooses the reader: gltf, glb, obj, stl, ply, off, and what assimp knows (fbx, dae, 3ds, …).
///
/// Vertices: a file without normals and UVs keeps its own vertices in its own order, unreferenced ones included (STL: its distinct
/// positions). Otherwise one vertex per distinct (position, normal, UV) corner in order of first use. glTF keeps its own.
/// Normals come out as unit vectors; UVs with v downwards. Polygons become triangles, as io/sculpt/triangulate.h says.
/// Guaranteed: at least one triangle, every index in range, every position, normal and UV finite, every `to_scene` invertible.
/// Counted: kUnitsAssumed, kPoseIgnored, kPartIgnored, kUnreferencedVertex, kDegenerateTriangle, kZeroNormal, kMissingUvSet.
/// Throws IoError where the file cannot be read, InputError where its bytes are unusable or its format is not supported.
Sculpt readMesh(const std::filesystem::path& file, const ReadSettings& settings, Warnings& warnings);

/// The same from the bytes of `file`, which names them, chooses the reader and has its buffers beside it. With `child_program`, the child
/// reads the file itself.
Sculpt readMesh(const std::filesystem::path& file, const std::string& bytes, const ReadSettings& settings, Warnings& warnings);

/// Whether the extension is that of a sculpt's usual formats, and their names: ".gltf, .glb, …". readMesh tries others too.
bool isSculptFile(const std::filesystem::path& file);
std::string sculptExtensions();

/// The guarantees of readMesh for a sculpt from elsewhere: checks it, and completes its normals. Throws InputError; `file` is for messages.
void checkSculpt(const std::filesystem::path& file, Sculpt& sculpt, Warnings& warnings);

// One reader per format. `bytes` is the whole file; `file` is for messages and for files beside it.
SculptPart readObj(const std::filesystem::path& file, const std::string& bytes, Warnings& warnings);
SculptPart readStl(const std::filesystem::path& file, const std::string& bytes, Warnings& warnings);
SculptPart readOff(const std::filesystem::path& file, const std::string& bytes, Warnings& warnings);
/// Walks over a PLY without reading it: throws InputError where it is damaged or has less data than its header says.
void checkPly(const std::filesystem::path& file, const std::string& bytes);
/// Everything else. `extension` is in lower case without the dot.
Sculpt readWithAssimp(const std::filesystem::path& file, const std::string& bytes, const std::string& extension,
                      const ReadSettings& settings, Warnings& warnings);

/// "5.2.4": of the library that is loaded, which may be newer than the one built with.
std::string assimpVersion();

}  // namespace cloudbake
