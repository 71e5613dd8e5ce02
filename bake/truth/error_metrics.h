// Computes how far a bake is from the truth, as the figures of docs/lobe_math.md.
#pragma once

#include <span>

#include "bake/truth/reference.h"
#include "core/figures.h"
#include "core/surface_points.h"
#include "core/types.h"

namespace cloudbake {

LobeError compareLobes(std::span<const Lobe> estimate, const Truth& truth);

/// Compares exp(−σℓ) of estimated and true lengths (#V × #directions each).
TransmittanceError compareLengths(std::span<const float> estimate, std::span<const float> truth, double extinction);
/// Compares the lobe formula with exp(−σℓ) of true lengths. `weights` says how much each direction counts; empty = all equal.
TransmittanceError compareTransmittance(std::span<const Lobe> lobes, LobeShape shape, std::span<const Vec3> directions,
                                        std::span<const float> true_lengths, double extinction, std::span<const float> weights = {});

/// The same with any light, #V × #directions, in place of exp(−σℓ).
TransmittanceError compareLight(std::span<const Lobe> lobes, LobeShape shape, std::span<const Vec3> directions,
                                std::span<const float> true_light, double extinction, std::span<const float> weights = {});

/// Compares the lobes as engines blend them at points of the surface with any light, #points × #directions. `weights` as above.
SurfaceLightError compareOverSurface(std::span<const SurfacePoint> points, std::span<const Lobe> lobes, LobeShape shape,
                                     std::span<const Vec3> directions, std::span<const float> true_light, double extinction,
                                     std::span<const float> weights = {});

/// Compares T of one set of lobes with T of another, over the directions. This shows the effect of bake errors on the picture.
TransmittanceError compareLobeTransmittance(std::span<const Lobe> estimate, std::span<const Lobe> truth, LobeShape shape,
                                            std::span<const Vec3> directions, double extinction);

}  // namespace cloudbake
