// The fuzz target of the L-systems: what a driver calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// Grows a cloud from any bytes. Byte 0: the low two bits 0 = the rest is text as a file holds it, else bytes that steer
/// tests/fuzz/recipe_maker. Byte 1: 0 = the default limits, else small ones. Byte 2: of a text, whether TOML or a list of rules.
/// InputErrors are a fine outcome; other exceptions pass. Aborts with a message where a cloud breaks its promises.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace cloudbake {

/// The same; true where a cloud grew, false for an InputError, whose text goes to `message`.
bool growFuzzInput(const uint8_t* data, size_t size, std::string& message);
/// Premise, rules and main settings that an input stands for, for people.
std::string describeFuzzInput(const uint8_t* data, size_t size);

constexpr size_t kFuzzHeader = 3;
constexpr bool fuzzesText(const uint8_t* data, size_t size) { return size > 0 && data[0] % 4 == 0; }
constexpr bool fuzzesDefaultLimits(const uint8_t* data, size_t size) { return size > 1 && data[1] == 0; }

}  // namespace cloudbake
