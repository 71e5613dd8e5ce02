// The one way to parse JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace cloudbake {

using Json = nlohmann::ordered_json;  ///< keeps the order of keys

/// Why a text is not accepted.
struct JsonFault {
  int line = 0;     ///< where the fault is, from 1; 0: nowhere in particular
  std::string why;  ///< after "the JSON ": "ends too early …"
};

/// No exporter nests objects and arrays deeper than 20 levels. Copying, comparing and printing a Json uses the stack for each level.
inline constexpr int kMostNestedJson = 200;

/// The value of a text; none if the text is not JSON or is nested more than kMostNestedJson levels deep, and then `fault`, if given, says
/// why.
std::optional<Json> parseJson(std::string_view text, JsonFault* fault = nullptr);

}  // namespace cloudbake
