#include "io/report/figures.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/markup.h"

namespace cloudbake {

namespace {

using F = BakeFigures;

constexpr FigureField kFields[] = {
    {"direction_rms_degrees", "direction", "rms", "°", 1, 3, false, true, [](F& f) -> double& { return f.lobe.angle_rms_degrees; }},
    {"direction_median_degrees", "direction", "median", "°", 1, 3, false, true,
     [](F& f) -> double& { return f.lobe.angle_median_degrees; }},
    {"direction_p95_degrees", "direction", "p95", "°", 1, 3, false, true, [](F& f) -> double& { return f.lobe.angle_p95_degrees; }},
    {"direction_max_degrees", "direction", "max", "°", 1, 2, false, true, [](F& f) -> double& { return f.lobe.angle_max_degrees; }},
    {"density_rms", "density", "rms", "%", 100, 3, false, true, [](F& f) -> double& { return f.lobe.density_rms; }},
    {"density_bias", "density", "bias", "%", 100, 3, true, true, [](F& f) -> double& { return f.lobe.density_bias; }},
    {"transmittance_rms", "transmittance", "rms", "%", 100, 3, false, false, [](F& f) -> double& { return f.transmittance.rms; }},
    {"transmittance_bias", "transmittance", "bias", "%", 100, 3, true, false, [](F& f) -> double& { return f.transmittance.bias; }},
    {"surface_pixel_rms", "transmittance per pixel", "rms", "%", 100, 3, false, false,
     [](F& f) -> double& { return f.surface.per_pixel.rms; }},
    {"surface_vertex_rms", "transmittance per vertex", "rms", "%", 100, 3, false, false,
     [](F& f) -> double& { return f.surface.per_vertex.rms; }},
};

// "rms 1.250°, median 1.000°, …": the figures of a mean lobe that have this subject.
std::string lineOf(const std::string& subject, const BakeFigures& figures) {
  std::string text;
  for (const FigureField& field : kFields) {
    if (field.subject != subject) continue;
    const std::string value =
        fmt::format(fmt::runtime(field.may_be_negative ? "{:+.{}f}" : "{:.{}f}"), field.scale * field.of(figures), field.decimals);
    text +=
        fmt::format("{}{} {}{}{}", text.empty() ? "" : ", ", field.what, value, std::string_view(field.unit) == "%" ? " " : "", field.unit);
  }
  return text;
}

Json jsonOf(const std::string& subject, const BakeFigures& figures) {
  Json json = Json::object();
  for (const FigureField& field : kFields)
    if (field.subject == subject) json[field.what] = field.of(figures);
  return json;
}

BakeFigures figuresOf(const LobeError& error) {
  BakeFigures figures;
  figures.lobe = error;
  return figures;
}

}  // namespace

std::span<const FigureField> figureFields() { return kFields; }

const FigureField& figureField(std::string_view key) {
  return *std::find_if(std::begin(kFields), std::end(kFields), [&](const FigureField& field) { return field.key == key; });
}

std::string figureName(const FigureField& field) { return fmt::format("{} {}", field.subject, field.what); }

std::string figureText(const FigureField& field, double value) {
  return std::isfinite(value) ? numberText(field.scale * value, std::chars_format::general, 3) + field.unit : "undefined";
}

std::string lobeErrorLines(const LobeError& error) {
  const BakeFigures figures = figuresOf(error);
  return figureLine("direction", "{} (left out: {} with concentration < 0.1)", lineOf("direction", figures), error.left_out) +
         figureLine("density", "{} of the mean thickness", lineOf("density", figures));
}

void addLobeError(Json& json, const LobeError& error) {
  const BakeFigures figures = figuresOf(error);
  json["left_out"] = error.left_out;
  json["direction_degrees"] = jsonOf("direction", figures);
  json["density"] = jsonOf("density", figures);
}

std::string surfaceErrorLine(const SurfaceLightError& error, const std::string& what) {
  if (error.points == 0) return "";
  return figureLine("surface", "rms of {} {:.4f} evaluated per vertex, {:.4f} per pixel ({} points spread by area)", what,
                    error.per_vertex.rms, error.per_pixel.rms, error.points);
}

void addSurfaceError(Json& json, const SurfaceLightError& error) {
  if (error.points == 0) return;
  const auto figures = [](const TransmittanceError& one) { return Json{{"rms", one.rms}, {"bias", one.bias}}; };
  json["surface"] = {{"points", error.points}, {"per_vertex", figures(error.per_vertex)}, {"per_pixel", figures(error.per_pixel)}};
}

std::string overBound(const BakeFigures& figures, std::span<const FigureBound> bounds, const std::string& verb) {
  for (const auto& [field, most] : bounds) {
    const double value = std::fabs(field->of(figures));
    if (value <= most || (figures.is_fit && field->of_mean_lobe)) continue;
    return fmt::format("{} {} by {} {}, over {}", field->subject, verb, figureText(*field, value), field->what, figureText(*field, most));
  }
  return "";
}

}  // namespace cloudbake
