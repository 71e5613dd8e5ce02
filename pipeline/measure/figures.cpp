#include "pipeline/measure/figures.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "bake/lobe/fit_lobe.h"
#include "bake/truth/error_metrics.h"
#include "core/harmonics.h"
#include "core/portable_math.h"
#include "io/report/figures.h"
#include "pipeline/measure/oracle.h"

namespace cloudbake {

namespace {

// The rms error of T over all vertices and directions.
double harmonicRms(std::span<const float> coefficients, std::span<const Vec3> directions, std::span<const float> lengths,
                   float extinction) {
  const size_t points = lengths.size() / directions.size(), count = coefficients.size() / points;
  double squares = 0;
  for (size_t p = 0; p < points; ++p)
    for (size_t j = 0; j < directions.size(); ++j) {
      const double truth = portableExp(-double(extinction) * lengths[p * directions.size() + j]);
      const double error = harmonicTransmittance(coefficients.subspan(p * count, count), directions[j]) - truth;
      squares += error * error;
    }
  return std::sqrt(squares / double(lengths.size()));
}

}  // namespace

MeasuredFigures measureBake(const Cloud& cloud, const IntegrationField& field, const BakedLobes& baked, const Settings& settings,
                            const BakeParameters& parameters) {
  const LobeSettings& lobe = settings.lobe;
  OracleQuestion question{
      .extinction = parameters.extinction, .ray_length = *parameters.bake.ray_length, .over_surface = !lobe.fit_to_volume};
  const Oracle oracle = askOracle(cloud, settings.field, settings.judge.truth_vertices, question);
  const float extinction = parameters.extinction;
  MeasuredFigures figures;
  figures.bake = figuresAgainst(oracle, baked.lobes, lobe.fit, baked.shape, extinction);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  const auto estimate = estimatedLengths(oracle.positions, oracle.axes, field, parameters.bake);
  figures.lengths = compareLengths(estimate, oracle.lengths, extinction);
  if (lobe.fit_to_volume) {
    question.volume = lobe.volume.over({}), question.over_surface = true;
    const Oracle of_volume = askOracle(cloud, settings.field, settings.judge.truth_vertices, question);
    figures.bake.surface = figuresAgainst(of_volume, baked.lobes, lobe.fit, baked.shape, extinction).surface;
    figures.radiance = measureRadiance(cloud, field, baked, settings, parameters);
    return figures;
  }
  if (lobe.fit) {
    const std::vector<Vec3> normals = pick(cloud.surface.normals, oracle.vertices);
    Warnings told_already;
    const std::vector<Lobe> mean = meanLobes({oracle.positions, normals}, field, parameters.bake, told_already);
    const std::vector<Lobe> fitted = pick(baked.lobes, oracle.vertices);
    const LobeShape mean_shape = defaultMeanShape(cloud.surface);
    for (const float one : extinctionSteps(parameters.extinction_low, parameters.extinction_high))
      figures.fit.push_back({one, compareTransmittance(mean, mean_shape, directions, oracle.lengths, one).rms,
                             compareTransmittance(fitted, baked.shape, directions, oracle.lengths, one).rms});
  }
  if (lobe.harmonic_order > 0) {
    const std::vector<float> coefficients = bakeHarmonics({oracle.positions, {}}, field, lobe.harmonic_order, lobe, parameters);
    figures.harmonics = HarmonicError{lobe.harmonic_order, figures.bake.transmittance.rms,
                                      harmonicRms(coefficients, directions, oracle.lengths, extinction)};
  }
  return figures;
}

std::string figuresText(const MeasuredFigures& f) {
  std::string text = figureLine("truth", "{}, {} vertices, {} directions", f.bake.truth, f.bake.vertices, kTruthDirections);
  text += lobeErrorLines(f.bake.lobe);
  text += figureLine("transmittance", "rms {:.4f}, bias {:+.4f} of the lengths; rms {:.4f}, bias {:+.4f} of the lobe ({} directions)",
                     f.lengths.rms, f.lengths.bias, f.bake.transmittance.rms, f.bake.transmittance.bias, kTransmittanceDirections);
  text += surfaceErrorLine(f.bake.surface, f.radiance.empty() ? "T" : "the volume's light");
  for (const auto& [extinction, mean_rms, fitted_rms] : f.fit)
    text += figureLine("fitted lobe", "extinction {:.4g}: rms of T {:.4f}, of the mean lobe {:.4f}, ratio {:.3f}", extinction, fitted_rms,
                       mean_rms, fitted_rms / mean_rms);
  for (const RadianceFigures& r : f.radiance) {
    text += figureLine("radiance", "extinction {:.4g}: {} vertices, {} pairs of a vertex and a view, {} suns", r.extinction, r.vertices,
                       r.pairs, r.suns);
    for (const auto& [name, error] : r.shadings)
      text +=
          figureLine("", "  {:16} rms {:.4f}, after the best exposure ({:.2f}) {:.4f}", name, error.rms, error.exposure, error.exposed_rms);
    if (!r.shadings.empty()) text += figureLine("", "  {:16} rms {:.4f}", "any without view", r.shadings.front().second.limit);
  }
  if (const auto& h = f.harmonics)
    text += figureLine("harmonics", "order {}: rms of T {:.4f}, of the lobe {:.4f}, ratio {:.3f}", h->order, h->rms, h->lobe_rms,
                       h->rms / h->lobe_rms);
  return text;
}

Json figuresJson(const MeasuredFigures& f) {
  Json json = {{"truth", f.bake.truth}, {"vertices", f.bake.vertices}};
  addLobeError(json, f.bake.lobe);
  json["transmittance_of_lengths"] = {{"rms", f.lengths.rms}, {"bias", f.lengths.bias}};
  json["transmittance_of_lobe"] = {{"rms", f.bake.transmittance.rms}, {"bias", f.bake.transmittance.bias}};
  addSurfaceError(json, f.bake.surface);
  for (const auto& [extinction, mean_rms, fitted_rms] : f.fit)
    json["fit"].push_back({{"extinction", extinction}, {"mean_rms", mean_rms}, {"fitted_rms", fitted_rms}});
  for (const RadianceFigures& r : f.radiance) {
    Json one = {{"extinction", r.extinction}, {"vertices", r.vertices}, {"pairs", r.pairs}, {"suns", r.suns}};
    for (const auto& [name, error] : r.shadings) {
      one["shadings"].push_back({{"name", name}, {"rms", error.rms}, {"exposed_rms", error.exposed_rms}, {"exposure", error.exposure}});
      one["limit_rms"] = error.limit;
    }
    json["radiance"].push_back(one);
  }
  if (const auto& h = f.harmonics) json["harmonics"] = {{"order", h->order}, {"lobe_rms", h->lobe_rms}, {"rms", h->rms}};
  return json;
}

}  // namespace cloudbake
