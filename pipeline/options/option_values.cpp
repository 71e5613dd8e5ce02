#include "pipeline/options/option_values.h"

#include <algorithm>

namespace cloudbake {

void refuseValue(const Option& option, const std::string& value, const std::string& wanted) {
  throw UsageError("--" + std::string(option.name) + ": '" + value + "' is not " + wanted);
}

bool readFlag(const Option& option, const std::string& value) {
  if (value != "true" && value != "false") refuseValue(option, value, "true or false");
  return value == "true";
}

int readChoice(const Option& option, const std::string& value) {
  const ValueForm::Word* word = findWord(option.value.form, value);
  if (!word) refuseValue(option, value, "one of " + wordList(option.value.form));
  return word->value;
}

std::string wordOf(const Option& option, int value) {
  for (const ValueForm::Word& word : option.value.form.words)
    if (word.text && word.value == value) return word.text;
  return "";
}

std::pair<std::string, std::string> readPair(const Option& option, const std::string& value, char separator) {
  const size_t at = value.find(separator);
  if (at == std::string::npos) refuseValue(option, value, std::string("two numbers joined by '") + separator + "'");
  return {value.substr(0, at), value.substr(at + 1)};
}

std::vector<std::string> readList(const std::string& value) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= value.size();) {
    const size_t end = std::min(value.find(',', begin), value.size());
    parts.push_back(value.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace cloudbake
