// Material libraries: "Wavefront MTL file format" (Alias|Wavefront, 1995), with the keys Pr, Pm and norm of "Extending Wavefront MTL for
// physically-based rendering" (Exocortex, 2013). Numbers are scanned here, because tinyobjloader does not say which keys a material has and
// does not round correctly. tinyobjloader reads the names and options of textures.
#include "io/sculpt/read_mtl.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/text/plain_text.h"
#include "core/text/scan.h"
#include "io/file/neighbour.h"
#include "io/sculpt/sculpt_images.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The numbers of a material by key, e.g. Kd → 0.8 0.8 0.8.
using Values = std::map<std::string, std::vector<float>>;

std::map<std::string, Values> scanValues(const fs::path& file, std::string_view mtl, Warnings& warnings) {
  std::map<std::string, Values> all;
  std::string name;
  Values* values = nullptr;
  LineScanner scanner{mtl};
  while (const auto line = scanner.next()) {
    std::string_view rest = *line;
    const std::string key(takeWord(rest));
    if (key == "newmtl") {
      name = trimmed(rest);
      values = &all.try_emplace(name).first->second;
    }
    if (!values || key.empty() || key.front() == '#') continue;
    std::vector<float> numbers;
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
      const auto number = parseFloat(word);
      if (number) numbers.push_back(*number);
      if (!number || std::isfinite(*number)) continue;
      if (!key.starts_with("map_"))  // whose numbers are those of the texture's place
        warnings.add(WarningKind::kMaterialIgnored, file.string() + ":" + std::to_string(scanner.line) + ": " + key + " of material '" +
                                                        name + "' has " + quotedWord(word) + ", which is not finite, and was left out");
      numbers.clear();
      break;
    }
    values->insert_or_assign(key, std::move(numbers));
  }
  return all;
}

// Everything that one library defines, by name.
struct Library {
  fs::path file;
  std::map<std::string, Values> values;
  std::map<std::string, tinyobj::material_t> textures;
};

Library parseLibrary(const fs::path& file, const std::string& bytes, Warnings& warnings) {
  std::string mended;
  const std::string_view text = plainText(bytes, file.string(), mended);
  Library library{file, scanValues(file, text, warnings), {}};
  std::map<std::string, int> places;
  std::vector<tinyobj::material_t> materials;
  std::istringstream stream{std::string(text)};
  std::string warning, error;
  tinyobj::LoadMtl(&places, &materials, &stream, &warning, &error);
  for (tinyobj::material_t& material : materials) library.textures[std::string(trimmed(material.name))] = material;
  return library;
}

// Makes one material of glTF.
struct MtlConverter {
  const Library& library;
  const std::string& name;
  const Values& values;
  ImageCollector& images;
  Warnings& warnings;

  std::string owner() const { return "material '" + name + "'"; }
  void ignoreTexture(const std::string& key, const std::string& why) const {
    warnings.add(WarningKind::kTextureIgnored, library.file.string() + ": " + key + " of " + owner() + " was left out: " + why);
  }
  void ignoreValue(const std::string& what, const std::string& why) const {
    warnings.add(WarningKind::kMaterialIgnored, library.file.string() + ": " + what + " of " + owner() + " " + why);
  }
  bool has(const char* key) const { return values.contains(key) && !values.at(key).empty(); }
  // A number in its range.
  float number(const char* key, size_t at, float most = 1) const {
    const std::vector<float>& all = values.at(key);
    const float value = all[std::min(at, all.size() - 1)], kept = std::clamp(value, 0.0F, most);
    if (kept != value) ignoreValue(key, "is out of range and was limited");
    return kept;
  }

  SculptTexture texture(const std::string& written, const tinyobj::texture_option_t& options) const {
    SculptTexture use;
    if (written.empty()) return use;
    use.image = images.fromFile(written, owner(), library.file);
    use.wrap = options.clamp ? TextureWrap::kClamp : TextureWrap::kRepeat;
    // In OBJ v grows upwards: 1 − v' = 1 − (scale·(1 − v) + offset).
    const Vec2 scale{options.scale[0], options.scale[1]}, offset{options.origin_offset[0], 1 - options.scale[1] - options.origin_offset[1]};
    if (std::isfinite(scale.x + scale.y + offset.x + offset.y))
      use.scale = scale, use.offset = offset;
    else
      ignoreValue("the place of a texture", "is not finite");
    return use;
  }

  void colors(SculptMaterial& out, const tinyobj::material_t& in) const {
    for (size_t i = 0; has("Kd") && i < 3; ++i) out.base_color[i] = number("Kd", i);
    if (has("d"))
      out.base_color[3] = number("d", 0);
    else if (has("Tr"))
      out.base_color[3] = 1 - number("Tr", 0);
    out.base_color_texture = texture(in.diffuse_texname, in.diffuse_texopt);
    if (!in.alpha_texname.empty() && in.alpha_texname != in.diffuse_texname) ignoreTexture("map_d", "glTF needs it as the alpha of map_Kd");
    out.blended = out.base_color[3] < 1 || (!in.alpha_texname.empty() && in.alpha_texname == in.diffuse_texname);

    constexpr float kMostEmission = 1e6F;
    for (size_t i = 0; has("Ke") && i < 3; ++i) out.emission[i] = number("Ke", i, kMostEmission);
    out.emissive_texture = texture(in.emissive_texname, in.emissive_texopt);
    if (out.emissive_texture.image >= 0 && out.emission == std::array<float, 3>{}) out.emission = {1, 1, 1};
  }

  void surface(SculptMaterial& out, const tinyobj::material_t& in) const {
    if (has("Ns")) out.roughness = std::sqrt(2 / (number("Ns", 0, 1e9F) + 2));
    if (has("Pr")) out.roughness = number("Pr", 0);
    if (has("Pm")) out.metallic = number("Pm", 0);
    // glTF reads roughness from green and metalness from blue, so an image serves both, or roughness alone while the metalness is 0.
    const bool both = in.roughness_texname == in.metallic_texname;
    if (!in.metallic_texname.empty() && !both) ignoreTexture("map_Pm", "glTF needs roughness and metalness in one image");
    if (in.roughness_texname.empty()) return;
    if (!both && out.metallic != 0) return ignoreTexture("map_Pr", "glTF needs roughness and metalness in one image");
    out.metallic_roughness_texture = texture(in.roughness_texname, in.roughness_texopt);
    if (out.metallic_roughness_texture.image < 0) return;
    if (!has("Pr") || out.roughness == 0) out.roughness = 1;
    if (both && (!has("Pm") || out.metallic == 0)) out.metallic = 1;
  }

  void bumps(SculptMaterial& out, const tinyobj::material_t& in) const {
    if (!in.normal_texname.empty()) {
      out.normal_texture = texture(in.normal_texname, in.normal_texopt);
      if (!in.bump_texname.empty() && in.bump_texname != in.normal_texname) ignoreTexture("map_Bump", "norm is used");
      return;
    }
    if (in.bump_texname.empty()) return;
    const SculptTexture use = texture(in.bump_texname, in.bump_texopt);
    if (use.image < 0) return;
    if (!looksLikeNormalMap(images.images[size_t(use.image)].bytes))
      return ignoreTexture("map_Bump", "it is a height map, which glTF does not have");
    out.normal_texture = use;
    if (std::isfinite(in.bump_texopt.bump_multiplier))
      out.normal_scale = in.bump_texopt.bump_multiplier;
    else
      ignoreValue("-bm", "is not finite");
  }

  void ignored(const tinyobj::material_t& in) const {
    const std::pair<const char*, const std::string&> maps[] = {
        {"map_Ka", in.ambient_texname},    {"map_Ks", in.specular_texname}, {"map_Ns", in.specular_highlight_texname},
        {"disp", in.displacement_texname}, {"refl", in.reflection_texname}, {"map_Ps", in.sheen_texname}};
    for (const auto& [key, texture_name] : maps)
      if (!texture_name.empty() && texture_name != in.diffuse_texname) ignoreTexture(key, "glTF's core materials have no such texture");
    for (const char* key : {"Tf", "Ps", "Pc", "Pcr", "aniso", "anisor"})
      if (has(key) && std::any_of(values.at(key).begin(), values.at(key).end(), [&](float v) { return v != (key[0] == 'T' ? 1 : 0); }))
        ignoreValue(key, "is not kept");
  }
};

std::vector<Library> readLibraries(const fs::path& obj, std::string_view bytes, const ReadSettings& settings, Warnings& warnings) {
  std::vector<Library> libraries;
  for (const fs::path& file : libraryPaths(obj, bytes, settings.allow_outside)) {
    std::string why = "cannot be read";
    try {
      libraries.push_back(parseLibrary(file, readNeighbour(obj, file, settings), warnings));
      continue;
    } catch (const InputError& error) {
      why = "is not used: " + refusalOfNeighbour(obj, file, settings.allow_outside).value_or(error.message);
    } catch (const IoError&) {
    }
    warnings.add(WarningKind::kMaterialIgnored, obj.string() + ": material library '" + file.filename().string() + "' " + why +
                                                    ": only the names of its materials were kept");
  }
  return libraries;
}

}  // namespace

std::vector<std::string> materialLibraries(std::string_view obj) {
  constexpr std::string_view kKeyword = "mtllib";
  std::vector<std::string> named;
  for (size_t at = obj.find(kKeyword); at != obj.npos; at = obj.find(kKeyword, at + 1)) {
    size_t begin = at;  // blanks may come before the keyword
    while (begin > 0 && isBlank(obj[begin - 1]) && obj[begin - 1] != '\n' && obj[begin - 1] != '\r') --begin;
    if (begin > 0 && obj[begin - 1] != '\n' && obj[begin - 1] != '\r') continue;
    std::string_view rest = obj.substr(at, obj.substr(at).find_first_of("\r\n"));
    if (takeWord(rest) != kKeyword) continue;
    std::string name(trimmed(rest));
    if (!name.empty() && std::find(named.begin(), named.end(), name) == named.end()) named.push_back(std::move(name));
  }
  return named;
}

std::vector<fs::path> libraryPaths(const fs::path& obj, std::string_view bytes, bool allow_outside) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const std::string& line : materialLibraries(withoutByteOrderMark(bytes))) {
    const fs::path whole = neighbourNamed(obj, line, allow_outside);
    std::string_view rest = line, probe = line;
    takeWord(probe);
    if (takeWord(probe).empty() || refusalOfNeighbour(obj, whole, allow_outside) || fs::exists(whole, error)) {
      paths.push_back(whole);
      continue;
    }
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest))
      paths.push_back(neighbourNamed(obj, std::string(word), allow_outside));
  }
  return paths;
}

std::vector<std::string> texturesOfLibrary(std::string_view mtl) {
  std::vector<std::string> named;
  Warnings ignored;
  for (const auto& [name, m] : parseLibrary({}, std::string(mtl), ignored).textures)
    for (const std::string& texture : {m.diffuse_texname, m.emissive_texname, m.normal_texname, m.bump_texname, m.roughness_texname})
      if (!texture.empty()) named.push_back(texture);
  return named;
}

void readMaterials(const fs::path& obj, std::string_view bytes, const std::vector<std::string>& names, const ReadSettings& settings,
                   Sculpt& sculpt, Warnings& warnings) {
  if (names.empty()) return;
  const std::vector<Library> libraries = readLibraries(obj, bytes, settings, warnings);
  const bool names_none = materialLibraries(bytes).empty();  // a library that cannot be read is counted already
  ImageCollector images{obj, settings, sculpt.images, warnings};
  for (const std::string& name : names) {
    SculptMaterial material;
    material.name = name;
    const auto library = std::find_if(libraries.begin(), libraries.end(), [&](const Library& one) { return one.values.contains(name); });
    if (library != libraries.end()) {
      const MtlConverter converter{*library, name, library->values.at(name), images, warnings};
      const auto found = library->textures.find(name);
      const tinyobj::material_t in = found == library->textures.end() ? tinyobj::material_t{} : found->second;
      converter.colors(material, in);
      converter.surface(material, in);
      converter.bumps(material, in);
      converter.ignored(in);
    } else if (!libraries.empty() || names_none) {
      warnings.add(WarningKind::kMaterialIgnored, obj.string() + ": no library defines material '" + name + "': only its name was kept");
    }
    sculpt.materials.push_back(std::move(material));
  }
}

}  // namespace cloudbake
