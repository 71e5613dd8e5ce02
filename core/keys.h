// The keys of settings: a row for each number, switch or colour of a struct that a file may set. Readers, range checks, docs, GLSL and the
// controls of pages follow from the rows.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// Limits of positions, world units, of colours and of seeds.
inline constexpr double kFar = 1e9, kBright = 1e4, kMostSeed = 2147483647;

/// What uses the value of a key in the page of `view`.
enum class KeyUse : uint8_t {
  kShader,    ///< shaders: a member of the table's struct in GLSL, if there is one
  kScript,    ///< only the script, before shaders run
  kComputed,  ///< shaders; time and sun give the value, and no file can set it
};

/// A key, the field that it sets, and the limits of each of its numbers.
template <typename Settings>
struct Key {
  const char* name;
  std::variant<float Settings::*, double Settings::*, int Settings::*, uint32_t Settings::*, uint64_t Settings::*, bool Settings::*,
               Vec2 Settings::*, Vec3 Settings::*, std::optional<float> Settings::*, std::optional<double> Settings::*,
               std::optional<Vec3> Settings::*>
      field;
  double low, high;
  const char* help;  ///< a phrase for docs and for the control of the page
  KeyUse use = KeyUse::kShader;
  const char* without_control = nullptr;  ///< why the page has no control for it; null: it has one
  bool takes_one = false;                 ///< of a Vec3: one number for all three will do
};

template <typename Value>
inline constexpr bool kIsOptional = false;
template <typename Value>
inline constexpr bool kIsOptional<std::optional<Value>> = true;

template <typename Settings>
using Keys = std::vector<Key<Settings>>;

/// Calls visit(key, value) for every key; the value is that of the settings.
template <typename Settings, typename Visit>
void visitValues(const Keys<std::remove_const_t<Settings>>& keys, Settings& settings, const Visit& visit) {
  for (const auto& key : keys) std::visit([&](auto field) { visit(key, settings.*field); }, key.field);
}

/// Whether all numbers of a value are within limits. A switch and a value that is not set are.
template <typename Value>
bool isInRange(const Value& value, double low, double high) {
  if constexpr (std::is_same_v<Value, Vec3>)
    return isInRange(value.x, low, high) && isInRange(value.y, low, high) && isInRange(value.z, low, high);
  else if constexpr (std::is_same_v<Value, Vec2>)
    return isInRange(value.x, low, high) && isInRange(value.y, low, high);
  else if constexpr (kIsOptional<Value>)
    return !value || isInRange(*value, low, high);
  else
    return std::is_same_v<Value, bool> || (value >= Value(low) && value <= Value(high));
}

/// Throws std::invalid_argument with the name of a key whose value is not within its limits.
template <typename Settings>
void requireInRange(const Keys<Settings>& keys, const Settings& settings) {
  visitValues(keys, settings, [](const auto& key, const auto& value) {
    if (!isInRange(value, key.low, key.high)) throw std::invalid_argument(key.name + std::string(" is out of its range"));
  });
}

}  // namespace cloudbake
