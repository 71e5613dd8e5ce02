// TOML by toml++, which keeps the place of every node: tables read key by key, with what is wrong told by file, line and column.
#pragma once

#include <toml++/toml.h>

#include <array>
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

/// Throws InputError where the text is larger than 16 MiB or no TOML.
toml::table parseTomlTable(const std::string& text, const std::string& file);

/// Keys and values of a table in the order of the file: toml++ sorts them by name.
std::vector<std::pair<const toml::key*, const toml::node*>> inOrder(const toml::table& table);

/// Reads the keys of one table. What is there must be of the right kind and range; what is not there keeps its value. Every reader ends in
/// finish(), which refuses keys that nothing has asked for. All throw InputError.
class TomlReader {
 public:
  /// `name` of the table for messages, "[sky]"; a null table has no keys. The table must outlive the reader.
  TomlReader(const toml::table* table, std::string name, std::string file)
      : table_(table), name_(std::move(name)), file_(std::move(file)) {}

  bool has(const char* key) const { return table_ && table_->contains(key); }
  /// Finite, low … high.
  void read(const char* key, double low, double high, double& value);
  void read(const char* key, double low, double high, float& value);
  void read(const char* key, double low, double high, std::optional<float>& value);
  void read(const char* key, int low, int high, int& value);
  void read(const char* key, bool& value);
  void read(const char* key, std::string& value);
  /// Three numbers; with `or_one`, one for all three too.
  void read(const char* key, double low, double high, Vec3& value, bool or_one = false);
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
  /// Where the key stands, or the table if it does not.
  [[noreturn]] void refuseAt(const char* key, const std::string& what) const;
  void finish() const;

 private:
  const toml::node* find(const char* key);
  std::optional<double> number(const char* key, double low, double high);
  [[noreturn]] void refuse(const char* key, const toml::node& node, const std::string& wanted) const;

  const toml::table* table_;
  std::string name_, file_;
  std::vector<std::string_view> asked_;
};

}  // namespace cloudbake
