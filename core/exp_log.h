// exp and log of floats for inner loops. They use plain arithmetic without calls, branches or tables, so that a loop over an array
// vectorises (SSE2 suffices) and every CPU gives the same bits. The polynomials are from Cephes (S. Moshier, expf.c and logf.c).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace cloudbake {

/// The polynomials of both, highest power first.
inline constexpr float kExpTerms[] = {1.9875691500e-4F, 1.3981999507e-3F, 8.3334519073e-3F,
                                      4.1665795894e-2F, 1.6666665459e-1F, 5.0000001201e-1F};
inline constexpr float kLogTerms[] = {7.0376836292e-2F,  -1.1514610310e-1F, 1.1676998740e-1F,  -1.2420140846e-1F, 1.4249322787e-1F,
                                      -1.6668057665e-1F, 2.0000714765e-1F,  -2.4999993993e-1F, 3.3333331174e-1F};

inline int32_t bitsOf(float x) { return std::bit_cast<int32_t>(x); }

/// max(x, low) and min(x, high) for bounds ≥ 0. They compare the bits as integers, which gives the right order if one of the floats is ≥ 0.
/// A comparison of floats would become a branch here.
inline float atLeast(float x, float low) { return std::bit_cast<float>(std::max(bitsOf(x), bitsOf(low))); }
inline float atMost(float x, float high) { return std::bit_cast<float>(std::min(bitsOf(x), bitsOf(high))); }

/// exp(−x) for x ≥ −87, with a relative error under 2⁻²². Larger x than 87 give exp(−87) = 1.6e-38. x = r + n ln 2, |r| ≤ ln(2)/2.
inline float expMinus(float x) {
  const float y = -atMost(x, 87), shifted = y * 1.44269504F + 0x1.8p23F, n = shifted - 0x1.8p23F;  // rounds n to an integer
  const float r = (y - n * 0.693359375F) + n * 2.12194440e-4F;
  const float* c = kExpTerms;
  const float p = ((((c[0] * r + c[1]) * r + c[2]) * r + c[3]) * r + c[4]) * r + c[5];
  return (p * r * r + r + 1) * std::bit_cast<float>((std::bit_cast<uint32_t>(shifted) << 23) + 0x3F800000U);
}

/// −log x for a normal x > 0, with an error under 2⁻²² of max(|log x|, |x − 1|). x = (1 + r) 2ⁿ, 1 + r in [√½, √2).
inline float minusLog(float x) {
  const int32_t n = (bitsOf(x) - 0x3F3504F3) >> 23;
  const float r = std::bit_cast<float>(bitsOf(x) - (n << 23)) - 1;
  const float* c = kLogTerms;
  const float p = (((((((c[0] * r + c[1]) * r + c[2]) * r + c[3]) * r + c[4]) * r + c[5]) * r + c[6]) * r + c[7]) * r + c[8];
  return -((r * r * (r * p - 0.5F) + r) + float(n) * 0.69314718F);
}

}  // namespace cloudbake
