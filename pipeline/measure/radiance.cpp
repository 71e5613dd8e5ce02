#include "pipeline/measure/radiance.h"

#include <algorithm>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/lobe/fit_lobe.h"
#include "core/harmonics.h"
#include "core/lobe_lighting.h"
#include "core/portable_math.h"
#include "preview/compare/volume.h"

namespace cloudbake {

namespace {

constexpr size_t kJudgedVertices = 300;
constexpr int kSuns = 128, kVoxels = 64, kHighestOrder = 3;
constexpr float kClear_cells = 1;  // cloud towards the eye that does not hide a point, because its own cell is partly filled

struct Pair {
  size_t point;
  float area;  // projected
};

// Sums over the views of every point, weighted by the area and the opacity that each sees.
class Sums {
 public:
  Sums(size_t points, size_t lights) : lights_(lights), weights_(points), sums_(points * lights), squares_(points * lights) {}

  void add(std::span<const Pair> pairs, std::span<const SeenLight> light, size_t j) {
    for (size_t i = 0; i < pairs.size(); ++i) {
      const double weight = double(pairs[i].area) * light[i].opacity, radiance = light[i].shade.sun;
      const size_t at = pairs[i].point * lights_ + j;
      if (j == 0) weights_[pairs[i].point] += weight;
      sums_[at] += weight * radiance, squares_[at] += weight * radiance * radiance;
    }
  }

  VolumeTruth truth(size_t views) const {
    VolumeTruth truth;
    truth.views = views;
    for (size_t p = 0; p < weights_.size(); ++p) {
      if (!(weights_[p] > 0)) continue;
      truth.seen.push_back(p);
      truth.weights.push_back(weights_[p]);
      for (size_t j = 0; j < lights_; ++j) {
        truth.mean.push_back(float(sums_[p * lights_ + j] / weights_[p]));
        truth.square.push_back(float(squares_[p * lights_ + j] / weights_[p]));
      }
    }
    return truth;
  }

 private:
  size_t lights_;
  std::vector<double> weights_, sums_, squares_;
};

// The cells whose lengths a march through the cloud reads: those with cloud and their neighbours.
std::vector<size_t> cellsNearCloud(const CoverageField& field) {
  const auto [columns, rows, slices] = field.cells;
  std::vector<char> is_near(field.fractions.size(), 0);
  // The outermost cells are empty, so every cell with cloud has all its neighbours.
  for (int k = 1; k + 1 < slices; ++k)
    for (int j = 1; j + 1 < rows; ++j)
      for (int i = 1; i + 1 < columns; ++i) {
        const size_t cell = (size_t(k) * size_t(rows) + size_t(j)) * size_t(columns) + size_t(i);
        if (!(field.fractions[cell] > 0)) continue;
        for (const ptrdiff_t z : {-1, 0, 1})
          for (const ptrdiff_t y : {-1, 0, 1})
            for (const ptrdiff_t x : {-1, 0, 1}) is_near[size_t(ptrdiff_t(cell) + (z * rows + y) * columns + x)] = 1;
      }
  std::vector<size_t> cells;
  for (size_t i = 0; i < is_near.size(); ++i)
    if (is_near[i]) cells.push_back(i);
  return cells;
}

}  // namespace

std::vector<VolumeTruth> marchVolume(const BakePoints& points, const CoverageField& field, std::span<const Vec3> to_lights,
                                     std::span<const float> extinctions, const VolumeTruthSettings& settings) {
  std::vector<Pair> pairs;
  std::vector<Ray> rays;
  const float clear = kClear_cells * float(field.frame.voxel_size);
  for (const Vec3& view : fibonacciDirections(settings.views)) {
    const std::vector<float> before = plainLengths(field, points.positions, -view, settings.steps);
    for (size_t p = 0; p < points.positions.size(); ++p) {
      const float area = std::fabs(dot(points.normals[p], view));
      if (before[p] < clear && area > 0) pairs.push_back({p, area}), rays.push_back({points.positions[p], view});
    }
  }

  std::vector<Sums> all(extinctions.size(), Sums(points.positions.size(), to_lights.size()));
  VolumeSettings volume;
  volume.light = settings.light;
  volume.steps = settings.steps;
  const std::vector<size_t> read = cellsNearCloud(field);
  const std::vector<Vec3> centers = pick(cellCenters(field), read);
  std::vector<float> lengths(field.fractions.size(), 0.0F);
  for (size_t j = 0; j < to_lights.size(); ++j) {
    const std::vector<float> marched = plainLengths(field, centers, to_lights[j], settings.steps);
    for (size_t i = 0; i < read.size(); ++i) lengths[read[i]] = marched[i];
    for (size_t e = 0; e < extinctions.size(); ++e) {
      volume.extinction = extinctions[e];
      all[e].add(pairs, lightAlong({&field, lengths, lengths}, rays, to_lights[j], volume), j);
    }
  }
  std::vector<VolumeTruth> truths;
  for (const Sums& sums : all) truths.push_back(sums.truth(pairs.size()));
  return truths;
}

RadianceError compareRadiance(const VolumeTruth& truth, size_t lights, const std::function<double(size_t, size_t)>& shading) {
  // Σ w (C − e·f)² = Σ w C² − 2 e Σ w C f + e² Σ w f²
  double weights = 0, squares = 0, products = 0, own = 0, limit = 0;
  for (size_t i = 0; i < truth.seen.size(); ++i)
    for (size_t j = 0; j < lights; ++j) {
      const double w = truth.weights[i], mean = truth.mean[i * lights + j], square = truth.square[i * lights + j], f = shading(i, j);
      weights += w, squares += w * square, products += w * mean * f, own += w * f * f, limit += w * std::max(0.0, square - mean * mean);
    }
  if (!(weights > 0)) return {};
  const auto rms = [&](double exposure) {
    return std::sqrt(std::max(0.0, squares - 2 * exposure * products + exposure * exposure * own) / weights);
  };
  const double best = own > 0 ? products / own : 1;
  return {rms(1), rms(best), best, std::sqrt(limit / weights)};
}

namespace {

std::vector<Vec3> sunsOf(const std::optional<SunArc>& arc) {
  if (arc) return sunsOver(*arc, kSuns);
  std::vector<Vec3> suns = fibonacciDirections(2 * kSuns);
  std::erase_if(suns, [](Vec3 sun) { return !(sun.y > 0); });
  return suns;
}

}  // namespace

std::vector<RadianceFigures> measureRadiance(const Cloud& cloud, const IntegrationField& field, const BakedLobes& baked,
                                             const Settings& settings, const BakeParameters& parameters) {
  const std::vector<Vec3> suns = sunsOf(settings.lobe.sun_arc);
  const std::vector<size_t> chosen =
      evenlySpread(cloud.surface.positions.size(), std::min(kJudgedVertices, settings.judge.truth_vertices.value_or(kJudgedVertices)));
  const std::vector<Vec3> positions = pick(cloud.surface.positions, chosen), normals = pick(cloud.surface.normals, chosen);
  const std::vector<float> lengths = trueLengths(*referenceFor(cloud, settings.field), positions, suns, *parameters.bake.ray_length);

  Warnings told_already;
  Stopwatch not_timed;
  StageSeconds no_seconds;
  const std::vector<Lobe> mean = meanLobes({positions, normals}, field, parameters.bake, told_already);
  LobeSettings to_transmittance = settings.lobe;
  to_transmittance.fit_to_volume = false;
  const BakedLobes transmittance = bakeLobes(cloud, field, to_transmittance, parameters, told_already, not_timed, no_seconds);

  FieldSettings other = settings.field;
  other.bake_voxels = kVoxels;
  const IntegrationField judges = buildField(cloud, other, Method::kSweep, told_already);
  const std::vector<float> extinctions = extinctionSteps(parameters.extinction_low, parameters.extinction_high);
  const std::vector<VolumeTruth> truths =
      marchVolume({positions, normals}, *judges.coverage, suns, extinctions, {settings.lobe.volume.over({})});
  std::vector<RadianceFigures> all;
  for (size_t e = 0; e < extinctions.size(); ++e) {
    const float extinction = extinctions[e];
    const VolumeTruth& truth = truths[e];
    RadianceFigures& figures = all.emplace_back(RadianceFigures{extinction, truth.seen.size(), truth.views, suns.size(), {}});
    const auto judge = [&](const std::string& name, const auto& shading) {
      figures.shadings.emplace_back(
          name, compareRadiance(truth, suns.size(), [&](size_t i, size_t j) { return double(shading(truth.seen[i], j)); }));
    };
    const auto judgeLobes = [&](const std::string& name, const std::vector<Lobe>& lobes, LobeShape shape) {
      judge(name, [&](size_t v, size_t j) { return lobeTransmittance(lobes[v], suns[j], shape, extinction); });
    };
    judgeLobes("published lobe", mean, defaultMeanShape(cloud.surface));
    judge("exact T", [&](size_t v, size_t j) { return portableExp(-double(extinction) * lengths[v * suns.size() + j]); });
    judgeLobes("fitted to T", pick(transmittance.lobes, chosen), transmittance.shape);
    judgeLobes("fitted to volume", pick(baked.lobes, chosen), baked.shape);
    BakeParameters at_this = parameters;
    at_this.extinction = extinction;
    for (int order = 1; order <= kHighestOrder; ++order) {
      const std::vector<float> coefficients = bakeHarmonics({positions, normals}, field, order, settings.lobe, at_this);
      const size_t count = harmonicCount(order);
      judge("sh" + std::to_string(order),
            [&](size_t v, size_t j) { return harmonicTransmittance(std::span(coefficients).subspan(v * count, count), suns[j]); });
    }
  }
  return all;
}

}  // namespace cloudbake
