// "Volumetric Clouds and Mega-Particles", the image chain, as "On Mesh Cloud Rendering" (2019-06-30; project maajor/Mesh-Cloud-Rendering,
// after Sea of Thieves) has it:
//   blur       w(x) = exp(−x²/(2 s²)), x = 0, ±1, ±2, ±3, normalised;  s = lerp(10, 0.1, A)
//   distortion C(p) = (1 − w) C(p − φ₁ f(p)) + w C(p − φ₂ f(p)),  φ₁ = frac(t), φ₂ = frac(t + 1/2), w = |2 φ₁ − 1|
//   composite  cloud = lerp(ambient_ground, sun, R) + lerp(ambient_ground, ambient_sky, G),  result = lerp(background, cloud, B)
// The flow f = (∂n/∂y, −∂n/∂x) of a noise n has no divergence. Means of pixels follow ChannelMean.
#include "preview/mesh_clouds/post.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "preview/backdrop/noise_kernels.h"
#include "preview/mesh_clouds/lit_mesh.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// The four pixels about a point in the image's own pixel coordinates (the first pixel's centre is at (0.5, 0.5)).
void addBilinear(const Image4& image, float x, float y, float weight, ChannelSum& sum) {
  const float left = std::clamp(x - 0.5F, 0.0F, float(image.width - 1)), top = std::clamp(y - 0.5F, 0.0F, float(image.height - 1));
  const int x0 = int(left), y0 = int(top), x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  const float part_x = left - float(x0), part_y = top - float(y0);
  sum.add(image.at(x0, y0), weight * (1 - part_x) * (1 - part_y));
  sum.add(image.at(x1, y0), weight * part_x * (1 - part_y));
  sum.add(image.at(x0, y1), weight * (1 - part_x) * part_y);
  sum.add(image.at(x1, y1), weight * part_x * part_y);
}

// Weights at x = 0 … 3, normalised over all seven; weights too small to change a float sum are 0.
std::array<float, 4> tapWeights(float sigma, bool as_quoted) {
  const float scale = as_quoted ? -2 / (sigma * sigma) : -0.5F / (sigma * sigma);
  std::array<float, 4> weights{1, std::exp(scale), std::exp(4 * scale), std::exp(9 * scale)};
  const float total = 1 + 2 * (weights[1] + weights[2] + weights[3]);
  for (float& w : weights) w = w < 0x1p-24F ? 0 : w / total;
  return weights;
}

// One direction of the blur: (1, 0) or (0, 1).
Image4 blurAlong(const Image4& image, int step_x, int step_y, const BlurSettings& settings) {
  Image4 result = image;
  parallelFor(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      const Rgba& center = image.at(x, y);
      const auto weights = tapWeights(lerp(settings.near_sigma, settings.far_sigma, std::min(1.0F, center[3])), settings.as_quoted);
      if (weights[1] == 0) continue;
      ChannelSum sum(settings.mean);
      for (int tap = -3; tap <= 3; ++tap) {
        const int at_x = std::clamp(x + tap * step_x, 0, image.width - 1), at_y = std::clamp(y + tap * step_y, 0, image.height - 1);
        sum.add(image.at(at_x, at_y), weights[size_t(std::abs(tap))]);
      }
      result.at(x, y) = sum.value();
      result.at(x, y)[3] = center[3];
    }
  });
  return result;
}

/// A sum of depths and of their weights, for the two passes of a box filter.
struct WeightedDepth {
  float sum = 0, weight = 0;
};

/// Places in tiles, or flows there.
struct Vectors2 {
  std::vector<float> x, y;
  explicit Vectors2(size_t count) : x(count), y(count) {}
  size_t count() const { return x.size(); }
};

// No flow is longer: the gradient noise of an octave has slopes under 4, and the two octaves count 1 and 0.8.
constexpr float kLongestFlow = 4;

// `drift` is in tiles of the noise, and its y points up.
Vectors2 curlsOfNoise(const Vectors2& tiles, float tiles_per_tile, Vec2 drift, uint32_t seed) {
  FbmSettings octaves = kSwirlNoise;
  octaves.seed = seed;
  Vectors2 cells(tiles.count()), slopes(tiles.count());
  for (size_t i = 0; i < tiles.count(); ++i) {
    cells.x[i] = (tiles.x[i] * tiles_per_tile - drift.x) * float(kSwirlNoise.period);
    cells.y[i] = (tiles.y[i] * tiles_per_tile + drift.y) * float(kSwirlNoise.period);
  }
  fbmGradients2(cells.x.data(), cells.y.data(), tiles.count(), octaves, slopes.x.data(), slopes.y.data());
  for (size_t i = 0; i < tiles.count(); ++i) cells.x[i] = slopes.y[i] / kTypicalSlope, cells.y[i] = -slopes.x[i] / kTypicalSlope;
  return cells;
}

// As swirlFlow, at many places.
Vectors2 swirlFlows(const Vectors2& tiles, std::span<const float> depths, const DistortSettings& settings) {
  const NoiseDrift drift = noiseDrift(settings);
  Vectors2 flows = curlsOfNoise(tiles, 1, drift.near, settings.seed);
  const Vectors2 far = curlsOfNoise(tiles, settings.far_tiles, drift.far, settings.seed + 1);
  for (size_t i = 0; i < flows.count(); ++i) {
    flows.x[i] = lerp(flows.x[i], far.x[i], depths[i]);
    flows.y[i] = lerp(flows.y[i], far.y[i], depths[i]);
  }
  return flows;
}

}  // namespace

Image4 resampleBilinear(const Image4& image, int width, int height, ChannelMean mean) {
  const float step_x = float(image.width) / float(width), step_y = float(image.height) / float(height);
  Image4 result = filledImage4(width, height, kNoCloud);
  parallelFor(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      ChannelSum sum(mean);
      addBilinear(image, (float(x) + 0.5F) * step_x, (float(y) + 0.5F) * step_y, 1, sum);
      result.at(x, y) = sum.value();
    }
  });
  return result;
}

const Image4& atSize(const Image4& channels, int width, int height, ChannelMean mean, Image4& resampled) {
  if (channels.width == width && channels.height == height) return channels;
  return resampled = resampleBilinear(channels, width, height, mean);
}

Image4 blurByDepth(const Image4& image, const BlurSettings& settings) {
  return blurAlong(blurAlong(image, 1, 0, settings), 0, 1, settings);
}

// B is its least value of the nine.
Image4 shrunk(const Image4& image, int step) {
  if (step <= 0) return image;
  Image4 result = image;
  parallelFor(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x)
      for (const int j : {-step, 0, step})
        for (const int i : {-step, 0, step}) {
          const Rgba& other = image.at(std::clamp(x + i, 0, image.width - 1), std::clamp(y + j, 0, image.height - 1));
          result.at(x, y)[2] = std::min(result.at(x, y)[2], other[2]);
        }
  });
  return result;
}

Image4 blurDepth(const Image4& image, const DepthBlurSettings& settings) {
  if (settings.radius <= 0) return shrunk(image, settings.shrink);
  const int radius = settings.radius;
  std::vector<WeightedDepth> rows(image.pixels.size());
  parallelFor(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      WeightedDepth& total = rows[size_t(y) * size_t(image.width) + size_t(x)];
      for (int i = x - radius; i <= x + radius; ++i) {
        const Rgba& pixel = image.at(std::clamp(i, 0, image.width - 1), y);
        const float weight = settings.mean == ChannelMean::kCovered ? pixel[2] : 1;
        total.sum += weight * pixel[3];
        total.weight += weight;
      }
    }
  });
  Image4 result = shrunk(image, settings.shrink);
  parallelFor(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      WeightedDepth total;
      for (int j = y - radius; j <= y + radius; ++j) {
        const WeightedDepth& row = rows[size_t(std::clamp(j, 0, image.height - 1)) * size_t(image.width) + size_t(x)];
        total.sum += row.sum;
        total.weight += row.weight;
      }
      if (total.weight > 0) result.at(x, y)[3] = total.sum / total.weight;
    }
  });
  return result;
}

NoiseDrift noiseDrift(const DistortSettings& settings) {
  const double cycles = settings.time_seconds * double(settings.swirl_speed);
  const auto moved = [&](Vec2 drift, double tiles) -> Vec2 {
    const double x = cycles * drift.x * tiles, y = cycles * drift.y * tiles;
    return {float(x - std::floor(x)), float(y - std::floor(y))};
  };
  return {moved(settings.near_drift, 1), moved(settings.far_drift, settings.far_tiles)};
}

std::optional<double> cyclesOfLoop(const DistortSettings& settings) {
  constexpr int kMostHalves = 32;
  const double far = settings.far_tiles;
  const std::array tiles{double(settings.near_drift.x), double(settings.near_drift.y), far * settings.far_drift.x,
                         far * settings.far_drift.y};  // in a cycle
  for (int halves = 1; halves <= kMostHalves; ++halves)
    if (std::ranges::all_of(tiles, [&](double of_cycle) { return std::fmod(of_cycle * halves / 2, 1) == 0; })) return double(halves) / 2;
  return std::nullopt;
}

Vec2 swirlFlow(Vec2 tiles, float depth, const DistortSettings& settings) {
  Vectors2 place(1);
  place.x[0] = tiles.x, place.y[0] = tiles.y;
  const Vectors2 flow = swirlFlows(place, {&depth, 1}, settings);
  return {flow.x[0], flow.y[0]};
}

FlowPhases flowPhases(double time_seconds, float swirl_speed) {
  const double cycles = time_seconds * double(swirl_speed), later = cycles + 0.5;
  const auto first = float(cycles - std::floor(cycles)), second = float(later - std::floor(later));
  return {first, second, std::abs(2 * first - 1)};
}

float darkness(Vec2 tiles, const DistortSettings& settings) {
  if (settings.dark >= 1) return 1;
  const NoiseDrift drift = noiseDrift(settings);
  const auto valueAt = [&](float x, float y, uint32_t seed) {
    return valueNoise3(Vec3{x, y, 0} * float(kSwirlNoise.period), {.seed = seed, .period = kSwirlNoise.period}).value;
  };
  const float far_x = tiles.x * settings.far_tiles, far_y = tiles.y * settings.far_tiles;
  return lerp(settings.dark, 1,
              valueAt(tiles.x - drift.near.x, tiles.y + drift.near.y, settings.seed + 2) *
                  valueAt(far_x - drift.far.x, far_y + drift.far.y, settings.seed + 3));
}

Image4 distort(const Image4& image, const DistortSettings& settings) {
  if (!(settings.swirl_strength > 0) && settings.dark >= 1) return image;
  const FlowPhases phases = flowPhases(settings.time_seconds, settings.swirl_speed);
  const float height = float(image.height);
  const PixelBox box = cloudBox(image, kLongestFlow * height * settings.swirl_strength * std::max(1.0F, settings.far_strength) + 1);
  Image4 result = image;
  parallelFor(box.bottom - box.top, [&](int row) {
    const int y = box.top + row;
    Vectors2 tiles(size_t(box.width()));
    std::vector<float> depths(tiles.count());
    const float at_y = float(y) + 0.5F;
    for (size_t i = 0; i < tiles.count(); ++i) {
      const int x = box.left + int(i);
      tiles.x[i] = (float(x) + 0.5F) / (height * settings.tile_size);
      tiles.y[i] = at_y / (height * settings.tile_size);
      depths[i] = std::min(1.0F, image.at(x, y)[3]);
    }
    const Vectors2 flows = swirlFlows(tiles, depths, settings);
    for (size_t i = 0; i < tiles.count(); ++i) {
      const int x = box.left + int(i);
      const float depth = depths[i], at_x = float(x) + 0.5F;
      const float strength = height * settings.swirl_strength * lerp(1, settings.far_strength, depth);
      const float dx = flows.x[i] * strength, dy = flows.y[i] * strength;
      ChannelSum sum(settings.mean);
      addBilinear(image, at_x - phases.first * dx, at_y - phases.first * dy, 1 - phases.second_weight, sum);
      addBilinear(image, at_x - phases.second * dx, at_y - phases.second * dy, phases.second_weight, sum);
      Rgba& p = result.at(x, y) = sum.value();
      const float dark = darkness({tiles.x[i], tiles.y[i]}, settings);
      p[0] *= dark, p[1] *= dark;
    }
  });
  return result;
}

float phaseFactor(Vec3 view, Vec3 to_sun, const PhaseSettings& settings) {
  if (!(settings.share > 0)) return 1;
  return 1 + settings.share * (std::min(henyeyGreenstein(dot(view, to_sun), settings.asymmetry), settings.limit) - 1);
}

CloudLight cloudLight(const SkySettings& sky) { return {lightColors(sky), keyLight(sky).direction}; }

Vec3 lightOfCloud(const Rgba& channels, Vec3 view, const CloudLight& light, const PhaseSettings& settings) {
  SkyColors colors = light.colors;
  colors.sun_color = colors.sun_color * phaseFactor(view, light.to_light, settings);
  return cloudColor({channels[0], channels[1]}, colors);
}

ColorPixels::ColorPixels(const ColorChannels& colors, int width, int height, ChannelMean mean, Vec3 otherwise) : otherwise_(otherwise) {
  if (colors.empty()) return;
  red_green_ = &atSize(colors[0], width, height, mean, resampled_[0]);
  blue_ = &atSize(colors[1], width, height, mean, resampled_[1]);
  // The light may cover places nearby by another mean.
  for (Rgba& p : resampled_[0].pixels)
    if (!(p[2] > 0)) p[0] = otherwise.x, p[1] = otherwise.y;
  for (Rgba& p : resampled_[1].pixels)
    if (!(p[2] > 0)) p[0] = otherwise.z;
}

Vec3 foggedCloud(const Rgba& channels, Vec3 view, const CloudLight& light, const CompositeSettings& settings, Vec3 lamps, Vec3 own) {
  const float fog = 1 - std::exp(-settings.fog_density * channels[3]);
  const Vec3 fog_color =
      settings.fog_color.value_or(light.colors.horizon) + scatteredLight(view, light.to_light, light.colors.sun_color, settings.scatter);
  return lerp((lightOfCloud(channels, view, light, settings.phase) + lamps) * own, fog_color, fog);
}

Image composite(const Image4& channels, const Image& background, const Camera& camera, const SkySettings& sky,
                const CompositeSettings& settings, const CloudColors& colors) {
  Image4 resampled;
  const ColorPixels lamps(colors.lamps, background.width, background.height, settings.mean, {});
  const ColorPixels own(colors.own, background.width, background.height, ChannelMean::kCovered, {1, 1, 1});
  const Image4& full = atSize(channels, background.width, background.height, settings.mean, resampled);
  Image result = background;
  const CloudLight light = cloudLight(sky);
  const CameraRays rays(camera);
  parallelFor(background.height, [&](int y) {
    for (int x = 0; x < background.width; ++x) {
      const Rgba& pixel = full.at(x, y);
      if (!(pixel[2] > 0)) continue;
      const Vec3 view = rays.at(float(x) + 0.5F, float(y) + 0.5F).direction;
      const Vec3 color = foggedCloud(pixel, view, light, settings, lamps.at(x, y), own.at(x, y));
      result.at(x, y) = color * pixel[2] + background.at(x, y) * (1 - pixel[2]);
    }
  });
  return result;
}

// --- Keys ---

const Keys<PhaseSettings>& phaseKeys() {
  using S = PhaseSettings;
  static const Keys<S> keys{
      {"phase", &S::share, 0, 1, "share of the phase term, by which clouds shine around the sun"},
      {"phase_asymmetry", &S::asymmetry, 0, 0.99, "g of Henyey and Greenstein's phase function"},
      {"phase_limit", &S::limit, 0, kBright, "largest value of the phase function that counts"},
  };
  return keys;
}

const Keys<CompositeSettings>& chainFogKeys() {
  using S = CompositeSettings;
  static const Keys<S> keys{
      {"density", &S::fog_density, 0, 1e3, "density of the chain's fog on mesh clouds, 1 − exp(−density·depth)"},
  };
  return keys;
}

const Keys<DistortSettings>& distortKeys() {
  using S = DistortSettings;
  static const Keys<S> keys{
      {"tile_size", &S::tile_size, 1e-3, 1e3, "tile of the near noise, heights of the picture"},
      {"far_tiles", &S::far_tiles, 1e-3, 1e3, "far tiles per near tile"},
      {"swirl_strength", &S::swirl_strength, 0, 10, "how far the near noise moves a pixel, heights of the picture"},
      {"far_strength", &S::far_strength, 0, 10, "strength of the far noise, relative to swirl_strength"},
      {"swirl_speed", &S::swirl_speed, 0, 1e3, "cycles of the swirls per second"},
      {"near_drift", &S::near_drift, -100, 100, "how far the near noise moves to the right and up in one cycle, near tiles"},
      {"far_drift", &S::far_drift, -100, 100, "how far the far noise moves to the right and up in one cycle, near tiles"},
      {"dark", &S::dark, 0, 1, "factor of the light where two noises are least; 1: none, 0.8 in maajor/Mesh-Cloud-Rendering"},
      {"seed", &S::seed, 0, kMostSeed, "selects other swirls and another erosion"},
  };
  return keys;
}

const Keys<BlurSettings>& blurKeys() {
  using S = BlurSettings;
  static const Keys<S> keys{
      {"near_sigma", &S::near_sigma, 1e-3, 1e3, "s of the blur exp(−x²/(2 s²)) at depth 0, pixels"},
      {"far_sigma", &S::far_sigma, 1e-3, 1e3, "s of the blur at depth 1, pixels"},
      {"blur_as_quoted", &S::as_quoted, 0, 1, "the blur has the weights exp(−2x²/s²), as the quoted code has them"},
  };
  return keys;
}

const Keys<DepthBlurSettings>& depthBlurKeys() {
  using S = DepthBlurSettings;
  static const Keys<S> keys{
      {"depth_blur_radius", &S::radius, 0, 64, "radius of the box blur of the depth, pixels"},
      {"shrink", &S::shrink, 0, 64,
       "the opacity becomes its least value here and at eight places so many pixels away; 2 in maajor/Mesh-Cloud-Rendering"},
  };
  return keys;
}

}  // namespace cloudbake
