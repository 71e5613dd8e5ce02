// rms = √(mean (a − b)²),  PSNR = 20 log₁₀(peak/rms), and
// Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to Structural Similarity" (IEEE TIP 13(4), 2004):
//   SSIM = (2 μ_a μ_b + C₁)(2 σ_ab + C₂) / ((μ_a² + μ_b² + C₁)(σ_a² + σ_b² + C₂)),   C₁ = (0.01 peak)², C₂ = (0.03 peak)²
// with means and (co)variances under an 11 × 11 Gaussian of σ = 1.5 that sums to 1, on the luminance 0.2126 R + 0.7152 G + 0.0722 B
// (ITU-R BT.709), averaged over the windows that are inside the picture. Sums are double and in a fixed order.
#include "preview/compare/image_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "core/parallel.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

constexpr int kRadius = 5, kWindow = 2 * kRadius + 1;

void checkSizes(const Image& a, const Image& b, std::span<const uint8_t> mask) {
  if (a.width != b.width || a.height != b.height) throw std::invalid_argument("image error: the pictures differ in size");
  if (!mask.empty() && mask.size() != a.pixels.size()) throw std::invalid_argument("image error: the mask has another size");
}

bool counts(std::span<const uint8_t> mask, size_t pixel) { return mask.empty() || mask[pixel] != 0; }

double squaredError(Vec3 a, Vec3 b) {
  const double x = double(a.x) - b.x, y = double(a.y) - b.y, z = double(a.z) - b.z;
  return (x * x + y * y + z * z) / 3;
}

std::vector<double> luminances(const Image& image) {
  std::vector<double> values;
  for (const Vec3& p : image.pixels) values.push_back(0.2126 * p.x + 0.7152 * p.y + 0.0722 * p.z);
  return values;
}

// The window is the product of this with itself.
std::array<double, kWindow> gaussian() {
  std::array<double, kWindow> weights;
  for (int i = 0; i < kWindow; ++i) weights[size_t(i)] = std::exp(-float((i - kRadius) * (i - kRadius)) / (2 * 1.5F * 1.5F));
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Weighted means over a window.
struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

double similarity(const Moments& mean, double peak) {
  const double c1 = 0.01 * peak * 0.01 * peak, c2 = 0.03 * peak * 0.03 * peak;
  const double variances = (mean.aa - mean.a * mean.a) + (mean.bb - mean.b * mean.b), covariance = mean.ab - mean.a * mean.b;
  return (2 * mean.a * mean.b + c1) * (2 * covariance + c2) / ((mean.a * mean.a + mean.b * mean.b + c1) * (variances + c2));
}

}  // namespace

PixelMask cloudMask(const Image& a, const Image& b, const Image& background, float threshold) {
  checkSizes(a, b, {});
  checkSizes(a, background, {});
  const auto differs = [threshold](Vec3 p, Vec3 q) {
    return std::abs(p.x - q.x) > threshold || std::abs(p.y - q.y) > threshold || std::abs(p.z - q.z) > threshold;
  };
  PixelMask mask(a.pixels.size());
  for (size_t i = 0; i < mask.size(); ++i)
    mask[i] = differs(a.pixels[i], background.pixels[i]) || differs(b.pixels[i], background.pixels[i]);
  return mask;
}

double imageRms(const Image& a, const Image& b, std::span<const uint8_t> mask) {
  checkSizes(a, b, mask);
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    if (!counts(mask, i)) continue;
    sum += squaredError(a.pixels[i], b.pixels[i]);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / double(count)) : 0;
}

float imagePsnr(const Image& a, const Image& b, std::span<const uint8_t> mask, float peak) {
  const double rms = imageRms(a, b, mask);
  return rms > 0 ? 20 * std::log10(float(peak / rms)) : std::numeric_limits<float>::infinity();
}

double imageSsim(const Image& a, const Image& b, std::span<const uint8_t> mask, float peak) {
  checkSizes(a, b, mask);
  const std::vector<double> first = luminances(a), second = luminances(b);
  const std::array<double, kWindow> weights = gaussian();
  const int rows = std::max(0, a.height - kWindow + 1);
  std::vector<double> sums(size_t(rows), 0.0), windows(size_t(rows), 0.0);
  parallelFor(rows, [&](int top) {
    for (int left = 0; left + kWindow <= a.width; ++left) {
      if (!counts(mask, size_t(top + kRadius) * size_t(a.width) + size_t(left + kRadius))) continue;
      Moments mean;
      for (int v = 0; v < kWindow; ++v)
        for (int u = 0; u < kWindow; ++u) {
          const size_t pixel = size_t(top + v) * size_t(a.width) + size_t(left + u);
          const double weight = weights[size_t(v)] * weights[size_t(u)], p = first[pixel], q = second[pixel];
          mean.a += weight * p, mean.b += weight * q;
          mean.aa += weight * (p * p), mean.bb += weight * (q * q), mean.ab += weight * (p * q);
        }
      sums[size_t(top)] += similarity(mean, peak);
      windows[size_t(top)] += 1;
    }
  });
  const double count = std::accumulate(windows.begin(), windows.end(), 0.0);
  return count > 0 ? std::accumulate(sums.begin(), sums.end(), 0.0) / count : 1;
}

Vec3 errorColor(float share) {
  constexpr Vec3 kGrey{0.3F, 0.3F, 0.3F}, kYellow{0.95F, 0.8F, 0.2F}, kRed{0.85F, 0.1F, 0.1F};
  const float t = 2 * saturate(share);
  return t < 1 ? lerp(kGrey, kYellow, t) : lerp(kYellow, kRed, t - 1);
}

double luminanceSpread(const Image& image, std::span<const uint8_t> mask) {
  checkSizes(image, image, mask);
  const std::vector<double> values = luminances(image);
  double sum = 0, squares = 0, count = 0;
  for (size_t i = 0; i < values.size(); ++i)
    if (counts(mask, i)) sum += values[i], squares += values[i] * values[i], ++count;
  return count == 0 ? 0 : std::sqrt(std::max(0.0, squares / count - sum / count * (sum / count)));
}

Image errorMap(const Image& a, const Image& b, float full_scale, std::span<const uint8_t> mask) {
  checkSizes(a, b, mask);
  Image map = blankImage(a.width, a.height);
  for (size_t i = 0; i < map.pixels.size(); ++i)
    if (counts(mask, i)) map.pixels[i] = errorColor(float(std::sqrt(squaredError(a.pixels[i], b.pixels[i]))) / full_scale);
  return map;
}

}  // namespace cloudbake
