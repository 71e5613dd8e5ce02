// Names are escaped as in GCC (gcc/libcpp/mkdeps.cc, munge), because Make and Ninja read that form. Only before a blank, backslashes are
// doubled and one is added. A colon is escaped too: both programs read it, and Make would take a bare colon for a rule. Some names, such as
// those with ';' or '|', cannot be written in any form that Make or Ninja reads.
#include "core/error.h"
#include "core/text/markup.h"
#include "io/report/batch_report.h"

namespace cloudbake {

namespace {

std::string escapedPath(const std::filesystem::path& path) {
  const std::string text = path.string();
  if (text.find_first_of("\r\n") != std::string::npos || text.ends_with('\\'))
    throw InputError(onOneLine(text),
                     "a depfile cannot contain a file name with a line break or with a backslash at its end; rename the file");
  std::string result;
  size_t backslashes = 0;  // directly before this character
  for (const char c : text) {
    if (c == ' ' || c == '\t')
      result.append(backslashes + 1, '\\');
    else if (c == '$')
      result += '$';
    else if (c == '#' || c == ':')
      result += '\\';
    result += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return result;
}

}  // namespace

std::string depfileText(const std::filesystem::path& target, const std::vector<std::filesystem::path>& prerequisites) {
  std::string text = escapedPath(target) + ":";
  for (const auto& prerequisite : prerequisites) text += " \\\n  " + escapedPath(prerequisite);
  text += "\n";
  for (const auto& prerequisite : prerequisites) text += escapedPath(prerequisite) + ":\n";  // like gcc -MP
  return text;
}

}  // namespace cloudbake
