// This file defines the keys of "cloudbake-report-1" and their order. "settings" is the same object that the asset records.
#include "io/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/markup.h"
#include "io/report/figures.h"

namespace cloudbake {

namespace {

void dropUndefined(Json& json) {
  for (auto at = json.begin(); at != json.end();) {
    if (at->is_structured()) dropUndefined(*at);
    if (json.is_object() && at->is_number_float() && !std::isfinite(at->get<double>()))
      at = json.erase(at);
    else
      ++at;
  }
}

double totalSeconds(const BakeReport& report) {
  double total = 0;
  for (const auto& [stage, seconds] : report.seconds) total += seconds;
  return total;
}

void appendLine(std::string& text, const std::string& label, const std::string& value) {
  text += label + std::string(label.size() < 12 ? 12 - label.size() : 1, ' ') + value + "\n";
}

std::string timesOf(uint64_t count) { return count > 1 ? fmt::format(" ({} in all)", count) : ""; }

constexpr size_t kRadiusBins = 8;

// Bins of equal width from the smallest to the largest radius.
std::array<uint64_t, kRadiusBins> radiusHistogram(const std::vector<float>& radii, float low, float high) {
  std::array<uint64_t, kRadiusBins> bins{};
  for (const float radius : radii)
    ++bins[high > low ? std::min(kRadiusBins - 1, size_t(float(kRadiusBins) * (radius - low) / (high - low))) : 0];
  return bins;
}

Json growthJson(const GrowthSummary& g) {
  Json json = {{"points", g.points}, {"leaves", g.leaves},         {"without_radius", g.without_radius},
               {"hidden", g.hidden}, {"over_count", g.over_count}, {"spheres", g.radii.size()},
               {"parts", g.parts},   {"connected", g.connected}};
  json["generations"] = Json::array();
  for (const auto& counts : g.generations) {
    Json symbols = Json::object();
    for (const auto& [symbol, count] : counts) symbols[std::string(1, symbol)] = count;
    json["generations"].push_back(std::move(symbols));
  }
  json["expansion"] = g.expansion;
  json["radii"] = g.radii;
  return json;
}

void appendGenerations(std::string& text, const GrowthSummary& g) {
  for (size_t n = 0; n < g.generations.size(); ++n) {
    uint64_t total = 0;
    std::string symbols;
    for (const auto& [symbol, count] : g.generations[n]) {
      total += count;
      symbols += fmt::format("  {} ", symbol) + std::to_string(count);
    }
    appendLine(text, n == 0 ? "premise" : "generation " + std::to_string(n), fmt::format("{:8} symbols:", total) + symbols);
  }
}

void appendRadii(std::string& text, const std::vector<float>& radii) {
  if (radii.empty()) return;
  const auto [low, high] = std::minmax_element(radii.begin(), radii.end());
  const auto bins = radiusHistogram(radii, *low, *high);
  const uint64_t most = *std::max_element(bins.begin(), bins.end());
  for (size_t bin = 0; bin < kRadiusBins; ++bin) {
    const double width = double(*high - *low) / kRadiusBins, from = double(*low) + width * double(bin);
    if (bin > 0 && *low == *high) break;
    appendLine(text, bin == 0 ? "radii" : "",
               fmt::format("{:8.3g} … {:<8.3g} {:6}  ", from, from + width, bins[bin]) + std::string(size_t(40 * bins[bin] / most), '#'));
  }
}

void appendGrowth(std::string& text, const GrowthSummary& g) {
  appendGenerations(text, g);
  if (!g.generations.empty()) {
    appendLine(text, "expansion", g.expansion);
    appendLine(text, "points", fmt::format("{} of the turtle, {} leaves", g.points, g.leaves));
    appendLine(text, "dropped",
               fmt::format("{} without a radius, {} hidden in others, {} over the count", g.without_radius, g.hidden, g.over_count));
    appendLine(text, "spheres",
               fmt::format("{} in {} part{}", g.radii.size(), g.parts, g.parts == 1 ? "" : "s") + (g.connected ? ", pulled together" : ""));
  }
  appendRadii(text, g.radii);
}

std::string switchText(int pixels) { return pixels > 0 ? std::to_string(pixels) + " px" : "never"; }

void appendLevels(std::string& text, const std::vector<LevelFigures>& levels) {
  if (!levels.empty())
    appendLine(text, "levels",
               "  vertices  triangles  distance rms   largest   rms of T  drawn up to   (distances in % of the longest side)");
  for (size_t i = 0; i < levels.size(); ++i) {
    const LevelFigures& l = levels[i];
    appendLine(text, fmt::format("lod {}", i + 1),
               fmt::format("{:10} {:10} {:13.4f} {:9.4f} {:10.4f} {:>12}   {}", l.vertices, l.triangles, 100 * l.distance.rms,
                           100 * l.distance.largest, l.transmittance_rms, switchText(l.switch_pixels), l.file));
  }
}

Json levelsJson(const std::vector<LevelFigures>& levels) {
  Json json = Json::array();
  for (const LevelFigures& l : levels)
    json.push_back({{"output", l.file},
                    {"vertices", l.vertices},
                    {"triangles", l.triangles},
                    {"surface_error", {{"rms", l.distance.rms}, {"largest", l.distance.largest}}},
                    {"transmittance_rms", l.transmittance_rms},
                    {"switch_pixels", l.switch_pixels}});
  return json;
}

void appendBake(std::string& text, const BakeReport& report) {
  const AssetInfo& info = report.info;
  appendLine(text, "mesh", fmt::format("{} vertices, {} triangles", report.vertices, report.triangles));
  if (!report.frame_note.empty()) appendLine(text, "frame", report.frame_note);
  if (const auto& r = report.repair)
    appendLine(
        text, "repair",
        fmt::format("{} triangles turned, {} holes filled with {} triangles", r->turned_triangles, r->filled_holes, r->added_triangles));
  if (!report.volume_note.empty()) appendLine(text, "volume", report.volume_note);
  if (const auto& e = report.surface_error)
    appendLine(text, "surface",
               fmt::format("rms {:.3g} %, largest {:.3g} % of the longest side from the sculpt", 100 * e->rms, 100 * e->largest));
  if (const auto& r = report.refine)
    appendLine(text, "refine",
               fmt::format("{} vertices became {}, rms of T that blending adds {:.4f}, before {:.4f}", r->vertices_before,
                           r->vertices_after, r->blending_after, r->blending_before));
  appendLine(
      text, "lobe",
      info.lobe +
          fmt::format(", k {:g}, b {:g}, extinction {:g}", double(info.shape.exponent), double(info.shape.bias), double(info.extinction)) +
          (info.smooth > 0 ? fmt::format(", smoothed {} times", info.smooth) : ""));
  appendLine(text, "method",
             info.method + (info.field.empty() ? "" : ", " + info.field) + (info.sampler.empty() ? "" : ", " + info.sampler) +
                 (info.quadrature.empty() ? "" : ", " + info.quadrature) +
                 fmt::format(", {} {}", info.rays, info.steps > 0 ? "rays" : "directions") +
                 (info.steps > 0 ? fmt::format(" of {} steps", info.steps) : ""));
  for (const auto& [extinction, mean_rms, fitted_rms] : report.fit)
    appendLine(
        text, "fit",
        fmt::format("extinction {:.4g}: rms of {} {:.4f}, of the mean lobe {:.4f}", extinction, judgedLight(info), fitted_rms, mean_rms));
  if (const auto& t = report.target)
    appendLine(text, "target",
               t->quantity + fmt::format(" {:.4g}: measured {:.4g} on {} vertices (", t->target, t->measured, t->vertices) + t->truth +
                   fmt::format("), {} voxels", t->voxels));
  if (report.undefined_directions > 0)
    appendLine(text, "undefined", fmt::format("{} vertices without a direction", report.undefined_directions));
  appendLevels(text, report.levels);
}

}  // namespace

std::string reportJsonText(Json json) {
  if (json.is_structured()) dropUndefined(json);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void enforceStrict(bool strict, const BakeReport& report) {
  if (!strict || report.warnings.empty()) return;
  std::string all;
  for (const auto& [kind, entry] : report.warnings.entries())
    all += (all.empty() ? "" : "; ") + std::string(warningName(kind)) + ": " + entry.first + timesOf(entry.count);
  throw InputError(report.input, "--strict refuses " + all);
}

std::string warningLines(const BakeReport& report) {
  std::string lines;
  for (const auto& [kind, entry] : report.warnings.entries())
    lines += fmt::format("cloudbake: {}: warning: {}: {}{}\n", onOneLine(report.input), warningName(kind), onOneLine(entry.first),
                         timesOf(entry.count));
  return lines;
}

std::string findingLines(const BakeReport& report) {
  std::string lines;
  for (const auto& [kind, entry] : report.findings.entries())
    appendLine(lines, "found", fmt::format("{}: {}{}", warningName(kind), entry.first, timesOf(entry.count)));
  return lines;
}

Json warningsJson(const Warnings& warnings) {
  Json json = Json::array();
  for (const auto& [kind, entry] : warnings.entries())
    json.push_back({{"kind", std::string(warningName(kind))}, {"count", entry.count}, {"first", entry.first}});
  return json;
}

std::string reportJson(const BakeReport& report) {
  Json json = {{"schema", "cloudbake-report-1"}, {"command", report.command}, {"input", report.input}, {"output", report.output}};
  json["settings"] = writeInfo(report.info);
  json["vertices"] = report.vertices;
  json["triangles"] = report.triangles;
  json["undefined_directions"] = report.undefined_directions;
  if (!report.fit.empty()) json["fit"] = Json::array();
  for (const auto& [extinction, mean_rms, fitted_rms] : report.fit)
    json["fit"].push_back({{"extinction", extinction}, {"mean_rms", mean_rms}, {"fitted_rms", fitted_rms}});
  if (const auto& t = report.target)
    json["target"] = {{"quantity", t->quantity}, {"target", t->target},     {"measured", t->measured},
                      {"truth", t->truth},       {"vertices", t->vertices}, {"voxels", t->voxels}};
  if (const auto& e = report.surface_error) json["surface_error"] = {{"rms", e->rms}, {"largest", e->largest}};
  if (!report.frame_note.empty()) json["frame"] = report.frame_note;
  if (const auto& r = report.repair)
    json["repair"] = {
        {"turned_triangles", r->turned_triangles}, {"filled_holes", r->filled_holes}, {"added_triangles", r->added_triangles}};
  if (const auto& r = report.refine)
    json["refine"] = {{"vertices_before", r->vertices_before},
                      {"vertices_after", r->vertices_after},
                      {"blending_before", r->blending_before},
                      {"blending_after", r->blending_after}};
  if (!report.volume_note.empty()) json["volume"] = report.volume_note;
  if (!report.levels.empty()) json["levels"] = levelsJson(report.levels);
  if (report.growth) json["growth"] = growthJson(*report.growth);
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : report.seconds) json["seconds"][stage] = seconds;
  json["seconds"]["total"] = totalSeconds(report);
  json["warnings"] = warningsJson(report.warnings);
  if (!report.findings.empty()) json["findings"] = warningsJson(report.findings);
  return reportJsonText(std::move(json));
}

std::string reportText(const BakeReport& report) {
  std::string text;
  appendLine(text, report.command, report.input + (report.output.empty() ? "" : " -> " + report.output));
  if (report.growth) appendGrowth(text, *report.growth);
  if (report.vertices > 0) appendBake(text, report);
  for (const auto& [stage, seconds] : report.seconds) appendLine(text, stage, fmt::format("{:8.3f} s", seconds));
  appendLine(text, "total", fmt::format("{:8.3f} s", totalSeconds(report)));
  return text;
}

std::string errorJson(const Error& error) {
  return reportJsonText({{"schema", "cloudbake-error-1"},
                         {"code", int(error.code)},
                         {"file", error.file},
                         {"line", error.line},
                         {"column", error.column},
                         {"message", error.message}});
}

}  // namespace cloudbake
