#include "io/gltf/impostor/impostor_file.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text/json.h"
#include "core/text/maker.h"
#include "io/gltf/asset_info.h"
#include "io/gltf/document.h"
#include "io/image/image.h"

namespace cloudbake {

namespace {

constexpr int kVersion = 1;

Json writeImpostorInfo(const ImpostorInfo& info) {
  Json json{{"layout", kImpostorLayout},
            {"version", kVersion},
            {"views", info.views},
            {"frame", info.frame},
            {"of", info.of == ImpostorOf::kMesh ? "mesh" : "volume"},
            {"center", numbersOf(info.center)},
            {"radius", shortest(info.radius)},
            {"box", {numbersOf(info.box.low), numbersOf(info.box.high)}},
            {"exponent", shortest(info.exponent)},
            {"extinction", shortest(info.extinction)},
            {"thickest", shortest(info.thickest)},
            {"gains", info.gains},
            {"input_hash", info.input_hash}};
  if (info.level > 0) json["level"] = info.level, json["switch_pixels"] = info.switch_pixels, json["level_of"] = info.level_of;
  return json;
}

// The chunk of buffers, and its views.
struct Binary {
  std::string bytes;
  Json views = Json::array();
  int add(std::string_view part) {
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", part.size()}});
    bytes += part;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return int(views.size()) - 1;
  }
  template <class T>
  int addValues(const std::vector<T>& values, int target) {
    const int view = add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
    views.back()["target"] = target;
    return view;
  }
};

}  // namespace

ImpostorFiles encodeImpostor(const Impostor& impostor, const Billboard& billboard) {
  const ImpostorInfo& info = impostor.info;
  ImpostorFiles files;
  files.lobe_png = encodePng(impostor.lobe[0]);
  files.rest_png = encodePng(impostor.rest[0]);

  Binary binary;
  const float r = info.radius;
  const std::vector<Vec3> corners{info.center + Vec3{-r, -r, 0}, info.center + Vec3{r, -r, 0}, info.center + Vec3{r, r, 0},
                                  info.center + Vec3{-r, r, 0}};
  const std::vector<Vec2> uvs{{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  const std::vector<uint16_t> indices{0, 1, 2, 0, 2, 3};
  Json accessors = Json::array();
  accessors.push_back({{"bufferView", binary.addValues(corners, kVertexTarget)},
                       {"componentType", kFloat},
                       {"count", 4},
                       {"type", "VEC3"},
                       {"min", numbersOf(corners[0])},
                       {"max", numbersOf(corners[2])}});
  accessors.push_back({{"bufferView", binary.addValues(uvs, kVertexTarget)}, {"componentType", kFloat}, {"count", 4}, {"type", "VEC2"}});
  accessors.push_back(
      {{"bufferView", binary.addValues(indices, kIndexTarget)}, {"componentType", kUnsignedShort}, {"count", 6}, {"type", "SCALAR"}});
  Json images = Json::array();
  const auto addImage = [&](const char* name, const std::string& png) {
    images.push_back({{"name", name}, {"mimeType", "image/png"}, {"bufferView", binary.add(png)}});
  };
  addImage("lit", encodeRgbaPng(billboard.size, billboard.size, billboard.rgba));
  addImage("lobe", files.lobe_png);
  addImage("rest", files.rest_png);

  // The material has the atlas in slots of linear values, so that loaders hand it over. An unlit material ignores them.
  constexpr int kClamp = 33071, kLinear = 9729, kLinearMips = 9987;
  Json json = {{"asset", {{"version", "2.0"}, {"generator", kMaker}}},
               {"extensionsUsed", {"KHR_materials_unlit"}},
               {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},
               {"nodes", {{{"name", "impostor"}, {"mesh", 0}}}},
               {"samplers", {{{"magFilter", kLinear}, {"minFilter", kLinearMips}, {"wrapS", kClamp}, {"wrapT", kClamp}}}}};
  json["asset"]["extras"]["cloudbake"] = writeImpostorInfo(info);
  json["meshes"] = {
      {{"name", "impostor"}, {"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}, {"material", 0}}}}}};
  json["materials"] = {{{"name", "impostor"},
                        {"alphaMode", "BLEND"},
                        {"doubleSided", true},
                        {"extensions", {{"KHR_materials_unlit", Json::object()}}},
                        {"occlusionTexture", {{"index", 2}, {"strength", 0}}},
                        {"pbrMetallicRoughness",
                         {{"baseColorTexture", {{"index", 0}}},
                          {"metallicFactor", 0},
                          {"roughnessFactor", 1},
                          {"metallicRoughnessTexture", {{"index", 1}}}}}}};
  json["textures"] = Json::array();
  for (int i = 0; i < 3; ++i) json["textures"].push_back({{"sampler", 0}, {"source", i}});
  json["images"] = images;
  json["accessors"] = accessors;
  json["bufferViews"] = binary.views;
  json["buffers"] = {{{"byteLength", binary.bytes.size()}}};
  files.glb = joinGlb("", json.dump(), binary.bytes);
  return files;
}

bool isImpostor(std::string_view bytes) { return isGltfOfLayout(bytes, kImpostorLayout); }

Impostor decodeImpostor(const std::filesystem::path& file, std::string_view bytes, uint64_t memory_limit) {
  const GlbChunks chunks = splitGlb(file, bytes);
  try {
    const auto parsed = parseJson(chunks.json);
    if (!parsed) throw InputError(file.string(), "its JSON is damaged");
    const Json& json = *parsed;
    const Json& own = json.at("asset").at("extras").at("cloudbake");
    if (own.at("layout") != kImpostorLayout) throw InputError(file.string(), "is not a lobe impostor: make one with `cloudbake impostor`");
    if (wholeNumber(own.at("version")) != kVersion)
      throw InputError(file.string(), "is an impostor of another version of the layout: make it again with `cloudbake impostor`");
    ImpostorInfo info;
    const int64_t views = wholeNumber(own.at("views")), frame = wholeNumber(own.at("frame"));
    if (views < 2 || frame < kLeastFrame || views * frame > kLargestAtlas || views > kLargestAtlas || frame > kLargestAtlas)
      throw InputError(file.string(), "the impostor's views and frame are out of range: make it again with `cloudbake impostor`");
    info.views = int(views), info.frame = int(frame);
    info.of = own.at("of") == "mesh" ? ImpostorOf::kMesh : ImpostorOf::kVolume;
    info.center = vectorOf(own.at("center"));
    info.radius = own.at("radius").get<float>();
    info.box = {vectorOf(own.at("box").at(0)), vectorOf(own.at("box").at(1))};
    info.exponent = own.at("exponent").get<float>();
    info.extinction = own.at("extinction").get<float>();
    info.thickest = own.at("thickest").get<float>();
    info.gains = own.at("gains").get<bool>();
    info.input_hash = own.at("input_hash").get<std::string>();
    if (own.contains("level")) {
      const int64_t level = wholeNumber(own.at("level")), pixels = wholeNumber(own.at("switch_pixels"));
      if (level < 1 || level > int64_t(kMostLevels) || pixels < 0 || pixels > kLargestAtlas)
        throw InputError(file.string(), "the impostor's level is out of range: plan the scene again");
      info.level = int(level), info.switch_pixels = int(pixels);
      info.level_of = own.at("level_of").get<std::string>();
    }
    for (const float number : {info.center.x, info.center.y, info.center.z, info.box.low.x, info.box.low.y, info.box.low.z, info.box.high.x,
                               info.box.high.y, info.box.high.z, info.exponent, info.extinction, info.thickest})
      if (!std::isfinite(number)) throw InputError(file.string(), "a number of the impostor is not finite in 32 bits");
    if (!(info.radius > 0) || !std::isfinite(info.radius)) throw InputError(file.string(), "the impostor's radius must be above 0");
    const auto picture = [&](const char* name) {
      const auto bytes_of_picture = imageIn(file, chunks, json, name);
      if (!bytes_of_picture)
        throw InputError(file.string(), std::string("the impostor has no picture '") + name +
                                            "': a tool has removed it; use the file that `cloudbake impostor` wrote");
      Image decoded = decodePng(*bytes_of_picture, file.string(), memory_limit);
      if (decoded.width != info.views * info.frame || decoded.height != decoded.width)
        throw InputError(file.string(), std::string("the picture '") + name + "' has another size than views times frame");
      return decoded;
    };
    Impostor impostor{info, {picture("lobe")}, {picture("rest")}};
    addMipLevels(impostor);
    return impostor;
  } catch (const Json::exception& error) {
    throw InputError(file.string(), std::string("the impostor's metadata are incomplete or damaged (") + error.what() +
                                        "): make it again with `cloudbake impostor`");
  }
}

}  // namespace cloudbake
