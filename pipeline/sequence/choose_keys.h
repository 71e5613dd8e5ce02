// Which frames of a segment are needed, so that what is blended between them looks like the others.
#pragma once

#include <vector>

#include "core/sequence.h"

namespace cloudbake {

/// A frame between two keys beside what is blended there.
struct BlendFigures {
  double change = 0;             ///< of the picture: rms of the 8-bit values where it shows a cloud
  double transmittance_rms = 0;  ///< of T, over vertices and lights from everywhere
};

/// The keys of a segment, as indices of its frames: the first and the last one, and as few others as are needed so that no picture of a
/// frame changes by more than `most_change`, where the longest side covers `pixels` pixels; all of them if that is 0. `figures` gets those
/// of all frames.
std::vector<size_t> chooseKeys(const CloudSequence& sequence, const SequenceSegment& all, int pixels, double most_change,
                               std::vector<BlendFigures>& figures);

}  // namespace cloudbake
