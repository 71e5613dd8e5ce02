// XML 1.0, sections 2 and 3.
#include "io/sculpt/xml_tags.h"

#include <algorithm>

#include "core/text/scan.h"

namespace cloudbake {

namespace {

// Removes everything up to and including `end`.
void passOver(std::string_view& text, std::string_view end) {
  const size_t at = text.find(end);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + end.size());
}

// The end of a tag. A quoted value may have a > in it.
size_t endOfTag(std::string_view text) {
  char quote = 0;
  for (size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != 0)
      quote = c == quote ? char(0) : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '>')
      return at;
  }
  return text.size();
}

}  // namespace

std::optional<XmlTag> XmlTags::next() {
  for (;;) {
    passOver(rest_, "<");
    if (rest_.empty()) return std::nullopt;
    if (rest_.starts_with("!--")) {
      passOver(rest_, "-->");
    } else if (rest_.starts_with("![CDATA[")) {
      passOver(rest_, "]]>");
    } else if (rest_.starts_with("?") || rest_.starts_with("!")) {
      passOver(rest_, ">");
    } else {
      break;
    }
  }
  const size_t end = endOfTag(rest_);
  std::string_view inside = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  XmlTag tag;
  if (inside.starts_with('/')) {
    tag.opens = false, tag.closes = true;
    inside.remove_prefix(1);
  } else if (inside.ends_with('/')) {
    tag.closes = true;
    inside.remove_suffix(1);
  }
  tag.name = takeWord(inside);
  tag.attributes = inside;
  return tag;
}

std::optional<XmlAttribute> takeAttribute(std::string_view& attributes) {
  const size_t equals = attributes.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  XmlAttribute attribute{trimmed(attributes.substr(0, equals)), {}};
  attributes = trimmed(attributes.substr(equals + 1));
  const size_t end = attributes.empty() ? std::string_view::npos : attributes.find(attributes[0], 1);
  if (end == std::string_view::npos || (attributes[0] != '"' && attributes[0] != '\'')) return std::nullopt;
  attribute.value = attributes.substr(1, end - 1);
  attributes.remove_prefix(end + 1);
  return attribute;
}

std::optional<std::string_view> attributeOf(const XmlTag& tag, std::string_view name) {
  std::string_view rest = tag.attributes;
  while (const auto attribute = takeAttribute(rest))
    if (attribute->name == name) return attribute->value;
  return std::nullopt;
}

}  // namespace cloudbake
