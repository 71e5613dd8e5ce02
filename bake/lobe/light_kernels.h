// The inner loop of the volume's target, with the SIMD instructions of the CPU: S(σℓ) of samples, summed with weights. All targets sum the
// same eight lanes, so they give the same bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace cloudbake {

/// S(σℓ) for all σ as sums of exponentials exp(−eℓ).
struct LightTerms {
  struct Exponential {
    float exponent;  ///< e
    bool is_square;  ///< e is twice the one before
  };
  std::vector<Exponential> exponentials;  ///< e rises
  std::vector<uint32_t> used;             ///< #σ × #octaves: an exponential
  std::vector<float> octave_weights;      ///< their sum is 1
};

/// Samples with one light. `count` is a multiple of 8.
struct LitSamples {
  const float* lengths = nullptr;  ///< ℓ
  const int32_t* views = nullptr;
  size_t count = 0;
  const float* phases = nullptr;  ///< p of octave i and view v at phases[i · phase_stride + v]; null if it is 1
  size_t phase_stride = 0;
};

/// Σ weights[s][n] S(σ_s ℓ_n) for every σ: #σ sums. `scratch` has room for 8 (#exponentials + #σ) floats.
void sumLight(const LightTerms& terms, const LitSamples& samples, std::span<const std::vector<float>> weights, float* scratch, float* sums);

/// A lattice of lengths: the ℓ of all lights, `stride` floats, then those of the next place. Rows and planes are so many floats apart.
struct LatticeLengths {
  const float* values = nullptr;
  size_t stride = 0, row = 0, plane = 0;
};

/// A place of the lattice, trilinear between eight others.
struct LatticeSample {
  uint32_t low = 0;  ///< of the lowest of them, floats
  uint32_t view = 0;
  float x = 0, y = 0, z = 0;  ///< 0 … 1
};

/// Adds Σ weights[n][s] S(σ_s ℓ_n) towards every light to `sums`: #σ × stride. `stride` is a multiple of 8, `weights` is #samples × #σ,
/// `phases` #octaves × #views × stride, or empty if p is 1. `scratch` has room for 8 #exponentials floats.
void addLatticeLight(const LightTerms& terms, const LatticeLengths& lattice, std::span<const LatticeSample> samples,
                     std::span<const float> weights, std::span<const float> phases, float* scratch, std::span<float> sums);

}  // namespace cloudbake
