#include "core/text/toml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text/check_toml.h"
#include "core/text/nearest.h"
#include "core/text/numbers.h"
#include "core/text/plain_text.h"

namespace cloudbake {

namespace {

constexpr size_t kMaxBytes = 16U << 20U;

std::string rangeText(double low, double high) {
  if (std::isinf(low) && std::isinf(high)) return "";
  if (std::isinf(high)) return " of " + shortestText(low) + " or more";
  return " from " + shortestText(low) + " to " + shortestText(high);
}

std::optional<double> finiteNumber(const toml::node& node) {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace

void refuseToml(const std::string& file, const toml::source_region& place, const std::string& what) {
  throw InputError(file, int(place.begin.line), int(place.begin.column), what);
}

toml::table parseTomlTable(const std::string& text, const std::string& file) {
  if (text.size() > kMaxBytes) throw InputError(file, "the file is larger than 16 MiB: this is not a manifest or scene");
  std::string storage;
  const std::string_view plain = plainText(text, file, storage);
  checkTomlText(plain, file);
  try {
    return toml::parse(plain, file);
  } catch (const toml::parse_error& error) {
    refuseToml(file, error.source(), "not valid TOML: " + std::string(error.description()));
  }
}

std::vector<std::pair<const toml::key*, const toml::node*>> inOrder(const toml::table& table) {
  std::vector<std::pair<const toml::key*, const toml::node*>> all;
  for (const auto& [key, node] : table) all.emplace_back(&key, &node);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    const auto &p = a.first->source().begin, &q = b.first->source().begin;
    return p.line != q.line ? p.line < q.line : p.column < q.column;
  });
  return all;
}

std::string optionText(const toml::node& node, const std::string& file) {
  if (node.is_string()) return *node.value<std::string>();
  if (node.is_boolean()) return *node.value<bool>() ? "true" : "false";
  if (node.is_integer()) return std::to_string(*node.value<int64_t>());
  if (node.is_floating_point() && std::isfinite(*node.value<double>())) return shortestText(*node.value<double>());
  if (const toml::array* list = node.as_array(); list && !list->empty()) {
    std::string joined;
    for (const toml::node& element : *list) {
      if (element.is_array()) break;
      joined += (joined.empty() ? "" : ",") + optionText(element, file);
      if (&element == &list->back()) return joined;
    }
  }
  refuseToml(file, node.source(), "no option takes this value: give a text, a finite number, true or false, or a list of them");
}

std::vector<double> finiteNumbers(const toml::node& node, size_t count, const std::function<void(const toml::node&)>& refuse) {
  std::vector<double> numbers;
  const toml::array* array = node.as_array();
  if (array)
    for (const toml::node& element : *array)
      if (const auto value = finiteNumber(element)) numbers.push_back(*value);
  if (!array || numbers.size() != count || array->size() != count) refuse(node);
  return numbers;
}

const toml::node* TomlReader::find(const char* key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.emplace_back(key);
  return table_ ? table_->get(key) : nullptr;
}

void TomlReader::refuse(const char* key, const toml::node& node, const std::string& wanted) const {
  refuseToml(file_, node.source(), std::string(key) + " must be " + wanted);
}

void TomlReader::refuseAt(const char* key, const std::string& what) const {
  if (!table_) throw InputError(file_, what);
  const toml::node* node = table_->get(key);
  refuseToml(file_, node ? node->source() : table_->source(), what);
}

std::optional<double> TomlReader::number(const char* key, double low, double high) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const auto value = finiteNumber(*node);
  if (!value || *value < low || *value > high) refuse(key, *node, "a number" + rangeText(low, high));
  return value;
}

void TomlReader::read(const char* key, double low, double high, double& value) { value = number(key, low, high).value_or(value); }

void TomlReader::read(const char* key, double low, double high, float& value) {
  if (const auto given = number(key, low, high)) value = float(*given);
}

void TomlReader::read(const char* key, double low, double high, std::optional<float>& value) {
  if (const auto given = number(key, low, high)) value = float(*given);
}

void TomlReader::readRange(const char* key, double low, double high, float& first, float& second) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto end = [&](const toml::node& one) { return one.is_number() ? one.value<double>().value_or(NAN) : NAN; };
  const toml::array* pair = node->as_array();
  const bool is_pair = pair && pair->size() == 2;
  const double from = is_pair ? end((*pair)[0]) : end(*node), to = is_pair ? end((*pair)[1]) : from;
  if (!(low <= from && from <= to && to <= high))
    refuse(key, *node, "a number" + rangeText(low, high) + ", or a range [low, high] of them");
  first = float(from);
  second = float(to);
}

void TomlReader::readPositive(const char* key, double& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto given = finiteNumber(*node);
  if (!given || !(*given > 0)) refuse(key, *node, "a number above 0");
  value = *given;
}

bool TomlReader::isNone(const char* key) {
  const toml::node* node = find(key);
  return node && node->value<std::string_view>() == std::string_view("none");
}

std::optional<std::vector<double>> TomlReader::numbers(const char* key, size_t count, const char* wanted) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  return finiteNumbers(*node, count, [&](const toml::node& place) { refuse(key, place, wanted); });
}

void TomlReader::read(const char* key, int64_t low, int64_t high, int64_t& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto given = node->is_integer() ? node->value<int64_t>() : std::nullopt;
  if (!given || *given < low || *given > high) refuse(key, *node, fmt::format("a whole number from {} to {}", low, high));
  value = *given;
}

void TomlReader::read(const char* key, bool& value) {
  const toml::node* node = find(key);
  if (!node) return;
  if (!node->is_boolean()) refuse(key, *node, "true or false");
  value = *node->value<bool>();
}

void TomlReader::read(const char* key, std::string& value) {
  const toml::node* node = find(key);
  if (!node) return;
  if (!node->is_string() || node->value<std::string_view>()->empty()) refuse(key, *node, "a text in quotes");
  value = *node->value<std::string>();
}

template <size_t count>
std::array<float, count> TomlReader::coordinates(const char* key, const toml::node& node, double low, double high,
                                                 const std::string& wanted) const {
  const toml::array* given = node.as_array();
  if (!given || given->size() != count) refuse(key, node, wanted);
  std::array<float, count> numbers{};
  for (size_t i = 0; i < count; ++i) {
    const toml::node& element = (*given)[i];
    const auto value = element.is_number() ? element.value<double>() : std::nullopt;
    if (!value || !(*value >= low) || !(*value <= high)) refuse(key, element, wanted);
    numbers[i] = float(*value);
  }
  return numbers;
}

void TomlReader::read(const char* key, double low, double high, Vec2& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto [x, y] = coordinates<2>(key, *node, low, high, "two numbers" + rangeText(low, high) + ": [x, y]");
  value = {x, y};
}

void TomlReader::read(const char* key, double low, double high, Vec3& value, bool or_one) {
  const toml::node* node = find(key);
  if (!node) return;
  if (or_one && node->is_number()) {
    const auto all = float(*number(key, low, high));
    value = {all, all, all};
    return;
  }
  const auto [x, y, z] = coordinates<3>(key, *node, low, high, "three numbers" + rangeText(low, high) + ": [x, y, z]");
  value = {x, y, z};
}

TomlReader TomlReader::table(const char* key) {
  const std::string name = name_.empty() ? "[" + std::string(key) + "]" : name_.substr(0, name_.size() - 1) + "." + key + "]";
  const toml::node* node = find(key);
  if (node && !node->is_table()) refuse(key, *node, "a table " + name);
  return {node ? node->as_table() : nullptr, name, file_};
}

std::vector<TomlReader> TomlReader::tables(const char* key) {
  const toml::node* node = find(key);
  std::vector<TomlReader> all;
  if (!node) return all;
  const std::string name = "[[" + (name_.empty() ? "" : name_.substr(1, name_.size() - 2) + ".") + key + "]]";
  const toml::array* list = node->as_array();
  if (!list || !list->is_homogeneous(toml::node_type::table)) refuse(key, *node, "tables " + name);
  for (const toml::node& element : *list) all.emplace_back(element.as_table(), name, file_);
  return all;
}

void TomlReader::finish() const {
  if (!table_) return;
  for (const auto& [key, node] : inOrder(*table_)) {
    if (std::find(asked_.begin(), asked_.end(), key->str()) != asked_.end()) continue;
    const std::vector<std::string> known(asked_.begin(), asked_.end());
    std::string all;
    for (const std::string& word : known) all += (all.empty() ? "" : ", ") + word;
    const std::string nearest = nearestName(key->str(), known);
    refuseToml(file_, key->source(),
               fmt::format("unknown key '{}'{}: there are {}{}", key->str(), name_.empty() ? "" : " in " + name_, all, nearest));
  }
}

}  // namespace cloudbake
