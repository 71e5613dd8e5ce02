#include "core/text/json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace cloudbake {

namespace {

// How deeply brackets are nested. The parser's callback could count them too, but makes parsing quadratic in the objects of an array.
int deepestNesting(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_string = !in_string;
    if (in_string) {
      i += c == '\\';
      continue;
    }
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if (c == ']' || c == '}') --depth;
  }
  return deepest;
}

}  // namespace

std::optional<Json> parseJson(std::string_view text, JsonFault* fault) {
  JsonFault found;
  try {
    if (deepestNesting(text) <= kMostNestedJson) return Json::parse(text.begin(), text.end());
    found.why = "is nested more than " + std::to_string(kMostNestedJson) + " levels deep";
  } catch (const Json::parse_error& error) {
    const size_t read = std::min(text.size(), error.byte > 0 ? error.byte - 1 : 0);
    found = {1 + int(std::count(text.begin(), text.begin() + ptrdiff_t(read), '\n')), "ends too early or is not valid from here on"};
  } catch (const Json::exception&) {
    found.why = "has a number that is too large";
  }
  if (fault) *fault = found;
  return std::nullopt;
}

}  // namespace cloudbake
