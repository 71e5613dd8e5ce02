// Animated PNGs (Mozilla's APNG), which browsers play, put together by apngasm.
#pragma once

#include <span>
#include <string>

namespace cloudbake {

/// Whether apngasm is installed: found in PATH.
bool hasAnimationEncoder();

/// The bytes of an animated PNG that loops for ever. `frames` are at least two PNGs of one size. Frames that equal the one before become a
/// longer one. Throws IoError where apngasm cannot be run or fails.
std::string encodeAnimation(std::span<const std::string> frames, double frames_per_second);

}  // namespace cloudbake
