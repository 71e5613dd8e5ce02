// A mesh is read once per node, because its lobes differ. A file of a megabyte can ask for a terabyte in this way.
#include "io/gltf/sculpt/budget.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "core/error.h"
#include "core/memory_budget.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// Bytes at the peak of a whole bake, measured with 300 and 600 nodes of a ball of 9,942 vertices (256 per vertex and two triangles) and
// with 100,000 nodes of a ball of 14 (5,000 per node and part). A skinned vertex keeps a map of its own.
constexpr double kBytesPerVertex = 160, kBytesPerTriangle = 48, kBytesPerPart = 3000, kBytesPerNode = 2000;
constexpr double kBytesPerSkinnedVertex = sizeof(Affine);
constexpr double kLobeBytes = 16;

struct Estimate {
  double vertices = 0, bytes = 0, lobe_bytes = 0;
};

// The count of an accessor; 0 for one that the file cannot hold, which its reader will report.
double plausibleCount(const tinygltf::Model& model, int accessor, size_t file_bytes) {
  if (accessor < 0 || size_t(accessor) >= model.accessors.size()) return 0;
  const size_t count = model.accessors[size_t(accessor)].count;
  return count <= file_bytes ? double(count) : 0;
}

// What one drawing of a mesh takes. Bundles that share positions share lobes in the file, but not in memory.
Estimate estimateMesh(const tinygltf::Model& model, const tinygltf::Mesh& mesh, const std::vector<GltfBundle>& bundles, bool is_skinned,
                      size_t file_bytes) {
  Estimate all;
  std::set<int> known;
  for (const GltfBundle& bundle : bundles) {
    const int position = mesh.primitives[size_t(bundle.front())].attributes.at("POSITION");
    const double vertices = plausibleCount(model, position, file_bytes);
    all.vertices += vertices;
    all.bytes += (kBytesPerVertex + (is_skinned ? kBytesPerSkinnedVertex : 0)) * vertices;
    if (known.insert(position).second) all.lobe_bytes += kLobeBytes * vertices;
    for (const int index : bundle) {
      const tinygltf::Primitive& primitive = mesh.primitives[size_t(index)];
      const double indices = primitive.indices < 0 ? vertices : plausibleCount(model, primitive.indices, file_bytes);
      const bool is_list = primitive.mode < 0 || primitive.mode == TINYGLTF_MODE_TRIANGLES;
      all.bytes += kBytesPerTriangle * indices / (is_list ? 3 : 1) + kBytesPerPart;
    }
  }
  return all;
}

}  // namespace

void checkBudget(const fs::path& file, const tinygltf::Model& model, const GltfBundles& bundles, const std::vector<PlacedNode>& placed,
                 const std::vector<uint64_t>& instances, uint64_t limit) {
  constexpr double kMostBytes = 4 * kGiB;
  size_t file_bytes = 0;
  for (const tinygltf::Buffer& buffer : model.buffers) file_bytes += buffer.data.size();
  std::map<std::pair<int, bool>, Estimate> meshes;
  Estimate all;
  double draws = 0;
  for (const PlacedNode& one : placed) {
    const tinygltf::Node& node = model.nodes[size_t(one.node)];
    if (one.hidden || node.mesh < 0 || size_t(node.mesh) >= model.meshes.size()) continue;
    const std::pair<int, bool> key{node.mesh, node.skin >= 0};
    auto found = meshes.find(key);
    if (found == meshes.end())
      found = meshes
                  .emplace(key, estimateMesh(model, model.meshes[size_t(node.mesh)], bundles.of_meshes[size_t(node.mesh)], key.second,
                                             file_bytes))
                  .first;
    const uint64_t count = size_t(one.node) < instances.size() ? instances[size_t(one.node)] : 1;
    const double times = count <= file_bytes ? double(count) : 1;
    draws += times;
    all.vertices += times * found->second.vertices;
    all.bytes += times * (found->second.bytes + kBytesPerNode);
    all.lobe_bytes += times * found->second.lobe_bytes;
  }
  const std::string what = fmt::format("the {:.0f} vertices that its {:.0f} nodes with meshes draw", all.vertices, draws);
  const std::string cure = "bake the mesh once and let the engine place it, use simpler meshes, or split the file";
  requireMemory({what, all.bytes, cure}, limit, file.string());
  if (all.lobe_bytes + double(file_bytes) > kMostBytes)
    throw InputError(file.string(), fmt::format("the lobes of {}, and its buffers, take {:.1f} GiB, but a GLB holds at most 4 GiB: {}",
                                                what, (all.lobe_bytes + double(file_bytes)) / kGiB, cure));
}

}  // namespace cloudbake
