// Splits a text into lines, words and numbers, independent of the locale and without copies. The readers of text formats use it.
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

/// Iterates over the lines of a text. "\n" and "\r\n" end a line (core/text/plain_text.h mends others).
struct LineScanner {
  std::string_view rest;
  int line = 0;          ///< number of the line that next() returned last, from 1
  char line_end = '\n';  ///< the last character of a line end

  /// The next line without its line end; nothing at the end of the text.
  std::optional<std::string_view> next() {
    if (rest.empty()) return std::nullopt;
    const size_t end = rest.find(line_end);
    std::string_view text = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    ++line;
    return text;
  }
};

/// A blank, tab, line feed, vertical tab, form feed or carriage return.
constexpr bool isBlank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// The text without blanks and line ends at its ends.
inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// Removes the next word from the front of `text` and returns it; empty at the end. A word ends at a blank, a tab or a line end.
inline std::string_view takeWord(std::string_view& text) {
  const auto begin = std::find_if_not(text.begin(), text.end(), isBlank), end = std::find_if(begin, text.end(), isBlank);
  const std::string_view word = text.substr(size_t(begin - text.begin()), size_t(end - begin));
  text.remove_prefix(size_t(end - text.begin()));
  return word;
}

/// A whole word as a number, "nan" and "inf" included; nothing if it is not a number. A number too small for a double gives 0.
inline std::optional<double> parseNumber(std::string_view word) {
  if (word.starts_with("+-")) return std::nullopt;
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return word.find("e-") != word.npos || word.find("E-") != word.npos ? 0.0 : HUGE_VAL;
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

/// Like parseNumber, but returns the nearest float. A float that was written with the fewest digits is restored bit by bit.
inline std::optional<float> parseFloat(std::string_view word) {
  float value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && end == word.data() + word.size()) return value;
  const auto wide = parseNumber(word);  // has a leading sign, or is outside a float's range
  return wide ? std::optional(float(*wide)) : std::nullopt;
}

/// A whole word as an integer; nothing if it is not an integer or too large.
inline std::optional<long long> parseInteger(std::string_view word) {
  if (word.starts_with("+-")) return std::nullopt;
  if (word.starts_with('+')) word.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// A word of a file for a message, cut if it is long.
inline std::string quotedWord(std::string_view word) {
  constexpr size_t kLongest = 40;
  return "'" + std::string(word.substr(0, kLongest)) + (word.size() > kLongest ? "…'" : "'");
}

/// The text with ASCII letters in lower case and everything else unchanged.
inline std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return lower;
}

}  // namespace cloudbake
