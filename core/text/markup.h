// Text and numbers as XML, SVG, HTML and messages carry them, whatever a file name holds and whatever the locale is.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace cloudbake {

/// The text with every byte that is no UTF-8 replaced by U+FFFD, as JSON files of ours have it.
std::string validUtf8(std::string_view text);

/// The same with a blank for every control character: one line for a terminal or a list.
std::string onOneLine(std::string_view text);

/// Character data and attribute values of XML 1.0 and of HTML, in either kind of quotes: markup escaped, tabs and line ends as references,
/// what XML forbids (other control characters, U+FFFE, U+FFFF) dropped, wrong UTF-8 replaced by U+FFFD.
std::string escapedMarkup(std::string_view text);

/// With a point, in every locale.
std::string numberText(double value, std::chars_format format = std::chars_format::fixed, int precision = 1);

}  // namespace cloudbake
