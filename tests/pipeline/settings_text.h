// Settings as text, field by field: two runs are asked for the same where the texts are equal. Every field counts, also one that is new.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <tuple>
#include <type_traits>

namespace cloudbake {

/// Converts to a field of any type.
struct AnyField {
  template <class Field>
  operator Field() const;
};

/// How many fields a struct has: the most values that it can be made from.
template <class Struct, class... Fields>
constexpr size_t fieldCount() {
  if constexpr (requires { Struct{Fields()..., AnyField()}; })
    return fieldCount<Struct, Fields..., AnyField>();
  else
    return sizeof...(Fields);
}

template <class Struct>
auto fieldsOf(const Struct& s) {
  constexpr size_t kCount = fieldCount<Struct>();
  // clang-format off
#define FIELDS(count, ...) \
  if constexpr (kCount == count) { const auto& [__VA_ARGS__] = s; return std::tie(__VA_ARGS__); } else
  FIELDS(2, a, b)
  FIELDS(3, a, b, c)
  FIELDS(4, a, b, c, d)
  FIELDS(5, a, b, c, d, e)
  FIELDS(6, a, b, c, d, e, f)
  FIELDS(7, a, b, c, d, e, f, g)
  FIELDS(8, a, b, c, d, e, f, g, h)
  FIELDS(9, a, b, c, d, e, f, g, h, i)
  FIELDS(10, a, b, c, d, e, f, g, h, i, j)
  FIELDS(11, a, b, c, d, e, f, g, h, i, j, k)
  FIELDS(12, a, b, c, d, e, f, g, h, i, j, k, l)
  FIELDS(13, a, b, c, d, e, f, g, h, i, j, k, l, m)
  FIELDS(14, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
  FIELDS(15, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
  FIELDS(16, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
  FIELDS(17, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q)
  FIELDS(18, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r)
  FIELDS(19, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t)
  FIELDS(20, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u)
  FIELDS(21, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v)
  FIELDS(22, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w)
  FIELDS(23, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x)
  FIELDS(24, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y)
  FIELDS(25, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z)
#undef FIELDS
  static_assert(kCount == 0, "fieldsOf needs a line for a struct with as many fields");
  // clang-format on
}

// One function, so that types of the standard library find it whatever holds them.
template <class Value>
std::string textOf(const Value& value) {
  if constexpr (requires { value.has_value(); }) {
    return value ? textOf(*value) : "-";
  } else if constexpr (requires { value.second; }) {
    return textOf(value.first) + "=" + textOf(value.second);
  } else if constexpr (
      requires { value.begin(); } && !requires { value.c_str(); }) {
    std::string text = "[";
    for (const auto& one : value) text += " " + textOf(one);
    return text + " ]";
  } else if constexpr (requires { std::filesystem::path(value); }) {
    return "'" + std::filesystem::path(value).string() + "'";
  } else if constexpr (std::is_enum_v<Value>) {
    return std::to_string(int(value));
  } else if constexpr (std::is_arithmetic_v<Value>) {
    return fmt::format("{}", value);
  } else if constexpr (requires { value.target_type(); }) {
    return "";  // a function, which no option sets
  } else {
    return "{" + std::apply([](const auto&... fields) { return ((" " + textOf(fields)) + ...); }, fieldsOf(value)) + " }";
  }
}

}  // namespace cloudbake
