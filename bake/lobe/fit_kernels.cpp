// Google Highway compiles this file once per target and picks one at run time. Multiplication and addition stay separate (no FMA).
#include "bake/lobe/fit_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bake/lobe/fit_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "bake/lobe/exp_log-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

constexpr size_t kRow = 8;  // lights that are summed apart; a target's vector holds all of them or a part

// Twice the σ before: T is the square of the T before.
HWY_INLINE bool isDoubled(std::span<const float> extinctions, size_t i) { return i > 0 && extinctions[i] == 2 * extinctions[i - 1]; }

HWY_INLINE V dotWith(Vec3 direction, V x, V y, V z) {
  const Wide d;
  return hn::Add(hn::Add(hn::Mul(x, hn::Set(d, direction.x)), hn::Mul(y, hn::Set(d, direction.y))), hn::Mul(z, hn::Set(d, direction.z)));
}

// s and its slopes for every light. First `along_u` holds h and `depth` −log h^k.
struct Slopes {
  float *depth, *along_u, *along_v, *along_w;
};
HWY_INLINE void thicknessRows(const FitLights& lights, const FitLobe& lobe, const Slopes& rows) {
  const Wide d;
  const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const V zero = hn::Zero(d), half = set(0.5F);
  for (size_t j = 0; j < lights.count; j += hn::Lanes(d)) {
    const V x = hn::LoadU(d, lights.x + j), y = hn::LoadU(d, lights.y + j), z = hn::LoadU(d, lights.z + j);
    const V h = hn::Max(hn::Add(hn::Mul(dotWith(lobe.direction, x, y, z), half), half), set(1e-7F));
    hn::StoreU(h, d, rows.along_u + j);
    hn::StoreU(hn::Mul(set(lobe.exponent), MinusLog(h)), d, rows.depth + j);
  }
  for (size_t j = 0; j < lights.count; j += hn::Lanes(d)) {
    const V x = hn::LoadU(d, lights.x + j), y = hn::LoadU(d, lights.y + j), z = hn::LoadU(d, lights.z + j),
            h = hn::LoadU(d, rows.along_u + j);
    const V bulk = hn::Mul(ExpMinus(hn::LoadU(d, rows.depth + j)), set(lobe.thickness)), s = hn::Add(bulk, set(lobe.bias));
    const V along_w = hn::IfThenElseZero(hn::Gt(s, zero), bulk), slope = hn::Div(hn::Mul(set(0.5F * lobe.exponent), along_w), h);
    hn::StoreU(hn::Max(s, zero), d, rows.depth + j);
    hn::StoreU(along_w, d, rows.along_w + j);
    hn::StoreU(hn::Mul(slope, dotWith(lobe.tangent, x, y, z)), d, rows.along_u + j);
    hn::StoreU(hn::Mul(slope, dotWith(lobe.bitangent, x, y, z)), d, rows.along_v + j);
  }
}

void TransmittanceRows(const float* lengths, size_t count, float unit, std::span<const float> extinctions, float* rows) {
  const Wide d;
  for (size_t j = 0; j < count; j += hn::Lanes(d)) {
    const V length = hn::Mul(hn::Max(hn::LoadU(d, lengths + j), hn::Zero(d)), hn::Set(d, unit));
    V t = hn::Zero(d);
    for (size_t i = 0; i < extinctions.size(); ++i) {
      t = isDoubled(extinctions, i) ? hn::Mul(t, t) : ExpMinus(hn::Mul(length, hn::Set(d, extinctions[i])));
      hn::StoreU(t, d, rows + i * count + j);
    }
  }
}

// In four passes, so that more lights are in progress at a time: each waits long for its own logarithm and exponentials.
void SumFit(const FitLights& lights, const FitLobe& lobe, std::span<const float> extinctions, const float* targets, float* scratch,
            FitSums& sums) {
  const Wide d;
  const size_t lanes = hn::Lanes(d);
  const Slopes rows{scratch, scratch + lights.count, scratch + 2 * lights.count, scratch + 3 * lights.count};
  float* transmittances = scratch + 4 * lights.count;
  thicknessRows(lights, lobe, rows);
  TransmittanceRows(rows.depth, lights.count, 1, extinctions, transmittances);
  const V zero = hn::Zero(d);
  sums = {};
  for (size_t part = 0; part < kRow; part += lanes) {
    V error_sum = zero, gu = zero, gv = zero, gw = zero, uu = zero, uv = zero, uw = zero, vv = zero, vw = zero, ww = zero;
    for (size_t j = part; j < lights.count; j += kRow) {
      const V weight = hn::LoadU(d, lights.weight + j);
      V error = zero, pull = zero, stiffness = zero;
      for (size_t i = 0; i < extinctions.size(); ++i) {
        const size_t at = i * lights.count + j;
        const V t = hn::LoadU(d, transmittances + at), residual = hn::Sub(t, hn::LoadU(d, targets + at));
        const V slope = hn::Mul(hn::Set(d, -extinctions[i]), t);
        const V weighted = hn::Mul(weight, slope);
        error = hn::Add(error, hn::Mul(residual, residual));
        pull = hn::Add(pull, hn::Mul(weighted, residual));
        stiffness = hn::Add(stiffness, hn::Mul(weighted, slope));
      }
      const V u = hn::LoadU(d, rows.along_u + j), v = hn::LoadU(d, rows.along_v + j), w = hn::LoadU(d, rows.along_w + j);
      const V stiff_u = hn::Mul(stiffness, u), stiff_v = hn::Mul(stiffness, v), stiff_w = hn::Mul(stiffness, w);
      error_sum = hn::Add(error_sum, hn::Mul(weight, error));
      gu = hn::Add(gu, hn::Mul(pull, u)), gv = hn::Add(gv, hn::Mul(pull, v)), gw = hn::Add(gw, hn::Mul(pull, w));
      uu = hn::Add(uu, hn::Mul(stiff_u, u)), uv = hn::Add(uv, hn::Mul(stiff_u, v)), uw = hn::Add(uw, hn::Mul(stiff_u, w));
      vv = hn::Add(vv, hn::Mul(stiff_v, v)), vw = hn::Add(vw, hn::Mul(stiff_v, w)), ww = hn::Add(ww, hn::Mul(stiff_w, w));
    }
    // The lanes are added one after the other in double precision
    const auto add = [&](double& sum, V values) HWY_ATTR {
      float each[kRow];
      hn::StoreU(values, d, each);
      for (size_t lane = 0; lane < lanes; ++lane) sum += double(each[lane]);
    };
    add(sums.error, error_sum);
    add(sums.gradient[0], gu), add(sums.gradient[1], gv), add(sums.gradient[2], gw);
    add(sums.hessian[0], uu), add(sums.hessian[1], uv), add(sums.hessian[2], uw);
    add(sums.hessian[3], vv), add(sums.hessian[4], vw), add(sums.hessian[5], ww);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(SumFit);
HWY_EXPORT(TransmittanceRows);

FitSums sumFit(const FitLights& lights, const FitLobe& lobe, std::span<const float> extinctions, const float* targets, float* scratch) {
  FitSums sums;
  HWY_DYNAMIC_DISPATCH(SumFit)(lights, lobe, extinctions, targets, scratch, sums);
  return sums;
}
void transmittanceRows(const float* lengths, size_t count, float unit, std::span<const float> extinctions, float* rows) {
  HWY_DYNAMIC_DISPATCH(TransmittanceRows)(lengths, count, unit, extinctions, rows);
}

}  // namespace cloudbake
#endif
