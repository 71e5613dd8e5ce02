// Every view that sees a point is marched once through the fractions of the field, which gives τ along it. The light is taken at a few
// depths per view, the same for all σ: each stands for a part of the opacity. Their ℓ towards all lights come from a sweep, like those of
// vertices. Octaves: Wrenninge, Kulla, Lundqvist, "Oz: The Great and Volumetric" (SIGGRAPH 2013). Phase: Henyey and Greenstein, "Diffuse
// radiation in the galaxy" (1941), times 4π.
#include "bake/lobe/volume_target.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bake/lobe/exp_log.h"
#include "bake/lobe/sliced_field.h"
#include "bake/lobe/sweep.h"

namespace cloudbake {

namespace {

constexpr size_t kLanes = 8, kBlock = 1024, kPointsPerTask = 16;
constexpr float kClear_cells = 1;  // with less cloud than this towards the eye a point is seen: its own cell is partly filled
constexpr float kOpaque = 12;      // optical depth behind which nothing is seen

// Samples of the light, point after point. The rows of a point are filled up to whole lanes with samples of weight 0.
struct Samples {
  std::vector<Vec3> positions;              // world
  std::vector<std::vector<float>> weights;  // per σ
  std::vector<uint8_t> views;               // the view of each sample
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

// The views of one point.
class Marcher {
 public:
  Marcher(const CoverageField& field, std::span<const float> view_extinctions, int depths)
      : field_(field), extinctions_(view_extinctions), table_(view_extinctions), parts_(depths) {}

  // Adds the samples of a view from `at` (cells of the field), and returns whether there is cloud. `weight` is multiplied by the opacity.
  bool add(Vec3 at, Vec3 view, float weight, size_t number, Samples& samples) {
    march(at, view);
    const float end = running_.back(), opacity = table_.opacity(end);
    if (!(opacity > 0)) return false;
    size_t step = 1;
    passed_.assign(extinctions_.size(), 1);
    for (int part = 0; part < parts_; ++part) {
      const auto depthAt = [&](float share) { return table_.depthAt(share / float(parts_) * opacity); };
      const float middle = std::min(depthAt(float(part) + 0.5F), end),
                  back = part + 1 < parts_ ? std::min(depthAt(float(part) + 1), end) : end;
      while (step + 1 < running_.size() && running_[step] < middle) ++step;
      const float inside = running_[step] - running_[step - 1];
      const float into = inside > 0 ? std::clamp((middle - running_[step - 1]) / inside, 0.0F, 1.0F) : 0;
      const Vec3 cell = at + view * (float(step - 1) + into);
      samples.positions.push_back(
          field_.frame.toWorld(cell + Vec3{float(field_.first[0]), float(field_.first[1]), float(field_.first[2])}));
      samples.views.push_back(uint8_t(number));
      for (size_t s = 0; s < extinctions_.size(); ++s) {
        const float left = expMinus(extinctions_[s] * back);
        samples.weights[s].push_back(weight * (passed_[s] - left));
        passed_[s] = left;
      }
    }
    return true;
  }

 private:
  // The running length of cloud along a view in steps of a cell, in world units.
  void march(Vec3 at, Vec3 view) {
    const auto& cells = field_.cells;
    const size_t row = size_t(cells[0]), plane = row * size_t(cells[1]);
    const float enough = kOpaque / *std::min_element(extinctions_.begin(), extinctions_.end()), step = float(field_.frame.voxel_size);
    const Vec3 last{float(cells[0] - 1), float(cells[1] - 1), float(cells[2] - 1)};
    running_.assign(1, 0);
    for (float t = 0.5F; running_.back() < enough; t += 1) {
      const Vec3 p = at + view * t;
      if (!(p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < last.x && p.y < last.y && p.z < last.z)) break;
      const auto i = size_t(p.x), j = size_t(p.y), k = size_t(p.z);
      const float x = p.x - float(i), y = p.y - float(j), z = p.z - float(k);
      const float* low = field_.fractions.data() + k * plane + j * row + i;
      const auto face = [&](const float* f) {
        const float first = f[0] + x * (f[1] - f[0]), second = f[row] + x * (f[row + 1] - f[row]);
        return first + y * (second - first);
      };
      const float near = face(low), far = face(low + plane);
      running_.push_back(running_.back() + step * (near + z * (far - near)));
    }
  }

  const CoverageField& field_;
  std::span<const float> extinctions_;
  DepthTable table_;
  int parts_;
  std::vector<float> running_, passed_;
};

float phase(float cosine, float g) {
  const float square = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (square * std::sqrt(square));
}

// S(σℓ) of a row of samples, octave by octave.
class OctaveRows {
 public:
  explicit OctaveRows(const VolumeLight& light) : octaves_(light.octaves) {
    float weight = 1, factor = 1, sum = 0, g = light.asymmetry;
    for (int i = 0; i <= octaves_.count; ++i) {
      weights_[size_t(i)] = weight, factors_[size_t(i)] = factor, asymmetries_[size_t(i)] = g;
      sum += weight;
      weight *= octaves_.contribution, factor *= octaves_.extinction, g *= octaves_.eccentricity;
    }
    for (float& one : weights_) one /= sum;
  }
  int count() const { return octaves_.count + 1; }
  float asymmetry(int octave) const { return asymmetries_[size_t(octave)]; }

  // Calls visit(octave, row) with the row of b^i/Σb · exp(−a^i σ ℓ) for every octave.
  template <class Visit>
  void visit(const float* lengths, size_t count, float extinction, const Visit& visit) {
    passed_.resize(count), row_.resize(count);
    float *passed = passed_.data(), *row = row_.data();
    for (int i = octaves_.count; i >= 0; --i) {
      const float factor = extinction * factors_[size_t(i)], weight = weights_[size_t(i)];
      if (i < octaves_.count && octaves_.extinction == 0.5F)
#pragma GCC ivdep
        for (size_t n = 0; n < count; ++n) passed[n] *= passed[n];
      else
#pragma GCC ivdep
        for (size_t n = 0; n < count; ++n) passed[n] = expMinus(atLeast(factor * lengths[n], 0));
#pragma GCC ivdep
      for (size_t n = 0; n < count; ++n) row[n] = weight * passed[n];
      visit(i, row);
    }
  }

 private:
  OctaveSettings octaves_;
  std::array<float, kMostLightOctaves + 1> weights_{}, factors_{}, asymmetries_{};
  std::vector<float> passed_, row_;
};

// Σ a b over whole lanes, in a fixed order.
float dotRows(const float* a, const float* b, size_t count) {
  float lanes[kLanes] = {};
  for (size_t n = 0; n < count; n += kLanes)
    for (size_t lane = 0; lane < kLanes; ++lane) lanes[lane] += a[n + lane] * b[n + lane];
  float sum = 0;
  for (const float lane : lanes) sum += lane;
  return sum;
}

}  // namespace

VolumeTarget volumeTarget(const BakePoints& points, std::span<const Vec3> axes, const CoverageField& field,
                          const VolumeTargetSettings& settings) {
  const std::vector<Vec3> view_axes = sweepAxes(settings.views);
  const size_t count = points.positions.size(), sigmas = settings.extinctions.size(), views = 2 * view_axes.size(),
               lights = 2 * axes.size();
  std::vector<float> view_extinctions;
  for (const float extinction : settings.extinctions) view_extinctions.push_back(extinction * settings.light.view_extinction);
  const auto clear = float(kClear_cells * field.frame.voxel_size);
  VolumeTarget target;
  target.radiance.resize(count * sigmas * lights);

  for (size_t begin = 0; begin < count; begin += kBlock) {
    const size_t size = std::min(kBlock, count - begin);
    const auto positions = points.positions.subspan(begin, size);
    const std::vector<float> towards = sweptLengths(positions, view_axes, field, settings.ray_length);
    uint64_t moved = 0;
    const std::vector<Vec3> cells = cellPositions(positions, field, moved);

    std::vector<Samples> rows(size);
    std::vector<char> is_unseen(size, 0);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, size, kPointsPerTask), [&](const tbb::blocked_range<size_t>& range) {
      Marcher marcher(field, view_extinctions, settings.depths);
      for (size_t p = range.begin(); p < range.end(); ++p) {
        Samples& row = rows[p];
        row.weights.resize(sigmas);
        const Vec3 normal = points.normals.empty() ? Vec3{} : points.normals[begin + p];
        const bool has_normal = dot(normal, normal) > 0;
        bool has_cloud = false;
        const auto addViews = [&](const auto& is_chosen) {
          for (size_t v = 0; v < views; ++v) {
            const Vec3 view = v % 2 ? -view_axes[v / 2] : view_axes[v / 2];
            const float facing = has_normal ? dot(normal, view) : -1;
            if (is_chosen(v, facing) && facing != 0) has_cloud = marcher.add(cells[p], view, std::fabs(facing), v, row) || has_cloud;
          }
        };
        addViews([&](size_t v, float) { return towards[(v ^ 1) * size + p] < clear; });  // the eye is on the other side
        if (!has_cloud) {
          is_unseen[p] = 1;
          addViews([&](size_t, float facing) { return facing < 0; });
        }
        const auto addWithoutView = [&](float weight) {
          row.positions.push_back(positions[p]), row.views.push_back(0);
          for (std::vector<float>& one : row.weights) one.push_back(weight);
        };
        if (!has_cloud) addWithoutView(1);
        while (row.positions.size() % kLanes) addWithoutView(0);
      }
    });
    target.unseen += uint64_t(std::count(is_unseen.begin(), is_unseen.end(), 1));

    std::vector<Vec3> places;
    std::vector<size_t> first{0};
    for (const Samples& row : rows) places.insert(places.end(), row.positions.begin(), row.positions.end()), first.push_back(places.size());
    const std::vector<float> lengths = sweptLengths(places, axes, field, settings.ray_length);

    tbb::parallel_for(tbb::blocked_range<size_t>(0, size, kPointsPerTask), [&](const tbb::blocked_range<size_t>& range) {
      OctaveRows octaves(settings.light);
      std::vector<float> phases;
      for (size_t p = range.begin(); p < range.end(); ++p) {
        const Samples& row = rows[p];
        const size_t samples = row.positions.size();
        for (size_t s = 0; s < sigmas; ++s) {
          const float* weights = row.weights[s].data();
          float total = 0;
          for (size_t n = 0; n < samples; ++n) total += weights[n];
          for (size_t j = 0; j < lights; ++j) {
            float sum = 0;
            octaves.visit(lengths.data() + j * places.size() + first[p], samples, settings.extinctions[s], [&](int octave, float* light) {
              if (settings.light.asymmetry != 0)
                for (size_t n = 0; n < samples; ++n) {
                  const Vec3 view = row.views[n] % 2 ? -view_axes[row.views[n] / 2] : view_axes[row.views[n] / 2];
                  light[n] *= phase((j % 2 ? -1.0F : 1.0F) * dot(view, axes[j / 2]), octaves.asymmetry(octave));
                }
              sum += dotRows(light, weights, samples);
            });
            target.radiance[((begin + p) * sigmas + s) * lights + j] = sum / total;
          }
        }
      }
    });
  }
  return target;
}

std::vector<float> scatteredLight(std::span<const float> lengths, float extinction, const OctaveSettings& octaves) {
  std::vector<float> light(lengths.size(), 0);
  OctaveRows rows({1, octaves, 0});
  rows.visit(lengths.data(), lengths.size(), extinction, [&](int, const float* row) {
    for (size_t n = 0; n < light.size(); ++n) light[n] += row[n];
  });
  return light;
}

}  // namespace cloudbake
