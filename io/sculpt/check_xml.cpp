// 3MF Core Specification 1.3, its Materials and Properties Extension 1.2 and Production Extension 1.1; AMF: ISO/ASTM 52915. What assimp 5.2
// does with them is in its XmlSerializer.cpp (3MF) and AMFImporter.cpp.
#include "io/sculpt/check_xml.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/text/scan.h"
#include "io/file/zip.h"
#include "io/sculpt/xml_tags.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// Extensions without which the shape is still right.
constexpr std::string_view kHarmless[] = {"http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
                                          "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
                                          "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};

void checkExtensions(const fs::path& file, const XmlTag& model) {
  std::string_view prefixes = attributeOf(model, "requiredextensions").value_or("");
  for (std::string_view prefix = takeWord(prefixes); !prefix.empty(); prefix = takeWord(prefixes)) {
    const std::string_view extension = attributeOf(model, "xmlns:" + std::string(prefix)).value_or(prefix);
    if (std::find(std::begin(kHarmless), std::end(kHarmless), extension) == std::end(kHarmless))
      throw InputError(file.string(), "the 3MF needs the extension " + quotedWord(extension) +
                                          ", which cannot be read; export the sculpt as glTF, FBX or OBJ");
  }
}

void checkPlacement(const fs::path& file, const XmlTag& tag) {
  std::string_view rest = tag.attributes;
  while (const auto attribute = takeAttribute(rest)) {
    if (attribute->name.ends_with(":path"))
      throw InputError(file.string(),
                       "the 3MF has its parts in several files (production extension), which cannot be read; export it as "
                       "glTF, FBX or OBJ");
    if (attribute->name != "transform") continue;
    std::string_view numbers = attribute->value;
    int count = 0;
    for (std::string_view word = takeWord(numbers); !word.empty(); word = takeWord(numbers))
      count += std::isfinite(parseNumber(word).value_or(HUGE_VAL)) ? 1 : 100;
    if (count != 12)
      throw InputError(file.string(),
                       "the 3MF has a transform that is not 12 numbers: " + quotedWord(attribute->value) + "; export it again");
  }
}

// Materials of the triangles of one object.
struct ObjectMaterials {
  std::string_view pid, index;  // the object's own, for triangles without
  std::set<std::pair<std::string_view, std::string_view>> used;
  bool mixed = false;  // within a triangle

  void add(const XmlTag& triangle) {
    const auto own = attributeOf(triangle, "pid"), first = attributeOf(triangle, "p1");
    for (const char* name : {"p2", "p3"})
      if (const auto other = attributeOf(triangle, name)) mixed |= first && *other != *first;
    used.emplace(own.value_or(pid), first.value_or(own ? "0" : index));
  }
};

}  // namespace

std::string modelOf3mf(const fs::path& file, std::string_view bytes, uint64_t limit) {
  std::string name = "3D/3dmodel.model";
  if (const auto relations = fileInZip(bytes, "_rels/.rels", limit)) {
    XmlTags tags(*relations);
    while (const auto tag = tags.next())
      if (attributeOf(*tag, "Type") == "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel") {
        const std::string_view target = attributeOf(*tag, "Target").value_or(name);
        name = target.substr(std::min(target.find_first_not_of('/'), target.size()));
        break;
      }
  }
  auto model = fileInZip(bytes, name, limit);
  if (!model || !XmlTags(*model).next())
    throw InputError(file.string(),
                     "the model of the 3MF cannot be unpacked: it is damaged, in UTF-16 or too large for --memory; export it "
                     "again");
  return std::move(*model);
}

void check3mf(const fs::path& file, std::string_view model, Warnings& warnings) {
  uint64_t several = 0, textured = 0, colored = 0;
  std::optional<ObjectMaterials> object;
  bool is_root = true;
  XmlTags tags(model);
  while (const auto tag = tags.next()) {
    if (std::exchange(is_root, false)) checkExtensions(file, *tag);
    const std::string_view local = tag->name.substr(tag->name.rfind(':') + 1);
    if (tag->opens && (local == "component" || local == "item")) checkPlacement(file, *tag);
    if (tag->opens && local == "object")
      object = ObjectMaterials{attributeOf(*tag, "pid").value_or(""), attributeOf(*tag, "pindex").value_or("0"), {}};
    if (tag->opens && local == "triangle" && object) object->add(*tag);
    if (!tag->opens && local == "object" && object) several += object->mixed || object->used.size() > 1, object.reset();
    textured += tag->opens && (local == "texture2d" || local == "texture2dgroup");
    colored += tag->opens && (local == "colorgroup" || local == "compositematerials" || local == "multiproperties");
  }
  warnings.add(WarningKind::kMaterialIgnored,
               file.string() + ": an object whose triangles have several materials has the last one everywhere", several);
  warnings.add(WarningKind::kMaterialIgnored, file.string() + ": colours and mixtures of materials are not kept", colored);
  warnings.add(WarningKind::kTextureIgnored, file.string() + ": textures of 3MF are not kept", textured);
}

void checkCollada(const fs::path& file, std::string_view xml) {
  const auto whole = [](const XmlTag& tag, std::string_view name, long long otherwise) {
    const auto value = attributeOf(tag, name);
    return value ? std::clamp(parseInteger(trimmed(*value)).value_or(0), 0LL, 1LL << 31) : otherwise;
  };
  std::map<std::string_view, long long> arrays;
  XmlTags tags(xml);
  while (const auto tag = tags.next()) {
    if (!tag->opens) continue;
    if (tag->name == "float_array" || tag->name == "Name_array" || tag->name == "IDREF_array")
      arrays[attributeOf(*tag, "id").value_or("")] = whole(*tag, "count", 0);
    if (tag->name != "accessor") continue;
    const std::string_view source = attributeOf(*tag, "source").value_or("");
    const auto array = arrays.find(source.substr(source.starts_with('#') ? 1 : 0));
    const long long needed = whole(*tag, "offset", 0) + whole(*tag, "count", 0) * whole(*tag, "stride", 1);
    if (array != arrays.end() && needed > array->second)
      throw InputError(file.string(), "the source " + quotedWord(array->first) + " has " + std::to_string(array->second) + " values of " +
                                          std::to_string(needed) + "; the file is damaged, export it again");
  }
}

void checkAmf(const fs::path& file, std::string_view xml) {
  XmlTags tags(xml);
  while (const auto tag = tags.next()) {
    if (!tag->opens || (tag->name != "rx" && tag->name != "ry" && tag->name != "rz")) continue;
    if (parseNumber(trimmed(tags.text())) != 0)
      throw InputError(file.string(), "the AMF turns an instance (<" + std::string(tag->name) +
                                          ">), which cannot be read; export it as "
                                          "glTF, FBX or OBJ");
  }
}

}  // namespace cloudbake
