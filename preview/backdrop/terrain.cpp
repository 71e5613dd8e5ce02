// I. Quilez, "Elevated" (Shadertoy MdX3Rr; 4 kB demo with TBC, Breakpoint 2009), from a reading of its code. With value noise n,
// its gradient ∇n, the rotation M = (4/5, −3/5; 3/5, 4/5) and the scale SC:
//   ground  h(x) = 120 SC Σᵢ 2⁻ⁱ n(pᵢ)/(1 + |Σⱼ≤ᵢ ∇n(pⱼ)|²),  p₀ = 0.003 x/SC,  pᵢ₊₁ = 2 M pᵢ;  slopes suppress finer detail
//   march   t ← t + 0.4 (y − h),  until |y − h| < 0.0015 t
//   shadow  min of 16 (y − h)/t along the way: the angle by which the light clears the ridges
//   fog     1 − exp(−(0.001 t/SC)^1.5)
// "Noise of a picture" below is value noise on a tile of 256 × 256 cells and side 1, like the noise picture that the source reads.
#include "preview/backdrop/terrain.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "preview/backdrop/noise.h"
#include "preview/backdrop/terrain_kernels.h"
#include "preview/shading_math.h"
#include "preview/side_by_side.h"

namespace cloudbake {

namespace {

// What a noise is for, so that all of them differ.
enum NoiseUse : uint32_t { kHeights = 0, kGrain = 0x51ED270B, kRock = 0x2545F491, kSnow = 0x6C8E9CF5, kClouds = 0x3C6EF372 };

constexpr uint32_t kOctaveSeed = 0x632BE5ABU;

// A point in a noise's lattice, kept inside the range of cell numbers.
struct LatticePoint {
  double x = 0, y = 0;
  Vec2 clamped() const {
    constexpr double kLimit = 0x1p29;
    return {float(std::clamp(x, -kLimit, kLimit)), float(std::clamp(y, -kLimit, kLimit))};
  }
  LatticePoint turned(double factor) const { return {factor * (0.8 * x - 0.6 * y), factor * (0.6 * x + 0.8 * y)}; }
};

float fbmAt(LatticePoint p, uint32_t seed, const TerrainFbm& fbm) {
  float sum = 0, weight = fbm.gain, weights = 0;
  for (const float lacunarity : {fbm.lacunarities.x, fbm.lacunarities.y, fbm.lacunarities.z, 1.0F}) {
    sum += weight * valueNoise2(p.clamped(), {.seed = seed}).value;
    weights += weight;
    p = p.turned(double(lacunarity));
    weight *= fbm.gain;
    seed += kOctaveSeed;
  }
  return sum / weights;
}

float pictureNoise(double u, double v, uint32_t seed) {
  return valueNoise2(LatticePoint{256 * u, 256 * v}.clamped(), {.seed = seed, .period = 256}).value;
}

float power(float base, float exponent) { return std::pow(std::max(0.0F, base), exponent); }

Vec3 notNegative(Vec3 v) { return {std::max(0.0F, v.x), std::max(0.0F, v.y), std::max(0.0F, v.z)}; }

/// A point on a ray, in double, because far from the origin float is coarser than the ground's detail.
struct RayPoint {
  double x = 0, y = 0, z = 0;
};

RayPoint pointAt(Vec3 from, Vec3 direction, double t) {
  return {double(from.x) + t * double(direction.x), double(from.y) + t * double(direction.y), double(from.z) + t * double(direction.z)};
}

/// What a ray asks for: the height of the ground.
struct HeightRequest {
  double x, z;
  int octaves;
};
template <typename Result>
using Asker = Asking<HeightRequest, double, Result>;

// The heights at many places, with the same number of octaves.
void heightsAt(std::span<const HeightRequest> places, std::span<double> heights, const TerrainSettings& settings) {
  const TerrainShape& shape = settings.shape;
  const double per_unit = double(shape.frequency) / settings.scale;
  const size_t padded = (places.size() + kPlacesTogether - 1) / kPlacesTogether * kPlacesTogether;
  thread_local std::vector<double> x, y;
  thread_local std::vector<float> sums;
  x.resize(padded), y.resize(padded), sums.resize(padded);
  for (size_t i = 0; i < places.size(); ++i) {
    x[i] = (places[i].x - settings.origin.x) * per_unit;
    y[i] = (places[i].z - settings.origin.z) * per_unit;
  }
  const ErodedOctaves octaves{places.front().octaves, shape.gain, shape.lacunarity, settings.seed + kHeights, kOctaveSeed};
  erodedSums(x.data(), y.data(), padded, octaves, sums.data());
  for (size_t i = 0; i < places.size(); ++i) heights[i] = settings.origin.y + double(settings.scale) * shape.amplitude * sums[i];
}

// The same for rays in different phases: those that ask for as many octaves are answered together.
void answerHeights(std::span<const HeightRequest> requests, std::span<double> heights, const TerrainSettings& settings) {
  std::vector<size_t> waiting(requests.size());
  std::iota(waiting.begin(), waiting.end(), size_t(0));
  std::vector<HeightRequest> places;
  std::vector<double> found;
  while (!waiting.empty()) {
    const int octaves = requests[waiting.front()].octaves;
    const auto other = std::stable_partition(waiting.begin(), waiting.end(), [&](size_t i) { return requests[i].octaves == octaves; });
    places.clear();
    for (auto i = waiting.begin(); i != other; ++i) places.push_back(requests[*i]);
    found.resize(places.size());
    heightsAt(places, found, settings);
    for (size_t i = 0; i < found.size(); ++i) heights[waiting[i]] = found[i];
    waiting.erase(waiting.begin(), other);
  }
}

template <typename Result>
Result runAlone(Asker<Result> asker, const TerrainSettings& settings) {
  return runAlone(std::move(asker), [&](const HeightRequest& place) {
    double height = 0;
    heightsAt({&place, 1}, {&height, 1}, settings);
    return height;
  });
}

Vec3 sunScatter(Vec3 view, Vec3 to_sun, const TerrainSettings& settings) {
  return settings.use_sun_scatter ? settings.fog.scatter * power(dot(view, to_sun), settings.fog.scatter_exponent) : Vec3{};
}

// There is snow at height, on gentle slopes, and less of it on the sunny side: s = h·e·o.
float snowShare(Vec3 point, Vec3 normal, const TerrainSettings& settings) {
  const TerrainGround& ground = settings.ground;
  const double x = (double(point.x) - settings.origin.x) / settings.scale, z = (double(point.z) - settings.origin.z) / settings.scale;
  const float y = (point.y - settings.origin.y) / settings.scale;
  const float noise = fbmAt({ground.snow_frequency * x, ground.snow_frequency * z}, settings.seed + kSnow, settings.fbm);
  const float high = smoothStep(ground.snow_low, ground.snow_high, y + ground.snow_noise * noise);
  if (high < 1e-4F) return 0;  // the two ends of the next step meet
  const float gentle = smoothStep(1 - ground.snow_steep * high, 1 - ground.snow_flat * high, normal.y);
  const float shady =
      ground.snow_sunny + ground.snow_shady * smoothStep(0, ground.snow_side_width, dot(normal, ground.snow_side) + high * high);
  return high * gentle * shady;
}

}  // namespace

float terrainFbm(Vec2 p, uint32_t seed, const TerrainFbm& fbm) { return fbmAt({p.x, p.y}, seed, fbm); }

double terrainHeight(double x, double z, int octaves, const TerrainSettings& settings) {
  const HeightRequest place{x, z, octaves};
  double height = 0;
  heightsAt({&place, 1}, {&height, 1}, settings);
  return height;
}

namespace {

Asker<Vec3> askNormal(double x, double z, double step, Outliving<TerrainSettings> all_settings) {
  const TerrainSettings& settings = all_settings;
  const int octaves = settings.shape.normal_octaves;
  const double left = co_await HeightRequest{x - step, z, octaves};
  const double right = co_await HeightRequest{x + step, z, octaves};
  const double back = co_await HeightRequest{x, z - step, octaves};
  const double front = co_await HeightRequest{x, z + step, octaves};
  co_return normalized(Vec3{float(left - right), float(2 * step), float(back - front)}).value_or(Vec3{0, 1, 0});
}

Asker<std::optional<TerrainHit>> askHit(Ray ray, Outliving<TerrainSettings> all_settings) {
  const TerrainSettings& settings = all_settings;
  const TerrainMarch& march = settings.march;
  double first = double(march.nearest) * settings.scale, last = double(march.farthest) * settings.scale;

  // The part of the ray below the ceiling.
  const double below_ceiling = settings.origin.y + double(march.ceiling) * settings.scale - ray.origin.y;
  if (below_ceiling < 0) {
    if (ray.direction.y >= 0) co_return std::nullopt;
    first = std::max(first, below_ceiling / ray.direction.y);
  } else if (ray.direction.y > 0) {
    last = std::min(last, below_ceiling / ray.direction.y);
  }

  double t = first;
  for (int i = 0; i < march.steps && t <= last; ++i) {
    const RayPoint p = pointAt(ray.origin, ray.direction, t);
    const double ground = co_await HeightRequest{p.x, p.z, settings.shape.march_octaves};
    const double height = p.y - ground;
    if (std::abs(height) < march.tolerance * t || (height < 0 && t <= first)) break;
    t = std::max(first, t + march.step * height);
  }
  if (t > last) co_return std::nullopt;
  const RayPoint hit = pointAt(ray.origin, ray.direction, t);
  co_return TerrainHit{t, {float(hit.x), float(hit.y), float(hit.z)}};
}

Asker<float> askShadow(Vec3 point, Vec3 to_sun, Outliving<TerrainSettings> all_settings) {
  const TerrainSettings& settings = all_settings;
  const TerrainShadowSettings& shadow = settings.shadow;
  const double lift = double(shadow.lift) * settings.scale, ceiling = settings.origin.y + double(shadow.ceiling) * settings.scale;
  double t = 1e-6 * settings.scale;
  float least = 1;
  for (int i = 0; i < shadow.steps && least >= shadow.darkest; ++i) {
    const RayPoint p = pointAt(point, to_sun, lift + t);
    if (p.y > ceiling) break;
    const double ground = co_await HeightRequest{p.x, p.z, settings.shape.march_octaves};
    const double height = p.y - ground;
    least = std::min(least, float(shadow.sharpness * height / t));
    t += height;
  }
  co_return saturate(least);
}

float facingOf(Vec3 normal, Vec3 to_sun) { return saturate(dot(normal, to_sun)); }

/// What a ray of the picture sees.
struct Sight {
  std::optional<TerrainHit> hit;
  Vec3 normal;
  float sun = 0;  // the share that comes past the ground; 0 also where the ground faces away
};

Asker<Sight> askGround(TerrainHit hit, Vec3 to_sun, Outliving<TerrainSettings> all_settings) {
  const TerrainSettings& settings = all_settings;
  Asker<Vec3> normal = askNormal(hit.position.x, hit.position.z, settings.march.normal_step * hit.distance, settings);
  while (normal.asks()) {
    const double ground = co_await normal.request();
    normal.take(ground);
  }
  Sight sight{hit, normal.result(), 0};
  if (facingOf(sight.normal, to_sun) > 0) {
    Asker<float> shadow = askShadow(hit.position, to_sun, settings);
    while (shadow.asks()) {
      const double ground = co_await shadow.request();
      shadow.take(ground);
    }
    sight.sun = shadow.result();
  }
  co_return sight;
}

Asker<Sight> askSight(Ray ray, Vec3 to_sun, Outliving<TerrainSettings> all_settings) {
  const TerrainSettings& settings = all_settings;
  Asker<std::optional<TerrainHit>> hit = askHit(ray, settings);
  while (hit.asks()) {
    const double ground = co_await hit.request();
    hit.take(ground);
  }
  if (!hit.result()) co_return Sight{};
  Asker<Sight> sight = askGround(*hit.result(), to_sun, settings);
  while (sight.asks()) {
    const double ground = co_await sight.request();
    sight.take(ground);
  }
  co_return sight.result();
}

// The colour of a hit with this normal and this much sun.
Vec3 litColor(const Sight& sight, Vec3 view, Vec3 to_sun, const TerrainSettings& settings);

}  // namespace

Vec3 terrainNormal(double x, double z, double step, const TerrainSettings& settings) {
  return runAlone(askNormal(x, z, step, settings), settings);
}

std::optional<TerrainHit> marchTerrain(const Ray& ray, const TerrainSettings& settings) {
  return runAlone(askHit(ray, settings), settings);
}

float terrainShadow(Vec3 point, Vec3 to_sun, const TerrainSettings& settings) {
  return runAlone(askShadow(point, to_sun, settings), settings);
}

TerrainMaterial terrainMaterial(Vec3 point, Vec3 normal, const TerrainSettings& settings) {
  const TerrainGround& ground = settings.ground;
  const double x = (double(point.x) - settings.origin.x) / settings.scale, y = (double(point.y) - settings.origin.y) / settings.scale,
               z = (double(point.z) - settings.origin.z) / settings.scale;

  // Rock in strata, grass where it is flat enough.
  const double grain = double(ground.grain_frequency) / 256, strata = ground.strata_frequency;
  const float r = pictureNoise(grain * x, grain * z, settings.seed + kRock);
  const float stratum = pictureNoise(strata * x, strata * ground.strata_upwards * y, settings.seed + kRock);
  Vec3 albedo = lerp(ground.rock_dark, ground.rock_light, stratum) * ((ground.rock_plain + ground.rock_grain * r) * ground.rock_gain);
  albedo = lerp(albedo, ground.grass * (ground.grass_gain * (ground.grass_plain + ground.grass_grain * r)),
                smoothStep(ground.grass_from, ground.grass_to, normal.y));
  albedo = lerp(albedo, ground.meadow * (ground.meadow_gain * (ground.meadow_plain + ground.meadow_grain * r)),
                smoothStep(ground.meadow_from, ground.meadow_to, normal.y));
  const float fine = fbmAt({ground.fine_grain * x, ground.fine_grain * z}, settings.seed + kGrain, settings.fbm);
  const float coarse = fbmAt({ground.coarse_grain * x, ground.coarse_grain * z}, settings.seed + kGrain, settings.fbm);
  albedo = albedo * (ground.light_plain + ground.light_gain * std::sqrt(fine * coarse));

  const float snow = snowShare(point, normal, settings);
  return {lerp(albedo, ground.snow * ground.snow_gain, smoothStep(ground.snow_from, ground.snow_to, snow)), snow};
}

Vec3 terrainColor(const TerrainHit& hit, Vec3 view, Vec3 to_sun, const TerrainSettings& settings) {
  return litColor(runAlone(askGround(hit, to_sun, settings), settings), view, to_sun, settings);
}

namespace {

Vec3 litColor(const Sight& sight, Vec3 view, Vec3 to_sun, const TerrainSettings& settings) {
  const TerrainLight& light = settings.light;
  const TerrainHit& hit = *sight.hit;
  const Vec3 n = sight.normal;
  const float s = sight.sun;
  const TerrainMaterial material = terrainMaterial(hit.position, n, settings);

  // The sun with a shadow that is bluer at its rim, the sky, and light from the slopes across.
  const float facing = facingOf(n, to_sun);
  const Vec3 shadow = Vec3{s, s, s} + settings.shadow.tint * (s * s - s);
  const Vec3 across = normalized(Vec3{-to_sun.x, 0, to_sun.z}).value_or(Vec3{});
  Vec3 lit = light.sun * shadow * facing;
  lit += light.sky * (light.sky_plain + light.sky_up * n.y);
  lit += light.bounce * saturate(light.bounce_plain + light.bounce_facing * dot(n, across));
  Vec3 color = material.albedo * lit;

  // Gloss, and a rim of sky on snow.
  const Vec3 half = normalized(to_sun - view).value_or(n);
  const float fresnel = light.fresnel_plain + light.fresnel_gain * power(1 + dot(half, view), light.fresnel_exponent);
  const float gloss = light.gloss_plain + light.gloss_snow * material.snow;
  color += light.specular * (facing * s * power(dot(n, half), light.gloss_exponent) * fresnel * gloss);
  const float reflected_y = view.y - 2 * dot(view, n) * n.y;
  color +=
      light.snow_rim * (material.snow * power(saturate(1 + dot(n, view)), light.rim_exponent) * smoothStep(0, light.rim_to, reflected_y));

  if (settings.use_own_fog) color = lerp(color, settings.fog.color, terrainFog(hit.distance, settings));
  return color + sunScatter(view, to_sun, settings);
}

}  // namespace

float terrainFog(double distance, const TerrainSettings& settings) {
  const double depth = settings.fog.density * distance / settings.scale;
  return float(1 - std::exp(-std::pow(std::max(0.0, depth), double(settings.fog.exponent))));
}

Vec3 terrainSky(Vec3 position, Vec3 view, Vec3 to_sun, const TerrainSettings& settings) {
  const TerrainSkySettings& sky = settings.sky;
  const float y = std::max(0.0F, view.y), s = dot(view, to_sun), darker = sky.darkening * view.y * view.y;
  Vec3 color = lerp(sky.color - Vec3{darker, darker, darker}, sky.haze, power(1 - y, sky.haze_exponent));
  color += sky.wide_lobe * power(s, sky.wide_exponent) + sky.middle_lobe * power(s, sky.middle_exponent) +
           sky.narrow_lobe * power(s, sky.narrow_exponent);

  // Clouds on their plane. At 10⁻³ above level the horizon covers all but 1.6% of them.
  const double scale = settings.scale, up = settings.origin.y + sky.cloud_height * scale - position.y;
  if (view.y > 0 && up > 0) {
    const RayPoint p = pointAt(position, view, up / std::max(1e-3, double(view.y)));
    const double frequency = sky.cloud_frequency / scale;
    const float clouds =
        fbmAt({(p.x - settings.origin.x) * frequency, (p.z - settings.origin.z) * frequency}, settings.seed + kClouds, settings.fbm);
    color = lerp(color, sky.cloud, sky.cloud_share * smoothStep(sky.cloud_from, sky.cloud_to, clouds));
  }
  color = lerp(color, sky.horizon, power(1 - y, sky.horizon_exponent));
  return notNegative(color + sunScatter(view, to_sun, settings));
}

void passTerrain(std::span<const Vec3> points, Vec3 to_sun, const TerrainSettings& settings, std::span<float> shares) {
  const Vec3 to_light = to_sun.y >= 0 ? to_sun : normalized(Vec3{to_sun.x, 0, to_sun.z}).value_or(Vec3{1, 0, 0});
  const double ceiling = settings.origin.y + double(settings.shadow.ceiling) * settings.scale;
  std::vector<Asker<float>> shadows;
  std::vector<size_t> low;  // of the points
  for (size_t i = 0; i < points.size(); ++i) {
    if (points[i].y > ceiling) continue;
    low.push_back(i);
    shadows.push_back(askShadow(points[i], to_light, settings));
  }
  runSideBySide(std::span(shadows),
                [&](std::span<const HeightRequest> requests, std::span<double> heights) { answerHeights(requests, heights, settings); });
  for (size_t i = 0; i < low.size(); ++i) shares[low[i]] *= shadows[i].result();
}

Layer renderTerrain(const Camera& camera, Vec3 to_sun, const TerrainSettings& settings, const LightPassage& passage) {
  constexpr int kTogether = 64;  // pixels whose rays are followed side by side
  const std::vector<Vec2> places = pixelPlaces(settings.samples_per_side);
  Layer layer = blankLayer(camera.width, camera.rows(), settings.samples_per_side);
  const CameraRays rays(camera);
  const auto drawPixels = [&](int first, int end, int y) {
    std::vector<Asker<Sight>> asked;
    std::vector<Vec3> views, points;
    for (int x = first; x < end; ++x)
      for (const Vec2 place : places) {
        const Ray ray = rays.at(float(x) + place.x, float(camera.first_row + y) + place.y);
        views.push_back(ray.direction);
        asked.push_back(askSight(ray, to_sun, settings));
      }
    runSideBySide(std::span(asked),
                  [&](std::span<const HeightRequest> requests, std::span<double> heights) { answerHeights(requests, heights, settings); });

    // What other things leave of the sun, where there is any.
    std::vector<Sight> sights;
    std::vector<size_t> lit;
    for (const Asker<Sight>& one : asked) {
      sights.push_back(one.result());
      if (!passage || !(sights.back().sun > 0)) continue;
      lit.push_back(sights.size() - 1);
      points.push_back(sights.back().hit->position);
    }
    std::vector<float> shares(points.size(), 1);
    if (!points.empty()) passage(points, shares);
    for (size_t i = 0; i < lit.size(); ++i) sights[lit[i]].sun *= shares[i];

    LayerPixel* pixels = &layer.at(first, y);
    for (size_t i = 0; i < sights.size(); ++i)
      if (sights[i].hit) pixels[i] = {litColor(sights[i], views[i], to_sun, settings), 1, float(sights[i].hit->distance)};
  };
  parallelFor(layer.height, [&](int y) {
    for (int x = 0; x < layer.width; x += kTogether) drawPixels(x, std::min(x + kTogether, layer.width), y);
  });
  return layer;
}

Image renderTerrainSky(const Camera& camera, Vec3 to_sun, const TerrainSettings& settings) {
  const std::vector<Vec2> places = pixelPlaces(settings.samples_per_side);
  Image image = blankImage(camera.width, camera.height);
  const CameraRays rays(camera);
  parallelFor(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      Vec3 sum;
      for (const Vec2 place : places) {
        const Ray ray = rays.at(float(x) + place.x, float(y) + place.y);
        sum += terrainSky(ray.origin, ray.direction, to_sun, settings);
      }
      image.at(x, y) = sum / float(places.size());
    }
  });
  return image;
}

TerrainCamera terrainPath(double time_seconds, const TerrainSettings& settings) {
  const TerrainPathSettings& path = settings.path;
  const double t = path.time_factor * time_seconds, radius = double(path.radius) * settings.scale;
  const auto level = [&](double at) {
    return RayPoint{settings.origin.x + radius * std::cos(path.x_rate * at), 0,
                    settings.origin.z + radius * std::cos(path.z_phase + path.z_rate * at)};
  };
  const RayPoint here = level(t), there = level(t + path.look_ahead);
  const double height = terrainHeight(here.x, here.z, settings.shape.camera_octaves, settings) + path.clearance * settings.scale;
  return {{float(here.x), float(height), float(here.z)},
          {float(there.x), float(height - path.sink * settings.scale), float(there.z)},
          path.roll * float(std::cos(path.roll_rate * t)),
          path.focal_length};
}

Camera cameraOf(const TerrainCamera& camera, int width, int height) {
  const auto fov_degrees = float(2 * std::atan(1.0 / camera.focal_length) * 180 / kPi);
  return {camera.position, camera.target, fov_degrees, width, height, camera.roll_radians};
}

// --- Keys ---

const Keys<TerrainSettings>& terrainKeys() {
  using S = TerrainSettings;
  static const Keys<S> keys{
      {"scale", &S::scale, 1e-6, 1e6, "SC: world units per unit of the terrain; mountains are some 100 high"},
      {"origin", &S::origin, -kFar, kFar, "place of the terrain's (0, 0, 0), world units"},
      {"seed", &S::seed, 0, kMostSeed, "selects other mountains"},
      {"samples_per_side", &S::samples_per_side, 1, 16, "n·n samples per pixel", KeyUse::kScript},
      {"own_fog", &S::use_own_fog, 0, 1, "the terrain has its own fog, else the scene's"},
      {"sun_scatter", &S::use_sun_scatter, 0, 1, "the air scatters light towards the sun"},
  };
  return keys;
}

const Keys<TerrainShape>& terrainShapeKeys() {
  using S = TerrainShape;
  static const Keys<S> keys{
      {"frequency", &S::frequency, 1e-6, 1, "frequency of the first octave, per SC"},
      {"amplitude", &S::amplitude, 0, 1e4, "height of the first octave, SC"},
      {"gain", &S::gain, 0.05, 1, "factor of the height from octave to octave"},
      {"lacunarity", &S::lacunarity, 1, 4, "factor of the frequency from octave to octave"},
      {"camera_octaves", &S::camera_octaves, 0, 16, "octaves of the ground under the camera's path", KeyUse::kScript},
      {"march_octaves", &S::march_octaves, 0, 16, "octaves of hits and shadows"},
      {"normal_octaves", &S::normal_octaves, 0, 16, "octaves of normals"},
  };
  return keys;
}

const Keys<TerrainFbm>& terrainFbmKeys() {
  using S = TerrainFbm;
  static const Keys<S> keys{
      {"lacunarities", &S::lacunarities, 1, 4, "factors of the frequency from octave to octave, of the fbm of ground, snow and clouds"},
      {"gain", &S::gain, 0.05, 1, "factor of the weight from octave to octave: ½, ¼, ⅛, ¹⁄₁₆"},
  };
  return keys;
}

const Keys<TerrainMarch>& terrainMarchKeys() {
  using S = TerrainMarch;
  static const Keys<S> keys{
      {"steps", &S::steps, 1, 10000, "steps along a ray, at most"},
      {"step", &S::step, 0.01, 1, "share of the height above ground that a step goes"},
      {"tolerance", &S::tolerance, 1e-6, 0.1, "height of a hit, in shares of the distance"},
      {"ceiling", &S::ceiling, 0, 1e6, "height above which there is no ground, SC"},
      {"nearest", &S::nearest, 1e-6, 1, "distance where rays begin, SC"},
      {"farthest", &S::farthest, 1, 1e6, "distance where rays end, SC"},
      {"normal_step", &S::normal_step, 1e-6, 0.1, "step of the normal's differences, in shares of the distance"},
  };
  return keys;
}

const Keys<TerrainShadowSettings>& terrainShadowKeys() {
  using S = TerrainShadowSettings;
  static const Keys<S> keys{
      {"lift", &S::lift, 0, 100, "how far along the light a shadow's ray starts, SC"},
      {"sharpness", &S::sharpness, 0.1, 1000, "16 of the shadow min(16·h/t)"},
      {"steps", &S::steps, 0, 10000, "steps along a shadow's ray, at most"},
      {"darkest", &S::darkest, 0, 1, "shadow that ends the march"},
      {"ceiling", &S::ceiling, 0, 1e6, "height above which nothing casts a shadow, SC"},
      {"tint", &S::tint, 0, 1, "share of s² in red, green and blue: (s, s²/2 + s/2, 0.8 s² + 0.2 s)"},
  };
  return keys;
}

const Keys<TerrainGround>& terrainGroundKeys() {
  using S = TerrainGround;
  static const Keys<S> keys{
      {"rock_dark", &S::rock_dark, 0, kBright, "colour of the dark strata"},
      {"rock_light", &S::rock_light, 0, kBright, "colour of the light strata"},
      {"strata_frequency", &S::strata_frequency, 0, 10, "f of the strata noise(f·(x, 48 y)/SC)"},
      {"strata_upwards", &S::strata_upwards, 0, 1e5, "48 of the strata"},
      {"rock_plain", &S::rock_plain, 0, 10, "0.75 of the rock's brightness (0.25 r + 0.75)·0.9"},
      {"rock_grain", &S::rock_grain, 0, 10, "0.25 of the rock's brightness"},
      {"rock_gain", &S::rock_gain, 0, 10, "0.9 of the rock's brightness"},
      {"grain_frequency", &S::grain_frequency, 0, 1e4, "7 of the grain r = noise(7 xz/SC/256)"},
      {"grass", &S::grass, 0, kBright, "colour of the grass"},
      {"grass_gain", &S::grass_gain, 0, 10, "0.2 of the grass's brightness 0.2·(0.5 + 0.5 r)"},
      {"grass_plain", &S::grass_plain, 0, 10, "first 0.5 of the grass's brightness"},
      {"grass_grain", &S::grass_grain, 0, 10, "0.5 of 0.5 r in the grass's brightness"},
      {"grass_from", &S::grass_from, -1, 2, "n.y of the steepest ground with grass: ss(0.7, 0.9, n.y)"},
      {"grass_to", &S::grass_to, -1, 2, "n.y from which there is nothing but grass"},
      {"meadow", &S::meadow, 0, kBright, "colour of the meadow"},
      {"meadow_gain", &S::meadow_gain, 0, 10, "0.15 of the meadow's brightness 0.15·(0.25 + 0.75 r)"},
      {"meadow_plain", &S::meadow_plain, 0, 10, "0.25 of the meadow's brightness"},
      {"meadow_grain", &S::meadow_grain, 0, 10, "0.75 of the meadow's brightness"},
      {"meadow_from", &S::meadow_from, -1, 2, "n.y of the steepest ground with meadow: ss(0.95, 1, n.y)"},
      {"meadow_to", &S::meadow_to, -1, 2, "n.y from which there is nothing but meadow"},
      {"coarse_grain", &S::coarse_grain, 0, 1e4, "0.005·SC of fbm(0.005 xz), cells per SC at SC = 250"},
      {"fine_grain", &S::fine_grain, 0, 1e4, "0.04·SC of fbm(0.04 xz), cells per SC at SC = 250"},
      {"light_plain", &S::light_plain, 0, 10, "0.1 of the ground's brightness 0.1 + 1.8·√(fbm·fbm)"},
      {"light_gain", &S::light_gain, 0, 10, "1.8 of the ground's brightness"},
      {"snow", &S::snow, 0, kBright, "colour of the snow"},
      {"snow_gain", &S::snow_gain, 0, 10, "factor of the snow's colour"},
      {"snow_low", &S::snow_low, -1e6, 1e6, "lowest height of snow: h = ss(55, 80, y/SC + 25·fbm)"},
      {"snow_high", &S::snow_high, -1e6, 1e6, "height from which there is snow everywhere, 80 of h"},
      {"snow_noise", &S::snow_noise, 0, 1e6, "25 of h"},
      {"snow_frequency", &S::snow_frequency, 0, 1e4, "0.01 of h's fbm(0.01 xz/SC)"},
      {"snow_steep", &S::snow_steep, 0, 2, "0.5 of the share by slope e = ss(1 − 0.5 h, 1 − 0.1 h, n.y)"},
      {"snow_flat", &S::snow_flat, 0, 2, "0.1 of the share by slope"},
      {"snow_sunny", &S::snow_sunny, 0, 1, "0.3 of the share by side o = 0.3 + 0.7·ss(0, 0.1, n.x + h²)"},
      {"snow_shady", &S::snow_shady, 0, 1, "0.7 of the share by side"},
      {"snow_side_width", &S::snow_side_width, 1e-6, 2, "0.1 of the share by side"},
      {"snow_from", &S::snow_from, -1, 2, "0.1 of the mix with snow ss(0.1, 0.9, s), s = h·e·o"},
      {"snow_to", &S::snow_to, -1, 2, "0.9 of the mix with snow"},
      {"snow_side", &S::snow_side, -1, 1, "slopes that face away from it have less snow", KeyUse::kComputed},
  };
  return keys;
}

const Keys<TerrainLight>& terrainLightKeys() {
  using S = TerrainLight;
  static const Keys<S> keys{
      {"sun", &S::sun, 0, kBright, "light of the sun, (8, 5, 3)·1.3 in the source; unset: of the hour"},
      {"sky", &S::sky, 0, kBright, "light of the sky, (0.4, 0.6, 1)·1.2 in the source; unset: of the hour"},
      {"sky_plain", &S::sky_plain, 0, 10, "first ½ of the sky's share ½ + ½ n.y"},
      {"sky_up", &S::sky_up, 0, 10, "½ of ½ n.y in the sky's share"},
      {"bounce", &S::bounce, 0, kBright, "light from the slopes across; unset: of the hour"},
      {"bounce_plain", &S::bounce_plain, 0, 10, "0.2 of its share 0.2 + 0.8 n·across"},
      {"bounce_facing", &S::bounce_facing, 0, 10, "0.8 of the share 0.2 + 0.8 n·across"},
      {"specular", &S::specular, 0, kBright, "light of the gloss; unset: of the hour"},
      {"gloss_exponent", &S::gloss_exponent, 0, 1e4, "16 of the gloss (n·h)¹⁶"},
      {"fresnel_plain", &S::fresnel_plain, 0, 10, "0.04 of the Fresnel factor 0.04 + 0.96·(1 + h·v)⁵"},
      {"fresnel_gain", &S::fresnel_gain, 0, 10, "0.96 of the Fresnel factor"},
      {"fresnel_exponent", &S::fresnel_exponent, 0, 100, "5 of the Fresnel factor"},
      {"gloss_plain", &S::gloss_plain, 0, 10, "0.7 of the gloss's factor 0.7 + 0.3·snow"},
      {"gloss_snow", &S::gloss_snow, 0, 10, "0.3 of the gloss's factor"},
      {"snow_rim", &S::snow_rim, 0, kBright, "light at the rim of snow, 0.65·(0.3, 0.5, 0.6) in the source; unset: of the hour"},
      {"rim_exponent", &S::rim_exponent, 0, 100, "4 of the rim's (1 + n·v)⁴"},
      {"rim_to", &S::rim_to, 1e-6, 10, "0.6 of the rim's ss(0, 0.6, reflected y)"},
  };
  return keys;
}

const Keys<TerrainSkySettings>& terrainSkyKeys() {
  using S = TerrainSkySettings;
  static const Keys<S> keys{
      {"color", &S::color, 0, kBright, "colour of the zenith"},
      {"darkening", &S::darkening, 0, 10, "0.5 of 0.5 y², by which the sky is darker"},
      {"haze", &S::haze, 0, kBright, "colour of the haze, 0.85·(0.7, 0.75, 0.85) in the source"},
      {"haze_exponent", &S::haze_exponent, 0, 1e3, "4 of the haze's share (1 − max(y, 0))⁴"},
      {"wide_lobe", &S::wide_lobe, 0, kBright, "widest glow around the sun, 0.25·(1, 0.7, 0.4) of s⁵ in the source"},
      {"middle_lobe", &S::middle_lobe, 0, kBright, "second glow, 0.25·(1, 0.8, 0.6) of s⁶⁴ in the source"},
      {"narrow_lobe", &S::narrow_lobe, 0, kBright, "narrowest glow, 0.2·(1, 0.8, 0.6) of s⁵¹² in the source"},
      {"wide_exponent", &S::wide_exponent, 0, 1e6, "5 of s⁵"},
      {"middle_exponent", &S::middle_exponent, 0, 1e6, "64 of s⁶⁴"},
      {"narrow_exponent", &S::narrow_exponent, 0, 1e6, "512 of s⁵¹²"},
      {"cloud", &S::cloud, 0, kBright, "colour of the sky's clouds"},
      {"cloud_share", &S::cloud_share, 0, 1, "½ of the clouds' opacity ½·ss(0.5, 0.8, fbm)"},
      {"cloud_from", &S::cloud_from, -1, 2, "0.5 of the clouds' opacity"},
      {"cloud_to", &S::cloud_to, -1, 2, "0.8 of the clouds' opacity"},
      {"cloud_height", &S::cloud_height, 0, 1e6, "height of the clouds, SC"},
      {"cloud_frequency", &S::cloud_frequency, 1e-9, 1e3, "0.0005 of the clouds' fbm(0.0005 xz/SC)"},
      {"horizon", &S::horizon, 0, kBright, "colour of the horizon, 0.68·(0.4, 0.65, 1) in the source"},
      {"horizon_exponent", &S::horizon_exponent, 0, 1e3, "16 of the horizon's share (1 − max(y, 0))¹⁶"},
  };
  return keys;
}

const Keys<TerrainFog>& terrainFogKeys() {
  using S = TerrainFog;
  static const Keys<S> keys{
      {"density", &S::density, 0, 1e3, "0.001 of the fog 1 − exp(−(0.001 t/SC)^1.5)"},
      {"exponent", &S::exponent, 1e-3, 100, "1.5 of the fog"},
      {"color", &S::color, 0, kBright, "colour of the fog, 0.65·(0.4, 0.65, 1) in the source"},
      {"scatter", &S::scatter, 0, kBright, "light that the air scatters, 0.3·(1, 0.7, 0.3) of s⁸ in the source"},
      {"scatter_exponent", &S::scatter_exponent, 0, 1e6, "8 of s⁸"},
  };
  return keys;
}

const Keys<TerrainPathSettings>& terrainPathKeys() {
  using S = TerrainPathSettings;
  static const Keys<S> keys{
      {"time_factor", &S::time_factor, -1e3, 1e3, "t of the path per second", KeyUse::kScript},
      {"radius", &S::radius, 0, 1e6, "radius of the path, SC", KeyUse::kScript},
      {"x_rate", &S::x_rate, -1e3, 1e3, "0.23 of the path's x, cos(0.23 t)", KeyUse::kScript},
      {"z_rate", &S::z_rate, -1e3, 1e3, "0.21 of the path's z, cos(1.5 + 0.21 t)", KeyUse::kScript},
      {"z_phase", &S::z_phase, -1e3, 1e3, "1.5 of the path's z", KeyUse::kScript},
      {"clearance", &S::clearance, -1e6, 1e6, "height of the camera above the ground, SC", KeyUse::kScript},
      {"sink", &S::sink, -1e6, 1e6, "how far the target is below the camera, SC", KeyUse::kScript},
      {"look_ahead", &S::look_ahead, 1e-6, 1e3, "3 of the target, which is on the path at t + 3", KeyUse::kScript},
      {"roll", &S::roll, -10, 10, "0.2 of the roll 0.2·cos(0.1 t), radians", KeyUse::kScript},
      {"roll_rate", &S::roll_rate, -1e3, 1e3, "0.1 of the roll", KeyUse::kScript},
      {"focal_length", &S::focal_length, 0.05, 1e3, "focal length in half heights of the picture", KeyUse::kScript},
  };
  return keys;
}

}  // namespace cloudbake
