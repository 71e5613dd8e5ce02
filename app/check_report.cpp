#include "app/check_report.h"

#include <cstdio>

#include "app/curve.h"
#include "io/asset_info.h"

namespace cloudbake {

namespace {

template <typename... Values>
std::string line(const char* label, const char* pattern, Values... values) {
  char text[1024];
  std::snprintf(text, sizeof text, pattern, values...);
  return label + std::string(15 - std::string_view(label).size(), ' ') + text + "\n";
}

unsigned long long whole(uint64_t count) { return static_cast<unsigned long long>(count); }

std::string lobeLines(const LobeError& e) {
  return line("direction", "rms %.3f°, median %.3f°, p95 %.3f°, max %.2f° (left out: %llu with concentration < 0.1)", e.angle_rms_degrees,
              e.angle_median_degrees, e.angle_p95_degrees, e.angle_max_degrees, whole(e.left_out)) +
         line("density", "rms %.3f %%, bias %+.3f %% of the mean thickness", 100 * e.density_rms, 100 * e.density_bias);
}

std::string figuresText(const CheckFigures& f) {
  std::string text = line("truth", "%s, %llu vertices, %d directions", f.truth.c_str(), whole(f.vertices), kTruthDirections);
  if (!f.is_fit) text += lobeLines(f.lobe);
  text += line("transmittance", "rms %.4f, bias %+.4f of the lobe (%d lights)", f.transmittance.rms, f.transmittance.bias,
               kTransmittanceDirections);
  if (f.is_fit)
    text += line("fitted lobe", "rms of T %.4f, of the mean lobe %.4f, of a fit to exact chords %.4f", f.transmittance.rms, f.mean_rms,
                 f.best_fit_rms);
  return text;
}

std::string comparisonText(const ComparisonFigures& c) {
  return line("against", "%s: %llu vertices matched, %llu only in the asset, %llu only before", c.before.c_str(), whole(c.matched),
              whole(c.added), whole(c.lost)) +
         lobeLines(c.lobe) + line("", "largest difference of d %.3f %%", 100 * c.density_max) +
         line("transmittance", "rms %.5f, bias %+.5f between the two", c.transmittance.rms, c.transmittance.bias) +
         line("UV sets", "%s; before: %s", c.sets.c_str(), c.sets_before.c_str()) +
         line("materials", "%s; before: %s", c.materials.c_str(), c.materials_before.c_str());
}

Json lobeJson(Json json, const LobeError& e) {
  json["left_out"] = e.left_out;
  json["direction_degrees"] = {
      {"rms", e.angle_rms_degrees}, {"median", e.angle_median_degrees}, {"p95", e.angle_p95_degrees}, {"max", e.angle_max_degrees}};
  json["density"] = {{"rms", e.density_rms}, {"bias", e.density_bias}};
  return json;
}

Json figuresJson(const CheckFigures& f) {
  Json json = {{"truth", f.truth}, {"vertices", f.vertices}, {"lobe", f.is_fit ? "fit" : "mean"}};
  if (!f.is_fit) json = lobeJson(std::move(json), f.lobe);
  json["transmittance"] = {{"rms", f.transmittance.rms}, {"bias", f.transmittance.bias}};
  if (f.is_fit) json["transmittance"]["mean_lobe_rms"] = f.mean_rms, json["transmittance"]["best_fit_rms"] = f.best_fit_rms;
  return json;
}

Json comparisonJson(const ComparisonFigures& c) {
  Json json = {{"before", c.before}, {"matched", c.matched}, {"only_in_asset", c.added}, {"only_before", c.lost}};
  json = lobeJson(std::move(json), c.lobe);
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
  std::string text = line("check", "%s", run.input.c_str());
  text += line("mesh", "%llu vertices, %llu triangles", whole(run.vertices), whole(run.triangles));
  if (!run.volume.empty()) text += line("volume", "%s", run.volume.c_str());
  if (n >= 0)
    text += line("lobe", "%s, k %g, b %g, extinction %g, in TEXCOORD_%d and TEXCOORD_%d", run.info.lobe.c_str(),
                 double(run.info.shape.exponent), double(run.info.shape.bias), double(run.info.extinction), n, n + 1);
  if (report.figures) text += figuresText(*report.figures);
  if (report.comparison) text += comparisonText(*report.comparison);
  for (const AssetFault& fault : report.file.faults) text += line("fault", "%s: %s", fault.cause.c_str(), fault.what.c_str());
  for (const AssetFault& note : report.file.harmless) text += line("note", "%s: %s", note.cause.c_str(), note.what.c_str());
  double total = 0;
  for (const auto& [stage, seconds] : run.seconds) total += seconds;
  text += line("total", "%.3f s", total);
  return text + line("verdict", "%s", report.verdict ? report.verdict->cause.c_str() : "sound");
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
  json["warnings"] = Json::array();
  for (const auto& [kind, entry] : run.warnings.entries())
    json["warnings"].push_back({{"kind", std::string(warningName(kind))}, {"count", entry.count}, {"first", entry.first}});
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : run.seconds) json["seconds"][stage] = seconds;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace cloudbake
