// The same as exp_log.h, bit for bit, for Highway's vectors. It is included once per Highway target, inside the target's namespace.
#if defined(CLOUDBAKE_EXP_LOG_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CLOUDBAKE_EXP_LOG_INL_H_
#undef CLOUDBAKE_EXP_LOG_INL_H_
#else
#define CLOUDBAKE_EXP_LOG_INL_H_
#endif

#include "bake/lobe/simd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

// exp(−x) for x ≥ −87.
HWY_INLINE V ExpMinus(V x) {
  const Wide d;
  const hn::RebindToUnsigned<Wide> bits;
  const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const V magic = set(0x1.8p23F), y = hn::Neg(hn::Min(x, set(87)));
  const V shifted = hn::Add(hn::Mul(y, set(1.44269504F)), magic), n = hn::Sub(shifted, magic);
  const V r = hn::Add(hn::Sub(y, hn::Mul(n, set(0.693359375F))), hn::Mul(n, set(2.12194440e-4F)));
  V p = hn::Add(hn::Mul(set(1.9875691500e-4F), r), set(1.3981999507e-3F));
  for (const float next : {8.3334519073e-3F, 4.1665795894e-2F, 1.6666665459e-1F, 5.0000001201e-1F}) p = hn::Add(hn::Mul(p, r), set(next));
  const V fraction = hn::Add(hn::Add(hn::Mul(hn::Mul(p, r), r), r), set(1));
  return hn::Mul(fraction, hn::BitCast(d, hn::Add(hn::ShiftLeft<23>(hn::BitCast(bits, shifted)), hn::Set(bits, 0x3F800000U))));
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#endif
