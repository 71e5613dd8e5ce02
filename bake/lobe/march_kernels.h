// Rays through a dense field, eight at a time, in SIMD for whatever the CPU offers. Each lane is a ray of its own: all targets give the
// same bits.
#pragma once

#include <array>
#include <cstddef>

#include "bake/field/dense_field.h"
#include "bake/lobe/inside_length.h"
#include "core/types.h"

namespace cloudbake {

/// Rays in arrays of a multiple of 8; positions and unit directions on the field's lattice.
struct RayArrays {
  std::array<const float*, 3> origin, direction;
  size_t count = 0;
};

/// Inside lengths, in voxels, with the samples and rules of inside_length.h; `settings.length` in voxels. Samples that cannot change the
/// result are skipped: those outside the box of the field, and those that |φ| or the field's clearances show to have the sign of one that
/// was read.
void marchRays(const DenseField& field, const RayArrays& rays, const MarchSettings& settings, float* lengths);

}  // namespace cloudbake
