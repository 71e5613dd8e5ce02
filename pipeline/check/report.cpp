#include "pipeline/check/report.h"

#include <nlohmann/json.hpp>

#include "io/report/figures.h"
#include "io/report/report.h"
#include "pipeline/measure/oracle.h"

namespace cloudbake {

namespace {

std::string figuresText(const CheckFigures& f, const AssetInfo& info) {
  std::string text = figureLine("truth", "{}, {} vertices, {} directions", f.bake.truth, f.bake.vertices, kTruthDirections);
  if (!f.bake.is_fit) text += lobeErrorLines(f.bake.lobe);
  text += figureLine(info.volume ? "radiance" : "transmittance", "rms {:.4f}, bias {:+.4f} of the lobe ({} lights)",
                     f.bake.transmittance.rms, f.bake.transmittance.bias, f.lights);
  text += surfaceErrorLine(f.bake.surface, judgedLight(info));
  if (f.bake.is_fit)
    text += figureLine("fitted lobe", "rms of {} {:.4f}, of the mean lobe {:.4f}, of a fit to {} {:.4f}", judgedLight(info),
                       f.bake.transmittance.rms, f.mean_rms, info.volume ? "that light" : "exact chords", f.best_fit_rms);
  return text;
}

std::string comparisonText(const ComparisonFigures& c) {
  return figureLine("against", "{}: {} vertices matched, {} only in the asset, {} only before", c.before, c.matched, c.added, c.lost) +
         lobeErrorLines(c.difference.lobe) + figureLine("", "largest difference of d {:.3f} %", 100 * c.density_max) +
         figureLine("transmittance", "rms {:.5f}, bias {:+.5f} between the two", c.difference.transmittance.rms,
                    c.difference.transmittance.bias) +
         figureLine("UV sets", "{}; before: {}", c.sets, c.sets_before) +
         figureLine("materials", "{}; before: {}", c.materials, c.materials_before);
}

Json figuresJson(const CheckFigures& f) {
  Json json = {{"truth", f.bake.truth}, {"vertices", f.bake.vertices}, {"lobe", f.bake.is_fit ? "fit" : "mean"}};
  if (!f.bake.is_fit) addLobeError(json, f.bake.lobe);
  json["transmittance"] = {{"rms", f.bake.transmittance.rms}, {"bias", f.bake.transmittance.bias}};
  addSurfaceError(json, f.bake.surface);
  if (f.bake.is_fit) json["transmittance"]["mean_lobe_rms"] = f.mean_rms, json["transmittance"]["best_fit_rms"] = f.best_fit_rms;
  return json;
}

Json comparisonJson(const ComparisonFigures& c) {
  Json json = {{"before", c.before}, {"matched", c.matched}, {"only_in_asset", c.added}, {"only_before", c.lost}};
  addLobeError(json, c.difference.lobe);
  json["density"]["max"] = c.density_max;
  json["transmittance"] = {{"rms", c.difference.transmittance.rms}, {"bias", c.difference.transmittance.bias}};
  json["uv_sets"] = {{"asset", c.sets}, {"before", c.sets_before}};
  json["materials"] = {{"asset", c.materials}, {"before", c.materials_before}};
  return json;
}

Json faultJson(const AssetFault& fault) { return {{"cause", fault.cause}, {"what", fault.what}, {"cure", fault.cure}}; }

Json faultsJson(const std::vector<AssetFault>& faults) {
  Json json = Json::array();
  for (const AssetFault& fault : faults) json.push_back(faultJson(fault));
  return json;
}

Json diagnosisJson(const Diagnosis& diagnosis) {
  Json json = Json::array();
  for (size_t i = 0; i < diagnosis.tried.size(); ++i) {
    const Hypothesis& one = diagnosis.tried[i];
    json.push_back({{"cause", one.cause}, {"what", one.what}, {"error", one.error}, {"right", one.right}});
    json.back()["explains"] = i > 0 && i == diagnosis.best;
  }
  return json;
}

}  // namespace

std::string checkText(const CheckReport& report) {
  const BakeReport& run = report.run;
  const int n = report.file.first_set;
  std::string text = figureLine("check", "{}", run.input);
  text += figureLine("mesh", "{} vertices, {} triangles", run.vertices, run.triangles);
  if (!run.volume_note.empty()) text += figureLine("volume", "{}", run.volume_note);
  if (n >= 0)
    text += figureLine("lobe", "{}, k {:g}, b {:g}, extinction {:g}, in TEXCOORD_{} and TEXCOORD_{}", run.info.lobe,
                       double(run.info.shape.exponent), double(run.info.shape.bias), double(run.info.extinction), n, n + 1);
  if (report.figures) text += figuresText(*report.figures, report.run.info);
  if (report.comparison) text += comparisonText(*report.comparison);
  for (const AssetFault& fault : report.file.faults) text += figureLine("fault", "{}: {}", fault.cause, fault.what);
  for (const AssetFault& note : report.file.harmless) text += figureLine("note", "{}: {}", note.cause, note.what);
  double total = 0;
  for (const auto& [stage, seconds] : run.seconds) total += seconds;
  text += figureLine("total", "{:.3f} s", total);
  return text + figureLine("verdict", "{}", report.verdict ? report.verdict->cause : "sound");
}

std::string checkJson(const CheckReport& report) {
  const BakeReport& run = report.run;
  Json json = {{"schema", "cloudbake-check-1"}, {"input", run.input}, {"sound", !report.verdict}};
  if (report.verdict) json["verdict"] = faultJson(*report.verdict);
  json["settings"] = writeInfo(run.info);
  json["uv_sets"] = report.file.first_set < 0 ? Json(nullptr) : Json({report.file.first_set, report.file.first_set + 1});
  json["vertices"] = run.vertices;
  json["triangles"] = run.triangles;
  if (!run.volume_note.empty()) json["volume"] = run.volume_note;
  if (report.figures) json["figures"] = figuresJson(*report.figures);
  if (report.comparison) json["comparison"] = comparisonJson(*report.comparison);
  json["bounds"] = Json::object();
  for (const auto& [field, most] : report.bounds) json["bounds"][field->key] = most;
  json["faults"] = faultsJson(report.file.faults);
  json["harmless"] = faultsJson(report.file.harmless);
  if (report.diagnosis) json["hypotheses"] = diagnosisJson(*report.diagnosis);
  json["warnings"] = warningsJson(run.warnings);
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : run.seconds) json["seconds"][stage] = seconds;
  return reportJsonText(std::move(json));
}

}  // namespace cloudbake
