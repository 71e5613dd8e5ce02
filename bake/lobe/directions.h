// Sets of N directions, each of which represents a solid angle of 4π/N.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Fills `out` with N = out.size() ≥ 1 directions, one at a random place in each of N strata of equal solid angle. The sphere is divided
/// into about √N bands of z, and each band into cells of azimuth (N = 100: 10 × 10). Integrals of 1 and ω are exact in expectation.
void stratifiedDirections(uint64_t stream, std::span<Vec3> out);

/// Independent uniform directions, as in the published method.
void uniformDirections(uint64_t stream, std::span<Vec3> out);

/// The fixed spherical Fibonacci set of N directions: z = 1 − (2j+1)/N, azimuth = 2πj/golden ratio.
std::vector<Vec3> fibonacciDirections(int count);

/// The same set, turned by a uniform random rotation from the stream.
void rotatedDirections(std::span<const Vec3> fixed, uint64_t stream, std::span<Vec3> out);

/// N = settings.rays directions by the settings' sampler. `fibonacci` = fibonacciDirections(N); only that sampler reads it.
void sampleDirections(const BakeSettings& settings, std::span<const Vec3> fibonacci, uint64_t stream, std::span<Vec3> out);

/// The indices of the directions in an order in which neighbours point the same way: along a Z-order curve on each face of a cube.
std::vector<size_t> coherentOrder(std::span<const Vec3> directions);

/// The bound for undefined directions: below this concentration κ an estimator with N directions sees only its own noise.
double concentrationNoise(Sampler sampler, int count);

/// The direction for a point whose mean direction is undefined: −normal, or −Y if the point has no normal or a zero normal.
Vec3 undefinedDirection(const BakePoints& points, size_t point);
/// Adds `count` such points to the warnings.
void warnUndefined(uint64_t count, Warnings& warnings);

std::string_view samplerName(Sampler sampler);
std::string_view quadratureName(Quadrature quadrature);

}  // namespace cloudbake
