#include "pipeline/kit/hlsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace cloudbake {

namespace {

using Names = std::pair<std::string_view, std::string_view>;

constexpr Names kWords[] = {
    {"vec2", "float2"}, {"vec3", "float3"}, {"vec4", "float4"}, {"ivec2", "int2"},    {"ivec3", "int3"},
    {"ivec4", "int4"},  {"uvec2", "uint2"}, {"uvec3", "uint3"}, {"mat3", "float3x3"}, {"sampler2D", "Texture2D<float4>"},
    {"mix", "lerp"},    {"fract", "frac"},  {"main", "write"}};

// Uniforms that are set as floats, and of what type these are.
constexpr Names kWhole[] = {{"bool", "float"}, {"int", "float"}, {"uint", "float"}, {"ivec2", "float2"}, {"ivec3", "float3"}};

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

// What is in parentheses from `at` on; empty if there are none.
std::string_view argumentsAt(std::string_view text, size_t at) {
  if (!text.substr(at).starts_with('(')) return {};
  int depth = 0;
  const size_t end = endOf(text, at, [&](char c) { return (depth += (c == '(') - (c == ')')) > 0; });
  return text.substr(at + 1, end - at - 1);
}

bool isOne(std::string_view arguments) {
  int depth = 0;
  return std::ranges::none_of(arguments, [&](char c) {
    depth += (c == '(') - (c == ')');
    return depth == 0 && c == ',';
  });
}

std::string withoutParentheses(const std::string& text) { return text.starts_with('(') ? text.substr(1, text.size() - 2) : text; }

std::string_view replaced(std::span<const Names> table, std::string_view word) {
  const auto rule = std::ranges::find(table, word, &Names::first);
  return rule == table.end() ? std::string_view() : rule->second;
}

// The words of a declaration, without its commas.
std::vector<std::string_view> wordsOf(std::string_view text) {
  std::vector<std::string_view> words;
  for (size_t at = 0; at < text.size();) {
    const size_t end = endOf(text, at, isOfWord);
    if (end > at) words.push_back(text.substr(at, end - at));
    at = std::max(end, at + 1);
  }
  return words;
}

// The translation of one text.
class Translation {
 public:
  enum class Form { kProgram, kStructure };
  explicit Translation(Form form) : is_structure_(form == Form::kStructure) {}

  // Structures of the text, which cannot be declared in another one.
  const std::string& structures() const { return hoisted_; }

  std::string of(std::string_view glsl) {
    std::string out;
    for (size_t at = 0; at < glsl.size();) {
      const size_t begin = at;
      if (glsl.substr(at).starts_with("//")) {
        at = endOf(glsl, at, [](char c) { return c != '\n'; });
        out += glsl.substr(begin, at - begin);
        continue;
      }
      at = endOf(glsl, at, isOfWord);
      if (at == begin) {
        depth_ += (glsl[at] == '{' || glsl[at] == '(') - (glsl[at] == '}' || glsl[at] == ')');
        out += glsl[at++];
        continue;
      }
      out += word(glsl, begin, at);
    }
    return out;
  }

 private:
  // What a word becomes. `at` is its end, and then the end of what was translated with it.
  std::string word(std::string_view glsl, size_t begin, size_t& at) {
    const std::string_view word = glsl.substr(begin, at - begin);
    if (before_ == "mat3" && glsl[begin - 1] == ' ') matrices_.insert(word);
    before_ = word;
    if (word == "highp") return ++at, "";
    if (depth_ == 0 && word == "uniform") return uniforms(glsl, at);
    if (depth_ == 0 && word == "out") return is_structure_ ? (++at, "") : "static";
    if (depth_ == 0 && word == "const") return "static const";
    if (word == "struct") return structure(glsl, at);
    constexpr std::string_view kTimes = " * ";
    if (matrices_.contains(word) && glsl.substr(at).starts_with(kTimes)) {
      const size_t factor = at + kTimes.size();
      at = endOfFactor(glsl, factor);
      return "mul(" + std::string(word) + ", " + withoutParentheses(of(glsl.substr(factor, at - factor))) + ")";
    }
    const std::string_view arguments = argumentsAt(glsl, at), other = replaced(kWords, word);
    if (word.find("vec") <= 1 && !other.empty() && !arguments.empty() && isOne(arguments)) {
      at += arguments.size() + 2;
      return "((" + std::string(other) + ")(" + of(arguments) + "))";
    }
    if (structures_.contains(word) && !arguments.empty()) return "make" + std::string(word);
    return std::string(other.empty() ? word : other);
  }

  // Whole numbers and switches are set as floats NAME_, because that is what every engine can set.
  std::string uniforms(std::string_view glsl, size_t& at) {
    const size_t end = glsl.find(';', at);
    std::vector<std::string_view> words = wordsOf(glsl.substr(at, end - at));
    std::erase(words, "highp");
    const std::string_view type = words.front(), as_float = replaced(kWhole, type);
    words.erase(words.begin());
    if (as_float.empty() || is_structure_) return at = end, fmt::format("{} {}", of(type), fmt::join(words, ", "));
    std::string out = fmt::format("{} {}_;", as_float, fmt::join(words, "_, "));
    for (const std::string_view name : words) out += fmt::format(" static const {0} {1} = ({0}){1}_;", of(type), name);
    at = end + 1;
    return out;
  }

  // A structure, and the function that makes one of its fields.
  std::string structure(std::string_view glsl, size_t& at) {
    const size_t end = glsl.find("};", at);
    const std::string_view name = wordsOf(glsl.substr(at, end - at)).front();
    const std::string body = of(glsl.substr(at, end - at));
    structures_.insert(name);
    std::string parameters, sets;
    for (size_t line = body.find('\n'); line + 1 < body.size(); line = std::min(body.find('\n', line + 1), body.size())) {
      const std::vector<std::string_view> field = wordsOf(std::string_view(body).substr(line, body.find(';', line) - line));
      if (field.size() < 2) continue;
      for (size_t i = 1; i < field.size(); ++i) {
        parameters += fmt::format("{}{} {}", parameters.empty() ? "" : ", ", field[0], field[i]);
        sets += fmt::format("  made.{0} = {0};\n", field[i]);
      }
    }
    at = end + 2;
    --depth_;
    const std::string declared = fmt::format("struct{}}};\n", body);
    if (is_structure_) hoisted_ += declared;
    return fmt::format("{0}{1} make{1}({2}) {{\n  {1} made;\n{3}  return made;\n}}", is_structure_ ? "" : declared, name, parameters, sets);
  }

  bool is_structure_;
  std::string hoisted_;
  std::set<std::string_view> matrices_, structures_;
  std::string_view before_;  // the last word
  int depth_ = 0;            // of braces and parentheses
};

}  // namespace

std::string hlslOf(std::string_view glsl) { return Translation(Translation::Form::kProgram).of(glsl); }

std::string hlslStructure(std::string_view name, std::string_view more, std::string_view glsl) {
  Translation translation(Translation::Form::kStructure);
  const std::string body = translation.of(glsl);
  return fmt::format("{}struct {} {{\nfloat4 gl_FragCoord;\n{}{}}};\n", translation.structures(), name, more, body);
}

}  // namespace cloudbake
