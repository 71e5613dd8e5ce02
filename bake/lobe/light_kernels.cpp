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

// The exponentials of a vector of lengths, as rows of kRow.
HWY_INLINE void exponentialRows(const LightTerms& terms, V length, float* rows) {
  const Wide d;
  V last = length;
  for (size_t k = 0; k < terms.exponentials.size(); ++k) {
    const auto& [exponent, is_square] = terms.exponentials[k];
    last = is_square ? hn::Mul(last, last) : ExpMinus(hn::Max(hn::Mul(hn::Set(d, exponent), length), hn::Zero(d)));
    hn::StoreU(last, d, rows + k * kRow);
  }
}

// S at σ number s, from those rows. phase(i) is p of octave i.
template <class Phase>
HWY_INLINE V lightOf(const LightTerms& terms, const float* rows, size_t s, bool has_phases, const Phase& phase) {
  const Wide d;
  const size_t octaves = terms.octave_weights.size();
  const auto exponential = [&](size_t i) HWY_ATTR { return hn::LoadU(d, rows + terms.used[s * octaves + i] * kRow); };
  if (octaves == 1 && !has_phases) return exponential(0);
  V light = hn::Zero(d);
  for (size_t i = 0; i < octaves; ++i) {
    V weight = hn::Set(d, terms.octave_weights[i]);
    if (has_phases) weight = hn::Mul(weight, phase(i));
    light = hn::Add(light, hn::Mul(weight, exponential(i)));
  }
  return light;
}

void SumLight(const LightTerms& terms, const LitSamples& samples, std::span<const std::vector<float>> weights, float* scratch,
              float* sums) {
  const Wide d;
  const hn::RebindToSigned<Wide> integers;
  const size_t sigmas = weights.size(), lanes = hn::Lanes(d);
  float *totals = scratch, *exponentials = scratch + kRow * sigmas;
  std::fill(totals, totals + kRow * sigmas, 0.0F);
  for (size_t n = 0; n < samples.count; n += lanes) {
    exponentialRows(terms, hn::LoadU(d, samples.lengths + n), exponentials);
    const auto phase = [&](size_t i) HWY_ATTR {
      return hn::GatherIndex(d, samples.phases + i * samples.phase_stride, hn::LoadU(integers, samples.views + n));
    };
    for (size_t s = 0; s < sigmas; ++s) {
      const V light = lightOf(terms, exponentials, s, samples.phases != nullptr, phase);
      float* total = totals + s * kRow + n % kRow;
      hn::StoreU(hn::Add(hn::LoadU(d, total), hn::Mul(light, hn::LoadU(d, weights[s].data() + n))), d, total);
    }
  }
  for (size_t s = 0; s < sigmas; ++s) {
    sums[s] = 0;
    for (size_t lane = 0; lane < kRow; ++lane) sums[s] += totals[s * kRow + lane];
  }
}

void AddLatticeLight(const LightTerms& terms, const LatticeLengths& lattice, std::span<const LatticeSample> samples,
                     std::span<const float> weights, std::span<const float> phases, float* scratch, std::span<float> sums) {
  const Wide d;
  const size_t sigmas = sums.size() / lattice.stride, lanes = hn::Lanes(d),
               octave = phases.size() / std::max<size_t>(terms.octave_weights.size(), 1);
  for (size_t n = 0; n < samples.size(); ++n) {
    const LatticeSample& sample = samples[n];
    const V x = hn::Set(d, sample.x), y = hn::Set(d, sample.y), z = hn::Set(d, sample.z);
    for (size_t j = 0; j < lattice.stride; j += lanes) {
      const auto along = [&](const float* low) HWY_ATTR { return lerp(hn::LoadU(d, low), hn::LoadU(d, low + lattice.stride), x); };
      const auto face = [&](const float* low) HWY_ATTR { return lerp(along(low), along(low + lattice.row), y); };
      const float* low = lattice.values + sample.low + j;
      exponentialRows(terms, lerp(face(low), face(low + lattice.plane), z), scratch);
      const auto phase = [&](size_t i) HWY_ATTR { return hn::LoadU(d, phases.data() + i * octave + sample.view * lattice.stride + j); };
      for (size_t s = 0; s < sigmas; ++s) {
        const V light = lightOf(terms, scratch, s, !phases.empty(), phase);
        float* sum = sums.data() + s * lattice.stride + j;
        hn::StoreU(hn::Add(hn::LoadU(d, sum), hn::Mul(hn::Set(d, weights[n * sigmas + s]), light)), d, sum);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(SumLight);
HWY_EXPORT(AddLatticeLight);

void sumLight(const LightTerms& terms, const LitSamples& samples, std::span<const std::vector<float>> weights, float* scratch,
              float* sums) {
  HWY_DYNAMIC_DISPATCH(SumLight)(terms, samples, weights, scratch, sums);
}
void addLatticeLight(const LightTerms& terms, const LatticeLengths& lattice, std::span<const LatticeSample> samples,
                     std::span<const float> weights, std::span<const float> phases, float* scratch, std::span<float> sums) {
  HWY_DYNAMIC_DISPATCH(AddLatticeLight)(terms, lattice, samples, weights, phases, scratch, sums);
}

}  // namespace cloudbake
#endif
