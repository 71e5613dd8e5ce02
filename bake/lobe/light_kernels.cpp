// Google Highway compiles this file once per target and picks one at run time. Multiplication and addition stay separate (no FMA).
#include "bake/lobe/light_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bake/lobe/light_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "bake/lobe/exp_log-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

constexpr size_t kRow = 8;  // samples of a row; a target's vector holds all of them or a part

void SumLight(const LightTerms& terms, const LitSamples& samples, std::span<const std::vector<float>> weights, float* scratch,
              float* sums) {
  const Wide d;
  const hn::RebindToSigned<Wide> integers;
  const size_t octaves = terms.octave_weights.size(), sigmas = weights.size(), lanes = hn::Lanes(d);
  float *totals = scratch, *exponentials = scratch + kRow * sigmas;
  std::fill(totals, totals + kRow * sigmas, 0.0F);
  for (size_t n = 0; n < samples.count; n += lanes) {
    const V length = hn::LoadU(d, samples.lengths + n);
    V last = length;
    for (size_t k = 0; k < terms.exponentials.size(); ++k) {
      const auto& [exponent, is_square] = terms.exponentials[k];
      last = is_square ? hn::Mul(last, last) : ExpMinus(hn::Max(hn::Mul(hn::Set(d, exponent), length), hn::Zero(d)));
      hn::StoreU(last, d, exponentials + k * kRow);
    }
    for (size_t s = 0; s < sigmas; ++s) {
      const auto exponential = [&](size_t i) HWY_ATTR { return hn::LoadU(d, exponentials + terms.used[s * octaves + i] * kRow); };
      V light = exponential(0);
      if (octaves > 1 || samples.phases) {
        light = hn::Zero(d);
        for (size_t i = 0; i < octaves; ++i) {
          V weight = hn::Set(d, terms.octave_weights[i]);
          if (samples.phases)
            weight = hn::Mul(weight, hn::GatherIndex(d, samples.phases + i * samples.phase_stride, hn::LoadU(integers, samples.views + n)));
          light = hn::Add(light, hn::Mul(weight, exponential(i)));
        }
      }
      float* total = totals + s * kRow + n % kRow;
      hn::StoreU(hn::Add(hn::LoadU(d, total), hn::Mul(light, hn::LoadU(d, weights[s].data() + n))), d, total);
    }
  }
  for (size_t s = 0; s < sigmas; ++s) {
    sums[s] = 0;
    for (size_t lane = 0; lane < kRow; ++lane) sums[s] += totals[s * kRow + lane];
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(SumLight);

void sumLight(const LightTerms& terms, const LitSamples& samples, std::span<const std::vector<float>> weights, float* scratch,
              float* sums) {
  HWY_DYNAMIC_DISPATCH(SumLight)(terms, samples, weights, scratch, sums);
}

}  // namespace cloudbake
#endif
