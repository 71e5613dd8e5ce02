// glTF 2.0, section 5 ("Properties Reference"): tables of what each object has in it. tinygltf takes a value of a wrong type for a missing
// one, and nlohmann's messages do not say where it is.
#include "io/gltf/value_types.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace cloudbake {

namespace {

// kIndex counts things of the document, or is one of its numbered constants. kSize counts bytes or elements.
enum class Kind { kObject, kText, kFlag, kNumber, kIndex, kSize };
enum class Many { kOne, kList, kByName, kListByName };

// A value of an object, or each one of a list or an object of values.
struct Member {
  const char* key;
  Kind kind;
  Many many = Many::kOne;
  const Member* members = nullptr;  // of kObject
  size_t member_count = 0;
  size_t length = 0;  // of a list; 0 is any
  bool needed = false;
};

template <size_t kCount>
constexpr Member object(const char* key, const Member (&members)[kCount], Many many = Many::kOne) {
  return {key, Kind::kObject, many, members, kCount};
}
constexpr Member list(const char* key, Kind kind, size_t length = 0) { return {key, kind, Many::kList, nullptr, 0, length}; }
constexpr Member byName(const char* key, Kind kind) { return {key, kind, Many::kByName}; }
constexpr Member needed(Member member) {
  member.needed = true;
  return member;
}

constexpr Member kNameMember{"name", Kind::kText};
constexpr Member kExtensionsMember = byName("extensions", Kind::kObject);

constexpr Member kAssetMembers[] = {needed({"version", Kind::kText}),
                                    {"minVersion", Kind::kText},
                                    {"generator", Kind::kText},
                                    {"copyright", Kind::kText},
                                    kExtensionsMember};

constexpr Member kSceneMembers[] = {kNameMember, list("nodes", Kind::kIndex), kExtensionsMember};
constexpr Member kInstancingMembers[] = {byName("attributes", Kind::kIndex)};
constexpr Member kVisibilityMembers[] = {{"visible", Kind::kFlag}};
constexpr Member kNodeExtensionsMembers[] = {object("EXT_mesh_gpu_instancing", kInstancingMembers),
                                             object("KHR_node_visibility", kVisibilityMembers)};
constexpr Member kNodeMembers[] = {kNameMember,
                                   list("children", Kind::kIndex),
                                   list("matrix", Kind::kNumber, 16),
                                   list("translation", Kind::kNumber, 3),
                                   list("rotation", Kind::kNumber, 4),
                                   list("scale", Kind::kNumber, 3),
                                   list("weights", Kind::kNumber),
                                   {"mesh", Kind::kIndex},
                                   {"skin", Kind::kIndex},
                                   {"camera", Kind::kIndex},
                                   kExtensionsMember,
                                   object("extensions", kNodeExtensionsMembers)};
constexpr Member kSkinMembers[] = {kNameMember,
                                   needed(list("joints", Kind::kIndex)),
                                   {"skeleton", Kind::kIndex},
                                   {"inverseBindMatrices", Kind::kIndex},
                                   kExtensionsMember};

constexpr Member kDracoMembers[] = {{"bufferView", Kind::kIndex}, byName("attributes", Kind::kIndex)};
constexpr Member kPrimitiveExtensionsMembers[] = {object("KHR_draco_mesh_compression", kDracoMembers)};
constexpr Member kPrimitiveMembers[] = {needed(byName("attributes", Kind::kIndex)),
                                        {"indices", Kind::kIndex},
                                        {"material", Kind::kIndex},
                                        {"mode", Kind::kIndex},
                                        {"targets", Kind::kIndex, Many::kListByName},
                                        kExtensionsMember,
                                        object("extensions", kPrimitiveExtensionsMembers)};
constexpr Member kMeshMembers[] = {kNameMember, needed(object("primitives", kPrimitiveMembers, Many::kList)),
                                   list("weights", Kind::kNumber), kExtensionsMember};

constexpr Member kSparseIndicesMembers[] = {
    needed({"bufferView", Kind::kIndex}), {"byteOffset", Kind::kSize}, needed({"componentType", Kind::kIndex}), kExtensionsMember};
constexpr Member kSparseValuesMembers[] = {needed({"bufferView", Kind::kIndex}), {"byteOffset", Kind::kSize}, kExtensionsMember};
constexpr Member kSparseMembers[] = {needed({"count", Kind::kSize}), needed(object("indices", kSparseIndicesMembers)),
                                     needed(object("values", kSparseValuesMembers)), kExtensionsMember};
constexpr Member kAccessorMembers[] = {kNameMember,
                                       {"bufferView", Kind::kIndex},
                                       {"byteOffset", Kind::kSize},
                                       needed({"componentType", Kind::kIndex}),
                                       {"normalized", Kind::kFlag},
                                       needed({"count", Kind::kSize}),
                                       needed({"type", Kind::kText}),
                                       list("min", Kind::kNumber),
                                       list("max", Kind::kNumber),
                                       object("sparse", kSparseMembers),
                                       kExtensionsMember};
constexpr Member kMeshoptMembers[] = {{"buffer", Kind::kIndex},    {"byteOffset", Kind::kSize}, {"byteLength", Kind::kSize},
                                      {"byteStride", Kind::kSize}, {"count", Kind::kSize},      {"mode", Kind::kText},
                                      {"filter", Kind::kText}};
constexpr Member kViewExtensionsMembers[] = {object("EXT_meshopt_compression", kMeshoptMembers),
                                             object("KHR_meshopt_compression", kMeshoptMembers)};
constexpr Member kViewMembers[] = {kNameMember,
                                   needed({"buffer", Kind::kIndex}),
                                   {"byteOffset", Kind::kSize},
                                   needed({"byteLength", Kind::kSize}),
                                   {"byteStride", Kind::kSize},
                                   {"target", Kind::kIndex},
                                   kExtensionsMember,
                                   object("extensions", kViewExtensionsMembers)};
constexpr Member kBufferMembers[] = {kNameMember, {"uri", Kind::kText}, needed({"byteLength", Kind::kSize}), kExtensionsMember};

constexpr Member kTextureTransformMembers[] = {
    list("offset", Kind::kNumber, 2), {"rotation", Kind::kNumber}, list("scale", Kind::kNumber, 2), {"texCoord", Kind::kIndex}};
constexpr Member kUseExtensionsMembers[] = {object("KHR_texture_transform", kTextureTransformMembers)};
constexpr Member kTextureUseMembers[] = {{"index", Kind::kIndex},  {"texCoord", Kind::kIndex},
                                         {"scale", Kind::kNumber}, {"strength", Kind::kNumber},
                                         kExtensionsMember,        object("extensions", kUseExtensionsMembers)};
constexpr Member kMetallicRoughnessMembers[] = {
    list("baseColorFactor", Kind::kNumber, 4), object("baseColorTexture", kTextureUseMembers),         {"metallicFactor", Kind::kNumber},
    {"roughnessFactor", Kind::kNumber},        object("metallicRoughnessTexture", kTextureUseMembers), kExtensionsMember};
constexpr Member kMaterialMembers[] = {kNameMember,
                                       object("pbrMetallicRoughness", kMetallicRoughnessMembers),
                                       object("normalTexture", kTextureUseMembers),
                                       object("occlusionTexture", kTextureUseMembers),
                                       object("emissiveTexture", kTextureUseMembers),
                                       list("emissiveFactor", Kind::kNumber, 3),
                                       {"alphaMode", Kind::kText},
                                       {"alphaCutoff", Kind::kNumber},
                                       {"doubleSided", Kind::kFlag},
                                       kExtensionsMember};
constexpr Member kTextureMembers[] = {kNameMember, {"sampler", Kind::kIndex}, {"source", Kind::kIndex}, kExtensionsMember};
constexpr Member kSamplerMembers[] = {
    kNameMember,      {"magFilter", Kind::kIndex}, {"minFilter", Kind::kIndex}, {"wrapS", Kind::kIndex}, {"wrapT", Kind::kIndex},
    kExtensionsMember};
constexpr Member kImageMembers[] = {
    kNameMember, {"uri", Kind::kText}, {"mimeType", Kind::kText}, {"bufferView", Kind::kIndex}, kExtensionsMember};

constexpr Member kAnimationTargetMembers[] = {{"node", Kind::kIndex}, {"path", Kind::kText}, kExtensionsMember};
constexpr Member kChannelMembers[] = {{"sampler", Kind::kIndex}, object("target", kAnimationTargetMembers), kExtensionsMember};
constexpr Member kAnimationSamplerMembers[] = {
    {"input", Kind::kIndex}, {"output", Kind::kIndex}, {"interpolation", Kind::kText}, kExtensionsMember};
constexpr Member kAnimationMembers[] = {kNameMember, object("channels", kChannelMembers, Many::kList),
                                        object("samplers", kAnimationSamplerMembers, Many::kList), kExtensionsMember};
constexpr Member kPerspectiveMembers[] = {
    {"aspectRatio", Kind::kNumber}, {"yfov", Kind::kNumber}, {"znear", Kind::kNumber}, {"zfar", Kind::kNumber}, kExtensionsMember};
constexpr Member kOrthographicMembers[] = {
    {"xmag", Kind::kNumber}, {"ymag", Kind::kNumber}, {"znear", Kind::kNumber}, {"zfar", Kind::kNumber}, kExtensionsMember};
constexpr Member kCameraMembers[] = {kNameMember,
                                     {"type", Kind::kText},
                                     object("perspective", kPerspectiveMembers),
                                     object("orthographic", kOrthographicMembers),
                                     kExtensionsMember};

constexpr Member kDocumentMembers[] = {needed(object("asset", kAssetMembers)),
                                       {"scene", Kind::kIndex},
                                       object("scenes", kSceneMembers, Many::kList),
                                       object("nodes", kNodeMembers, Many::kList),
                                       object("meshes", kMeshMembers, Many::kList),
                                       object("skins", kSkinMembers, Many::kList),
                                       object("accessors", kAccessorMembers, Many::kList),
                                       object("bufferViews", kViewMembers, Many::kList),
                                       object("buffers", kBufferMembers, Many::kList),
                                       object("materials", kMaterialMembers, Many::kList),
                                       object("textures", kTextureMembers, Many::kList),
                                       object("samplers", kSamplerMembers, Many::kList),
                                       object("images", kImageMembers, Many::kList),
                                       object("animations", kAnimationMembers, Many::kList),
                                       object("cameras", kCameraMembers, Many::kList),
                                       list("extensionsUsed", Kind::kText),
                                       list("extensionsRequired", Kind::kText),
                                       kExtensionsMember};

// A value while its surroundings are visited; a path is made for messages alone.
struct ValuePlace {
  const ValuePlace* outer = nullptr;
  std::string_view key{};  // empty for an element of a list
  size_t index = 0;

  std::string text() const {
    if (!outer) return "";
    if (key.empty()) return outer->text() + "[" + std::to_string(index) + "]";
    return outer->outer ? outer->text() + "." + std::string(key) : std::string(key);
  }
};

bool isWhole(const Json& value, uint64_t most) {
  return value.is_number_integer() && (value.is_number_unsigned() || value.get<int64_t>() >= 0) && value.get<uint64_t>() <= most;
}

bool fits(const Json& value, Kind kind) {
  switch (kind) {
    case Kind::kObject: return value.is_object();
    case Kind::kText: return value.is_string();
    case Kind::kFlag: return value.is_boolean();
    case Kind::kNumber: return value.is_number();
    case Kind::kIndex: return isWhole(value, std::numeric_limits<int>::max());
    case Kind::kSize: return isWhole(value, std::numeric_limits<int64_t>::max());
  }
  return false;
}

const char* nameOf(Kind kind, bool several) {
  switch (kind) {
    case Kind::kObject: return several ? "objects" : "an object";
    case Kind::kText: return several ? "texts" : "a text";
    case Kind::kFlag: return several ? "true or false each" : "true or false";
    case Kind::kNumber: return several ? "numbers" : "a number";
    case Kind::kIndex: return several ? "whole numbers from 0 to 2147483647" : "a whole number from 0 to 2147483647";
    case Kind::kSize: return several ? "whole numbers from 0 to 2^63 - 1" : "a whole number from 0 to 2^63 - 1";
  }
  return "";
}

std::string wantedText(const Member& member) {
  if (member.many == Many::kOne) return nameOf(member.kind, false);
  const std::string what = (member.length > 0 ? std::to_string(member.length) + " " : "") + nameOf(member.kind, true);
  return member.many == Many::kByName ? "an object of " + what
         : member.many == Many::kList ? "a list of " + what
                                      : "a list of objects of " + what;
}

struct ValueChecker {
  const std::filesystem::path& file;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file.string(), what + "; the file is damaged, export it again");
  }

  void checkOne(const Json& value, const Member& member, const ValuePlace& place) const {
    if (!fits(value, member.kind)) fail(place.text() + " is " + valueText(value) + ", not " + nameOf(member.kind, false));
    for (size_t i = 0; i < member.member_count; ++i) check(value, member.members[i], place);
  }

  void checkAll(const Json& values, const Member& member, const ValuePlace& place, bool is_list) const {
    if ((is_list ? !values.is_array() : !values.is_object()) || (member.length > 0 && values.size() != member.length))
      fail(place.text() + " is " + valueText(values) + ", not " + wantedText(member));
    size_t index = 0;
    for (auto item = values.begin(); item != values.end(); ++item, ++index) {
      const ValuePlace own{&place, is_list ? std::string_view() : std::string_view(item.key()), index};
      if (member.many == Many::kListByName && is_list)
        checkAll(*item, member, own, false);
      else
        checkOne(*item, member, own);
    }
  }

  void check(const Json& object, const Member& member, const ValuePlace& owner) const {
    const auto found = object.find(member.key);
    if (found == object.end()) {
      if (member.needed) fail((owner.outer ? owner.text() : "the glTF") + " has no " + member.key);
      return;
    }
    const ValuePlace place{&owner, member.key};
    if (member.many == Many::kOne)
      checkOne(*found, member, place);
    else
      checkAll(*found, member, place, member.many != Many::kByName);
  }
};

}  // namespace

void checkValueTypes(const std::filesystem::path& file, const Json& document) {
  const ValueChecker checker{file};
  for (const Member& member : kDocumentMembers) checker.check(document, member, {});
}

std::string valueText(const Json& value) {
  constexpr size_t kLongest = 40;
  if (value.is_object()) return "an object";
  if (value.is_array()) return value.empty() ? "an empty list" : "a list of " + std::to_string(value.size());
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() > kLongest ? text.substr(0, kLongest) + "…" : text;
}

}  // namespace cloudbake
