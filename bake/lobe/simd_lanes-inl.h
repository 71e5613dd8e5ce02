// Code shared by the SIMD kernels: vectors of at most 8 lanes, and bilinear interpolation. It is included once per Highway target, inside
// the target's namespace. Taps are read per point. A 4 × 4 transpose turns "four taps of a point" into "one tap of four points", which is
// cheaper than gathers.
#if defined(CLOUDBAKE_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CLOUDBAKE_SIMD_LANES_INL_H_
#undef CLOUDBAKE_SIMD_LANES_INL_H_
#else
#define CLOUDBAKE_SIMD_LANES_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Wide = hn::CappedTag<float, 8>;
using WideInts = hn::RebindToSigned<Wide>;
using Block = hn::CappedTag<float, 4>;
using V = hn::Vec<Wide>;
using VInts = hn::Vec<WideInts>;

HWY_INLINE V lerp(V from, V to, V part) { return hn::Add(from, hn::Mul(part, hn::Sub(to, from))); }

// The four values of point n, from `taps(n)`, and if there is a second block also those of point n + 4.
template <class Taps>
HWY_INLINE V pairOfBlocks(const Taps& taps, int n) {
#if HWY_MAX_BYTES >= 32
  return hn::Combine(Wide(), taps(n + 4), taps(n));
#else
  return taps(n);
#endif
}

// Bilinear values from the values 00, 01, 10, 11 of four points per block. After a transpose in each block it interpolates within a pair by
// `part_low` and between the pairs by `part_high`.
HWY_INLINE V bilinear(V p0, V p1, V p2, V p3, V part_low, V part_high) {
  const Wide d;
  const hn::RepartitionToWide<hn::RebindToUnsigned<Wide>> halves;
  const auto lower = [&](V x, V y)
                         HWY_ATTR { return hn::BitCast(d, hn::InterleaveLower(halves, hn::BitCast(halves, x), hn::BitCast(halves, y))); };
  const auto upper = [&](V x, V y)
                         HWY_ATTR { return hn::BitCast(d, hn::InterleaveUpper(halves, hn::BitCast(halves, x), hn::BitCast(halves, y))); };
  const V low01 = hn::InterleaveLower(d, p0, p1), low23 = hn::InterleaveLower(d, p2, p3);
  const V high01 = hn::InterleaveUpper(d, p0, p1), high23 = hn::InterleaveUpper(d, p2, p3);
  const V first = lerp(lower(low01, low23), upper(low01, low23), part_low);
  const V second = lerp(lower(high01, high23), upper(high01, high23), part_low);
  return lerp(first, second, part_high);
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#endif
