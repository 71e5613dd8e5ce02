// A line of a grammar that knows where it stands, so that every error names file, line and column.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cloudbake {

/// One rule or premise as written. `line` and `column` are those of its first character in the file (1, 2, …; 0 = unknown).
struct SourceLine {
  std::string text;
  int line = 0, column = 0;
};

/// A line without its blanks (blanks inside a quoted text in parentheses stay), with the place of every character left.
struct PlainText {
  std::string file, original;
  int line = 0;
  std::string characters;
  std::vector<int> columns;  ///< #characters, 0 = unknown
  int end_column = 0;        ///< behind the last character
};

/// Index of a symbol (printable ASCII) in tables of 128.
constexpr size_t symbolIndex(char symbol) { return static_cast<unsigned char>(symbol); }

/// Throws InputError for a character that no grammar may hold (a backquote, anything outside ASCII).
PlainText plainText(const std::string& file, const SourceLine& line);

/// Throws InputError at the character `position`.
[[noreturn]] void failAt(const PlainText& text, size_t position, const std::string& message);

/// Position of the parenthesis that closes the one at `open`, before `end`. Throws InputError if it stays open.
size_t closingParenthesis(const PlainText& text, size_t open, size_t end);

}  // namespace cloudbake
