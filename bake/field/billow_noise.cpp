// S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996. One feature point lies in every cell of the unit lattice; F1(x) is the
// distance to the nearest of them.
//   b(x) = 1 − min(1, F1(x)²)                        round bumps; points at a distance of 1 or more have no effect, so 27 cells suffice
//   n(x) = Σ 2⁻ᵏ b_k(2ᵏ x) / Σ 2⁻ᵏ,  k < octaves     every octave has its own points
// Where b is not flat, ∇b = −2 (x − nearest point) and F1 < 1, so |∇b| < 2. The chain rule's 2ᵏ cancels the weight 2⁻ᵏ:
//   |∇n| < 2 octaves / Σ 2⁻ᵏ = octaves / (1 − 2^−octaves)
#include "bake/field/billow_noise.h"

#include "core/random.h"

namespace cloudbake {

namespace {

// One coordinate relative to three cells of its axis, nearest first: 0 is its own cell, 1 the nearer neighbour, 2 the farther neighbour.
struct Axis {
  float offset[3];            // from the cell's lower corner to x
  float squared_distance[3];  // from x to the cell
  uint64_t key[3];            // the cell's contribution to the hash
};

Axis axisAt(float x, uint64_t multiplier) {
  int64_t cell = int64_t(x);
  cell -= x < float(cell);
  const float f = x - float(cell);
  const bool low = f < 0.5F;
  const float near = low ? f : 1 - f, far = 1 - near;
  const uint64_t own = uint64_t(cell) * multiplier, below = own - multiplier, above = own + multiplier;
  return {{f, low ? f + 1 : f - 1, low ? f - 1 : f + 1}, {0, near * near, far * far}, {own, low ? below : above, low ? above : below}};
}

// Converts 21 bits of a cell's hash to a coordinate in [0, 1).
float coordinate(uint64_t hash) { return float(int32_t(hash & 0x1FFFFF)) * 0x1p-21F; }

struct Nearest {
  float squared_distance;
  Vec3 to_x;  // 0 if no point is nearer than 1
};

Nearest nearestPoint(Vec3 p, uint64_t key) {
  const Axis x = axisAt(p.x, kGolden64), y = axisAt(p.y, mix64(kGolden64) | 1), z = axisAt(p.z, mix64(2 * kGolden64) | 1);
  Nearest nearest{1, {}};
  // A cell is skipped if its distance along one, two or three axes is not below the best distance so far.
  for (int i = 0; i < 3 && x.squared_distance[i] < nearest.squared_distance; ++i)
    for (int j = 0; j < 3; ++j) {
      const float squared_xy = x.squared_distance[i] + y.squared_distance[j];
      if (squared_xy >= nearest.squared_distance) break;
      for (int k = 0; k < 3 && squared_xy + z.squared_distance[k] < nearest.squared_distance; ++k) {
        const uint64_t hash = mix64(key + x.key[i] + y.key[j] + z.key[k]);
        const Vec3 v{x.offset[i] - coordinate(hash), y.offset[j] - coordinate(hash >> 21), z.offset[k] - coordinate(hash >> 42)};
        if (const float squared = dot(v, v); squared < nearest.squared_distance) nearest = {squared, v};
      }
    }
  return nearest;
}

}  // namespace

NoiseSample billow(Vec3 x, int octaves, uint64_t seed) {
  const uint64_t stream = mix64((seed + 1) * kGolden64);
  NoiseSample sum{0, {}};
  float weight = 1, weights = 0, frequency = 1;
  for (int octave = 0; octave < octaves; ++octave, weight *= 0.5F, frequency *= 2) {
    const Nearest nearest = nearestPoint(x * frequency, hashDraw(stream, uint32_t(octave), 0));
    sum.value += weight * (1 - nearest.squared_distance);
    sum.gradient += -2 * nearest.to_x;
    weights += weight;
  }
  return {sum.value / weights, sum.gradient / weights};
}

double billowSlope(int octaves) { return octaves / (1 - 1 / double(1 << octaves)); }

}  // namespace cloudbake
