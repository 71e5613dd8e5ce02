// Characters: "Extensible Markup Language (XML) 1.0", fifth edition, production 2 (Char); line ends in attributes: its section 3.3.3.
#include "core/text/markup.h"

#include <array>
#include <nlohmann/json.hpp>

namespace cloudbake {

std::string validUtf8(std::string_view text) {
  using Json = nlohmann::json;
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

std::string onOneLine(std::string_view text) {
  std::string line = validUtf8(text);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return line;
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

std::string numberText(double value, std::chars_format format, int precision) {
  std::array<char, 400> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, format, precision).ptr};
}

}  // namespace cloudbake
