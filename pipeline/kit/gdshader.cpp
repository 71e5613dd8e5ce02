#include "pipeline/kit/gdshader.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace cloudbake {

namespace {

using Token = std::string_view;
using Fields = std::vector<std::pair<Token, Token>>;  // types and names

bool isWordPart(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool isSpace(Token token) { return std::isspace(static_cast<unsigned char>(token.front())); }
bool isComment(Token token) { return token.starts_with("//"); }

// Comments, words with numbers, runs of spaces, and single other characters.
std::vector<Token> tokensOf(std::string_view text) {
  std::vector<Token> tokens;
  for (size_t at = 0; at < text.size();) {
    size_t end = at + 1;
    const auto extend = [&](auto belongs) {
      while (end < text.size() && belongs(text[end])) ++end;
    };
    if (text.substr(at).starts_with("//")) {
      extend([](char c) { return c != '\n'; });
    } else if (isWordPart(text[at])) {
      extend(isWordPart);
    } else if (isSpace(text.substr(at, 1))) {
      extend([](char c) { return isSpace({&c, 1}); });
    }
    tokens.push_back(text.substr(at, end - at));
    at = end;
  }
  return tokens;
}

// An unsigned literal as a cast of the signed number of the same bits, because larger literals are no numbers to Godot 3.
std::string withoutSuffix(Token number) {
  const auto bits = static_cast<uint32_t>(std::stoull(std::string(number), nullptr, 0));
  return "uint(" + std::to_string(static_cast<int32_t>(bits)) + ")";
}

class GodotTranslation {
 public:
  explicit GodotTranslation(std::string_view glsl) : tokens_(tokensOf(glsl)), at_(0), end_(tokens_.size()) {}

  std::string run() {
    while (at_ < end_) step();
    return std::move(out_);
  }

 private:
  // The token at `at`, or nothing after the last one.
  Token token(size_t at) const { return at < end_ ? tokens_[at] : Token(); }

  size_t afterSpace(size_t at) const {
    while (at < end_ && (isSpace(tokens_[at]) || isComment(tokens_[at]))) ++at;
    return at;
  }

  // Goes to the place behind a token, copying nothing.
  void skipPast(Token last) {
    while (at_ < end_ && tokens_[at_++] != last) {
    }
  }

  void skipLineEnd() {
    while (at_ < end_ && isComment(tokens_[afterSpaces(at_)])) at_ = afterSpaces(at_) + 1;
    if (at_ < end_ && isSpace(tokens_[at_])) ++at_;
  }

  size_t afterSpaces(size_t at) const { return at + 1 < end_ && isSpace(tokens_[at]) ? at + 1 : at; }

  // The words up to a token, parted at commas that are in no parentheses; ends behind that token.
  std::vector<std::string> partsUpTo(Token last) {
    std::vector<std::string> parts(1);
    for (int depth = 0; at_ < end_ && (depth > 0 || tokens_[at_] != last);) {
      depth += (tokens_[at_] == "(") - (tokens_[at_] == ")");
      if (depth == 0 && tokens_[at_] == ",") {
        parts.emplace_back();
        at_ = afterSpace(at_ + 1);
        continue;
      }
      std::string before = std::exchange(out_, {});
      step();
      parts.back() += std::exchange(out_, std::move(before));
    }
    ++at_;
    return parts;
  }

  void step() {
    const Token here = tokens_[at_];
    if (isComment(here) || isSpace(here)) return copy();
    if (here == "struct") return readStruct();
    if (here == "uniform" && braces_ == 0) return writeUniforms();
    if (here == "out" && braces_ == 0 && parentheses_ == 0) return skipPast(";"), skipLineEnd();
    if (here == "void" && token(afterSpace(at_ + 1)) == "main") return beginMain();
    if (here == "return" && in_main_ && token(at_ + 1) == ";") return out_ += "return value", void(++at_);
    if (here == "gl_FragCoord") return out_ += "pixel_place", void(++at_);
    if (std::isdigit(static_cast<unsigned char>(here.front())) && here.ends_with('u')) return out_ += withoutSuffix(here), void(++at_);
    if (structs_.contains(here)) return declare(here);
    if (const auto variable = variables_.find(here); variable != variables_.end() && !out_.ends_with('.')) return writeVariable(*variable);
    if (isWordPart(here.front()) && isXorAssigned()) return writeXor();
    copy();
  }

  void copy() {
    const Token here = tokens_[at_++];
    parentheses_ += (here == "(") - (here == ")");
    braces_ += (here == "{") - (here == "}");
    if (here == "}" && braces_ == 0) {
      variables_.clear();
      if (std::exchange(in_main_, false)) out_ += "  return value;\n}\n\nvoid fragment() {\n  COLOR = valueAt(FRAGCOORD.xy);\n";
    }
    out_ += here;
  }

  void readStruct() {
    at_ = afterSpace(at_ + 1);
    Fields& fields = structs_[tokens_[at_]];
    at_ = afterSpace(afterSpace(at_ + 1) + 1);
    while (at_ < end_ && tokens_[at_] != "}") {
      const Token type = tokens_[at_];
      at_ = afterSpace(at_ + 1);
      fields.emplace_back(type, tokens_[at_]);
      skipPast(";");
      at_ = afterSpace(at_);
    }
    skipPast(";");
    skipLineEnd();
  }

  // Those of Godot have one name, and may have hints after it.
  void writeUniforms() {
    const auto last = std::find_if(tokens_.begin() + at_, tokens_.end(), [](Token token) { return token == ";" || token == ":"; });
    if (last != tokens_.end() && *last == ":") return copy();
    ++at_;
    const std::vector<std::string> names = partsUpTo(";");
    const std::string& first = names.front();
    out_ += "uniform" + first + ";";
    const std::string type = first.substr(0, first.rfind(' ') + 1);
    for (size_t i = 1; i < names.size(); ++i) out_ += "\nuniform" + type + names[i] + ";";
  }

  void beginMain() {
    in_main_ = true;
    braces_ = 1;
    skipPast("{");
    out_ += "vec4 valueAt(vec2 pixel_place) {\n  vec4 value = vec4(0.0);";
  }

  // A parameter, or a variable of a function.
  void declare(Token type) {
    const Fields& fields = structs_[type];
    const std::string qualifier = out_.ends_with("inout ") ? "inout " : "";
    at_ = afterSpace(at_ + 1);
    const Token name = tokens_[at_++];
    variables_[name] = &fields;
    std::vector<std::string> values;
    const bool is_parameter = parentheses_ > 0;
    if (!is_parameter && token(afterSpace(at_)) == "=") {
      skipPast("(");
      values = partsUpTo(")");
    }
    for (size_t i = 0; i < fields.size(); ++i) {
      if (i > 0) out_ += is_parameter ? ", " + qualifier : "; ";
      out_ += std::string(fields[i].first) + " " + fieldOf(name, fields[i].second);
      if (!values.empty()) out_ += " = " + values[i];
    }
  }

  static std::string fieldOf(Token variable, Token field) { return std::string(variable) + "_" + std::string(field); }

  void writeVariable(const std::pair<const Token, const Fields*>& variable) {
    const auto& [name, fields] = variable;
    if (token(++at_) == ".") {
      out_ += fieldOf(name, tokens_[at_ + 1]);
      at_ += 2;
      return;
    }
    for (size_t i = 0; i < fields->size(); ++i) out_ += (i > 0 ? ", " : "") + fieldOf(name, (*fields)[i].second);
  }

  bool isXorAssigned() const {
    const size_t next = afterSpace(at_ + 1);
    return token(next) == "^" && token(next + 1) == "=";
  }

  void writeXor() {
    const std::string name(tokens_[at_]);
    skipPast("=");
    at_ = afterSpace(at_);
    out_ += name + " = " + name + " ^ (" + partsUpTo(";").front() + ");";
  }

  std::vector<Token> tokens_;
  size_t at_, end_;
  std::string out_;
  int parentheses_ = 0, braces_ = 0;
  bool in_main_ = false;
  std::map<Token, Fields> structs_;
  std::map<Token, const Fields*> variables_;  // of the function
};

}  // namespace

std::string gdshaderOf(std::string_view glsl) { return GodotTranslation(glsl).run(); }

}  // namespace cloudbake
