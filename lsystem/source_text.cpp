// Blanks have no meaning in a grammar (L-system notes, section 1). The columns of the other characters are kept for error messages.
#include "lsystem/source_text.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "core/text/scan.h"

namespace cloudbake {

namespace {

[[noreturn]] void refuseCharacter(const std::string& file, int line, int column, char c) {
  if (c == '`')
    throw InputError(file, line, column,
                     "a backquoted Houdini expression cannot be evaluated here: write its value, or declare a variable for it");
  throw InputError(file, line, column, "only printable ASCII characters can be symbols: replace this character (a pasted quote or dash?)");
}

}  // namespace

PlainText plainText(const std::string& file, const SourceLine& line) {
  PlainText plain{file, line.text, line.line, {}, {}, 0};
  int depth = 0;
  bool quoted = false;
  for (size_t i = 0; i < line.text.size(); ++i) {
    const char c = line.text[i];
    const int column = line.column > 0 ? line.column + int(i) : 0;
    if (!quoted && isBlank(c)) continue;
    if (c == '`' || static_cast<unsigned char>(c) >= 127 || static_cast<unsigned char>(c) < 32) refuseCharacter(file, line.line, column, c);
    if (c == '"' && depth > 0) quoted = !quoted;
    if (!quoted && c == '(') ++depth;
    if (!quoted && c == ')') --depth;
    plain.characters += c;
    plain.columns.push_back(column);
  }
  plain.end_column = line.column > 0 ? line.column + int(line.text.size()) : 0;
  return plain;
}

void failAt(const PlainText& text, size_t position, const std::string& message) {
  const int column = position < text.columns.size() ? text.columns[position] : text.end_column;
  throw InputError(text.file, text.line, column, message);
}

size_t closingParenthesis(const PlainText& text, size_t open, size_t end) {
  int depth = 0;
  bool quoted = false;
  for (size_t i = open; i < end; ++i) {
    const char c = text.characters[i];
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '(') ++depth;
    if (c == ')' && --depth == 0) return i;
  }
  failAt(text, open, quoted ? "this \"(\" holds a text whose closing quote is missing" : "this \"(\" is never closed: add a \")\"");
}

}  // namespace cloudbake
