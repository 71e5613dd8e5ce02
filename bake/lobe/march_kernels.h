// Marches rays through a dense field, eight at a time, with the SIMD instructions of the CPU. Each lane is a separate ray, so all targets
// give the same bits.
#pragma once

#include <array>
#include <cstddef>

#include "bake/field/dense_field.h"
#include "bake/lobe/inside_length.h"
#include "core/types.h"

namespace cloudbake {

/// Rays in arrays whose length is a multiple of 8, with positions and unit directions on the field's lattice.
struct RayArrays {
  std::array<const float*, 3> origin, direction;
  size_t count = 0;
};

/// Inside lengths in voxels, with the samples and rules of inside_length.h; `settings.length` is in voxels. Samples that cannot change the
/// result are skipped: those outside the field's box, and those that must have the same sign as a previous sample because of |φ| or the
/// field's clearances.
void marchRays(const DenseField& field, const RayArrays& rays, const MarchSettings& settings, float* lengths);

}  // namespace cloudbake
