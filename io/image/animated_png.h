// Makes animated PNGs (Mozilla's APNG), which browsers play, with the program apngasm.
#pragma once

#include <span>
#include <string>

namespace cloudbake {

/// Whether apngasm is installed (found in PATH).
bool hasAnimationEncoder();

/// The bytes of an animated PNG that loops forever. `frames` are at least two PNGs of the same size. A frame that equals the previous one
/// makes that one longer. Throws IoError if apngasm cannot be run or fails.
std::string encodeAnimation(std::span<const std::string> frames, double frames_per_second);

}  // namespace cloudbake
