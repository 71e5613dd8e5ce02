#include "io/report/figures.h"

#include <cmath>

#include "core/text/markup.h"

namespace cloudbake {

namespace {

using F = BakeFigures;

constexpr FigureField kFields[] = {
    {"direction_rms_degrees", "direction", "rms", "°", 1, false, true, [](F& f) -> double& { return f.lobe.angle_rms_degrees; }},
    {"direction_median_degrees", "direction", "median", "°", 1, false, true, [](F& f) -> double& { return f.lobe.angle_median_degrees; }},
    {"direction_p95_degrees", "direction", "p95", "°", 1, false, true, [](F& f) -> double& { return f.lobe.angle_p95_degrees; }},
    {"direction_max_degrees", "direction", "max", "°", 1, false, true, [](F& f) -> double& { return f.lobe.angle_max_degrees; }},
    {"density_rms", "density", "rms", "%", 100, false, true, [](F& f) -> double& { return f.lobe.density_rms; }},
    {"density_bias", "density", "bias", "%", 100, true, true, [](F& f) -> double& { return f.lobe.density_bias; }},
    {"transmittance_rms", "transmittance", "rms", "%", 100, false, false, [](F& f) -> double& { return f.transmittance.rms; }},
    {"transmittance_bias", "transmittance", "bias", "%", 100, true, false, [](F& f) -> double& { return f.transmittance.bias; }},
};

}  // namespace

std::span<const FigureField> figureFields() { return kFields; }

const FigureField& figureField(std::string_view key) {
  return *std::find_if(std::begin(kFields), std::end(kFields), [&](const FigureField& field) { return field.key == key; });
}

std::string figureName(const FigureField& field) { return fmt::format("{} {}", field.subject, field.what); }

std::string figureText(const FigureField& field, double value) {
  return std::isfinite(value) ? numberText(field.scale * value, std::chars_format::general, 3) + field.unit : "undefined";
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
