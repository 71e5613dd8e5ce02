// Google Highway compiles this file once per target and picks one at run time. A lane is a point, no lanes are added, and there is no FMA:
// each operation is that of preview/backdrop/noise.cpp, in its order.
#include "preview/backdrop/noise_kernels.h"

#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "preview/backdrop/noise_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "preview/backdrop/noise-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

HWY_INLINE V scaled(V x, float frequency, float shift) { return hn::Add(hn::Mul(x, set(frequency)), set(shift)); }

void FbmValues2(const float* x, const float* y, size_t count, const FbmSettings& settings, float* value) {
  forEachVector<2, 1>({x, y}, {value}, count, [&](const std::array<V, 2>& p) HWY_ATTR {
    V sum = set(0);
    const float total = forEachOctave(settings, [&](float frequency, float shift, uint32_t seed, int, float weight) HWY_ATTR {
      const Axis along_x = axisAt(scaled(p[0], frequency, shift), 0), along_y = axisAt(scaled(p[1], frequency, shift), 0);
      sum = hn::Add(sum, hn::Mul(set(weight), valueFace(seedBits(seed), along_x, along_y).value()));
    });
    return std::array<V, 1>{hn::Div(sum, set(total))};
  });
}

void FbmValues3(const float* x, const float* y, const float* z, const float* limit, size_t count, const FbmSettings& settings,
                float* value) {
  const float total = forEachOctave(settings, [](float, float, uint32_t, int, float) HWY_ATTR {});
  forEachVector<4, 1>({x, y, z, limit}, {value}, count, [&](const std::array<V, 4>& p) HWY_ATTR {
    V sum = set(0);
    bool done = false;
    forEachOctave(settings, [&](float frequency, float shift, uint32_t seed, int, float weight) HWY_ATTR {
      if (done) return;
      const Axis along_x = axisAt(scaled(p[0], frequency, shift), 0), along_y = axisAt(scaled(p[1], frequency, shift), 0),
                 along_z = axisAt(scaled(p[2], frequency, shift), 0);
      const Bits bits = seedBits(seed);
      const V low = valueFace(hashAlong(bits, along_z.low), along_x, along_y).value(),
              high = valueFace(hashAlong(bits, along_z.high), along_x, along_y).value();
      sum = hn::Add(sum, hn::Mul(set(weight), lerp(low, high, along_z.weight)));
      done = hn::AllTrue(D(), hn::Ge(hn::Div(sum, set(total)), p[3]));
    });
    return std::array<V, 1>{hn::Div(sum, set(total))};
  });
}

void FbmGradients2(const float* x, const float* y, size_t count, const FbmSettings& settings, float* slope_x, float* slope_y) {
  forEachVector<2, 2>({x, y}, {slope_x, slope_y}, count, [&](const std::array<V, 2>& p) HWY_ATTR {
    V sum_x = set(0), sum_y = set(0);
    const float total = forEachOctave(settings, [&](float frequency, float shift, uint32_t seed, int period, float weight) HWY_ATTR {
      const Axis along_x = axisAt(scaled(p[0], frequency, shift), period), along_y = axisAt(scaled(p[1], frequency, shift), period);
      const Vector2 slope = gradientNoiseSlope(seedBits(seed), along_x, along_y);
      sum_x = hn::Add(sum_x, hn::Mul(slope.x, set(weight * frequency)));
      sum_y = hn::Add(sum_y, hn::Mul(slope.y, set(weight * frequency)));
    });
    const V scale = set(1 / total);
    return std::array<V, 2>{hn::Mul(sum_x, scale), hn::Mul(sum_y, scale)};
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(FbmValues2);
HWY_EXPORT(FbmValues3);
HWY_EXPORT(FbmGradients2);

void fbmValues2(const float* x, const float* y, size_t count, const FbmSettings& settings, float* value) {
  HWY_DYNAMIC_DISPATCH(FbmValues2)(x, y, count, settings, value);
}
void fbmValues3(const float* x, const float* y, const float* z, const float* limit, size_t count, const FbmSettings& settings,
                float* value) {
  HWY_DYNAMIC_DISPATCH(FbmValues3)(x, y, z, limit, count, settings, value);
}
void fbmGradients2(const float* x, const float* y, size_t count, const FbmSettings& settings, float* slope_x, float* slope_y) {
  HWY_DYNAMIC_DISPATCH(FbmGradients2)(x, y, count, settings, slope_x, slope_y);
}

}  // namespace cloudbake
#endif
