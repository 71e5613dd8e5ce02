// The transfer function of sRGB.
#pragma once

#include <cmath>

namespace cloudbake {

/// The linear value of an encoded one (IEC 61966-2-1). Values below 0 and above 1 continue the curve.
inline float linearOfSrgb(float encoded) { return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F); }

}  // namespace cloudbake
