// Values of the C++ as GLSL.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>

#include "core/text/numbers.h"
#include "core/vec3.h"
#include "preview/backdrop/glsl_structs.h"

namespace cloudbake {

inline std::string glslOf(bool value) { return value ? "true" : "false"; }
inline std::string glslOf(int value) { return shortestText(value); }
inline std::string glslOf(uint32_t value) { return shortestText(value) + "u"; }
inline std::string glslOf(double value) { return "float(" + shortestText(float(value)) + ")"; }
inline std::string glslOf(float value) { return "float(" + shortestText(value) + ")"; }
inline std::string glslOf(Vec2 v) { return "vec2(" + shortestText(v.x) + ", " + shortestText(v.y) + ")"; }
inline std::string glslOf(Vec3 v) { return "vec3(" + shortestText(v.x) + ", " + shortestText(v.y) + ", " + shortestText(v.z) + ")"; }
inline std::string glslOf(std::string text) { return text; }

/// The members of a struct that are keys of settings.
template <typename Settings>
std::string glslMembers(const Keys<Settings>& keys, const Settings& settings) {
  std::string text;
  visitValues(keys, settings, [&](const auto& key, const auto& value) {
    if constexpr (kIsGlslType<std::remove_cvref_t<decltype(value)>>)
      if (isGlslMember(key)) text += (text.empty() ? "" : ", ") + glslOf(value);
  });
  return text;
}

/// A struct with these members, in the order of its declaration; those that are structs come as text.
template <typename First, typename... Others>
std::string glslStruct(const std::string& name, const First& first, const Others&... others) {
  return name + "(" + (glslOf(first) + ... + (", " + glslOf(others))) + ")";
}

}  // namespace cloudbake
