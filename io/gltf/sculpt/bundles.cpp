#include "io/gltf/sculpt/bundles.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>

#include "core/error.h"
#include "io/gltf/accessor.h"
#include "io/gltf/sculpt/edit_vertices.h"

namespace cloudbake {

namespace {

using Attributes = std::map<std::string, int>;

// Accessors are often written once per primitive, with the same bytes.
std::vector<int> findAlike(const tinygltf::Model& model) {
  using Data = std::tuple<int, size_t, size_t, int, int, bool, size_t>;  // buffer, offset, stride, types, count
  std::map<Data, int> known;
  std::vector<int> first;
  for (size_t i = 0; i < model.accessors.size(); ++i) {
    const tinygltf::Accessor& accessor = model.accessors[i];
    first.push_back(int(i));
    if (accessor.sparse.isSparse || accessor.bufferView < 0 || size_t(accessor.bufferView) >= model.bufferViews.size()) continue;
    const tinygltf::BufferView& view = model.bufferViews[size_t(accessor.bufferView)];
    first.back() = known
                       .try_emplace({view.buffer, view.byteOffset + accessor.byteOffset, view.byteStride, accessor.type,
                                     accessor.componentType, accessor.normalized, accessor.count},
                                    int(i))
                       .first->second;
  }
  return first;
}

struct Finder {
  const std::vector<int>& first_alike;

  int alike(int accessor) const {
    return accessor < 0 || size_t(accessor) >= first_alike.size() ? accessor : first_alike[size_t(accessor)];
  }
  Attributes alike(Attributes attributes) const {
    for (auto& [name, accessor] : attributes) accessor = alike(accessor);
    return attributes;
  }

  std::vector<GltfBundle> bundlesOf(const tinygltf::Mesh& mesh) const {
    std::vector<GltfBundle> bundles;
    std::map<std::tuple<Attributes, std::vector<Attributes>, std::vector<std::string>>, size_t> known;
    for (size_t i = 0; i < mesh.primitives.size(); ++i) {
      const tinygltf::Primitive& primitive = mesh.primitives[i];
      if (!hasSurface(primitive)) continue;
      std::vector<Attributes> targets;
      for (const Attributes& target : primitive.targets) targets.push_back(alike(target));
      const auto [entry, is_new] =
          known.try_emplace({alike(primitive.attributes), std::move(targets), vertexExtensions(primitive)}, bundles.size());
      if (is_new) bundles.emplace_back();
      bundles[entry->second].push_back(int(i));
    }
    return bundles;
  }
};

// Whether all attributes exist and have a row per vertex, and nothing else refers to vertices by their numbers.
bool canBeRenumbered(const tinygltf::Model& model, const tinygltf::Primitive& primitive, size_t vertices) {
  const auto fit = [&](const Attributes& attributes) {
    return std::all_of(attributes.begin(), attributes.end(), [&](const auto& one) {
      return one.second >= 0 && size_t(one.second) < model.accessors.size() && model.accessors[size_t(one.second)].count == vertices;
    });
  };
  return vertexExtensions(primitive).empty() && fit(primitive.attributes) &&
         std::all_of(primitive.targets.begin(), primitive.targets.end(), fit);
}

size_t countAt(const tinygltf::Model& model, int accessor) {
  return accessor < 0 || size_t(accessor) >= model.accessors.size() ? 0 : model.accessors[size_t(accessor)].count;
}

// What a bundle uses, if it is at most half of its vertices.
class UseFinder {
 public:
  UseFinder(const std::filesystem::path& file, const tinygltf::Model& model, const GltfBundles& bundles)
      : accessors_{file, model}, finder_{bundles.first_alike} {}

  std::optional<FewVertices> find(int mesh, const GltfBundle& bundle, size_t vertices) {
    std::set<int> distinct;
    for (const int index : bundle) distinct.insert(finder_.alike(primitive(mesh, index).indices));
    std::vector<uint32_t> used;
    for (const int accessor : distinct) {
      const std::vector<uint32_t>& of_one = usedBy(accessor);
      used.insert(used.end(), of_one.begin(), of_one.end());
    }
    used = distinctNumbers(std::move(used));
    if (used.empty() || used.back() >= vertices || 2 * used.size() > vertices) return std::nullopt;
    FewVertices few{mesh, bundle, vertices, std::move(used)};
    for (const int index : bundle) {
      std::vector<uint32_t>& own = few.indices.emplace_back(accessors_.readIndices(primitive(mesh, index).indices, "a primitive"));
      for (uint32_t& v : own) v = uint32_t(std::lower_bound(few.kept.begin(), few.kept.end(), v) - few.kept.begin());
    }
    return few;
  }

 private:
  const tinygltf::Primitive& primitive(int mesh, int index) const {
    return accessors_.model.meshes[size_t(mesh)].primitives[size_t(index)];
  }

  const std::vector<uint32_t>& usedBy(int accessor) {
    const auto [entry, is_new] = used_.try_emplace(accessor);
    if (!is_new) return entry->second;
    return entry->second = distinctNumbers(accessors_.readIndices(accessor, "a primitive"));
  }

  GltfAccessors accessors_;
  Finder finder_;
  std::map<int, std::vector<uint32_t>> used_;
};

}  // namespace

int GltfBundles::positionsOf(const tinygltf::Primitive& primitive) const {
  const int accessor = primitive.attributes.at("POSITION");
  return accessor < 0 || size_t(accessor) >= first_alike.size() ? -1 : first_alike[size_t(accessor)];
}

bool hasSurface(const tinygltf::Primitive& primitive) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  return mode >= TINYGLTF_MODE_TRIANGLES && mode <= TINYGLTF_MODE_TRIANGLE_FAN && primitive.attributes.contains("POSITION");
}

std::vector<std::string> vertexExtensions(const tinygltf::Primitive& primitive) {
  std::vector<std::string> names;
  for (const auto& [name, extension] : primitive.extensions)
    if (name != "KHR_materials_variants") names.push_back(name);
  return names;
}

GltfBundles findBundles(const tinygltf::Model& model) {
  GltfBundles bundles{findAlike(model), {}};
  for (const tinygltf::Mesh& mesh : model.meshes) bundles.of_meshes.push_back(Finder{bundles.first_alike}.bundlesOf(mesh));
  return bundles;
}

std::vector<FewVertices> fewOfShared(const std::filesystem::path& file, const tinygltf::Model& model, const GltfBundles& bundles,
                                     const std::vector<uint64_t>& draws, uint64_t limit) {
  std::map<int, uint64_t> draws_of_positions;
  const auto visit = [&](const auto& take) {
    for (size_t m = 0; m < model.meshes.size(); ++m)
      for (const GltfBundle& bundle : bundles.of_meshes[m])
        if (draws[m] > 0) take(int(m), bundle, model.meshes[m].primitives[size_t(bundle.front())]);
  };
  visit([&](int mesh, const GltfBundle&, const tinygltf::Primitive& first) {
    draws_of_positions[bundles.positionsOf(first)] += draws[size_t(mesh)];
  });

  std::vector<std::pair<int, const GltfBundle*>> sharing;
  double bytes = 0;
  visit([&](int mesh, const GltfBundle& bundle, const tinygltf::Primitive& first) {
    const size_t vertices = countAt(model, first.attributes.at("POSITION"));
    if (draws_of_positions[bundles.positionsOf(first)] < 2 || !canBeRenumbered(model, first, vertices)) return;
    for (const int index : bundle) {
      const int indices = model.meshes[size_t(mesh)].primitives[size_t(index)].indices;
      if (indices < 0) return;  // all vertices in their order
      bytes += 3.0 * sizeof(uint32_t) * double(countAt(model, indices));
    }
    sharing.emplace_back(mesh, &bundle);
  });
  std::vector<FewVertices> few;
  if (bytes > double(limit)) return few;
  UseFinder finder(file, model, bundles);
  for (const auto& [mesh, bundle] : sharing) {
    const tinygltf::Primitive& first = model.meshes[size_t(mesh)].primitives[size_t(bundle->front())];
    try {
      if (auto found = finder.find(mesh, *bundle, countAt(model, first.attributes.at("POSITION")))) few.push_back(std::move(*found));
    } catch (const InputError&) {  // the reader will report it
    }
  }
  return few;
}

void giveOwnVertices(GltfDocument& document, const std::vector<FewVertices>& few) {
  std::set<GltfPrimitive> edited;
  for (const FewVertices& one : few)
    for (const int index : one.bundle) edited.emplace(one.mesh, index);
  VertexEditor editor(std::move(document), edited);
  for (const FewVertices& one : few) {
    editor.keepVertices(one.mesh, one.bundle, one.kept, one.vertices);
    for (size_t i = 0; i < one.bundle.size(); ++i) editor.setIndices({one.mesh, one.bundle[i]}, one.indices[i], one.kept.size());
  }
  document = std::move(editor).result();
}

}  // namespace cloudbake
