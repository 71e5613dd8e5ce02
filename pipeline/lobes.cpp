#include "pipeline/lobes.h"

#include <algorithm>
#include <cmath>

#include "bake/lobe/fit_lobe.h"
#include "bake/lobe/harmonics.h"
#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/smooth_lobes.h"
#include "bake/truth/error_metrics.h"

namespace cloudbake {

namespace {

constexpr int kFitDirections = 100, kJudgingDirections = 512;
constexpr size_t kShapeVertices = 256, kJudgedVertices = 2000, kBlock = 1 << 16;

Vec3 directionAt(float elevation_degrees, float azimuth_degrees) {
  const float to_radians = float(kPi / 180), elevation = elevation_degrees * to_radians, azimuth = azimuth_degrees * to_radians;
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

struct FittedLobes {
  std::vector<Lobe> lobes;
  LobeShape shape;
};

// Fits lobes, starting from the mean lobes.
FittedLobes fittedLobes(const Cloud& cloud, const IntegrationField& field, const std::vector<Lobe>& mean, const LobeSettings& settings,
                        const BakeParameters& parameters) {
  const LightSet lights = lightSet(settings.sun_arc, kFitDirections);
  const std::vector<Vec3> directions = bothSenses(lights.axes);
  FitSettings fit;
  fit.shape = parameters.shape;
  fit.extinctions = extinctionSteps(parameters.extinction_low, parameters.extinction_high);

  if (settings.fit_exponent || settings.fit_bias) {
    const std::vector<size_t> chosen = evenlySpread(mean.size(), kShapeVertices);
    const std::vector<float> lengths = estimatedLengths(pick(cloud.surface.positions, chosen), lights.axes, field, parameters.bake);
    fit.shape =
        fitShape(pick(mean, chosen), {directions, lengths, lights.weights}, fit, {settings.fit_exponent, settings.fit_bias, chosen.size()});
  }

  // The vertices are fitted in blocks, so that the lengths of a large mesh do not fill the memory.
  FittedLobes fitted{{}, fit.shape};
  for (size_t begin = 0; begin < mean.size(); begin += kBlock) {
    const size_t count = std::min(kBlock, mean.size() - begin);
    const std::vector<float> lengths =
        estimatedLengths(std::span(cloud.surface.positions).subspan(begin, count), lights.axes, field, parameters.bake);
    const std::vector<Lobe> block = fitLobes(std::span(mean).subspan(begin, count), {directions, lengths, lights.weights}, fit);
    fitted.lobes.insert(fitted.lobes.end(), block.begin(), block.end());
  }
  return fitted;
}

// The errors of T at some vertices, over lights of the same kind as those of the fit, but in other directions.
std::vector<FitError> judgedFit(const Cloud& cloud, const IntegrationField& field, const std::vector<Lobe>& mean, const FittedLobes& fitted,
                                const LobeSettings& settings, const BakeParameters& parameters) {
  const std::vector<size_t> judged = evenlySpread(fitted.lobes.size(), kJudgedVertices);
  const LightSet lights = lightSet(settings.sun_arc, kJudgingDirections);
  const std::vector<float> lengths = estimatedLengths(pick(cloud.surface.positions, judged), lights.axes, field, parameters.bake);
  const std::vector<Vec3> directions = bothSenses(lights.axes);
  std::vector<FitError> errors;
  for (const float extinction : extinctionSteps(parameters.extinction_low, parameters.extinction_high)) {
    const auto rms = [&](const std::vector<Lobe>& lobes, LobeShape shape) {
      return compareTransmittance(pick(lobes, judged), shape, directions, lengths, extinction, lights.weights).rms;
    };
    errors.push_back({extinction, rms(mean, defaultMeanShape(cloud.surface)), rms(fitted.lobes, fitted.shape)});
  }
  return errors;
}

}  // namespace

// The sun over its arc, in steps of about the same length in both angles, and the zenith for the sky, with half the weight of the whole
// arc.
LightSet lightSet(const std::optional<SunArc>& arc, int directions) {
  if (!arc) return {sweepAxes(directions), {}};
  const float height = arc->elevation_high_degrees - arc->elevation_low_degrees,
              width = arc->azimuth_high_degrees - arc->azimuth_low_degrees;
  const int rows = std::clamp(int(std::lround(std::sqrt(float(directions) * (height + 1) / (width + 1)))), 1, directions);
  const int columns = std::max(1, directions / rows);
  LightSet set;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      set.axes.push_back(directionAt(arc->elevation_low_degrees + height * (float(row) + 0.5F) / float(rows),
                                     arc->azimuth_low_degrees + width * (float(column) + 0.5F) / float(columns)));
  const auto suns = float(set.axes.size());
  set.axes.push_back({0, 1, 0});
  for (size_t i = 0; i < set.axes.size(); ++i) set.weights.insert(set.weights.end(), {i + 1 < set.axes.size() ? 1.0F : suns / 2, 0.0F});
  return set;
}

BakedLobes bakeLobes(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings, const BakeParameters& parameters,
                     Warnings& warnings, Stopwatch& watch, StageSeconds& seconds) {
  const std::vector<Lobe> mean = meanLobes({cloud.surface.positions, cloud.surface.normals}, field, parameters.bake, warnings);
  watch.lap(seconds, "bake");
  FittedLobes result{mean, parameters.shape};
  if (settings.fit) {
    result = fittedLobes(cloud, field, mean, settings, parameters);
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

std::vector<float> bakeHarmonics(std::span<const Vec3> positions, const IntegrationField& field, int order,
                                 const BakeParameters& parameters) {
  const std::vector<Vec3> axes = sweepAxes(parameters.bake.rays / 2 * 2);
  const std::vector<Vec3> directions = bothSenses(axes);
  std::vector<float> coefficients;
  for (size_t begin = 0; begin < positions.size(); begin += kBlock) {
    const auto block = positions.subspan(begin, std::min(kBlock, positions.size() - begin));
    const std::vector<float> lengths = estimatedLengths(block, axes, field, parameters.bake);
    const std::vector<float> some = transmittanceHarmonics(directions, lengths, order, parameters.extinction);
    coefficients.insert(coefficients.end(), some.begin(), some.end());
  }
  return coefficients;
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
  lattice.coefficients = bakeHarmonics(centers, field, settings.harmonic_order, parameters);
  return lattice;
}

}  // namespace cloudbake
