// Random L-systems from random bytes: every byte string is a recipe, most of them with grammars that parse and grow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "lsystem/recipe.h"

namespace cloudbake {

/// Bytes that steer choices, one after the other; zeros when they are used up, so that every choice 0 must end something.
struct Choices {
  const uint8_t* data = nullptr;
  size_t size = 0, used = 0;

  uint8_t byte() { return used < size ? data[used++] : 0; }
  /// 0 … count - 1, count <= 256.
  size_t below(size_t count) { return byte() % count; }
  bool oneIn(size_t count) { return byte() % count == 1 % count; }
};

/// A grammar with settings from all their ranges and beyond them; limits stay as they are.
CloudRecipe makeRecipe(Choices& choices);
/// Flips, repeats, drops and inserts a few characters.
void mutateText(std::string& text, Choices& choices);

}  // namespace cloudbake
