// Archimedes: z is uniform on [−1, 1] for uniform directions, so a band of z of height 2n/N has the solid angle of n strata.
// Stratification: D. Mitchell, "Consequences of Stratified Sampling in Graphics", SIGGRAPH 1996. Spherical Fibonacci set:
// R. Marques et al., "Spherical Fibonacci Point Sets for Illumination Integrals", CGF 32(8), 2013. Uniform rotation: K. Shoemake,
// "Uniform Random Rotations", Graphics Gems III, 1992.
#include "bake/lobe/directions.h"

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "core/random.h"

namespace cloudbake {

namespace {

Vec3 fromCylinder(float z, float turns) {
  const float radius = std::sqrt(std::max(0.0F, 1 - z * z));
  const SinCos azimuth = sinCosDegrees(360 * double(turns));
  return {radius * float(azimuth.cos), radius * float(azimuth.sin), z};
}

struct Quaternion {
  float x, y, z, w;
};

Quaternion uniformRotation(uint64_t stream) {
  const float u0 = uniformFloat(hashDraw(stream, 0, 0)), u1 = uniformFloat(hashDraw(stream, 0, 1)),
              u2 = uniformFloat(hashDraw(stream, 0, 2));
  const float a = std::sqrt(1 - u0), b = std::sqrt(u0);
  const SinCos first = sinCosDegrees(360 * double(u1)), second = sinCosDegrees(360 * double(u2));
  return {a * float(first.sin), a * float(first.cos), b * float(second.sin), b * float(second.cos)};
}

Vec3 rotate(const Quaternion& q, Vec3 v) {
  const Vec3 axis{q.x, q.y, q.z}, t = 2.0F * cross(axis, v);
  return v + q.w * t + cross(axis, t);
}

}  // namespace

void stratifiedDirections(uint64_t stream, std::span<Vec3> out) {
  const int count = int(out.size()), bands = std::max(1, int(std::lround(std::sqrt(float(count)))));
  int j = 0;
  for (int band = 0; band < bands; ++band) {
    // The number of cells in this band. The remainder is spread evenly over the bands around the equator.
    const int first = int(int64_t(band) * count / bands), cells = int(int64_t(band + 1) * count / bands) - first;
    const float z_high = 1 - 2 * float(first) / float(count), height = 2 * float(cells) / float(count);
    for (int cell = 0; cell < cells; ++cell, ++j) {
      const float z = z_high - height * uniformFloat(hashDraw(stream, uint32_t(j), 0));
      out[size_t(j)] = fromCylinder(z, (float(cell) + uniformFloat(hashDraw(stream, uint32_t(j), 1))) / float(cells));
    }
  }
}

void uniformDirections(uint64_t stream, std::span<Vec3> out) {
  for (size_t j = 0; j < out.size(); ++j)
    out[j] = fromCylinder(1 - 2 * uniformFloat(hashDraw(stream, uint32_t(j), 0)), uniformFloat(hashDraw(stream, uint32_t(j), 1)));
}

std::vector<Vec3> fibonacciDirections(int count) {
  constexpr double kGoldenTurn = 0.6180339887498948482;  // 1/golden ratio
  std::vector<Vec3> directions;
  directions.reserve(size_t(count));
  for (int j = 0; j < count; ++j) {
    const double turns = j * kGoldenTurn;
    directions.push_back(fromCylinder(float(1 - (2.0 * j + 1) / count), float(turns - std::floor(turns))));
  }
  return directions;
}

void rotatedDirections(std::span<const Vec3> fixed, uint64_t stream, std::span<Vec3> out) {
  const Quaternion rotation = uniformRotation(stream);
  for (size_t j = 0; j < fixed.size(); ++j) out[j] = rotate(rotation, fixed[j]);
}

void sampleDirections(const BakeSettings& settings, std::span<const Vec3> fibonacci, uint64_t stream, std::span<Vec3> out) {
  switch (settings.sampler) {
    case Sampler::kStratified: return stratifiedDirections(stream, out);
    case Sampler::kUniform: return uniformDirections(stream, out);
    case Sampler::kFibonacci:
      if (settings.rotate_directions) return rotatedDirections(fibonacci, stream, out);
      std::copy(fibonacci.begin(), fibonacci.end(), out.begin());
  }
}

std::vector<size_t> coherentOrder(std::span<const Vec3> directions) {
  const auto keyOf = [](Vec3 d) {
    constexpr int kBits = 10;
    const float x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
    const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const float along[3] = {d.x, d.y, d.z}, major = along[axis];
    const auto cell = [&](int i) { return uint32_t((along[i % 3] / std::fabs(major) + 1) * ((1 << (kBits - 1)) - 1)); };
    const uint32_t u = cell(axis + 1), v = cell(axis + 2);
    auto key = uint32_t(2 * axis + (major < 0));
    for (int bit = kBits; bit-- > 0;) key = key << 2 | (u >> bit & 1) << 1 | (v >> bit & 1);
    return key;
  };
  std::vector<std::pair<uint32_t, size_t>> keys;
  for (size_t i = 0; i < directions.size(); ++i) keys.emplace_back(keyOf(directions[i]), i);
  std::sort(keys.begin(), keys.end());
  std::vector<size_t> order;
  for (const auto& [key, index] : keys) order.push_back(index);
  return order;
}

double concentrationNoise(Sampler sampler, int count) {
  const double factor = sampler == Sampler::kStratified ? 0.5 : sampler == Sampler::kUniform ? 2 : 0.01;
  return std::max(1e-6, factor / std::sqrt(double(count)));
}

Vec3 undefinedDirection(const BakePoints& points, size_t point) {
  const bool has_normal = !points.normals.empty() && !(points.normals[point] == Vec3{});
  return has_normal ? -points.normals[point] : Vec3{0, -1, 0};
}

void warnUndefined(uint64_t count, Warnings& warnings) {
  warnings.add(WarningKind::kUndefinedDirection,
               "a vertex has no mean occlusion direction (no cloud around it, or the same amount on every side): −normal was stored",
               count);
}

std::string_view samplerName(Sampler sampler) {
  switch (sampler) {
    case Sampler::kStratified: return "stratified";
    case Sampler::kFibonacci: return "fibonacci";
    case Sampler::kUniform: return "uniform";
  }
  return "unknown";
}

std::string_view quadratureName(Quadrature quadrature) {
  switch (quadrature) {
    case Quadrature::kCrossing: return "crossing";
    case Quadrature::kMidpoint: return "midpoint";
    case Quadrature::kEnd: return "end";
  }
  return "unknown";
}

}  // namespace cloudbake
