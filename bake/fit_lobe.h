// The fitted lobe: the four floats whose formula comes nearest to the true transmittance, for the lights and extinctions that count.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// What is known of one vertex: the inside length ℓ along N directions.
struct FitSamples {
  std::span<const Vec3> directions;  ///< N unit vectors to the light
  std::span<const float> lengths;    ///< N, world units, ≥ 0
  std::span<const float> weights;    ///< N, ≥ 0, any scale; or empty: every direction counts the same
};

struct FitSettings {
  LobeShape shape{4, 0};           ///< k ≥ 0 and b (world units), the same for all vertices
  std::vector<float> extinctions;  ///< σ per world unit, > 0, one or more: the fit serves all of them (extinctionSteps)
  int iterations = 12;             ///< Levenberg–Marquardt steps per start, ≥ 0
  int extra = 0;
  float tolerance=1e-3F;
};

double lobeError(const Lobe& lobe, const FitSamples& samples, const FitSettings& settings);
Lobe fitLobe(const Lobe& start, const FitSamples& samples, const FitSettings& settings);
std::vector<Lobe> fitLobes(std::span<const Lobe> starts, std::span<const Vec3> directions, std::span<const float> lengths,
                           std::span<const float> weights, const FitSettings& settings);
}  // namespace cloudbake
