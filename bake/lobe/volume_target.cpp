// Every view that sees a point is followed to a few depths: the nodes of Gauss's quadrature over the opacity, the same for all σ. The light
// there comes from ℓ towards all lights. For few points both are exact: views are marched through the fractions of the field, and a sweep
// gives ℓ from every place. For many points a sweep gives ℓ towards lights and along views on a coarse lattice, and both are interpolated.
// Octaves: Wrenninge, Kulla, Lundqvist, "Oz: The Great and Volumetric" (SIGGRAPH 2013). Phase: Henyey and Greenstein, "Diffuse radiation in
// the galaxy" (1941), times 4π.
#include "bake/lobe/volume_target.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bake/lobe/light_kernels.h"
#include "bake/lobe/sliced_field.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_lattice.h"
#include "bake/lobe/volume_samples.h"
#include "core/exp_log.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

constexpr size_t kLanes = 8, kBlock = 16384, kPointsPerTask = 16;
constexpr float kGrowth = 0.2F;  // of the steps of a march, per cell of distance

// Samples of the light, point after point. The rows of a point are filled up to whole lanes with samples of weight 0.
struct Samples {
  std::vector<Vec3> positions;              // world
  std::vector<std::vector<float>> weights;  // per σ
  std::vector<int32_t> views;               // the view of each sample
};

// Follows the views of points through the fractions of the field.
class Marcher {
 public:
  Marcher(const CoverageField& field, const DepthNodes& nodes)
      : field_(field), nodes_(nodes), depths_(nodes.count()), weights_(nodes.count() * nodes.sigmas()) {}

  // Adds the samples of a view from `at` (cells of the field), and returns whether there is cloud. `weight` is multiplied by the opacity.
  bool add(Vec3 at, Vec3 view, float weight, size_t number, Samples& samples) {
    march(at, view);
    if (!nodes_.divide(running_.back(), weight, depths_, weights_)) return false;
    size_t step = 1;
    for (size_t n = 0; n < depths_.size(); ++n) {
      while (step + 1 < running_.size() && running_[step] < depths_[n]) ++step;
      const float inside = running_[step] - running_[step - 1];
      const float into = inside > 0 ? std::clamp((depths_[n] - running_[step - 1]) / inside, 0.0F, 1.0F) : 0;
      const Vec3 cell = at + view * (places_[step - 1] + into * (places_[step] - places_[step - 1]));
      samples.positions.push_back(
          field_.frame.toWorld(cell + Vec3{float(field_.first[0]), float(field_.first[1]), float(field_.first[2])}));
      samples.views.push_back(int32_t(number));
      for (size_t s = 0; s < nodes_.sigmas(); ++s) samples.weights[s].push_back(weights_[n * nodes_.sigmas() + s]);
    }
    return true;
  }

 private:
  // The running length of cloud along a view, in world units, at the ends of steps of a cell or more.
  void march(Vec3 at, Vec3 view) {
    const auto& cells = field_.cells;
    const size_t row = size_t(cells[0]), plane = row * size_t(cells[1]);
    const float enough = nodes_.enough(), step = float(field_.frame.voxel_size);
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
      running_.push_back(running_.back() + size * step * trilinear(low, row, plane, x, y, z));
      places_.push_back(t + size);
    }
  }

  const CoverageField& field_;
  const DepthNodes& nodes_;
  std::vector<float> running_, places_;  // places in cells from the point
  std::vector<float> depths_, weights_;
};

// p(cⁱ g) of every octave for a view and a light.
class Phases {
 public:
  Phases(const VolumeLight& light, std::span<const Vec3> views, std::span<const Vec3> lights)
      : views_(views.size()), lights_(lights.size()) {
    float g = light.asymmetry;
    for (int i = 0; i <= light.octaves.count && g != 0; ++i, g *= light.octaves.eccentricity)
      for (const Vec3& to_light : lights)
        for (const Vec3& view : views) values_.push_back(phaseOf(g, dot(view, to_light)));
  }
  // The row of all views for the first octave; the next one is `stride` further. Null if all are 1.
  const float* of(size_t light) const { return values_.empty() ? nullptr : values_.data() + light * views_; }
  size_t stride() const { return lights_ * views_; }

 private:
  size_t views_, lights_;
  std::vector<float> values_;
};

// The samples of a point's views, or the point itself if there is no cloud behind it. Returns whether a view sees it.
template <class Sees>
bool gather(const std::vector<Vec3>& views, Vec3 position, Vec3 cell, Vec3 normal, const Sees& sees, Marcher& marcher, Samples& samples) {
  const auto addPlace = [&](float weight) {
    samples.positions.push_back(position), samples.views.push_back(0);
    for (std::vector<float>& one : samples.weights) one.push_back(weight);
  };
  const SeenPoint seen =
      addViews(views, normal, sees, [&](size_t v, float weight) { return marcher.add(cell, views[v], weight, v, samples); });
  if (!seen.has_cloud) addPlace(1);
  while (samples.positions.size() % kLanes != 0) addPlace(0);
  return seen.is_seen;
}

VolumeTarget exactTarget(const BakePoints& points, std::span<const Vec3> axes, const SweepField& field,
                         const VolumeTargetSettings& settings) {
  const std::vector<Vec3> view_axes = sweepAxes(settings.views), views = bothSenses(view_axes), to_lights = bothSenses(axes);
  const size_t count = points.positions.size(), sigmas = settings.extinctions.size(), row = sigmas * to_lights.size();
  const Phases phases(settings.light, views, to_lights);
  const LightTerms terms = lightTerms(settings.extinctions, settings.light.octaves);
  const DepthNodes nodes(settings);
  const float clear = clearLength(field.coverage);
  VolumeTarget target;
  target.radiance.resize(count * row);

  for (size_t begin = 0; begin < count; begin += kBlock) {
    const size_t size = std::min(kBlock, count - begin);
    const auto positions = points.positions.subspan(begin, size);
    const std::vector<float> before = sweptLengths(positions, view_axes, field, settings.ray_length);
    uint64_t moved = 0;
    const std::vector<Vec3> cells = cellPositions(positions, field.coverage, moved);
    std::vector<Samples> samples(size);
    std::vector<char> is_seen(size);
    parallelBlocks(size, kPointsPerTask, [&](size_t first, size_t last) {
      Marcher marcher(field.coverage, nodes);
      for (size_t p = first; p < last; ++p) {
        const auto sees = [&](size_t v) { return before[(v ^ 1) * size + p] < clear; };  // the eye is in the other sense
        samples[p].weights.resize(sigmas);
        is_seen[p] = gather(views, positions[p], cells[p], normalOf(points, begin + p), sees, marcher, samples[p]);
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
    const LoopProgress::Part part(double(begin) / double(count), double(begin + size) / double(count));
    const LoopProgress::Counted counted;
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

// The same from a lattice. Points without cloud behind them are few, and exact.
VolumeTarget interpolatedTarget(const BakePoints& points, std::span<const Vec3> axes, std::span<const Vec3> view_axes,
                                const SweepField& field, const LengthLattice& lattice, const VolumeTargetSettings& settings) {
  const std::vector<Vec3> views = bothSenses(view_axes), lights = bothSenses(axes);
  const std::vector<float> along_views = sweptLengths(points.positions, view_axes, field, settings.ray_length);
  LatticeTarget found = latticeTarget(points, along_views, views, lights, field.coverage, lattice, settings);
  VolumeTarget target{std::move(found.radiance), uint64_t(std::count(found.is_seen.begin(), found.is_seen.end(), 0))};
  std::vector<size_t> bare;
  std::vector<Vec3> positions, normals;
  for (size_t p = 0; p < points.positions.size(); ++p)
    if (!found.has_cloud[p]) bare.push_back(p), positions.push_back(points.positions[p]), normals.push_back(normalOf(points, p));
  const VolumeTarget exact = exactTarget({positions, normals}, axes, field, settings);
  const size_t row = settings.extinctions.size() * lights.size();
  for (size_t i = 0; i < bare.size(); ++i)
    std::copy_n(exact.radiance.begin() + ptrdiff_t(i * row), row, target.radiance.begin() + ptrdiff_t(bare[i] * row));
  return target;
}

}  // namespace

VolumeTargets::VolumeTargets(size_t points, std::span<const Vec3> axes, const SweepField& field, VolumeTargetSettings settings)
    : axes_(axes), field_(field), settings_(std::move(settings)), view_axes_(sweepAxes(settings_.views)) {
  if (!settings_.may_interpolate) return;
  const size_t samples = points * size_t(settings_.views / 2) * size_t(settings_.depths);  // half of the views are in front
  if (auto lattice = lengthLattice(field, view_axes_, axes, settings_, samples))
    lattice_ = std::make_unique<const LengthLattice>(std::move(*lattice));
}
VolumeTargets::~VolumeTargets() = default;

VolumeTarget VolumeTargets::at(const BakePoints& points) const {
  return lattice_ ? interpolatedTarget(points, axes_, view_axes_, field_, *lattice_, settings_)
                  : exactTarget(points, axes_, field_, settings_);
}

VolumeTarget volumeTarget(const BakePoints& points, std::span<const Vec3> axes, const SweepField& field,
                          const VolumeTargetSettings& settings) {
  return VolumeTargets(points.positions.size(), axes, field, settings).at(points);
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
