// A ramp of sky colours that an artist has painted: a strip with a row for each height of the sun.
#pragma once

#include "core/image.h"
#include "core/keys.h"
#include "preview/backdrop/sky.h"

namespace cloudbake {

/// What the rows and columns of a strip are. Columns are as wide as each other, from left to right the first of: zenith, low_sky, horizon,
/// ground, sun, ambient_sky, ambient_ground.
struct SkyStrip {
  float low_degrees = -18, high_degrees = 90;  ///< elevations of the sun of the bottom row and of the top row; the others are spaced evenly
  int columns = 4;                             ///< 1 … 7
  float gain = 1;                              ///< factor of the linear colours, ≥ 0
};
/// Its keys in a scene file.
const Keys<SkyStrip>& skyStripKeys();

/// The most hours of a strip: one with more rows is read, between rows, at as many heights that are spaced evenly.
inline constexpr int kMostStripHours = 64;

/// The hours of a linear picture. Colours that it has no column for are those of the default sky at the same height. Throws
/// std::invalid_argument if the picture is narrower than its columns, a setting is out of its range, or high_degrees is not above
/// low_degrees.
SkyRamp rampOfStrip(const Image& picture, const SkyStrip& strip);

}  // namespace cloudbake
