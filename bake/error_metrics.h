// How far a bake is from the truth, in the figures of docs/lobe_math.md.
#pragma once

#include <span>

#include "bake/reference.h"
#include "core/types.h"

namespace cloudbake {

struct LobeError {
  // Angle between estimated and true direction, degrees, over vertices whose true concentration is ≥ 0.1.
  double angle_rms_degrees = 0, angle_median_degrees = 0, angle_p95_degrees = 0, angle_max_degrees = 0;
  uint64_t vertices = 0, left_out = 0;  ///< all, and those under 0.1
  // Density along the mean over the same vertices, as a fraction of their mean true density.
  double density_rms = 0, density_bias = 0;
};
LobeError compareLobes(std::span<const Lobe> estimate, const Truth& truth);

struct TransmittanceError {
  double rms = 0, bias = 0;  ///< of T, over all vertices and directions
};
/// exp(−σℓ) of estimated lengths against true ones (#V × #directions each).
TransmittanceError compareLengths(std::span<const float> estimate, std::span<const float> truth, double extinction);
/// The lobe formula against exp(−σℓ) of true lengths. `weights`: how much each direction counts; empty: all the same.
TransmittanceError compareTransmittance(std::span<const Lobe> lobes, LobeShape shape, std::span<const Vec3> directions,
                                        std::span<const float> true_lengths, double extinction, std::span<const float> weights = {});

/// T of one set of lobes against that of another, over the directions: what an error of the bake does to the picture.
TransmittanceError compareLobeTransmittance(std::span<const Lobe> estimate, std::span<const Lobe> truth, LobeShape shape,
                                            std::span<const Vec3> directions, double extinction);

}  // namespace cloudbake
