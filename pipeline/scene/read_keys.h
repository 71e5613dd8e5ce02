// Reads keys of settings from a table of a scene file.
#pragma once

#include <optional>
#include <variant>

#include "core/keys.h"

namespace cloudbake {

class TomlReader;  // core/text/toml.h

/// The value that a key sets.
using KeyValue = std::variant<float*, double*, int*, uint32_t*, uint64_t*, bool*, Vec2*, Vec3*, std::optional<float>*,
                              std::optional<double>*, std::optional<Vec3>*>;

/// Reads a key into a value if the table has it. Throws InputError with file, line and column.
void readKey(TomlReader& table, const char* name, double low, double high, bool takes_one, const KeyValue& value);

/// Reads those of the keys that the table has.
template <typename Settings>
void readKeys(TomlReader& table, const Keys<Settings>& keys, Settings& settings) {
  visitValues(keys, settings, [&](const Key<Settings>& key, auto& value) {
    if (key.use != KeyUse::kComputed) readKey(table, key.name, key.low, key.high, key.takes_one, &value);
  });
}

}  // namespace cloudbake
