#include "pipeline/kit/hlsl.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

namespace cloudbake {

namespace {

constexpr std::pair<std::string_view, std::string_view> kWords[] = {{"vec2", "float2"}, {"vec3", "float3"},   {"vec4", "float4"},
                                                                    {"ivec2", "int2"},  {"mat3", "float3x3"}, {"mix", "lerp"},
                                                                    {"fract", "frac"}};

bool isOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// The first character from `at` on that does not belong there.
template <class Belongs>
size_t endOf(std::string_view text, size_t at, Belongs belongs) {
  while (at < text.size() && belongs(text[at])) ++at;
  return at;
}

// The end of a factor: a name with fields, a call or a group in parentheses.
size_t endOfFactor(std::string_view text, size_t at) {
  int depth = 0;
  return endOf(text, at, [&](char c) {
    const bool is_inside = depth > 0;
    depth += (c == '(') - (c == ')');
    return depth > 0 || (is_inside && depth == 0) || (depth == 0 && (isOfWord(c) || c == '.'));
  });
}

std::string withoutParentheses(const std::string& text) { return text.starts_with('(') ? text.substr(1, text.size() - 2) : text; }

std::string translated(std::string_view glsl, std::set<std::string_view>& matrices) {
  std::string out;
  std::string_view before;  // the last word
  for (size_t at = 0; at < glsl.size();) {
    const size_t begin = at;
    if (glsl.substr(at).starts_with("//")) {
      at = endOf(glsl, at, [](char c) { return c != '\n'; });
      out += glsl.substr(begin, at - begin);
      continue;
    }
    at = endOf(glsl, at, isOfWord);
    if (at == begin) {
      out += glsl[at++];
      continue;
    }
    const std::string_view word = glsl.substr(begin, at - begin);
    if (before == "mat3" && glsl[begin - 1] == ' ') matrices.insert(word);
    before = word;
    constexpr std::string_view kTimes = " * ";
    if (matrices.contains(word) && glsl.substr(at).starts_with(kTimes)) {
      const size_t factor = at + kTimes.size();
      at = endOfFactor(glsl, factor);
      out += "mul(" + std::string(word) + ", " + withoutParentheses(translated(glsl.substr(factor, at - factor), matrices)) + ")";
    } else {
      const auto* const rule = std::ranges::find(kWords, word, &std::pair<std::string_view, std::string_view>::first);
      out += rule == std::end(kWords) ? word : rule->second;
    }
  }
  return out;
}

}  // namespace

std::string hlslOf(std::string_view glsl) {
  std::set<std::string_view> matrices;
  return translated(glsl, matrices);
}

}  // namespace cloudbake
