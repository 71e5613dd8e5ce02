// Two values that every option takes, the first of them not its default.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/text/numbers.h"
#include "pipeline/options/options.h"

namespace cloudbake {

struct Samples {
  std::string one, other;
};

/// Made from the form of its values: the examples of texts, words, and numbers within the limits, whole ones even.
inline Samples samplesOf(const Option& option) {
  const ValueForm& form = option.value.form;
  const std::string examples = form.examples, fallback = defaultOf(option);
  std::vector<std::string> found;
  const auto add = [&](const std::string& value) {
    if (value != fallback) found.push_back(value);
  };
  const auto addNumber = [&](double number) {
    if (number >= form.low && number <= form.high) add(shortestText(number));
  };
  if (!examples.empty()) return {examples.substr(0, examples.find(' ')), examples.substr(examples.find(' ') + 1)};
  if (form.kind == ValueForm::kFlag) return {"true", "false"};
  const auto words = std::count_if(form.words.begin(), form.words.end(), [](const ValueForm::Word& word) { return word.text; });
  if (form.kind == ValueForm::kChoice) return {form.words[size_t(words) - 1].text, form.words[0].text};
  if (form.high_percent > 0) add("2%");
  if (form.kind == ValueForm::kWhole)
    for (int number = 0; number <= 8; number += 2) addNumber(number);
  for (const double number : {0.5, 0.25, 1.5, 2.5})
    if (form.kind == ValueForm::kNumber) addNumber(number);
  if (words > 0) found.insert(found.begin() + 1, form.words[0].text);
  return found.size() < 2 ? Samples{} : Samples{found[0], found[1]};
}

/// The value with another last digit in each of its numbers, one at a time: "5:60" gives "6:60" and "5:61". A single number gives none.
inline std::vector<std::string> withOneNumberChanged(const std::string& value) {
  constexpr const char* kDigits = "0123456789.";
  std::vector<std::string> changed;
  for (size_t begin = value.find_first_of(kDigits); begin != value.npos;) {
    const size_t end = std::min(value.find_first_not_of(kDigits, begin), value.size());
    char& last = changed.emplace_back(value)[end - 1];
    last = last == '9' ? '8' : char(last + 1);
    begin = value.find_first_of(kDigits, end);
  }
  if (changed.size() < 2) changed.clear();
  return changed;
}

}  // namespace cloudbake
