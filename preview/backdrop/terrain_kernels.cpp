// Google Highway compiles this file once per target and picks one at run time. Places are in double, because far from the origin float is
// coarser than the ground's detail; the noise is in float.
#include "preview/backdrop/terrain_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "preview/backdrop/terrain_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "preview/backdrop/noise-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

using DHalf = hn::Half<D>;
using DDouble = hn::Rebind<double, DHalf>;

HWY_INLINE hn::Vec<DHalf> clampedToFloat(hn::Vec<DDouble> x) {
  const DDouble d;
  return hn::DemoteTo(DHalf(), hn::Min(hn::Max(x, hn::Set(d, -0x1p29)), hn::Set(d, 0x1p29)));
}

// A vector of places in double, as two halves.
struct Doubles {
  hn::Vec<DDouble> low, high;
  HWY_INLINE V floats() const { return hn::Combine(D(), clampedToFloat(high), clampedToFloat(low)); }
};

HWY_INLINE Doubles turned(const Doubles& x, double a, const Doubles& y, double b, double factor) {
  const DDouble d;
  const auto turn = [&](hn::Vec<DDouble> p, hn::Vec<DDouble> q)
                        HWY_ATTR { return hn::Mul(hn::Set(d, factor), hn::Add(hn::Mul(hn::Set(d, a), p), hn::Mul(hn::Set(d, b), q))); };
  return {turn(x.low, y.low), turn(x.high, y.high)};
}

void ErodedSums(const double* x, const double* y, size_t count, const ErodedOctaves& octaves, float* sums) {
  const D d;
  const DDouble dd;
  const size_t half = hn::Lanes(dd);
  for (size_t i = 0; i < count; i += 2 * half) {
    Doubles at_x{hn::LoadU(dd, x + i), hn::LoadU(dd, x + i + half)}, at_y{hn::LoadU(dd, y + i), hn::LoadU(dd, y + i + half)};
    V sum = set(0), slope_x = set(0), slope_y = set(0);
    float weight = 1;
    for (int octave = 0; octave < octaves.count; ++octave, weight *= octaves.gain) {
      const Axis along_x = axisAt(at_x.floats(), 0), along_y = axisAt(at_y.floats(), 0);
      const Face face = valueFace(seedBits(octaves.seed + uint32_t(octave) * octaves.seed_step), along_x, along_y);
      slope_x = hn::Add(slope_x, face.slopeX());
      slope_y = hn::Add(slope_y, face.slopeY());
      const V steepness = hn::Add(hn::Add(set(1), hn::Mul(slope_x, slope_x)), hn::Mul(slope_y, slope_y));
      sum = hn::Add(sum, hn::Div(hn::Mul(set(weight), face.value()), steepness));
      const Doubles next_x = turned(at_x, 0.8, at_y, -0.6, octaves.lacunarity);
      at_y = turned(at_x, 0.6, at_y, 0.8, octaves.lacunarity);
      at_x = next_x;
    }
    hn::StoreU(sum, d, sums + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(ErodedSums);

void erodedSums(const double* x, const double* y, size_t count, const ErodedOctaves& octaves, float* sums) {
  HWY_DYNAMIC_DISPATCH(ErodedSums)(x, y, count, octaves, sums);
}

}  // namespace cloudbake
#endif
