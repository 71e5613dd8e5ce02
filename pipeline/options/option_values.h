// Values of options: reads them from text, with messages that say what is wanted, and makes the OptionValue of a field of the settings. The
// field is named by the members that lead to it: numberAt<&Settings::lobe, &LobeSettings::smooth>(0, 1000).
#pragma once

#include <charconv>
#include <utility>

#include "core/error.h"
#include "core/text/numbers.h"
#include "pipeline/options/options.h"

namespace cloudbake {

// --- Reading ---

/// Throws UsageError: "--NAME: 'value' is not WANTED".
[[noreturn]] void refuseValue(const Option& option, const std::string& value, const std::string& wanted);

/// The whole text as a number in low … high.
template <class Number>
Number readNumber(const Option& option, const std::string& value, Number low, Number high, const std::string& or_words = "") {
  Number number{};
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  bool usable = error == std::errc() && end == value.data() + value.size() && number >= low && number <= high;
  if constexpr (std::is_floating_point_v<Number>) usable = usable && std::isfinite(number);
  if (usable) return number;
  refuseValue(
      option, value,
      or_words + (std::is_integral_v<Number> ? "a whole number" : "a number") + " from " + shortestText(low) + " to " + shortestText(high));
}
/// A number within the limits of the option.
template <class Number>
Number readNumber(const Option& option, const std::string& value) {
  const ValueForm& form = option.value.form;
  return readNumber<Number>(option, value, limitAs<Number>(form.low), limitAs<Number>(form.high),
                            form.words[0].text ? wordList(form) + " or " : "");
}
bool readFlag(const Option& option, const std::string& value);
int readChoice(const Option& option, const std::string& value);
/// "A,B" or "AxB".
std::pair<std::string, std::string> readPair(const Option& option, const std::string& value, char separator);
/// The parts between commas; empty ones too.
std::vector<std::string> readList(const std::string& value);

/// A number, or one that is followed by % as a fraction of 1; both within the limits of the option.
template <class Share>
Share readShare(const Option& option, const std::string& value) {
  using Number = decltype(Share{}.value);
  if (!value.ends_with('%')) return {readNumber<Number>(option, value), false};
  const ValueForm& form = option.value.form;
  const std::string number = value.substr(0, value.size() - 1);
  return {readNumber<Number>(option, number, limitAs<Number>(form.low_percent), limitAs<Number>(form.high_percent)) / 100, true};
}

// --- The value of a field ---

template <auto... Members>
using FieldAt = WithoutOptional<std::remove_reference_t<decltype(fieldOf<Members...>(std::declval<Settings&>()))>>;

/// The value of a number's field as text; empty if it is unset or out of range.
template <class Number>
std::string numberText(const Option& option, std::optional<Number> value) {
  const bool is_some = value && double(*value) >= option.value.form.low && double(*value) <= option.value.form.high;
  return is_some ? shortestText(*value) : "";
}
/// The word for a value of an enumeration; empty if there is none.
std::string wordOf(const Option& option, int value);

/// A number; the default is that of the field, unless it is out of range, which means that there is none.
template <auto... Members>
constexpr OptionValue numberAt(double low, double high = double(std::numeric_limits<FieldAt<Members...>>::max())) {
  using Field = FieldAt<Members...>;
  return {[](Settings& s, const Option& o, const std::string& v) { fieldOf<Members...>(s) = readNumber<Field>(o, v); },
          {.kind = std::is_integral_v<Field> ? ValueForm::kWhole : ValueForm::kNumber, .low = low, .high = high},
          [](const Settings& s, const Option& o) { return numberText<Field>(o, fieldOf<Members...>(s)); }};
}

template <auto... Members>
constexpr OptionValue flagAt() {
  return {[](Settings& s, const Option& o, const std::string& v) { fieldOf<Members...>(s) = readFlag(o, v); }, {.kind = ValueForm::kFlag}};
}

/// One of a few words, each with the value of the field.
template <auto... Members>
constexpr OptionValue choiceAt(std::initializer_list<std::pair<const char*, FieldAt<Members...>>> choices) {
  using Field = FieldAt<Members...>;
  ValueForm form{.kind = ValueForm::kChoice};
  auto word = form.words.begin();
  for (const auto& [text, value] : choices) *word++ = {text, int(value)};
  return {[](Settings& s, const Option& o, const std::string& v) { fieldOf<Members...>(s) = Field(readChoice(o, v)); }, form,
          [](const Settings& s, const Option& o) {
            const std::optional<Field> value = fieldOf<Members...>(s);
            return value ? wordOf(o, int(*value)) : "";
          }};
}

/// A length in world units from `low` to `high`, or % of the longest side.
template <auto... Members>
constexpr OptionValue lengthAt(double low, double high) {
  return {[](Settings& s, const Option& o, const std::string& v) { fieldOf<Members...>(s) = readShare<FieldAt<Members...>>(o, v); },
          {.kind = ValueForm::kNumber, .low = low, .high = high, .low_percent = low < 0 ? -1000.0 : 0, .high_percent = 1000}};
}

/// Any text, a path among them.
template <auto... Members>
constexpr OptionValue textAt(const char* examples = "a b") {
  return {[](Settings& s, const Option&, const std::string& v) { fieldOf<Members...>(s) = v; }, {.examples = examples}};
}

}  // namespace cloudbake
