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

}  // namespace cloudbake
