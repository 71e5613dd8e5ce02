#include "bake/lobe/volume_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/exp_log.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr float kOpaque = 6;  // optical depth behind which nothing is seen: a share of 0.0025 of the light is

}  // namespace

DepthNodes::DepthNodes(const VolumeTargetSettings& settings) : parts_(gaussParts(settings.depths)) {
  for (const float extinction : settings.extinctions) extinctions_.push_back(extinction * settings.light.view_extinction);
  const float least = *std::min_element(extinctions_.begin(), extinctions_.end());
  for (size_t i = 0; i < kEntries; ++i) {
    // From 0 to kOpaque at the least σ, finer in front
    const float share = float(i) / float(kEntries - 1), depth = kOpaque / least * share * share;
    depths_[i] = depth, opacities_[i] = opacity(depth);
  }
  const size_t nodes = parts_.size(), row = nodes * (1 + extinctions_.size());
  divided_.resize(kEntries * row);
  for (size_t i = 1; i < kEntries; ++i)
    divide(depths_[i], 1, std::span(divided_).subspan(i * row, nodes), std::span(divided_).subspan(i * row + nodes, row - nodes));
}

bool DepthNodes::divide(float length, float weight, std::span<float> depths, std::span<float> weights) const {
  const float whole = opacity(length);
  if (!(whole > 0)) return false;
  float begin = 0;
  for (size_t n = 0; n < parts_.size(); ++n) {
    const float end = n + 1 == parts_.size() ? length : std::min(depthAt(parts_[n].end * whole), length);
    depths[n] = std::min(depthAt(parts_[n].node * whole), length);
    for (size_t s = 0; s < extinctions_.size(); ++s)
      weights[n * extinctions_.size() + s] = weight * (expMinus(extinctions_[s] * begin) - expMinus(extinctions_[s] * end));
    begin = end;
  }
  return true;
}

bool DepthNodes::divideQuickly(float length, float weight, std::span<float> depths, std::span<float> weights) const {
  if (!(length > 0)) return false;
  const float at = std::min(std::sqrt(length / enough()), 1.0F) * float(kEntries - 1);
  const size_t entry = std::min(size_t(at), kEntries - 2), nodes = parts_.size(), row = nodes * (1 + extinctions_.size());
  const float part = at - float(entry);
  const float* low = divided_.data() + entry * row;
  const auto between = [&](size_t i) { return low[i] + part * (low[i + row] - low[i]); };
  for (size_t n = 0; n < nodes; ++n) depths[n] = std::min(between(n), length);
  for (size_t i = nodes; i < row; ++i) weights[i - nodes] = weight * between(i);
  return true;
}

// The nodes are the zeros of Legendre's polynomial of that degree, by Newton's method (Abramowitz and Stegun 1964, 25.4.30).
std::vector<DepthNodes::Part> DepthNodes::gaussParts(int count) {
  std::vector<Part> parts;
  double end = 0;
  for (int i = 0; i < count; ++i) {
    double x = -sinCosDegrees(180 * (i + 0.75) / (count + 0.5)).cos, slope = 1;
    for (int round = 0; round < 8; ++round) {
      double value = x, before = 1;  // P₁ and P₀
      for (int n = 2; n <= count; ++n) before = std::exchange(value, ((2 * n - 1) * x * value - (n - 1) * before) / n);
      slope = count * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    end += 1 / ((1 - x * x) * slope * slope);
    parts.push_back({float(0.5 + 0.5 * x), float(end)});
  }
  return parts;
}

float DepthNodes::opacity(float depth) const {
  float sum = 0;
  for (const float extinction : extinctions_) sum += 1 - expMinus(extinction * depth);
  return sum / float(extinctions_.size());
}

float DepthNodes::depthAt(float opacity) const {
  const auto above = std::upper_bound(opacities_.begin() + 1, opacities_.end() - 1, opacity);
  const size_t i = size_t(above - opacities_.begin());
  const float step = opacities_[i] - opacities_[i - 1];
  return depths_[i - 1] + (step > 0 ? std::clamp((opacity - opacities_[i - 1]) / step, 0.0F, 1.0F) : 0) * (depths_[i] - depths_[i - 1]);
}

float phaseOf(float asymmetry, float cosine) {
  const float square = 1 + asymmetry * asymmetry - 2 * asymmetry * cosine;
  return (1 - asymmetry * asymmetry) / (square * std::sqrt(square));
}

// One exponential that is twice another in its exponent is the square of it, as are all but the first where a = ½ and σ doubles.
LightTerms lightTerms(std::span<const float> extinctions, const OctaveSettings& octaves) {
  LightTerms terms;
  std::vector<float> needed, exponents;
  float weight = 1, sum = 0;
  for (int i = 0; i <= octaves.count; ++i) terms.octave_weights.push_back(weight), sum += weight, weight *= octaves.contribution;
  for (float& one : terms.octave_weights) one /= sum;
  for (const float extinction : extinctions) {
    float exponent = extinction;
    for (int i = 0; i <= octaves.count; ++i) needed.push_back(exponent), exponent *= octaves.extinction;
  }
  exponents = needed;
  std::sort(exponents.begin(), exponents.end());
  exponents.erase(std::unique(exponents.begin(), exponents.end()), exponents.end());
  for (size_t k = 0; k < exponents.size(); ++k) terms.exponentials.push_back({exponents[k], k > 0 && exponents[k] == 2 * exponents[k - 1]});
  for (const float exponent : needed)
    terms.used.push_back(uint32_t(std::lower_bound(exponents.begin(), exponents.end(), exponent) - exponents.begin()));
  return terms;
}

}  // namespace cloudbake
