// Checks that a text is safe to parse with toml++.
#pragma once

#include <string>
#include <string_view>

namespace cloudbake {

/// Throws InputError with `file` and line if a text contains something that toml++ 3.3 does not handle safely: a key of more than 8 parts
/// (toml++ uses a stack frame for each), or a letter outside ASCII where a key or value begins (undefined behaviour; TOML forbids it).
void checkTomlText(std::string_view text, const std::string& file);

}  // namespace cloudbake
