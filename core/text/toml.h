// Reads TOML tables key by key. toml++ keeps the place of every node, so errors name file, line and column.
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

/// Throws InputError for a place in a file.
[[noreturn]] void refuseToml(const std::string& file, const toml::source_region& place, const std::string& what);

/// Parses a text. Throws InputError if it is larger than 16 MiB or not valid TOML. check_toml.h first rejects texts that toml++ 3.3 does
/// not handle safely.
toml::table parseTomlTable(const std::string& text, const std::string& file);

/// Keys and values of a table in the order of the file. (toml++ sorts them by name.)
std::vector<std::pair<const toml::key*, const toml::node*>> inOrder(const toml::table& table);

/// A value as it would be written on the command line: a text, a finite number, true or false, or a list of them joined by commas. Throws
/// InputError for anything else.
std::string optionText(const toml::node& node, const std::string& file);

/// A list of `count` finite numbers. Calls `refuse`, which must throw, for anything else.
std::vector<double> finiteNumbers(const toml::node& node, size_t count, const std::function<void(const toml::node&)>& refuse);

/// Reads the keys of one table. A present key must have the right type and range. A missing key leaves the value unchanged. Call finish()
/// last: it rejects keys that nothing has read. All functions throw InputError.
class TomlReader {
 public:
  /// `name` is the table's name for messages, e.g. "[sky]". A null table has no keys. The table must outlive the reader.
  TomlReader(const toml::table* table, std::string name, std::string file)
      : table_(table), name_(std::move(name)), file_(std::move(file)) {}

  bool has(const char* key) const { return table_ && table_->contains(key); }
  /// A finite number in low … high. Either bound may be infinite.
  void read(const char* key, double low, double high, double& value);
  void read(const char* key, double low, double high, float& value);
  void read(const char* key, double low, double high, std::optional<float>& value);
  /// A finite number above 0.
  void readPositive(const char* key, double& value);
  /// A whole number in low … high.
  void read(const char* key, int64_t low, int64_t high, int64_t& value);
  template <std::integral Integer>
  void read(const char* key, int64_t low, int64_t high, Integer& value) {
    auto wide = int64_t(value);
    read(key, low, high, wide);
    value = Integer(wide);
  }
  void read(const char* key, bool& value);
  void read(const char* key, std::string& value);
  /// Two numbers.
  void read(const char* key, double low, double high, Vec2& value);
  /// Three numbers. With `or_one`, a single number for all three is also accepted.
  void read(const char* key, double low, double high, Vec3& value, bool or_one = false);
  /// A list of `count` finite numbers, which `wanted` describes in the error message; nothing if the key is missing.
  std::optional<std::vector<double>> numbers(const char* key, size_t count, const char* wanted);
  /// Whether the key is present and is 'none'.
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
  /// A reader of a table inside this one. A missing table is read as one without keys.
  TomlReader table(const char* key);
  /// The tables of a [[key]], in the order of the file.
  std::vector<TomlReader> tables(const char* key);
  /// The value of a key that the caller reads by hand; null if the key is missing.
  const toml::node* find(const char* key);
  /// Throws for a value that does not fit: "KEY must be WANTED".
  [[noreturn]] void refuse(const char* key, const toml::node& node, const std::string& wanted) const;
  /// The place of the key, or of the table if the key is missing.
  [[noreturn]] void refuseAt(const char* key, const std::string& what) const;
  void finish() const;
  const std::string& file() const { return file_; }

 private:
  std::optional<double> number(const char* key, double low, double high);
  template <size_t count>
  std::array<float, count> coordinates(const char* key, const toml::node& node, double low, double high, const std::string& wanted) const;

  const toml::table* table_;
  std::string name_, file_;
  std::vector<std::string_view> asked_;
};

}  // namespace cloudbake
