// A coverage field as slices across each axis, and points sorted by slice: what the sweep and its rays walk through.
#pragma once

#include <tbb/parallel_for.h>

#include <span>
#include <vector>

#include "bake/lobe/sweep_kernels.h"
#include "core/types.h"

namespace cloudbake {

/// The lanes that arrays of points are padded to.
constexpr size_t kSweepLanes = 8;

/// The field as slices across one axis. Positions are (a, b, c) = columns, rows, slices, in cells; columns lie next to each other in
/// memory.
struct SlicedField {
  std::array<size_t, 3> axes{};  ///< of a, b, c: 0, 1, 2 = x, y, z
  std::array<int, 3> cells{};    ///< along a, b, c
  size_t row_stride = 0, slice_stride = 0;
  const float* values = nullptr;          ///< in SlicedFields
  std::vector<std::array<int, 2>> spans;  ///< #slices × #rows: the columns [first, end) outside of which a row is 0
  SliceView slice(int index) const {
    return {values + size_t(index) * slice_stride, row_stride, cells[0], cells[1], spans.data() + size_t(index) * size_t(cells[1])};
  }
};

/// Slices across x, y and z of the fractions, sharpened against the blur of cells and taps (negative and above 1 next to the surface).
struct SlicedFields {
  std::vector<float> along_x, along_z;  ///< the same values in two orders of memory, padded for vectors that read past the end
  std::array<SlicedField, 3> across;
};
SlicedFields slicedFields(const CoverageField& field);

/// Points in the order of their slices, each slice padded to a multiple of kSweepLanes.
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

/// Sorts by the slice of c + shift. Beyond the slices: none of the first, or all of the last.
SortedPoints sortedPoints(std::span<const Vec3> cell_positions, const SlicedField& field, float shift);

/// Positions in cells of the field. What lies outside its inner box is moved there and counted.
std::vector<Vec3> cellPositions(std::span<const Vec3> positions, const CoverageField& field, uint64_t& moved);

/// ℓ, in cells, from each point along a direction of its own, through the same slices as a sweep.
std::vector<float> slicedLengths(std::span<const Vec3> cell_positions, std::span<const Vec3> directions, float length_cells,
                                 const SlicedFields& fields);

/// body(v) for every point, in parallel blocks.
template <class Body>
void forPoints(size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 4096), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t v = range.begin(); v < range.end(); ++v) body(v);
  });
}

inline float component(Vec3 v, size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
/// The axis of the largest component, by magnitude.
size_t mainAxis(Vec3 direction);

}  // namespace cloudbake
