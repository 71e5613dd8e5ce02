// The noises of preview/backdrop/noise.h at many points at once: the same bits, on every CPU.
#pragma once

#include <cstddef>

#include "preview/backdrop/noise.h"

namespace cloudbake {

/// fbmValueOnly2 of `count` points, without a period.
void fbmValues2(const float* x, const float* y, size_t count, const FbmSettings& settings, float* value);

/// fbmValueOnly3 of `count` points, without a period. A value that is not under its limit may differ from that of fbmValueOnly3; it is not
/// under the limit there either.
void fbmValues3(const float* x, const float* y, const float* z, const float* limit, size_t count, const FbmSettings& settings,
                float* value);

/// The gradients of fbmGradient2 at `count` points. |x|, |y| < 2^20 / 2^octaves if there is a period.
void fbmGradients2(const float* x, const float* y, size_t count, const FbmSettings& settings, float* slope_x, float* slope_y);

}  // namespace cloudbake
