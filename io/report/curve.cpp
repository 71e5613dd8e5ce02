// One table of columns is used for all three formats. Its keys are the header of the CSV and the keys of "cloudbake-curve-1".
#include "io/report/curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/json.h"
#include "core/text/maker.h"
#include "core/text/utf8.h"
#include "io/report/plot.h"

namespace cloudbake {

namespace {

Json text(const std::string& s) { return s.empty() ? Json() : Json(s); }
Json whole(int n) { return n == 0 ? Json() : Json(n); }
Json real(double x) { return std::isfinite(x) ? Json(x) : Json(); }

struct Column {
  const char *key, *heading;
  Json (*value)(const CurveRow&);
  int decimals = 0;  // for Markdown, like the next two members
  double scale = 1;
  bool left = false;
};

constexpr Column kColumns[] = {
    {"method", "method", [](const CurveRow& r) { return text(r.method); }, 0, 1, true},
    {"sampler", "sampler", [](const CurveRow& r) { return text(r.sampler); }, 0, 1, true},
    {"quadrature", "quadrature", [](const CurveRow& r) { return text(r.quadrature); }, 0, 1, true},
    {"field", "field", [](const CurveRow& r) { return text(r.field); }, 0, 1, true},
    {"directions", "N", [](const CurveRow& r) { return whole(r.directions); }},
    {"steps", "S", [](const CurveRow& r) { return whole(r.steps); }},
    {"voxels", "voxels", [](const CurveRow& r) { return whole(r.voxels); }},
    {"seconds_field", "field, ms", [](const CurveRow& r) { return real(r.seconds_field); }, 1, 1000},
    {"seconds_bake", "bake, ms", [](const CurveRow& r) { return real(r.seconds_bake); }, 1, 1000},
    {"direction_rms_degrees", "rms °", [](const CurveRow& r) { return real(r.figures.lobe.angle_rms_degrees); }, 2, 1},
    {"direction_median_degrees", "median °", [](const CurveRow& r) { return real(r.figures.lobe.angle_median_degrees); }, 2, 1},
    {"direction_p95_degrees", "p95 °", [](const CurveRow& r) { return real(r.figures.lobe.angle_p95_degrees); }, 2, 1},
    {"direction_max_degrees", "max °", [](const CurveRow& r) { return real(r.figures.lobe.angle_max_degrees); }, 1, 1},
    {"density_rms", "density rms %", [](const CurveRow& r) { return real(r.figures.lobe.density_rms); }, 2, 100},
    {"density_bias", "density bias %", [](const CurveRow& r) { return real(r.figures.lobe.density_bias); }, 2, 100},
    {"transmittance_rms", "T rms", [](const CurveRow& r) { return real(r.figures.transmittance.rms); }, 4, 1},
    {"speedup_bake", "bake ×", [](const CurveRow& r) { return real(r.speedup_bake); }, 1, 1},
    {"speedup_with_field", "with field ×", [](const CurveRow& r) { return real(r.speedup_with_field); }, 1, 1},
    {"pareto", "front", [](const CurveRow& r) { return Json(r.pareto); }},
};

std::string csvCell(const Json& value) {
  if (value.is_null()) return {};
  if (!value.is_string()) return value.dump();
  std::string cell = value.get<std::string>();
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  for (size_t at = 0; (at = cell.find('"', at)) != std::string::npos; at += 2) cell.insert(at, 1, '"');
  return '"' + cell + '"';
}

std::string markdownCell(const Column& column, const Json& value) {
  if (value.is_null()) return "–";
  if (value.is_boolean()) return value.get<bool>() ? "*" : "";
  if (value.is_string()) {
    std::string cell = value.get<std::string>();
    for (size_t at = 0; (at = cell.find('|', at)) != std::string::npos; at += 2) cell.insert(at, 1, '\\');
    return cell;
  }
  return fmt::format("{:.{}f}", value.get<double>() * column.scale, column.decimals);
}

}  // namespace

void rankCurve(std::vector<CurveRow>& rows, const CurveRow& plain) {
  const double plain_bake = plain.seconds_bake, plain_all = plain.seconds();  // `plain` may be one of the rows
  std::vector<PlotPoint> points;
  for (CurveRow& row : rows) {
    row.speedup_bake = plain_bake / row.seconds_bake, row.speedup_with_field = plain_all / row.seconds(), row.pareto = false;
    points.push_back({row.seconds(), row.figures.lobe.angle_rms_degrees, {}});
  }
  for (const size_t i : paretoFront(points)) rows[i].pareto = true;
}

std::string curveCsv(const std::vector<CurveRow>& rows) {
  std::string csv;
  for (const Column& column : kColumns) csv += std::string(column.key) + ',';
  csv += "made_by";
  for (const CurveRow& row : rows) {
    csv += '\n';
    for (const Column& column : kColumns) csv += csvCell(column.value(row)) + ',';
    csv += kMaker;
  }
  return csv + '\n';
}

std::string curveJson(const std::vector<CurveRow>& rows) {
  Json json = {{"schema", "cloudbake-curve-1"}, {"made_by", kMaker}, {"rows", Json::array()}};
  for (const CurveRow& row : rows) {
    Json entry;
    for (const Column& column : kColumns) entry[column.key] = column.value(row);
    json["rows"].push_back(entry);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string curveMarkdown(const std::vector<CurveRow>& rows) {
  std::vector<std::vector<std::string>> columns;
  for (const Column& column : kColumns) {
    std::vector<std::string> cells{column.heading};
    for (const CurveRow& row : rows) cells.push_back(markdownCell(column, column.value(row)));
    size_t width = 3;
    for (const std::string& cell : cells) width = std::max(width, codePoints(cell));
    for (std::string& cell : cells) cell.insert(column.left ? cell.size() : 0, width - codePoints(cell), ' ');
    cells.insert(cells.begin() + 1, column.left ? std::string(width, '-') : std::string(width - 1, '-') + ":");
    columns.push_back(std::move(cells));
  }
  std::string table;
  for (size_t line = 0; line < rows.size() + 2; ++line) {
    for (const auto& cells : columns) table += "| " + cells[line] + " ";
    table += "|\n";
  }
  return table;
}

}  // namespace cloudbake
