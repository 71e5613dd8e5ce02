// The sky behind a cloud: a gradient that depends on the sun's height, a line at the horizon, a sun disc, a moon, stars and an aurora; and
// the light that it sends to clouds.
#pragma once

#include <optional>
#include <vector>

#include "core/image.h"
#include "core/keys.h"
#include "core/types.h"
#include "preview/backdrop/aurora.h"
#include "preview/backdrop/disc.h"
#include "preview/backdrop/moon.h"
#include "preview/backdrop/stars.h"
#include "preview/camera.h"

namespace cloudbake {

/// The colours of one hour, linear. Those of zenith, horizon, ground and low sky paint the sky, the others light clouds.
struct SkyColors {
  Vec3 zenith, horizon, ground;
  Vec3 sun_color, ambient_sky, ambient_ground;
  Vec3 low_sky;  ///< where the gradient begins, above the line at the horizon
};
/// Its keys in a scene file.
const Keys<SkyColors>& colorKeys();

/// The colours at a sun's height, which is the sine of its elevation.
struct SkyHour {
  float sun_height = 0;
  SkyColors colors;
};

/// Colours by the sun's height, mixed between the hours. Below the first and above the last one they stay the same.
struct SkyRamp {
  std::vector<SkyHour> hours;  ///< heights rising, at least one
  /// Which of the colours that withAmbientOfSky computes are the hours' own instead.
  bool own_ground = false, own_ambient_sky = false, own_ambient_ground = false;
};

/// Hours that scripts/sky_ramps made of a published atmosphere (sky_hours.h), with ground and ambient light of their own.
const SkyRamp& defaultSkyRamp();

SkyColors skyColorsForSun(float sun_height, const SkyRamp& ramp = defaultSkyRamp());

/// The heights between which skyColorsForSun mixes, rising, with 0 and with 1, the height of a sun overhead.
std::vector<float> skyHours(const SkyRamp& ramp = defaultSkyRamp());

/// The same sky over a ground that it lights, with the light that the two send to clouds: ambient_sky is the mean of the sky over the upper
/// hemisphere, by the cosine, half way to the grey of the same luminance; ground and ambient_ground reflect it and the sun.
SkyColors withAmbientOfSky(SkyColors colors, float sun_height);

struct SkySettings {
  Vec3 to_sun{0.5F, 0.5F, 0.70710678F};  ///< unit; default: azimuth 35.3, elevation 30
  SkyRamp ramp = defaultSkyRamp();
  SkyColors colors = skyColorsForSun(0.5F);  ///< of this hour
  DiscKind sun_disc = DiscKind::kSimple;
  DiscSettings disc = kSmallDisc;  ///< of DiscKind::kSimple
  float glow = 0.12F;              ///< kSimple: strength of the wide glow around the sun, of the sun's colour, ≥ 0
  SmoothDiscSettings smooth_disc;  ///< of DiscKind::kSmooth, which includes its glow
  std::optional<MoonSettings> moon;
  std::optional<StarSettings> stars;
  std::optional<AuroraSettings> aurora;
  float horizon_exponent = 24;        ///< e: how thin the line is, 4 … 50
  std::optional<Vec3> horizon_color;  ///< of the line, linear; unset: that of the horizon
  float horizon_strength = 1;         ///< how much of that colour the line has, 0 … 1
  float viewer_height = 0;            ///< in radii of the planet, ≥ 0: the horizon is arccos(1/(1+height)) below level
};
/// Its keys in a scene file.
const Keys<SkySettings>& skyKeys();
const Keys<DiscSettings>& sunDiscKeys();

/// The sky of the sources where ours differs: the larger disc.
SkySettings publishedSky();

/// The light that clouds and ground receive from one direction.
struct KeyLight {
  Vec3 direction;  ///< unit, towards it; never from below the horizon that the viewer sees
  Vec3 color;      ///< linear
};

/// Elevations of the sun above the horizon that the viewer sees, degrees. From kFullLight down to kLastLight the light of sun and twilight
/// fades evenly, as toneMap shows it. From there to kMoonLight the moon's grows, if there is a moon. A moon that is brighter than a natural
/// one takes over earlier.
inline constexpr float kFullLight = 6, kLastLight = -17, kMoonLight = -22;

/// The sun's light; as the sun sinks, that of the twilight where it has set; at night the moon's. No light is left where they change.
KeyLight keyLight(const SkySettings& sky);

/// The colours of the hour with the key light's in place of the sun's: what lights clouds. It is at least the ambient light from the
/// ground, which less light would darken where a cloud faces it (cloudColor).
SkyColors lightColors(const SkySettings& sky);

/// h = saturate(1 − |y|)^exponent; y is the height of the view (its sine) above the horizon, which is arccos(1/(1 + viewer_height))
/// below level.
float horizonLine(float view_y, float exponent, float viewer_height);

/// The sky in a direction, linear and finite. `view` is unit length; directions below the horizon see hazy ground.
Vec3 skyColor(Vec3 view, const SkySettings& settings);

/// Which pixels have all samples: every one, or those whose centre differs from a neighbour's by more than a 256th; the others have one.
enum class SkySampling { kEverywhere, kAtEdges };

/// The sky as a camera sees it, n·n samples per pixel.
Image renderSky(const Camera& camera, const SkySettings& settings, int samples_per_side, SkySampling sampling = SkySampling::kEverywhere);

}  // namespace cloudbake
