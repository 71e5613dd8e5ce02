// cloudbake measure INPUT: the error figures of docs/lobe_math.md for the chosen settings, against an independent truth, and seconds; with
// -o DIR the speed–error curve of all methods.
#include <cmath>
#include <cstdio>

#include "pipeline/sources/grown.h"
#include "app/commands.h"
#include "pipeline/measure/curve.h"
#include "io/report/figure_lines.h"
#include "pipeline/lobes.h"
#include "pipeline/asset.h"
#include "pipeline/sources/volume.h"
#include "bake/truth/error_metrics.h"
#include "bake/lobe/fit_lobe.h"
#include "core/harmonics.h"

namespace cloudbake {

namespace {

struct Figures {
  std::string truth;
  uint64_t measured = 0;
  LobeError lobe;
  TransmittanceError lengths, formula;
  std::vector<FitError> fit;  // of a fitted lobe, against the truth
  std::optional<HarmonicError> harmonics;
};

// rms of T over all vertices and directions.
double harmonicRms(std::span<const float> coefficients, std::span<const Vec3> directions, std::span<const float> lengths,
                   float extinction) {
  const size_t points = lengths.size() / directions.size(), count = coefficients.size() / points;
  double squares = 0;
  for (size_t p = 0; p < points; ++p)
    for (size_t j = 0; j < directions.size(); ++j) {
      const double truth = std::exp(-double(extinction) * lengths[p * directions.size() + j]);
      squares += std::pow(harmonicTransmittance(coefficients.subspan(p * count, count), directions[j]) - truth, 2);
    }
  return std::sqrt(squares / double(lengths.size()));
}

Figures measureScene(const Scene& scene, const IntegrationField& field, const std::vector<Lobe>& all_lobes, const Settings& settings,
                     BakeReport& report, Stopwatch& watch) {
  const Oracle oracle = askOracle(scene, settings);
  const std::vector<Lobe> lobes = pick(all_lobes, oracle.vertices);
  Figures figures;
  figures.truth = oracle.name;
  figures.measured = lobes.size();
  figures.lobe = compareLobes(lobes, oracle.truth);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  const auto estimate = estimatedLengths(oracle.positions, oracle.axes, field, settings.bake);
  figures.lengths = compareLengths(estimate, oracle.lengths, report.info.extinction);
  figures.formula = compareTransmittance(lobes, report.info.shape, directions, oracle.lengths, report.info.extinction);
  if (settings.fit) {
    const std::vector<Vec3> normals = pick(scene.surface.normals, oracle.vertices);
    Warnings told_already;
    const std::vector<Lobe> mean = meanLobes({oracle.positions, normals}, field, settings.bake, told_already);
    const LobeShape mean_shape = defaultMeanShape(scene.surface);
    for (const float extinction : extinctionSteps(report.info.extinction_low, report.info.extinction_high))
      figures.fit.push_back({extinction, compareTransmittance(mean, mean_shape, directions, oracle.lengths, extinction).rms,
                             compareTransmittance(lobes, report.info.shape, directions, oracle.lengths, extinction).rms});
  }
  if (settings.harmonic_order > 0) {
    const std::vector<float> coefficients = bakeHarmonics(oracle.positions, field, settings, report.info.extinction);
    figures.harmonics = HarmonicError{settings.harmonic_order, figures.formula.rms,
                                      harmonicRms(coefficients, directions, oracle.lengths, report.info.extinction)};
  }
  watch.lap(report, "truth");
  return figures;
}

std::string figuresText(const Figures& f) {
  std::string text = figureLine("truth", "{}, {} vertices, {} directions", f.truth, f.measured, kTruthDirections);
  text += lobeErrorLines(f.lobe);
  text += figureLine("transmittance", "rms {:.4f}, bias {:+.4f} of the lengths; rms {:.4f}, bias {:+.4f} of the lobe ({} directions)",
                     f.lengths.rms, f.lengths.bias, f.formula.rms, f.formula.bias, kTransmittanceDirections);
  for (const auto& [extinction, mean_rms, fitted_rms] : f.fit)
    text += figureLine("fitted lobe", "extinction {:.4g}: rms of T {:.4f}, of the mean lobe {:.4f}, ratio {:.3f}", extinction, fitted_rms, mean_rms,
                       fitted_rms / mean_rms);
  if (const auto& h = f.harmonics)
    text += figureLine("harmonics", "order {}: rms of T {:.4f}, of the lobe {:.4f}, ratio {:.3f}", h->order, h->rms, h->lobe_rms,
                       h->rms / h->lobe_rms);
  return text;
}

Json figuresJson(const Figures& f) {
  Json json = {{"truth", f.truth}, {"vertices", f.measured}};
  addLobeError(json, f.lobe);
  json["transmittance_of_lengths"] = {{"rms", f.lengths.rms}, {"bias", f.lengths.bias}};
  json["transmittance_of_lobe"] = {{"rms", f.formula.rms}, {"bias", f.formula.bias}};
  for (const auto& [extinction, mean_rms, fitted_rms] : f.fit)
    json["fit"].push_back({{"extinction", extinction}, {"mean_rms", mean_rms}, {"fitted_rms", fitted_rms}});
  if (const auto& h = f.harmonics) json["harmonics"] = {{"order", h->order}, {"lobe_rms", h->lobe_rms}, {"rms", h->rms}};
  return json;
}

}  // namespace

ExitCode runMeasure(Settings settings, const ApplyCommandLine& apply_command_line) {
  apply_command_line(settings);
  checkVolumeOptions(settings);
  BakeReport report;
  report.command = "measure";
  Stopwatch watch;
  const Scene scene = isGrown(settings) ? growScene(settings, apply_command_line, report, watch) : readScene(settings, report, watch);
  resolveInfo(settings, scene, report, watch);
  if (!settings.output.empty()) return runCurve(scene, settings, report);
  const IntegrationField field = fieldOfScene(scene, settings, report, watch);
  const std::vector<Lobe> lobes = bakeScene(scene, field, settings, report, watch);
  const Figures figures = measureScene(scene, field, lobes, settings, report, watch);
  enforceStrict(settings, report);
  tellReport(settings, report, "error", figuresJson(figures), figuresText(figures));
  return ExitCode::kDone;
}

}  // namespace cloudbake
