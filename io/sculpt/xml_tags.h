// The tags of an XML file one after another, to look up attributes in files that a library reads. Nothing is copied, and nothing is checked
// beyond what that takes: the library judges the file.
#pragma once

#include <optional>
#include <string_view>

namespace cloudbake {

struct XmlTag {
  std::string_view name;        ///< with its prefix, as written
  std::string_view attributes;  ///< as written
  bool opens = true;            ///< false for </name>
  bool closes = false;          ///< true for </name> and <name/>
};

class XmlTags {
 public:
  explicit XmlTags(std::string_view xml) : rest_(xml) {}
  /// The next tag; nothing at the end. Comments, CDATA sections, declarations and processing instructions are passed over.
  std::optional<XmlTag> next();
  /// What follows the last tag, up to the next.
  std::string_view text() const { return rest_.substr(0, rest_.find('<')); }

 private:
  std::string_view rest_;
};

/// Removes the next attribute from the front of `attributes`. Character references in its value stay as they are.
struct XmlAttribute {
  std::string_view name, value;
};
std::optional<XmlAttribute> takeAttribute(std::string_view& attributes);

/// The value of an attribute.
std::optional<std::string_view> attributeOf(const XmlTag& tag, std::string_view name);

}  // namespace cloudbake
