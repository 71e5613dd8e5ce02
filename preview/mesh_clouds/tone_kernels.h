// The tone curve of toneMap at many values at once: the same bits on every CPU.
#pragma once

#include <cstddef>

namespace cloudbake {

/// Each value in place: the filmic curve of exposure·value, then the sRGB transfer function, in [0, 1]; NaN gives 0. Within one ulp of the
/// formulas.
void encodeTones(float* values, size_t count, float exposure);

}  // namespace cloudbake
