#include "pipeline/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "bake/mesh/repair.h"
#include "core/error.h"
#include "core/harmonics.h"
#include "core/text/numbers.h"
#include "core/text/scan.h"
#include "core/text/utf8.h"
#include "io/volume/spheres.h"
#include "lsystem/recipe.h"

namespace cloudbake {

namespace {

std::string refusal(const Option& option, const std::string& value, const std::string& wanted) {
  return "--" + std::string(option.name) + ": '" + value + "' is not " + wanted;
}
[[noreturn]] void refuse(const Option& option, const std::string& value, const std::string& wanted) {
  throw UsageError(refusal(option, value, wanted));
}

// A usage error that has all valid values.
struct ChoiceError : UsageError {
  ChoiceError(std::string text, std::vector<std::string> all) : UsageError(std::move(text)), choices(std::move(all)) {}
  std::vector<std::string> choices;
};

template <class Number>
Number parseNumber(const Option& option, const std::string& value, Number low, Number high, const char* kind) {
  Number number{};
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  bool usable = error == std::errc() && end == value.data() + value.size() && number >= low && number <= high;
  if constexpr (std::is_floating_point_v<Number>) usable = usable && std::isfinite(number);
  if (!usable) {
    refuse(option, value, std::string(kind) + " from " + shortestText(low) + " to " + shortestText(high));
  }
  return number;
}

int parseInt(const Option& option, const std::string& value, int low, int high = std::numeric_limits<int>::max()) {
  return parseNumber<int>(option, value, low, high, "a whole number");
}
float parseFloat(const Option& option, const std::string& value, float low, float high) {
  return parseNumber<float>(option, value, low, high, "a number");
}
double parseDouble(const Option& option, const std::string& value, double low, double high) {
  return parseNumber<double>(option, value, low, high, "a number");
}
constexpr float kTiny = std::numeric_limits<float>::min(), kHuge = std::numeric_limits<float>::max();

Length parseLength(const Option& option, const std::string& value, float low, float high) {
  if (value.empty() || value.back() != '%') return {parseFloat(option, value, low, high), false};
  return {parseFloat(option, value.substr(0, value.size() - 1), low < 0 ? -1000.0F : 0.0F, 1000) / 100, true};
}

bool parseBool(const Option& option, const std::string& value) {
  if (value == "true") return true;
  if (value != "false") refuse(option, value, "true or false");
  return false;
}

template <class Value, size_t N>
Value parseChoice(const Option& option, const std::string& value, const std::array<std::pair<const char*, Value>, N>& choices) {
  std::string names;
  std::vector<std::string> all;
  for (const auto& [name, choice] : choices) {
    if (value == name) return choice;
    names += (names.empty() ? "" : ", ") + std::string(name);
    all.emplace_back(name);
  }
  throw ChoiceError(refusal(option, value, "one of " + names), all);
}

// "A,B" or "AxB".
std::pair<std::string, std::string> parsePair(const Option& option, const std::string& value, char separator) {
  const size_t at = value.find(separator);
  if (at == std::string::npos) refuse(option, value, std::string("two numbers joined by '") + separator + "'");
  return {value.substr(0, at), value.substr(at + 1)};
}

// "50%,25%" or "2000,500": all of one kind, each smaller than the one before.
void parseLevels(std::vector<LevelSize>& levels, const Option& option, const std::string& value) {
  levels.clear();
  for (size_t begin = 0; begin <= value.size();) {
    const size_t end = std::min(value.find(',', begin), value.size());
    std::string size = value.substr(begin, end - begin);
    const bool is_share = size.ends_with('%');
    if (is_share) size.pop_back();
    const double number = is_share ? parseDouble(option, size, 0, 100) / 100 : double(parseInt(option, size, 4));
    if (is_share && (number == 0 || number == 1)) refuse(option, value, "a list of sizes above 0% and below 100%");
    if (!levels.empty() && (is_share != levels.back().is_share || number >= levels.back().value))
      refuse(option, value, "a list of sizes of one kind, % or vertices, each smaller than the one before");
    levels.push_back({number, is_share});
    begin = end + 1;
  }
  if (levels.size() > kMostLevels) refuse(option, value, "a list of at most " + std::to_string(kMostLevels) + " sizes");
}

// Any of "orient,fill,remesh".
void parseRepair(MeshSettings& settings, const Option& option, const std::string& value) {
  for (size_t begin = 0; begin <= value.size();) {
    const size_t end = std::min(value.find(',', begin), value.size());
    const std::string cure = value.substr(begin, end - begin);
    bool* const asked = cure == "orient"   ? &settings.repair.orient
                        : cure == "fill"   ? &settings.repair.fill
                        : cure == "remesh" ? &settings.repair_remesh
                                           : nullptr;
    if (!asked) refuse(option, value, "a list of orient, fill, remesh, joined by commas");
    *asked = true;
    begin = end + 1;
  }
}

// "LOW:HIGH", or one number for both.
std::pair<float, float> parseRange(const Option& option, const std::string& value, float low, float high) {
  const size_t at = value.find(':');
  const float first = parseFloat(option, value.substr(0, at), low, high);
  const float second = at == std::string::npos ? first : parseFloat(option, value.substr(at + 1), low, high);
  if (second < first) refuse(option, value, "a range LOW:HIGH, the lower first");
  return {first, second};
}

SunArc parseSunArc(const Option& option, const std::string& value) {
  const auto [elevation, azimuth] = parsePair(option, value, ',');
  const auto [elevation_low, elevation_high] = parseRange(option, elevation, -90, 90);
  const auto [azimuth_low, azimuth_high] = parseRange(option, azimuth, -3600, 3600);
  return {elevation_low, elevation_high, azimuth_low, azimuth_high};
}

TargetError parseTarget(const Option& option, const std::string& value) {
  if (value.empty() || value.back() != '%') return {parseDouble(option, value, 0.05, 180), false};
  return {parseDouble(option, value.substr(0, value.size() - 1), 0.01, 100) / 100, true};
}

// A number of bytes, with K, M, G or T for powers of 1024. The program with its libraries takes some tens of megabytes by itself.
uint64_t parseBytes(const Option& option, const std::string& value) {
  const size_t unit = value.empty() ? std::string_view::npos : std::string_view("KMGT").find(value.back());
  const bool has_unit = unit != std::string_view::npos;
  const double number = parseDouble(option, has_unit ? value.substr(0, value.size() - 1) : value, 1, 1e15);
  const double bytes = has_unit ? std::ldexp(number, 10 * (int(unit) + 1)) : number;
  if (!(bytes >= 64 << 20 && bytes <= 1e15)) refuse(option, value, "a size from 64M to 900T, such as 8G");
  return uint64_t(bytes);
}

using Motion = PictureSettings::Motion;

void setMotion(Settings& settings, const Option& option, const std::string& value, Motion motion) {
  PictureSettings& view = settings.picture;
  view.frame_count = parseInt(option, value, 2, 10000);
  if (view.motion != Motion::kNone && view.motion != motion)
    throw UsageError("--turntable, --sun-sweep and --animate: give only one of them");
  view.motion = motion;
}

void parseShard(Settings& settings, const Option& option, const std::string& value) {
  const auto [first, second] = parsePair(option, value, '/');
  settings.batch.shards = parseInt(option, second, 1, 100000);
  settings.batch.shard = parseInt(option, first, 1, settings.batch.shards);
}

void parseAngles(const Option& option, const std::string& value, float& azimuth, float& elevation) {
  const auto [first, second] = parsePair(option, value, ',');
  azimuth = parseFloat(option, first, -3600, 3600);
  elevation = parseFloat(option, second, -90, 90);
}

using S = Settings;
using O = const Option&;
using V = const std::string&;

void parsePictureSize(S& settings, O option, V value) {
  const auto [width, height] = parsePair(option, value, 'x');
  settings.picture.width = parseInt(option, width, 1, 16384);
  settings.picture.height = parseInt(option, height, 1, 16384);
}

void setViewExtinction(S& settings, O option, V value) { settings.lobe.volume.view_extinction = parseFloat(option, value, 0.01F, 100); }
void setPhase(S& settings, O option, V value) { settings.lobe.volume.asymmetry = parseFloat(option, value, -0.95F, 0.95F); }
// "N" or "N,A,B".
void setOctaves(S& settings, O option, V value) {
  OctaveSettings& octaves = settings.lobe.volume.octaves.emplace();
  const size_t comma = value.find(',');
  octaves.count = parseInt(option, value.substr(0, comma), 0, kMostLightOctaves);
  if (comma == std::string::npos) return;
  const auto [extinction, contribution] = parsePair(option, value.substr(comma + 1), ',');
  octaves.extinction = parseFloat(option, extinction, 0, 1);
  octaves.contribution = parseFloat(option, contribution, 0, 1);
}

constexpr FileUse kReads{FileUse::kRead};
// `view` bakes what it watches.
constexpr unsigned kSculpts = kBake | kMeasure | kBatch | kView, kBakes = kSculpts | kGrow, kGrows = kGrow | kMeasure | kBatch,
                   kDraws = kPreview | kView, kAll = kBakes | kDraws | kCheck;

constexpr const char *kGeneral = "Options", *kRules = "Rules (as the recipe says, unless given)",
                     *kTurtle = "Turtle (as the recipe says, unless given)", *kSpheres = "Spheres (as the recipe says, unless given)",
                     *kOfBatch = "Batch", *kBounds = "Bounds";

// --- Rules: what an option excludes or needs ---

bool isSweep(const S& s) { return s.lobe.bake.method == Method::kSweep; }
bool isRays(const S& s) { return !isSweep(s); }
bool isOddSweep(const S& s) { return isSweep(s) && s.lobe.bake.rays % 2 != 0; }
bool hasTooFewForHarmonics(const S& s) {
  return s.lobe.harmonic_order > 0 && s.lobe.bake.rays < 2 * int(harmonicCount(s.lobe.harmonic_order));
}
bool hasTarget(const S& s) { return s.lobe.target_error.has_value(); }
bool isVolume(const S& s) { return s.source.kind == SourceKind::kVolume; }
bool lacksCgal(const S&) { return !hasCgal(); }
bool isPlain(const S& s) { return s.picture.plain; }
bool moves(const S& s) { return s.picture.motion != Motion::kNone; }
bool isComparison(const S& s) { return s.picture.compare; }
bool isNoComparison(const S& s) { return !s.picture.compare; }
bool isFittedToNoVolume(const S& s) { return !s.lobe.fit_to_volume; }

constexpr const char *kOfRays = " needs --method rays", *kOfComparison = " needs --compare", *kOfVolumeFit = " needs --fit-to volume",
                     *kChosen = " is chosen by --target-error: give one of the two",
                     *kOwnLattice = ": a VDB has voxels of its own: leave this out, or give --bake-voxels for the integration field",
                     *kOfCgal = " needs CGAL: this binary was built with -DCLOUDBAKE_CGAL=OFF",
                     *kOfPainted = " is an option of the painted look: leave out --look plain",
                     *kOfOnePicture = " is for a single picture: leave out this option or the motion",
                     *kOfNoSheet = " cannot be combined with --compare, which is for an asset in a still picture: leave it out";

// Sets a key of the cloud recipe, which checks its range.
void setRecipe(Settings& s, const Option& option, const std::string& value) {
  std::string key = option.name;
  std::replace(key.begin(), key.end(), '-', '_');
  CloudRecipe scratch;
  try {
    setRecipeKey(scratch, key, value);
  } catch (const InputError& error) {
    throw UsageError("--" + std::string(option.name) + ": '" + value + "': " + error.message);
  }
  s.source.recipe_keys.emplace_back(key, value);
}

const Option kOptions[] = {
    {"as-published", "", "", "the method exactly as published: uniform draws, 100 × 100, end, L = 10, k = 3, b = -0.01", kBakes, 0, kAnyInput, true,
     nullptr, kGeneral, {},
     "method=rays sampler=uniform quadrature=end rays=100 steps=100 ray-length=10 exponent=3 bias=-0.01"},
    {"method", "NAME", "sweep", "how inside lengths are measured: sweep (all vertices at once), rays", kBakes, kMeasure, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.bake.method = parseChoice<Method, 2>(o, v, {{{"sweep", Method::kSweep}, {"rays", Method::kRays}}}); }, kGeneral,
     {{{[](const S& s) { return isRays(s) && hasTarget(s); }, " rays cannot be combined with --target-error: a sweep costs less at every error"}}}},
    {"field", "NAME", "auto", "what a sweep integrates: coverage (rasterised from a closed mesh), levelset, auto (coverage if closed)", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) {
       s.field.kind = parseChoice<FieldChoice, 3>(o, v, {{{"auto", FieldChoice::kAuto}, {"coverage", FieldChoice::kCoverage}, {"levelset", FieldChoice::kLevelSet}}});
     }, kGeneral,
     {{{[](const S& s) { return isRays(s) && s.field.kind != FieldChoice::kAuto; }, " is an option of the sweep: rays march the level set"}}}},
    {"rays", "N", "100", "directions per vertex; a sweep needs an even number", kBakes, kBake | kMeasure, kAnyInput, true, [](S& s, O o, V v) { s.lobe.bake.rays = parseInt(o, v, 1, 1 << 20); }, kGeneral,
     {{{isOddSweep, ": a sweep uses both senses of an axis: give an even number, or --method rays"},
      {hasTooFewForHarmonics, ": spherical harmonics need 8 (sh1), 18 (sh2) or 32 (sh3) directions: use more --rays, or a lower --basis"},
      {hasTarget, kChosen}}}},
    {"sampler", "NAME", "stratified", "rays: how directions are chosen: stratified, fibonacci (turned at random per vertex), uniform", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) {
       s.lobe.bake.sampler = parseChoice<Sampler, 3>(o, v, {{{"stratified", Sampler::kStratified}, {"fibonacci", Sampler::kFibonacci}, {"uniform", Sampler::kUniform}}});
     }, kGeneral,
     {{{[](const S& s) { return isSweep(s) && s.lobe.bake.sampler != Sampler::kFibonacci; }, kOfRays}}}},
    {"fixed-directions", "", "", "rays with fibonacci: one set of directions for all vertices, not turned", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.bake.rotate_directions = !parseBool(o, v); }, kGeneral,
     {{{isSweep, kOfRays}}}},
    {"quadrature", "NAME", "crossing", "rays: inside length along a ray: crossing, midpoint, end (as published)", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) {
       s.lobe.bake.quadrature = parseChoice<Quadrature, 3>(o, v, {{{"crossing", Quadrature::kCrossing}, {"midpoint", Quadrature::kMidpoint}, {"end", Quadrature::kEnd}}});
     }, kGeneral,
     {{{isSweep, kOfRays}}}},
    {"steps", "S", "100", "rays: samples per ray", kBakes, 0, kAnyInput, true, [](S& s, O o, V v) { s.lobe.bake.steps = parseInt(o, v, 1, 1 << 20); }, kGeneral,
     {{{isSweep, kOfRays}}}},
    {"ray-length", "L", "diagonal", "length of a ray, world units; the default is the diagonal of the bounding box", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.bake.ray_length = parseFloat(o, v, kTiny, kHuge); }},
    {"voxels", "N", "100", "voxels of the level set along the longest side", kBakes, kGrow | kBake | kMeasure, kAnyInput & ~kFromVolume, true, [](S& s, O o, V v) { s.field.voxels = parseInt(o, v, 1); }, kGeneral,
     {{{isVolume, kOwnLattice}}}},
    {"voxel-size", "H", "", "voxel size, world units, instead of --voxels", kBakes, 0, kAnyInput & ~kFromVolume, true,
     [](S& s, O o, V v) { s.field.voxel_size = parseFloat(o, v, kTiny, kHuge); }, kGeneral,
     {{{isVolume, kOwnLattice}}}},
    {"bake-voxels", "N", "as the surface", "voxels of the integration field along the longest side; grown: no more than its directions and spheres need", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) { s.field.bake_voxels = parseInt(o, v, 1); }, kGeneral,
     {{{hasTarget, kChosen}}}},
    {"target-error", "E", "", "find directions and voxels for an rms error: degrees, or % of T", kBakes, kGrow | kBake | kMeasure, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.target_error = parseTarget(o, v); }},
    {"scene", "FILE", "", "scene file: target error 1/255, vertices for its camera, fit for its sun", kBakes & ~kView, kGrow | kBake, kAnyInput, false,
     [](S& s, O, V v) { s.scene = v; }, kGeneral, {}, "", kReads},
    {"lobe", "NAME", "mean", "mean (occlusion direction and thickness) or fit (to the transmittance)", kBakes, kGrow | kBake | kMeasure, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.fit = parseChoice<bool, 2>(o, v, {{{"mean", false}, {"fit", true}}}); }},
    {"fit-to", "NAME", "transmittance", "fit: what comes near to the truth: transmittance (at the surface) or volume (the light that a volume render shows there)", kBakes, kBake, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.fit_to_volume = parseChoice<bool, 2>(o, v, {{{"transmittance", false}, {"volume", true}}}); }, kGeneral,
     {{{[](const S& s) { return s.lobe.fit_to_volume && !s.lobe.fit; }, " volume needs --lobe fit"},
      {[](const S& s) { return s.lobe.fit_to_volume && isRays(s); }, " volume needs --method sweep"}}}},
    {"view-extinction", "X", "1", "fit to a volume: extinction along the view, as a factor of that towards the light", kBakes, 0, kAnyInput, true, setViewExtinction, kGeneral,
     {{{isFittedToNoVolume, kOfVolumeFit}}}},
    {"octaves", "N[,A,B]", "0", "fit to a volume: light that is scattered again, as N octaves; octave i has A^i of the extinction and B^i of the light, both 0.5 by default", kBakes, 0, kAnyInput, true, setOctaves, kGeneral,
     {{{isFittedToNoVolume, kOfVolumeFit}}}},
    {"phase", "G", "0", "fit to a volume: asymmetry of the scattering, -0.95 to 0.95; above 0 forwards", kBakes, 0, kAnyInput, true, setPhase, kGeneral,
     {{{isFittedToNoVolume, kOfVolumeFit}}}},
    {"exponent", "K", "3; fit: 4", "k of the lobe formula; with --lobe fit also 'fit', the best k for the asset", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) {
       s.lobe.fit_exponent = v == "fit";
       if (!s.lobe.fit_exponent) s.lobe.exponent = parseFloat(o, v, 0, 1000);
     }, kGeneral,
     {{{[](const S& s) { return s.lobe.fit_exponent && !s.lobe.fit; }, " fit needs --lobe fit"}}}},
    {"bias", "B", "-0.3%; fit: 0", "b of the lobe formula: world units, or % of the longest side; with --lobe fit also 'fit'", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) {
       s.lobe.fit_bias = v == "fit";
       if (!s.lobe.fit_bias) s.lobe.bias = parseLength(o, v, -kHuge, kHuge);
     }, kGeneral,
     {{{[](const S& s) { return s.lobe.fit_bias && !s.lobe.fit; }, " fit needs --lobe fit"}}}},
    {"extinction", "SIGMA", "7/longest side; fit: half to double", "per world unit; for a fit also LO:HI", kBakes, kBake, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.extinction_range = parseRange(o, v, kTiny, kHuge); }, kGeneral,
     {{{[](const S& s) { return !s.lobe.fit && s.lobe.extinction_range->first != s.lobe.extinction_range->second; },
       " LO:HI needs --lobe fit: a mean lobe has a single extinction"}}}},
    {"sun-arc", "EL:EL,AZ:AZ", "whole sphere", "fit: range of the sun, degrees; the zenith is always added", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.sun_arc = parseSunArc(o, v); }, kGeneral,
     {{{[](const S& s) { return !s.lobe.fit; }, " needs --lobe fit"}}}},
    {"basis", "NAME", "lobe", "also write spherical harmonics of T: lobe (none), sh1, sh2, sh3", kBakes, kMeasure, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.harmonic_order = parseChoice<int, 4>(o, v, {{{"lobe", 0}, {"sh1", 1}, {"sh2", 2}, {"sh3", 3}}}); }},
    {"lattice", "FILE", "", "also write spherical harmonics on a lattice in and around the cloud: FILE.json with 3D textures (KTX 2); needs --basis", kGrow | kBake, 0, kAnyInput, false,
     [](S& s, O o, V v) {
       s.output.lattice = v;
       if (s.output.lattice->extension() != ".json" || s.output.lattice->stem().empty()) refuse(o, v, "a name that ends in .json");
       if (!isUtf8(s.output.lattice->stem().string())) refuse(o, v, "a name in UTF-8, because the file names its textures in JSON");
     }, kGeneral,
     {{{[](const S& s) { return s.lobe.harmonic_order == 0; }, " needs --basis sh1, sh2 or sh3"}}}, "", FileUse{FileUse::kWritten, "", ".[0-9].ktx2"}},
    {"lattice-cells", "N", "16", "cells of the lattice along the longest side", kGrow | kBake, 0, kAnyInput, false, [](S& s, O o, V v) { s.lobe.lattice_cells = parseInt(o, v, 2, 128); }},
    {"smooth", "N", "0", "passes of Laplacian smoothing of the lobes over the mesh, after bake and fit", kBakes, 0, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.smooth = parseInt(o, v, 0, 1000); }, kGeneral,
     {{{[](const S& s) { return hasTarget(s) && s.lobe.smooth > 0; },
       " changes the lobes that --target-error (or --scene) measured: leave it out, or give --rays and --bake-voxels instead of a target"}}}},
    {"seed", "N", "1", "random seed of the shape and of the rays", kBakes, kGrow, kAnyInput, true,
     [](S& s, O o, V v) { s.lobe.bake.seed = parseNumber<uint64_t>(o, v, 0, std::numeric_limits<uint64_t>::max(), "a whole number"); }},
    {"vertices", "N", "", "vertex budget; without it a sculpt keeps its own mesh", kBakes, kGrow | kBake | kMeasure, kAnyInput, true,
     [](S& s, O o, V v) { s.mesh.vertices = size_t(parseInt(o, v, 4)); }},
    {"lods", "LIST", "", "also write levels of detail, OUT_lod1.glb and so on: vertices, or % of them, such as 50%,25%,10%", kGrow | kBake | kBatch, kGrow | kBake, kAnyInput, false,
     [](S& s, O o, V v) { parseLevels(s.mesh.levels, o, v); }, kGeneral,
     {{{[](const S& s) { return s.mesh.refine.has_value(); }, " and --refine change the mesh in opposite ways: give one of the two"}}}, "", FileUse{FileUse::kLevels}},
    {"remesh", "LENGTH", "", "remesh a sculpt with even triangles of this edge length: world units, or % of the longest side", kSculpts, 0, kFromSculpt, false,
     [](S& s, O o, V v) {
       s.mesh.remesh = parseLength(o, v, kTiny, kHuge);
       if (s.mesh.remesh->value == 0) refuse(o, v, "a length above 0");
     }, kGeneral,
     {{{[](const S& s) { return s.mesh.vertices.has_value(); }, " and --vertices both give a sculpt a new mesh: give one of the two"}, {lacksCgal, kOfCgal}}}},
    {"refine", "E", "", "split edges of a sculpt until blending lobes between vertices adds at most E to T (rms, 0 to 1), or auto: a tenth of the error of unblended lobes; --vertices is its budget", kSculpts, kBake, kFromSculpt, false,
     [](S& s, O o, V v) { s.mesh.refine = v == "auto" ? 0 : parseNumber<double>(o, v, 0.0001, 1, "auto or a number"); }, kGeneral,
     {{{[](const S& s) { return s.mesh.separate; }, " measures the whole sculpt: leave out --separate, or put each object in its own file"}}}},
    {"repair", "LIST", "", "repair a sculpt: any of orient, fill (holes), remesh; joined by commas", kSculpts, kBake, kFromSculpt, false,
     [](S& s, O o, V v) { parseRepair(s.mesh, o, v); }, kGeneral,
     {{{[](const S& s) { return s.mesh.repair_remesh && s.mesh.vertices; }, " remesh and --vertices both give a sculpt a new mesh: give one of the two"},
      {lacksCgal, kOfCgal}}}},
    {"close", "HOW", "auto", "how to close an open sculpt: auto, wrap (always), reject (an error)", kSculpts | kCheck, kBake | kCheck, kFromSculpt, false,
     [](S& s, O o, V v) {
       s.mesh.close = parseChoice<CloseChoice, 3>(o, v, {{{"auto", CloseChoice::kAuto}, {"wrap", CloseChoice::kWrap}, {"reject", CloseChoice::kReject}}});
     }, kGeneral,
     {{{[](const S& s) { return s.mesh.close == CloseChoice::kWrap && !hasCgal(); }, " wrap needs CGAL: this binary was built with -DCLOUDBAKE_CGAL=OFF"}}}},
    {"separate", "", "", "bake every object of a sculpt as if it were alone", kBake | kBatch | kView, 0, kFromSculpt, false, [](S& s, O o, V v) { s.mesh.separate = parseBool(o, v); }, kGeneral,
     {{{[](const S& s) { return s.mesh.separate && s.lobe.harmonic_order > 0; }, " bakes lobes only: leave out --basis, or put each object in its own file"},
      {[](const S& s) { return s.mesh.separate && hasTarget(s); }, " cannot be combined with --target-error, which measures the whole sculpt"},
      {[](const S& s) { return s.mesh.separate && s.lobe.fit; }, " bakes mean lobes: leave out --lobe fit, or put each object in its own file"}}}},
    {"inspect", "", "", "also report self-intersections and shells inside others", kSculpts & ~kView, 0, kFromSculpt, false, [](S& s, O o, V v) { s.mesh.inspect = parseBool(o, v); }, kGeneral,
     {{{lacksCgal, kOfCgal}}}},
    {"allow-outside", "", "", "let a sculpt refer to files outside its own folder", kSculpts, 0, kFromSculpt, false, [](S& s, O o, V v) { s.source.read.allow_outside = parseBool(o, v); }},
    {"scene-index", "N", "the file's default scene", "glTF: number of the scene to bake, from 0", kSculpts, 0, kFromSculpt, false, [](S& s, O o, V v) { s.source.read.scene_index = parseInt(o, v, 0); }},
    {"uv-set", "N", "lowest free", "first of the two UV sets, 0 to 6", kGrow | kBake | kBatch, 0, kAnyInput, true, [](S& s, O o, V v) { s.output.gltf.uv_set = parseInt(o, v, 0, 6); }},
    {"attribute", "", "", "also write the vertex attribute _OCCLUSION", kGrow | kBake | kBatch, 0, kAnyInput, true, [](S& s, O o, V v) { s.output.gltf.attribute = parseBool(o, v); }},
    {"keep-alive-texture", "WHEN", "auto", "bind a white texture, so that optimisers keep the UV sets: auto, force, off", kGrow | kBake | kBatch, 0, kAnyInput, true,
     [](S& s, O o, V v) {
       s.output.gltf.keep_alive_texture = parseChoice<KeepAliveTexture, 3>(o, v, {{{"auto", KeepAliveTexture::kAuto}, {"force", KeepAliveTexture::kForce}, {"off", KeepAliveTexture::kOff}}});
     }},
    {"blend", "W", "0", "width of the spheres' smooth union: world units, or % of the longest side", kGrows, kGrow, kFromRules | kFromSpheres, true,
     [](S& s, O o, V v) { s.field.blend = parseLength(o, v, 0, kHuge); }},
    {"flat-base", "Y", "", "height of a plane that cuts off the base of the cloud, world units", kGrows, 0, kFromRules | kFromSpheres, true,
     [](S& s, O o, V v) { s.field.flat_base = parseFloat(o, v, -kHuge, kHuge); }},
    {"noise", "A", "0", "height of bumps on the surface: world units, or % of the longest side", kGrows, kGrow, kFromRules | kFromSpheres, true,
     [](S& s, O o, V v) { s.field.noise = parseLength(o, v, 0, kHuge); }},
    {"noise-size", "W", "5 x noise (3 octaves)", "spacing of the largest bumps: world units, or % of the longest side", kGrows, 0, kFromRules | kFromSpheres, true,
     [](S& s, O o, V v) { s.field.noise_size = parseLength(o, v, kTiny, kHuge); }, kGeneral,
     {{{[](const S& s) { return !s.field.noise; }, " needs --noise, the height of the bumps"}}}},
    {"noise-octaves", "N", "3", "layers of bumps, each half the size and height of the one before", kGrows, 0, kFromRules | kFromSpheres, true,
     [](S& s, O o, V v) { s.field.noise_octaves = parseInt(o, v, 1, 8); }},
    {"from-spheres", "FILE", "", "points and radii from a .ply or .csv instead of a preset", kGrow | kMeasure, kGrow, kAnyInput, false, [](S& s, O, V v) { s.source.kind = SourceKind::kSpheres, s.source.input = v; }, kGeneral, {}, "", kReads},
    {"spheres", "FILE", "", "also write the points and radii, as .ply or .csv", kGrow, 0, kAnyInput, false, [](S& s, O, V v) { sphereFormatOf(v), s.output.spheres = v; }, kGeneral, {}, "", FileUse{FileUse::kWritten}},
    {"vdb", "FILE", "", "also write the level set of the surface, as .vdb", kGrow, 0, kAnyInput, false,
     [](S& s, O o, V v) {
       if (!isVdbFile(v)) refuse(o, v, "a name that ends in .vdb");
       s.output.vdb = v;
     }, kGeneral, {}, "", FileUse{FileUse::kWritten}},
    {"explain", "", "", "also report how the cloud grew: symbols per generation, points, radii, what was dropped", kGrow, 0, kAnyInput, false,
     [](S& s, O o, V v) { s.source.explain = parseBool(o, v); }},
    {"dry-run", "", "", "write nothing: grow stops after the spheres, batch lists its work", kGrow | kBatch, kGrow | kBatch, kAnyInput, false, [](S& s, O o, V v) { s.source.spheres_only = s.batch.dry_run = parseBool(o, v); }},
    {"rules", "FILE", "", "a plain list of rules instead of a preset", kGrow | kMeasure, kGrow, kAnyInput, false, [](S& s, O, V v) { s.source.kind = SourceKind::kRules, s.source.input = v; }, kRules, {}, "", kReads},
    {"premise", "TEXT", "", "symbols that the rules start from", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"generations", "G", "", "passes of the rules; a fraction grows the last pass in part", kGrows, kGrow, kFromRules, false, setRecipe, kRules},
    {"variable", "NAME=X", "", "sets a variable of the expressions, such as b, c, d; may be given several times", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"context-ignore", "SYMBOLS", "", "symbols that are skipped when contexts are matched", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"context-includes-siblings", "BOOL", "", "contexts include sibling branches", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"max-modules", "N", "", "limit of the number of symbols", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"max-passes", "N", "", "limit of the generations", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"max-steps", "N", "", "limit of the work of all generations", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"max-depth", "N", "", "limit of open brackets", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"max-points", "N", "", "limit of the turtle's points", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"max-spheres", "N", "", "limit of the spheres", kGrows, 0, kFromRules, false, setRecipe, kRules},
    {"step", "D", "", "length of an F, world units", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"step-scale", "X", "", "factor of \" on the step", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"angle", "DEG", "", "angle of a turn", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"angle-scale", "X", "", "factor of ; on the angle", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"thickness", "W", "", "width at the start, world units", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"thickness-scale", "X", "", "factor of ! on the width", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"gravity", "DEG", "", "how far T bends a horizontal heading", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"random-scale", "X", "", "random variation of lengths, as a fraction, 0 to 1", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"random-scale-all", "BOOL", "", "also vary angles and widths", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"segments", "N", "", "points per F", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"continuous-length", "BOOL", "", "lengths of the newest symbols grow with the fraction of the generation", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"continuous-angles", "BOOL", "", "the same for their angles", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"continuous-width", "BOOL", "", "the same for their widths and radii", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"pitch-up", "BOOL", "", "& pitches up and ^ down", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"uv-increment", "X", "", "step of ' and #", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"vertical-increment", "X", "", "growth of lage per segment", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"start-position", "X,Y,Z", "", "where the turtle starts, world units", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"start-rotation", "X,Y,Z", "", "degrees about X, then Y, then Z", kGrows, 0, kFromRules, false, setRecipe, kTurtle},
    {"emit", "WHAT", "", "what becomes a sphere: points, leaves, both", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"size", "R", "", "radius of a sphere at the starting width, world units", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"leaf-size", "R", "", "radius of a leaf of scale 1, world units", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"width-power", "X", "", "radius x (width / thickness)^X", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"generation-power", "X", "", "radius x (2 / (generation + 2))^X", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"radius-min", "X", "", "lower end of the random factor on each radius", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"radius-max", "X", "", "upper end of the random factor on each radius", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"top-falloff", "X", "", "how much smaller spheres get towards the top, 0 to 1", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"jitter", "X", "", "centres are moved at random by up to X radii along each axis", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"base", "Y", "", "height of the condensation level, world units, or none", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"squash", "X", "", "factor on the depth below the base, 0 to 1", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"ceiling", "Y", "", "height above which heights are scaled by 0.3, world units, or none", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"flat", "X", "", "centres stay at least X radii above the base, or none", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"count", "N", "", "keep only the N largest spheres, or none", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"domain", "WxHxD", "", "box that the cloud fills, world units; a side of 0 follows the others; or none", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"connect", "BOOL", "", "join separate parts by moving them together", kGrows, 0, kFromRules, false, setRecipe, kSpheres},
    {"units", "METRES", "as the file", "metres per unit of the sculpt", kSculpts, kBake, kFromSculpt, false,
     [](S& s, O o, V v) { s.source.read.metres_per_unit = parseDouble(o, v, double(kTiny), double(kHuge)); }},
    {"up", "AXIS", "as the file", "up axis of the sculpt: x, y, z", kSculpts, kBake, kFromSculpt, false,
     [](S& s, O o, V v) { s.source.read.up_axis = parseChoice<UpAxis, 3>(o, v, {{{"x", UpAxis::kX}, {"y", UpAxis::kY}, {"z", UpAxis::kZ}}}); }},
    {"grid", "NAME", "surface, density, or the first", "VDB: the grid to read", kSculpts, 0, kFromVolume, false, [](S& s, O, V v) { s.source.volume.grid = v; }},
    {"iso", "X", "5% of the mean value", "VDB: value of a fog volume at the surface", kSculpts, 0, kFromVolume, false,
     [](S& s, O o, V v) { s.source.volume.iso = parseFloat(o, v, -kHuge, kHuge); }},
    {"truth-vertices", "N", "2000; march, batch, check: 200", "vertices to compute the truth for, evenly spread", kMeasure | kBatch | kCheck, kMeasure | kCheck, kAnyInput, false,
     [](S& s, O o, V v) { s.judge.truth_vertices = size_t(parseInt(o, v, 1)); }},
    {"sun", "AZ,EL", "130,28", "azimuth (0 = behind the viewer, 90 = right) and elevation, degrees; 105,30 with --look plain and --compare", kDraws, kDraws, kAnyInput, false,
     [](S& s, O o, V v) { parseAngles(o, v, s.picture.sun_azimuth_degrees, s.picture.sun_elevation_degrees); }},
    {"camera", "AZ,EL", "0,-8", "azimuth and elevation of the camera, degrees; 0,6 with --look plain and --compare", kDraws, kDraws, kAnyInput, false,
     [](S& s, O o, V v) { parseAngles(o, v, s.picture.camera_azimuth_degrees, s.picture.camera_elevation_degrees); }},
    {"size", "WxH", "960x640", "picture size, pixels", kPreview, kPreview, kAnyInput, false, parsePictureSize},
    {"size", "WxH", "", "picture size, pixels; without it the picture fills the window", kView, kView, kAnyInput, false,
     [](S& s, O o, V v) {
       parsePictureSize(s, o, v);
       s.picture.is_sized = true;
     }},
    {"fov", "DEG", "35", "vertical field of view, degrees", kDraws, kDraws, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.field_of_view_degrees = parseFloat(o, v, 1, 150); }},
    {"look", "NAME", "painted", "painted (an image chain, as in games) or plain (the lobe formula alone)", kDraws, kDraws, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.plain = parseChoice<bool, 2>(o, v, {{{"painted", false}, {"plain", true}}}); }},
    {"time", "SECONDS", "0", "painted: the moment of all that moves by itself", kDraws, 0, kAnyInput, false, [](S& s, O o, V v) { s.picture.time_seconds = parseDouble(o, v, 0, 1e6); }, kGeneral,
     {{{[](const S& s) { return s.picture.plain && s.picture.time_seconds > 0; }, kOfPainted}}}},
    {"channels", "STEM", "", "painted: also write STEM_sun.png, _sky.png, _opacity.png and _depth.png; for NAME.exr all four as floats", kPreview, 0, kAnyInput, false,
     [](S& s, O, V v) { s.picture.channels = v; }, kGeneral,
     {{{isPlain, kOfPainted}, {moves, kOfOnePicture}, {isComparison, kOfNoSheet}}}, "", FileUse{FileUse::kStem, ".exr", "_sun.png _sky.png _opacity.png _depth.png"}},
    {"steps", "STEM", "", "painted: also write the picture after each step: STEM_1_drawn.png to STEM_5_distorted.png", kPreview, 0, kAnyInput, false,
     [](S& s, O, V v) { s.picture.steps = v; }, kGeneral,
     {{{isPlain, kOfPainted}, {moves, kOfOnePicture}, {isComparison, kOfNoSheet}}}, "", FileUse{FileUse::kStem, "", "_1_drawn.png _2_downsampled.png _2_depth_spread.png _3_blurred.png _3_softened.png _4_depth_blurred.png _4_distorted.png _5_distorted.png _5_eroded.png"}},
    {"scene", "FILE", "", "draw a scene file (docs/previewer.md) instead of an asset", kDraws, kDraws, kAnyInput, false,
     [](S& s, O, V v) { s.scene = v; }, kGeneral,
     {{{isPlain, " draws the painted look: leave out --look plain"}, {isComparison, kOfNoSheet},
      {[](const S& s) { return !s.source.input.empty(); }, " and an asset: give one of the two, because a scene names its own clouds"}}}, "", kReads},
    {"quality", "NAME", "final", "scenes: final or draft (faster, with fewer samples and coarser steps)", kPreview, kPreview, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.draft = parseChoice<bool, 2>(o, v, {{{"final", false}, {"draft", true}}}); }},
    {"lobes-only", "", "", "light by the lobes even if the asset has spherical harmonics", kDraws, 0, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.lobes_only = parseBool(o, v); }},
    {"turntable", "N", "", "draw a turn around the cloud in N frames, as animated PNG, while what moves by itself goes on", kPreview, kPreview, kAnyInput, false,
     [](S& s, O o, V v) { setMotion(s, o, v, Motion::kTurntable); }, kGeneral,
     {{{isComparison, kOfNoSheet}}}},
    {"sun-sweep", "N", "", "draw a day whose sun culminates at --sun in N frames, as animated PNG", kPreview, kPreview, kAnyInput, false,
     [](S& s, O o, V v) { setMotion(s, o, v, Motion::kSunSweep); }, kGeneral,
     {{{isComparison, kOfNoSheet}}}},
    {"animate", "N", "", "draw what moves by itself in N frames, as animated PNG: swirls alone until they repeat, else frame i after i/fps seconds", kPreview, kPreview, kAnyInput, false,
     [](S& s, O o, V v) { setMotion(s, o, v, Motion::kAnimate); }, kGeneral,
     {{{isPlain, kOfPainted}, {isComparison, kOfNoSheet}}}},
    {"fps", "X", "12", "frames per second of an animated PNG", kPreview, 0, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.frames_per_second = parseDouble(o, v, 0.1, 100); }},
    {"frames", "STEM", "", "also write every frame: STEM_0001.png and so on", kPreview, 0, kAnyInput, false, [](S& s, O, V v) { s.picture.frames = v; }, kGeneral,
     {{{[](const S& s) { return !moves(s); }, " needs --turntable, --sun-sweep or --animate"}}}, "", FileUse{FileUse::kStem, "", "_[0-9][0-9][0-9][0-9].png _[0-9][0-9][0-9][0-9][0-9].png"}},
    {"compare", "", "", "draw a sheet that compares volume, truth, lobe, Lambert and the painted look; a page gets the other kind of lobe, and harmonics", kDraws, kDraws, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.compare = parseBool(o, v); }},
    {"suns", "N", "", "with --compare: figures for N suns above the horizon, or on the arc of the fit", kPreview, 0, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.suns = parseInt(o, v, 1, 10000); }, kGeneral,
     {{{isNoComparison, kOfComparison}}}},
    {"view-extinction", "X", "as fitted, else 1", "with --compare: extinction along the view, as a factor of that towards the light", kPreview, 0, kAnyInput, false, setViewExtinction, kGeneral,
     {{{isNoComparison, kOfComparison}}}},
    {"octaves", "N[,A,B]", "as fitted, else 0", "with --compare: light that the volume scatters again, as N octaves; 6 is near to many", kPreview, 0, kAnyInput, false, setOctaves, kGeneral,
     {{{isNoComparison, kOfComparison}}}},
    {"phase", "G", "as fitted, else 0", "with --compare: asymmetry of the volume's scattering, above 0 forwards", kPreview, 0, kAnyInput, false, setPhase, kGeneral,
     {{{isNoComparison, kOfComparison}}}},
    {"exposure", "X", "1", "factor on the light, before tone mapping", kDraws, kDraws, kAnyInput, false,
     [](S& s, O o, V v) { s.picture.exposure = parseFloat(o, v, kTiny, 1e6F); }},
    {"serve", "[PORT]", "8642", "show the page at http://127.0.0.1:PORT/, for this machine only, until Ctrl-C, instead of writing it; 0 takes any free port", kView, kView, kAnyInput, false,
     [](S& s, O o, V v) { s.serve.port = parseInt(o, v, 0, 65535); }},
    {"watch", "FILE", "", "serve a sculpt, volume, recipe (.toml) or asset, and bake it again in memory whenever it is saved; takes the options of bake too", kView, kView, kAnyInput, false,
     [](S& s, O, V v) { s.serve.watch = v; }, kGeneral,
     {{{isComparison, " shows a single bake: leave out --compare"}}}, "", kReads},
    {"input-list", "FILE", "", "file with a sculpt's path per line, instead of a manifest; - reads stdin", kBatch, kBatch, kAnyInput, false, [](S& s, O, V v) { s.batch.input_list = v; }, kOfBatch, {}, "", kReads},
    {"name", "TEMPLATE", "{folder}/{stem}.glb", "output names; words: {stem}, {ext}, {folder}, {seed}", kBatch, kBatch, kAnyInput, false, [](S& s, O, V v) { s.batch.name = v; }, kOfBatch},
    {"init", "", "", "write a commented manifest to MANIFEST.toml", kBatch, kBatch, kAnyInput, false, [](S& s, O o, V v) { s.batch.init = parseBool(o, v); }, kOfBatch},
    {"force", "", "", "also replace files of other programs where cloudbake makes the names; batch also bakes what is up to date",
     kGrow | kBake | kPreview | kMeasure | kShader | kBatch, kBatch | kShader, kAnyInput, false, [](S& s, O o, V v) { s.run.force = parseBool(o, v); }},
    {"prune", "", "", "remove outputs of earlier batches that are no longer in the batch", kBatch, 0, kAnyInput, false, [](S& s, O o, V v) { s.batch.prune = parseBool(o, v); }, kOfBatch,
     {{{[](const S& s) { return s.batch.shards > 0; }, " needs the whole batch: leave out --shard"}}}},
    {"fail-fast", "", "", "start nothing new after a failure", kBatch, 0, kAnyInput, false, [](S& s, O o, V v) { s.batch.fail_fast = parseBool(o, v); }, kOfBatch},
    {"cache", "DIR", "", "folder that keeps bakes by the hash of their inputs; machines may share it", kBatch, kBatch, kAnyInput, false,
     [](S& s, O, V v) { s.batch.cache = v; }, kOfBatch},
    {"shard", "I/N", "", "bake only part I of N parts of about equal cost", kBatch, kBatch, kAnyInput, false, [](S& s, O o, V v) { parseShard(s, o, v); }, kOfBatch},
    {"merge", "", "", "merge the reports of shards, given instead of a manifest", kBatch, kBatch, kAnyInput, false, [](S& s, O o, V v) { s.batch.merge = parseBool(o, v); }, kOfBatch},
    {"max-angle", "DEG", "", "fail if the rms error of the direction is larger; not for fitted lobes", kBatch | kCheck, kBatch | kCheck, kAnyInput, false,
     [](S& s, O o, V v) { s.judge.bounds.angle_degrees = parseDouble(o, v, 0, 180); }, kBounds},
    {"max-transmittance-rms", "X", "", "fail if the rms error of the transmittance is larger, 0 to 1", kBatch | kCheck, kCheck, kAnyInput, false,
     [](S& s, O o, V v) { s.judge.bounds.transmittance_rms = parseDouble(o, v, 0, 1); }, kBounds},
    {"max-surface-rms", "X", "", "fail if the rms error of the transmittance over the surface is larger, 0 to 1", kBatch | kCheck, 0, kAnyInput, false,
     [](S& s, O o, V v) { s.judge.bounds.surface_rms = parseDouble(o, v, 0, 1); }, kBounds,
     {{{[](const S& s) { return s.judge.against.has_value(); }, " is measured against exact chords: leave out --against"}}}},
    {"against", "FILE", "", "compare with this earlier asset, vertex by vertex, not with exact chords", kCheck, kCheck, kAnyInput, false,
     [](S& s, O, V v) { s.judge.against = v; }, kGeneral, {}, "", kReads},
    {"with-lattice", "FILE", "", "also judge this lattice of spherical harmonics, which --lattice wrote", kCheck, kCheck, kAnyInput, false,
     [](S& s, O, V v) { s.judge.lattice = v; }, kGeneral, {}, "", kReads},
    {"junit", "FILE", "", "write the report as JUnit XML", kBatch, 0, kAnyInput, false, [](S& s, O, V v) { s.batch.junit = v; }, kOfBatch, {}, "", FileUse{FileUse::kWritten, ".xml"}},
    {"html", "FILE", "", "write the report as a page with pictures", kBatch, kBatch, kAnyInput, false, [](S& s, O, V v) { s.batch.html = v; }, kOfBatch, {}, "", FileUse{FileUse::kWritten, ".html .htm"}},
    {"live", "", "", "with --html: also write a live view of every asset beside it, NAME.html, and link its picture to it", kBatch, kBatch, kAnyInput, false, [](S& s, O o, V v) { s.batch.live = parseBool(o, v); }, kOfBatch,
     {{{[](const S& s) { return s.batch.live && !s.batch.html; }, " needs --html FILE: the report that links to the live views"}}}},
    {"depfile", "FILE", "", "write the list of files that the batch reads, for Make and Ninja", kBatch, 0, kAnyInput, false, [](S& s, O, V v) { s.batch.depfile = v; }, kOfBatch, {}, "", FileUse{FileUse::kWritten, ".d"}},
    {"depfile-target", "PATH", "the output folder", "target of the depfile", kBatch, 0, kAnyInput, false, [](S& s, O, V v) { s.batch.depfile_target = v; }, kOfBatch},
    {"threads", "N", "all", "number of threads; it does not change the result", kAll, kMeasure | kBatch, kAnyInput, false, [](S& s, O o, V v) { s.run.threads = parseInt(o, v, 1, 4096); }},
    {"memory", "SIZE", "3/4 of what is free", "most memory that the run may take, such as 8G; more is refused before it is taken", kAll | kShader, kBatch, kAnyInput, false,
     [](S& s, O o, V v) { s.run.memory = parseBytes(o, v); }},
    {"strict", "", "", "treat warnings as errors (exit 3) and write nothing", kAll | kShader, kGrow | kBake | kCheck, kAnyInput, false, [](S& s, O o, V v) { s.run.strict = parseBool(o, v); }},
    {"json", "FILE", "", "write the report, or the error, as JSON", kAll | kShader, kAll | kShader, kAnyInput, false, [](S& s, O, V v) { s.run.json = v; }, kGeneral, {}, "", FileUse{FileUse::kWritten, ".json"}},
};

}  // namespace

std::string_view groupOf(const Option& option, Command command) {
  return command == kView && needsWatch(option) ? "Bake (with --watch)" : option.group;
}

bool isOfFiles(const Option& option) {
  constexpr std::string_view kOfFiles[] = {"units", "up", "allow-outside", "scene-index"};
  return std::find(std::begin(kOfFiles), std::end(kOfFiles), option.name) != std::end(kOfFiles);
}

bool isVdbFile(const std::filesystem::path& file) { return lowerCase(file.extension().string()) == ".vdb"; }

std::span<const Option> optionTable() { return kOptions; }

const Option* findOption(std::string_view name, Command command) {
  std::string dashed(name);
  std::replace(dashed.begin(), dashed.end(), '_', '-');
  const auto found = std::find_if(std::begin(kOptions), std::end(kOptions),
                                  [&](const Option& option) { return dashed == option.name && (option.commands & command); });
  return found == std::end(kOptions) ? nullptr : &*found;
}

const Option* findAssetOption(std::string_view name) {
  const Option* option = findOption(name, kBatch);
  if (!option || !(option->commands & (kGrow | kBake))) return nullptr;
  const std::string_view found = option->name;
  return found == "threads" || found == "memory" || found == "json" || found == "dry-run" || found == "force"
             ? nullptr
             : option;  // these belong to the run, not to an asset
}

bool isGiven(std::span<const Given> given, std::string_view name) {
  return std::any_of(given.begin(), given.end(), [&](const Given& one) { return name == one.option->name; });
}

std::vector<std::string> optionChoices(const Option& option) {
  if (std::string_view(option.unit) == "BOOL") return {"true", "false"};
  if (!*option.unit || !option.set) return {};
  Settings scratch;
  try {
    option.set(scratch, option, "");  // no valid choice is empty
  } catch (const ChoiceError& error) {
    return error.choices;
  } catch (const Error&) {
  }
  return {};
}

}  // namespace cloudbake
