// TOML by toml++, which keeps the place of every node: tables read key by key, with what is wrong told by file, line and column.
#pragma once

#include <toml++/toml.h>

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// Throws InputError at a place of a file.
[[noreturn]] void refuseToml(const std::string& file, const toml::source_region& place, const std::string& what);

/// Throws InputError where the text is larger than 16 MiB or no TOML; toml++ 3.3 is not given what it cannot be trusted with
/// (check_toml.h).
toml::table parseTomlTable(const std::string& text, const std::string& file);

/// Keys and values of a table in the order of the file: toml++ sorts them by name.
std::vector<std::pair<const toml::key*, const toml::node*>> inOrder(const toml::table& table);

/// A value as the command line would carry it: a text, a finite number, true or false; a list of them joined by commas. Throws InputError
/// for anything else.
std::string optionText(const toml::node& node, const std::string& file);

/// `count` finite numbers in brackets; calls `refuse`, which throws, for anything else.
std::vector<double> finiteNumbers(const toml::node& node, size_t count, const std::function<void(const toml::node&)>& refuse);

/// Reads the keys of one table. What is there must be of the right kind and range; what is not there keeps its value. Every reader ends in
/// finish(), which refuses keys that nothing has asked for. All throw InputError.
class TomlReader {
 public:
  /// `name` of the table for messages, "[sky]"; a null table has no keys. The table must outlive the reader.
  TomlReader(const toml::table* table, std::string name, std::string file)
      : table_(table), name_(std::move(name)), file_(std::move(file)) {}

  bool has(const char* key) const { return table_ && table_->contains(key); }
  /// A finite number, low … high; either end may be infinite.
  void read(const char* key, double low, double high, double& value);
  void read(const char* key, double low, double high, float& value);
  void read(const char* key, double low, double high, std::optional<float>& value);
  /// A finite number above 0.
  void readPositive(const char* key, double& value);
  /// A finite number, or 'none'.
  void readOrNone(const char* key, std::optional<double>& value);
  /// A whole number, low … high.
  void read(const char* key, int64_t low, int64_t high, int64_t& value);
  template <std::integral Integer>
  void read(const char* key, int64_t low, int64_t high, Integer& value) {
    auto wide = int64_t(value);
    read(key, low, high, wide);
    value = Integer(wide);
  }
  void read(const char* key, bool& value);
  void read(const char* key, std::string& value);
  /// Three numbers; with `or_one`, one for all three too.
  void read(const char* key, double low, double high, Vec3& value, bool or_one = false);
  /// `count` finite numbers in brackets, which `wanted` describes; nothing where the key is missing.
  std::optional<std::vector<double>> numbers(const char* key, size_t count, const char* wanted);
  /// Whether the key is there and is 'none'.
  bool isNone(const char* key);
  /// Two numbers, [low, high], or one for both.
  void readRange(const char* key, double low, double high, float& first, float& second);
  /// One of a few words.
  template <typename Value>
  void read(const char* key, std::initializer_list<std::pair<const char*, Value>> choices, Value& value) {
    const toml::node* node = find(key);
    if (!node) return;
    std::string words;
    for (const auto& [word, meaning] : choices) {
      if (node->value<std::string_view>() == std::string_view(word)) {
        value = meaning;
        return;
      }
      words += (words.empty() ? "" : ", ") + std::string(word);
    }
    refuse(key, *node, "one of " + words);
  }
  /// A table below this one: a reader of it, of no keys where it is missing.
  TomlReader table(const char* key);
  /// The tables of a [[key]], in the order of the file.
  std::vector<TomlReader> tables(const char* key);
  /// The value of a key that is read by hand; null where it is missing.
  const toml::node* find(const char* key);
  /// A value that does not fit: "KEY must be WANTED".
  [[noreturn]] void refuse(const char* key, const toml::node& node, const std::string& wanted) const;
  /// Where the key stands, or the table if it does not.
  [[noreturn]] void refuseAt(const char* key, const std::string& what) const;
  void finish() const;
  const std::string& file() const { return file_; }

 private:
  std::optional<double> number(const char* key, double low, double high);

  const toml::table* table_;
  std::string name_, file_;
  std::vector<std::string_view> asked_;
};

}  // namespace cloudbake
