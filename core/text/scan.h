// Lines, words and numbers of a text file, without locale and without copies. Used by the text formats' readers.
#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cloudbake {

/// Walks over the lines of a text. "\n" and "\r\n" end a line.
struct LineScanner {
  std::string_view rest;
  int line = 0;  ///< number of the line that next() gave last, from 1

  /// The next line without its end; nothing at the end of the text.
  std::optional<std::string_view> next() {
    if (rest.empty()) return std::nullopt;
    const size_t end = rest.find('\n');
    std::string_view text = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    ++line;
    return text;
  }
};

/// Takes the next word off the front of `text`; empty at the end. A word ends at a blank, a tab or a line end.
inline std::string_view takeWord(std::string_view& text) {
  constexpr std::string_view kBlanks = " \t\r\n\v\f";
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return text = {};
  text.remove_prefix(begin);
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

/// A whole word as a number, "nan" and "inf" included; nothing where it is none. Too small for a double gives 0.
inline std::optional<double> parseNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return word.find("e-") != word.npos || word.find("E-") != word.npos ? 0.0 : HUGE_VAL;
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

/// A whole word as the float nearest to it, as parseNumber does. A float written with the fewest digits comes back bit by bit.
inline std::optional<float> parseFloat(std::string_view word) {
  float value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && end == word.data() + word.size()) return value;
  const auto wide = parseNumber(word);  // a sign in front, or beyond a float's range
  return wide ? std::optional(float(*wide)) : std::nullopt;
}

/// A whole word as an integer; nothing where it is none or too large.
inline std::optional<long long> parseInteger(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// ASCII letters in lower case, all else as it is.
inline std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return lower;
}

}  // namespace cloudbake
