// The fitted lobe: the four floats whose formula (core/lobe_lighting.h) comes nearest to the true transmittance.
// Free of scale: doubling a shape and halving σ doubles d and changes no direction, bit for bit.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// What is known of one vertex: the inside length ℓ along N directions. Of #V vertices: their rows of lengths, one after the other.
struct FitSamples {
  std::span<const Vec3> directions;  ///< N unit vectors to the light; about 100 over the sphere are enough
  std::span<const float> lengths;    ///< #V × N, world units, ≥ 0
  std::span<const float> weights;    ///< N, ≥ 0, of any scale: how much a direction counts; empty: all the same
};

struct FitSettings {
  LobeShape shape{4, 0};           ///< k ≥ 0 and b (world units), the same for all vertices
  std::vector<float> extinctions;  ///< σ per world unit, > 0, one or more (extinctionSteps): the fit serves them all
  int iterations = 20;             ///< at most so many steps per vertex, ≥ 0; five are usual
};

/// The figure that is minimised: mean of (T_lobe − exp(−σℓ))² over all σ and, by weight, all directions. 0 where no weight is > 0.
double lobeError(const Lobe& lobe, const FitSamples& samples, const FitSettings& settings);

/// Per vertex the lobe of least error near its start, which has a unit direction and a finite thickness ≥ 0 (the mean lobe); so has the
/// result. Never worse than the start with the same k and b: where nothing better is found, the start is returned as it is. From #V starts
/// and rows of lengths; the same bytes for any number of threads.
std::vector<Lobe> fitLobes(std::span<const Lobe> starts, const FitSamples& samples, const FitSettings& settings);

/// What fitShape may choose.
struct ShapeSearch {
  bool exponent = true;   ///< k: from that of the settings in steps of 1 … 1/8, within 0.5 … 12
  bool bias = false;      ///< b: likewise in steps of 0.08 … 0.01 optical depths, within ±0.4 (of √(first σ · last σ))
  size_t vertices = 256;  ///< how many judge, evenly spread over #V, ≥ 1; the search costs 10 to 100 fits of so many
};

/// One k, one b or both for the whole asset: the shape near `settings.shape` whose fitted lobes have the least mean error.
/// What is not searched stays as in `settings.shape`. Arguments as of fitLobes.
LobeShape fitShape(std::span<const Lobe> starts, const FitSamples& samples, const FitSettings& settings, const ShapeSearch& search);

/// The σ that a fit over a range sums over: from `low` to `high` (0 < low ≤ high) in equal factors of at most 2; one where they are equal.
std::vector<float> extinctionSteps(float low, float high);

}  // namespace cloudbake
