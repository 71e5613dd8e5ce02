// Characters: "Extensible Markup Language (XML) 1.0", fifth edition, production 2 (Char); line ends in attributes: its section 3.3.3.
#include "core/text/markup.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core/text/json.h"

namespace cloudbake {

namespace {

// Of a character of valid UTF-8, by its first byte.
size_t lengthOfCharacter(char first) {
  const auto byte = static_cast<unsigned char>(first);
  return byte < 0x80 ? 1 : byte < 0xE0 ? 2 : byte < 0xF0 ? 3 : 4;
}

// C0, DEL, C1, the marks, embeddings and isolates of bidirectional text (Unicode 15, section 23.2), and the line and paragraph separators.
bool isControl(std::string_view character) {
  if (character.size() == 1) return static_cast<unsigned char>(character[0]) < 0x20 || character[0] == 0x7F;
  const auto between = [&](std::string_view low, std::string_view high) { return low <= character && character <= high; };
  return between("\u0080", "\u009F") || between("\u200E", "\u200F") || between("\u2028", "\u202E") || between("\u2066", "\u2069") ||
         character == "\u061C";
}

}  // namespace

std::string validUtf8(std::string_view text) {
  return parseJson(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).value().get<std::string>();
}

std::string onOneLine(std::string_view text) {
  constexpr size_t kLongestLine = 2000;
  const std::string valid = validUtf8(text.substr(0, 2 * kLongestLine));
  std::string line;
  for (size_t i = 0; i < valid.size();) {
    const size_t length = lengthOfCharacter(valid[i]);
    const std::string_view character(&valid[i], length);
    if (line.size() + length > kLongestLine) return line + "…";
    line += isControl(character) ? " " : character;
    i += length;
  }
  return text.size() > 2 * kLongestLine ? line + "…" : line;
}

std::string escapedMarkup(std::string_view text) {
  const std::string valid = validUtf8(text);
  std::string result;
  for (size_t i = 0; i < valid.size(); ++i) switch (const char c = valid[i]) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      case '\'': result += "&#39;"; break;
      case '\t': result += "&#9;"; break;
      case '\n': result += "&#10;"; break;
      case '\r': result += "&#13;"; break;
      default:
        if (valid.compare(i, 3, "\xEF\xBF\xBE") == 0 || valid.compare(i, 3, "\xEF\xBF\xBF") == 0) {
          i += 2;
        } else if (static_cast<unsigned char>(c) >= 0x20) {
          result += c;
        }
    }
  return result;
}

std::string onOwnLines(std::string_view lines) {
  std::string text;
  while (!lines.empty()) {
    const size_t end = std::min(lines.find('\n'), lines.size());
    text += onOneLine(lines.substr(0, end));
    if (end < lines.size()) text += '\n';
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return text;
}

std::string filledTemplate(std::string_view text, std::span<const std::pair<std::string_view, std::string>> marks) {
  std::string filled, first_letters;
  for (const auto& [mark, value] : marks) first_letters += mark.front();
  for (size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    const auto found = std::find_if(marks.begin(), marks.end(), [&](const auto& one) { return rest.starts_with(one.first); });
    const size_t end = found == marks.end() ? text.find_first_of(first_letters, at + 1) : at + found->first.size();
    filled += found == marks.end() ? text.substr(at, end - at) : std::string_view(found->second);
    at = std::min(end, text.size());
  }
  return filled;
}

std::string numberText(double value, std::chars_format format, int precision) {
  std::array<char, 400> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, format, precision).ptr};
}

}  // namespace cloudbake
