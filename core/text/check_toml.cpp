// Skips strings in quotes and comments, so that only the text outside them is checked.
#include "core/text/check_toml.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"

namespace cloudbake {

namespace {

constexpr int kMaxKeyParts = 8;

// Position of the last quote of the TOML string that starts at `open`. A single-line string ends at the end of its line at the latest.
size_t closingQuote(std::string_view text, size_t open) {
  const char quote = text[open];
  const std::string three(3, quote);
  const bool is_long = text.substr(open).starts_with(three);
  for (size_t i = open + (is_long ? 3 : 1); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\')
      ++i;
    else if (is_long && text.substr(i).starts_with(three))
      return i + 2;
    else if (!is_long && (text[i] == quote || text[i] == '\n'))
      return i;
  }
  return text.size();
}

}  // namespace

void checkTomlText(std::string_view text, const std::string& file) {
  const auto refuse = [&](size_t i, const std::string& message) {
    throw InputError(file, int(std::count(text.begin(), text.begin() + ptrdiff_t(i), '\n')) + 1, message);
  };
  int dots = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"' || text[i] == '\'') i = closingQuote(text, i);
    if (i < text.size() && text[i] == '#') i = text.find('\n', i);
    if (i >= text.size()) return;
    if (std::strchr("\n=,{}[]", text[i]) != nullptr) dots = 0;
    if (text[i] == '.' && ++dots >= kMaxKeyParts)
      refuse(i, "a key of more than " + std::to_string(kMaxKeyParts) + " parts, or a number with as many dots: remove it");
    if (static_cast<unsigned char>(text[i]) >= 128)
      refuse(i, "not valid TOML: a character outside ASCII is only allowed in quotes and in comments (a pasted quote or dash?)");
  }
}

}  // namespace cloudbake
