// Two kinds of noise clouds that are marched along the view: one by a field that is used as a distance, one by summing a density.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/keys.h"
#include "core/types.h"
#include "preview/backdrop/sample_sum.h"
#include "preview/backdrop/sky.h"
#include "preview/camera.h"
#include "preview/layer.h"
#include "preview/light_passage.h"

namespace cloudbake {

/// Composites samples from front to back: at most `samples` of them, and none after the opacity has exceeded `stop_opacity`. The colour is
/// the sum divided by the opacity, and the distance is the mean of t weighted by what each sample adds. Empty if no sample has an opacity.
LayerPixel accumulateSamples(float t, int samples, float stop_opacity, const std::function<CloudSample(float)>& sample);

/// The distance-like field. Lengths are in the method's own units: p, t and heights are world units / scale.
struct DistanceCloudSettings {
  float scale = 1;         ///< world units per unit of the method, > 0
  float cloud_height = 8;  ///< world y / scale of the densest plane
  float flatness = 0.06F;  ///< h: added to the field per unit of height above or below it, ≥ 0; the layer is 0.4/h thick each way
  float noise_frequency = 0.4F, noise_offset = 0.4F;  ///< field = |y − cloud_height|·h + fbm(0.4 p) − 0.4; frequency > 0
  int octaves = 5;                                    ///< of the fbm, 1 … 8
  uint32_t seed = 0;
  Vec3 wind;  ///< that moves the noise, units per second
  double time_seconds = 0;

  float first_step = 1, step_factor = 0.8F;  ///< of the search for the cloud; > 0
  float contact = 0.1F;                      ///< |step| below which it ends, > 0
  float search_farthest = 70;                ///< t beyond which it ends without a contact, > 0
  int search_steps = 512;                    ///< ≥ 1; a search that uses them up is in contact where it ends
  float step_back = 5;                       ///< from the contact to the first sample, ≥ 0

  float farthest = 70;                                           ///< MAXT: t beyond which there are no samples, > 0
  int samples = 128;                                             ///< ≥ 1
  float least_step = 0.4F;                                       ///< > 0
  float step_base = 2, step_density = 30, step_growth = 0.011F;  ///< step = max(0.4, (2 − 30 den)·t·0.011)
  Vec3 thin_color{0.8F, 0.75F, 0.85F}, dense_color;              ///< linear, mixed by the density
  float shadow_start = 0.2F;                                     ///< the shadow is full at the density 0.2 + 0.05 m towards the light, > 0
  float shadow_slope = 0.05F, shadow_tuning = 0;                 ///< 0.05 and m
  float shadow_distance = 1;                                     ///< of the place towards the light, units
  float shadow_range = 0.85F, shadow_floor = 0.15F;              ///< of colour and opacity: ss·0.85 + 0.15
  float opacity_factor = 0.9F;                                   ///< 0 … 1
  float stop_opacity = 0.99F;                                    ///< 0 … 1
  float fade_start = 0.5F;   ///< fraction of `farthest` from which samples fade out, 0 … 1; 1 = an edge
  Vec3 tint{1, 1, 1};        ///< of the hour: multiplies all colours, ≥ 0
  float dither = 1;          ///< of a step by which the first sample is moved at random, 0 … 1
  int samples_per_side = 1;  ///< n·n samples per pixel, ≥ 1
};
/// Its keys in a scene file.
const Keys<DistanceCloudSettings>& distanceCloudKeys();

/// The constants of the source where ours differ: an edge at `farthest`, and no dither.
DistanceCloudSettings publishedDistanceClouds();

/// The field at a point, units. Beyond 2^20 units of the noise the noise counts as 1, which is clear.
float distanceCloudField(Vec3 p, const DistanceCloudSettings& settings);

/// clamp(−field, 0, 1).
float distanceCloudDensity(Vec3 p, const DistanceCloudSettings& settings);

/// Where the samples begin: t += step from `start`, first `first_step`, then step_factor·field(t), until |step| < contact; then t minus
/// `step_back`, at least 0. Infinite if t exceeds `search_farthest`.
float findDistanceCloud(const std::function<float(float)>& field, float start, const DistanceCloudSettings& settings);

/// A sample at t, from the densities there and one unit towards the light.
CloudSample distanceCloudSample(float t, float density, float density_to_light, const DistanceCloudSettings& settings);

/// The clouds as a camera sees them. The distance is the mean, weighted by what each sample adds. Of the sky only the direction to
/// its key light is used. Throws std::invalid_argument if a setting is out of its range.
Layer renderDistanceClouds(const Camera& camera, const SkySettings& sky, const DistanceCloudSettings& settings = {});
/// The same, cut where the surfaces of other layers are: the part before the first of them, the part between, the part behind the last one.
/// What an opaque surface hides is left out. The parts over each other are the whole. `shadow`:
/// of other things on their samples.
std::vector<Layer> renderDistanceClouds(const Camera& camera, const SkySettings& sky, const DistanceCloudSettings& settings,
                                        std::span<const Layer> surfaces, const MarchedShadow& shadow = {});

/// The light that comes through the clouds to points from a direction: as much as an eye there would see.
void passDistanceClouds(std::span<const Vec3> points, Vec3 to_light, const DistanceCloudSettings& settings, std::span<float> shares);

/// The summed density: a deck of clouds with openings. Lengths are in the method's own units: p, t and heights are world units / scale.
struct DensityCloudSettings {
  float scale = 1;                ///< world units per unit of the method, > 0
  float cloud_height = 10.8F;     ///< world y / scale of the densest plane
  float flatness = 0.15F;         ///< subtracted from the density per unit of height above or below it, ≥ 0
  float noise_strength = 1.75F;   ///< d = clamp(1 − 0.15 |10.8 − y| − 1.75 fbm(0.15 p), 0, 1); ≥ 0
  float noise_contrast = 3.5F;    ///< of the fbm about its mean: clamp(1/2 + 3.5 (mean of octaves − 1/2), 0, 1); ≥ 0, 1 = no change
  float noise_frequency = 0.15F;  ///< > 0
  int octaves = 5;                ///< of the fbm, 1 … 8
  uint32_t seed = 0;
  Vec3 wind;  ///< that moves the noise, units per second
  double time_seconds = 0;

  Vec3 thin_color{0.8F, 0.76F, 0.72F}, dense_color{0.12F, 0.12F, 0.12F};  ///< linear: 0.8 (1, 0.95, 0.9) and 0.2 (0.6, 0.6, 0.6)
  float color_factor = 1.45F;                                             ///< of both
  Vec3 glow_color{1, 0.7F, 0.4F};                                         ///< linear; + 0.3 glow max(0, v·l)^6 (1 − d)
  float glow_strength = 0.3F, glow_exponent = 6;                          ///< ≥ 0
  Vec3 tint{1, 1, 1};                                                     ///< of the hour: multiplies all colours, ≥ 0
  float fade_density = 0.0005F;                                           ///< of the fade to the sky, 1 − exp(−0.0005 t²); ≥ 0
  float opacity_factor = 0.9F;                                            ///< 0 … 1
  float first_t = 0.1F, least_step = 0.1F, step_growth = 0.3F;            ///< step = max(0.1, 0.3 t); > 0
  int samples = 64;                                                       ///< ≥ 1
  float stop_opacity = 0.99F;                                             ///< 0 … 1

  /// A step is divided into at most `parts` parts of at least `part_length`, each with the opacity 1 − (1 − a)^(1/parts), so that a
  /// homogeneous cloud does not change. With parts = 1 the samples are those published, which are too far apart for clouds of this size.
  int parts = 16;            ///< ≥ 1
  float part_length = 0.4F;  ///< units, > 0
  float dither = 1;          ///< of part_length by which the first sample is moved at random, 0 … 1
  int samples_per_side = 1;  ///< n·n samples per pixel, ≥ 1
};
/// Its keys in a scene file.
const Keys<DensityCloudSettings>& densityCloudKeys();

/// The constants of the source where ours differ: the noise as it is, thinner and darker clouds that fade sooner, which are a grey haze
/// under our sky, steps that are not divided, and no dither.
DensityCloudSettings publishedDensityClouds();

/// d at a point, units. Beyond 2^20 units of the noise it is 0.
float densityCloudDensity(Vec3 p, const DensityCloudSettings& settings);

/// max(least_step, step_growth·t): from one published sample to the next.
float densityCloudStep(float t, const DensityCloudSettings& settings);

/// A sample of a density at t. Its step is a part of the published one. `sun_cosine` is v·l, `sky` is the colour behind.
CloudSample densityCloudSample(float t, float density, float sun_cosine, Vec3 sky, const DensityCloudSettings& settings);

/// The clouds as a camera sees them, faded to the sky of each direction. The distance is the mean, weighted by what each sample adds.
/// Throws std::invalid_argument if a setting is out of its range.
Layer renderDensityClouds(const Camera& camera, const SkySettings& sky, const DensityCloudSettings& settings = {});
/// The same, cut as renderDistanceClouds cuts.
std::vector<Layer> renderDensityClouds(const Camera& camera, const SkySettings& sky, const DensityCloudSettings& settings,
                                       std::span<const Layer> surfaces, const MarchedShadow& shadow = {});

/// As passDistanceClouds.
void passDensityClouds(std::span<const Vec3> points, Vec3 to_light, const DensityCloudSettings& settings, std::span<float> shares);

}  // namespace cloudbake
