// FilmCurve of preview/shading_math.h, and the sRGB transfer function (IEC 61966-2-1). Its power x^(1/2.4) is s·c² with
// s = x^(1/4) and c = s^(1/3): c begins as a parabola, 1 % off at most where x ≥ 0.0031308, and two steps of Halley's method in double
// precision. Google Highway compiles this file once per target and picks one at run time. There is no FMA, so that all targets agree to the
// last bit.
#include "preview/mesh_clouds/tone_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "preview/mesh_clouds/tone_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "preview/shading_math.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Double = hn::ScalableTag<double>;
using Float = hn::Rebind<float, Double>;

constexpr double kExcess = double(1 / 2.4F) - 5.0 / 12;  // ε: the exponent is a float

HWY_INLINE hn::Vec<Float> powerOfSrgb(hn::Vec<Float> x) {
  const Double d;
  const auto set = [d](double value) HWY_ATTR { return hn::Set(d, value); };
  const auto s = hn::Sqrt(hn::Sqrt(hn::PromoteTo(d, x)));
  auto c = hn::Add(hn::Mul(hn::Add(hn::Mul(set(-0.2791682), s), set(0.8329862)), s), set(0.4436118));
  for (int step = 0; step < 2; ++step) {
    const auto cube = hn::Mul(hn::Mul(c, c), c);
    c = hn::Div(hn::Mul(c, hn::Add(cube, hn::Add(s, s))), hn::Add(hn::Add(cube, cube), s));
  }
  // x^ε = 1 + 12 ε ln c, to all digits of a float.
  const auto below = hn::Sub(c, set(1));
  const auto log = hn::Mul(below, hn::Add(set(1), hn::Mul(below, hn::Add(set(-0.5), hn::Mul(below, set(1.0 / 3))))));
  return hn::DemoteTo(Float(), hn::Mul(hn::Mul(s, hn::Mul(c, c)), hn::Add(set(1), hn::Mul(set(12 * kExcess), log))));
}

HWY_INLINE hn::Vec<Float> encoded(hn::Vec<Float> value, float exposure) {
  const auto set = [](float constant) HWY_ATTR { return hn::Set(Float(), constant); };
  const auto light = hn::Mul(value, set(exposure));
  const auto x = hn::IfThenElseZero(hn::Gt(light, set(0)), hn::Min(light, set(1e6F)));
  const auto film =
      hn::Min(set(1), hn::Div(hn::Mul(x, hn::Add(hn::Mul(set(FilmCurve::kA), x), set(FilmCurve::kB))),
                              hn::Add(hn::Mul(x, hn::Add(hn::Mul(set(FilmCurve::kC), x), set(FilmCurve::kD))), set(FilmCurve::kE))));
  const auto bright = hn::Sub(hn::Mul(set(1.055F), powerOfSrgb(film)), set(0.055F));
  return hn::IfThenElse(hn::Le(film, set(0.0031308F)), hn::Mul(set(12.92F), film), bright);
}

void EncodeTones(float* values, size_t count, float exposure) {
  const Float d;
  const size_t lanes = hn::Lanes(d), whole = count - count % lanes;
  for (size_t i = 0; i < whole; i += lanes) hn::StoreU(encoded(hn::LoadU(d, values + i), exposure), d, values + i);
  if (whole == count) return;
  std::array<float, hn::MaxLanes(Float())> rest{};
  std::copy(values + whole, values + count, rest.begin());
  hn::StoreU(encoded(hn::LoadU(d, rest.data()), exposure), d, rest.data());
  std::copy_n(rest.begin(), count - whole, values + whole);
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(EncodeTones);

void encodeTones(float* values, size_t count, float exposure) { HWY_DYNAMIC_DISPATCH(EncodeTones)(values, count, exposure); }

}  // namespace cloudbake
#endif
