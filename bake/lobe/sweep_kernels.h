// The inner loops of the sweep, in SIMD for whatever the CPU offers. Every lane is a cell or a point of its own, and nothing is summed
// across lanes: all targets give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/types.h"

namespace cloudbake {

/// One slice of cells across the swept axis. Rows may be read 16 floats past their end.
struct SliceView {
  const float* cells = nullptr;
  size_t row_stride = 0;
  int columns = 0, rows = 0;
  const std::array<int, 2>* spans = nullptr;  ///< per row, the columns [first, end) outside of which all cells are 0
};

/// Two planes over the sheared lattice: the sum of the slices so far, and behind it the last slice, as resampled.
struct ShearedPlanes {
  float* sum = nullptr;  ///< rows of `stride` floats
  ptrdiff_t last = 0;    ///< sum + last: the last slice
  size_t stride = 0;
};

/// Adds a slice that the shear has moved. Sheared cell (U, V) takes the bilinear value of the slice at column U + column + column_part, row
/// V + row + row_part (parts in [0, 1)), for U = −1 − column … columns − 1 − column and V alike; `planes.sum` points to U = V = 0.
struct SliceShift {
  int column = 0, row = 0;
  float column_part = 0, row_part = 0;
};
void addSlice(const SliceView& slice, const SliceShift& shift, const ShearedPlanes& planes, std::span<float> scratch_row);

/// Points to look up, in arrays of a multiple of 8: position (a, b, c), columns, rows and slices.
struct PointArrays {
  const float *a = nullptr, *b = nullptr, *c = nullptr;
  const float* rest = nullptr;  ///< share of the point's own slice that lies beyond it
  size_t count = 0;
};

/// The line through a point: sheared position u = a − slope_a·c, v = b − slope_b·c.
struct Shear {
  float slope_a = 0, slope_b = 0;
};

/// Sum of the slices up to each point, the own slice in part: bilinear sum − rest · last. #count floats.
void lookUpPrefix(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* prefix);

/// Bilinear `sum` at each point's line. #count floats.
void lookUpSum(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* sum);

/// Σ ω ℓ² and Σ ℓ² of many directions, one per point.
struct MeanSums {
  float *x = nullptr, *y = nullptr, *z = nullptr, *squares = nullptr;
};

/// Adds both senses of an axis: ℓ(ω) = (to − at)·scale, ℓ(−ω) = (at − from)·scale; `from` may be null for 0. `count` is a multiple of 8.
void addSenses(const float* from, const float* at, const float* to, float scale, Vec3 direction, const MeanSums& sums, size_t count);

/// A ray from each point through the slices of `cells`, towards increasing or decreasing slice. All in cells, a multiple of 8 points.
struct MarchedField {
  const float* cells = nullptr;
  size_t row_stride = 0, slice_stride = 0;
  int columns = 0, rows = 0, slices = 0;
};
struct MarchedRays {
  const float *a = nullptr, *b = nullptr, *c = nullptr;  ///< start
  const float *slope_a = nullptr, *slope_b = nullptr;    ///< per slice
  const float* length = nullptr;                         ///< slices to go
  float sense = 1;                                       ///< +1 or −1: along c
  size_t count = 0;
};

/// Slices of cloud along each ray. The own slice counts in part.
void marchSlices(const MarchedField& field, const MarchedRays& rays, float* inside);

}  // namespace cloudbake
