// glTF 2.0, sections 3.8 and 3.9: baseColorFactor and COLOR_0 are linear, baseColorTexture is encoded in sRGB, and texture coordinates
// begin at the upper left corner of the image. KHR_texture_transform (Khronos): uv' = offset + R·(scale·uv), with R counter-clockwise where
// v points down.
#include "io/gltf/asset/own_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/image.h"
#include "core/portable_math.h"
#include "core/srgb.h"
#include "core/text/base64.h"
#include "core/text/json.h"
#include "io/file/neighbour.h"
#include "io/gltf/accessor.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/named_files.h"
#include "io/gltf/sculpt/load.h"
#include "io/image/image.h"

namespace cloudbake {

namespace {

// Values of wrapS and wrapT.
enum Wrap { kRepeats = 10497, kClamps = 33071, kMirrors = 33648 };

// A texel beyond the image, by the wrap mode.
int64_t wrapped(int64_t texel, int64_t size, int wrap) {
  if (wrap == kClamps) return std::clamp<int64_t>(texel, 0, size - 1);
  const int64_t period = wrap == kMirrors ? 2 * size : size, within = (texel % period + period) % period;
  return within < size ? within : 2 * size - 1 - within;
}

/// An image as a texture has it. Pixels are encoded in sRGB.
struct Texture {
  std::shared_ptr<const Image> image;
  int wrap_s = kRepeats, wrap_t = kRepeats;

  Vec3 texel(int64_t x, int64_t y) const {
    const Vec3& p = image->at(int(wrapped(x, image->width, wrap_s)), int(wrapped(y, image->height, wrap_t)));
    return {linearOfSrgb(p.x), linearOfSrgb(p.y), linearOfSrgb(p.z)};
  }
  // Bilinear between linear colours.
  Vec3 at(double u, double v) const {
    constexpr double kFar = 1e9;  // texels, beyond which a float has no fraction
    const double x = u * image->width - 0.5, y = v * image->height - 0.5;
    if (!(std::abs(x) < kFar && std::abs(y) < kFar)) return texel(0, 0);
    const auto left = int64_t(std::floor(x)), top = int64_t(std::floor(y));
    const auto part_x = float(x - double(left)), part_y = float(y - double(top));
    const auto row = [&](int64_t at_y) {
      const Vec3 first = texel(left, at_y);
      return first + (texel(left + 1, at_y) - first) * part_x;
    };
    const Vec3 upper = row(top);
    return upper + (row(top + 1) - upper) * part_y;
  }
};

/// The use of a texture by a material.
struct TextureUse {
  Texture texture;
  int uv_set = 0;
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation = 0;

  Vec3 at(double u, double v) const {
    const double x = scale[0] * u, y = scale[1] * v;
    const auto [s, c] = sinCosDegrees(rotation * (180 / kPi));
    return texture.at(offset[0] + c * x + s * y, offset[1] - s * x + c * y);
  }
};

struct Material {
  Vec3 factor{1, 1, 1};
  std::optional<TextureUse> texture;
  bool isWhite() const { return factor == Vec3{1, 1, 1} && !texture; }
};

// A grey is what modelling programs give to materials that nobody has set: 0.8 in Blender, 0.5 in Maya.
bool isGrey(Vec3 color) { return color.x == color.y && color.y == color.z; }

// As the texture that keeps the UV sets of a material without one.
bool isAllWhite(const Image& image) {
  return std::ranges::all_of(image.pixels, [](Vec3 color) { return color == Vec3{1, 1, 1}; });
}

Vec3 limited(Vec3 color) {
  const auto limit = [](float x) { return x > 0 ? std::min(x, 1.0F) : 0; };
  return {limit(color.x), limit(color.y), limit(color.z)};
}

class ColorReader {
 public:
  ColorReader(const LoadedGltf& loaded, const ReadSettings& settings, Warnings& warnings)
      : loaded_(loaded), json_(loaded.document->json), file_(loaded.document->file), settings_(settings), warnings_(warnings) {}

  std::vector<Vec3> read() {
    std::vector<Vec3> colors;
    for (size_t i = 0; i < loaded_.sculpt.parts.size(); ++i) addPart(i, colors);
    const bool is_white = std::ranges::all_of(colors, [](Vec3 color) { return color == Vec3{1, 1, 1}; });
    return is_white ? std::vector<Vec3>() : colors;
  }

 private:
  void ignore(const std::string& what) {
    warnings_.add(WarningKind::kTextureIgnored, file_.string() + ": " + what + ": white is shown in its place");
  }

  // Reads something; if that fails, warns and returns what stands for it.
  template <typename Value, typename Read>
  Value orElse(Value fallback, const std::string& what, const Read& read) {
    try {
      return read();
    } catch (const Json::exception& error) {
      ignore(what + " cannot be read (" + error.what() + ")");
    } catch (const Error& error) {
      ignore(what + " cannot be read (" + error.message + ")");
    }
    return fallback;
  }

  void addPart(size_t index, std::vector<Vec3>& colors) {
    const SculptPart& part = loaded_.sculpt.parts[index];
    const GltfPlace& place = loaded_.document->places[index];
    const size_t begin = colors.size();
    colors.resize(begin + part.positions.size(), {1, 1, 1});
    std::vector<bool> is_known(part.positions.size());
    size_t first = 0;
    for (const GltfStretch& stretch : place.stretches) {
      const auto& primitive = loaded_.model.meshes[size_t(place.mesh)].primitives[size_t(stretch.primitive)];
      const std::vector<Vec3> own = colorsOf(primitive, part.positions.size(), "'" + part.name + "'");
      const size_t end = std::min(first + stretch.triangles, part.triangles.size());
      for (size_t t = first; t < end; ++t)
        for (const uint32_t v : part.triangles[t]) {
          if (!own.empty() && !is_known[v]) colors[begin + v] = own[v];
          is_known[v] = true;
        }
      first = end;
    }
  }

  // Of `count` vertices; empty if all are white.
  std::vector<Vec3> colorsOf(const tinygltf::Primitive& primitive, size_t count, const std::string& owner) {
    const Material& material = materialAt(primitive.material);
    std::vector<Vec3> colors;
    if (const auto found = primitive.attributes.find("COLOR_0"); found != primitive.attributes.end())
      colors = orElse(std::vector<Vec3>(), "COLOR_0 of " + owner, [&] { return vertexColors(found->second, count); });
    if (material.isWhite()) return colors;
    colors.resize(count, {1, 1, 1});
    for (Vec3& color : colors) color = color * material.factor;
    if (!material.texture) return colors;
    const std::string set = uvSetName(material.texture->uv_set), what = set + " of " + owner;
    const std::vector<float> uvs = orElse(std::vector<float>(), what, [&] { return floatsOf(primitive, set, count, what); });
    for (size_t v = 0; 2 * v < uvs.size(); ++v)
      colors[v] = limited(colors[v] * material.texture->at(double(uvs[2 * v]), double(uvs[2 * v + 1])));
    return colors;
  }

  std::vector<Vec3> vertexColors(int accessor, size_t count) const {
    const bool has_alpha = accessor >= 0 && size_t(accessor) < loaded_.model.accessors.size() &&
                           loaded_.model.accessors[size_t(accessor)].type == TINYGLTF_TYPE_VEC4;
    const size_t width = has_alpha ? 4 : 3;
    const std::vector<float> floats = GltfAccessors{file_, loaded_.model}.readFloats(accessor, int(width), "COLOR_0");
    if (floats.size() != width * count) throw InputError(file_.string(), "it has a different number of vertices");
    std::vector<Vec3> colors;
    for (size_t v = 0; v < count; ++v) colors.push_back(limited({floats[width * v], floats[width * v + 1], floats[width * v + 2]}));
    return colors;
  }

  std::vector<float> floatsOf(const tinygltf::Primitive& primitive, const std::string& set, size_t count, const std::string& owner) const {
    const auto found = primitive.attributes.find(set);
    if (found == primitive.attributes.end()) throw InputError(file_.string(), "there is none");
    std::vector<float> floats = GltfAccessors{file_, loaded_.model}.readFloats(found->second, 2, owner);
    if (floats.size() != 2 * count) throw InputError(file_.string(), "it has a different number of vertices");
    return floats;
  }

  const Material& materialAt(int index) {
    const auto [found, is_new] = materials_.try_emplace(index);
    if (!is_new || index < 0) return found->second;
    const std::string owner = "the base colour of material " + std::to_string(index);
    found->second = orElse(Material{}, owner, [&] { return readMaterial(json_.at("materials").at(size_t(index)), owner); });
    return found->second;
  }

  Material readMaterial(const Json& json, const std::string& owner) {
    Material material;
    const Json pbr = json.value("pbrMetallicRoughness", Json::object());
    if (const auto factor = pbr.find("baseColorFactor"); factor != pbr.end())
      material.factor = limited({factor->at(0).get<float>(), factor->at(1).get<float>(), factor->at(2).get<float>()});
    const auto use = pbr.find("baseColorTexture");
    if (use != pbr.end())
      material.texture = orElse(std::optional<TextureUse>(), owner + ": its texture", [&] { return std::optional(readUse(*use)); });
    const bool has_colors = material.texture ? !isAllWhite(*material.texture->texture.image) : use != pbr.end();
    if (!has_colors && isGrey(material.factor)) return {};
    return material;
  }

  TextureUse readUse(const Json& json) {
    TextureUse use;
    use.uv_set = int(wholeNumber(json, "texCoord", 0));
    if (json.contains("extensions") && json["extensions"].contains("KHR_texture_transform")) {
      const Json& transform = json["extensions"]["KHR_texture_transform"];
      use.offset = transform.value("offset", use.offset), use.scale = transform.value("scale", use.scale);
      use.rotation = transform.value("rotation", 0.0);
      use.uv_set = int(wholeNumber(transform, "texCoord", use.uv_set));
    }
    const Json& texture = json_.at("textures").at(size_t(wholeNumber(json.at("index"))));
    if (!texture.contains("source")) throw InputError(file_.string(), "it has no PNG or JPEG image");
    use.texture.image = imageAt(size_t(wholeNumber(texture["source"])));
    if (texture.contains("sampler")) {
      const Json& sampler = json_.at("samplers").at(size_t(wholeNumber(texture["sampler"])));
      use.texture.wrap_s = sampler.value("wrapS", int(kRepeats)), use.texture.wrap_t = sampler.value("wrapT", int(kRepeats));
    }
    return use;
  }

  std::shared_ptr<const Image> imageAt(size_t index) {
    std::shared_ptr<const Image>& image = images_[index];
    if (!image) {
      std::string kept;
      const std::string_view bytes = bytesOfImage(json_.at("images").at(index), kept);
      image = std::make_shared<const Image>(decodeImage(bytes, "image " + std::to_string(index), settings_.memory_limit));
    }
    return image;
  }

  // `kept` holds bytes that are not of the model.
  std::string_view bytesOfImage(const Json& json, std::string& kept) const {
    if (json.contains("bufferView")) {
      const auto index = size_t(wholeNumber(json["bufferView"]));
      if (index >= loaded_.model.bufferViews.size()) throw InputError(file_.string(), "its buffer view does not exist");
      const tinygltf::BufferView& view = loaded_.model.bufferViews[index];
      if (view.buffer < 0 || size_t(view.buffer) >= loaded_.model.buffers.size())
        throw InputError(file_.string(), "its buffer does not exist");
      const std::vector<unsigned char>& data = loaded_.model.buffers[size_t(view.buffer)].data;
      if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        throw InputError(file_.string(), "its buffer view ends beyond its buffer");
      return {reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength};
    }
    const std::string uri = json.at("uri");
    const size_t comma = uri.find(',');
    if (!uri.starts_with("data:")) {
      kept = readNeighbour(file_, file_.parent_path() / percentDecoded(uri), settings_);
    } else {
      std::optional<std::string> bytes = comma == uri.npos ? std::nullopt : decodeBase64(percentDecoded(uri.substr(comma + 1)));
      if (!bytes) throw InputError(file_.string(), "its data URI is not in base64");
      kept = std::move(*bytes);
    }
    return kept;
  }

  const LoadedGltf& loaded_;
  const Json& json_;
  const std::filesystem::path& file_;
  const ReadSettings& settings_;
  Warnings& warnings_;
  std::map<int, Material> materials_;
  std::map<size_t, std::shared_ptr<const Image>> images_;
};

}  // namespace

BakedMesh decodeColoredGlb(const std::filesystem::path& file, std::string_view bytes, Warnings& warnings, const ReadSettings& settings) {
  const LoadedGltf loaded = loadGltf(file, bytes, settings, warnings);
  BakedMesh baked = decodeLoaded(loaded);
  baked.colors = ColorReader(loaded, settings, warnings).read();
  return baked;
}

}  // namespace cloudbake
