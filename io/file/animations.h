// The choice of an animation of a sculpt's file, whatever its format.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace cloudbake {

/// The number of the animation of that name; of the first one if no name is wanted. Throws InputError if there is none, with the names of
/// those that there are.
size_t chosenAnimation(const std::filesystem::path& file, std::span<const std::string> names, const std::string& wanted);

/// Throws InputError for an animation that moves nothing.
[[noreturn]] void refuseStillAnimation(const std::filesystem::path& file, std::span<const std::string> names, size_t chosen);

}  // namespace cloudbake
