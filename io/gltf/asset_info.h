// What an asset records of its bake, as JSON and back.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "core/types.h"

namespace cloudbake {

using Json = nlohmann::ordered_json;  ///< keeps the order of keys

/// A whole number. Throws Json::type_error for any other value, where get<int>() would cast 1e39. Above 2⁶³ it wraps.
inline int64_t wholeNumber(const Json& value) { return value.get_ref<const Json::number_integer_t&>(); }
/// The same of an object's member; `fallback` where there is none.
inline int64_t wholeNumber(const Json& object, const char* key, int64_t fallback) {
  const auto found = object.find(key);
  return found == object.end() ? fallback : wholeNumber(*found);
}

/// The double that prints as shortly as the float does (0.01, not 0.009999999776482582) and reads back as the same float.
double shortest(float value);

/// The object that stands in `asset.extras.cloudbake` and in reports. A float prints as short as it reads back to the same float.
Json writeInfo(const AssetInfo& info);

/// From a whole glTF document; nothing where it carries none, or one of another layout.
std::optional<AssetInfo> readInfo(const Json& document);

}  // namespace cloudbake
