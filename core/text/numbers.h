// Converts numbers to text that reads back as the same number.
#pragma once

#include <charconv>
#include <string>

namespace cloudbake {

/// The shortest decimal text of a float, a double or an integer that std::from_chars reads back as the same value, e.g. "0.1".
template <typename Number>
std::string shortestText(Number value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace cloudbake
