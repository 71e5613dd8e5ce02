// The structs of settings in GLSL: their members are the keys of the settings that shaders use.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/keys.h"

namespace cloudbake {

/// Whether a key is a member of its struct.
template <typename Settings>
bool isGlslMember(const Key<Settings>& key) {
  return key.use == KeyUse::kShader || key.use == KeyUse::kComputed;
}

/// Whether a value of a key can be a member of a struct in GLSL.
template <typename Value>
inline constexpr bool kIsGlslType = !kIsOptional<Value> && !std::is_same_v<Value, uint64_t>;

/// "TerrainGround" of the table "terrain.ground".
std::string glslStructName(std::string_view table);

/// The declaration of each struct, after those of the structs that it has as members.
const std::map<std::string, std::string>& glslStructs();

/// GLSL in which each line `struct NAME;` is the declaration of that struct. Throws std::out_of_range if there is no such struct.
std::string glslWithStructs(std::string_view text);

}  // namespace cloudbake
