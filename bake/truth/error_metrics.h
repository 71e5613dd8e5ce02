// How far a bake is from the truth, in the figures of docs/lobe_math.md.
#pragma once

#include <span>

#include "bake/truth/reference.h"
#include "core/figures.h"
#include "core/types.h"

namespace cloudbake {

LobeError compareLobes(std::span<const Lobe> estimate, const Truth& truth);

/// exp(−σℓ) of estimated lengths against true ones (#V × #directions each).
TransmittanceError compareLengths(std::span<const float> estimate, std::span<const float> truth, double extinction);
/// The lobe formula against exp(−σℓ) of true lengths. `weights`: how much each direction counts; empty: all the same.
TransmittanceError compareTransmittance(std::span<const Lobe> lobes, LobeShape shape, std::span<const Vec3> directions,
                                        std::span<const float> true_lengths, double extinction, std::span<const float> weights = {});

/// T of one set of lobes against that of another, over the directions: what an error of the bake does to the picture.
TransmittanceError compareLobeTransmittance(std::span<const Lobe> estimate, std::span<const Lobe> truth, LobeShape shape,
                                            std::span<const Vec3> directions, double extinction);

}  // namespace cloudbake
