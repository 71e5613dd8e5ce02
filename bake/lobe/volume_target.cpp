// Every view that sees a point is marched once through the fractions of the field, which gives τ along it. The light is taken at a few
// depths per view, the same for all σ: the nodes of Gauss's quadrature over the opacity. Their ℓ towards all lights come from a sweep,
// like those of vertices. Octaves: Wrenninge, Kulla, Lundqvist, "Oz: The Great and Volumetric" (SIGGRAPH 2013). Phase: Henyey and
// Greenstein, "Diffuse radiation in the galaxy" (1941), times 4π.
#include "bake/lobe/volume_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "bake/lobe/exp_log.h"
#include "bake/lobe/light_kernels.h"
#include "bake/lobe/sliced_field.h"
#include "bake/lobe/sweep.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr size_t kLanes = 8, kBlock = 16384, kPointsPerTask = 16;
constexpr float kClear_cells = 1;  // with less cloud than this towards the eye a point is seen: its own cell is partly filled
constexpr float kOpaque = 6;       // optical depth behind which nothing is seen: a share of 0.0025 of the light is
constexpr float kGrowth = 0.2F;    // of the steps of a march, per cell of distance

// Samples of the light, point after point. The rows of a point are filled up to whole lanes with samples of weight 0.
struct Samples {
  std::vector<Vec3> positions;              // world
  std::vector<std::vector<float>> weights;  // per σ
  std::vector<int32_t> views;               // the view of each sample
};

// A depth that divides the opacity of all σ together in given parts: the inverse of F(τ) = mean over σ of 1 − exp(−σ_v τ), from a table.
class DepthTable {
 public:
  explicit DepthTable(std::span<const float> extinctions) : extinctions_(extinctions) {
    const float least = *std::min_element(extinctions.begin(), extinctions.end());
    for (size_t i = 0; i < kEntries; ++i) {
      // From 0 to kOpaque at the least σ, finer in front
      const float share = float(i) / float(kEntries - 1), depth = kOpaque / least * share * share;
      depths_[i] = depth, opacities_[i] = opacity(depth);
    }
  }
  float opacity(float depth) const {
    float sum = 0;
    for (const float extinction : extinctions_) sum += 1 - expMinus(extinction * depth);
    return sum / float(extinctions_.size());
  }
  float depthAt(float opacity) const {
    const auto above = std::upper_bound(opacities_.begin() + 1, opacities_.end() - 1, opacity);
    const size_t i = size_t(above - opacities_.begin());
    const float step = opacities_[i] - opacities_[i - 1];
    return depths_[i - 1] + (step > 0 ? std::clamp((opacity - opacities_[i - 1]) / step, 0.0F, 1.0F) : 0) * (depths_[i] - depths_[i - 1]);
  }

 private:
  static constexpr size_t kEntries = 128;
  std::span<const float> extinctions_;
  std::array<float, kEntries> depths_{}, opacities_{};
};

// Gauss's quadrature over 0 … 1: a part of each node's weight, from the end of the part before to `end`, and the node within it.
struct Part {
  float node, end;
};

// The nodes are the zeros of Legendre's polynomial of that degree, by Newton's method (Abramowitz and Stegun 1964, 25.4.30).
std::vector<Part> gaussParts(int count) {
  std::vector<Part> parts;
  double end = 0;
  for (int i = 0; i < count; ++i) {
    double x = -std::cos(kPi * (i + 0.75) / (count + 0.5)), slope = 1;
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

// The views of one point.
class Marcher {
 public:
  Marcher(const CoverageField& field, std::span<const float> view_extinctions, int depths)
      : field_(field), extinctions_(view_extinctions), table_(view_extinctions), parts_(gaussParts(depths)) {}

  // Adds the samples of a view from `at` (cells of the field), and returns whether there is cloud. `weight` is multiplied by the opacity.
  bool add(Vec3 at, Vec3 view, float weight, size_t number, Samples& samples) {
    march(at, view);
    const float end = running_.back(), opacity = table_.opacity(end);
    if (!(opacity > 0)) return false;
    size_t step = 1;
    passed_.assign(extinctions_.size(), 1);
    for (const Part& part : parts_) {
      const float node = std::min(table_.depthAt(part.node * opacity), end),
                  back = &part == &parts_.back() ? end : std::min(table_.depthAt(part.end * opacity), end);
      while (step + 1 < running_.size() && running_[step] < node) ++step;
      const float inside = running_[step] - running_[step - 1];
      const float into = inside > 0 ? std::clamp((node - running_[step - 1]) / inside, 0.0F, 1.0F) : 0;
      const Vec3 cell = at + view * (places_[step - 1] + into * (places_[step] - places_[step - 1]));
      samples.positions.push_back(
          field_.frame.toWorld(cell + Vec3{float(field_.first[0]), float(field_.first[1]), float(field_.first[2])}));
      samples.views.push_back(int32_t(number));
      for (size_t s = 0; s < extinctions_.size(); ++s) {
        const float left = expMinus(extinctions_[s] * back);
        samples.weights[s].push_back(weight * (passed_[s] - left));
        passed_[s] = left;
      }
    }
    return true;
  }

 private:
  // The running length of cloud along a view, in world units, at the ends of steps of a cell or more.
  void march(Vec3 at, Vec3 view) {
    const auto& cells = field_.cells;
    const size_t row = size_t(cells[0]), plane = row * size_t(cells[1]);
    const float enough = kOpaque / *std::min_element(extinctions_.begin(), extinctions_.end()), step = float(field_.frame.voxel_size);
    const Vec3 last{float(cells[0] - 1), float(cells[1] - 1), float(cells[2] - 1)};
    running_.assign(1, 0);
    places_.assign(1, 0);
    for (float t = 0; running_.back() < enough; t = places_.back()) {
      const float size = std::max(1.0F, kGrowth * t);
      const Vec3 p = at + view * (t + 0.5F * size);
      if (!(p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < last.x && p.y < last.y && p.z < last.z)) break;
      const auto i = size_t(p.x), j = size_t(p.y), k = size_t(p.z);
      const float x = p.x - float(i), y = p.y - float(j), z = p.z - float(k);
      const float* low = field_.fractions.data() + k * plane + j * row + i;
      const auto face = [&](const float* f) {
        const float first = f[0] + x * (f[1] - f[0]), second = f[row] + x * (f[row + 1] - f[row]);
        return first + y * (second - first);
      };
      const float near = face(low), far = face(low + plane);
      running_.push_back(running_.back() + size * step * (near + z * (far - near)));
      places_.push_back(t + size);
    }
  }

  const CoverageField& field_;
  std::span<const float> extinctions_;
  DepthTable table_;
  std::vector<Part> parts_;
  std::vector<float> running_, places_, passed_;  // places in cells from the point
};

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

// p(cⁱ g) of every octave for a view and a light.
class Phases {
 public:
  Phases(const VolumeLight& light, std::span<const Vec3> views, std::span<const Vec3> lights)
      : views_(views.size()), lights_(lights.size()) {
    float g = light.asymmetry;
    for (int i = 0; i <= light.octaves.count && g != 0; ++i, g *= light.octaves.eccentricity)
      for (const Vec3& to_light : lights)
        for (const Vec3& view : views) {
          const float square = 1 + g * g - 2 * g * dot(view, to_light);
          values_.push_back((1 - g * g) / (square * std::sqrt(square)));
        }
  }
  // The row of all views for the first octave; the next one is `stride` further. Null if all are 1.
  const float* of(size_t light) const { return values_.empty() ? nullptr : values_.data() + light * views_; }
  size_t stride() const { return lights_ * views_; }

 private:
  size_t views_, lights_;
  std::vector<float> values_;
};

// All views of a point that see it, or else those from the side of its normal, or else the point itself.
class Gatherer {
 public:
  Gatherer(const CoverageField& field, std::span<const float> view_extinctions, std::span<const Vec3> views, int depths)
      : marcher_(field, view_extinctions, depths), views_(views), sigmas_(view_extinctions.size()) {}

  // sees(v) says whether view v has nothing in front of the point. `position` is in the world, `cell` in cells of the field.
  template <class Sees>
  bool gather(Vec3 position, Vec3 cell, Vec3 normal, const Sees& sees, Samples& samples) {
    samples.weights.resize(sigmas_);
    const bool has_normal = dot(normal, normal) > 0;
    bool has_cloud = false;
    const auto addViews = [&](const auto& is_chosen) {
      for (size_t v = 0; v < views_.size(); ++v) {
        const float facing = has_normal ? dot(normal, views_[v]) : -1;
        if (facing != 0 && is_chosen(v, facing)) has_cloud = marcher_.add(cell, views_[v], std::fabs(facing), v, samples) || has_cloud;
      }
    };
    const auto addPlace = [&](float weight) {
      samples.positions.push_back(position), samples.views.push_back(0);
      for (std::vector<float>& one : samples.weights) one.push_back(weight);
    };
    addViews([&](size_t v, float) { return sees(v); });
    const bool is_seen = has_cloud;
    if (!has_cloud) addViews([&](size_t, float facing) { return facing < 0; });
    if (!has_cloud) addPlace(1);
    while (samples.positions.size() % kLanes != 0) addPlace(0);
    return is_seen;
  }

 private:
  Marcher marcher_;
  std::span<const Vec3> views_;
  size_t sigmas_;
};

}  // namespace

VolumeTarget volumeTarget(const BakePoints& points, std::span<const Vec3> axes, const CoverageField& field,
                          const VolumeTargetSettings& settings) {
  const std::vector<Vec3> view_axes = sweepAxes(settings.views), views = bothSenses(view_axes), to_lights = bothSenses(axes);
  const size_t count = points.positions.size(), sigmas = settings.extinctions.size(), row = sigmas * to_lights.size();
  const Phases phases(settings.light, views, to_lights);
  const LightTerms terms = lightTerms(settings.extinctions, settings.light.octaves);
  std::vector<float> view_extinctions;
  for (const float extinction : settings.extinctions) view_extinctions.push_back(extinction * settings.light.view_extinction);
  const auto clear = float(kClear_cells * field.frame.voxel_size);
  VolumeTarget target;
  target.radiance.resize(count * row);

  for (size_t begin = 0; begin < count; begin += kBlock) {
    const size_t size = std::min(kBlock, count - begin);
    const auto positions = points.positions.subspan(begin, size);
    const std::vector<float> before = sweptLengths(positions, view_axes, field, settings.ray_length);
    uint64_t moved = 0;
    const std::vector<Vec3> cells = cellPositions(positions, field, moved);
    std::vector<Samples> samples(size);
    std::vector<char> is_seen(size);
    parallelBlocks(size, kPointsPerTask, [&](size_t first, size_t last) {
      Gatherer gatherer(field, view_extinctions, views, settings.depths);
      for (size_t p = first; p < last; ++p) {
        const auto sees = [&](size_t v) { return before[(v ^ 1) * size + p] < clear; };  // the eye is in the other sense
        is_seen[p] = gatherer.gather(positions[p], cells[p], points.normals.empty() ? Vec3{} : points.normals[begin + p], sees, samples[p]);
      }
    });
    target.unseen += uint64_t(std::count(is_seen.begin(), is_seen.end(), 0));

    std::vector<Vec3> places;
    std::vector<size_t> offsets;
    std::vector<float> totals;  // of the weights, per point and σ
    for (const Samples& one : samples) {
      offsets.push_back(places.size());
      places.insert(places.end(), one.positions.begin(), one.positions.end());
      for (const std::vector<float>& weights : one.weights) totals.push_back(std::accumulate(weights.begin(), weights.end(), 0.0F));
    }
    sweepLengths(places, axes, field, settings.ray_length, [&](size_t first_axis, std::span<const float> lengths) {
      std::vector<float> scratch(kLanes * (terms.exponentials.size() + sigmas)), sums(sigmas);
      for (size_t p = 0; p < size; ++p)
        for (size_t i = 0; i * places.size() < lengths.size(); ++i) {
          const size_t light = 2 * first_axis + i;
          sumLight(terms,
                   {lengths.data() + i * places.size() + offsets[p], samples[p].views.data(), samples[p].views.size(), phases.of(light),
                    phases.stride()},
                   samples[p].weights, scratch.data(), sums.data());
          for (size_t s = 0; s < sigmas; ++s)
            target.radiance[(begin + p) * row + s * to_lights.size() + light] = sums[s] / totals[p * sigmas + s];
        }
    });
  }
  return target;
}

std::vector<float> scatteredLight(std::span<const float> lengths, float extinction, const OctaveSettings& octaves) {
  std::vector<float> light(lengths.size());
  float weight = 1, sum = 0;
  for (int i = 0; i <= octaves.count; ++i, extinction *= octaves.extinction, weight *= octaves.contribution) {
    for (size_t n = 0; n < light.size(); ++n) light[n] += weight * expMinus(atLeast(extinction * lengths[n], 0));
    sum += weight;
  }
  for (float& one : light) one /= sum;
  return light;
}

}  // namespace cloudbake
