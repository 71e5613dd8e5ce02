// Sums are in double, in the order of the vertices. Percentiles use the nearest rank.
#include "bake/truth/error_metrics.h"

#include <algorithm>
#include <cmath>

#include "core/lobe_lighting.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr double kLeastConcentration = 0.1;

double percentile(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return 0;
  const size_t rank = size_t(std::ceil(fraction * double(sorted.size())));
  return sorted[std::max<size_t>(rank, 1) - 1];
}

struct ErrorSum {
  double sum = 0, squares = 0;
  uint64_t count = 0;
  void add(double error) { sum += error, squares += error * error, ++count; }
  double mean() const { return count ? sum / double(count) : 0; }
  double rms() const { return count ? std::sqrt(squares / double(count)) : 0; }
};

}  // namespace

LobeError compareLobes(std::span<const Lobe> estimate, const Truth& truth) {
  LobeError error;
  error.vertices = estimate.size();
  std::vector<double> angles;
  ErrorSum angle_sum, density_sum;
  double true_density = 0;
  for (size_t v = 0; v < estimate.size(); ++v) {
    if (truth.concentration[v] < kLeastConcentration) {
      ++error.left_out;
      continue;
    }
    angles.push_back(angleDegrees(estimate[v].direction, truth.lobes[v].direction));
    angle_sum.add(angles.back());
    density_sum.add(double(estimate[v].thickness) - truth.lobes[v].thickness);
    true_density += truth.lobes[v].thickness;
  }
  if (angles.empty()) return error;
  std::sort(angles.begin(), angles.end());
  error.angle_rms_degrees = angle_sum.rms();
  error.angle_median_degrees = percentile(angles, 0.5);
  error.angle_p95_degrees = percentile(angles, 0.95);
  error.angle_max_degrees = angles.back();
  const double mean_density = true_density / double(angles.size());
  error.density_rms = mean_density > 0 ? density_sum.rms() / mean_density : 0;
  error.density_bias = mean_density > 0 ? density_sum.mean() / mean_density : 0;
  return error;
}

TransmittanceError compareLengths(std::span<const float> estimate, std::span<const float> truth, double extinction) {
  ErrorSum sum;
  for (size_t i = 0; i < estimate.size(); ++i) sum.add(portableExp(-extinction * estimate[i]) - portableExp(-extinction * truth[i]));
  return {sum.rms(), sum.mean()};
}

namespace {

// `shade` gives the light of a point from a direction, `true_light` that of point · #directions + direction.
template <class Shade, class TrueLight>
TransmittanceError compareShades(const Shade& shade, const TrueLight& true_light, size_t points, size_t directions,
                                 std::span<const float> weights) {
  double sum = 0, squares = 0, weight_sum = 0;
  for (size_t p = 0; p < points; ++p)
    for (size_t i = 0; i < directions; ++i) {
      const double weight = weights.empty() ? 1 : double(weights[i]);
      if (weight == 0) continue;
      const double error = double(shade(p, i)) - true_light(p * directions + i);
      sum += weight * error, squares += weight * error * error, weight_sum += weight;
    }
  if (weight_sum == 0) return {};
  return {std::sqrt(squares / weight_sum), sum / weight_sum};
}

template <class TrueLight>
TransmittanceError compareWith(const TrueLight& true_light, std::span<const Lobe> lobes, LobeShape shape, std::span<const Vec3> directions,
                               double extinction, std::span<const float> weights) {
  const auto shade = [&](size_t v, size_t i) { return lobeTransmittance(lobes[v], directions[i], shape, float(extinction)); };
  return compareShades(shade, true_light, lobes.size(), directions.size(), weights);
}

}  // namespace

TransmittanceError compareTransmittance(std::span<const Lobe> lobes, LobeShape shape, std::span<const Vec3> directions,
                                        std::span<const float> true_lengths, double extinction, std::span<const float> weights) {
  return compareWith([&](size_t i) { return portableExp(-extinction * true_lengths[i]); }, lobes, shape, directions, extinction, weights);
}

TransmittanceError compareLight(std::span<const Lobe> lobes, LobeShape shape, std::span<const Vec3> directions,
                                std::span<const float> true_light, double extinction, std::span<const float> weights) {
  return compareWith([&](size_t i) { return double(true_light[i]); }, lobes, shape, directions, extinction, weights);
}

SurfaceLightError compareOverSurface(std::span<const SurfacePoint> points, std::span<const Lobe> lobes, LobeShape shape,
                                     std::span<const Vec3> directions, std::span<const float> true_light, double extinction,
                                     std::span<const float> weights) {
  std::vector<Lobe> blended;
  for (const SurfacePoint& point : points) blended.push_back(blendedLobe(point, lobes));
  const auto truth = [&](size_t i) { return double(true_light[i]); };
  SurfaceLightError error;
  error.points = points.size();
  error.per_pixel = compareWith(truth, blended, shape, directions, extinction, weights);
  error.per_vertex =
      compareShades([&](size_t p, size_t i) { return blendedTransmittance(points[p], lobes, directions[i], shape, float(extinction)); },
                    truth, points.size(), directions.size(), weights);
  return error;
}

TransmittanceError compareLobeTransmittance(std::span<const Lobe> estimate, std::span<const Lobe> truth, LobeShape shape,
                                            std::span<const Vec3> directions, double extinction) {
  ErrorSum sum;
  for (size_t v = 0; v < estimate.size(); ++v)
    for (const Vec3& direction : directions)
      sum.add(double(lobeTransmittance(estimate[v], direction, shape, float(extinction))) -
              double(lobeTransmittance(truth[v], direction, shape, float(extinction))));
  return {sum.rms(), sum.mean()};
}

}  // namespace cloudbake
