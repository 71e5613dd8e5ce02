// The keys of "cloudbake-report-1" are those written here, in this order; "settings" is what the asset itself records.
#include "io/report.h"

#include <cstdio>

#include "io/asset_info.h"

namespace cloudbake {

namespace {

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

double totalSeconds(const BakeReport& report) {
  double total = 0;
  for (const auto& [stage, seconds] : report.seconds) total += seconds;
  return total;
}

void appendLine(std::string& text, const std::string& label, const std::string& value) {
  text += label + std::string(label.size() < 12 ? 12 - label.size() : 1, ' ') + value + "\n";
}

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, pattern, values...);
  return line;
}

}  // namespace

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
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : report.seconds) json["seconds"][stage] = seconds;
  json["seconds"]["total"] = totalSeconds(report);
  json["warnings"] = Json::array();
  for (const auto& [kind, entry] : report.warnings.entries())
    json["warnings"].push_back({{"kind", std::string(warningName(kind))}, {"count", entry.count}, {"first", entry.first}});
  return dump(json);
}

std::string reportText(const BakeReport& report) {
  std::string text;
  const AssetInfo& info = report.info;
  appendLine(text, report.command, report.input + (report.output.empty() ? "" : " -> " + report.output));
  appendLine(text, "mesh",
             format("%llu vertices, %llu triangles", static_cast<unsigned long long>(report.vertices),
                    static_cast<unsigned long long>(report.triangles)));
  appendLine(
      text, "lobe",
      info.lobe + format(", k %g, b %g, extinction %g", double(info.shape.exponent), double(info.shape.bias), double(info.extinction)));
  appendLine(text, "method",
             info.method + (info.field.empty() ? "" : ", " + info.field) + (info.sampler.empty() ? "" : ", " + info.sampler) +
                 (info.quadrature.empty() ? "" : ", " + info.quadrature) +
                 format(info.steps > 0 ? ", %d rays" : ", %d directions", info.rays) +
                 (info.steps > 0 ? format(" of %d steps", info.steps) : ""));
  for (const auto& [extinction, mean_rms, fitted_rms] : report.fit)
    appendLine(text, "fit", format("extinction %.4g: rms of T %.4f, of the mean lobe %.4f", extinction, fitted_rms, mean_rms));
  if (const auto& t = report.target)
    appendLine(text, "target",
               t->quantity +
                   format(" %.4g: measured %.4g on %llu vertices (", t->target, t->measured, static_cast<unsigned long long>(t->vertices)) +
                   t->truth + format("), %d voxels", t->voxels));
  if (report.undefined_directions > 0)
    appendLine(text, "undefined",
               format("%llu vertices without a direction", static_cast<unsigned long long>(report.undefined_directions)));
  for (const auto& [stage, seconds] : report.seconds) appendLine(text, stage, format("%8.3f s", seconds));
  appendLine(text, "total", format("%8.3f s", totalSeconds(report)));
  return text;
}

std::string errorJson(const Error& error) {
  return dump({{"schema", "cloudbake-error-1"},
               {"code", int(error.code)},
               {"file", error.file},
               {"line", error.line},
               {"column", error.column},
               {"message", error.message}});
}

}  // namespace cloudbake
