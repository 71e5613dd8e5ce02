// "Procedural Stylized Sky 1" (tajourney) keys the colours of the sky by the sun's height; here each key is a row of a picture.
#include "preview/backdrop/sky_strip.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "preview/shading_math.h"

namespace cloudbake {

SkyRamp rampOfStrip(const Image& picture, const SkyStrip& strip) {
  requireInRange(skyStripKeys(), strip);
  if (!(strip.low_degrees < strip.high_degrees)) throw std::invalid_argument("rampOfStrip: the elevations do not rise");
  if (picture.width < strip.columns || picture.height < 1) throw std::invalid_argument("rampOfStrip: the picture has too few pixels");
  constexpr Vec3 SkyColors::*kColumns[]{&SkyColors::zenith,    &SkyColors::low_sky,     &SkyColors::horizon,       &SkyColors::ground,
                                        &SkyColors::sun_color, &SkyColors::ambient_sky, &SkyColors::ambient_ground};
  SkyRamp ramp{{}, strip.columns > 3, strip.columns > 5, strip.columns > 6};
  const int hours = std::min(picture.height, kMostStripHours);
  for (int i = 0; i < hours; ++i) {
    const double share = hours > 1 ? double(i) / (hours - 1) : 0;
    const auto height = float(std::sin((strip.low_degrees + share * (double(strip.high_degrees) - strip.low_degrees)) * kPi / 180));
    const auto row = float((1 - share) * (picture.height - 1));
    const int above = int(row), below = std::min(above + 1, picture.height - 1);
    SkyHour hour{height, skyColorsForSun(height)};
    for (int c = 0; c < strip.columns; ++c) {
      const int x = (2 * c + 1) * picture.width / (2 * strip.columns);
      hour.colors.*kColumns[c] = lerp(picture.at(x, above), picture.at(x, below), row - float(above)) * strip.gain;
    }
    ramp.hours.push_back(hour);
  }
  return ramp;
}

// --- Keys ---

const Keys<SkyStrip>& skyStripKeys() {
  using S = SkyStrip;
  constexpr const char* kWhy = "the page has a table of the colours by the sun's height";
  static const Keys<S> keys{
      {"ramp_low", &S::low_degrees, -90, 90, "elevation of the sun of the bottom row of the ramp, degrees", KeyUse::kScript, kWhy},
      {"ramp_high", &S::high_degrees, -90, 90, "elevation of the sun of the top row, degrees", KeyUse::kScript, kWhy},
      {"ramp_columns", &S::columns, 1, 7,
       "columns of the ramp, from left to right: zenith, low_sky, horizon, ground, sun, ambient_sky, ambient_ground", KeyUse::kScript,
       kWhy},
      {"ramp_gain", &S::gain, 0, kBright, "factor of the ramp's linear colours", KeyUse::kScript, kWhy},
  };
  return keys;
}

}  // namespace cloudbake
