#include "app/check_report.h"

#include "app/curve.h"
#include "app/figure_lines.h"
#include "io/report.h"

namespace cloudbake {

namespace {

std::string figuresText(const CheckFigures& f) {
  std::string text = figureLine("truth", "%s, %llu vertices, %d directions", f.truth.c_str(), wholeNumber(f.vertices), kTruthDirections);
  if (!f.is_fit) text += lobeErrorLines(f.lobe);
  text += figureLine("transmittance", "rms %.4f, bias %+.4f of the lobe (%d lights)", f.transmittance.rms, f.transmittance.bias,
                     kTransmittanceDirections);
  if (f.is_fit)
    text += figureLine("fitted lobe", "rms of T %.4f, of the mean lobe %.4f, of a fit to exact chords %.4f", f.transmittance.rms,
                       f.mean_rms, f.best_fit_rms);
  return text;
}

std::string comparisonText(const ComparisonFigures& c) {
  return figureLine("against", "%s: %llu vertices matched, %llu only in the asset, %llu only before", c.before.c_str(),
                    wholeNumber(c.matched), wholeNumber(c.added), wholeNumber(c.lost)) +
         lobeErrorLines(c.lobe) + figureLine("", "largest difference of d %.3f %%", 100 * c.density_max) +
         figureLine("transmittance", "rms %.5f, bias %+.5f between the two", c.transmittance.rms, c.transmittance.bias) +
         figureLine("UV sets", "%s; before: %s", c.sets.c_str(), c.sets_before.c_str()) +
         figureLine("materials", "%s; before: %s", c.materials.c_str(), c.materials_before.c_str());
}

Json figuresJson(const CheckFigures& f) {
  Json json = {{"truth", f.truth}, {"vertices", f.vertices}, {"lobe", f.is_fit ? "fit" : "mean"}};
  if (!f.is_fit) addLobeError(json, f.lobe);
  json["transmittance"] = {{"rms", f.transmittance.rms}, {"bias", f.transmittance.bias}};
  if (f.is_fit) json["transmittance"]["mean_lobe_rms"] = f.mean_rms, json["transmittance"]["best_fit_rms"] = f.best_fit_rms;
  return json;
}

Json comparisonJson(const ComparisonFigures& c) {
  Json json = {{"before", c.before}, {"matched", c.matched}, {"only_in_asset", c.added}, {"only_before", c.lost}};
  addLobeError(json, c.lobe);
  json["density"]["max"] = c.density_max;
  json["transmittance"] = {{"rms", c.transmittance.rms}, {"bias", c.transmittance.bias}};
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
  std::string text = figureLine("check", "%s", run.input.c_str());
  text += figureLine("mesh", "%llu vertices, %llu triangles", wholeNumber(run.vertices), wholeNumber(run.triangles));
  if (!run.volume.empty()) text += figureLine("volume", "%s", run.volume.c_str());
  if (n >= 0)
    text += figureLine("lobe", "%s, k %g, b %g, extinction %g, in TEXCOORD_%d and TEXCOORD_%d", run.info.lobe.c_str(),
                       double(run.info.shape.exponent), double(run.info.shape.bias), double(run.info.extinction), n, n + 1);
  if (report.figures) text += figuresText(*report.figures);
  if (report.comparison) text += comparisonText(*report.comparison);
  for (const AssetFault& fault : report.file.faults) text += figureLine("fault", "%s: %s", fault.cause.c_str(), fault.what.c_str());
  for (const AssetFault& note : report.file.harmless) text += figureLine("note", "%s: %s", note.cause.c_str(), note.what.c_str());
  double total = 0;
  for (const auto& [stage, seconds] : run.seconds) total += seconds;
  text += figureLine("total", "%.3f s", total);
  return text + figureLine("verdict", "%s", report.verdict ? report.verdict->cause.c_str() : "sound");
}

std::string checkJson(const CheckReport& report) {
  const BakeReport& run = report.run;
  Json json = {{"schema", "cloudbake-check-1"}, {"input", run.input}, {"sound", !report.verdict}};
  if (report.verdict) json["verdict"] = faultJson(*report.verdict);
  json["settings"] = writeInfo(run.info);
  json["uv_sets"] = report.file.first_set < 0 ? Json(nullptr) : Json({report.file.first_set, report.file.first_set + 1});
  json["vertices"] = run.vertices;
  json["triangles"] = run.triangles;
  if (!run.volume.empty()) json["volume"] = run.volume;
  if (report.figures) json["figures"] = figuresJson(*report.figures);
  if (report.comparison) json["comparison"] = comparisonJson(*report.comparison);
  json["bounds"] = Json::object();
  for (const auto& [name, bound] : report.bounds) json["bounds"][name] = bound;
  json["faults"] = faultsJson(report.file.faults);
  json["harmless"] = faultsJson(report.file.harmless);
  if (report.diagnosis) json["hypotheses"] = diagnosisJson(*report.diagnosis);
  json["warnings"] = warningsJson(run.warnings);
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : run.seconds) json["seconds"][stage] = seconds;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace cloudbake
