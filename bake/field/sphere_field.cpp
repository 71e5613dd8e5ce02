// Union: u(x) = −k ln Σ exp(−dᵢ(x)/k) with dᵢ = |x − cᵢ| − rᵢ, the exponential smooth minimum. It does not depend on the order of the
// spheres, is 1-Lipschitz, and tends to min dᵢ, the exact union, for k → 0. Its gradient is the mean of the unit vectors from the
// centres, weighted by exp(−dᵢ/k).
//
// Noise: u − A n(x/size) with n in [0, 1] from bake/field/billow_noise.h. If A |∇n| < 1, it decreases along the straight line from x to the
// centre of the nearest sphere, because dᵢ falls by 1 per unit of length. So every bump on an exact union is attached to its sphere.
//
// Flat base: the smooth maximum w = k ln (exp(a/k) + exp(b/k)) of that value and the half-space base − y, with a k of its own. Its bumps
// lower the base by B m(x/size), where m is the same noise at y = 0: the base stays a height over the ground, however steep.
//
// With noise, |∇w| can reach 1 + A max |∇n| < 2, and 1 + B max |∇m| < 2. So φ = w / max(1, |∇w|), which does not move the surface w = 0.
#include "bake/field/sphere_field.h"

#include <algorithm>
#include <cmath>

#include "core/exp_log.h"

namespace cloudbake {

namespace {

constexpr float kNothing = 18;     // 1 + e⁻¹⁸ rounds to 1
constexpr float kBlendReach = 12;  // e⁻¹² of a sphere's weight is below float's rounding of φ

float smoothMaximum(float a, float b, float k) {
  const float high = std::max(a, b), low = std::min(a, b);
  return high - low < kNothing * k ? high - k * minusLog(1 + expMinus((high - low) / k)) : high;
}

// ∂/∂a of the same.
float weightOfFirst(float a, float b, float k) {
  const float less = k > 0 ? expMinus(std::fabs(a - b) / k) : 0;
  return (a > b ? 1 : less) / (1 + less);
}

// Most of the time of a level set is spent here. Pointers have no checks of their ends.
float unionAt(Vec3 x, std::span<const IndexSphere> spheres, std::vector<float>& distances, float k) {
  const size_t count = spheres.size();
  const IndexSphere* sphere = spheres.data();
  float* distance = distances.data();
  float nearest = INFINITY;
  for (size_t i = 0; i < count; ++i) {
    const Vec3 v = x - sphere[i].center;
    distance[i] = std::sqrt(dot(v, v)) - sphere[i].radius;
    nearest = std::min(nearest, distance[i]);
  }
  if (!(k > 0) || count < 2) return nearest;
  // The exponents that count are collected without branches, for loops that a compiler vectorises.
  float sum = 0;
  const float per_k = 1 / k;
  constexpr size_t kTogether = 32, kLanes = 4;
  float terms[kTogether];
  for (size_t begin = 0; begin < count; begin += kTogether) {
    size_t found = 0;
    for (size_t i = begin; i < std::min(begin + kTogether, count); ++i) {
      terms[found] = (distance[i] - nearest) * per_k;
      found += terms[found] < kBlendReach;
    }
    size_t filled = found;
    while (filled % kLanes != 0) terms[filled++] = 0;
    for (size_t i = 0; i < filled; ++i) terms[i] = expMinus(terms[i]);
    for (size_t i = 0; i < found; ++i) sum += terms[i];
  }
  return sum > 1 ? nearest + k * minusLog(sum) : nearest;
}

// Uses u(x) and the distances that unionAt found there: Σ exp((u − dᵢ)/k) = 1. Weights below e⁻⁸ do not change the gradient visibly.
Vec3 unionGradient(Vec3 x, float u, std::span<const IndexSphere> spheres, const std::vector<float>& distances, float k) {
  Vec3 gradient;
  for (size_t i = 0; i < spheres.size(); ++i) {
    if (distances[i] - u > 8 * k) continue;
    const float weight = k > 0 ? expMinus((distances[i] - u) / k) : 1, from_center = distances[i] + spheres[i].radius;
    if (from_center > 0) gradient += (x - spheres[i].center) * (weight / from_center);
    if (!(k > 0)) break;
  }
  return gradient;
}

float withBase(float phi, float y, const SphereField& field) {
  return field.base_voxels ? smoothMaximum(phi, *field.base_voxels - y, field.base_k_voxels) : phi;
}

NoiseSample bumps(const std::optional<BillowNoise>& noise, Vec3 x) {
  if (!noise) return {0, {}};
  const NoiseSample sample = billow(x / noise->size, noise->octaves, noise->seed);
  return {noise->amplitude * sample.value, noise->amplitude / noise->size * sample.gradient};
}

float withNoise(float phi, Vec3 x, std::span<const IndexSphere> spheres, const std::vector<float>& distances, const SphereField& field) {
  // Noises are in [0, 1], and w exceeds the larger of its two arguments by less than k. So most points are beyond the band for any noise.
  const float over_base = field.base_voxels ? *field.base_voxels - x.y : -INFINITY, beyond = field.steepest * field.band_voxels;
  const float lowest = std::max(phi - field.amplitude(), over_base - field.baseAmplitude());
  const float highest = std::max(phi, over_base) + field.base_k_voxels;
  if (lowest >= beyond) return lowest;
  if (highest <= -beyond) return highest;

  const NoiseSample noise = bumps(field.noise, x);
  NoiseSample hanging = bumps(field.base_bumps, {x.x, 0, x.z});
  hanging.gradient.y = 0;
  const float bumpy = phi - noise.value, bumpy_base = over_base - hanging.value;
  const float w = field.base_voxels ? smoothMaximum(bumpy, bumpy_base, field.base_k_voxels) : bumpy;

  // The same test with the slopes of the noises here. If it does not decide, use the gradient of w.
  const float steepest = 1 + std::sqrt(std::max(dot(noise.gradient, noise.gradient), dot(hanging.gradient, hanging.gradient)));
  if (std::fabs(w) >= steepest * field.band_voxels) return w;
  Vec3 gradient = unionGradient(x, phi, spheres, distances, field.k_voxels) - noise.gradient;
  if (field.base_voxels) {
    const float weight = weightOfFirst(bumpy, bumpy_base, field.base_k_voxels);
    gradient = weight * gradient - (1 - weight) * (Vec3{0, 1, 0} + hanging.gradient);
  }
  return w / std::max(1.0F, std::sqrt(dot(gradient, gradient)));
}

}  // namespace

float sphereFieldAt(Vec3 x, std::span<const IndexSphere> spheres, std::vector<float>& distances, const SphereField& field) {
  const float phi = unionAt(x, spheres, distances, field.k_voxels);
  return field.noise || field.base_bumps ? withNoise(phi, x, spheres, distances, field) : withBase(phi, x.y, field);
}

// |d(x) − d(center)| ≤ radius for all x around the centre.
std::vector<IndexSphere> spheresNear(Vec3 center, float radius, std::span<const IndexSphere> spheres, const SphereField& field) {
  float nearest = INFINITY;
  std::vector<float> distances(spheres.size());
  for (size_t i = 0; i < spheres.size(); ++i) {
    distances[i] = length(center - spheres[i].center) - spheres[i].radius;
    nearest = std::min(nearest, distances[i]);
  }
  std::vector<IndexSphere> near;
  const float highest = std::min(nearest + radius, field.farthestThatCounts() + radius) + radius + kBlendReach * field.k_voxels;
  for (size_t i = 0; i < spheres.size(); ++i)
    if (distances[i] <= highest) near.push_back(spheres[i]);
  return near;
}

// The union is 1-Lipschitz, also with a base. Noise lowers it by 0 … amplitude, and bumps of the base the base.
bool isBeyondBand(Vec3 center, float radius, std::span<const IndexSphere> spheres, std::vector<float>& distances,
                  const SphereField& field) {
  const float phi = unionAt(center, spheres, distances, field.k_voxels), beyond = field.steepest * field.band_voxels + radius;
  return withBase(phi - field.amplitude(), center.y + field.baseAmplitude(), field) > beyond || withBase(phi, center.y, field) < -beyond;
}

}  // namespace cloudbake
