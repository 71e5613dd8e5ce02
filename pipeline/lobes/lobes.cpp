#include "pipeline/lobes/lobes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bake/lobe/fit_lobe.h"
#include "bake/lobe/harmonics.h"
#include "bake/lobe/sparse_points.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_target.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/smooth_lobes.h"
#include "bake/truth/error_metrics.h"
#include "core/memory_budget.h"
#include "core/parallel.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

// The lobe is off by a tenth of R, so a fit to a volume takes few samples (docs/lobe_math.md has the errors).
struct FitSampling {
  int directions = 100, views = 0, depths = 0;  // views and depths of a fit to a volume
  int judging_directions = 512, judging_views = 0, judging_depths = 0;
  size_t judged_vertices = 2000, shape_vertices = 256;  // the latter for the search of k and b
  float exponent = 4, bias_depths = 0, first_step = 1;  // where that search begins
};
constexpr FitSampling kTransmittanceSampling{};
constexpr FitSampling kVolumeSampling{.directions = 30,
                                      .views = 16,
                                      .depths = 2,
                                      .judging_directions = 64,
                                      .judging_views = 20,
                                      .judging_depths = 4,
                                      .judged_vertices = 300,
                                      .shape_vertices = 128,
                                      .exponent = 2,
                                      .bias_depths = 0.25F,
                                      .first_step = 0.5F};
constexpr size_t kBlock = 1 << 16;
constexpr double kShareOfTargets = 0.7;  // of the time of a fit, roughly

const FitSampling& samplingOf(const LobeSettings& settings) { return settings.fit_to_volume ? kVolumeSampling : kTransmittanceSampling; }

VolumeTargetSettings volumeSettings(const LobeSettings& settings, const BakeParameters& parameters, std::vector<float> extinctions) {
  return {std::move(extinctions), settings.volume.over({}), *parameters.bake.ray_length};
}

Vec3 directionAt(float elevation_degrees, float azimuth_degrees) {
  const SinCos elevation = sinCosDegrees(elevation_degrees), azimuth = sinCosDegrees(azimuth_degrees);
  return {float(elevation.cos * azimuth.sin), float(elevation.sin), float(elevation.cos * azimuth.cos)};
}

// What lobes are fitted to at some points, towards both senses of the axes.
struct FitTargets {
  std::vector<float> lengths, radiance;  // one of them: the radiance of a fit to a volume
  uint64_t unseen = 0;                   // points
};

// The targets of many points, which may be asked for in blocks.
class TargetMaker {
 public:
  TargetMaker(size_t points, std::span<const Vec3> axes, const IntegrationField& field, const LobeSettings& settings,
              const BakeParameters& parameters, bool is_judge = false)
      : axes_(axes), field_(field), bake_(parameters.bake) {
    if (!settings.fit_to_volume) return;
    VolumeTargetSettings sampled =
        volumeSettings(settings, parameters, extinctionSteps(parameters.extinction_low, parameters.extinction_high));
    sampled.views = is_judge ? kVolumeSampling.judging_views : kVolumeSampling.views;
    sampled.depths = is_judge ? kVolumeSampling.judging_depths : kVolumeSampling.depths;
    sampled.may_interpolate = !is_judge;
    volume_.emplace(points, axes, field.swept(), sampled);
  }
  FitTargets at(const BakePoints& points) const {
    if (!volume_) return {estimatedLengths(points.positions, axes_, field_, bake_), {}};
    VolumeTarget volume = volume_->at(points);
    return {{}, std::move(volume.radiance), volume.unseen};
  }

 private:
  std::span<const Vec3> axes_;
  const IntegrationField& field_;
  const BakeSettings& bake_;
  std::optional<VolumeTargets> volume_;
};

// What all vertices of a fit share.
struct FitPlan {
  const IntegrationField& field;
  const LobeSettings& settings;
  const BakeParameters& parameters;
  LightSet lights;
  std::vector<Vec3> directions;
  FitSettings fit;
};

// Fits lobes at points, in blocks, so that the targets of many do not fill the memory. Counts the points that no view sees.
std::vector<Lobe> fittedAt(const BakePoints& points, std::span<const Lobe> starts, const FitPlan& plan, uint64_t& unseen) {
  const TargetMaker maker(starts.size(), plan.lights.axes, plan.field, plan.settings, plan.parameters);
  std::vector<Lobe> fitted;
  fitted.reserve(starts.size());
  for (size_t begin = 0; begin < starts.size(); begin += kBlock) {
    const size_t count = std::min(kBlock, starts.size() - begin);
    const auto block = [&](const auto& values) { return values.empty() ? std::span(values) : std::span(values).subspan(begin, count); };
    const LoopProgress::Part part(double(begin) / double(starts.size()), double(begin + count) / double(starts.size()));
    const auto targetsOfBlock = [&] {
      const LoopProgress::Part most_of_it(0, kShareOfTargets);
      return maker.at({block(points.positions), block(points.normals)});
    };
    const FitTargets targets = targetsOfBlock();
    const LoopProgress::Part rest(kShareOfTargets, 1);
    const std::vector<Lobe> lobes =
        fitLobes(block(starts), {plan.directions, targets.lengths, plan.lights.weights, targets.radiance}, plan.fit);
    fitted.insert(fitted.end(), lobes.begin(), lobes.end());
    unseen += targets.unseen;
  }
  return fitted;
}

// Fits lobes, starting from the mean lobes.
ShapedLobes fittedLobes(const SurfaceMesh& surface, const IntegrationField& field, const std::vector<Lobe>& mean,
                        const LobeSettings& settings, const BakeParameters& parameters, Warnings& warnings) {
  FitPlan plan{field, settings, parameters, fitLights(settings.sun_arc, settings.fit_to_volume, samplingOf(settings).directions), {}, {}};
  plan.directions = bothSenses(plan.lights.axes);
  plan.fit.shape = parameters.shape;
  plan.fit.extinctions = extinctionSteps(parameters.extinction_low, parameters.extinction_high);
  const BakePoints points{surface.positions, surface.normals};

  if (settings.fit_exponent || settings.fit_bias) {
    const FitSampling& sampling = samplingOf(settings);
    if (settings.fit_exponent) plan.fit.shape.exponent = sampling.exponent;
    if (settings.fit_bias) plan.fit.shape.bias = sampling.bias_depths / parameters.extinction;
    const std::vector<size_t> some = evenlySpread(mean.size(), sampling.shape_vertices);
    const std::vector<Vec3> positions = pick(surface.positions, some), normals = pick(surface.normals, some);
    const LoopProgress::Part search(0, 0.01);
    const FitTargets targets = TargetMaker(some.size(), plan.lights.axes, field, settings, parameters).at({positions, normals});
    plan.fit.shape = fitShape(pick(mean, some), {plan.directions, targets.lengths, plan.lights.weights, targets.radiance}, plan.fit,
                              {settings.fit_exponent, settings.fit_bias, sampling.first_step, some.size()});
  }

  uint64_t unseen = 0;
  ShapedLobes fitted{{}, plan.fit.shape};
  const auto sparse = settings.fit_to_volume ? SparsePoints::choose(points, *field.coverage) : std::nullopt;
  if (sparse) {
    const std::vector<size_t>& chosen = sparse->chosen();
    const std::vector<Vec3> positions = pick(surface.positions, chosen), normals = pick(surface.normals, chosen);
    fitted.lobes = sparse->blended(fittedAt({positions, normals}, pick(mean, chosen), plan, unseen));
    unseen = uint64_t(double(unseen) * double(mean.size()) / double(chosen.size()));  // about so many of all
  } else {
    fitted.lobes = fittedAt(points, mean, plan, unseen);
  }
  // Vertices in creases and of inner shells are in no picture. If most are like that, something is wrong with the mesh.
  constexpr double kUnseenShare = 0.5;
  if (double(unseen) > kUnseenShare * double(mean.size()))
    warnings.add(WarningKind::kUnseenVertex, "a vertex that no view sees from outside was fitted as if nothing were in front of it",
                 unseen);
  return fitted;
}

// The errors at some vertices, over lights of the same kind as those of the fit, but in other directions.
std::vector<FitError> judgedFit(const Cloud& cloud, const IntegrationField& field, const std::vector<Lobe>& mean, const ShapedLobes& fitted,
                                const LobeSettings& settings, const BakeParameters& parameters) {
  const std::vector<size_t> judged = evenlySpread(fitted.lobes.size(), samplingOf(settings).judged_vertices);
  const LightSet lights = fitLights(settings.sun_arc, settings.fit_to_volume, samplingOf(settings).judging_directions);
  const std::vector<Vec3> directions = bothSenses(lights.axes), positions = pick(cloud.surface.positions, judged),
                          normals = pick(cloud.surface.normals, judged);
  const FitTargets targets = TargetMaker(judged.size(), lights.axes, field, settings, parameters, true).at({positions, normals});
  const std::vector<float> extinctions = extinctionSteps(parameters.extinction_low, parameters.extinction_high);
  std::vector<FitError> errors;
  for (size_t i = 0; i < extinctions.size(); ++i) {
    std::vector<float> light;  // that the target has at this σ
    for (size_t v = 0; v < judged.size() && settings.fit_to_volume; ++v) {
      const auto row = targets.radiance.begin() + ptrdiff_t((v * extinctions.size() + i) * directions.size());
      light.insert(light.end(), row, row + ptrdiff_t(directions.size()));
    }
    const auto rms = [&](const std::vector<Lobe>& lobes, LobeShape shape) {
      const std::vector<Lobe> some = pick(lobes, judged);
      return (light.empty() ? compareTransmittance(some, shape, directions, targets.lengths, extinctions[i], lights.weights)
                            : compareLight(some, shape, directions, light, extinctions[i], lights.weights))
          .rms;
    };
    errors.push_back({extinctions[i], rms(mean, defaultMeanShape(cloud.surface)), rms(fitted.lobes, fitted.shape)});
  }
  return errors;
}

}  // namespace

// In steps of about the same length in both angles.
std::vector<Vec3> sunsOver(const SunArc& arc, int count) {
  const float height = arc.elevation_high_degrees - arc.elevation_low_degrees, width = arc.azimuth_high_degrees - arc.azimuth_low_degrees;
  const int rows = std::clamp(int(std::lround(std::sqrt(float(count) * (height + 1) / (width + 1)))), 1, count);
  const int columns = std::max(1, count / rows);
  std::vector<Vec3> suns;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      suns.push_back(directionAt(arc.elevation_low_degrees + height * (float(row) + 0.5F) / float(rows),
                                 arc.azimuth_low_degrees + width * (float(column) + 0.5F) / float(columns)));
  return suns;
}

// The zenith stands for the sky, with half the weight of the whole arc.
LightSet lightSet(const std::optional<SunArc>& arc, int directions) {
  if (!arc) return {sweepAxes(directions), {}};
  LightSet set{sunsOver(*arc, directions), {}};
  const auto suns = float(set.axes.size());
  set.axes.push_back({0, 1, 0});
  for (size_t i = 0; i < set.axes.size(); ++i) set.weights.insert(set.weights.end(), {i + 1 < set.axes.size() ? 1.0F : suns / 2, 0.0F});
  return set;
}

LightSet fitLights(const std::optional<SunArc>& arc, bool to_volume, int directions) {
  LightSet set = lightSet(arc, directions);
  if (arc || !to_volume) return set;
  // Both weights are measured: docs/lobe_math.md
  constexpr float kBelowHorizon = 0.1F, kZenithShare = 0.1F;
  const auto axes = float(set.axes.size());
  for (const Vec3& axis : set.axes) set.weights.insert(set.weights.end(), {axis.y < 0 ? kBelowHorizon : 1, axis.y < 0 ? 1 : kBelowHorizon});
  set.axes.push_back({0, 1, 0});
  set.weights.insert(set.weights.end(), {kZenithShare * axes, 0});
  return set;
}

ShapedLobes lobesAt(const SurfaceMesh& points, const IntegrationField& field, const LobeSettings& settings,
                    const BakeParameters& parameters, Warnings& warnings) {
  const std::vector<Lobe> mean = meanLobes({points.positions, points.normals}, field, parameters.bake, warnings);
  return settings.fit ? fittedLobes(points, field, mean, settings, parameters, warnings) : ShapedLobes{mean, parameters.shape};
}

std::vector<float> lightAt(const BakePoints& points, std::span<const Vec3> axes, const IntegrationField& field,
                           const LobeSettings& settings, const BakeParameters& parameters) {
  if (settings.fit_to_volume)
    return volumeTarget(points, axes, field.swept(), volumeSettings(settings, parameters, {parameters.extinction})).radiance;
  return scatteredLight(estimatedLengths(points.positions, axes, field, parameters.bake), parameters.extinction, {});
}

BakedLobes bakeLobes(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings, const BakeParameters& parameters,
                     Warnings& warnings, Stopwatch& watch, StageSeconds& seconds) {
  const std::vector<Lobe> mean = meanLobes({cloud.surface.positions, cloud.surface.normals}, field, parameters.bake, warnings);
  watch.lap(seconds, "bake");
  ShapedLobes result{mean, parameters.shape};
  if (settings.fit) {
    result = fittedLobes(cloud.surface, field, mean, settings, parameters, warnings);
    watch.lap(seconds, "fit");
  }
  if (settings.smooth > 0) {
    smoothLobes(result.lobes, cloud.surface, settings.smooth);
    watch.lap(seconds, "smooth");
  }
  BakedLobes baked{std::move(result.lobes), result.shape, {}};
  if (settings.fit) {
    baked.fit = judgedFit(cloud, field, mean, {baked.lobes, baked.shape}, settings, parameters);
    watch.lap(seconds, "fit");
  }
  return baked;
}

// Swept lengths, the same point by point, and the light.
void requireHarmonicsMemory(size_t points, const LobeSettings& settings, const BakeParameters& parameters) {
  const size_t together = std::min(points, kBlock);
  requireMemory({fmt::format("the light at {} places from {} directions", together, parameters.bake.rays),
                 3.0 * sizeof(float) * double(together) * parameters.bake.rays, "use fewer --rays"},
                settings.memory_limit);
}

namespace {

// The coefficients at points in blocks, from valuesAt(begin, count, axes): the light towards both senses of the axes, point by point.
template <class Values>
std::vector<float> harmonicsOf(size_t points, int order, const BakeParameters& parameters, const Values& valuesAt) {
  const std::vector<Vec3> axes = sweepAxes(parameters.bake.rays / 2 * 2);
  const std::vector<Vec3> directions = bothSenses(axes);
  std::vector<float> coefficients;
  for (size_t begin = 0; begin < points; begin += kBlock) {
    const LoopProgress::Part part(double(begin) / double(points), double(std::min(begin + kBlock, points)) / double(points));
    const std::vector<float> some = fitHarmonics(directions, valuesAt(begin, std::min(kBlock, points - begin), axes), order);
    coefficients.insert(coefficients.end(), some.begin(), some.end());
  }
  return coefficients;
}

}  // namespace

std::vector<float> bakeHarmonics(const BakePoints& points, const IntegrationField& field, int order, const LobeSettings& settings,
                                 const BakeParameters& parameters) {
  return harmonicsOf(points.positions.size(), order, parameters, [&](size_t begin, size_t count, const std::vector<Vec3>& axes) {
    const auto normals = points.normals.empty() ? points.normals : points.normals.subspan(begin, count);
    return lightAt({points.positions.subspan(begin, count), normals}, axes, field, settings, parameters);
  });
}

HarmonicLattice bakeLattice(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings,
                            const BakeParameters& parameters) {
  const Box box = boundingBox(cloud.surface);
  HarmonicLattice lattice;
  lattice.order = settings.harmonic_order;
  lattice.extinction = parameters.extinction;
  lattice.cell_size = box.longestSide() / float(settings.lattice_cells);
  const Vec3 size = box.size();
  lattice.cells = {int(std::ceil(size.x / lattice.cell_size - 1e-3F)) + 2, int(std::ceil(size.y / lattice.cell_size - 1e-3F)) + 2,
                   int(std::ceil(size.z / lattice.cell_size - 1e-3F)) + 2};
  const Vec3 span = Vec3{float(lattice.cells[0] - 1), float(lattice.cells[1] - 1), float(lattice.cells[2] - 1)} * lattice.cell_size;
  lattice.origin = box.center() - span * 0.5F;
  std::vector<Vec3> centers;
  for (int z = 0; z < lattice.cells[2]; ++z)
    for (int y = 0; y < lattice.cells[1]; ++y)
      for (int x = 0; x < lattice.cells[0]; ++x) centers.push_back(lattice.origin + Vec3{float(x), float(y), float(z)} * lattice.cell_size);
  const OctaveSettings octaves = settings.fit_to_volume ? settings.volume.over({}).octaves : OctaveSettings{};
  lattice.coefficients =
      harmonicsOf(centers.size(), settings.harmonic_order, parameters, [&](size_t begin, size_t count, const std::vector<Vec3>& axes) {
        return scatteredLight(estimatedLengths(std::span(centers).subspan(begin, count), axes, field, parameters.bake),
                              parameters.extinction, octaves);
      });
  return lattice;
}

}  // namespace cloudbake
