// This file defines the keys of asset.extras.cloudbake (docs/asset_format.md) and of a report's "settings" (io/report/report.h).
#include "io/gltf/asset_info.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/harmonics.h"
#include "core/text/numbers.h"

namespace cloudbake {

namespace {

constexpr const char* kLayoutName = "lobe-uv";
constexpr int kLayoutVersion = 1;

}  // namespace

int64_t wholeNumber(const Json& value) { return value.get_ref<const Json::number_integer_t&>(); }

int64_t wholeNumber(const Json& object, const char* key, int64_t fallback) {
  const auto found = object.find(key);
  return found == object.end() ? fallback : wholeNumber(*found);
}

double shortest(float value) {
  const std::string text = shortestText(value);
  double result = value;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

namespace {

template <size_t N>
Json shortestAll(const std::array<float, N>& values) {
  Json json = Json::array();
  for (const float value : values) json.push_back(shortest(value));
  return json;
}

template <size_t N>
std::array<float, N> floatsOf(const Json& json) {
  std::array<float, N> values;
  for (size_t i = 0; i < N; ++i) values[i] = json.at(i).get<float>();
  return values;
}

Json writeSeal(const AssetSeal& seal) {
  Json json = {{"mesh", seal.mesh}, {"constants", seal.constants}, {"area", shortest(seal.area)}};
  json["moments"] = shortestAll(seal.moments);
  json["lobes"] = shortestAll(seal.lobes);
  if (seal.harmonics) json["harmonics"] = shortestAll(*seal.harmonics);
  return json;
}

AssetSeal readSeal(const Json& json) {
  AssetSeal seal;
  seal.mesh = json.at("mesh"), seal.constants = json.at("constants");
  seal.area = json.at("area").get<float>();
  seal.moments = floatsOf<3>(json.at("moments"));
  seal.lobes = floatsOf<kSketchSize>(json.at("lobes"));
  if (json.contains("harmonics")) seal.harmonics = floatsOf<kSketchSize>(json.at("harmonics"));
  return seal;
}

}  // namespace

Json writeInfo(const AssetInfo& info) {
  Json json = {
      {"layout", info.layout}, {"version", info.version}, {"uv_sets", {info.first_uv_set, info.first_uv_set + 1}}, {"lobe", info.lobe}};
  json["exponent"] = shortest(info.shape.exponent);
  json["bias"] = shortest(info.shape.bias);
  json["extinction"] = shortest(info.extinction);
  if (info.extinction_high > 0) json["extinction_range"] = {shortest(info.extinction_low), shortest(info.extinction_high)};
  if (const auto& arc = info.sun_arc) {
    json["sun_elevation"] = {shortest(arc->elevation_low_degrees), shortest(arc->elevation_high_degrees)};
    json["sun_azimuth"] = {shortest(arc->azimuth_low_degrees), shortest(arc->azimuth_high_degrees)};
  }
  if (const auto& volume = info.volume) {
    json["fit_to"] = "volume";
    json["view_extinction"] = shortest(volume->view_extinction);
    json["phase"] = shortest(volume->asymmetry);
    const OctaveSettings& octaves = volume->octaves;
    json["octaves"] = octaves.count;
    if (octaves.count > 0) {
      json["octave_extinction"] = shortest(octaves.extinction);
      json["octave_contribution"] = shortest(octaves.contribution);
    }
  }
  json["method"] = info.method;
  json["field"] = info.field;
  json["sampler"] = info.sampler;
  json["quadrature"] = info.quadrature;
  json["rays"] = info.rays;
  json["steps"] = info.steps;
  if (info.smooth > 0) json["smooth"] = info.smooth;
  if (info.separate) json["separate"] = true;
  if (info.wrapped) json["close"] = "wrap";
  if (info.level > 0) json["level"] = info.level, json["switch_pixels"] = info.switch_pixels;
  if (info.harmonic_order > 0) json["harmonic_order"] = info.harmonic_order;
  json["ray_length"] = shortest(info.ray_length);
  json["voxel_size"] = shortest(info.voxel_size);
  json["seed"] = info.seed;
  json["input_hash"] = info.input_hash;
  if (info.seal) json["seal"] = writeSeal(*info.seal);
  return json;
}

std::string infoFault(const Json& document) {
  const Json* at = &document;
  for (const char* key : {"asset", "extras", "cloudbake"}) {
    if (!at->is_object() || !at->contains(key)) return "";
    at = &(*at)[key];
  }
  if (readInfo(document)) return "";
  const auto is = [&](const char* key, const Json& value) { return at->is_object() && at->contains(key) && (*at)[key] == value; };
  if (at->is_object() && at->contains("layout") && !is("layout", kLayoutName))
    return "the layout " + (*at)["layout"].dump() + " is unknown";
  if (at->is_object() && at->contains("version") && !is("version", kLayoutVersion))
    return "version " + (*at)["version"].dump() + " of the layout is unknown: this program knows version " + std::to_string(kLayoutVersion);
  return "a key is missing or has the wrong type";
}

std::optional<AssetInfo> readInfo(const Json& document) {
  try {
    const Json& json = document.at("asset").at("extras").at("cloudbake");
    AssetInfo info;
    info.layout = json.at("layout");
    info.version = int(wholeNumber(json.at("version")));
    const Json& sets = json.at("uv_sets");
    const int64_t first_set = wholeNumber(sets.at(0));
    if (first_set < 0 || first_set > 6) return std::nullopt;
    info.first_uv_set = int(first_set);
    if (info.layout != kLayoutName || info.version != kLayoutVersion || sets.at(1) != first_set + 1) return std::nullopt;
    info.lobe = json.value("lobe", info.lobe);
    info.shape = {json.value("exponent", 3.0F), json.value("bias", 0.0F)};
    info.extinction = json.value("extinction", 0.0F);
    if (json.contains("extinction_range")) {
      info.extinction_low = json.at("extinction_range").at(0);
      info.extinction_high = json.at("extinction_range").at(1);
    }
    if (json.contains("sun_elevation"))
      info.sun_arc = SunArc{json.at("sun_elevation").at(0), json.at("sun_elevation").at(1), json.at("sun_azimuth").at(0),
                            json.at("sun_azimuth").at(1)};
    if (json.value("fit_to", "") == "volume") {
      VolumeLight& volume = info.volume.emplace();
      volume.view_extinction = json.value("view_extinction", volume.view_extinction);
      volume.asymmetry = json.value("phase", volume.asymmetry);
      OctaveSettings& octaves = volume.octaves;
      octaves.count = int(std::clamp<int64_t>(wholeNumber(json, "octaves", 0), 0, kMostLightOctaves));
      octaves.extinction = json.value("octave_extinction", octaves.extinction);
      octaves.contribution = json.value("octave_contribution", octaves.contribution);
    }
    info.method = json.value("method", "");
    info.field = json.value("field", "");
    info.sampler = json.value("sampler", "");
    info.quadrature = json.value("quadrature", "");
    info.rays = int(wholeNumber(json, "rays", 0));
    info.steps = int(wholeNumber(json, "steps", 0));
    info.smooth = int(wholeNumber(json, "smooth", 0));
    info.separate = json.value("separate", false);
    info.wrapped = json.value("close", "") == "wrap";
    info.harmonic_order = int(std::clamp<int64_t>(wholeNumber(json, "harmonic_order", 0), 0, kMaxHarmonicOrder));
    info.level = int(std::clamp<int64_t>(wholeNumber(json, "level", 0), 0, int64_t(kMostLevels)));
    info.switch_pixels = int(std::clamp<int64_t>(wholeNumber(json, "switch_pixels", 0), 0, std::numeric_limits<int>::max()));
    info.ray_length = json.value("ray_length", 0.0F);
    info.voxel_size = json.value("voxel_size", 0.0F);
    info.seed = uint64_t(wholeNumber(json, "seed", 0));
    info.input_hash = json.value("input_hash", "");
    if (json.contains("seal")) info.seal = readSeal(json.at("seal"));
    return info;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace cloudbake
