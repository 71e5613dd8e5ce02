// This file defines the keys of asset.extras.cloudbake (docs/asset_format.md) and of a report's "settings" (io/report/report.h).
#include "io/gltf/asset_info.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/harmonics.h"
#include "core/sequence.h"
#include "core/text/numbers.h"
#include "io/gltf/value_types.h"

namespace cloudbake {

namespace {

constexpr const char* kPlace = "asset.extras.cloudbake";
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
  Json json = {{"mesh", seal.mesh}, {"constants", seal.constants}, {"size", shortest(seal.size)}};
  json["moments"] = shortestAll(seal.moments);
  json["lobes"] = shortestAll(seal.lobes);
  if (seal.harmonics) json["harmonics"] = shortestAll(*seal.harmonics);
  return json;
}

AssetSeal readSeal(const Json& json) {
  AssetSeal seal;
  seal.mesh = json.at("mesh"), seal.constants = json.at("constants");
  seal.size = json.at("size").get<float>();
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
  if (info.density_max > 0) json["density_max"] = shortest(info.density_max);
  if (const auto& certificate = info.certificate)
    json["certificate"] = {{"transmittance", shortest(certificate->transmittance)},
                           {"extinction", {shortest(certificate->extinction_low), shortest(certificate->extinction_high)}}};
  if (info.seal) json["seal"] = writeSeal(*info.seal);
  return json;
}

namespace {

[[noreturn]] void refuse(const std::string& what) { throw InputError("", std::string(kPlace) + what + "; bake the asset again"); }

// The object of the metadata, with values of known types by key. A value that is missing is the fallback.
struct Record {
  const Json& json;

  template <class Is>
  const Json* find(const char* key, Is is, const char* wanted) const {
    const auto found = json.find(key);
    if (found == json.end()) return nullptr;
    if (!is(*found)) refuse(std::string(".") + key + " is " + valueText(*found) + ", not " + wanted);
    return &*found;
  }
  float number(const char* key, float fallback) const {
    const Json* found = find(
        key, [](const Json& value) { return value.is_number(); }, "a number");
    return found ? found->get<float>() : fallback;
  }
  float numberWithin(const char* key, float fallback, float low, float high, const char* wanted) const {
    const Json* found = find(
        key, [&](const Json& value) { return value.is_number() && value.get<float>() >= low && value.get<float>() <= high; }, wanted);
    return found ? found->get<float>() : fallback;
  }
  // A count of things.
  int whole(const char* key, int64_t most = std::numeric_limits<int>::max()) const {
    const Json* found = find(
        key, [](const Json& value) { return value.is_number_integer(); }, "a whole number");
    return found ? int(std::clamp<int64_t>(wholeNumber(*found), 0, most)) : 0;
  }
  std::string text(const char* key, const std::string& fallback = "") const {
    const Json* found = find(
        key, [](const Json& value) { return value.is_string(); }, "a text");
    return found ? found->get<std::string>() : fallback;
  }
  bool flag(const char* key) const {
    const Json* found = find(
        key, [](const Json& value) { return value.is_boolean(); }, "true or false");
    return found && found->get<bool>();
  }
  std::optional<std::array<float, 2>> range(const char* key) const {
    const auto is_range = [](const Json& value) {
      return value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
    };
    const Json* found = find(key, is_range, "a list of 2 numbers");
    if (!found) return std::nullopt;
    return std::array{(*found)[0].get<float>(), (*found)[1].get<float>()};
  }
};

// The metadata, right or wrong; null if there is none.
const Json* findRecord(const Json& document) {
  const Json* found = &document;
  for (const char* key : {"asset", "extras", "cloudbake"}) {
    if (!found->is_object() || !found->contains(key)) return nullptr;
    found = &(*found)[key];
  }
  return found;
}

// The metadata's object; throws if there is none.
const Json& recordOf(const Json& document) {
  const Json* found = findRecord(document);
  if (!found) throw InputError("", std::string("not a baked asset: it has no ") + kPlace + "; run `cloudbake bake` first");
  if (!found->is_object()) refuse(" is " + valueText(*found) + ", not an object");
  return *found;
}

// The first of the two UV sets.
int firstSet(const Json& json) {
  const auto sets = json.find("uv_sets");
  const bool are_two = sets != json.end() && sets->is_array() && sets->size() == 2 && (*sets)[0].is_number_integer() &&
                       wholeNumber((*sets)[0]) >= 0 && wholeNumber((*sets)[0]) <= 6 && (*sets)[1] == wholeNumber((*sets)[0]) + 1;
  if (!are_two) refuse(".uv_sets does not have two neighbouring UV sets from 0 to 7");
  return int(wholeNumber((*sets)[0]));
}

std::optional<PackingCertificate> readCertificate(const Record& record) {
  const Json* found = record.find(
      "certificate", [](const Json& value) { return value.is_object(); }, "an object");
  if (!found) return std::nullopt;
  const Record certificate{*found};
  const auto extinction = certificate.range("extinction");
  if (!extinction) refuse(".certificate has no range of extinction");
  return PackingCertificate{certificate.number("transmittance", 1), (*extinction)[0], (*extinction)[1]};
}

AssetInfo parseInfo(const Json& json) {
  const Record record{json};
  AssetInfo info;
  info.layout = record.text("layout");
  info.version = record.whole("version");
  const bool is_packed = info.layout == kPackedLayoutName;
  if ((info.layout != kLayoutName && !is_packed) || info.version != kLayoutVersion)
    refuse(" is of layout '" + info.layout + "' " + std::to_string(info.version) + ", and this program reads '" + kLayoutName + "' " +
           std::to_string(kLayoutVersion) + " and '" + kPackedLayoutName + "' " + std::to_string(kLayoutVersion));
  info.first_uv_set = firstSet(json);
  info.lobe = record.text("lobe", info.lobe);
  info.shape = {record.number("exponent", 3), record.number("bias", 0)};
  info.extinction = record.number("extinction", 0);
  if (const auto range = record.range("extinction_range")) info.extinction_low = (*range)[0], info.extinction_high = (*range)[1];
  if (const auto elevation = record.range("sun_elevation")) {
    const auto azimuth = record.range("sun_azimuth");
    if (!azimuth) refuse(".sun_azimuth is missing beside sun_elevation");
    info.sun_arc = SunArc{(*elevation)[0], (*elevation)[1], (*azimuth)[0], (*azimuth)[1]};
  }
  if (record.text("fit_to") == "volume") {
    VolumeLight& volume = info.volume.emplace();
    volume.view_extinction = record.numberWithin("view_extinction", volume.view_extinction, 0.01F, 100, "a number from 0.01 to 100");
    volume.asymmetry = record.numberWithin("phase", volume.asymmetry, -0.95F, 0.95F, "a number from -0.95 to 0.95");
    OctaveSettings& octaves = volume.octaves;
    octaves.count = record.whole("octaves", kMostLightOctaves);
    octaves.extinction = record.numberWithin("octave_extinction", octaves.extinction, 0, 1, "a number from 0 to 1");
    octaves.contribution = record.numberWithin("octave_contribution", octaves.contribution, 0, 1, "a number from 0 to 1");
  }
  info.method = record.text("method");
  info.field = record.text("field");
  info.sampler = record.text("sampler");
  info.quadrature = record.text("quadrature");
  info.rays = record.whole("rays");
  info.steps = record.whole("steps");
  info.smooth = record.whole("smooth");
  info.separate = record.flag("separate");
  info.wrapped = record.text("close") == "wrap";
  info.harmonic_order = record.whole("harmonic_order", kMaxHarmonicOrder);
  info.level = record.whole("level", int64_t(kMostLevels));
  info.switch_pixels = record.whole("switch_pixels");
  info.ray_length = record.number("ray_length", 0);
  info.voxel_size = record.number("voxel_size", 0);
  const Json* seed = record.find(
      "seed", [](const Json& value) { return value.is_number_integer(); }, "a whole number");
  info.seed = seed ? uint64_t(wholeNumber(*seed)) : 0;
  info.input_hash = record.text("input_hash");
  if (is_packed) {
    info.density_max = record.number("density_max", 0);
    if (!(info.density_max > 0)) refuse(".density_max is not above 0, and packed lobes need it");
    info.certificate = readCertificate(record);
  }
  if (const Json* seal = record.find(
          "seal", [](const Json& value) { return value.is_object(); }, "an object"))
    try {
      info.seal = readSeal(*seal);
    } catch (const Json::exception&) {
      refuse(".seal lacks a key or has a value of the wrong type");
    }
  return info;
}

// Shaders, pages and reports get these numbers; JSON has numbers that 32 bits do not hold.
void refuseInfinite(const Json& value, const std::string& name) {
  if (value.is_array() || value.is_object()) {
    for (const auto& [key, inner] : value.items()) refuseInfinite(inner, name + (value.is_array() ? "[" + key + "]" : "." + key));
  } else if (value.is_number() && !std::isfinite(value.get<float>())) {
    refuse(name + " is " + valueText(value) + ", which is too large for 32 bits");
  }
}

}  // namespace

bool isOfLayout(const Json& document, const char* layout) {
  const Json* record = findRecord(document);
  return record && record->is_object() && record->contains("layout") && (*record)["layout"] == layout;
}

bool isSequenceDocument(const Json& document) { return isOfLayout(document, kSequenceLayout); }

AssetInfo requireInfo(const std::filesystem::path& file, const Json& document) {
  if (isImpostorDocument(document))
    throw InputError(file.string(), "is an impostor, which is pictures and no mesh: give the baked asset that it was made of");
  if (isSequenceDocument(document))
    throw InputError(file.string(),
                     "is a sequence, which preview, view and check take: give one of its keys (cloudbake sequence --as keys)");
  try {
    const Json& record = recordOf(document);
    AssetInfo info = parseInfo(record);
    refuseInfinite(record, "");
    return info;
  } catch (const InputError& error) {
    throw InputError(file.string(), error.message);
  }
}

bool hasInfo(const Json& document) { return findRecord(document) != nullptr; }

std::string infoFault(const std::filesystem::path& file, const Json& document) {
  try {
    requireInfo(file, document);
  } catch (const InputError& error) {
    return error.message;
  }
  return "";
}

std::optional<AssetInfo> readInfo(const Json& document) {
  try {
    return parseInfo(recordOf(document));
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace cloudbake
