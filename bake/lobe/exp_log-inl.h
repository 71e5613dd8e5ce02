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

// −log x for a normal x > 0.
HWY_INLINE V MinusLog(V x) {
  const Wide d;
  const WideInts integers;
  const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const auto bits = hn::BitCast(integers, x);
  const auto n = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(integers, 0x3F3504F3)));
  const V r = hn::Sub(hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(n))), set(1));
  V p = hn::Sub(hn::Mul(set(7.0376836292e-2F), r), set(1.1514610310e-1F));
  for (const float next :
       {1.1676998740e-1F, -1.2420140846e-1F, 1.4249322787e-1F, -1.6668057665e-1F, 2.0000714765e-1F, -2.4999993993e-1F, 3.3333331174e-1F})
    p = hn::Add(hn::Mul(p, r), set(next));
  const V log = hn::Add(hn::Mul(hn::Mul(r, r), hn::Sub(hn::Mul(r, p), set(0.5F))), r);
  return hn::Neg(hn::Add(log, hn::Mul(hn::ConvertTo(d, n), set(0.69314718F))));
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#endif
