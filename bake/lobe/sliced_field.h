// A coverage field as slices across each axis, and points sorted by slice. The sweep and its rays use both.
#pragma once

#include <span>
#include <vector>

#include "bake/lobe/sweep_kernels.h"
#include "core/parallel.h"
#include "core/types.h"

namespace cloudbake {

/// Arrays of points are padded to a multiple of this.
constexpr size_t kSweepLanes = 8;

/// The field as slices across one axis. Positions are (a, b, c) = (column, row, slice), in cells. Neighbouring columns are adjacent in
/// memory.
struct SlicedField {
  std::array<size_t, 3> axes{};  ///< the axes of a, b, c: 0, 1, 2 = x, y, z
  std::array<int, 3> cells{};    ///< number of cells along a, b, c
  size_t row_stride = 0, slice_stride = 0;
  const float* values = nullptr;          ///< owned by SlicedFields
  std::vector<std::array<int, 2>> spans;  ///< #slices × #rows: a row is 0 outside the columns [first, end)
  SliceView slice(int index) const {
    return {values + size_t(index) * slice_stride, row_stride, cells[0], cells[1], spans.data() + size_t(index) * size_t(cells[1])};
  }
};

/// Slices of the fractions across x, y and z. The values are sharpened against the blur of cells and taps, so they can be negative or above
/// 1 next to the surface.
struct SlicedFields {
  std::vector<float> along_x, along_z;  ///< the same values in two memory orders, padded for vectors that read past the end
  std::array<SlicedField, 3> across;
};
SlicedFields slicedFields(const CoverageField& field);

/// A field in the forms that sweeps read, for any number of sweeps. It refers to the field. A function that takes one can also be given the
/// field itself; then the forms are made for that call alone.
struct SweepField {
  SweepField(const CoverageField& field)  // not explicit: see above
      : coverage(field), sliced(slicedFields(field)) {}
  SweepField(const SweepField&) = delete;
  SweepField& operator=(const SweepField&) = delete;
  const CoverageField& coverage;
  SlicedFields sliced;
};

/// Points in the order of their slices. Each slice is padded to a multiple of kSweepLanes.
struct SortedPoints {
  static constexpr uint32_t kNobody = UINT32_MAX;
  std::vector<uint32_t> source;      ///< index of the point; kNobody for padding
  std::vector<float> a, b, c, rest;  ///< as in PointArrays
  std::vector<size_t> first;         ///< #slices + 1 offsets
  size_t size() const { return source.size(); }
  PointArrays range(size_t begin, size_t end) const {
    return {a.data() + begin, b.data() + begin, c.data() + begin, rest.data() + begin, end - begin};
  }
};

/// Sorts points by the slice of c + shift. A point before the first slice counts none of it; a point beyond the last slice counts all of
/// it.
SortedPoints sortedPoints(std::span<const Vec3> cell_positions, const SlicedField& field, float shift);

/// The positions in cells of the field. Positions outside its inner box are moved to the box's border and counted in `moved`.
std::vector<Vec3> cellPositions(std::span<const Vec3> positions, const CoverageField& field, uint64_t& moved);

/// ℓ in cells, from each point along its own direction, through the same slices as a sweep.
std::vector<float> slicedLengths(std::span<const Vec3> cell_positions, std::span<const Vec3> directions, float length_cells,
                                 const SlicedFields& fields);

/// Calls body(v) for every point, in parallel blocks.
template <class Body>
void forPoints(size_t count, const Body& body) {
  parallelBlocks(count, 4096, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) body(v);
  });
}

inline float component(Vec3 v, size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
/// The axis of the largest component, by magnitude.
size_t mainAxis(Vec3 direction);

}  // namespace cloudbake
