// The light follows the axis a of the field most. With its slopes s_b = l_b/l_a and s_c = l_c/l_a (l in the cloud's own space), all cells
// on a way of the light meet the slice a = 0 at the place (b − s_b a, c − s_c a): on this sheared plane one bilinear tap per slice sums the
// way,
//   ℓ(u, v) = h/|l_a| Σ_a f(a, u + s_b a, v + s_c a),   A = 1 − exp(−σ ℓ).
// Means of A over squares are differences of sums (F. Crow, "Summed-Area Tables for Texture Mapping", SIGGRAPH 1984): a light that fills an
// angle spreads a shadow's edge by the distance times that angle.
#include "preview/mesh_clouds/cloud_shadow.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

std::array<double, 3> parts(Vec3 v) { return {v.x, v.y, v.z}; }

/// A slice of the field across an axis.
struct Slice {
  const ShadowCaster& caster;
  size_t axis, across, aside;
  int index;

  double cell(int b, int c) const {
    if (b < 0 || c < 0 || b >= caster.cells[across] || c >= caster.cells[aside]) return 0;
    std::array<size_t, 3> at{};
    at[axis] = size_t(index), at[across] = size_t(b), at[aside] = size_t(c);
    return caster.fractions[(at[2] * size_t(caster.cells[1]) + at[1]) * size_t(caster.cells[0]) + at[0]];
  }
  bool isEmpty() const {
    for (int c = 0; c < caster.cells[aside]; ++c)
      for (int b = 0; b < caster.cells[across]; ++b)
        if (cell(b, c) > 0) return false;
    return true;
  }
};

}  // namespace

CloudShadow::CloudShadow(const ShadowCaster& caster, const Affine& to_world, float extinction, Vec3 to_light,
                         const ShadowSettings& settings)
    : to_own_(inverted(to_world).value()), origin_(caster.origin), cell_size_(caster.cell_size) {
  const Vec3 own = transformVector(to_own_, to_light);
  const std::array<double, 3> l = parts(own);
  axis_ = size_t(std::max_element(l.begin(), l.end(), [](double p, double q) { return std::abs(p) < std::abs(q); }) - l.begin());
  across_ = (axis_ + 1) % 3, aside_ = (axis_ + 2) % 3;
  slope_across_ = l[across_] / l[axis_], slope_aside_ = l[aside_] / l[axis_];
  per_slice_ = double(cell_size_) / std::abs(l[axis_]);
  spread_ = std::tan(double(settings.softness_degrees) * kPi / 180) * double(length(own)) / std::abs(l[axis_]);
  light_is_above_ = l[axis_] > 0;

  // The plane holds every place that a slice is seen at, and a cell around.
  const int slices = caster.cells[axis_];
  const double far_across = -slope_across_ * (slices - 1), far_aside = -slope_aside_ * (slices - 1);
  left_ = int(std::floor(std::min(0.0, far_across))) - 1, bottom_ = int(std::floor(std::min(0.0, far_aside))) - 1;
  width_ = int(std::ceil(caster.cells[across_] - 1 + std::max(0.0, far_across))) + 2 - left_;
  height_ = int(std::ceil(caster.cells[aside_] - 1 + std::max(0.0, far_aside))) + 2 - bottom_;

  const auto slice = [&](int index) { return Slice{caster, axis_, across_, aside_, index}; };
  int first = 0, last = slices - 1;
  while (first < last && slice(first).isEmpty()) ++first;
  while (last > first && slice(last).isEmpty()) --last;
  low_ = first - 0.5, high_ = last + 0.5;

  std::vector<float> absorbed(size_t(width_) * size_t(height_));
  parallelFor(height_, [&](int j) {
    for (int i = 0; i < width_; ++i) {
      double sum = 0;
      for (int k = first; k <= last; ++k) {
        const Slice at = slice(k);
        const double b = left_ + i + slope_across_ * k, c = bottom_ + j + slope_aside_ * k;
        const double b0 = std::floor(b), c0 = std::floor(c), p = b - b0, q = c - c0;
        const int x = int(b0), y = int(c0);
        sum += (1 - q) * ((1 - p) * at.cell(x, y) + p * at.cell(x + 1, y)) + q * ((1 - p) * at.cell(x, y + 1) + p * at.cell(x + 1, y + 1));
      }
      const auto length = float(sum / 255 * per_slice_);
      absorbed[size_t(j) * size_t(width_) + size_t(i)] = settings.strength * (1 - std::exp(-extinction * length));
    }
  });
  sums_.assign(size_t(width_ + 1) * size_t(height_ + 1), 0);
  for (int j = 0; j < height_; ++j)
    for (int i = 0; i < width_; ++i) {
      const size_t stride = size_t(width_) + 1, at = size_t(j) * stride + size_t(i);
      sums_[at + stride + 1] = sums_[at + 1] + sums_[at + stride] - sums_[at] + double(absorbed[size_t(j) * size_t(width_) + size_t(i)]);
    }
}

double CloudShadow::integralTo(double u, double v) const {
  const double x = std::clamp(u - left_ + 0.5, 0.0, double(width_)), y = std::clamp(v - bottom_ + 0.5, 0.0, double(height_));
  const int x0 = std::min(int(x), width_ - 1), y0 = std::min(int(y), height_ - 1);
  const double p = x - x0, q = y - y0;
  const double* at = &sums_[size_t(y0) * (size_t(width_) + 1) + size_t(x0)];
  const double* above = at + width_ + 1;
  return (1 - q) * ((1 - p) * at[0] + p * at[1]) + q * ((1 - p) * above[0] + p * above[1]);
}

float CloudShadow::shareAt(Vec3 point) const {
  const std::array<double, 3> place = parts((transformPoint(to_own_, point) - origin_) / cell_size_);
  const double a = place[axis_], before = light_is_above_ ? (high_ - a) / (high_ - low_) : (a - low_) / (high_ - low_);
  const double share = std::clamp(before, 0.0, 1.0);  // of the way through the cloud that lies before the point
  if (!(share > 0)) return 1;
  const double u = place[across_] - slope_across_ * a, v = place[aside_] - slope_aside_ * a;
  const double middle = light_is_above_ ? (std::max(a, low_) + high_) / 2 : (std::min(a, high_) + low_) / 2;
  const double half = std::max(0.5, spread_ * std::abs(middle - a));
  const double sum =
      integralTo(u + half, v + half) - integralTo(u - half, v + half) - integralTo(u + half, v - half) + integralTo(u - half, v - half);
  const auto passed = float(std::clamp(1 - sum / (4 * half * half), 0.0, 1.0));
  return share < 1 ? std::pow(passed, float(share)) : passed;
}

}  // namespace cloudbake
