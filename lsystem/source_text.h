// A line of a grammar with its place in the file, so that every error names file, line and column.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cloudbake {

/// One rule or premise as written. `line` and `column` give the place of its first character in the file (1, 2, …; 0 = unknown).
struct SourceLine {
  std::string text;
  int line = 0, column = 0;
};

/// A line without its blanks, with the place of every remaining character. Blanks inside a quoted text in parentheses are kept.
struct PlainText {
  std::string file, original;
  int line = 0;
  std::string characters;
  std::vector<int> columns;  ///< #characters, 0 = unknown
  int end_column = 0;        ///< the column after the last character
};

/// Index of a symbol (printable ASCII) in tables of 128 entries.
constexpr size_t symbolIndex(char symbol) { return static_cast<unsigned char>(symbol); }

/// Throws InputError for a character that is not allowed in a grammar (a backquote, anything outside printable ASCII).
PlainText plainText(const std::string& file, const SourceLine& line);

/// Throws InputError for the place of the character `position`.
[[noreturn]] void failAt(const PlainText& text, size_t position, const std::string& message);

/// Position of the parenthesis before `end` that closes the one at `open`. Throws InputError if it is never closed.
size_t closingParenthesis(const PlainText& text, size_t open, size_t end);

}  // namespace cloudbake
