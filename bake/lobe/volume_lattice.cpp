#include "bake/lobe/volume_lattice.h"

#include <algorithm>
#include <cmath>

#include "bake/lobe/light_kernels.h"
#include "bake/lobe/sliced_field.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_samples.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr float kSpacing_depths = 0.5F;          // of places, in optical depths at the largest σ
constexpr size_t kMostPlaces = size_t(1) << 18;  // about 50 MB with 32 lights and 16 views
constexpr float kBorder = 2;                     // empty cells at the border of a field
constexpr int kSearches = 3;                     // for the place at a depth
constexpr size_t kLanes = 8, kPointsPerTask = 64;

// A place between eight places of the lattice.
struct Between {
  size_t low;
  float x, y, z;
};

Between between(const LengthLattice& lattice, Vec3 cell) {
  const auto along = [&](float at, float first, int count) {
    return std::clamp((at - first) / lattice.spacing, 0.0F, float(count) - 1.001F);
  };
  const float x = along(cell.x, lattice.first.x, lattice.counts[0]), y = along(cell.y, lattice.first.y, lattice.counts[1]),
              z = along(cell.z, lattice.first.z, lattice.counts[2]);
  const auto i = size_t(x), j = size_t(y), k = size_t(z);
  return {(k * size_t(lattice.counts[1]) + j) * size_t(lattice.counts[0]) + i, x - float(i), y - float(j), z - float(k)};
}

float interpolated(const LengthLattice& lattice, const float* values, const Between& at) {
  const size_t row = size_t(lattice.counts[0]), plane = row * size_t(lattice.counts[1]);
  return trilinear(values + at.low, row, plane, at.x, at.y, at.z);
}

// The samples of one point.
struct Samples {
  std::vector<LatticeSample> samples;
  std::vector<float> weights, totals;  // #samples × #σ, and their sums
};

class Follower {
 public:
  Follower(const LengthLattice& lattice, const DepthNodes& nodes, float cell)
      : lattice_(lattice), nodes_(nodes), cell_(cell), depths_(nodes.count()), weights_(nodes.count() * nodes.sigmas()) {}

  // Adds the samples of view v, through `length` of cloud from `at` (cells of the field).
  bool add(Vec3 at, Vec3 view, size_t v, float length, float weight, Samples& samples) {
    if (!nodes_.divideQuickly(length, weight, depths_, weights_)) return false;
    const float* ahead = lattice_.along_views.data() + v * lattice_.places();
    const float step = lattice_.spacing * cell_;
    const float whole = interpolated(lattice_, ahead, between(lattice_, at));
    float t = 0;
    for (size_t n = 0; n < depths_.size(); ++n) {
      // What is missing of the depth is the least distance to its place, as in sphere tracing
      t = std::max(t, depths_[n]);
      Between place = between(lattice_, at + view * (t / cell_));
      for (int search = 0; search < kSearches; ++search) {
        const float missing = depths_[n] - (whole - interpolated(lattice_, ahead, place));
        if (!(missing > step)) break;
        t += missing;
        place = between(lattice_, at + view * (t / cell_));
      }
      samples.samples.push_back({uint32_t(place.low * lattice_.stride), uint32_t(v), place.x, place.y, place.z});
    }
    samples.weights.insert(samples.weights.end(), weights_.begin(), weights_.end());
    for (size_t i = 0; i < weights_.size(); ++i) samples.totals[i % nodes_.sigmas()] += weights_[i];
    return true;
  }

 private:
  const LengthLattice& lattice_;
  const DepthNodes& nodes_;
  float cell_;  // world units
  std::vector<float> depths_, weights_;
};

}  // namespace

std::optional<LengthLattice> lengthLattice(const SweepField& swept, std::span<const Vec3> view_axes, std::span<const Vec3> light_axes,
                                           const VolumeTargetSettings& settings, size_t samples) {
  const CoverageField& field = swept.coverage;
  LengthLattice lattice;
  const float most = *std::max_element(settings.extinctions.begin(), settings.extinctions.end());
  lattice.spacing = std::max(1.0F, kSpacing_depths / (most * float(field.frame.voxel_size)));
  lattice.first = {kBorder, kBorder, kBorder};
  double places = 1;
  for (size_t axis = 0; axis < 3; ++axis) {
    const float inner = float(field.cells[axis] - 1) - 2 * kBorder;
    lattice.counts[axis] = std::max(2, int(std::ceil(inner / lattice.spacing)) + 1);
    places *= lattice.counts[axis];
  }
  if (places > double(std::min(samples, kMostPlaces))) return {};

  std::vector<Vec3> positions;
  positions.reserve(lattice.places());
  const Vec3 low{float(field.first[0]), float(field.first[1]), float(field.first[2])};
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i)
        positions.push_back(field.frame.toWorld(low + lattice.first + Vec3{float(i), float(j), float(k)} * lattice.spacing));
  std::vector<Vec3> axes(light_axes.begin(), light_axes.end());
  axes.insert(axes.end(), view_axes.begin(), view_axes.end());
  lattice.lights = 2 * light_axes.size();
  lattice.stride = (lattice.lights + kLanes - 1) / kLanes * kLanes;
  lattice.to_lights.resize(lattice.places() * lattice.stride);
  lattice.along_views.resize(2 * view_axes.size() * lattice.places());
  sweepLengths(positions, axes, swept, settings.ray_length, [&](size_t first_axis, std::span<const float> lengths) {
    const size_t first = 2 * first_axis, count = lengths.size() / positions.size(),
                 lights = std::min(count, std::max(first, lattice.lights) - first);
    for (size_t place = 0; place < positions.size(); ++place)
      for (size_t i = 0; i < lights; ++i)
        lattice.to_lights[place * lattice.stride + first + i] = std::max(lengths[i * positions.size() + place], 0.0F);
    const auto views = lengths.subspan(lights * positions.size());
    std::copy(views.begin(), views.end(),
              lattice.along_views.begin() + ptrdiff_t((std::max(first, lattice.lights) - lattice.lights) * positions.size()));
  });
  return lattice;
}

LatticeTarget latticeTarget(const BakePoints& points, std::span<const float> along_views, std::span<const Vec3> views,
                            std::span<const Vec3> lights, const CoverageField& field, const LengthLattice& lattice,
                            const VolumeTargetSettings& settings) {
  const size_t count = points.positions.size(), sigmas = settings.extinctions.size();
  const LightTerms terms = lightTerms(settings.extinctions, settings.light.octaves);
  std::vector<float> phases;
  float g = settings.light.asymmetry;
  for (int i = 0; i <= settings.light.octaves.count && g != 0; ++i, g *= settings.light.octaves.eccentricity)
    for (const Vec3& view : views)
      for (size_t l = 0; l < lattice.stride; ++l) phases.push_back(l < lights.size() ? phaseOf(g, dot(view, lights[l])) : 1);
  const DepthNodes nodes(settings);
  const auto clear = clearLength(field);
  const size_t row = size_t(lattice.counts[0]);
  const LatticeLengths lengths{lattice.to_lights.data(), lattice.stride, row * lattice.stride,
                               row * size_t(lattice.counts[1]) * lattice.stride};
  uint64_t moved = 0;
  const std::vector<Vec3> cells = cellPositions(points.positions, field, moved);

  LatticeTarget target{std::vector<float>(count * sigmas * lights.size()), std::vector<char>(count), std::vector<char>(count)};
  const LoopProgress::Counted counted;
  parallelBlocks(count, kPointsPerTask, [&](size_t begin, size_t end) {
    Follower follower(lattice, nodes, float(field.frame.voxel_size));
    Samples samples;
    std::vector<float> scratch(kLanes * terms.exponentials.size()), sums(sigmas * lattice.stride);
    for (size_t p = begin; p < end; ++p) {
      samples.samples.clear(), samples.weights.clear(), samples.totals.assign(sigmas, 0);
      const SeenPoint seen = addViews(
          views, normalOf(points, p), [&](size_t v) { return along_views[(v ^ 1) * count + p] < clear; },
          [&](size_t v, float weight) { return follower.add(cells[p], views[v], v, along_views[v * count + p], weight, samples); });
      target.is_seen[p] = seen.is_seen, target.has_cloud[p] = seen.has_cloud;
      if (!seen.has_cloud) continue;
      std::fill(sums.begin(), sums.end(), 0.0F);
      addLatticeLight(terms, lengths, samples.samples, samples.weights, phases, scratch.data(), sums);
      for (size_t s = 0; s < sigmas; ++s)
        for (size_t l = 0; l < lights.size(); ++l)
          target.radiance[(p * sigmas + s) * lights.size() + l] = sums[s * lattice.stride + l] / samples.totals[s];
    }
  });
  return target;
}

}  // namespace cloudbake
