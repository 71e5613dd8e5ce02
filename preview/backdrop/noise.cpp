// Value noise interpolates a hash h of each lattice point by w(t) = 6t⁵ − 15t⁴ + 10t³, whose first and second derivatives are 0 at 0 and 1
// (K. Perlin, "Improving Noise", SIGGRAPH 2002). In a cell with corners h00, h10, h01, h11:
//   n = h00 + (h10 − h00) w(x) + (h01 − h00) w(y) + (h00 − h10 − h01 + h11) w(x) w(y)
//   ∂n/∂x = w'(x) ((h10 − h00) + (h00 − h10 − h01 + h11) w(y))        w'(t) = 30 t²(t − 1)²
// (I. Quilez, "Value noise derivatives"). Gradient noise uses the linear functions g·(p − corner) instead of the hashes, |g| = 1,
// which adds the mean of the g to the derivatives. Its largest magnitude, at the centre of a cell, is √2/2, so it is scaled by √2.
#include "preview/backdrop/noise.h"

#include <array>
#include <cmath>

#include "preview/backdrop/lattice_hash.h"

namespace cloudbake {

namespace {

/// A coordinate's cell, and the blend to the next lattice point.
struct Axis {
  uint32_t low = 0, high = 0;   // lattice points, wrapped
  float part = 0;               // 0 … 1 in the cell
  float weight = 0, slope = 0;  // w and w'
};

Axis axisAt(float x, int period) {
  const float floor = std::floor(x), t = x - floor;
  int cell = int(floor), next = cell + 1;
  if (period > 0) {
    cell = ((cell % period) + period) % period;
    next = cell + 1 == period ? 0 : cell + 1;
  }
  return {uint32_t(cell), uint32_t(next), t, t * t * t * (t * (6 * t - 15) + 10), 30 * t * t * (t - 1) * (t - 1)};
}

/// A face of a cell: n = a + b w(x) + c w(y) + d w(x) w(y).
Noise2 joinCorners(float h00, float h10, float h01, float h11, const Axis& x, const Axis& y) {
  const float b = h10 - h00, c = h01 - h00, d = h00 - h10 - h01 + h11;
  return {h00 + b * x.weight + c * y.weight + d * x.weight * y.weight, {x.slope * (b + d * y.weight), y.slope * (c + d * x.weight)}};
}

// Inlined, so that the derivatives cost nothing if only the value is used.
[[gnu::always_inline]] inline Noise2 valueFace(uint32_t seed, const Axis& x, const Axis& y) {
  const uint32_t low = hashAlong(seed, y.low), high = hashAlong(seed, y.high);
  return joinCorners(unitFloat(hashAlong(low, x.low)), unitFloat(hashAlong(low, x.high)), unitFloat(hashAlong(high, x.low)),
                     unitFloat(hashAlong(high, x.high)), x, y);
}

// A unit vector from a hash, without sine and cosine: a point on a square's rim, projected to the circle.
Vec2 unitVector(uint32_t hash) {
  const float along = unitFloat(hash) * 4, part = along - std::floor(along);
  const float a = 2 * part - 1;
  const std::array<Vec2, 4> sides{{{1, a}, {-a, 1}, {-1, -a}, {a, -1}}};
  const Vec2 on_rim = sides[size_t(along)];
  const float scale = 1 / std::sqrt(1 + a * a);
  return {on_rim.x * scale, on_rim.y * scale};
}

void addScaled(Vec2& sum, Vec2 v, float factor) { sum = {sum.x + v.x * factor, sum.y + v.y * factor}; }
void addScaled(Vec3& sum, Vec3 v, float factor) { sum += v * factor; }

// Sums the octaves. `noise` takes the factor and the shift of the point, and the octave's settings. The shifts, which are exact in float,
// keep the lattices of the octaves apart. Where all lattices coincide, gradient noise would be 0 in all octaves.
template <typename Result, typename Noise>
Result sumOctaves(const FbmSettings& settings, const Noise& noise) {
  Result sum;
  float weight = 1, total = 0, frequency = 1;
  int period = settings.period;
  for (int i = 0; i < settings.octaves; ++i, weight *= settings.gain, frequency *= 2, period *= 2) {
    const Result octave = noise(frequency, float(i * i) * 0.3125F, NoiseSettings{settings.seed + uint32_t(i) * 0x632BE5ABU, period});
    sum.value += weight * octave.value;
    addScaled(sum.gradient, octave.gradient, weight * frequency);
    total += weight;
  }
  sum.value /= total;
  Result mean{sum.value, {}};
  addScaled(mean.gradient, sum.gradient, 1 / total);
  return mean;
}

// As sumOctaves, but only for values in [0, 1]. Stops once the octaves so far reach `limit`.
template <typename Noise>
float sumValues(const FbmSettings& settings, float limit, const Noise& noise) {
  float total = 0, weight = 1;
  for (int i = 0; i < settings.octaves; ++i, weight *= settings.gain) total += weight;
  float sum = 0, frequency = 1;
  int period = settings.period;
  weight = 1;
  for (int i = 0; i < settings.octaves; ++i, weight *= settings.gain, frequency *= 2, period *= 2) {
    sum += weight * noise(frequency, float(i * i) * 0.3125F, mix32(settings.seed + uint32_t(i) * 0x632BE5ABU), period);
    if (sum / total >= limit) break;
  }
  return sum / total;
}

Vec2 scaled(Vec2 p, float factor, float shift) { return {p.x * factor + shift, p.y * factor + shift}; }

}  // namespace

Noise2 valueNoise2(Vec2 p, const NoiseSettings& settings) {
  return valueFace(mix32(settings.seed), axisAt(p.x, settings.period), axisAt(p.y, settings.period));
}

Noise3 valueNoise3(Vec3 p, const NoiseSettings& settings) {
  const Axis x = axisAt(p.x, settings.period), y = axisAt(p.y, settings.period), z = axisAt(p.z, settings.period);
  const uint32_t seed = mix32(settings.seed);
  const Noise2 low = valueFace(hashAlong(seed, z.low), x, y), high = valueFace(hashAlong(seed, z.high), x, y);
  const auto between = [&](float a, float b) { return a + (b - a) * z.weight; };
  return {between(low.value, high.value),
          {between(low.gradient.x, high.gradient.x), between(low.gradient.y, high.gradient.y), z.slope * (high.value - low.value)}};
}

Noise2 gradientNoise2(Vec2 p, const NoiseSettings& settings) {
  const Axis x = axisAt(p.x, settings.period), y = axisAt(p.y, settings.period);
  const uint32_t seed = mix32(settings.seed), low = hashAlong(seed, y.low), high = hashAlong(seed, y.high);
  const Vec2 g00 = unitVector(hashAlong(low, x.low)), g10 = unitVector(hashAlong(low, x.high));
  const Vec2 g01 = unitVector(hashAlong(high, x.low)), g11 = unitVector(hashAlong(high, x.high));

  const float u = x.part, v = y.part;
  const Noise2 n =
      joinCorners(g00.x * u + g00.y * v, g10.x * (u - 1) + g10.y * v, g01.x * u + g01.y * (v - 1), g11.x * (u - 1) + g11.y * (v - 1), x, y);
  const Noise2 mean_x = joinCorners(g00.x, g10.x, g01.x, g11.x, x, y), mean_y = joinCorners(g00.y, g10.y, g01.y, g11.y, x, y);
  constexpr float kScale = 1.41421356F;
  return {kScale * n.value, {kScale * (n.gradient.x + mean_x.value), kScale * (n.gradient.y + mean_y.value)}};
}

Noise2 fbmValue2(Vec2 p, const FbmSettings& settings) {
  return sumOctaves<Noise2>(settings, [p](float f, float shift, const NoiseSettings& s) { return valueNoise2(scaled(p, f, shift), s); });
}

Noise3 fbmValue3(Vec3 p, const FbmSettings& settings) {
  return sumOctaves<Noise3>(settings, [p](float f, float shift, const NoiseSettings& s) {
    return valueNoise3(p * f + Vec3{shift, shift, shift}, s);
  });
}

float fbmValueOnly2(Vec2 p, const FbmSettings& settings) {
  return sumValues(settings, INFINITY, [p](float f, float shift, uint32_t seed, int period) {
    const Vec2 q = scaled(p, f, shift);
    return valueFace(seed, axisAt(q.x, period), axisAt(q.y, period)).value;
  });
}

float fbmValueOnly3(Vec3 p, const FbmSettings& settings, float limit) {
  return sumValues(settings, limit, [p](float f, float shift, uint32_t seed, int period) {
    const Vec3 q = p * f + Vec3{shift, shift, shift};
    const Axis x = axisAt(q.x, period), y = axisAt(q.y, period), z = axisAt(q.z, period);
    const float low = valueFace(hashAlong(seed, z.low), x, y).value, high = valueFace(hashAlong(seed, z.high), x, y).value;
    return low + (high - low) * z.weight;
  });
}

Noise2 fbmGradient2(Vec2 p, const FbmSettings& settings) {
  return sumOctaves<Noise2>(settings, [p](float f, float shift, const NoiseSettings& s) { return gradientNoise2(scaled(p, f, shift), s); });
}

}  // namespace cloudbake
