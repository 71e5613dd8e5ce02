// The sky behind a cloud: a gradient keyed by the sun's height, a bright line at the horizon, a sun disc.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// The colours of one hour, linear. The first three paint the sky, the last three light clouds.
struct SkyColors {
  Vec3 zenith, horizon, ground;
  Vec3 sun_color, ambient_sky, ambient_ground;
};

/// Colours for a sun of this height (the sine of its elevation): night below −0.2, dawn about 0, day from 0.35 up, mixed between.
SkyColors skyColorsForSun(float sun_height);

struct SkySettings {
  Vec3 to_sun{0.5F, 0.5F, 0.70710678F};  ///< unit; default: azimuth 35.3, elevation 30
  SkyColors colors = skyColorsForSun(0.5F);
  float disc_exponent = 4000;  ///< a: how sharp the sun disc's rim is, ≥ 1
  float disc_gain = 250;       ///< b: how large the disc is, ≥ 0; 0 = no disc. The disc's radius is √(2·ln(b)/a): 3 degrees
  float glow = 0.25F;          ///< strength of the wide glow around the sun, of the sun's colour, ≥ 0
  float horizon_exponent = 8;  ///< e: how thin the bright line is, 4 … 50
  float viewer_height = 0;     ///< in radii of the planet, ≥ 0: the horizon sinks below level by arccos(1/(1+height))
};

/// The sky in a direction, linear and finite. `view` is unit length; directions below the horizon see hazy ground.
Vec3 skyColor(Vec3 view, const SkySettings& settings);

}  // namespace cloudbake
