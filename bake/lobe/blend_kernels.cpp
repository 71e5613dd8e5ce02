// Google Highway compiles this file once per target and picks one at run time. Multiplication and addition stay separate (no FMA).
#include "bake/lobe/blend_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bake/lobe/blend_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "bake/lobe/simd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

constexpr size_t kRow = 8;  // lobes that are summed apart; a target's vector holds all of them or a part

void SumNear(const NearLobes& near, Vec3 at, Vec3 normal, const BlendReach& reach, BlendSums& sums) {
  const Wide d;
  const size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F), cosine = hn::Set(d, reach.cosine),
          per_square = hn::Set(d, 1 / (reach.distance * reach.distance));
  const V at_x = hn::Set(d, at.x), at_y = hn::Set(d, at.y), at_z = hn::Set(d, at.z);
  const V normal_x = hn::Set(d, normal.x), normal_y = hn::Set(d, normal.y), normal_z = hn::Set(d, normal.z);
  const auto dotOf = [&](V a, V b, V c, V x, V y, V z) HWY_ATTR { return hn::Add(hn::Add(hn::Mul(a, x), hn::Mul(b, y)), hn::Mul(c, z)); };
  sums = {};
  for (size_t part = 0; part < kRow; part += lanes) {
    V weights = zero, thickness = zero, vector_x = zero, vector_y = zero, vector_z = zero, x = zero, y = zero, z = zero;
    for (size_t n = part; n < near.count; n += kRow) {
      const auto load = [&](const float* row) HWY_ATTR { return hn::LoadU(d, row + n); };
      const V to_x = hn::Sub(load(near.x), at_x), to_y = hn::Sub(load(near.y), at_y), to_z = hn::Sub(load(near.z), at_z);
      const V place = hn::Max(hn::Sub(one, hn::Mul(dotOf(to_x, to_y, to_z, to_x, to_y, to_z), per_square)), zero);
      const V between = dotOf(load(near.normal_x), load(near.normal_y), load(near.normal_z), normal_x, normal_y, normal_z);
      const V facing = hn::Max(hn::Sub(between, cosine), zero), square = hn::Mul(place, place);
      const V weight = hn::Mul(hn::Mul(square, square), hn::Mul(facing, facing));
      const V o_x = hn::Mul(weight, load(near.o_x)), o_y = hn::Mul(weight, load(near.o_y)), o_z = hn::Mul(weight, load(near.o_z)),
              long_as = load(near.thickness);
      weights = hn::Add(weights, weight), thickness = hn::Add(thickness, hn::Mul(weight, long_as));
      x = hn::Add(x, o_x), y = hn::Add(y, o_y), z = hn::Add(z, o_z);
      vector_x = hn::Add(vector_x, hn::Mul(o_x, long_as));
      vector_y = hn::Add(vector_y, hn::Mul(o_y, long_as));
      vector_z = hn::Add(vector_z, hn::Mul(o_z, long_as));
    }
    // The lanes are added one after the other
    const auto add = [&](float& sum, V values) HWY_ATTR {
      float each[kRow];
      hn::StoreU(values, d, each);
      for (size_t lane = 0; lane < lanes; ++lane) sum += each[lane];
    };
    add(sums.weight, weights), add(sums.thickness, thickness);
    add(sums.vector.x, vector_x), add(sums.vector.y, vector_y), add(sums.vector.z, vector_z);
    add(sums.direction.x, x), add(sums.direction.y, y), add(sums.direction.z, z);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(SumNear);

BlendSums sumNear(const NearLobes& near, Vec3 at, Vec3 normal, const BlendReach& reach) {
  BlendSums sums;
  HWY_DYNAMIC_DISPATCH(SumNear)(near, at, normal, reach, sums);
  return sums;
}

}  // namespace cloudbake
#endif
