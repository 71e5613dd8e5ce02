#include "preview/backdrop/glsl_structs.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "preview/backdrop/dust.h"
#include "preview/backdrop/marched_clouds.h"
#include "preview/backdrop/sky.h"
#include "preview/backdrop/slab_clouds.h"
#include "preview/backdrop/terrain.h"
#include "preview/grade.h"

namespace cloudbake {

namespace {

template <typename Settings, typename Value>
const char* typeOf(Value Settings::*) {
  if constexpr (std::is_floating_point_v<Value>) return "float";
  if constexpr (std::is_same_v<Value, int>) return "int";
  if constexpr (std::is_same_v<Value, uint32_t>) return "uint";
  if constexpr (std::is_same_v<Value, bool>) return "bool";
  if constexpr (std::is_same_v<Value, Vec2>) return "vec2";
  if constexpr (std::is_same_v<Value, Vec3>) return "vec3";
  throw std::logic_error("a key of a struct of GLSL has a type that GLSL does not have");
}

std::string member(const std::string& type, const std::string& name) { return "  " + type + " " + name + ";\n"; }

template <typename Settings>
std::string members(const Keys<Settings>& keys) {
  std::string text;
  for (const Key<Settings>& key : keys)
    if (isGlslMember(key)) text += std::visit([&](auto field) { return member(typeOf(field), key.name); }, key.field);
  return text;
}

std::string declared(const std::string& name, const std::string& members) { return "struct " + name + " {\n" + members + "};\n"; }

// A part without members has no struct.
std::string terrainStructs() {
  std::string parts, whole;
  const TerrainSettings any;
  visitTerrainKeys(any, [&](std::string_view table, const auto& keys, const auto&) {
    const size_t dot = table.find('.');
    const std::string text = members(keys);
    if (dot == std::string_view::npos) {
      whole += text;
    } else if (!text.empty()) {
      const std::string type = glslStructName(table);
      parts += declared(type, text);
      whole += member(type, std::string(table.substr(dot + 1)));
    }
  });
  return parts + declared("Terrain", whole);
}

}  // namespace

std::string glslStructName(std::string_view table) {
  std::string name;
  bool begins = true;
  for (const char c : table) {
    if (c != '.') name += begins ? char(std::toupper(c)) : c;
    begins = c == '.';
  }
  return name;
}

const std::map<std::string, std::string>& glslStructs() {
  static const auto structs = [] {
    std::map<std::string, std::string> all{{"Terrain", terrainStructs()}};
    const auto add = [&](const std::string& name, const std::string& text) { all.emplace(name, declared(name, text)); };
    add("Slab", members(slabKeys()) + members(slabToneKeys()));
    add("DistanceClouds", members(distanceCloudKeys()));
    add("DensityClouds", members(densityCloudKeys()));
    add("Dust", members(dustKeys()));
    add("SmoothDisc", members(smoothDiscKeys()));
    add("Moon", members(moonKeys()) + members(moonDiscKeys()) + members(smoothDiscKeys()));
    add("Stars", members(starKeys()));
    add("Aurora", members(auroraKeys()));
    add("Vignette", members(vignetteKeys()));
    add("Contrast", members(contrastKeys()));
    return all;
  }();
  return structs;
}

std::string glslWithStructs(std::string_view text) {
  constexpr std::string_view kStruct = "struct ";
  std::string out;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, std::min(text.find('\n'), text.size() - 1) + 1);
    if (line.starts_with(kStruct) && line.ends_with(";\n"))
      out += glslStructs().at(std::string(line.substr(kStruct.size(), line.size() - kStruct.size() - 2)));
    else
      out += line;
    text.remove_prefix(line.size());
  }
  return out;
}

}  // namespace cloudbake
