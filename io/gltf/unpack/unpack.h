// Compressed glTF becomes plain glTF, right after parsing, so that all other code sees a plain document. Only for io/gltf.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/warnings.h"
#include "io/gltf/asset_info.h"
#include "io/gltf/document.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

/// Decodes EXT_meshopt_compression, KHR_meshopt_compression and KHR_draco_mesh_compression in the document and its buffers. The decoded
/// views, and the data of all others, are moved to one new buffer that replaces `buffers`; indices of views and accessors stay. The
/// extensions are removed from the document. Returns their names; a document without them stays untouched. Throws InputError for damaged
/// data, for a bitstream that the libraries do not know, or if the plain data would take more than `limit` bytes.
std::vector<std::string> unpackGltf(const std::filesystem::path& file, Json& json, GltfBuffers& buffers, uint64_t limit);

/// Instances of EXT_mesh_gpu_instancing become child nodes of their node, in the document and in the model alike. Hidden nodes (a flag per
/// node) stay as they are. Returns the number of instances. Throws InputError for damaged attributes. Counts kPartIgnored for attributes of
/// instances that nodes cannot have.
size_t unpackInstances(const std::filesystem::path& file, Json& json, tinygltf::Model& model, const std::vector<bool>& hidden,
                       Warnings& warnings);

/// The number of instances of every node of the document: 1 for a node without the extension. Accessors are looked up, not read.
std::vector<uint64_t> instanceCounts(const Json& json);

// The rest is shared by unpack.cpp, unpack_meshopt.cpp and unpack_draco.cpp.

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// A document while it is unpacked.
struct Unpacking {
  const std::filesystem::path& file;
  Json& json;
  const GltfBuffers& buffers;
  uint64_t limit;                            ///< bytes of plain data
  std::vector<std::string> decoded_views{};  ///< per buffer view: its decoded data
  std::vector<bool> is_decoded{};            ///< per buffer view
  uint64_t decoded_bytes = 0;                ///< so far

  /// Throws InputError if the file needs more than `limit` bytes with `bytes` more, else counts them.
  void reserve(uint64_t bytes, const std::string& owner);
  /// Bytes of a buffer, checked.
  std::string_view bytesOf(uint64_t buffer, uint64_t offset, uint64_t length, const std::string& owner) const;
  [[noreturn]] void fail(const std::string& what) const;
};

/// Decodes the buffer views that use one of the two extensions.
void unpackMeshopt(Unpacking& unpacking, const std::string& extension);
/// Decodes the primitives that use KHR_draco_mesh_compression. Their accessors get views of their own.
void unpackDraco(Unpacking& unpacking);

/// A whole number ≥ 0 of a JSON object. Throws InputError if it is something else.
uint64_t countAt(const Unpacking& unpacking, const Json& object, const char* key, uint64_t fallback, const std::string& owner);

}  // namespace cloudbake
