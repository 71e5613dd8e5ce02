// Text and numbers for XML, SVG, HTML and messages. File names may hold any bytes, and the locale does not matter.
#pragma once

#include <charconv>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace cloudbake {

/// The text with every byte that is not valid UTF-8 replaced by U+FFFD, as in the JSON files that cloudbake writes.
std::string validUtf8(std::string_view text);

/// The same for a line of a terminal, a log or a list: control characters (of C0, C1 and of the direction of writing) and line separators
/// become blanks, and a text of more than 2,000 bytes is cut, so that a name in a file cannot take over a terminal.
std::string onOneLine(std::string_view text);
/// The same for each line of a text.
std::string onOwnLines(std::string_view lines);

/// The text escaped for character data and attribute values of XML 1.0 and HTML, in either kind of quotes. Tabs and line ends become
/// character references. Characters that XML forbids (other control characters, U+FFFE, U+FFFF) are dropped. Invalid UTF-8 is replaced by
/// U+FFFD.
std::string escapedMarkup(std::string_view text);

/// A template with its marks, such as @NAME@, replaced by texts. What is put in is not looked at again, so that it may hold marks.
std::string filledTemplate(std::string_view text, std::span<const std::pair<std::string_view, std::string>> marks);
inline std::string filledTemplate(std::string_view text, std::initializer_list<std::pair<std::string_view, std::string>> marks) {
  return filledTemplate(text, std::span(marks.begin(), marks.size()));
}

/// The number with a decimal point, in every locale.
std::string numberText(double value, std::chars_format format = std::chars_format::fixed, int precision = 1);

}  // namespace cloudbake
