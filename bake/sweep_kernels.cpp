// Google Highway compiles this file once per target and picks one at run time. Multiplication and addition stay apart (no FMA), vectors are
// capped at 8 lanes. Bilinear taps are two loads of two neighbours each, turned from "four taps of a point" to "one tap of four points" by a
// 4 × 4 transpose: cheaper than gathers.
#include "bake/sweep_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bake/sweep_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Wide = hn::CappedTag<float, 8>;
using Four = hn::FixedTag<float, 4>;
using FourInts = hn::FixedTag<int32_t, 4>;
using Pair = hn::FixedTag<float, 2>;
using VFour = hn::Vec<Four>;

template <class V>
HWY_INLINE V lerp(V from, V to, V part) {
  return hn::Add(from, hn::Mul(part, hn::Sub(to, from)));
}

// cell, its neighbour, and both of the next row.
HWY_INLINE VFour fourTaps(const float* cell, size_t stride) {
  return hn::Combine(Four(), hn::LoadU(Pair(), cell + stride), hn::LoadU(Pair(), cell));
}

// Taps of four points → bilinear values.
HWY_INLINE VFour bilinear(VFour p0, VFour p1, VFour p2, VFour p3, VFour part_a, VFour part_b) {
  const Four d;
  const VFour low01 = hn::InterleaveLower(d, p0, p1), low23 = hn::InterleaveLower(d, p2, p3);
  const VFour high01 = hn::InterleaveUpper(d, p0, p1), high23 = hn::InterleaveUpper(d, p2, p3);
  const VFour row = lerp(hn::ConcatLowerLower(d, low23, low01), hn::ConcatUpperUpper(d, low23, low01), part_a);
  const VFour next = lerp(hn::ConcatLowerLower(d, high23, high01), hn::ConcatUpperUpper(d, high23, high01), part_a);
  return lerp(row, next, part_b);
}

// Cell of four sheared positions, and where in it they lie. u, v ≥ the plane's first column and row.
struct Sheared {
  VFour part_a, part_b;
  int32_t cell[4];
};
HWY_INLINE void shearPoints(const PointArrays& points, size_t i, const Shear& shear, size_t stride, Sheared& out) {
  const Four d;
  const FourInts di;
  const VFour c = hn::LoadU(d, points.c + i);
  const VFour u = hn::Sub(hn::LoadU(d, points.a + i), hn::Mul(hn::Set(d, shear.slope_a), c));
  const VFour v = hn::Sub(hn::LoadU(d, points.b + i), hn::Mul(hn::Set(d, shear.slope_b), c));
  const VFour column = hn::Floor(u), row = hn::Floor(v);
  out.part_a = hn::Sub(u, column);
  out.part_b = hn::Sub(v, row);
  const auto cell = hn::Add(hn::ConvertTo(di, column), hn::Mul(hn::ConvertTo(di, row), hn::Set(di, int32_t(stride))));
  hn::StoreU(cell, di, out.cell);
}

void AddSlice(const SliceView& slice, const SliceShift& shift, const ShearedPlanes& planes, float* scratch) {
  const Wide d;
  const size_t lanes = hn::Lanes(d);
  const auto row_part = hn::Set(d, shift.row_part), column_part = hn::Set(d, shift.column_part), zero = hn::Zero(d);
  // scratch[i] is column i − 1 of the two rows in between which a sheared row lies; two zero vectors follow the last one.
  float* between = scratch + 8;
  for (int row = -1; row < slice.rows; ++row) {
    const std::array<int, 2> none{slice.columns, 0};
    const auto& span = row >= 0 ? slice.spans[row] : none;
    const auto& next_span = row + 1 < slice.rows ? slice.spans[row + 1] : none;
    const int first = std::min(span[0], next_span[0]), end = std::max(span[1], next_span[1]);
    float* sum = planes.sum + (row - shift.row) * ptrdiff_t(planes.stride) - shift.column;
    float* last = sum + planes.last;
    if (first >= end) {
      for (int i = -1; i < slice.columns; i += int(lanes)) hn::StoreU(zero, d, last + i);
      continue;
    }

    // Between the rows. The first and the last row are empty, and stand in for those beyond.
    const float* low = slice.cells + size_t(std::max(row, 0)) * slice.row_stride;
    const float* high = slice.cells + size_t(std::min(row + 1, slice.rows - 1)) * slice.row_stride;
    between[first - 1] = 0;
    for (int i = first; i < end; i += int(lanes)) hn::StoreU(lerp(hn::LoadU(d, low + i), hn::LoadU(d, high + i), row_part), d, between + i);
    for (size_t i = 0; i < 16; i += lanes) hn::StoreU(zero, d, between + size_t(end) + i);

    // Between the columns, into both planes.
    for (int i = -1; i < first - 1; i += int(lanes)) hn::StoreU(zero, d, last + i);
    int i = first - 1;
    for (; i < end; i += int(lanes)) {
      const auto value = lerp(hn::LoadU(d, between + i), hn::LoadU(d, between + i + 1), column_part);
      hn::StoreU(value, d, last + i);
      hn::StoreU(hn::Add(hn::LoadU(d, sum + i), value), d, sum + i);
    }
    for (; i < slice.columns; i += int(lanes)) hn::StoreU(zero, d, last + i);
  }
}

void LookUpPrefix(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* prefix) {
  const Four d;
  Sheared at;
  const auto taps = [&](int n, size_t i) HWY_ATTR {
    const float* cell = planes.sum + at.cell[n];
    return hn::Sub(fourTaps(cell, planes.stride), hn::Mul(hn::Set(d, points.rest[i + size_t(n)]), fourTaps(cell + planes.last, planes.stride)));
  };
  for (size_t i = 0; i < points.count; i += 4) {
    shearPoints(points, i, shear, planes.stride, at);
    hn::StoreU(bilinear(taps(0, i), taps(1, i), taps(2, i), taps(3, i), at.part_a, at.part_b), d, prefix + i);
  }
}

void LookUpSum(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* sum) {
  const Four d;
  Sheared at;
  const auto taps = [&](int n) HWY_ATTR { return fourTaps(planes.sum + at.cell[n], planes.stride); };
  for (size_t i = 0; i < points.count; i += 4) {
    shearPoints(points, i, shear, planes.stride, at);
    hn::StoreU(bilinear(taps(0), taps(1), taps(2), taps(3), at.part_a, at.part_b), d, sum + i);
  }
}

void AddSenses(const float* from, const float* at, const float* to, float scale, Vec3 direction, const MeanSums& sums, size_t count) {
  const Wide d;
  const auto add = [&](float* target, auto value) HWY_ATTR { hn::StoreU(hn::Add(hn::LoadU(d, target), value), d, target); };
  const auto x = hn::Set(d, direction.x), y = hn::Set(d, direction.y), z = hn::Set(d, direction.z), to_length = hn::Set(d, scale);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto here = hn::LoadU(d, at + i), start = from ? hn::LoadU(d, from + i) : hn::Zero(d);
    const auto ahead = hn::Mul(hn::Sub(hn::LoadU(d, to + i), here), to_length), behind = hn::Mul(hn::Sub(here, start), to_length);
    const auto ahead2 = hn::Mul(ahead, ahead), behind2 = hn::Mul(behind, behind), difference = hn::Sub(ahead2, behind2);
    add(sums.x + i, hn::Mul(x, difference));
    add(sums.y + i, hn::Mul(y, difference));
    add(sums.z + i, hn::Mul(z, difference));
    add(sums.squares + i, hn::Add(ahead2, behind2));
  }
}

void MarchSlices(const MarchedField& field, const MarchedRays& rays, float* inside) {
  const Four d;
  const FourInts di;
  const auto half = hn::Set(d, 0.5F), zero = hn::Zero(d), sense = hn::Set(d, rays.sense);
  const auto last_a = hn::Set(d, float(field.columns - 2)), last_b = hn::Set(d, float(field.rows - 2)), last_c = hn::Set(d, float(field.slices - 1));
  for (size_t i = 0; i < rays.count; i += 4) {
    const auto a = hn::LoadU(d, rays.a + i), b = hn::LoadU(d, rays.b + i), c = hn::LoadU(d, rays.c + i);
    const auto slope_a = hn::LoadU(d, rays.slope_a + i), slope_b = hn::LoadU(d, rays.slope_b + i), length = hn::LoadU(d, rays.length + i);
    auto slice = hn::Floor(hn::Add(c, half));
    auto sum = zero;
    for (;;) {
      // The ray meets the slice's middle at t, its near side half a slice before; beyond the box or its end it is done.
      const auto along = hn::Sub(slice, c), t = hn::Mul(sense, along);
      const auto at_a = hn::Add(a, hn::Mul(slope_a, along)), at_b = hn::Add(b, hn::Mul(slope_b, along));
      const auto near = hn::Max(hn::Sub(t, half), zero), far = hn::Min(hn::Add(t, half), length);
      auto live = hn::And(hn::Lt(near, length), hn::And(hn::Ge(slice, zero), hn::Le(slice, last_c)));
      const auto column = hn::Floor(at_a), row = hn::Floor(at_b);
      live = hn::And(live, hn::And(hn::And(hn::Ge(column, zero), hn::Le(column, last_a)), hn::And(hn::Ge(row, zero), hn::Le(row, last_b))));
      if (hn::AllFalse(d, live)) break;

      int32_t columns[4], rows[4], slices[4];
      hn::StoreU(hn::ConvertTo(di, hn::IfThenElseZero(live, column)), di, columns);
      hn::StoreU(hn::ConvertTo(di, hn::IfThenElseZero(live, row)), di, rows);
      hn::StoreU(hn::ConvertTo(di, hn::IfThenElseZero(live, slice)), di, slices);
      const auto taps = [&](int n) HWY_ATTR {
        return fourTaps(field.cells + size_t(slices[n]) * field.slice_stride + size_t(rows[n]) * field.row_stride + size_t(columns[n]), field.row_stride);
      };
      const auto value = bilinear(taps(0), taps(1), taps(2), taps(3), hn::Sub(at_a, column), hn::Sub(at_b, row));
      sum = hn::Add(sum, hn::IfThenElseZero(live, hn::Mul(hn::Max(hn::Sub(far, near), zero), value)));
      slice = hn::Add(slice, sense);
    }
    hn::StoreU(sum, d, inside + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(AddSlice);
HWY_EXPORT(LookUpPrefix);
HWY_EXPORT(LookUpSum);
HWY_EXPORT(AddSenses);
HWY_EXPORT(MarchSlices);

void addSlice(const SliceView& slice, const SliceShift& shift, const ShearedPlanes& planes, std::span<float> scratch_row) {
  HWY_DYNAMIC_DISPATCH(AddSlice)(slice, shift, planes, scratch_row.data());
}
void lookUpPrefix(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* prefix) {
  HWY_DYNAMIC_DISPATCH(LookUpPrefix)(points, shear, planes, prefix);
}
void lookUpSum(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* sum) {
  HWY_DYNAMIC_DISPATCH(LookUpSum)(points, shear, planes, sum);
}
void addSenses(const float* from, const float* at, const float* to, float scale, Vec3 direction, const MeanSums& sums, size_t count) {
  HWY_DYNAMIC_DISPATCH(AddSenses)(from, at, to, scale, direction, sums, count);
}
void marchSlices(const MarchedField& field, const MarchedRays& rays, float* inside) {
  HWY_DYNAMIC_DISPATCH(MarchSlices)(field, rays, inside);
}

}  // namespace cloudbake
#endif
