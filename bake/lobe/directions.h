// Sets of N directions, each standing for a solid angle of 4π/N.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Fills `out` with N = out.size() directions, one in each of N strata of equal solid angle, placed at random inside it: the sphere is
/// cut into about √N bands of z, a band into cells of azimuth (N = 100: 10 × 10). Any N ≥ 1; integrates 1 and ω exactly in expectation.
void stratifiedDirections(uint64_t stream, std::span<Vec3> out);

/// Independent uniform draws, as published.
void uniformDirections(uint64_t stream, std::span<Vec3> out);

/// The fixed spherical Fibonacci set of N directions: z = 1 − (2j+1)/N, azimuth = 2πj/golden ratio.
std::vector<Vec3> fibonacciDirections(int count);

/// The same set turned by a rotation drawn uniformly from the stream.
void rotatedDirections(std::span<const Vec3> fixed, uint64_t stream, std::span<Vec3> out);

/// N = settings.rays directions by the settings' sampler. `fibonacci` = fibonacciDirections(N), read by that sampler only.
void sampleDirections(const BakeSettings& settings, std::span<const Vec3> fibonacci, uint64_t stream, std::span<Vec3> out);

/// Undefined-direction bound: below this concentration κ an estimator with N directions sees only its own noise.
double concentrationNoise(Sampler sampler, int count);

std::string_view samplerName(Sampler sampler);
std::string_view quadratureName(Quadrature quadrature);

}  // namespace cloudbake
