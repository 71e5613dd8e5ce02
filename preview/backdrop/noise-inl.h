// The noises of preview/backdrop/noise.cpp in vectors: a lane is a point, no lanes are added, and there is no FMA. It is included once per
// Highway target, inside the target's namespace.
#if defined(CLOUDBAKE_NOISE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CLOUDBAKE_NOISE_INL_H_
#undef CLOUDBAKE_NOISE_INL_H_
#else
#define CLOUDBAKE_NOISE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "preview/backdrop/noise.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using DInt = hn::RebindToSigned<D>;
using DBits = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using Bits = hn::Vec<DBits>;

HWY_INLINE V set(float x) { return hn::Set(D(), x); }
HWY_INLINE V lerp(V a, V b, V t) { return hn::Add(a, hn::Mul(hn::Sub(b, a), t)); }

struct Axis {
  Bits low, high;         // hashed coordinates of the lattice points
  V part, weight, slope;  // as in noise.cpp
};

// The share of a coordinate in a hash.
HWY_INLINE Bits coordinateBits(hn::Vec<DInt> cell) {
  const DBits d;
  return hn::Add(hn::Mul(hn::BitCast(d, cell), hn::Set(d, 0x9E3779B9U)), hn::Set(d, 0x7F4A7C15U));
}

HWY_INLINE Axis axisAt(V x, int period) {
  const DInt di;
  const V floor = hn::Floor(x), t = hn::Sub(x, floor);
  V cell = floor, next = hn::Add(floor, set(1));
  if (period > 0) {
    const V size = set(float(period));
    cell = hn::Sub(cell, hn::Mul(size, hn::Floor(hn::Div(cell, size))));
    next = hn::Add(cell, set(1));
    next = hn::IfThenElseZero(hn::Ne(next, size), next);
  }
  const hn::Vec<DInt> low = hn::ConvertTo(di, cell);
  const hn::Vec<DInt> high = period > 0 ? hn::ConvertTo(di, next) : hn::Add(low, hn::Set(di, 1));
  const V weight = hn::Mul(hn::Mul(hn::Mul(t, t), t), hn::Add(hn::Mul(t, hn::Sub(hn::Mul(set(6), t), set(15))), set(10)));
  const V down = hn::Sub(t, set(1));
  return {coordinateBits(low), coordinateBits(high), t, weight, hn::Mul(hn::Mul(hn::Mul(hn::Mul(set(30), t), t), down), down)};
}

HWY_INLINE Bits mix32(Bits x) {
  const DBits d;
  x = hn::Xor(x, hn::ShiftRight<16>(x));
  x = hn::Mul(x, hn::Set(d, 0x7feb352dU));
  x = hn::Xor(x, hn::ShiftRight<15>(x));
  x = hn::Mul(x, hn::Set(d, 0x846ca68bU));
  return hn::Xor(x, hn::ShiftRight<16>(x));
}

HWY_INLINE Bits hashAlong(Bits hash, Bits coordinate) { return mix32(hn::Xor(hash, coordinate)); }
HWY_INLINE Bits seedBits(uint32_t seed) { return mix32(hn::Set(DBits(), seed)); }

HWY_INLINE V unitFloat(Bits hash) {
  const DInt di;
  return hn::Mul(hn::ConvertTo(D(), hn::BitCast(di, hn::ShiftRight<8>(hash))), set(0x1p-24F));
}

// A face of a cell, as joinCorners of noise.cpp.
struct Face {
  V base, b, c, d;
  const Axis &x, &y;
  HWY_INLINE Face(V h00, V h10, V h01, V h11, const Axis& along_x, const Axis& along_y)
      : base(h00), b(hn::Sub(h10, h00)), c(hn::Sub(h01, h00)), d(hn::Add(hn::Sub(hn::Sub(h00, h10), h01), h11)), x(along_x), y(along_y) {}
  HWY_INLINE V value() const {
    return hn::Add(hn::Add(hn::Add(base, hn::Mul(b, x.weight)), hn::Mul(c, y.weight)), hn::Mul(hn::Mul(d, x.weight), y.weight));
  }
  HWY_INLINE V slopeX() const { return hn::Mul(x.slope, hn::Add(b, hn::Mul(d, y.weight))); }
  HWY_INLINE V slopeY() const { return hn::Mul(y.slope, hn::Add(c, hn::Mul(d, x.weight))); }
};

HWY_INLINE Face valueFace(Bits seed, const Axis& x, const Axis& y) {
  const Bits low = hashAlong(seed, y.low), high = hashAlong(seed, y.high);
  return {unitFloat(hashAlong(low, x.low)),
          unitFloat(hashAlong(low, x.high)),
          unitFloat(hashAlong(high, x.low)),
          unitFloat(hashAlong(high, x.high)),
          x,
          y};
}

struct Vector2 {
  V x, y;
};

HWY_INLINE Vector2 unitVector(Bits hash) {
  const V along = hn::Mul(unitFloat(hash), set(4)), side = hn::Floor(along), a = hn::Sub(hn::Mul(set(2), hn::Sub(along, side)), set(1));
  const V one = set(1), minus = set(-1), opposite = hn::Neg(a);
  const auto first = hn::Eq(side, set(0)), second = hn::Eq(side, set(1)), third = hn::Eq(side, set(2));
  const V x = hn::IfThenElse(first, one, hn::IfThenElse(second, opposite, hn::IfThenElse(third, minus, a)));
  const V y = hn::IfThenElse(first, a, hn::IfThenElse(second, one, hn::IfThenElse(third, opposite, minus)));
  const V scale = hn::Div(one, hn::Sqrt(hn::Add(one, hn::Mul(a, a))));
  return {hn::Mul(x, scale), hn::Mul(y, scale)};
}

// The gradient of gradientNoise2.
HWY_INLINE Vector2 gradientNoiseSlope(Bits seed, const Axis& x, const Axis& y) {
  const Bits low = hashAlong(seed, y.low), high = hashAlong(seed, y.high);
  const Vector2 g00 = unitVector(hashAlong(low, x.low)), g10 = unitVector(hashAlong(low, x.high));
  const Vector2 g01 = unitVector(hashAlong(high, x.low)), g11 = unitVector(hashAlong(high, x.high));
  const V u = x.part, v = y.part, u1 = hn::Sub(u, set(1)), v1 = hn::Sub(v, set(1));
  const auto height = [](const Vector2& g, V along, V up) HWY_ATTR { return hn::Add(hn::Mul(g.x, along), hn::Mul(g.y, up)); };
  const Face n(height(g00, u, v), height(g10, u1, v), height(g01, u, v1), height(g11, u1, v1), x, y);
  const Face mean_x(g00.x, g10.x, g01.x, g11.x, x, y), mean_y(g00.y, g10.y, g01.y, g11.y, x, y);
  const V scale = set(1.41421356F);
  return {hn::Mul(scale, hn::Add(n.slopeX(), mean_x.value())), hn::Mul(scale, hn::Add(n.slopeY(), mean_y.value()))};
}

// Runs of whole vectors. The rest is copied, so that a kernel neither reads nor writes beyond `count`.
template <size_t kIn, size_t kOut, typename Kernel>
HWY_INLINE void forEachVector(const std::array<const float*, kIn>& in, const std::array<float*, kOut>& out, size_t count,
                              const Kernel& kernel) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    std::array<V, kIn> values;
    for (size_t k = 0; k < kIn; ++k) values[k] = hn::LoadU(d, in[k] + i);
    const std::array<V, kOut> results = kernel(values);
    for (size_t k = 0; k < kOut; ++k) hn::StoreU(results[k], d, out[k] + i);
  }
  if (i == count) return;
  HWY_ALIGN float buffer[HWY_MAX_BYTES / sizeof(float)] = {};
  std::array<V, kIn> values;
  for (size_t k = 0; k < kIn; ++k) {
    std::copy(in[k] + i, in[k] + count, buffer);
    values[k] = hn::Load(d, buffer);
  }
  const std::array<V, kOut> results = kernel(values);
  for (size_t k = 0; k < kOut; ++k) {
    hn::Store(results[k], d, buffer);
    std::copy(buffer, buffer + (count - i), out[k] + i);
  }
}

// The octaves of an fbm, as in noise.cpp: octave(frequency, shift, seed, period, weight).
template <typename Octave>
HWY_INLINE float forEachOctave(const FbmSettings& settings, const Octave& octave) {
  float weight = 1, total = 0, frequency = 1;
  int period = settings.period;
  for (int i = 0; i < settings.octaves; ++i, weight *= settings.gain, frequency *= 2, period *= 2) {
    octave(frequency, float(i * i) * 0.3125F, settings.seed + uint32_t(i) * 0x632BE5ABU, period, weight);
    total += weight;
  }
  return total;
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#endif
