// Google Highway compiles this file once per target and picks one at run time. Multiplication and addition stay separate (no FMA), and
// vectors are capped at 8 lanes. The taps of a point are two loads of two neighbouring cells each.
#include "bake/lobe/sweep_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bake/lobe/sweep_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "bake/lobe/simd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

using Pair = hn::FixedTag<float, 2>;

// A cell and its neighbour, and the same two of the next row: a block of four lanes.
HWY_INLINE hn::Vec<Block> fourTaps(const float* cell, size_t stride) {
  return hn::Combine(Block(), hn::LoadU(Pair(), cell + stride), hn::LoadU(Pair(), cell));
}
HWY_INLINE V tapsOf(const float* plane, const int32_t* cells, int n, size_t stride) {
  return pairOfBlocks([&](int point) HWY_ATTR { return fourTaps(plane + cells[point], stride); }, n);
}

// The cells of sheared positions and the positions inside them. Requires u, v ≥ the plane's first column and row.
struct Sheared {
  V part_a, part_b;
  int32_t cells[8];
};
HWY_INLINE void shearPoints(const PointArrays& points, size_t i, const Shear& shear, size_t stride, Sheared& out) {
  const Wide d;
  const WideInts di;
  const V c = hn::LoadU(d, points.c + i);
  const V u = hn::Sub(hn::LoadU(d, points.a + i), hn::Mul(hn::Set(d, shear.slope_a), c));
  const V v = hn::Sub(hn::LoadU(d, points.b + i), hn::Mul(hn::Set(d, shear.slope_b), c));
  const V column = hn::Floor(u), row = hn::Floor(v);
  out.part_a = hn::Sub(u, column);
  out.part_b = hn::Sub(v, row);
  hn::StoreU(hn::Add(hn::ConvertTo(di, column), hn::Mul(hn::ConvertTo(di, row), hn::Set(di, int32_t(stride)))), di, out.cells);
}

void AddSlice(const SliceView& slice, const SliceShift& shift, const ShearedPlanes& planes, float* scratch) {
  const Wide d;
  const size_t lanes = hn::Lanes(d);
  const auto row_part = hn::Set(d, shift.row_part), column_part = hn::Set(d, shift.column_part), zero = hn::Zero(d);
  // between[i] is column i of a row interpolated between two rows of the slice. Two zero vectors follow the last column.
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

    // Interpolate between the rows. The first and the last row are empty, so they are also used for rows beyond them.
    const float* low = slice.cells + size_t(std::max(row, 0)) * slice.row_stride;
    const float* high = slice.cells + size_t(std::min(row + 1, slice.rows - 1)) * slice.row_stride;
    between[first - 1] = 0;
    for (int i = first; i < end; i += int(lanes)) hn::StoreU(lerp(hn::LoadU(d, low + i), hn::LoadU(d, high + i), row_part), d, between + i);
    for (size_t i = 0; i < 16; i += lanes) hn::StoreU(zero, d, between + size_t(end) + i);

    // Interpolate between the columns, and write to both planes.
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
  const Wide d;
  Sheared at;
  const auto taps = [&](int n, V rest) HWY_ATTR {
    return hn::Sub(tapsOf(planes.sum, at.cells, n, planes.stride),
                   hn::Mul(rest, tapsOf(planes.sum + planes.last, at.cells, n, planes.stride)));
  };
  for (size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    shearPoints(points, i, shear, planes.stride, at);
    const V rest = hn::LoadU(d, points.rest + i);
    const V value = bilinear(taps(0, hn::Broadcast<0>(rest)), taps(1, hn::Broadcast<1>(rest)), taps(2, hn::Broadcast<2>(rest)),
                             taps(3, hn::Broadcast<3>(rest)), at.part_a, at.part_b);
    hn::StoreU(value, d, prefix + i);
  }
}

void LookUpSum(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* sum) {
  const Wide d;
  Sheared at;
  const auto taps = [&](int n) HWY_ATTR { return tapsOf(planes.sum, at.cells, n, planes.stride); };
  for (size_t i = 0; i < points.count; i += hn::Lanes(d)) {
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
  const Wide d;
  const WideInts di;
  const V half = hn::Set(d, 0.5F), zero = hn::Zero(d), sense = hn::Set(d, rays.sense);
  const V last_a = hn::Set(d, float(field.columns - 2)), last_b = hn::Set(d, float(field.rows - 2)),
          last_c = hn::Set(d, float(field.slices - 1));
  const auto row_stride = hn::Set(di, int32_t(field.row_stride)), slice_stride = hn::Set(di, int32_t(field.slice_stride));
  for (size_t i = 0; i < rays.count; i += hn::Lanes(d)) {
    const V a = hn::LoadU(d, rays.a + i), b = hn::LoadU(d, rays.b + i), c = hn::LoadU(d, rays.c + i);
    const V slope_a = hn::LoadU(d, rays.slope_a + i), slope_b = hn::LoadU(d, rays.slope_b + i), length = hn::LoadU(d, rays.length + i);
    V slice = hn::Floor(hn::Add(c, half)), sum = zero;
    for (;;) {
      // The ray reaches the middle of the slice at t and its near side half a slice earlier. A ray stops beyond the box or its own end.
      const V along = hn::Sub(slice, c), t = hn::Mul(sense, along);
      const V at_a = hn::Add(a, hn::Mul(slope_a, along)), at_b = hn::Add(b, hn::Mul(slope_b, along));
      const V near = hn::Max(hn::Sub(t, half), zero), far = hn::Min(hn::Add(t, half), length);
      const V column = hn::Floor(at_a), row = hn::Floor(at_b);
      const auto in_reach = hn::And(hn::Lt(near, length), hn::And(hn::Ge(slice, zero), hn::Le(slice, last_c)));
      const auto in_slice = hn::And(hn::And(hn::Ge(column, zero), hn::Le(column, last_a)), hn::And(hn::Ge(row, zero), hn::Le(row, last_b)));
      const auto live = hn::And(in_reach, in_slice);
      if (hn::AllFalse(d, live)) break;

      int32_t cells[8];
      const auto index = [&](V x) HWY_ATTR { return hn::ConvertTo(di, hn::IfThenElseZero(live, x)); };
      hn::StoreU(hn::Add(hn::Add(hn::Mul(index(slice), slice_stride), hn::Mul(index(row), row_stride)), index(column)), di, cells);
      const auto taps = [&](int n) HWY_ATTR { return tapsOf(field.cells, cells, n, field.row_stride); };
      const V value = bilinear(taps(0), taps(1), taps(2), taps(3), hn::Sub(at_a, column), hn::Sub(at_b, row));
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
