// Reads a glTF as a sculpt.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// Reads a .gltf or .glb. Every triangle primitive of a mesh under a visible node of the scene (settings.scene_index, else the default
/// scene, else scene 0, else all root nodes) becomes a part, in order of the nodes, depth first. Primitives of a mesh that have the same
/// vertices become one part. Primitives that share vertices with other meshes or nodes, and use at most half of them, get copies of those
/// that they use. Skinned parts are posed by their joints. Strips and fans become triangles; triangles with two equal corners only join a
/// strip and are dropped. Morph targets are applied with the file's weights. With settings.moment, transforms and weights are those of an
/// animation, and Sculpt::animation_seconds is set. `Sculpt.gltf` keeps the document and all its buffers,
/// unpacked: compressed data (Draco, meshopt) is decoded, and instances become nodes. The lobes of an earlier bake are taken out. `file` is
/// for messages, and for finding buffers and images beside it or in folders below. Images are read so that the GLB can embed them. Counts
/// kPartIgnored (points, lines), kHiddenPart (nodes that KHR_node_visibility hides), kPoseIgnored (morph targets, animations),
/// kJointFallback, kOtherScene, kSingularTransform, kImageNotEmbedded. Throws IoError, or InputError for a damaged file, no such scene,
/// cyclic nodes, an unknown required extension, parts over settings.memory_limit, a buffer outside the file's folder (unless
/// settings.allow_outside), or meshes that are all hidden.
Sculpt readGltf(const std::filesystem::path& file, std::string_view bytes, const ReadSettings& settings, Warnings& warnings);

/// Identifies the source of a bake: the hash of its bytes. For a baked asset that is baked again, the hash of what remains of it without
/// the earlier bake, so that it is the same after every bake.
std::string sourceHash(const Sculpt& sculpt, std::string_view bytes);

}  // namespace cloudbake
