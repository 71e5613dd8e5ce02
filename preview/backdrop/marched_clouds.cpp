// nimitz, "Cloud Ten" (the distance-like field) and I. Quilez, "Clouds" (the density), both as summarised in a course note.
//   field   f(p) = |p.y − cloud_height| h + fbm(0.4 p) − 0.4,  density = clamp(−f, 0, 1)
//           search: t += s, s = 1, then 0.8 f, until |s| < 0.1; 5 units back; samples of the opacity 0.9·density·shadow
//           shadow = ss(0.2 + 0.05 m, 0, density(p + l))·0.85 + 0.15
//   density d(p) = clamp(1 − 0.15 |10.8 − p.y| − 1.6 fbm(0.15 p), 0, 1), samples of the opacity 0.5 d
// Because 0 ≤ fbm ≤ 1, both densities are 0 outside a band of heights, which is not marched.
#include "preview/backdrop/marched_clouds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/parallel.h"
#include "core/random.h"
#include "preview/backdrop/noise_kernels.h"
#include "preview/backdrop/sample_sum.h"
#include "preview/shading_math.h"
#include "preview/side_by_side.h"

namespace cloudbake {

namespace {

constexpr float kLimitSlack = 1e-4F;  // for rounding, when the noise has a limit

/// What a march asks for: the noise at a place, exact if under the limit, else some value not under it.
struct NoiseRequest {
  Vec3 place;  // in cells
  float limit;
};
using CloudMarch = Asking<NoiseRequest, float, CutPixels>;

template <typename Settings>
NoiseRequest noiseAt(Vec3 p, float limit, const Settings& settings) {
  return {(p - settings.wind * float(settings.time_seconds)) * settings.noise_frequency, limit};
}

bool isInLattice(Vec3 place) { return std::abs(place.x) < kMostCells && std::abs(place.y) < kMostCells && std::abs(place.z) < kMostCells; }

// The noises of many places; 1 where float has no precision left between the lattice's points.
void answerNoises(std::span<const NoiseRequest> requests, std::span<float> noises, const FbmSettings& fbm) {
  const size_t count = requests.size();
  thread_local std::vector<float> x, y, z, limits;
  for (std::vector<float>* values : {&x, &y, &z, &limits}) values->resize(count);
  for (size_t i = 0; i < count; ++i) {
    const Vec3 place = isInLattice(requests[i].place) ? requests[i].place : Vec3{};
    x[i] = place.x, y[i] = place.y, z[i] = place.z, limits[i] = requests[i].limit;
  }
  fbmValues3(x.data(), y.data(), z.data(), limits.data(), count, fbm, noises.data());
  for (size_t i = 0; i < count; ++i)
    if (!isInLattice(requests[i].place)) noises[i] = 1;
}

template <typename Settings>
FbmSettings fbmOf(const Settings& settings) {
  return {.octaves = settings.octaves, .seed = settings.seed};
}

template <typename Settings>
float noiseOf(const NoiseRequest& request, const Settings& settings) {
  float noise = 0;
  answerNoises({&request, 1}, {&noise, 1}, fbmOf(settings));
  return noise;
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

// march(ray, jitter, cuts) makes the march of a ray in the method's units; jitter is its own random share of the dither. A layer before the
// surfaces, one between them and so on.
template <typename Settings, typename March>
std::vector<Layer> renderScaled(const Camera& camera, const Settings& settings, std::span<const Layer> surfaces, const March& march) {
  constexpr int kTogether = 64;  // pixels whose rays are marched side by side
  const int n = settings.samples_per_side;
  const std::vector<Vec2> places = pixelPlaces(n);
  const FbmSettings fbm = fbmOf(settings);
  std::vector<Layer> layers(surfaces.size() + 1, blankLayer(camera.width, camera.rows(), n));
  const CameraRays rays(camera);
  const auto drawPixels = [&](int first, int end, int y) {
    std::vector<CloudMarch> marches;
    std::vector<Cuts> all_cuts;
    const int row = camera.first_row + y;
    for (int x = first; x < end; ++x) {
      const uint64_t stream = hashDraw(mix64(settings.seed + kGolden64), uint32_t(x), uint32_t(row));
      for (size_t i = 0; i < places.size(); ++i) {
        Ray ray = rays.at(float(x) + places[i].x, float(row) + places[i].y);
        ray.origin = ray.origin / settings.scale;
        Cuts cuts = cutsAt(surfaces, x, y, int(i), n);
        all_cuts.push_back(cuts);
        for (Cuts::Cut& cut : cuts.cuts) cut.distance /= settings.scale;
        marches.push_back(march(ray, settings.dither * uniformFloat(hashDraw(stream, uint32_t(i), 0)), cuts));
      }
    }
    runSideBySide(std::span(marches),
                  [&](std::span<const NoiseRequest> requests, std::span<float> noises) { answerNoises(requests, noises, fbm); });
    for (size_t part = 0; part < layers.size(); ++part) {
      LayerPixel* pixels = &layers[part].at(first, y);
      for (size_t i = 0; i < marches.size(); ++i) {
        pixels[i] = marches[i].result()[part];
        if (pixels[i].opacity > 0) pixels[i].distance = all_cuts[i].within(part, pixels[i].distance * settings.scale);
      }
    }
  };
  parallelFor(camera.rows(), [&](int y) {
    for (int x = 0; x < camera.width; x += kTogether) drawPixels(x, std::min(x + kTogether, camera.width), y);
  });
  return layers;
}

void checkSettings(const DistanceCloudSettings& s) {
  requireInRange(distanceCloudKeys(), s);
  if (!(s.shadow_start + s.shadow_slope * s.shadow_tuning > 0))
    throw std::invalid_argument("renderDistanceClouds: the shadow is full at a density of 0");
}

float fieldOf(Vec3 p, float noise, const DistanceCloudSettings& settings) {
  return std::abs(p.y - settings.cloud_height) * settings.flatness + noise - settings.noise_offset;
}

// The noise that decides about a density; none where the density is 0 for any noise, because noise is not negative. Nearer to the plane
// there is no density where the field stays above 0.
std::optional<NoiseRequest> noiseForDensity(Vec3 p, const DistanceCloudSettings& settings) {
  const float limit = settings.noise_offset - std::abs(p.y - settings.cloud_height) * settings.flatness;
  if (limit <= 0) return std::nullopt;
  return noiseAt(p, limit + kLimitSlack, settings);
}
float densityOf(Vec3 p, float noise, const DistanceCloudSettings& settings) { return saturate(-fieldOf(p, noise, settings)); }

// From 1/2 + contrast (sum − 1/2) = layer/strength on there is no cloud.
std::optional<NoiseRequest> noiseForDensity(Vec3 p, const DensityCloudSettings& settings) {
  const float layer = 1 - settings.flatness * std::abs(settings.cloud_height - p.y);
  if (!(layer > 0)) return std::nullopt;
  const float limit = settings.noise_strength > layer && settings.noise_contrast > 0
                          ? 0.5F + (layer / settings.noise_strength - 0.5F) / settings.noise_contrast + kLimitSlack
                          : INFINITY;
  return noiseAt(p, limit, settings);
}
float densityOf(Vec3 p, float noise, const DensityCloudSettings& settings) {
  const float layer = 1 - settings.flatness * std::abs(settings.cloud_height - p.y);
  return saturate(layer - settings.noise_strength * saturate(0.5F + settings.noise_contrast * (noise - 0.5F)));
}

// The density at a place from the answer to its request. Throws std::logic_error if a noise is negative, or if one that need not be exact
// makes a density.
template <typename Settings>
float densityOf(const NoiseRequest& request, Vec3 p, float noise, const Settings& settings) {
  const float density = densityOf(p, noise, settings);
  if (!(noise > -kLimitSlack) || (density > kLimitSlack && !(noise < request.limit)))
    throw std::logic_error("marched clouds: a noise that is negative, or a density of one that is not exact");
  return density;
}

template <typename Settings>
float densityAt(Vec3 p, const Settings& settings) {
  const auto request = noiseForDensity(p, settings);
  return request ? densityOf(*request, p, noiseOf(*request, settings), settings) : 0;
}

/// The search for the cloud, step by step: the field at t() is to be given to take() as long as there are more().
class Search {
 public:
  Search(float start, const DistanceCloudSettings& settings) : settings_(settings), t_(start), step_(settings.first_step) { advance(); }
  bool more() const { return more_; }
  float t() const { return t_; }
  void take(float field) {
    step_ = settings_.step_factor * field;
    advance();
  }
  /// Where the samples begin; infinite if there is no cloud.
  float first() const { return t_ > settings_.search_farthest ? INFINITY : std::max(0.0F, t_ - settings_.step_back); }

 private:
  void advance() {
    more_ = steps_++ < settings_.search_steps && std::abs(step_) >= settings_.contact;
    if (!more_) return;
    t_ += step_;
    more_ = !(t_ > settings_.search_farthest);
  }

  const DistanceCloudSettings& settings_;
  float t_, step_;
  int steps_ = 0;
  bool more_ = true;
};

CloudMarch marchDistanceCloud(Ray ray, Vec3 to_light, float jitter, Cuts cuts, Outliving<MarchedShadow> any_shadow,
                              Outliving<DistanceCloudSettings> all_settings) {
  const MarchedShadow& shadow = any_shadow;
  const DistanceCloudSettings& settings = all_settings;
  // |step| < contact requires a field below contact/step_factor, which is impossible where the height alone makes it larger.
  const float half = (settings.noise_offset + settings.contact / settings.step_factor) / settings.flatness;
  const auto stretch = stretchAbout(ray, settings.cloud_height, half);
  if (!stretch || stretch->enter > std::min({settings.search_farthest, settings.farthest, cuts.hiddenFrom()})) co_return CutPixels{};

  Search search(stretch->enter, settings);
  while (search.more()) {
    if (search.t() - settings.step_back > cuts.hiddenFrom()) co_return CutPixels{};
    float field = INFINITY;
    if (search.t() <= stretch->leave) {
      const Vec3 p = ray.origin + ray.direction * search.t();
      const float noise = co_await noiseAt(p, INFINITY, settings);
      field = fieldOf(p, noise, settings);
    }
    search.take(field);
  }
  if (!std::isfinite(search.first())) co_return CutPixels{};

  SampleSum samples(search.first() + jitter * settings.least_step, settings.samples, settings.stop_opacity, cuts);
  while (samples.more()) {
    const float t = samples.t();
    const Vec3 p = ray.origin + ray.direction * t, lit = p + to_light * settings.shadow_distance;
    float density = 0, density_to_light = 0;
    if (const auto request = noiseForDensity(p, settings)) {
      const float noise = co_await *request;
      density = densityOf(*request, p, noise, settings);
    }
    if (density > 0) {
      if (const auto request = noiseForDensity(lit, settings)) {
        const float noise = co_await *request;
        density_to_light = densityOf(*request, lit, noise, settings);
      }
    }
    CloudSample sample = distanceCloudSample(t, density, density_to_light, settings);
    if (sample.opacity > 0) sample.color = sample.color * shadow.factorAt(p * settings.scale);
    if (t > stretch->leave || t > settings.farthest) sample.step = INFINITY;
    samples.take(sample);
  }
  co_return samples.pixels();
}

/// A published step, divided.
struct DensityStep {
  float length, parts;
};
DensityStep densityStep(float t, const DensityCloudSettings& settings) {
  const float whole = densityCloudStep(t, settings);
  // The same as below without the division that the next sample would wait for.
  if (whole < 2 * settings.part_length) return {whole, 1};
  if (whole >= (float(settings.parts) + 1) * settings.part_length) return {whole / float(settings.parts), float(settings.parts)};
  const float parts = std::max(1.0F, float(int(std::min(whole / settings.part_length, float(settings.parts)))));
  return {whole / parts, parts};
}

float glowOf(float sun_cosine, const DensityCloudSettings& settings) {
  return settings.glow_strength * std::pow(std::max(0.0F, sun_cosine), settings.glow_exponent);
}

CloudSample litSample(float t, float density, const DensityStep& step, float glow, Vec3 sky, Vec3 shadow,
                      const DensityCloudSettings& settings) {
  const Vec3 color =
      lerp(settings.thin_color, settings.dense_color, density) * settings.color_factor + settings.glow_color * (glow * (1 - density));
  const Vec3 tinted = color * settings.tint * shadow;
  const float fade = 1 - std::exp(-settings.fade_density * t * t);
  return {lerp(tinted, sky, fade), 1 - std::pow(1 - density * settings.opacity_factor, 1 / step.parts), step.length};
}

CloudMarch marchDensityCloud(Ray ray, Vec3 to_light, Outliving<SkySettings> sky, float jitter, Cuts cuts,
                             Outliving<MarchedShadow> any_shadow, Outliving<DensityCloudSettings> all_settings) {
  const MarchedShadow& shadow = any_shadow;
  const DensityCloudSettings& settings = all_settings;
  const auto stretch = stretchAbout(ray, settings.cloud_height, 1 / settings.flatness);
  if (!stretch || stretch->enter > cuts.hiddenFrom()) co_return CutPixels{};
  const float glow = glowOf(dot(ray.direction, to_light), settings);
  const Vec3 background = skyColor(ray.direction, sky);
  SampleSum samples(settings.first_t + jitter * settings.part_length, settings.samples * settings.parts, settings.stop_opacity, cuts);
  while (samples.more()) {
    const float t = samples.t();
    if (t > stretch->leave) break;
    const Vec3 p = ray.origin + ray.direction * t;
    float density = 0;
    if (t >= stretch->enter) {
      if (const auto request = noiseForDensity(p, settings)) {
        const float noise = co_await *request;
        density = densityOf(*request, p, noise, settings);
      }
    }
    const DensityStep step = densityStep(t, settings);
    samples.take(density > 0 ? litSample(t, density, step, glow, background, shadow.factorAt(p * settings.scale), settings)
                             : CloudSample{background, 0, step.length});
  }
  co_return samples.pixels();
}

// march(ray) makes the march of a ray in the method's units.
template <typename Settings, typename March>
void pass(std::span<const Vec3> points, Vec3 to_light, const Settings& settings, std::span<float> shares, const March& march) {
  std::vector<CloudMarch> marches;
  for (const Vec3& point : points) marches.push_back(march(Ray{point / settings.scale, to_light}));
  const FbmSettings fbm = fbmOf(settings);
  runSideBySide(std::span(marches),
                [&](std::span<const NoiseRequest> requests, std::span<float> noises) { answerNoises(requests, noises, fbm); });
  for (size_t i = 0; i < shares.size(); ++i) shares[i] *= 1 - marches[i].result().front().opacity;
}

}  // namespace

LayerPixel accumulateSamples(float t, int samples, float stop_opacity, const std::function<CloudSample(float)>& sample) {
  SampleSum sum(t, samples, stop_opacity);
  while (sum.more()) sum.take(sample(sum.t()));
  return sum.pixels().front();
}

DistanceCloudSettings publishedDistanceClouds() {
  DistanceCloudSettings settings;
  settings.fade_start = 1;
  settings.dither = 0;
  return settings;
}

float distanceCloudField(Vec3 p, const DistanceCloudSettings& settings) {
  return fieldOf(p, noiseOf(noiseAt(p, INFINITY, settings), settings), settings);
}

float distanceCloudDensity(Vec3 p, const DistanceCloudSettings& settings) { return densityAt(p, settings); }

float findDistanceCloud(const std::function<float(float)>& field, float start, const DistanceCloudSettings& settings) {
  Search search(start, settings);
  while (search.more()) search.take(field(search.t()));
  return search.first();
}

CloudSample distanceCloudSample(float t, float density, float density_to_light, const DistanceCloudSettings& settings) {
  const float shadow =
      smoothStep(settings.shadow_start + settings.shadow_slope * settings.shadow_tuning, 0, density_to_light) * settings.shadow_range +
      settings.shadow_floor;
  const Vec3 color = lerp(settings.thin_color, settings.dense_color, density) * shadow;
  const float near = settings.fade_start < 1 ? smoothStep(settings.farthest, settings.fade_start * settings.farthest, t) : 1;
  const Vec3 tinted = color * settings.tint;
  return {tinted, saturate(density * shadow * settings.opacity_factor * near),
          std::max(settings.least_step, (settings.step_base - settings.step_density * density) * t * settings.step_growth)};
}

std::vector<Layer> renderDistanceClouds(const Camera& camera, const SkySettings& sky, const DistanceCloudSettings& settings,
                                        std::span<const Layer> surfaces, const MarchedShadow& shadow) {
  checkSettings(settings);
  const Vec3 to_light = keyLight(sky).direction;
  return renderScaled(camera, settings, surfaces, [&](const Ray& ray, float jitter, const Cuts& cuts) {
    return marchDistanceCloud(ray, to_light, jitter, cuts, shadow, settings);
  });
}

Layer renderDistanceClouds(const Camera& camera, const SkySettings& sky, const DistanceCloudSettings& settings) {
  return std::move(renderDistanceClouds(camera, sky, settings, {}).front());
}

void passDistanceClouds(std::span<const Vec3> points, Vec3 to_light, const DistanceCloudSettings& settings, std::span<float> shares) {
  const MarchedShadow none;
  pass(points, to_light, settings, shares, [&](const Ray& ray) { return marchDistanceCloud(ray, to_light, 0, {}, none, settings); });
}

DensityCloudSettings publishedDensityClouds() {
  DensityCloudSettings settings;
  settings.noise_strength = 1.6F, settings.noise_contrast = 1;
  settings.color_factor = 0.65F, settings.opacity_factor = 0.5F, settings.fade_density = 0.0018F;
  settings.parts = 1;
  settings.dither = 0;
  return settings;
}

float densityCloudDensity(Vec3 p, const DensityCloudSettings& settings) { return densityAt(p, settings); }

float densityCloudStep(float t, const DensityCloudSettings& settings) { return std::max(settings.least_step, settings.step_growth * t); }

CloudSample densityCloudSample(float t, float density, float sun_cosine, Vec3 sky, const DensityCloudSettings& settings) {
  const DensityStep step = densityStep(t, settings);
  return density > 0 ? litSample(t, density, step, glowOf(sun_cosine, settings), sky, {1, 1, 1}, settings)
                     : CloudSample{sky, 0, step.length};
}

std::vector<Layer> renderDensityClouds(const Camera& camera, const SkySettings& sky, const DensityCloudSettings& settings,
                                       std::span<const Layer> surfaces, const MarchedShadow& shadow) {
  requireInRange(densityCloudKeys(), settings);
  const Vec3 to_light = keyLight(sky).direction;
  return renderScaled(camera, settings, surfaces, [&](const Ray& ray, float jitter, const Cuts& cuts) {
    return marchDensityCloud(ray, to_light, sky, jitter, cuts, shadow, settings);
  });
}

Layer renderDensityClouds(const Camera& camera, const SkySettings& sky, const DensityCloudSettings& settings) {
  return std::move(renderDensityClouds(camera, sky, settings, {}).front());
}

void passDensityClouds(std::span<const Vec3> points, Vec3 to_light, const DensityCloudSettings& settings, std::span<float> shares) {
  const SkySettings any;
  const MarchedShadow none;
  pass(points, to_light, settings, shares, [&](const Ray& ray) { return marchDensityCloud(ray, to_light, any, 0, {}, none, settings); });
}

// --- Keys ---

const Keys<DistanceCloudSettings>& distanceCloudKeys() {
  using S = DistanceCloudSettings;
  static const Keys<S> keys{
      {"scale", &S::scale, 1e-6, 1e9, "world units per unit of the method"},
      {"cloud_height", &S::cloud_height, -kFar, kFar, "height of the densest plane, cloudY of the source, units"},
      {"flatness", &S::flatness, 0, 100, "h of the field's |p.y − cloudY|·h"},
      {"noise_frequency", &S::noise_frequency, 1e-6, 1e3, "0.4 of the field's fbm(0.4 p)"},
      {"octaves", &S::octaves, 1, 8, "octaves of the fbm"},
      {"seed", &S::seed, 0, kMostSeed, "selects other clouds"},
      {"wind", &S::wind, -1e6, 1e6, "motion of the noise, units per second"},
      {"samples", &S::samples, 1, 4096, "samples along a ray, at most"},
      {"least_step", &S::least_step, 1e-6, 1e6, "0.4 of the step max(0.4, (2 − 30·den)·t·0.011)"},
      {"step_growth", &S::step_growth, 1e-9, 1e3, "0.011 of the step"},
      {"thin_color", &S::thin_color, 0, kBright, "colour at density 0"},
      {"dense_color", &S::dense_color, 0, kBright, "colour at density 1"},
      {"opacity_factor", &S::opacity_factor, 0, 1, "factor of every sample's opacity"},
      {"stop_opacity", &S::stop_opacity, 0, 1, "opacity at which the march ends"},
      {"tint", &S::tint, 0, kBright, "factor of all colours; unset: of the hour", KeyUse::kShader, nullptr, true},
      {"dither", &S::dither, 0, 1, "how far the first sample is moved at random, in least steps"},
      {"samples_per_side", &S::samples_per_side, 1, 16, "n·n samples per pixel", KeyUse::kScript},
      {"noise_offset", &S::noise_offset, -100, 100, "subtracted from the field"},
      {"first_step", &S::first_step, 1e-6, 1e6, "first step of the search for the cloud"},
      {"step_factor", &S::step_factor, 1e-3, 10, "0.8 of the search's t += 0.8·map"},
      {"contact", &S::contact, 1e-6, 1e3, "|step| that ends the search"},
      {"farthest", &S::farthest, 1e-3, 1e6, "MAXT: t beyond which there are no samples"},
      {"search_farthest", &S::search_farthest, 1e-3, 1e6, "70 of the search's stop at t > 70, without a cloud"},
      {"search_steps", &S::search_steps, 1, 1e5, "steps of the search, at most"},
      {"step_back", &S::step_back, 0, 1e6, "from the contact to the first sample, units"},
      {"step_base", &S::step_base, -1e6, 1e6, "2 of the step"},
      {"step_density", &S::step_density, -1e6, 1e6, "30 of the step"},
      {"shadow_start", &S::shadow_start, 1e-6, 100, "0.2 of the shadow ss(0.2 + 0.05 m, 0, density(p + l))"},
      {"shadow_slope", &S::shadow_slope, -100, 100, "0.05 of the shadow"},
      {"shadow_tuning", &S::shadow_tuning, -100, 100, "m of the shadow"},
      {"shadow_distance", &S::shadow_distance, -1e6, 1e6, "how far from p the shadow's p + l is, units"},
      {"shadow_range", &S::shadow_range, 0, 1, "0.85 of ss·0.85 + 0.15, which multiplies colour and opacity"},
      {"shadow_floor", &S::shadow_floor, 0, 1, "0.15 of ss·0.85 + 0.15"},
      {"fade_start", &S::fade_start, 0, 1, "share of farthest from which samples fade; 1 is an edge"},
      {"time", &S::time_seconds, -kFar, kFar, "moment of the wind, seconds", KeyUse::kComputed},
  };
  return keys;
}

const Keys<DensityCloudSettings>& densityCloudKeys() {
  using S = DensityCloudSettings;
  static const Keys<S> keys{
      {"scale", &S::scale, 1e-6, 1e9, "world units per unit of the method"},
      {"cloud_height", &S::cloud_height, -kFar, kFar, "10.8 of the density's 1 − 0.15·|10.8 − y|, units"},
      {"flatness", &S::flatness, 0, 100, "0.15 of the density"},
      {"noise_frequency", &S::noise_frequency, 1e-6, 1e3, "0.15 of fbm(0.15 p), which is subtracted"},
      {"octaves", &S::octaves, 1, 8, "octaves of the fbm"},
      {"seed", &S::seed, 0, kMostSeed, "selects other clouds"},
      {"wind", &S::wind, -1e6, 1e6, "motion of the noise, units per second"},
      {"samples", &S::samples, 1, 4096, "samples along a ray, at most"},
      {"least_step", &S::least_step, 1e-6, 1e6, "0.1 of the step max(0.1, 0.3 t)"},
      {"step_growth", &S::step_growth, 1e-9, 1e3, "0.3 of the step"},
      {"thin_color", &S::thin_color, 0, kBright, "colour at density 0, 0.8·(1, 0.95, 0.9) in the source"},
      {"dense_color", &S::dense_color, 0, kBright, "colour at density 1, 0.2·(0.6, 0.6, 0.6) in the source"},
      {"opacity_factor", &S::opacity_factor, 0, 1, "factor of every sample's opacity"},
      {"stop_opacity", &S::stop_opacity, 0, 1, "opacity at which the march ends"},
      {"tint", &S::tint, 0, kBright, "factor of all colours; unset: of the hour", KeyUse::kShader, nullptr, true},
      {"dither", &S::dither, 0, 1, "how far the first sample is moved at random, in parts of a step"},
      {"samples_per_side", &S::samples_per_side, 1, 16, "n·n samples per pixel", KeyUse::kScript},
      {"noise_strength", &S::noise_strength, 0, 100, "1.6 of 1.6·fbm"},
      {"noise_contrast", &S::noise_contrast, 0, 100, "contrast of the fbm about its mean; 1 leaves it as it is"},
      {"color_factor", &S::color_factor, 0, kBright, "factor of both colours"},
      {"glow_color", &S::glow_color, 0, kBright, "colour of the glow towards the sun"},
      {"glow_strength", &S::glow_strength, 0, 100, "0.3 of the glow 0.3·max(0, v·l)⁶·(1 − d)"},
      {"glow_exponent", &S::glow_exponent, 0, 1e4, "6 of the glow"},
      {"fade_density", &S::fade_density, 0, 100, "density of the fade to the background, 1 − exp(−0.0018 t²)"},
      {"first_t", &S::first_t, 1e-6, 1e6, "t where the march begins"},
      {"parts", &S::parts, 1, 256, "parts into which a step is divided, at most"},
      {"part_length", &S::part_length, 1e-6, 1e6, "least length of a part, units"},
      {"time", &S::time_seconds, -kFar, kFar, "moment of the wind, seconds", KeyUse::kComputed},
  };
  return keys;
}

}  // namespace cloudbake
