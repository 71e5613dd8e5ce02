// The sky behind a cloud: a gradient that depends on the sun's height, a bright line at the horizon, a sun disc and a moon.
#pragma once

#include <optional>

#include "core/image.h"
#include "core/types.h"
#include "preview/camera.h"

namespace cloudbake {

/// The colours of one hour, linear. The first three paint the sky, the last three light clouds.
struct SkyColors {
  Vec3 zenith, horizon, ground;
  Vec3 sun_color, ambient_sky, ambient_ground;
};

/// Colours for a sun of this height (the sine of its elevation): night below −0.2, dawn about 0, day from 0.35 up, mixed between.
SkyColors skyColorsForSun(float sun_height);

/// The heights between which skyColorsForSun mixes, rising, and 1, the height of a sun overhead. 0 is among them.
std::vector<float> skyHours();

/// The same sky over a ground that it lights, with the light that the two send to clouds: ambient_sky is the mean of the sky over the upper
/// hemisphere, by the cosine, half way to the grey of the same luminance; ground and ambient_ground reflect it and the sun.
SkyColors withAmbientOfSky(SkyColors colors, float sun_height);

/// m = saturate(max(0, l·v)^exponent · gain): 1 inside the angle arccos(gain^(−1/exponent)), then a soft rim.
struct DiscSettings {
  float exponent = 1000;  ///< a: how sharp the rim is, ≥ 1
  float gain = 250;       ///< b: how large the disc is, ≥ 0; 0 = no disc. The radius is √(2·ln(b)/a)
};

/// The published disc has a radius of 6 degrees. The default of our pictures is half as large, because the large disc looks like a second
/// cloud beside a cloud that fills the view.
constexpr DiscSettings kPublishedDisc{}, kSmallDisc{4000, 250};

/// r = √(max((1 − l·v)/2 − radius/100, a/10⁴)), colour = (b·sun_color/r)²: a plateau that falls off over the whole sky.
struct SmoothDiscSettings {
  float radius = 0.05F;  ///< ≥ 0; the plateau ends at the angle 2·arcsin(√(radius/100 + a/10⁴)): 3 degrees
  float softness = 2;    ///< a, > 0
  float gain = 0.06F;    ///< b, ≥ 0
};

enum class SunDisc { kSimple, kSmooth };

/// A moon with its own picture on a simple disc.
struct MoonSettings {
  Vec3 direction{0, 0.70710678F, -0.70710678F};  ///< unit, towards the moon
  Vec3 up{0, 1, 0};                              ///< top of its picture, made perpendicular to the direction; not parallel to it
  DiscSettings disc{13000, 1e8F};                ///< radius 3 degrees; the rim is sharper than the sun's. gain > 1/2
  Vec3 color{0.9F, 0.93F, 1};                    ///< of a full moon's brightest ground, linear
  float phase_degrees = 0;                       ///< 0 = full, 90 = half, 180 = new
};

struct SkySettings {
  Vec3 to_sun{0.5F, 0.5F, 0.70710678F};  ///< unit; default: azimuth 35.3, elevation 30
  SkyColors colors = skyColorsForSun(0.5F);
  SunDisc sun_disc = SunDisc::kSimple;
  DiscSettings disc = kSmallDisc;  ///< of SunDisc::kSimple
  float glow = 0.25F;              ///< kSimple: strength of the wide glow around the sun, of the sun's colour, ≥ 0
  SmoothDiscSettings smooth_disc;  ///< of SunDisc::kSmooth, which includes its glow
  std::optional<MoonSettings> moon;
  float horizon_exponent = 8;  ///< e: how thin the bright line is, 4 … 50
  float viewer_height = 0;     ///< in radii of the planet, ≥ 0: the horizon is arccos(1/(1+height)) below level
};

/// The disc's mask, 0 … 1. Unit vectors.
float discMask(Vec3 view, Vec3 towards, const DiscSettings& settings);

/// The smooth disc's colour, finite. Unit vectors.
Vec3 smoothDiscColor(Vec3 view, Vec3 to_sun, Vec3 sun_color, const SmoothDiscSettings& settings);

/// Where a view meets the moon's picture: u along its up, v along direction × up, the disc's rim (mask 1/2) on the circle of radius
/// 1/2 around (1/2, 1/2). Not clamped. None for the half of all views that faces away, where the formula repeats.
std::optional<Vec2> moonUv(Vec3 view, const MoonSettings& settings);

/// How bright the moon's ground is at a point of its picture, 0 … 1: plains, craters and the shadow of the phase. Beyond the circle of
/// radius 1/2 the rim continues.
float moonBrightness(Vec2 uv, float phase_degrees);

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
