// The fitted lobe: the four floats for which the lobe formula (core/lobe_lighting.h) comes nearest to the true transmittance.
// The fit is independent of scale: doubling a shape and halving σ doubles d and changes no direction, bit for bit.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// The samples of one vertex towards N directions: inside lengths ℓ, or the light that T is fitted to. For #V vertices, their rows follow
/// one after the other.
struct FitSamples {
  std::span<const Vec3> directions;     ///< N unit vectors towards the light; about 100 over the sphere are enough
  std::span<const float> lengths;       ///< #V × N, world units, ≥ 0; is not read if there are targets
  std::span<const float> weights;       ///< N values ≥ 0 of any scale: how much each direction counts; empty = all equal
  std::span<const float> targets = {};  ///< #V × #σ × N values that T is fitted to; empty = exp(−σℓ)
};

struct FitSettings {
  LobeShape shape{4, 0};           ///< k ≥ 0 and b (world units), shared by all vertices
  std::vector<float> extinctions;  ///< one or more σ per world unit, > 0 (extinctionSteps); the lobe is fitted to all of them
  int iterations = 20;             ///< maximum number of steps per vertex, ≥ 0; five are usual
};

/// The error that is minimised: the mean of (T_lobe − exp(−σℓ))² over all σ and, by weight, all directions. 0 if no weight is > 0.
double lobeError(const Lobe& lobe, const FitSamples& samples, const FitSettings& settings);

/// Per vertex the lobe of least error near its start, which is usually the mean lobe; from #V starts and rows of lengths. Starts and
/// results have a unit direction and a finite thickness ≥ 0. A result is never worse than its start with the same k and b: if nothing
/// better is found, the start is returned unchanged. The bytes are the same for any number of threads.
std::vector<Lobe> fitLobes(std::span<const Lobe> starts, const FitSamples& samples, const FitSettings& settings);

/// The constants that fitShape may choose.
struct ShapeSearch {
  bool exponent = true;  ///< searches k, from that of the settings in steps of first_step … 1/8, within 0.5 … 12
  bool bias = false;  ///< searches b likewise in steps of 0.08 first_step … 0.01 optical depths, within ±1 (at √(first σ · last σ))
  float first_step = 1;   ///< of both, a power of two
  size_t vertices = 256;  ///< number of vertices used, spread evenly over #V, ≥ 1; the search costs 10 to 100 fits of them
};

/// Finds k, b or both for the whole asset: the shape near `settings.shape` whose fitted lobes have the least mean error.
/// A parameter that is not searched stays as in `settings.shape`. The other arguments are as for fitLobes.
LobeShape fitShape(std::span<const Lobe> starts, const FitSamples& samples, const FitSettings& settings, const ShapeSearch& search);

/// The σ values that a fit over a range uses: from `low` to `high` (0 < low ≤ high) in equal factors of at most 2. One value if low = high.
std::vector<float> extinctionSteps(float low, float high);

}  // namespace cloudbake
