// The inner loops of the sweep, with the SIMD instructions of the CPU. Every lane is a separate cell or point, and nothing is summed
// across lanes, so all targets give the same bits.
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
  const std::array<int, 2>* spans = nullptr;  ///< per row: all cells outside the columns [first, end) are 0
};

/// Two planes over the sheared lattice: the sum of the slices so far, and behind it in memory the last slice after resampling.
struct ShearedPlanes {
  float* sum = nullptr;  ///< rows of `stride` floats
  ptrdiff_t last = 0;    ///< sum + last: the last slice
  size_t stride = 0;
};

/// Adds a slice that the shear has moved. Sheared cell (U, V) gets the bilinear value of the slice at column U + column + column_part and
/// row V + row + row_part (parts in [0, 1)), for U = −1 − column … columns − 1 − column, and V likewise. `planes.sum` points to U = V = 0.
struct SliceShift {
  int column = 0, row = 0;
  float column_part = 0, row_part = 0;
};
void addSlice(const SliceView& slice, const SliceShift& shift, const ShearedPlanes& planes, std::span<float> scratch_row);

/// Points to look up, in arrays whose length is a multiple of 8: position (a, b, c) in columns, rows and slices.
struct PointArrays {
  const float *a = nullptr, *b = nullptr, *c = nullptr;
  const float* rest = nullptr;  ///< fraction of the point's own slice that lies beyond the point
  size_t count = 0;
};

/// The line through a point has the sheared position u = a − slope_a·c, v = b − slope_b·c.
struct Shear {
  float slope_a = 0, slope_b = 0;
};

/// The sum of the slices up to each point, including part of its own slice: bilinear sum − rest · last. #count floats.
void lookUpPrefix(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* prefix);

/// The bilinear `sum` at each point's line. #count floats.
void lookUpSum(const PointArrays& points, const Shear& shear, const ShearedPlanes& planes, float* sum);

/// Σ ω ℓ² and Σ ℓ² over many directions, per point.
struct MeanSums {
  float *x = nullptr, *y = nullptr, *z = nullptr, *squares = nullptr;
};

/// Adds both senses of an axis: ℓ(ω) = (to − at)·scale, ℓ(−ω) = (at − from)·scale; `from` may be null for 0. `count` is a multiple of 8.
void addSenses(const float* from, const float* at, const float* to, float scale, Vec3 direction, const MeanSums& sums, size_t count);

/// Rays from points through the slices of `cells`, towards increasing or decreasing slices. All lengths are in cells; `count` is a multiple
/// of 8.
struct MarchedField {
  const float* cells = nullptr;
  size_t row_stride = 0, slice_stride = 0;
  int columns = 0, rows = 0, slices = 0;
};
struct MarchedRays {
  const float *a = nullptr, *b = nullptr, *c = nullptr;  ///< start
  const float *slope_a = nullptr, *slope_b = nullptr;    ///< per slice
  const float* length = nullptr;                         ///< in slices
  float sense = 1;                                       ///< +1 or −1: direction along c
  size_t count = 0;
};

/// The length of cloud along each ray, in slices. Only part of the ray's first slice counts.
void marchSlices(const MarchedField& field, const MarchedRays& rays, float* inside);

}  // namespace cloudbake
