#include "pipeline/check/report.h"

#include <algorithm>
#include <cmath>
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
  if (f.harmonics)
    text +=
        figureLine("harmonics", "order {}: rms {:.4f}, of the lobe {:.4f}", f.harmonics->order, f.harmonics->rms, f.harmonics->lobe_rms);
  if (f.bake.is_fit)
    text += figureLine("fitted lobe", "rms of {} {:.4f}, of the mean lobe {:.4f}, of a fit to {} {:.4f}", judgedLight(info),
                       f.bake.transmittance.rms, f.mean_rms, info.volume ? "that light" : "exact chords", f.best_fit_rms);
  const Agreement& a = f.agreement;
  text += figureLine("new bake", "T differs by {:.4f} rms at {} vertices (at most {:.4f})", a.rms, a.vertices, a.most);
  if (f.harmonics) text += figureLine("", "T by the harmonics by {:.4f} rms", a.harmonics_rms);
  return text;
}

std::string sealText(const SealDifference& seal) {
  return figureLine("since the bake", "mesh {}, constants {}, shape {:.2g} %, lobes {}", seal.mesh ? "changed" : "the same",
                    seal.constants ? "changed" : "the same", 100 * seal.shape,
                    seal.mesh ? "not to be told" : fmt::format("{:.2g} % rms", 100 * seal.lobes));
}

std::string comparisonText(const ComparisonFigures& c) {
  return figureLine("against", "{}: {} vertices matched, {} only in the asset, {} only before", c.before, c.matched, c.added, c.lost) +
         lobeErrorLines(c.difference.lobe) + figureLine("", "largest difference of d {:.3f} %", 100 * c.density_max) +
         figureLine("transmittance", "rms {:.5f}, bias {:+.5f} between the two", c.difference.transmittance.rms,
                    c.difference.transmittance.bias) +
         (c.harmonics_rms ? figureLine("harmonics", "rms of T {:.5f} between the two", *c.harmonics_rms) : "") +
         figureLine("constants", "{}", c.constants.empty() ? "the same" : c.constants) +
         figureLine("UV sets", "{}; before: {}", c.sets, c.sets_before) +
         figureLine("materials", "{}; before: {}", c.materials, c.materials_before);
}

std::string certificateText(const CertificateFigures& c) {
  return figureLine("certificate", "|difference of T| <= {:.3g} for any light, extinction {:g} to {:g}; recorded {:.3g}; 1/255 is {:.3g}",
                    double(c.proved.transmittance), double(c.recorded.extinction_low), double(c.recorded.extinction_high),
                    double(c.recorded.transmittance), 1.0 / 255) +
         (c.largest ? figureLine("", "{:.3g} is the largest found at {} vertices, {:.0f} % of the bound", *c.largest, c.matched,
                                 100 * *c.largest / double(c.proved.transmittance))
                    : "");
}

std::string sequenceText(const SequenceFigures& figures) {
  const auto keys = std::count_if(figures.keys.begin(), figures.keys.end(), [](const KeyFigures& one) { return one.is_key; });
  const KeyFigures &key = *worstOf(figures, true), *between = worstOf(figures, false);
  const size_t segments = figures.keys.back().segment + 1;
  std::string text = figureLine("sequence", "{} keys, {} {}; since the bake: {}", keys, segments, segments == 1 ? "segment" : "segments",
                                figures.seal == SequenceFigures::Seal::kNone    ? "not known, there is no seal"
                                : figures.seal == SequenceFigures::Seal::kWhole ? "the same"
                                                                                : "changed");
  text += figureLine("new bakes", "T differs by at most {:.4f} rms at a key (frame {:g})", key.transmittance_rms, key.frame);
  if (between) text += figureLine("", "and by {:.4f} between two keys (frame {:g})", between->transmittance_rms, between->frame);
  return text + figureLine("worst key", "frame {:g} of segment {}:", key.frame, key.segment + 1);
}

Json sequenceJson(const SequenceFigures& figures) {
  Json json = {{"worst_key", worstOf(figures, true) - figures.keys.data()}, {"keys", Json::array()}};
  if (figures.seal != SequenceFigures::Seal::kNone) json["changed"] = figures.seal == SequenceFigures::Seal::kBroken;
  for (const KeyFigures& one : figures.keys)
    json["keys"].push_back({{"segment", one.segment},
                            {"frame", one.frame},
                            {"is_key", one.is_key},
                            {"transmittance_rms", one.transmittance_rms},
                            {"folded", one.folded}});
  return json;
}

Json certificateJson(const CertificateFigures& c) {
  Json json = {{"transmittance", c.proved.transmittance},
               {"recorded", c.recorded.transmittance},
               {"extinction", {c.recorded.extinction_low, c.recorded.extinction_high}}};
  if (c.largest) json["vertices_matched"] = c.matched, json["largest_difference"] = *c.largest;
  return json;
}

Json figuresJson(const CheckFigures& f) {
  Json json = {{"truth", f.bake.truth}, {"vertices", f.bake.vertices}, {"lobe", f.bake.is_fit ? "fit" : "mean"}};
  if (!f.bake.is_fit) addLobeError(json, f.bake.lobe);
  json["transmittance"] = {{"rms", f.bake.transmittance.rms}, {"bias", f.bake.transmittance.bias}};
  addSurfaceError(json, f.bake.surface);
  json["transmittance"]["mean_lobe_rms"] = f.mean_rms;
  if (f.bake.is_fit) json["transmittance"]["best_fit_rms"] = f.best_fit_rms;
  if (f.harmonics) json["harmonics"] = {{"order", f.harmonics->order}, {"rms", f.harmonics->rms}};
  const Agreement& a = f.agreement;
  json["new_bake"] = {{"vertices", a.vertices}, {"rms", a.rms}, {"noise", a.noise}, {"most", a.most}};
  if (f.harmonics) json["new_bake"]["harmonics_rms"] = a.harmonics_rms;
  return json;
}

Json comparisonJson(const ComparisonFigures& c) {
  Json json = {{"before", c.before}, {"matched", c.matched}, {"only_in_asset", c.added}, {"only_before", c.lost}};
  addLobeError(json, c.difference.lobe);
  json["density"]["max"] = c.density_max;
  json["transmittance"] = {{"rms", c.difference.transmittance.rms}, {"bias", c.difference.transmittance.bias}};
  if (c.harmonics_rms) json["harmonics_rms"] = std::isfinite(*c.harmonics_rms) ? Json(*c.harmonics_rms) : Json("only one has them");
  json["constants"] = c.constants;
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

const KeyFigures* worstOf(const SequenceFigures& figures, bool of_keys) {
  const KeyFigures* worst = nullptr;
  for (const KeyFigures& one : figures.keys)
    if (one.is_key == of_keys && (!worst || !(one.transmittance_rms <= worst->transmittance_rms))) worst = &one;
  return worst;
}

std::string checkText(const CheckReport& report) {
  const BakeReport& run = report.run;
  const int n = report.file.first_set;
  std::string text = figureLine("check", "{}", run.input);
  text += figureLine("mesh", "{} vertices, {} triangles", run.vertices, run.triangles);
  if (!run.volume_note.empty()) text += figureLine("volume", "{}", run.volume_note);
  if (n >= 0)
    text += figureLine("lobe", "{}, k {:g}, b {:g}, extinction {:g}, in TEXCOORD_{} and TEXCOORD_{}", run.info.lobe,
                       double(run.info.shape.exponent), double(run.info.shape.bias), double(run.info.extinction), n, n + 1);
  if (report.seal) text += sealText(*report.seal);
  if (report.sequence) text += sequenceText(*report.sequence);
  if (report.figures) text += figuresText(*report.figures, report.run.info);
  if (report.lattice_rms) text += figureLine("lattice", "T differs by {:.4f} rms from a new one", *report.lattice_rms);
  if (report.comparison) text += comparisonText(*report.comparison);
  if (report.certificate) text += certificateText(*report.certificate);
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
  if (report.certificate) json["certificate"] = certificateJson(*report.certificate);
  if (report.seal) {
    const SealDifference& seal = *report.seal;
    json["since_the_bake"] = {{"mesh_changed", seal.mesh}, {"constants_changed", seal.constants}, {"shape", seal.shape}};
    if (!seal.mesh) json["since_the_bake"]["lobes"] = seal.lobes, json["since_the_bake"]["harmonics"] = seal.harmonics;
  }
  if (report.sequence) json["sequence"] = sequenceJson(*report.sequence);
  if (report.figures) json["figures"] = figuresJson(*report.figures);
  if (report.lattice_rms) json["lattice_rms"] = *report.lattice_rms;
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
