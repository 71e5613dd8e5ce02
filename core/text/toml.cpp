#include "core/text/toml.h"

#include <algorithm>
#include <cmath>

#include "core/text/check_toml.h"
#include "core/error.h"
#include "core/text/numbers.h"

namespace cloudbake {

namespace {

constexpr size_t kMaxBytes = 16U << 20U;

std::string rangeText(double low, double high) { return "from " + shortestText(low) + " to " + shortestText(high); }

}  // namespace

void refuseToml(const std::string& file, const toml::source_region& place, const std::string& what) {
  throw InputError(file, int(place.begin.line), int(place.begin.column), what);
}

toml::table parseTomlTable(const std::string& text, const std::string& file) {
  if (text.size() > kMaxBytes) throw InputError(file, "more than 16 MiB: this is no manifest or scene");
  checkTomlText(text, file);
  try {
    return toml::parse(text, file);
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

const toml::node* TomlReader::find(const char* key) {
  asked_.emplace_back(key);
  return table_ ? table_->get(key) : nullptr;
}

void TomlReader::refuse(const char* key, const toml::node& node, const std::string& wanted) const {
  refuseToml(file_, node.source(), "'" + std::string(key) + "' in " + name_ + " does not fit: give " + wanted);
}

void TomlReader::refuseAt(const char* key, const std::string& what) const {
  if (!table_) throw InputError(file_, what);
  const toml::node* node = table_->get(key);
  refuseToml(file_, node ? node->source() : table_->source(), what);
}

std::optional<double> TomlReader::number(const char* key, double low, double high) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !(*value >= low) || !(*value <= high)) refuse(key, *node, "a number " + rangeText(low, high));
  return value;
}

void TomlReader::read(const char* key, double low, double high, double& value) { value = number(key, low, high).value_or(value); }

void TomlReader::read(const char* key, double low, double high, float& value) {
  if (const auto given = number(key, low, high)) value = float(*given);
}

void TomlReader::read(const char* key, double low, double high, std::optional<float>& value) {
  if (const auto given = number(key, low, high)) value = float(*given);
}

void TomlReader::read(const char* key, int low, int high, int& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto given = node->is_integer() ? node->value<int64_t>() : std::nullopt;
  if (!given || *given < low || *given > high) refuse(key, *node, "a whole number " + rangeText(low, high));
  value = int(*given);
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

void TomlReader::read(const char* key, double low, double high, Vec3& value, bool or_one) {
  const toml::node* node = find(key);
  if (!node) return;
  if (or_one && node->is_number()) {
    const auto all = float(*number(key, low, high));
    value = {all, all, all};
    return;
  }
  const toml::array* three = node->as_array();
  const std::string wanted = "three numbers " + rangeText(low, high) + ", [x, y, z]";
  if (!three || three->size() != 3) refuse(key, *node, wanted);
  std::array<float, 3> numbers{};
  for (size_t i = 0; i < 3; ++i) {
    const toml::node& element = (*three)[i];
    const auto given = element.is_number() ? element.value<double>() : std::nullopt;
    if (!given || !(*given >= low) || !(*given <= high)) refuse(key, element, wanted);
    numbers[i] = float(*given);
  }
  value = {numbers[0], numbers[1], numbers[2]};
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
  const std::string name = "[[" + std::string(key) + "]]";
  const toml::array* list = node->as_array();
  if (!list || !list->is_homogeneous(toml::node_type::table)) refuse(key, *node, "tables " + name);
  for (const toml::node& element : *list) all.emplace_back(element.as_table(), name, file_);
  return all;
}

void TomlReader::finish() const {
  if (!table_) return;
  for (const auto& [key, node] : inOrder(*table_)) {
    if (std::find(asked_.begin(), asked_.end(), key->str()) != asked_.end()) continue;
    std::string known;
    for (const std::string_view word : asked_) known += (known.empty() ? "" : ", ") + std::string(word);
    refuseToml(file_, key->source(),
               "unknown key '" + std::string(key->str()) + "' in " + (name_.empty() ? "a scene" : name_) + ": there are " + known);
  }
}

}  // namespace cloudbake
