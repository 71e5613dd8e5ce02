// Text that toml++ can be given.
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

/// Throws InputError with the line where a text holds what toml++ 3.3 cannot be trusted with: a key of more than 8 parts (it takes a stack
/// frame for each), or letters outside ASCII where a key or value begins (undefined there; TOML forbids them). `file` is named.
void checkTomlText(std::string_view text, const std::string& file);

}  // namespace cloudbake
