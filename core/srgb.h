// The transfer function of sRGB.
#pragma once

#include "core/portable_math.h"

namespace cloudbake {

/// The linear value of an encoded one (IEC 61966-2-1). Values below 0 and above 1 continue the curve.
inline float linearOfSrgb(float encoded) { return encoded <= 0.04045F ? encoded / 12.92F : portablePow((encoded + 0.055F) / 1.055F, 2.4F); }

/// The encoded value of a linear one that is not below 0.
inline float srgbOfLinear(float linear) { return linear <= 0.0031308F ? 12.92F * linear : 1.055F * portablePow(linear, 1 / 2.4F) - 0.055F; }

}  // namespace cloudbake
