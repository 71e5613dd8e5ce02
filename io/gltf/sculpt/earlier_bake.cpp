// Unknown extensions may refer to anything by its number. So nothing is renumbered: what is at the end of its array is removed, and what is
// not becomes a stub that the next bake replaces.
#include "io/gltf/sculpt/earlier_bake.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/error.h"
#include "core/harmonics.h"
#include "io/gltf/keep_alive.h"

namespace cloudbake {

namespace {

using Numbers = std::set<size_t>;

size_t sizeOf(const Json& json, const char* array) { return json.contains(array) ? json[array].size() : 0; }

// Removes what is free at the end of an array, and the array if it becomes empty. The rest of `free` stays.
void dropTail(Json& json, const char* array, Numbers& free) {
  if (!json.contains(array)) return;
  Json& list = json[array];
  while (!list.empty() && free.erase(list.size() - 1) > 0) list.erase(list.size() - 1);
  if (list.empty()) json.erase(array);
}

// --- Textures ---

// Calls visit(UV set) for everything in a material that uses a texture.
template <class Visit>
void visitTextures(const Json& node, const Visit& visit) {
  if (!node.is_structured()) return;
  if (node.is_object() && node.contains("index") && node["index"].is_number_integer()) {
    const Json extensions = node.value("extensions", Json::object());
    const Json transform = extensions.is_object() ? extensions.value("KHR_texture_transform", Json::object()) : Json::object();
    visit(wholeNumber(transform, "texCoord", wholeNumber(node, "texCoord", 0)));
  }
  for (const Json& member : node) visitTextures(member, visit);
}

// The bytes of a buffer view; none if it is damaged.
std::string_view bytesOfView(const GltfDocument& document, size_t index) {
  const Json& view = document.json.at("bufferViews").at(index);
  const auto buffer = size_t(wholeNumber(view.at("buffer"))), begin = size_t(wholeNumber(view, "byteOffset", 0)),
             length = size_t(wholeNumber(view.at("byteLength")));
  if (buffer >= document.buffers.size()) return {};
  const std::vector<unsigned char>& bytes = document.buffers[buffer];
  if (begin > bytes.size() || length > bytes.size() - begin) return {};
  return {reinterpret_cast<const char*>(bytes.data()) + begin, length};
}

// The textures of the white image that bakes bind.
Numbers whiteTextures(const GltfDocument& document) {
  const Json& json = document.json;
  const auto isWhite = [&](const Json& texture) {
    const size_t image = size_t(wholeNumber(texture, "source", int64_t(sizeOf(json, "images"))));
    if (image >= sizeOf(json, "images") || !json["images"][image].contains("bufferView")) return false;
    return bytesOfView(document, size_t(wholeNumber(json["images"][image]["bufferView"]))) == whitePng();
  };
  Numbers white;
  for (size_t i = 0; i < sizeOf(json, "textures"); ++i)
    if (isWhite(json["textures"][i])) white.insert(i);
  return white;
}

// Removes the members that are uses of these textures, and objects that become empty by that.
void unbind(Json& object, const Numbers& textures) {
  for (auto member = object.begin(); member != object.end();) {
    if (!member->is_object()) {
      ++member;
      continue;
    }
    const Json index = member->value("index", Json());
    const bool is_bound = index.is_number_integer() && textures.contains(index.get<size_t>());
    const bool was_empty = member->empty();
    if (!is_bound) unbind(*member, textures);
    if (is_bound || (member->empty() && !was_empty))
      member = object.erase(member);
    else
      ++member;
  }
}

// Removes the white textures from the materials, and from the document if they are the last of all. One that stays is used again.
void removeWhiteTextures(GltfDocument& document) {
  Json& json = document.json;
  Numbers white = whiteTextures(document);
  if (white.empty() || !json.contains("materials")) return;
  for (Json& material : json["materials"]) unbind(material, white);
  Numbers images, samplers;
  for (const size_t texture : white) {
    images.insert(size_t(wholeNumber(json["textures"][texture]["source"])));
    if (json["textures"][texture].contains("sampler")) samplers.insert(size_t(wholeNumber(json["textures"][texture]["sampler"])));
  }
  dropTail(json, "textures", white);
  if (!white.empty()) document.white_texture = int(*white.begin());
  for (size_t i = 0; i < sizeOf(json, "textures"); ++i) {
    images.erase(size_t(wholeNumber(json["textures"][i], "source", -1)));
    samplers.erase(size_t(wholeNumber(json["textures"][i], "sampler", -1)));
  }
  dropTail(json, "images", images);
  dropTail(json, "samplers", samplers);
}

bool isUsedByArtist(const Json& json, int set) {
  bool used = false;
  for (const Json& material : json.value("materials", Json::array()))
    visitTextures(material, [&](int64_t of_texture) { used = used || of_texture == set || of_texture == set + 1; });
  return used;
}

// --- Attributes ---

// Removes the attributes of a bake from all primitives. Returns their accessors.
Numbers removeAttributes(Json& json, const std::vector<std::string>& names) {
  Numbers removed;
  for (Json& mesh : json.at("meshes"))
    for (Json& primitive : mesh.at("primitives"))
      for (const std::string& name : names) {
        Json& attributes = primitive.at("attributes");
        if (!attributes.contains(name)) continue;
        const auto accessor = size_t(wholeNumber(attributes[name]));
        if (name == "_OCCLUSION" && json.at("accessors").at(accessor).value("type", "") != "VEC4") continue;  // it is not of a bake
        removed.insert(accessor);
        attributes.erase(name);
      }
  return removed;
}

// --- Bytes ---

// Clears the lobes of packed vertices, which share their bytes with positions: what is left must not depend on the bake.
void clearPackedLobes(GltfDocument& document, int first_set) {
  Json& json = document.json;
  const auto clear = [&](size_t index, size_t from) {
    const Json& accessor = json.at("accessors").at(index);
    if (wholeNumber(accessor.at("componentType")) == kFloat || !accessor.contains("bufferView")) return;
    const Json& view = json.at("bufferViews").at(size_t(wholeNumber(accessor["bufferView"])));
    const auto buffer = size_t(wholeNumber(view.at("buffer"))), count = size_t(wholeNumber(accessor.at("count"))),
               begin = size_t(wholeNumber(view, "byteOffset", 0)) + size_t(wholeNumber(accessor, "byteOffset", 0)),
               stride = size_t(wholeNumber(view, "byteStride", 4));
    if (buffer >= document.buffers.size()) return;
    std::vector<unsigned char>& bytes = document.buffers[buffer];
    for (size_t at = begin + from; at + 4 - from <= bytes.size() && at < begin + count * stride; at += stride)
      std::fill_n(bytes.begin() + std::ptrdiff_t(at), 4 - from, static_cast<unsigned char>(0));
  };
  for (const Json& mesh : json.at("meshes"))
    for (const Json& primitive : mesh.at("primitives")) {
      const Json& attributes = primitive.at("attributes");
      if (!attributes.contains(uvSetName(first_set)) || !attributes.contains(uvSetName(first_set + 1))) continue;
      clear(size_t(wholeNumber(attributes[uvSetName(first_set)])), 0);
      clear(size_t(wholeNumber(attributes[uvSetName(first_set + 1)])), 2);  // its first number is a coordinate
    }
}

void collectViews(const Json& node, Numbers& views) {
  if (!node.is_structured()) return;
  for (auto item = node.begin(); item != node.end(); ++item)
    if (node.is_object() && item.key() == "bufferView" && item->is_number_unsigned())
      views.insert(item->get<size_t>());
    else
      collectViews(*item, views);
}

using Ranges = std::map<size_t, size_t>;  // begin → end

bool overlaps(const Ranges& ranges, size_t begin, size_t end) {
  const auto next = ranges.lower_bound(end);
  return next != ranges.begin() && std::prev(next)->second > begin;
}

// Adds a range, joined with those that it meets.
void add(Ranges& ranges, size_t begin, size_t end) {
  for (auto next = ranges.upper_bound(begin); next != ranges.begin() && std::prev(next)->second >= begin;) {
    next = std::prev(next);
    begin = next->first, end = std::max(end, next->second);
    next = ranges.erase(next);
  }
  for (auto next = ranges.lower_bound(begin); next != ranges.end() && next->first <= end; next = ranges.erase(next))
    end = std::max(end, next->second);
  ranges[begin] = end;
}

// Cuts the bytes of free views out of a buffer, in whole words so that everything stays aligned, unless other views share them.
void cutBytes(GltfDocument& document, size_t buffer, const Numbers& free_views) {
  std::vector<unsigned char>& bytes = document.buffers[buffer];
  Json& views = document.json["bufferViews"];
  Ranges kept, cuts;
  const auto visit = [&](bool are_free, const auto& take) {
    for (size_t i = 0; i < views.size(); ++i) {
      if (free_views.contains(i) != are_free || size_t(wholeNumber(views[i].at("buffer"))) != buffer) continue;
      const auto begin = size_t(wholeNumber(views[i], "byteOffset", 0)), length = size_t(wholeNumber(views[i].at("byteLength")));
      if (begin <= bytes.size() && length <= bytes.size() - begin) take(views[i], begin, begin + length);
    }
  };
  visit(false, [&](Json&, size_t begin, size_t end) { add(kept, begin, end); });
  visit(true, [&](Json&, size_t begin, size_t end) {
    const size_t padded = std::min((end + 3) / 4 * 4, bytes.size());
    if (begin % 4 == 0 && !overlaps(kept, begin, padded)) add(cuts, begin, padded);
  });
  std::vector<unsigned char> rest;
  std::map<size_t, size_t> cut_before;  // the end of a cut → bytes that are cut up to there
  size_t copied = 0;
  for (const auto& [begin, end] : cuts) {
    rest.insert(rest.end(), bytes.begin() + std::ptrdiff_t(copied), bytes.begin() + std::ptrdiff_t(begin));
    copied = end;
    cut_before[end] = end - rest.size();
  }
  rest.insert(rest.end(), bytes.begin() + std::ptrdiff_t(copied), bytes.end());
  if (cuts.empty() || rest.empty()) return;  // a buffer has at least a byte
  size_t last = 0;
  visit(false, [&](Json& view, size_t begin, size_t end) {
    const auto after = cut_before.upper_bound(begin);
    const size_t cut = after == cut_before.begin() ? 0 : std::prev(after)->second;
    if (cut > 0) view["byteOffset"] = begin - cut;
    last = std::max(last, end - cut);
  });
  if (rest.size() - last < 4) rest.resize(last);  // what aligned the first bytes that were cut
  bytes = std::move(rest);
  if (buffer < sizeOf(document.json, "buffers")) document.json["buffers"][buffer]["byteLength"] = bytes.size();
}

}  // namespace

void removeEarlierBake(GltfDocument& document) {
  Json& json = document.json;
  if (isImpostorDocument(json))
    throw InputError(document.file.string(), "is an impostor, which is pictures and no mesh: give the sculpt or the baked asset");
  if (isSequenceDocument(json))
    throw InputError(document.file.string(), "is a sequence of clouds that were baked: bake the frames that it was made of");
  const auto info = readInfo(json);
  if (!info) return;
  document.was_baked = true;
  Numbers views, still_used;
  collectViews(json, views);
  removeWhiteTextures(document);
  std::vector<std::string> names{"_OCCLUSION"};
  for (int i = 0; i < int(kMaxHarmonics) / 4; ++i) names.push_back(harmonicsName(i));
  if (!isUsedByArtist(json, info->first_uv_set)) {
    document.earlier_set = info->first_uv_set;
    names.insert(names.end(), {uvSetName(info->first_uv_set), uvSetName(info->first_uv_set + 1)});
  }
  if (info->density_max > 0 && document.earlier_set >= 0) clearPackedLobes(document, document.earlier_set);
  Numbers accessors = removeAttributes(json, names);
  for (const size_t used : accessorsInUse(json)) accessors.erase(used);
  for (const size_t accessor : accessors) json.at("accessors").at(accessor) = {{"componentType", kFloat}, {"count", 1}, {"type", "SCALAR"}};
  dropTail(json, "accessors", accessors);
  collectViews(json, still_used);
  for (const size_t view : still_used) views.erase(view);
  for (size_t buffer = 0; buffer < document.buffers.size(); ++buffer) cutBytes(document, buffer, views);
  for (const size_t view : views) json["bufferViews"][view] = {{"buffer", json["bufferViews"][view].at("buffer")}, {"byteLength", 1}};
  dropTail(json, "bufferViews", views);
  document.free_accessors = std::move(accessors);
  document.free_views = std::move(views);
}

}  // namespace cloudbake
