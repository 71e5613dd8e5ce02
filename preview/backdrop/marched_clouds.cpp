// nimitz, "Cloud Ten" (the distance-like field) and I. Quilez, "Clouds" (the density), both as summarised in a course note.
//   field   f(p) = |p.y − cloud_height| h + fbm(0.4 p) − 0.4,  density = clamp(−f, 0, 1)
//           search: t += s, s = 1, then 0.8 f, until |s| < 0.1; 5 units back; samples of the opacity 0.9·density·shadow
//           shadow = ss(0.2 + 0.05 m, 0, density(p + l))·0.85 + 0.15
//   density d(p) = clamp(1 − 0.15 |10.8 − p.y| − 1.6 fbm(0.15 p), 0, 1), samples of the opacity 0.5 d
// Samples are composited from front to back, with T_i = Π_{j<i} (1 − a_j):
//   opacity A = Σ T_i a_i,  colour Σ T_i a_i c_i / A,  distance Σ T_i a_i t_i / A.
// Because 0 ≤ fbm ≤ 1, both densities are 0 outside a band of heights, which is not marched.
#include "preview/backdrop/marched_clouds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/random.h"
#include "preview/backdrop/noise.h"
#include "preview/parallel_rows.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

constexpr float kLimitSlack = 1e-4F;  // for rounding, when the noise has a limit

// The noise; 1 where float has no precision left between the lattice's points. Exact if under `limit`, else some value not under it.
float noiseAt(Vec3 p, float frequency, int octaves, uint32_t seed, float limit) {
  const Vec3 place = p * frequency;
  if (!(std::abs(place.x) < kMostCells && std::abs(place.y) < kMostCells && std::abs(place.z) < kMostCells)) return 1;
  return fbmValueOnly3(place, {.octaves = octaves, .seed = seed}, limit);
}

/// The part of a ray, t ≥ 0, whose heights lie within `half` of a plane.
struct Stretch {
  float enter, leave;
};

std::optional<Stretch> stretchAbout(const Ray& ray, float height, float half) {
  const float from = height - half - ray.origin.y, to = height + half - ray.origin.y, rise = ray.direction.y;
  if (rise == 0) return from <= 0 && to >= 0 ? std::optional<Stretch>({0, INFINITY}) : std::nullopt;
  const float enter = std::max(0.0F, std::min(from / rise, to / rise)), leave = std::max(from / rise, to / rise);
  return leave >= enter && std::isfinite(enter) ? std::optional<Stretch>({enter, leave}) : std::nullopt;
}

LayerPixel meanPixel(std::span<const LayerPixel> pixels) {
  LayerPixel mean{{}, 0, 0};
  for (const LayerPixel& pixel : pixels) {
    if (pixel.opacity <= 0) continue;
    mean.color += pixel.color * pixel.opacity;
    mean.distance += pixel.distance * pixel.opacity;
    mean.opacity += pixel.opacity;
  }
  if (mean.opacity <= 0) return {};
  return {mean.color / mean.opacity, mean.opacity / float(pixels.size()), mean.distance / mean.opacity};
}

// trace(ray, jitter) is given a ray in the method's units and its own random number in [0, 1).
template <typename Trace>
Layer renderScaled(const Camera& camera, float scale, uint32_t seed, int samples_per_side, const Trace& trace) {
  const std::vector<Vec2> places = pixelPlaces(samples_per_side);
  Layer layer = blankLayer(camera.width, camera.height);
  const CameraRays rays(camera);
  forEachRow(camera.height, [&](int y) {
    std::vector<LayerPixel> pixels(places.size());
    for (int x = 0; x < camera.width; ++x) {
      const uint64_t stream = hashDraw(mix64(seed + kGolden64), uint32_t(x), uint32_t(y));
      for (size_t i = 0; i < places.size(); ++i) {
        Ray ray = rays.at(float(x) + places[i].x, float(y) + places[i].y);
        ray.origin = ray.origin / scale;
        pixels[i] = trace(ray, uniformFloat(hashDraw(stream, uint32_t(i), 0)));
        pixels[i].distance *= scale;
      }
      layer.at(x, y) = meanPixel(pixels);
    }
  });
  return layer;
}

bool isShare(float x) { return x >= 0 && x <= 1; }

void checkSettings(const DistanceCloudSettings& s) {
  const bool in_range = s.scale > 0 && std::isfinite(s.cloud_height) && s.flatness >= 0 && s.noise_frequency > 0 && s.octaves >= 1 &&
                        s.octaves <= 8 && isFinite(s.drift) && s.first_step > 0 && s.step_factor > 0 && s.contact > 0 && s.farthest > 0 &&
                        s.search_steps >= 1 && s.step_back >= 0 && s.samples >= 1 && s.least_step > 0 && isShare(s.opacity_factor) &&
                        s.shadow_start + 0.05F * s.shadow_tuning > 0 && isShare(s.stop_opacity) && isShare(s.fade_start) &&
                        isShare(s.dither) && s.samples_per_side >= 1;
  if (!in_range) throw std::invalid_argument("renderDistanceClouds: a setting is out of its range");
}

void checkSettings(const DensityCloudSettings& s) {
  const bool in_range = s.scale > 0 && std::isfinite(s.cloud_height) && s.flatness >= 0 && s.noise_strength >= 0 && s.noise_frequency > 0 &&
                        s.octaves >= 1 && s.octaves <= 8 && isFinite(s.drift) && s.glow_strength >= 0 && s.glow_exponent >= 0 &&
                        s.fade_density >= 0 && isShare(s.opacity_factor) && s.first_t > 0 && s.least_step > 0 && s.step_growth > 0 &&
                        s.samples >= 1 && isShare(s.stop_opacity) && s.parts >= 1 && s.part_length > 0 && s.noise_contrast >= 0 &&
                        isShare(s.dither) && s.samples_per_side >= 1;
  if (!in_range) throw std::invalid_argument("renderDensityClouds: a setting is out of its range");
}

LayerPixel traceDistanceCloud(const Ray& ray, Vec3 to_sun, float jitter, const DistanceCloudSettings& settings) {
  // |step| < contact requires a field below contact/step_factor, which is impossible where the height alone makes it larger.
  const float half = (settings.noise_offset + settings.contact / settings.step_factor) / settings.flatness;
  const auto stretch = stretchAbout(ray, settings.cloud_height, half);
  if (!stretch || stretch->enter > settings.farthest) return {};

  const auto at = [&](float t) { return ray.origin + ray.direction * t; };
  const float first = findDistanceCloud([&](float t) { return t > stretch->leave ? INFINITY : distanceCloudField(at(t), settings); },
                                        stretch->enter, settings);
  if (!std::isfinite(first)) return {};
  return accumulateSamples(first + jitter * settings.least_step, settings.samples, settings.stop_opacity, [&](float t) {
    const Vec3 p = at(t);
    const float density = distanceCloudDensity(p, settings);
    CloudSample sample = distanceCloudSample(t, density, density > 0 ? distanceCloudDensity(p + to_sun, settings) : 0, settings);
    if (t > stretch->leave || t > settings.farthest) sample.step = INFINITY;
    return sample;
  });
}

LayerPixel traceDensityCloud(const Ray& ray, const SkySettings& sky, float jitter, const DensityCloudSettings& settings) {
  const auto stretch = stretchAbout(ray, settings.cloud_height, 1 / settings.flatness);
  if (!stretch) return {};
  const float sun_cosine = dot(ray.direction, sky.to_sun);
  const Vec3 background = skyColor(ray.direction, sky);
  const float start = settings.first_t + jitter * settings.dither * settings.part_length;
  return accumulateSamples(start, settings.samples * settings.parts, settings.stop_opacity, [&](float t) {
    if (t > stretch->leave) return CloudSample{{}, 0, INFINITY};
    const Vec3 p = ray.origin + ray.direction * t;
    const float density = t < stretch->enter ? 0 : densityCloudDensity(p, settings);
    return densityCloudSample(t, density, sun_cosine, background, settings);
  });
}

}  // namespace

LayerPixel accumulateSamples(float t, int samples, float stop_opacity, const std::function<CloudSample(float)>& sample) {
  Vec3 color;
  float opacity = 0, distance = 0;
  for (int i = 0; i < samples && opacity <= stop_opacity && std::isfinite(t); ++i) {
    const CloudSample here = sample(t);
    const float added = (1 - opacity) * here.opacity;
    color += here.color * added;
    distance += t * added;
    opacity += added;
    t += here.step;
  }
  if (!(opacity > 0)) return {};
  return {color / opacity, std::min(opacity, 1.0F), distance / opacity};
}

float distanceCloudField(Vec3 p, const DistanceCloudSettings& settings) {
  return std::abs(p.y - settings.cloud_height) * settings.flatness +
         noiseAt(p - settings.drift, settings.noise_frequency, settings.octaves, settings.seed, INFINITY) - settings.noise_offset;
}

float distanceCloudDensity(Vec3 p, const DistanceCloudSettings& settings) {
  // The noise is not negative. So far from the plane there is no cloud for any noise, and nearer there is none where the field stays above
  // 0.
  const float layer = std::abs(p.y - settings.cloud_height) * settings.flatness, limit = settings.noise_offset - layer;
  if (limit <= 0) return 0;
  const float noise = noiseAt(p - settings.drift, settings.noise_frequency, settings.octaves, settings.seed, limit + kLimitSlack);
  return saturate(-(layer + noise - settings.noise_offset));
}

float findDistanceCloud(const std::function<float(float)>& field, float start, const DistanceCloudSettings& settings) {
  float t = start, step = settings.first_step;
  for (int i = 0; i < settings.search_steps && std::abs(step) >= settings.contact; ++i) {
    t += step;
    if (t > settings.farthest) return INFINITY;
    step = settings.step_factor * field(t);
  }
  return std::max(0.0F, t - settings.step_back);
}

CloudSample distanceCloudSample(float t, float density, float density_to_light, const DistanceCloudSettings& settings) {
  const float shadow = smoothStep(settings.shadow_start + 0.05F * settings.shadow_tuning, 0, density_to_light) * settings.shadow_range +
                       settings.shadow_floor;
  const Vec3 color = lerp(settings.thin_color, settings.dense_color, density) * shadow;
  const float near = settings.fade_start < 1 ? smoothStep(settings.farthest, settings.fade_start * settings.farthest, t) : 1;
  const Vec3 tinted = product(color, settings.tint);
  return {tinted, saturate(density * shadow * settings.opacity_factor * near),
          std::max(settings.least_step, (settings.step_base - settings.step_density * density) * t * settings.step_growth)};
}

Layer renderDistanceClouds(const Camera& camera, const SkySettings& sky, const DistanceCloudSettings& settings) {
  checkSettings(settings);
  return renderScaled(camera, settings.scale, settings.seed, settings.samples_per_side, [&](const Ray& ray, float jitter) {
    return traceDistanceCloud(ray, sky.to_sun, jitter * settings.dither, settings);
  });
}

float densityCloudDensity(Vec3 p, const DensityCloudSettings& settings) {
  const float layer = 1 - settings.flatness * std::abs(settings.cloud_height - p.y);
  if (!(layer > 0)) return 0;
  // From 1/2 + contrast (sum − 1/2) = layer/strength on there is no cloud.
  const float limit = settings.noise_strength > layer && settings.noise_contrast > 0
                          ? 0.5F + (layer / settings.noise_strength - 0.5F) / settings.noise_contrast + kLimitSlack
                          : INFINITY;
  const float sum = noiseAt(p - settings.drift, settings.noise_frequency, settings.octaves, settings.seed, limit);
  return saturate(layer - settings.noise_strength * saturate(0.5F + settings.noise_contrast * (sum - 0.5F)));
}

float densityCloudStep(float t, const DensityCloudSettings& settings) { return std::max(settings.least_step, settings.step_growth * t); }

CloudSample densityCloudSample(float t, float density, float sun_cosine, Vec3 sky, const DensityCloudSettings& settings) {
  const float whole = densityCloudStep(t, settings);
  const float parts = std::clamp(std::floor(whole / settings.part_length), 1.0F, float(settings.parts)), step = whole / parts;
  if (density <= 0) return {sky, 0, step};
  const float glow = settings.glow_strength * std::pow(std::max(0.0F, sun_cosine), settings.glow_exponent) * (1 - density);
  const Vec3 color = lerp(settings.thin_color, settings.dense_color, density) * settings.color_factor + settings.glow_color * glow;
  const Vec3 tinted = product(color, settings.tint);
  const float fade = 1 - std::exp(-settings.fade_density * t * t);
  return {lerp(tinted, sky, fade), 1 - std::pow(1 - density * settings.opacity_factor, 1 / parts), step};
}

Layer renderDensityClouds(const Camera& camera, const SkySettings& sky, const DensityCloudSettings& settings) {
  checkSettings(settings);
  return renderScaled(camera, settings.scale, settings.seed, settings.samples_per_side,
                      [&](const Ray& ray, float jitter) { return traceDensityCloud(ray, sky, jitter, settings); });
}

}  // namespace cloudbake
