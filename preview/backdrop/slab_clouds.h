// Cartoon clouds in a slab of the sky: a height noise swells two surfaces around a middle plane, and the first contact of a ray determines
// its tone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/keys.h"
#include "core/types.h"
#include "preview/backdrop/noise.h"
#include "preview/backdrop/sky.h"
#include "preview/camera.h"
#include "preview/layer.h"

namespace cloudbake {

/// Linear colours; the defaults are those of full day.
struct SlabTones {
  Vec3 shadow{0.30F, 0.42F, 0.62F}, middle{0.52F, 0.63F, 0.78F}, light{0.84F, 0.87F, 0.91F};
  Vec3 highlight{1.15F, 1.10F, 1.02F};  ///< of light parts that face the viewer
  Vec3 outline{0.13F, 0.20F, 0.36F};
};
/// Its keys in a scene file.
const Keys<SlabTones>& slabToneKeys();

/// Heights are world y, whatever the camera's height.
struct SlabSettings {
  float bottom = 4, center = 4.9F, top = 7;  ///< world units, bottom < center < top
  int samples = 64;                          ///< equal steps through the slab, ≥ 1
  float dither = 1;                          ///< of a step by which the start is moved at random, 0 … 1
  int samples_per_side = 1;                  ///< n·n samples per pixel, ≥ 1

  float noise_scale = 5;             ///< world units per cell of the first octave, > 0
  int octaves = 4;                   ///< 1 … 8
  uint32_t seed = 0;                 ///< of both noises and the dither
  float threshold = 0.45F;           ///< noise below it is clear sky, < 1; a lower value gives more clouds
  float low_share = 0.5F;            ///< weight of the low noise in the mixture, 0 … 1
  float smooth_low = 0.32F;          ///< the noise is Hermite's step of the mixture, from 0 here …
  float smooth_high = 0.68F;         ///< … to 1 here; low < high
  double time_seconds = 0;           ///< moves both noises
  Vec2 high_drift{0.020F, 0.008F};   ///< of the noise read at (x, z), cells per second
  Vec2 low_drift{-0.006F, -0.012F};  ///< of the noise read at (z, x), cells per second along z and x
  float edge_width = 0.15F;          ///< of the soft skin outside the surfaces, world units, > 0
  float opaque_widths = 2;           ///< a path that rises by so many edge widths is opaque, > 0
  float least_den = 1e-4F;           ///< den is in least_den … 1; > 0

  SlabTones tones;
  float shadow_limit = 0.33F, middle_limit = 0.66F;  ///< below these values of den a contact has the shadow's or the middle's tone
  float tone_softness = 0.02F;                       ///< half width in den over which two tones are mixed, ≥ 0; 0 = a hard edge
  float bright = 1;                                  ///< weight of the highlight on parts that face the viewer, ≥ 0
  float self_shadow = 0.85F;                         ///< s and g of the factor lerp(1, s, g·den²)
  float self_shadow_gain = 0.5F;
  float outline_strength = 0.3F;                  ///< 0 … 1
  float outline_start = 0.15F, outline_full = 1;  ///< gradient of the opacity, per degree of view, where the outline begins and is full
  float horizon_start = 0.05F, horizon_gain = 5;  ///< a and b of the fade clamp((v.y − a)·b, 0, 1); a ≥ 0, b > 0

  float day_luminance = 0.17F;  ///< for slabNightFactor: of the sky's colours, above which it is day, > 0
  float night_light = 0.005F;   ///< for slabNightFactor: under a black sky, 0 … 1
};
/// Its keys in a scene file.
const Keys<SlabSettings>& slabKeys();

/// The constants of the source where ours differ: hard edges between tones, and the highlight's colour is that of the light.
SlabSettings publishedSlab();

/// Height noise above a place of the ground, 0 … 1, and its derivatives by x and z, per world unit. It is 0 beyond 2^20 cells from the
/// origin, where float has no precision left.
Noise2 slabNoise(float x, float z, const SlabSettings& settings);

/// The heights of the cloud above a place, world y. There is no cloud if lower ≥ upper, which is where the noise is at most `threshold`.
struct SlabProfile {
  float lower = 0, upper = 0;
};
SlabProfile slabProfile(float noise, const SlabSettings& settings);

/// What a step of this length adds to the thickness at a height: min(step, upper − lower) inside, and outside a smooth fraction of it that
/// is 0 from `edge_width` on.
float slabThickening(float y, float step, const SlabProfile& profile, float edge_width);

/// clamp(thickness/(opaque_widths·edge_width/view_y), 0, 1). view_y > 0 is the sine of the view's elevation.
float slabOpacity(float thickness, float view_y, const SlabSettings& settings);

/// (upper − y)/(top − bottom), in [least_den, 1].
float slabDen(float y, float upper, const SlabSettings& settings);

/// Colour without outline. `facing` is the cosine between the normal and the way to the viewer; below 0 it counts as 0.
Vec3 slabTone(float den, float facing, const SlabSettings& settings);

/// 0 where the opacity changes slowly, 1 at an outline. The gradient is per degree of view.
float slabEdge(float opacity_gradient, const SlabSettings& settings);

/// clamp((view_y − horizon_start)·horizon_gain, 0, 1).
float slabHorizonFade(float view_y, const SlabSettings& settings);

/// The source's brightness of tones that do not follow the light of the hour, night_light … 1, by the luminance of the mean of the sky's
/// zenith and horizon.
float slabNightFactor(const SkyColors& colors, const SlabSettings& settings);

/// The result of one ray.
struct SlabHit {
  float thickness = 0;  ///< world units; 0: the ray meets nothing, and the other members have no meaning
  float opacity = 0;    ///< without the horizon's fade
  float den = 0, facing = 0;
  float distance = INFINITY;  ///< along the ray to the first contact, world units
};

/// `jitter`, 0 … 1, moves the start by that fraction of a step. Rays that do not rise meet nothing. The direction is a unit vector.
SlabHit marchSlab(const Ray& ray, float jitter, const SlabSettings& settings);

/// The light that comes through the clouds to points from a direction: as much as an eye there would see.
void passSlab(std::span<const Vec3> points, Vec3 to_light, const SlabSettings& settings, std::span<float> shares);

/// The clouds as a camera sees them. The opacity includes the horizon's fade, and the distance is to the first contact. Throws
/// std::invalid_argument if a setting is out of its range.
Layer renderSlabClouds(const Camera& camera, const SlabSettings& settings = {});
/// The same, cut where the surfaces of other layers are: the part before the first of them, the part between, the part behind the last one.
/// The parts over each other are the whole. A part has the tone of its own first contact, which may be the cut, and the outlines of the
/// whole.
std::vector<Layer> renderSlabClouds(const Camera& camera, const SlabSettings& settings, std::span<const Layer> surfaces);

}  // namespace cloudbake
