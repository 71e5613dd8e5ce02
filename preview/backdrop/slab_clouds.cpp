// "Stylized cartoon volumetric clouds". A slab from `bottom` to `top`; n is the height noise at (x, z):
//   v = (n − threshold)/(1 − threshold),  lower = center − v (center − bottom),  upper = center + v (top − center)
//   thickness = Σ min(step, upper − lower) inside, a smooth fraction of it in the skin around
//   opacity = clamp(thickness/(2 edge_width/view_y), 0, 1),  den = (upper − y)/(top − bottom) at the first contact.
// Along a ray, upper − y grows with a vertical path by view_y per unit, so a path of the height 2·edge_width is opaque at any elevation.
// The normal is the gradient of den, (∂upper/∂x, −1, ∂upper/∂z), which points down to the viewer. n is Hermite's step of a mixture of
// two noises: with m = (mixture − low)/(high − low), ∂n = 6 m (1 − m) ∂m. Between the last sample without contact and the first with it the
// contact is found by bisection, so that den and its tones do not depend on the steps and their dither.
#include "preview/backdrop/slab_clouds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/parallel.h"
#include "core/random.h"
#include "preview/backdrop/noise_kernels.h"
#include "preview/shading_math.h"
#include "preview/side_by_side.h"

namespace cloudbake {

namespace {

constexpr int kBisections = 8;

void checkSettings(const SlabSettings& s) {
  requireInRange(slabKeys(), s);
  requireInRange(slabToneKeys(), s.tones);
  if (!(s.bottom < s.center && s.center < s.top && s.smooth_low < s.smooth_high && s.outline_start < s.outline_full))
    throw std::invalid_argument("renderSlabClouds: two settings are out of order");
}

// A place in cells after the drift; none if it is too far away.
std::optional<Vec2> driftedPlace(double a, double b, Vec2 drift, const SlabSettings& settings) {
  const double x = a / settings.noise_scale - drift.x * settings.time_seconds,
               y = b / settings.noise_scale - drift.y * settings.time_seconds;
  if (!(std::abs(x) < kMostCells && std::abs(y) < kMostCells)) return std::nullopt;
  return Vec2{float(x), float(y)};
}

// Rises from 0 to 1 about a limit.
float passed(float limit, float softness, float x) {
  return softness > 0 ? smoothStep(limit - softness, limit + softness, x) : x < limit ? 0.0F : 1.0F;
}

/// What a ray meets before, between and behind its cuts.
struct CutHits {
  std::array<SlabHit, Cuts::kMost + 1> parts;
  float opacity = 0;  ///< of all of it
};

/// What a march asks for: the height noise at a place (x, z).
using SlabMarch = Asking<Vec2, float, CutHits>;

// The same bits as slabNoise, without its derivatives.
void answerHeights(std::span<const Vec2> places, std::span<float> heights, const SlabSettings& settings) {
  const size_t count = places.size();
  thread_local std::vector<float> high_x, high_y, low_x, low_y, high, low;
  for (std::vector<float>* values : {&high_x, &high_y, &low_x, &low_y, &high, &low}) values->resize(count);
  thread_local std::vector<char> is_near;
  is_near.resize(count);
  for (size_t i = 0; i < count; ++i) {
    const auto high_place = driftedPlace(places[i].x, places[i].y, settings.high_drift, settings),
               low_place = driftedPlace(places[i].y, places[i].x, settings.low_drift, settings);
    is_near[i] = high_place && low_place;
    const Vec2 h = high_place.value_or(Vec2{}), l = low_place.value_or(Vec2{});
    high_x[i] = h.x, high_y[i] = h.y, low_x[i] = l.x, low_y[i] = l.y;
  }
  fbmValues2(high_x.data(), high_y.data(), count, {.octaves = settings.octaves, .seed = settings.seed}, high.data());
  fbmValues2(low_x.data(), low_y.data(), count, {.octaves = settings.octaves, .seed = settings.seed + 1}, low.data());
  for (size_t i = 0; i < count; ++i) {
    heights[i] = is_near[i] ? smoothStep(settings.smooth_low, settings.smooth_high, lerp(high[i], low[i], settings.low_share)) : 0;
  }
}

void describeContact(const Ray& ray, const SlabSettings& settings, SlabHit& hit) {
  const Vec3 p = ray.origin + ray.direction * hit.distance;
  const Noise2 noise = slabNoise(p.x, p.z, settings);
  hit.den = slabDen(p.y, slabProfile(noise.value, settings).upper, settings);
  const float rise = (settings.top - settings.center) / (1 - settings.threshold);
  const Vec3 normal = normalized(Vec3{noise.gradient.x * rise, -1, noise.gradient.y * rise}).value_or(Vec3{0, -1, 0});
  hit.facing = -dot(normal, ray.direction);
}

// The cloud that is met step by step, in parts. A step that a cut divides is divided between two parts.
class Thickness {
 public:
  explicit Thickness(const Cuts& cuts) : cuts_(cuts) {}
  float total() const { return total_; }

  // Adds what the way from `from` to `end` has, of which the cloud begins at `contact`.
  void add(float from, float end, float contact, float added) {
    while (part_ < size_t(cuts_.count) && cuts_.cuts[part_].distance < end) {
      const float cut = cuts_.cuts[part_].distance, share = cut > contact ? std::max(0.0F, (cut - from) / (end - from)) : 0;
      addToPart(contact, added * share);
      added -= added * share;
      from = std::max(from, cut);
      contact = std::max(contact, cut);
      ++part_;
    }
    addToPart(contact, added);
  }
  const CutHits& hits() const { return hits_; }

 private:
  void addToPart(float contact, float added) {
    if (!(added > 0)) return;
    SlabHit& hit = hits_.parts[part_];
    if (hit.thickness == 0) hit.distance = contact;
    hit.thickness += added;
    total_ += added;
  }

  const Cuts& cuts_;
  CutHits hits_;
  size_t part_ = 0;
  float total_ = 0;
};

// How opaque each part is with all parts before it.
void setOpacities(CutHits& hits, float rise, const SlabSettings& settings) {
  float thickness = 0;
  for (SlabHit& hit : hits.parts) {
    thickness += hit.thickness;
    hit.opacity = hits.opacity = slabOpacity(thickness, rise, settings);
  }
}

SlabMarch marchSlabAsking(Ray ray, float jitter, Cuts cuts, Outliving<SlabSettings> all_settings) {
  const SlabSettings& settings = all_settings;
  const float rise = ray.direction.y;
  if (!(rise > 0)) co_return CutHits{};
  const float enter = std::max(0.0F, (settings.bottom - ray.origin.y) / rise), leave = (settings.top - ray.origin.y) / rise;
  if (!(leave > enter) || !std::isfinite(leave)) co_return CutHits{};

  const float step = (leave - enter) / float(settings.samples), opaque = settings.opaque_widths * settings.edge_width / rise;
  const auto at = [&ray](float t) { return ray.origin + ray.direction * t; };
  const auto thickening = [&](float t, float height) {
    return slabThickening(at(t).y, step, slabProfile(height, settings), settings.edge_width);
  };
  Thickness thickness(cuts);
  for (int i = 0; i < settings.samples && thickness.total() < opaque; ++i) {
    const float t = enter + step * (float(i) + jitter);
    const Vec3 p = at(t);
    const float height = co_await Vec2{p.x, p.z};
    const float added = thickening(t, height);
    if (!(added > 0)) continue;
    const float from = enter + step * float(i);
    float contact = from;
    if (thickness.total() == 0) {
      float clear = t - step, touching = t;
      for (int halving = 0; halving < (i == 0 ? 0 : kBisections); ++halving) {
        const float middle = 0.5F * (clear + touching);
        const Vec3 q = at(middle);
        const float there = co_await Vec2{q.x, q.z};
        (thickening(middle, there) > 0 ? touching : clear) = middle;
      }
      contact = touching;
    }
    thickness.add(from, from + step, contact, added);
  }
  CutHits hits = thickness.hits();
  for (SlabHit& hit : hits.parts)
    if (hit.thickness > 0) describeContact(ray, settings, hit);
  setOpacities(hits, rise, settings);
  co_return hits;
}

/// All rays of a picture, n·n per pixel on a regular grid, so that neighbours give gradients.
struct HitGrid {
  int width, height;
  std::vector<CutHits> hits;

  float opacity(int x, int y) const {
    return hits[size_t(std::clamp(y, 0, height - 1)) * size_t(width) + size_t(std::clamp(x, 0, width - 1))].opacity;
  }
  // Length of Sobel's gradient, per sample.
  float gradient(int x, int y) const {
    const auto across = [&](int dx, int dy) {
      const auto side = [&](int s) {
        return opacity(x + s * dx - dy, y + s * dy - dx) + 2 * opacity(x + s * dx, y + s * dy) + opacity(x + s * dx + dy, y + s * dy + dx);
      };
      return (side(1) - side(-1)) / 8;
    };
    return std::hypot(across(1, 0), across(0, 1));
  }
};

HitGrid marchAll(const Camera& camera, const SlabSettings& settings, std::span<const Layer> surfaces) {
  constexpr int kTogether = 256;  // rays that are marched side by side
  const int n = settings.samples_per_side;
  HitGrid grid{camera.width * n, camera.rows() * n, {}};
  grid.hits.resize(size_t(grid.width) * size_t(grid.height));
  const CameraRays rays(camera);
  const auto marchRays = [&](int first, int end, int y) {
    std::vector<SlabMarch> marches;
    std::vector<CutHits*> hits;
    const int row = camera.first_row * n + y;
    for (int x = first; x < end; ++x) {
      const float jitter = settings.dither * uniformFloat(hashDraw(mix64(settings.seed + kGolden64), uint32_t(x), uint32_t(row)));
      const Ray ray = rays.at((float(x) + 0.5F) / float(n), (float(row) + 0.5F) / float(n));
      if (!(slabHorizonFade(ray.direction.y, settings) > 0)) continue;
      marches.push_back(marchSlabAsking(ray, jitter, cutsAt(surfaces, x / n, y / n, y % n * n + x % n, n), settings));
      hits.push_back(&grid.hits[size_t(y) * size_t(grid.width) + size_t(x)]);
    }
    runSideBySide(std::span(marches),
                  [&](std::span<const Vec2> places, std::span<float> heights) { answerHeights(places, heights, settings); });
    for (size_t i = 0; i < marches.size(); ++i) *hits[i] = marches[i].result();
  };
  parallelFor(grid.height, [&](int y) {
    for (int x = 0; x < grid.width; x += kTogether) marchRays(x, std::min(x + kTogether, grid.width), y);
  });
  return grid;
}

}  // namespace

SlabSettings publishedSlab() {
  SlabSettings settings;
  settings.tone_softness = 0;
  settings.tones.highlight = settings.tones.light;
  return settings;
}

Noise2 slabNoise(float x, float z, const SlabSettings& settings) {
  const auto high_place = driftedPlace(x, z, settings.high_drift, settings), low_place = driftedPlace(z, x, settings.low_drift, settings);
  if (!high_place || !low_place) return {};
  const Noise2 high = fbmValue2(*high_place, {.octaves = settings.octaves, .seed = settings.seed});
  const Noise2 low = fbmValue2(*low_place, {.octaves = settings.octaves, .seed = settings.seed + 1});
  const float share = settings.low_share, mixed = lerp(high.value, low.value, share);
  const float range = settings.smooth_high - settings.smooth_low, part = saturate((mixed - settings.smooth_low) / range);
  const float slope = 6 * part * (1 - part) / (range * settings.noise_scale);
  return {smoothStep(settings.smooth_low, settings.smooth_high, mixed),
          {slope * lerp(high.gradient.x, low.gradient.y, share), slope * lerp(high.gradient.y, low.gradient.x, share)}};
}

SlabProfile slabProfile(float noise, const SlabSettings& settings) {
  const float v = (noise - settings.threshold) / (1 - settings.threshold);
  return {settings.center - v * (settings.center - settings.bottom), settings.center + v * (settings.top - settings.center)};
}

float slabThickening(float y, float step, const SlabProfile& profile, float edge_width) {
  if (!(profile.lower < profile.upper)) return 0;
  const float outside = std::max(profile.lower - y, y - profile.upper);
  if (outside >= edge_width) return 0;
  const float inside = std::min(step, profile.upper - profile.lower);
  return outside < 0 ? inside : inside * smoothStep(edge_width, 0, outside);
}

float slabOpacity(float thickness, float view_y, const SlabSettings& settings) {
  return saturate(thickness / (settings.opaque_widths * settings.edge_width / view_y));
}

float slabDen(float y, float upper, const SlabSettings& settings) {
  return std::clamp((upper - y) / (settings.top - settings.bottom), settings.least_den, 1.0F);
}

Vec3 slabTone(float den, float facing, const SlabSettings& settings) {
  const SlabTones& tones = settings.tones;
  const Vec3 brightest = lerp(tones.light, tones.highlight, saturate(facing * settings.bright));
  Vec3 tone = lerp(tones.shadow, tones.middle, passed(settings.shadow_limit, settings.tone_softness, den));
  tone = lerp(tone, brightest, passed(settings.middle_limit, settings.tone_softness, den));
  return tone * lerp(1, settings.self_shadow, den * den * settings.self_shadow_gain);
}

float slabEdge(float opacity_gradient, const SlabSettings& settings) {
  return smoothStep(settings.outline_start, settings.outline_full, opacity_gradient);
}

float slabHorizonFade(float view_y, const SlabSettings& settings) {
  return saturate((view_y - settings.horizon_start) * settings.horizon_gain);
}

float slabNightFactor(const SkyColors& colors, const SlabSettings& settings) {
  const float luminance = 0.5F * luminanceOf(colors.zenith + colors.horizon);
  return lerp(settings.night_light, 1, saturate(luminance / settings.day_luminance));
}

SlabHit marchSlab(const Ray& ray, float jitter, const SlabSettings& settings) {
  return runAlone(marchSlabAsking(ray, jitter, {}, settings),
                  [&](Vec2 place) {
                    float height = 0;
                    answerHeights({&place, 1}, {&height, 1}, settings);
                    return height;
                  })
      .parts.front();
}

void passSlab(std::span<const Vec3> points, Vec3 to_light, const SlabSettings& settings, std::span<float> shares) {
  const float fade = slabHorizonFade(to_light.y, settings);
  if (!(fade > 0)) return;
  std::vector<SlabMarch> marches;
  for (const Vec3& point : points) marches.push_back(marchSlabAsking({point, to_light}, 0.5F, {}, settings));
  runSideBySide(std::span(marches),
                [&](std::span<const Vec2> places, std::span<float> heights) { answerHeights(places, heights, settings); });
  for (size_t i = 0; i < shares.size(); ++i) shares[i] *= 1 - fade * marches[i].result().opacity;
}

std::vector<Layer> renderSlabClouds(const Camera& camera, const SlabSettings& settings, std::span<const Layer> surfaces) {
  checkSettings(settings);
  const HitGrid grid = marchAll(camera, settings, surfaces);
  const int n = settings.samples_per_side;
  const float samples_per_degree = float(camera.height * n) / camera.vertical_fov_degrees;

  std::vector<Layer> layers(surfaces.size() + 1, blankLayer(camera.width, camera.rows(), n));
  const CameraRays rays(camera);
  parallelFor(camera.rows(), [&](int y) {
    for (int x = 0; x < camera.width; ++x)
      for (int i = 0; i < n * n; ++i) {
        const int column = x * n + i % n, row = y * n + i / n;
        const CutHits& hits = grid.hits[size_t(row) * size_t(grid.width) + size_t(column)];
        if (!(hits.opacity > 0)) continue;
        const Vec3 view = rays.at((float(column) + 0.5F) / float(n), (float(camera.first_row * n + row) + 0.5F) / float(n)).direction;
        const float fade = slabHorizonFade(view.y, settings);
        const float edge = slabEdge(grid.gradient(column, row) * samples_per_degree, settings);
        float before = 0;  // opacity of the parts before
        for (size_t part = 0; part < layers.size(); ++part) {
          const SlabHit& hit = hits.parts[part];
          const float so_far = hit.opacity * fade;
          if (so_far > before) {
            const Vec3 color = lerp(slabTone(hit.den, hit.facing, settings), settings.tones.outline, settings.outline_strength * edge);
            layers[part].at(x, y, i) = {color, (so_far - before) / (1 - before), hit.distance};
          }
          before = so_far;
        }
      }
  });
  return layers;
}

Layer renderSlabClouds(const Camera& camera, const SlabSettings& settings) {
  return std::move(renderSlabClouds(camera, settings, {}).front());
}

// --- Keys ---

const Keys<SlabSettings>& slabKeys() {
  using S = SlabSettings;
  constexpr const char* kByHour = "the page has a table of the tones by the sun's height";
  static const Keys<S> keys{
      {"bottom", &S::bottom, -kFar, kFar, "lowest height, world units"},
      {"center", &S::center, -kFar, kFar, "height of the middle plane, world units"},
      {"top", &S::top, -kFar, kFar, "highest height, world units"},
      {"samples", &S::samples, 1, 4096, "steps through the slab"},
      {"dither", &S::dither, 0, 1, "how far the start of a ray is moved at random, in steps"},
      {"samples_per_side", &S::samples_per_side, 1, 16, "n·n samples per pixel", KeyUse::kScript},
      {"noise_scale", &S::noise_scale, 1e-6, 1e9, "world units per cell of the noise"},
      {"octaves", &S::octaves, 1, 8, "octaves of both noises"},
      {"seed", &S::seed, 0, kMostSeed, "selects other clouds"},
      {"threshold", &S::threshold, 0, 0.99, "t: noise n below it is clear sky; v = (n − t)/(1 − t)"},
      {"low_share", &S::low_share, 0, 1, "weight of the low noise in the mixture"},
      {"smooth_low", &S::smooth_low, 0, 1, "mixture that becomes noise 0"},
      {"smooth_high", &S::smooth_high, 0, 1, "mixture that becomes noise 1"},
      {"high_drift", &S::high_drift, -1e3, 1e3, "drift of the noise that is read at (x, z), cells per second"},
      {"low_drift", &S::low_drift, -1e3, 1e3, "drift of the noise that is read at (z, x), cells per second"},
      {"edge_width", &S::edge_width, 1e-6, 1e6, "width of the soft skin, world units"},
      {"opaque_widths", &S::opaque_widths, 1e-3, 1e6, "2 of opacity = thickness/(2·edge_width/v.y)"},
      {"least_den", &S::least_den, 1e-9, 1, "least value of den, the share of the slab's height below the top of the cloud"},
      {"shadow_limit", &S::shadow_limit, 0, 1, "den below which the tone is shadow"},
      {"middle_limit", &S::middle_limit, 0, 1, "den below which the tone is middle"},
      {"tone_softness", &S::tone_softness, 0, 1, "half width in den over which tones mix; 0: hard edges"},
      {"bright", &S::bright, 0, 100, "factor of dot(normal, −v), the share of the highlight"},
      {"self_shadow", &S::self_shadow, 0, 1, "s of the factor mix(1, s, den²·g)"},
      {"self_shadow_gain", &S::self_shadow_gain, 0, 1, "g of the factor mix(1, s, den²·g)"},
      {"outline_strength", &S::outline_strength, 0, 1, "share of the outline's colour"},
      {"outline_start", &S::outline_start, 0, 1e3, "gradient of the opacity where the outline begins, per degree"},
      {"outline_full", &S::outline_full, 0, 1e3, "gradient of the opacity where the outline is full, per degree"},
      {"horizon_start", &S::horizon_start, 0, 0.99, "a of the fade clamp((v.y − a)·b, 0, 1) at the horizon"},
      {"horizon_gain", &S::horizon_gain, 1e-3, 1e3, "b of the fade at the horizon"},
      {"day_luminance", &S::day_luminance, 1e-6, kBright, "luminance of the sky from which tones that the table sets are not darkened",
       KeyUse::kScript, kByHour},
      {"night_light", &S::night_light, 0, 1, "brightness of tones that the table sets under a black sky", KeyUse::kScript, kByHour},
      {"time", &S::time_seconds, -kFar, kFar, "moment of the drift, seconds", KeyUse::kComputed},
  };
  return keys;
}

const Keys<SlabTones>& slabToneKeys() {
  using S = SlabTones;
  static const Keys<S> keys{
      {"shadow", &S::shadow, 0, kBright, "colour of the darkest tone; tones that are unset take the light of the hour"},
      {"middle", &S::middle, 0, kBright, "colour of the middle tone"},
      {"light", &S::light, 0, kBright, "colour of the light tone"},
      {"highlight", &S::highlight, 0, kBright, "colour of light parts that face the viewer"},
      {"outline", &S::outline, 0, kBright, "colour of the outline"},
  };
  return keys;
}

}  // namespace cloudbake
