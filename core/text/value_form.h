// The values that an option or a key of a file takes, as data. The parser has its limits from it, and so have the fields of the page that
// bakes, Blender's properties, the types of Python, the schemas of the files and the samples of the tests.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace cloudbake {

struct ValueForm {
  /// kChoice takes its words only, and a kWhole or a kNumber takes them beside its numbers.
  enum Kind { kText, kFlag, kChoice, kWhole, kNumber } kind = kText;
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();  ///< both are in the range
  struct Word {
    const char* text = nullptr;
    int value = 0;  ///< of the enumeration that the word sets
  };
  std::array<Word, 4> words{};
  double low_percent = 0, high_percent = 0;  ///< of a number that may also be a share, such as 5%; both 0: it may not
  /// Of several values that are joined: X for each number, N for a whole one, W for a word, then … if there may be more; the separators are
  /// , : = x /. In a file, those that are joined by commas are a list.
  const char* shape = "";
  const char* examples = "";  ///< of a text or a shape: two, joined by a space
};

/// The lower limit of numbers that must be above 0.
inline constexpr double kAboveZero = std::numeric_limits<double>::denorm_min();

/// A limit as the nearest value of a type.
template <class Number>
Number limitAs(double limit) {
  using Limits = std::numeric_limits<Number>;
  if (limit >= double(Limits::max())) return Limits::max();
  return limit <= double(Limits::lowest()) ? Limits::lowest() : Number(limit);
}

/// The word of this text; null if there is none.
inline const ValueForm::Word* findWord(const ValueForm& form, std::string_view text) {
  for (const ValueForm::Word& word : form.words)
    if (word.text && word.text == text) return &word;
  return nullptr;
}

/// "one, two, three".
inline std::string wordList(const ValueForm& form) {
  std::string list;
  for (const auto& [text, value] : form.words)
    if (text) list += (list.empty() ? "" : ", ") + std::string(text);
  return list;
}

template <class Value>
struct InnerValue {
  using Type = Value;
};
template <class Value>
struct InnerValue<std::optional<Value>> {
  using Type = Value;
};
/// The type of a value that may be unset.
template <class Value>
using WithoutOptional = typename InnerValue<Value>::Type;

/// Follows members from an object to the field of a field.
template <auto... Members, class Object>
auto& fieldOf(Object& object) {
  return (object.*....*Members);
}

}  // namespace cloudbake
