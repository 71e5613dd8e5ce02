// The same as exp_log.h, bit for bit, for Highway's vectors. It is included once per Highway target, inside the target's namespace.
#if defined(CLOUDBAKE_EXP_LOG_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CLOUDBAKE_EXP_LOG_INL_H_
#undef CLOUDBAKE_EXP_LOG_INL_H_
#else
#define CLOUDBAKE_EXP_LOG_INL_H_
#endif

#include <iterator>

#include "bake/lobe/simd_lanes-inl.h"
#include "core/exp_log.h"

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
  V p = set(kExpTerms[0]);
  for (size_t i = 1; i < std::size(kExpTerms); ++i) p = hn::Add(hn::Mul(p, r), set(kExpTerms[i]));
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
  V p = set(kLogTerms[0]);
  for (size_t i = 1; i < std::size(kLogTerms); ++i) p = hn::Add(hn::Mul(p, r), set(kLogTerms[i]));
  const V log = hn::Add(hn::Mul(hn::Mul(r, r), hn::Sub(hn::Mul(r, p), set(0.5F))), r);
  return hn::Neg(hn::Add(log, hn::Mul(hn::ConvertTo(d, n), set(0.69314718F))));
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#endif
