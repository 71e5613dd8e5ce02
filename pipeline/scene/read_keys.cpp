#include "pipeline/scene/read_keys.h"

#include <type_traits>

#include "core/text/toml.h"

namespace cloudbake {

void readKey(TomlReader& table, const char* name, double low, double high, bool takes_one, const KeyValue& value) {
  const auto read = [&](auto* given) {
    using Value = std::remove_pointer_t<decltype(given)>;
    if constexpr (kIsOptional<Value>) {
      typename Value::value_type number = given->value_or(typename Value::value_type{});
      readKey(table, name, low, high, takes_one, &number);
      if (table.has(name)) *given = number;
    } else if constexpr (std::is_same_v<Value, bool>)
      table.read(name, *given);
    else if constexpr (std::is_same_v<Value, Vec3>)
      table.read(name, low, high, *given, takes_one);
    else if constexpr (std::is_integral_v<Value>)
      table.read(name, int64_t(low), int64_t(high), *given);
    else
      table.read(name, low, high, *given);
  };
  std::visit(read, value);
}

}  // namespace cloudbake
