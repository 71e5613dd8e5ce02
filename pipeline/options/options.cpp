#include "pipeline/options/options.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "bake/mesh/repair.h"
#include "core/harmonics.h"
#include "core/text/scan.h"
#include "core/text/utf8.h"
#include "io/volume/spheres.h"
#include "lsystem/recipe.h"
#include "pipeline/options/option_values.h"

namespace cloudbake {

namespace {

using S = Settings;
using O = const Option&;
using V = const std::string&;

constexpr double kTiny = std::numeric_limits<float>::min(), kHuge = std::numeric_limits<float>::max(),
                 kMostInt = std::numeric_limits<int>::max();

// --- Values of more than one field ---

// "50%,25%" or "2000,500": all of one kind, each smaller than the one before.
void setLevels(S& settings, O option, V value) {
  std::vector<LevelSize>& levels = settings.mesh.levels;
  levels.clear();
  for (std::string size : readList(value)) {
    const bool is_share = size.ends_with('%');
    if (is_share) size.pop_back();
    const double number = is_share ? readNumber<double>(option, size, 0, 100) / 100 : readNumber<int>(option, size, 4, int(kMostInt));
    if (is_share && (number == 0 || number == 1)) refuseValue(option, value, "a list of sizes above 0% and below 100%");
    if (!levels.empty() && (is_share != levels.back().is_share || number >= levels.back().value))
      refuseValue(option, value, "a list of sizes of one kind, % or vertices, each smaller than the one before");
    levels.push_back({number, is_share});
  }
  if (levels.size() > kMostLevels) refuseValue(option, value, "a list of at most " + std::to_string(kMostLevels) + " sizes");
}

// "change=1,vertices=200000".
void setBudget(S& settings, O option, V value) {
  constexpr const char* kWanted = "a list of change, vertices, bytes and draws, each with = and a number, such as change=2,draws=40";
  PlanSettings& plan = settings.plan;
  for (const std::string& one : readList(value)) {
    const size_t equals = one.find('=');
    if (equals == std::string::npos) refuseValue(option, value, kWanted);
    const std::string key = one.substr(0, equals), number = one.substr(equals + 1);
    if (key == "change")
      plan.change = readNumber<double>(option, number, 0.1, 255);
    else if (key == "vertices")
      plan.vertices = readNumber<double>(option, number, 1, kHuge);
    else if (key == "bytes")
      plan.bytes = readNumber<double>(option, number, 1, kHuge);
    else if (key == "draws")
      plan.draws = readNumber<double>(option, number, 1, kHuge);
    else
      refuseValue(option, value, kWanted);
  }
}

// A picture of twice as many pixels is halved six times.
void setPixels(S& settings, O option, V value) {
  const int pixels = readNumber<int>(option, value);
  if (pixels % 32 != 0) refuseValue(option, value, "a whole number from 32 to 2048 that is a multiple of 32");
  settings.sequence.pixels = pixels;
}
std::string pixelsText(const S& settings, O) { return std::to_string(settings.sequence.pixels); }

// "OPTION=A:B", or several joined by commas.
void setVaried(S& settings, O option, V value) {
  constexpr const char* kWanted = "an option and its first and last number, such as size=0.5:1";
  for (const std::string& one : readList(value)) {
    const size_t equals = one.find('='), colon = one.find(':', std::min(equals, one.size()));
    if (equals == 0 || equals == one.npos || colon == one.npos) refuseValue(option, one, kWanted);
    const double from = readNumber<double>(option, one.substr(equals + 1, colon - equals - 1), -1e9, 1e9),
                 to = readNumber<double>(option, one.substr(colon + 1), -1e9, 1e9);
    settings.sequence.varied.push_back({one.substr(0, equals), from, to});
  }
}

// "6,9,12".
void setHours(S& settings, O option, V value) {
  settings.plan.hours.clear();
  for (const std::string& hour : readList(value)) settings.plan.hours.push_back(readNumber<double>(option, hour, 0, 24));
}

// "X,Y,Z:X,Y,Z:…".
std::vector<Vec3> readPlaces(O option, V value, const char* wanted) {
  std::vector<Vec3> places;
  for (std::string rest = value; !rest.empty();) {
    const size_t end = std::min(rest.find(':'), rest.size());
    const std::vector<std::string> numbers = readList(rest.substr(0, end));
    if (numbers.size() != 3) refuseValue(option, value, wanted);
    Vec3 place;
    for (size_t axis = 0; axis < 3; ++axis)
      (axis == 0 ? place.x : axis == 1 ? place.y : place.z) = readNumber<float>(option, numbers[axis], -1e9F, 1e9F);
    places.push_back(place);
    rest.erase(0, end + 1);
  }
  return places;
}
void setPath(S& settings, O option, V value) {
  constexpr const char* kWanted = "two or more places of three numbers, X,Y,Z, joined by colons";
  settings.plan.path = readPlaces(option, value, kWanted);
  if (settings.plan.path.size() < 2) refuseValue(option, value, kWanted);
}
void setRegion(S& settings, O option, V value) {
  constexpr const char* kWanted = "the low and the high corner of a box, three numbers each: X,Y,Z:X,Y,Z";
  const std::vector<Vec3> corners = readPlaces(option, value, kWanted);
  if (corners.size() != 2) refuseValue(option, value, kWanted);
  const Vec3 low = corners[0], high = corners[1];
  if (low.x > high.x || low.y > high.y || low.z > high.z) refuseValue(option, value, kWanted);
  settings.plan.region.emplace(low, high);
}

// Any of "orient,fill,remesh".
void setRepair(S& settings, O option, V value) {
  for (const std::string& cure : readList(value)) {
    const ValueForm::Word* word = findWord(option.value.form, cure);
    if (!word) refuseValue(option, value, "a list of " + wordList(option.value.form) + ", joined by commas");
    bool* const asked[] = {&settings.mesh.repair.orient, &settings.mesh.repair.fill, &settings.mesh.repair_remesh};
    *asked[word->value] = true;
  }
}

// "LOW:HIGH", or one number for both.
std::pair<float, float> readRange(O option, V value, float low, float high) {
  const size_t at = value.find(':');
  const auto first = readNumber<float>(option, value.substr(0, at), low, high);
  const auto second = at == std::string::npos ? first : readNumber<float>(option, value.substr(at + 1), low, high);
  if (second < first) refuseValue(option, value, "a range LOW:HIGH, the lower first");
  return {first, second};
}

void setExtinction(S& settings, O option, V value) {
  settings.lobe.extinction_range = readRange(option, value, float(option.value.form.low), float(option.value.form.high));
}

constexpr float kMostAzimuth = 3600, kMostElevation = 90;

void setSunArc(S& settings, O option, V value) {
  const auto [elevation, azimuth] = readPair(option, value, ',');
  const auto [elevation_low, elevation_high] = readRange(option, elevation, -kMostElevation, kMostElevation);
  const auto [azimuth_low, azimuth_high] = readRange(option, azimuth, -kMostAzimuth, kMostAzimuth);
  settings.lobe.sun_arc = {elevation_low, elevation_high, azimuth_low, azimuth_high};
}

// "AZ,EL".
template <auto azimuth, auto elevation>
constexpr OptionValue anglesAt() {
  return {[](S& s, O o, V v) {
            const auto [first, second] = readPair(o, v, ',');
            s.picture.*azimuth = readNumber(o, first, -kMostAzimuth, kMostAzimuth);
            s.picture.*elevation = readNumber(o, second, -kMostElevation, kMostElevation);
          },
          {.shape = "X,X", .examples = "10,20 20,10"},
          [](const S& s, O) { return shortestText(s.picture.*azimuth) + "," + shortestText(s.picture.*elevation); }};
}

void setPictureSize(S& settings, O option, V value) {
  constexpr int kMostPixels = 16384;
  const auto [width, height] = readPair(option, value, 'x');
  settings.picture.width = readNumber(option, width, 1, kMostPixels);
  settings.picture.height = readNumber(option, height, 1, kMostPixels);
}
void setPageSize(S& settings, O option, V value) {
  setPictureSize(settings, option, value);
  settings.picture.is_sized = true;
}
std::string pictureSizeText(const S& s, O) { return std::to_string(s.picture.width) + "x" + std::to_string(s.picture.height); }
constexpr ValueForm kSizeForm{.shape = "NxN", .examples = "640x360 64x48"};

// A number of bytes, with K, M, G or T for powers of 1024. The program with its libraries takes some tens of megabytes by itself.
void setMemory(S& settings, O option, V value) {
  const size_t unit = value.empty() ? std::string_view::npos : std::string_view("KMGT").find(value.back());
  const bool has_unit = unit != std::string_view::npos;
  const auto number = readNumber<double>(option, has_unit ? value.substr(0, value.size() - 1) : value, 1, 1e15);
  const double bytes = has_unit ? std::ldexp(number, 10 * (int(unit) + 1)) : number;
  if (!(bytes >= 64 << 20 && bytes <= 1e15)) refuseValue(option, value, "a size from 64M to 900T, such as 8G");
  settings.run.memory = uint64_t(bytes);
}

using Motion = PictureSettings::Motion;

template <Motion motion>
constexpr OptionValue framesOf() {
  return {[](S& s, O o, V v) {
            PictureSettings& view = s.picture;
            view.frame_count = readNumber<int>(o, v);
            if (view.motion != Motion::kNone && view.motion != motion)
              throw UsageError("--turntable, --sun-sweep and --animate: give only one of them");
            view.motion = motion;
          },
          {.kind = ValueForm::kWhole, .low = 2, .high = 10000}};
}

void setShard(S& settings, O option, V value) {
  const auto [first, second] = readPair(option, value, '/');
  settings.batch.shards = readNumber(option, second, 1, 100000);
  settings.batch.shard = readNumber(option, first, 1, settings.batch.shards);
}

// "N" or "N,A,B".
void setOctaves(S& settings, O option, V value) {
  OctaveSettings& octaves = settings.lobe.volume.octaves.emplace();
  const size_t comma = value.find(',');
  octaves.count = readNumber<int>(option, value.substr(0, comma));
  if (comma == std::string::npos) return;
  const auto [extinction, contribution] = readPair(option, value.substr(comma + 1), ',');
  octaves.extinction = readNumber<float>(option, extinction, 0, 1);
  octaves.contribution = readNumber<float>(option, contribution, 0, 1);
}
constexpr OptionValue kOctaves{
    setOctaves, {.kind = ValueForm::kWhole, .low = 0, .high = kMostLightOctaves, .shape = "N,X,X", .examples = "3 5,0.6,0.4"}};

constexpr ValueForm withWord(const char* word, ValueForm form) {
  form.words[0].text = word;
  return form;
}

void setExponent(S& settings, O option, V value) {
  settings.lobe.fit_exponent = value == "fit";
  if (!settings.lobe.fit_exponent) settings.lobe.exponent = readNumber<float>(option, value);
}
void setBias(S& settings, O option, V value) {
  settings.lobe.fit_bias = value == "fit";
  if (!settings.lobe.fit_bias) settings.lobe.bias = readShare<Length>(option, value);
}
void setRefine(S& settings, O option, V value) { settings.mesh.refine = value == "auto" ? 0 : readNumber<double>(option, value); }
void setRemesh(S& settings, O option, V value) {
  settings.mesh.remesh = readShare<Length>(option, value);
  if (settings.mesh.remesh->value == 0) refuseValue(option, value, "a length above 0");
}
void setFixedDirections(S& settings, O option, V value) { settings.lobe.bake.rotate_directions = !readFlag(option, value); }
void setDryRun(S& settings, O option, V value) { settings.source.spheres_only = settings.batch.dry_run = readFlag(option, value); }

void setLattice(S& settings, O option, V value) {
  const std::filesystem::path file = value;
  if (file.extension() != ".json" || file.stem().empty()) refuseValue(option, value, "a name that ends in .json");
  if (!isUtf8(file.stem().string())) refuseValue(option, value, "a name in UTF-8, because the file names its textures in JSON");
  settings.output.lattice = file;
}
void setSpheres(S& settings, O, V value) { sphereFormatOf(value), settings.output.spheres = value; }
void setVdb(S& settings, O option, V value) {
  if (!isVdbFile(value)) refuseValue(option, value, "a name that ends in .vdb");
  settings.output.vdb = value;
}

template <SourceKind kind>
constexpr OptionValue sourceOf(const char* examples) {
  return {[](S& s, O, V v) { s.source.kind = kind, s.source.input = v; }, {.examples = examples}};
}

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

// --- The table ---

// `view` bakes what it watches.
constexpr unsigned kSculpts = kBake | kMeasure | kBatch | kView | kSequence, kBakes = kSculpts | kGrow,
                   kGrows = kGrow | kMeasure | kBatch | kSequence, kDraws = kPreview | kView,
                   kAll = kBakes | kDraws | kCheck | kShadow | kImpostor | kPlan, kAssets = kGrow | kBake | kBatch;
constexpr unsigned kFromSurface = kAnyInput & ~kFromVolume, kFromGrowth = kFromRules | kFromSpheres;

constexpr const char *kGeneral = "Options", *kOfBake = "Bake", *kOfLobe = "Lobes", *kOfMesh = "Mesh", *kOfInput = "Input",
                     *kOfGltf = "Asset", *kOfGrowth = "Grown cloud", *kRules = "Rules (as the recipe says, unless given)",
                     *kTurtle = "Turtle (as the recipe says, unless given)", *kSpheres = "Spheres (as the recipe says, unless given)",
                     *kOfSequence = "Sequence", *kOfPicture = "Picture", *kOfMotion = "Motion", *kOfSheet = "Comparison", *kOfPage = "Page",
                     *kOfBatch = "Batch", *kOfTruth = "Truth", *kBounds = "Bounds";

constexpr FileUse kReads{FileUse::kRead};
constexpr FileUse writes(const char* extensions, const char* endings = "") { return {FileUse::kWritten, extensions, endings}; }

constexpr auto kLobe = &S::lobe;
constexpr auto kRays = &LobeSettings::bake;
constexpr auto kVolume = &LobeSettings::volume;
constexpr auto kMesh = &S::mesh;
constexpr auto kField = &S::field;
constexpr auto kSource = &S::source;
constexpr auto kRead = &SourceSettings::read;
constexpr auto kOutput = &S::output;
constexpr auto kGltf = &OutputSettings::gltf;
constexpr auto kPicture = &S::picture;
constexpr auto kJudge = &S::judge;
constexpr auto kErrors = &JudgeSettings::bounds;
constexpr auto kBatchOf = &S::batch;
constexpr auto kRun = &S::run;
using L = LobeSettings;
using B = BakeSettings;
using M = MeshSettings;
using F = FieldSettings;
using P = PictureSettings;
using J = JudgeSettings;

constexpr OptionValue kViewExtinction = numberAt<kLobe, kVolume, &VolumeChoices::view_extinction>(0.01, 100),
                      kPhase = numberAt<kLobe, kVolume, &VolumeChoices::asymmetry>(-0.95, 0.95);

const Option kOptions[] = {
    {.name = "as-published",
     .value = {.form = {.kind = ValueForm::kFlag}},
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe | kNotOnPage,
     .help = "the method exactly as published: uniform draws, 100 × 100, end, L = 10, k = 3, b = -0.01",
     .stands_for = "method=rays sampler=uniform quadrature=end rays=100 steps=100 ray-length=10 exponent=3 bias=-0.01"},
    {.name = "method",
     .unit = "NAME",
     .value = choiceAt<kLobe, kRays, &B::method>({{"sweep", Method::kSweep}, {"rays", Method::kRays}}),
     .group = kOfBake,
     .commands = kBakes,
     .common = kMeasure,
     .bits = kInRecipe | kNotOnPage,
     .help = "how inside lengths are measured: sweep (all vertices at once), rays",
     .rules = {{{[](const S& s) { return isRays(s) && hasTarget(s); },
                 " rays cannot be combined with --target-error: a sweep costs less at every error"}}}},
    {.name = "field",
     .label = "What a sweep integrates",
     .unit = "NAME",
     .value = choiceAt<kField, &F::kind>(
         {{"auto", FieldChoice::kAuto}, {"coverage", FieldChoice::kCoverage}, {"levelset", FieldChoice::kLevelSet}}),
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe,
     .help = "what a sweep integrates: coverage (rasterised from a closed mesh), levelset, auto (coverage if closed)",
     .rules = {{{[](const S& s) { return isRays(s) && s.field.kind != FieldChoice::kAuto; },
                 " is an option of the sweep: rays march the level set"}}}},
    {.name = "rays",
     .label = "Directions per vertex",
     .unit = "N",
     .value = numberAt<kLobe, kRays, &B::rays>(1, 1 << 20),
     .group = kOfBake,
     .commands = kBakes,
     .common = kBake | kMeasure,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "directions per vertex; a sweep needs an even number",
     .rules = {{{isOddSweep, ": a sweep uses both senses of an axis: give an even number, or --method rays"},
                {hasTooFewForHarmonics,
                 ": spherical harmonics need 8 (sh1), 18 (sh2) or 32 (sh3) directions: use more --rays, or a lower --basis"},
                {hasTarget, kChosen}}}},
    {.name = "sampler",
     .unit = "NAME",
     .value = choiceAt<kLobe, kRays, &B::sampler>(
         {{"stratified", Sampler::kStratified}, {"fibonacci", Sampler::kFibonacci}, {"uniform", Sampler::kUniform}}),
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe | kNotOnPage,
     .help = "rays: how directions are chosen: stratified, fibonacci (turned at random per vertex), uniform",
     .rules = {{{[](const S& s) { return isSweep(s) && s.lobe.bake.sampler != Sampler::kFibonacci; }, kOfRays}}}},
    {.name = "fixed-directions",
     .value = {setFixedDirections, {.kind = ValueForm::kFlag}},
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe | kNotOnPage,
     .help = "rays with fibonacci: one set of directions for all vertices, not turned",
     .rules = {{{isSweep, kOfRays}}}},
    {.name = "quadrature",
     .unit = "NAME",
     .value = choiceAt<kLobe, kRays, &B::quadrature>(
         {{"crossing", Quadrature::kCrossing}, {"midpoint", Quadrature::kMidpoint}, {"end", Quadrature::kEnd}}),
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe | kNotOnPage,
     .help = "rays: inside length along a ray: crossing, midpoint, end (as published)",
     .rules = {{{isSweep, kOfRays}}}},
    {.name = "steps",
     .unit = "S",
     .value = numberAt<kLobe, kRays, &B::steps>(1, 1 << 20),
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe | kNotOnPage,
     .help = "rays: samples per ray",
     .rules = {{{isSweep, kOfRays}}}},
    {.name = "ray-length",
     .unit = "L",
     .value = numberAt<kLobe, kRays, &B::ray_length>(kTiny),
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe | kNotOnPage,
     .help = "length of a ray, world units; the default is the diagonal of the bounding box",
     .fallback = "diagonal"},
    {.name = "voxels",
     .label = "Voxels along the longest side",
     .unit = "N",
     .value = numberAt<kField, &F::voxels>(1),
     .group = kOfBake,
     .commands = kBakes,
     .common = kGrow | kBake | kMeasure,
     .inputs = kFromSurface,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "voxels of the level set along the longest side",
     .rules = {{{isVolume, kOwnLattice}}}},
    {.name = "voxel-size",
     .unit = "H",
     .value = numberAt<kField, &F::voxel_size>(kTiny),
     .group = kOfBake,
     .commands = kBakes,
     .inputs = kFromSurface,
     .bits = kInRecipe | kNotOnPage,
     .help = "voxel size, world units, instead of --voxels",
     .rules = {{{isVolume, kOwnLattice}}}},
    {.name = "bake-voxels",
     .label = "Voxels of the integration",
     .unit = "N",
     .value = numberAt<kField, &F::bake_voxels>(1),
     .group = kOfBake,
     .commands = kBakes,
     .bits = kInRecipe,
     .help = "voxels of the integration field along the longest side; grown: no more than its directions and spheres need",
     .fallback = "as the surface",
     .rules = {{{hasTarget, kChosen}}}},
    {.name = "target-error",
     .unit = "E",
     .value = {[](S& s, O o, V v) { s.lobe.target_error = readShare<TargetError>(o, v); },
               {.kind = ValueForm::kNumber, .low = 0.05, .high = 180, .low_percent = 0.01, .high_percent = 100}},
     .group = kOfBake,
     .commands = kBakes & ~kSequence,
     .common = kGrow | kBake | kMeasure,
     .bits = kInRecipe | kNotOnPage | kInBlendersPanel,
     .help = "find directions and voxels for an rms error: degrees, or % of T"},
    {.name = "scene",
     .unit = "FILE",
     .value = textAt<&S::scene>("view.toml other.toml"),
     .group = kOfBake,
     .commands = kBakes & ~(kView | kSequence),
     .common = kGrow | kBake,
     .help = "scene file: target error 1/255, vertices for its camera, fit for its sun",
     .files = kReads},
    {.name = "seed",
     .label = "Random seed",
     .unit = "N",
     .value = numberAt<kLobe, kRays, &B::seed>(0),
     .group = kOfBake,
     .commands = kBakes,
     .common = kGrow,
     .bits = kInRecipe,
     .help = "random seed of the shape and of the rays"},

    {.name = "lobe",
     .label = "Lobe",
     .unit = "NAME",
     .value = choiceAt<kLobe, &L::fit>({{"fit", true}, {"mean", false}}),
     .group = kOfLobe,
     .commands = kBakes,
     .common = kGrow | kBake | kMeasure,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "fit (to the light that the cloud shows) or mean (direction and thickness; default of rays, --separate and measure)"},
    {.name = "fit-to",
     .label = "Fit the lobe to",
     .unit = "NAME",
     .value = choiceAt<kLobe, &L::fit_to_volume>({{"volume", true}, {"transmittance", false}}),
     .group = kOfLobe,
     .commands = kBakes,
     .common = kBake,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "what --lobe fit fits: volume (light that a volume render shows) or transmittance (light at the surface; default of rays)",
     .rules = {{{[](const S& s) { return s.lobe.fit_to_volume && !s.lobe.fit; }, " volume needs --lobe fit"},
                {[](const S& s) { return s.lobe.fit_to_volume && isRays(s); }, " volume needs --method sweep"}}}},
    {.name = "view-extinction",
     .label = "Extinction along the view, factor",
     .unit = "X",
     .value = kViewExtinction,
     .group = kOfLobe,
     .commands = kBakes,
     .bits = kInRecipe,
     .help = "fit to a volume: extinction along the view, as a factor of that towards the light",
     .fallback = "1",
     .rules = {{{isFittedToNoVolume, kOfVolumeFit}}}},
    {.name = "octaves",
     .label = "Light scattered again, octaves",
     .unit = "N[,A,B]",
     .value = kOctaves,
     .group = kOfLobe,
     .commands = kBakes,
     .bits = kInRecipe,
     .help = "fit to a volume: light that is scattered again, as N octaves; octave i has A^i of the extinction and B^i of the light, "
             "both 0.5 by default",
     .fallback = "0",
     .rules = {{{isFittedToNoVolume, kOfVolumeFit}}}},
    {.name = "phase",
     .label = "Scattering forwards, −0.95 to 0.95",
     .unit = "G",
     .value = kPhase,
     .group = kOfLobe,
     .commands = kBakes,
     .bits = kInRecipe,
     .help = "fit to a volume: asymmetry of the scattering, -0.95 to 0.95; above 0 forwards",
     .fallback = "0",
     .rules = {{{isFittedToNoVolume, kOfVolumeFit}}}},
    {.name = "exponent",
     .label = "Exponent k",
     .unit = "K",
     .value = {setExponent, withWord("fit", {.kind = ValueForm::kNumber, .low = 0, .high = 1000})},
     .group = kOfLobe,
     .commands = kBakes,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "k of the lobe formula; with --lobe fit also 'fit', the best k for the asset",
     .fallback = "3; fit: 4",
     .rules = {{{[](const S& s) { return s.lobe.fit_exponent && !s.lobe.fit; }, " fit needs --lobe fit"}}}},
    {.name = "bias",
     .label = "Bias b, world units or %",
     .unit = "B",
     .value = {setBias, withWord("fit", lengthAt<kLobe, &L::bias>(-kHuge, kHuge).form)},
     .group = kOfLobe,
     .commands = kBakes,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "b of the lobe formula: world units, or % of the longest side; with --lobe fit also 'fit'",
     .fallback = "-0.3%; fit: 0",
     .rules = {{{[](const S& s) { return s.lobe.fit_bias && !s.lobe.fit; }, " fit needs --lobe fit"}}}},
    {.name = "extinction",
     .label = "Extinction σ, per world unit",
     .unit = "SIGMA",
     .value = {setExtinction, {.kind = ValueForm::kNumber, .low = kTiny, .high = kHuge, .shape = "X:X", .examples = "2:9 3"}},
     .group = kOfLobe,
     .commands = kBakes,
     .common = kBake,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "per world unit; for a fit also LO:HI",
     .fallback = "7/longest side; fit: half to double",
     .rules = {{{[](const S& s) { return !s.lobe.fit && s.lobe.extinction_range->first != s.lobe.extinction_range->second; },
                 " LO:HI needs --lobe fit: a mean lobe has a single extinction"}}}},
    {.name = "sun-arc",
     .label = "Range of the sun, degrees",
     .unit = "EL:EL,AZ:AZ",
     .value = {setSunArc, {.shape = "X:X,X:X", .examples = "5:60,80:100 30,90"}},
     .group = kOfLobe,
     .commands = kBakes,
     .bits = kInRecipe,
     .help = "fit: range of the sun, degrees; the zenith is always added",
     .fallback = "whole sphere",
     .rules = {{{[](const S& s) { return !s.lobe.fit; }, " needs --lobe fit"}}}},
    {.name = "basis",
     .label = "Also write harmonics",
     .unit = "NAME",
     .value = choiceAt<kLobe, &L::harmonic_order>({{"lobe", 0}, {"sh1", 1}, {"sh2", 2}, {"sh3", 3}}),
     .group = kOfLobe,
     .commands = kBakes & ~kSequence,
     .common = kMeasure,
     .bits = kInRecipe | kNotInBlender,
     .help = "also write spherical harmonics of T: lobe (none), sh1, sh2, sh3"},
    {.name = "lattice",
     .unit = "FILE",
     .value = {setLattice, {.examples = "a.json b.json"}},
     .group = kOfLobe,
     .commands = kGrow | kBake,
     .bits = kNotInBlender,
     .help = "also write spherical harmonics on a lattice in and around the cloud: FILE.json with 3D textures (KTX 2); needs --basis",
     .rules = {{{[](const S& s) { return s.lobe.harmonic_order == 0; }, " needs --basis sh1, sh2 or sh3"}}},
     .files = writes("", ".[0-9].ktx2")},
    {.name = "lattice-cells",
     .unit = "N",
     .value = numberAt<kLobe, &L::lattice_cells>(2, 128),
     .group = kOfLobe,
     .commands = kGrow | kBake,
     .bits = kOfOutputFiles | kNotOnPage | kNotInBlender,
     .help = "cells of the lattice along the longest side"},
    {.name = "smooth",
     .label = "Smoothing, passes",
     .unit = "N",
     .value = numberAt<kLobe, &L::smooth>(0, 1000),
     .group = kOfLobe,
     .commands = kBakes,
     .bits = kInRecipe | kInBlendersPanel,
     .help = "passes of Laplacian smoothing of the lobes over the mesh, after bake and fit",
     .rules = {{{[](const S& s) { return hasTarget(s) && s.lobe.smooth > 0; },
                 " changes the lobes that --target-error (or --scene) measured: leave it out, or give --rays and --bake-voxels instead of "
                 "a target"}}}},

    {.name = "vertices",
     .unit = "N",
     .value = numberAt<kMesh, &M::vertices>(4, kMostInt),
     .group = kOfMesh,
     .commands = kBakes,
     .common = kGrow | kBake | kMeasure,
     .bits = kInRecipe | kNotOnPage | kInBlendersPanel,
     .help = "vertex budget; without it a sculpt keeps its own mesh"},
    {.name = "lods",
     .unit = "LIST",
     .value = {setLevels, {.high_percent = 100, .shape = "X,…", .examples = "50%,25% 900,300,100"}},
     .group = kOfMesh,
     .commands = kAssets,
     .common = kGrow | kBake,
     .help = "also write levels of detail, OUT_lod1.glb and so on: vertices, or % of them, such as 50%,25%,10%",
     .rules = {{{[](const S& s) { return s.mesh.refine.has_value(); },
                 " and --refine change the mesh in opposite ways: give one of the two"}}},
     .files = {FileUse::kLevels}},
    {.name = "remesh",
     .unit = "LENGTH",
     .value = {setRemesh, lengthAt<kMesh, &M::remesh>(kTiny, kHuge).form},
     .group = kOfMesh,
     .commands = kSculpts & ~kSequence,
     .inputs = kFromSculpt,
     .bits = kNotOnPage,
     .help = "remesh a sculpt with even triangles of this edge length: world units, or % of the longest side",
     .rules = {{{[](const S& s) { return s.mesh.vertices.has_value(); },
                 " and --vertices both give a sculpt a new mesh: give one of the two"},
                {lacksCgal, kOfCgal}}}},
    {.name = "refine",
     .label = "Refine to an error of T, 0 to 1",
     .unit = "E",
     .value = {setRefine, withWord("auto", {.kind = ValueForm::kNumber, .low = 0.0001, .high = 1})},
     .group = kOfMesh,
     .commands = kSculpts & ~kSequence,
     .common = kBake,
     .inputs = kFromSculpt,
     .help = "split edges of a sculpt until blending lobes between vertices adds at most E to T (rms, 0 to 1), or auto: a tenth of the "
             "error of unblended lobes; --vertices is its budget",
     .rules = {{{[](const S& s) { return s.mesh.separate; },
                 " measures the whole sculpt: leave out --separate, or put each object in its own file"}}}},
    {.name = "repair",
     .unit = "LIST",
     .value = {setRepair, {.words = {{{"orient", 0}, {"fill", 1}, {"remesh", 2}}}, .shape = "W,…", .examples = "orient,fill remesh"}},
     .group = kOfMesh,
     .commands = kSculpts,
     .common = kBake,
     .inputs = kFromSculpt,
     .bits = kNotOnPage | kInBlendersPanel,
     .help = "repair a sculpt: any of orient, fill (holes), remesh; joined by commas",
     .rules = {{{[](const S& s) { return s.mesh.repair_remesh && s.mesh.vertices; },
                 " remesh and --vertices both give a sculpt a new mesh: give one of the two"},
                {lacksCgal, kOfCgal}}}},
    {.name = "close",
     .label = "Close open sculpts",
     .unit = "HOW",
     .value = choiceAt<kMesh, &M::close>({{"auto", CloseChoice::kAuto}, {"wrap", CloseChoice::kWrap}, {"reject", CloseChoice::kReject}}),
     .group = kOfMesh,
     .commands = kSculpts | kCheck,
     .common = kBake | kCheck,
     .inputs = kFromSculpt,
     .bits = kInBlendersPanel,
     .help = "how to close an open sculpt: auto, wrap (always), reject (an error)",
     .rules = {{{[](const S& s) { return s.mesh.close == CloseChoice::kWrap && !hasCgal(); },
                 " wrap needs CGAL: this binary was built with -DCLOUDBAKE_CGAL=OFF"}}}},
    {.name = "separate",
     .label = "Each object alone",
     .value = flagAt<kMesh, &M::separate>(),
     .group = kOfMesh,
     .commands = kBake | kBatch | kView,
     .inputs = kFromSculpt,
     .bits = kNotInBlender,
     .help = "bake every object of a sculpt as if it were alone",
     .rules = {{{[](const S& s) { return s.mesh.separate && s.lobe.harmonic_order > 0; },
                 " bakes lobes only: leave out --basis, or put each object in its own file"},
                {[](const S& s) { return s.mesh.separate && hasTarget(s); },
                 " cannot be combined with --target-error, which measures the whole sculpt"},
                {[](const S& s) { return s.mesh.separate && s.lobe.fit; },
                 " bakes mean lobes: leave out --lobe fit, or put each object in its own file"}}}},
    {.name = "inspect",
     .value = flagAt<kMesh, &M::inspect>(),
     .group = kOfMesh,
     .commands = kSculpts & ~(kView | kSequence),
     .inputs = kFromSculpt,
     .bits = kNotOnPage,
     .help = "also report self-intersections and shells inside others",
     .rules = {{{lacksCgal, kOfCgal}}}},

    {.name = "allow-outside",
     .label = "Files outside the folder",
     .value = flagAt<kSource, kRead, &ReadSettings::allow_outside>(),
     .group = kOfInput,
     .commands = kSculpts,
     .inputs = kFromSculpt,
     .bits = kOfInputFile | kNotInBlender,
     .help = "let a sculpt refer to files outside its own folder"},
    {.name = "scene-index",
     .label = "Scene of a glTF, number",
     .unit = "N",
     .value = numberAt<kSource, kRead, &ReadSettings::scene_index>(0),
     .group = kOfInput,
     .commands = kSculpts,
     .inputs = kFromSculpt,
     .bits = kOfInputFile | kNotInBlender,
     .help = "glTF: number of the scene to bake, from 0",
     .fallback = "the file's default scene"},
    {.name = "units",
     .label = "Metres per unit of the sculpt",
     .unit = "METRES",
     .value = numberAt<kSource, kRead, &ReadSettings::metres_per_unit>(kTiny, kHuge),
     .group = kOfInput,
     .commands = kSculpts,
     .common = kBake,
     .inputs = kFromSculpt,
     .bits = kOfInputFile | kNotInBlender,
     .help = "metres per unit of the sculpt",
     .fallback = "as the file"},
    {.name = "up",
     .label = "Up axis of the file",
     .unit = "AXIS",
     .value = choiceAt<kSource, kRead, &ReadSettings::up_axis>({{"x", UpAxis::kX}, {"y", UpAxis::kY}, {"z", UpAxis::kZ}}),
     .group = kOfInput,
     .commands = kSculpts,
     .common = kBake,
     .inputs = kFromSculpt | kFromVolume,
     .bits = kOfInputFile | kNotInBlender,
     .help = "up axis of the sculpt or volume: x, y, z",
     .fallback = "as the file; y of a VDB, which does not say it"},
    {.name = "grid",
     .unit = "NAME",
     .value = textAt<kSource, &SourceSettings::volume, &VdbSettings::grid>("density surface"),
     .group = kOfInput,
     .commands = kSculpts,
     .inputs = kFromVolume,
     .bits = kNotOnPage | kNotInBlender,
     .help = "VDB: the grid to read",
     .fallback = "surface, density, or the first"},
    {.name = "iso",
     .unit = "X",
     .value = numberAt<kSource, &SourceSettings::volume, &VdbSettings::iso>(-kHuge, kHuge),
     .group = kOfInput,
     .commands = kSculpts,
     .inputs = kFromVolume,
     .bits = kNotOnPage | kNotInBlender,
     .help = "VDB: value of a fog volume at the surface",
     .fallback = "5% of the mean value"},

    {.name = "uv-set",
     .label = "First of two UV sets, 0 to 6",
     .unit = "N",
     .value = numberAt<kOutput, kGltf, &GltfSettings::uv_set>(0, 6),
     .group = kOfGltf,
     .commands = kAssets,
     .bits = kInRecipe | kNotInBlender,
     .help = "first of the two UV sets, 0 to 6",
     .fallback = "lowest free"},
    {.name = "attribute",
     .label = "Also write _OCCLUSION",
     .value = flagAt<kOutput, kGltf, &GltfSettings::attribute>(),
     .group = kOfGltf,
     .commands = kAssets,
     .bits = kInRecipe | kNotInBlender,
     .help = "also write the vertex attribute _OCCLUSION"},
    {.name = "pack",
     .label = "Bytes of a lobe",
     .unit = "BYTES",
     .value = choiceAt<kOutput, kGltf, &GltfSettings::pack>({{"16", false}, {"8", true}}),
     .group = kOfGltf,
     .commands = kAssets,
     .common = kAssets,
     .bits = kInRecipe | kNotInBlender | kNotOnPage,
     .help = "bytes of a lobe: 16 (four floats), or 8, which packs vertices into 16, with a certificate that T changes by at most 1/255",
     .rules = {{{[](const S& s) { return s.output.gltf.pack && s.output.gltf.attribute; },
                 ": --attribute writes the lobes a second time, as floats: leave one of the two out"}}}},
    {.name = "pack-as",
     .unit = "FORM",
     .value = choiceAt<kOutput, kGltf, &GltfSettings::pack_form>(
         {{"list", PackForm::kList}, {"strip", PackForm::kStrip}, {"meshopt", PackForm::kMeshopt}}),
     .group = kOfGltf,
     .commands = kAssets,
     .bits = kInRecipe | kNotInBlender | kNotOnPage,
     .help = "packed: triangles as a list, as a strip (smaller, but not every engine reads it), or all by EXT_meshopt_compression",
     .rules = {{{[](const S& s) { return !s.output.gltf.pack; }, " needs --pack 8"}}}},
    {.name = "keep-alive-texture",
     .label = "Keep UV sets alive",
     .unit = "WHEN",
     .value = choiceAt<kOutput, kGltf, &GltfSettings::keep_alive_texture>(
         {{"auto", KeepAliveTexture::kAuto}, {"force", KeepAliveTexture::kForce}, {"off", KeepAliveTexture::kOff}}),
     .group = kOfGltf,
     .commands = kAssets,
     .bits = kInRecipe | kNotInBlender,
     .help = "bind a white texture, so that optimisers keep the UV sets: auto, force, off"},

    {.name = "blend",
     .unit = "W",
     .value = lengthAt<kField, &F::blend>(0, kHuge),
     .group = kOfGrowth,
     .commands = kGrows,
     .common = kGrow,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "width of the spheres' smooth union: world units, or % of the longest side",
     .fallback = "0"},
    {.name = "flat-base",
     .unit = "Y",
     .value = numberAt<kField, &F::flat_base>(-kHuge),
     .group = kOfGrowth,
     .commands = kGrows,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "height of a plane that cuts off the base of the cloud, world units"},
    {.name = "base-softness",
     .unit = "W",
     .value = lengthAt<kField, &F::base_softness>(0, kHuge),
     .group = kOfGrowth,
     .commands = kGrows,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "width over which the flat base rounds its rim: world units, or % of the longest side",
     .fallback = "as --blend"},
    {.name = "base-bumps",
     .unit = "A",
     .value = lengthAt<kField, &F::base_bumps>(0, kHuge),
     .group = kOfGrowth,
     .commands = kGrows,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "height of bumps that hang from the flat base: world units, or % of the longest side",
     .fallback = "0"},
    {.name = "base-bump-size",
     .unit = "W",
     .value = lengthAt<kField, &F::base_bump_size>(kTiny, kHuge),
     .group = kOfGrowth,
     .commands = kGrows,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "spacing of the bumps of the base: world units, or % of the longest side",
     .fallback = "5 x base-bumps"},
    {.name = "noise",
     .unit = "A",
     .value = lengthAt<kField, &F::noise>(0, kHuge),
     .group = kOfGrowth,
     .commands = kGrows,
     .common = kGrow,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "height of bumps on the surface: world units, or % of the longest side",
     .fallback = "0"},
    {.name = "noise-size",
     .unit = "W",
     .value = lengthAt<kField, &F::noise_size>(kTiny, kHuge),
     .group = kOfGrowth,
     .commands = kGrows,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "spacing of the largest bumps: world units, or % of the longest side",
     .fallback = "5 x noise (3 octaves)",
     .rules = {{{[](const S& s) { return !s.field.noise; }, " needs --noise, the height of the bumps"}}}},
    {.name = "noise-octaves",
     .unit = "N",
     .value = numberAt<kField, &F::noise_octaves>(1, 8),
     .group = kOfGrowth,
     .commands = kGrows,
     .inputs = kFromGrowth,
     .bits = kInRecipe,
     .help = "layers of bumps, each half the size and height of the one before",
     .fallback = "3, or as many as the voxels hold"},
    {.name = "from-spheres",
     .unit = "FILE",
     .value = sourceOf<SourceKind::kSpheres>("a.csv b.ply"),
     .group = kOfGrowth,
     .commands = kGrow | kMeasure,
     .common = kGrow,
     .help = "points and radii from a .ply or .csv instead of a preset",
     .files = kReads},
    {.name = "spheres",
     .unit = "FILE",
     .value = {setSpheres, {.examples = "a.csv b.ply"}},
     .group = kOfGrowth,
     .commands = kGrow,
     .help = "also write the points and radii, as .ply or .csv",
     .files = writes("")},
    {.name = "vdb",
     .unit = "FILE",
     .value = {setVdb, {.examples = "a.vdb b.VDB"}},
     .group = kOfGrowth,
     .commands = kGrow,
     .help = "also write the level set of the surface, as .vdb",
     .files = writes("")},
    {.name = "explain",
     .value = flagAt<kSource, &SourceSettings::explain>(),
     .group = kOfGrowth,
     .commands = kGrow,
     .help = "also report how the cloud grew: symbols per generation, points, radii, what was dropped"},

    {.name = "truth-vertices",
     .unit = "N",
     .value = numberAt<kJudge, &J::truth_vertices>(1, kMostInt),
     .group = kOfTruth,
     .commands = kMeasure | kBatch | kCheck,
     .common = kMeasure | kCheck,
     .help = "vertices to compute the truth for, evenly spread",
     .fallback = "2000; march, batch, check: 200"},
    {.name = "against",
     .unit = "FILE",
     .value = textAt<kJudge, &J::against>("a.glb b.glb"),
     .group = kOfTruth,
     .commands = kCheck,
     .common = kCheck,
     .help = "compare with this earlier asset, vertex by vertex, not with exact chords",
     .files = kReads},
    {.name = "certificate",
     .value = flagAt<kJudge, &J::certificate>(),
     .group = kOfTruth,
     .commands = kCheck,
     .common = kCheck,
     .help = "of a packed asset: prove its bound on the change of T from its integers, and nothing else"},
    {.name = "with-lattice",
     .unit = "FILE",
     .value = textAt<kJudge, &J::lattice>("a.json b.json"),
     .group = kOfTruth,
     .commands = kCheck,
     .common = kCheck,
     .help = "also judge this lattice of spherical harmonics, which --lattice wrote",
     .files = kReads},

    {.name = "sun",
     .unit = "AZ,EL",
     .value = anglesAt<&P::sun_azimuth_degrees, &P::sun_elevation_degrees>(),
     .group = kOfPicture,
     .commands = kDraws,
     .common = kDraws,
     .help = "azimuth (0 = behind the viewer, 90 = right) and elevation, degrees; 105,30 with --look plain and --compare"},
    {.name = "sun",
     .unit = "AZ,EL",
     .value = anglesAt<&P::sun_azimuth_degrees, &P::sun_elevation_degrees>(),
     .group = kOfPicture,
     .commands = kShadow,
     .common = kShadow,
     .help = "azimuth (0 = behind the viewer, 90 = right, as in preview) and elevation of the light, degrees"},
    {.name = "size",
     .unit = "N",
     .value = numberAt<&S::shadow, &ShadowPictureSettings::size>(6, 2048),
     .group = kOfPicture,
     .commands = kShadow,
     .common = kShadow,
     .help = "pixels to a side of the picture"},
    {.name = "extinction",
     .unit = "X",
     .value = numberAt<&S::shadow, &ShadowPictureSettings::extinction>(0, kHuge),
     .group = kOfPicture,
     .commands = kShadow,
     .common = kShadow,
     .help = "extinction per world unit",
     .fallback = "as the asset records it, else 7 / longest side"},
    {.name = "views",
     .unit = "N",
     .value = numberAt<&S::impostor, &ImpostorSettings::views>(2, 64),
     .group = kOfPicture,
     .commands = kImpostor,
     .common = kImpostor,
     .help = "the atlas has N x N views of the cloud from all sides; an odd N has views from the horizon"},
    {.name = "frame",
     .unit = "N",
     .value = numberAt<&S::impostor, &ImpostorSettings::frame>(kLeastFrame, 1024),
     .group = kOfPicture,
     .commands = kImpostor,
     .common = kImpostor,
     .help = "pixels to a side of a view",
     .rules = {{{[](const S& s) { return s.impostor.views * s.impostor.frame > kLargestAtlas; },
                 " times --views is more than 16384 pixels, the largest picture that GPUs take: give fewer of either"}}}},
    {.name = "of",
     .unit = "NAME",
     .value = choiceAt<&S::impostor, &ImpostorSettings::of>({{"volume", ImpostorOf::kVolume}, {"mesh", ImpostorOf::kMesh}}),
     .group = kOfPicture,
     .commands = kImpostor,
     .common = kImpostor,
     .help = "what is seen: the volume inside of the mesh, or the mesh itself, to take its place in the distance"},
    {.name = "half-lambert",
     .unit = "F",
     .value = numberAt<&S::impostor, &ImpostorSettings::half_lambert>(0, 1),
     .group = kOfPicture,
     .commands = kImpostor,
     .common = kImpostor,
     .help = "of a mesh: f of the factor lerp(f, 1, n.l/2 + 1/2) of its light; 0.3 in the painted look, 1 = none"},
    {.name = "measure",
     .value = flagAt<&S::impostor, &ImpostorSettings::measure>(),
     .group = kOfPicture,
     .commands = kImpostor,
     .common = kImpostor,
     .help = "compare pictures of 16 to 200 pixels with the volume, the mesh and six-way maps of the same bytes; takes minutes"},
    {.name = "six-way",
     .value = flagAt<&S::impostor, &ImpostorSettings::six_way>(),
     .group = kOfPicture,
     .commands = kImpostor,
     .common = kImpostor,
     .help = "also write six-way light maps of the same views, in Unity's layout"},
    {.name = "budget",
     .unit = "LIST",
     .value = {setBudget, {.shape = "KEY=X,…", .examples = "change=1 change=2,vertices=200000,bytes=8000000,draws=40"}},
     .group = kOfPicture,
     .commands = kPlan,
     .common = kPlan,
     .help = "what pictures may change by, in 1/255 (change), and what they may cost (vertices, bytes, draws), such as "
             "change=2,vertices=200000",
     .fallback = "change=2"},
    {.name = "hours",
     .unit = "LIST",
     .value = {setHours, {.shape = "X,…", .examples = "6,9,12 15"}},
     .group = kOfPicture,
     .commands = kPlan,
     .common = kPlan,
     .help = "hours of day that the plan is for, such as 7,12,17; the sun rises at 6 and is highest, as the scene says, at 12; "
             "without it, for the scene's sun"},
    {.name = "path",
     .unit = "PLACES",
     .value = {setPath, {.shape = "X,X,X:X,X,X", .examples = "0,2,30:0,2,-30 1,2,3:4,5,6"}},
     .group = kOfPicture,
     .commands = kPlan,
     .common = kPlan,
     .help = "places that the camera moves along, X,Y,Z:X,Y,Z and more; it looks to all sides; without it, the scene's "
             "camera",
     .rules = {{{[](const S& s) { return s.plan.region.has_value(); }, " and --region both place the camera: give one of the two"}}}},
    {.name = "region",
     .unit = "BOX",
     .value = {setRegion, {.shape = "X,X,X:X,X,X", .examples = "-30,1,-30:30,5,30 0,0,0:4,5,6"}},
     .group = kOfPicture,
     .commands = kPlan,
     .common = kPlan,
     .help = "box that the camera may be anywhere in, by its low and its high corner, X,Y,Z:X,Y,Z; it looks to all sides"},
    {.name = "measure",
     .value = flagAt<&S::plan, &PlanSettings::measure>(),
     .group = kOfPicture,
     .commands = kPlan,
     .common = kPlan,
     .help = "draw and compare all pictures of the plan, not only some of them"},
    {.name = "camera",
     .unit = "AZ,EL",
     .value = anglesAt<&P::camera_azimuth_degrees, &P::camera_elevation_degrees>(),
     .group = kOfPicture,
     .commands = kDraws,
     .common = kDraws,
     .help = "azimuth and elevation of the camera, degrees; 0,6 with --look plain and --compare"},
    {.name = "size",
     .unit = "WxH",
     .value = {setPictureSize, kSizeForm, pictureSizeText},
     .group = kOfPicture,
     .commands = kPreview,
     .common = kPreview,
     .help = "picture size, pixels"},
    {.name = "size",
     .unit = "WxH",
     .value = {setPageSize, kSizeForm},
     .group = kOfPicture,
     .commands = kView,
     .common = kView,
     .help = "picture size, pixels; without it the picture fills the window"},
    {.name = "fov",
     .unit = "DEG",
     .value = numberAt<kPicture, &P::field_of_view_degrees>(1, 150),
     .group = kOfPicture,
     .commands = kDraws,
     .common = kDraws,
     .help = "vertical field of view, degrees"},
    {.name = "look",
     .unit = "NAME",
     .value = choiceAt<kPicture, &P::plain>({{"painted", false}, {"plain", true}}),
     .group = kOfPicture,
     .commands = kDraws,
     .common = kDraws,
     .help = "painted (an image chain, as in games) or plain (the lobe formula alone)"},
    {.name = "time",
     .unit = "SECONDS",
     .value = numberAt<kPicture, &P::time_seconds>(0, 1e6),
     .group = kOfPicture,
     .commands = kDraws,
     .help = "time of the picture: of clouds that change, and in the painted look of swirls, wind and stars"},
    {.name = "exposure",
     .unit = "X",
     .value = numberAt<kPicture, &P::exposure>(kTiny, 1e6),
     .group = kOfPicture,
     .commands = kDraws,
     .common = kDraws,
     .help = "factor on the light, before tone mapping"},
    {.name = "lobes-only",
     .value = flagAt<kPicture, &P::lobes_only>(),
     .group = kOfPicture,
     .commands = kDraws,
     .help = "light by the lobes even if the asset has spherical harmonics"},
    {.name = "scene",
     .unit = "FILE",
     .value = textAt<&S::scene>("view.toml other.toml"),
     .group = kOfPicture,
     .commands = kDraws,
     .common = kDraws,
     .help = "draw a scene file (docs/previewer.md) instead of an asset",
     .rules = {{{isPlain, " draws the painted look: leave out --look plain"},
                {isComparison, kOfNoSheet},
                {[](const S& s) { return !s.source.input.empty(); },
                 " and an asset: give one of the two, because a scene names its own clouds"}}},
     .files = kReads},
    {.name = "scene",
     .unit = "FILE",
     .value = textAt<&S::scene>("view.toml other.toml"),
     .group = kOfPicture,
     .commands = kShadow,
     .common = kShadow,
     .help = "draw the shadow of all mesh clouds of a scene file on what is below them",
     .rules = {{{[](const S& s) { return !s.source.input.empty(); },
                 " and an asset: give one of the two, because a scene names its own clouds"}}},
     .files = kReads},
    {.name = "scene",
     .unit = "FILE",
     .value = textAt<&S::scene>("view.toml other.toml"),
     .group = kOfPicture,
     .commands = kShader,
     .common = kShader,
     .help = "scene file: its light, fog and image chain become the defaults of the kit",
     .files = kReads},
    {.name = "quality",
     .unit = "NAME",
     .value = choiceAt<kPicture, &P::draft>({{"final", false}, {"draft", true}}),
     .group = kOfPicture,
     .commands = kPreview,
     .common = kPreview,
     .help = "scenes: final or draft (faster, with fewer samples and coarser steps)"},
    {.name = "channels",
     .unit = "STEM",
     .value = textAt<kPicture, &P::channels>("c c.exr"),
     .group = kOfPicture,
     .commands = kPreview,
     .help = "painted: also write STEM_sun.png, _sky.png, _opacity.png and _depth.png; for NAME.exr all four as floats",
     .rules = {{{isPlain, kOfPainted}, {moves, kOfOnePicture}, {isComparison, kOfNoSheet}}},
     .files = {FileUse::kStem, ".exr", "_sun.png _sky.png _opacity.png _depth.png"}},
    {.name = "steps",
     .unit = "STEM",
     .value = textAt<kPicture, &P::steps>(),
     .group = kOfPicture,
     .commands = kPreview,
     .help = "painted: also write the picture after each step: STEM_1_drawn.png to STEM_5_distorted.png",
     .rules = {{{isPlain, kOfPainted}, {moves, kOfOnePicture}, {isComparison, kOfNoSheet}}},
     .files = {FileUse::kStem, "",
               "_1_drawn.png _2_downsampled.png _2_depth_spread.png _3_blurred.png _3_softened.png _4_depth_blurred.png _4_distorted.png "
               "_5_distorted.png _5_eroded.png"}},

    {.name = "turntable",
     .unit = "N",
     .value = framesOf<Motion::kTurntable>(),
     .group = kOfMotion,
     .commands = kPreview,
     .common = kPreview,
     .help = "draw a turn around the cloud in N frames, as animated PNG, while what moves by itself goes on",
     .rules = {{{isComparison, kOfNoSheet}}}},
    {.name = "sun-sweep",
     .unit = "N",
     .value = framesOf<Motion::kSunSweep>(),
     .group = kOfMotion,
     .commands = kPreview,
     .common = kPreview,
     .help = "draw a day whose sun culminates at --sun in N frames, as animated PNG",
     .rules = {{{isComparison, kOfNoSheet}}}},
    {.name = "animate",
     .unit = "N",
     .value = framesOf<Motion::kAnimate>(),
     .group = kOfMotion,
     .commands = kPreview,
     .common = kPreview,
     .help = "draw what moves by itself in N frames, as animated PNG: swirls alone until they repeat, else frame i after i/fps seconds",
     .rules = {{{isComparison, kOfNoSheet}}}},
    {.name = "fps",
     .unit = "X",
     .value = numberAt<kPicture, &P::frames_per_second>(0.1, 100),
     .group = kOfMotion,
     .commands = kPreview,
     .help = "frames per second of an animated PNG"},
    {.name = "frames",
     .unit = "STEM",
     .value = textAt<kPicture, &P::frames>(),
     .group = kOfMotion,
     .commands = kPreview,
     .help = "also write every frame: STEM_0001.png and so on",
     .rules = {{{[](const S& s) { return !moves(s); }, " needs --turntable, --sun-sweep or --animate"}}},
     .files = {FileUse::kStem, "", "_[0-9][0-9][0-9][0-9].png _[0-9][0-9][0-9][0-9][0-9].png"}},

    {.name = "fps",
     .unit = "X",
     .value = numberAt<&S::sequence, &SequenceSettings::frames_per_second>(0.1, 1000),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .help = "frames per second; without it 24, or with --frame-count those that keep the speed of an animation"},
    {.name = "change",
     .unit = "X",
     .value = numberAt<&S::sequence, &SequenceSettings::change>(0, 255),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .help = "how much blending between keys may change a picture: rms of its values of 0 to 255; 0 keeps every frame"},
    {.name = "pixels",
     .unit = "N",
     .value = {setPixels, {.kind = ValueForm::kWhole, .low = 32, .high = 2048, .examples = "64 96"}, pixelsText},
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .help = "how many pixels the longest side covers in that picture, a multiple of 32"},
    {.name = "detail",
     .unit = "X|P%",
     .value = lengthAt<&S::sequence, &SequenceSettings::detail>(0, kHuge),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .help = "gaps, holes and threads narrower than twice this are left out of the mesh, so that it can follow the cloud",
     .fallback = "2%"},
    {.name = "fade",
     .unit = "N",
     .value = numberAt<&S::sequence, &SequenceSettings::fade>(1, 1000),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .help = "frames over which a mesh that can no longer follow the cloud fades into the next one"},
    {.name = "loop",
     .value = flagAt<&S::sequence, &SequenceSettings::loops>(),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .help = "fade the last frames into the first ones, so that the sequence can repeat"},
    {.name = "vary",
     .unit = "OPTION=A:B",
     .value = {setVaried, {.shape = "W=X:X,…", .examples = "size=0.5:1 generations=1:5,size=1:2"}},
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .inputs = kFromGrowth,
     .bits = kRepeats,
     .help = "of a preset or recipe: an option of grow, or a variable of the recipe, that changes from A to B over the frames; may be "
             "given several times"},
    {.name = "frame-count",
     .unit = "N",
     .value = numberAt<&S::sequence, &SequenceSettings::frames>(2, 10000),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .inputs = kFromGrowth | kFromSculpt,
     .help = "number of frames, of a preset or recipe, or of an animation from its start to its end",
     .fallback = "60; of an animation, as --fps makes"},
    {.name = "animation",
     .unit = "NAME",
     .value = textAt<&S::sequence, &SequenceSettings::animation>("Walk Run"),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .inputs = kFromSculpt,
     .help = "which animation of a glTF or FBX becomes the frames; without it, the first one"},
    {.name = "as",
     .unit = "NAME",
     .value = choiceAt<&S::sequence, &SequenceSettings::output>(
         {{"morph", SequenceOutput::kMorph}, {"picture", SequenceOutput::kPicture}, {"keys", SequenceOutput::kKeys}}),
     .group = kOfSequence,
     .commands = kSequence,
     .common = kSequence,
     .help = "what is written: a GLB with its keys as morph targets (morph), or in a picture that a vertex shader reads (picture), or a "
             "GLB for each key (keys)"},

    {.name = "compare",
     .value = flagAt<kPicture, &P::compare>(),
     .group = kOfSheet,
     .commands = kDraws,
     .common = kDraws,
     .help = "draw a sheet that compares volume, truth, lobe, Lambert and the painted look; a page gets the other kind of lobe, and "
             "harmonics"},
    {.name = "suns",
     .unit = "N",
     .value = numberAt<kPicture, &P::suns>(1, 10000),
     .group = kOfSheet,
     .commands = kPreview,
     .help = "with --compare: figures for N suns above the horizon, or on the arc of the fit",
     .rules = {{{isNoComparison, kOfComparison}}}},
    {.name = "view-extinction",
     .unit = "X",
     .value = kViewExtinction,
     .group = kOfSheet,
     .commands = kPreview,
     .help = "with --compare: extinction along the view, as a factor of that towards the light",
     .fallback = "as fitted, else 1",
     .rules = {{{isNoComparison, kOfComparison}}}},
    {.name = "octaves",
     .unit = "N[,A,B]",
     .value = kOctaves,
     .group = kOfSheet,
     .commands = kPreview,
     .help = "with --compare: light that the volume scatters again, as N octaves; 6 is near to many",
     .fallback = "as fitted, else 0",
     .rules = {{{isNoComparison, kOfComparison}}}},
    {.name = "phase",
     .unit = "G",
     .value = kPhase,
     .group = kOfSheet,
     .commands = kPreview,
     .help = "with --compare: asymmetry of the volume's scattering, above 0 forwards",
     .fallback = "as fitted, else 0",
     .rules = {{{isNoComparison, kOfComparison}}}},

    {.name = "serve",
     .unit = "[PORT]",
     .value = numberAt<&S::serve, &ServeSettings::port>(0, 65535),
     .group = kOfPage,
     .commands = kView,
     .common = kView,
     .help = "show the page at http://127.0.0.1:PORT/, for this machine only, until Ctrl-C, instead of writing it; 0 takes any free port",
     .fallback = "8642"},
    {.name = "watch",
     .unit = "FILE",
     .value = textAt<&S::serve, &ServeSettings::watch>("a.obj b.obj"),
     .group = kOfPage,
     .commands = kView,
     .common = kView,
     .help = "serve a sculpt, volume, recipe (.toml) or asset, and bake it again in memory whenever it is saved; takes the options of bake "
             "too",
     .rules = {{{isComparison, " shows a single bake: leave out --compare"}}},
     .files = kReads},

    {.name = "input-list",
     .unit = "FILE",
     .value = textAt<kBatchOf, &BatchSettings::input_list>("list.txt -"),
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "file with a sculpt's path per line, instead of a manifest; - reads stdin",
     .files = kReads},
    {.name = "name",
     .unit = "TEMPLATE",
     .value = textAt<kBatchOf, &BatchSettings::name>("{stem}.glb {stem}_{ext}.glb"),
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "output names; words: {stem}, {ext}, {folder}, {seed}",
     .fallback = "{folder}/{stem}.glb"},
    {.name = "init",
     .value = flagAt<kBatchOf, &BatchSettings::init>(),
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "write a commented manifest to MANIFEST.toml"},
    {.name = "prune",
     .value = flagAt<kBatchOf, &BatchSettings::prune>(),
     .group = kOfBatch,
     .commands = kBatch,
     .help = "remove outputs of earlier batches that are no longer in the batch",
     .rules = {{{[](const S& s) { return s.batch.shards > 0; }, " needs the whole batch: leave out --shard"}}}},
    {.name = "fail-fast",
     .value = flagAt<kBatchOf, &BatchSettings::fail_fast>(),
     .group = kOfBatch,
     .commands = kBatch,
     .help = "start nothing new after a failure"},
    {.name = "cache",
     .unit = "DIR",
     .value = textAt<kBatchOf, &BatchSettings::cache>("kept other"),
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "folder that keeps bakes by the hash of their inputs; machines may share it"},
    {.name = "shard",
     .unit = "I/N",
     .value = {setShard, {.shape = "N/N", .examples = "2/3 1/3"}},
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "bake only part I of N parts of about equal cost"},
    {.name = "merge",
     .value = flagAt<kBatchOf, &BatchSettings::merge>(),
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "merge the reports of shards, given instead of a manifest"},
    {.name = "junit",
     .unit = "FILE",
     .value = textAt<kBatchOf, &BatchSettings::junit>("a.xml b.xml"),
     .group = kOfBatch,
     .commands = kBatch,
     .help = "write the report as JUnit XML",
     .files = writes(".xml")},
    {.name = "html",
     .unit = "FILE",
     .value = textAt<kBatchOf, &BatchSettings::html>("a.html b.html"),
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "write the report as a page with pictures",
     .files = writes(".html .htm")},
    {.name = "live",
     .value = flagAt<kBatchOf, &BatchSettings::live>(),
     .group = kOfBatch,
     .commands = kBatch,
     .common = kBatch,
     .help = "with --html: also write a live view of every asset beside it, NAME.html, and link its picture to it",
     .rules = {{{[](const S& s) { return s.batch.live && !s.batch.html; },
                 " needs --html FILE: the report that links to the live views"}}}},
    {.name = "depfile",
     .unit = "FILE",
     .value = textAt<kBatchOf, &BatchSettings::depfile>("a.d b.d"),
     .group = kOfBatch,
     .commands = kBatch,
     .help = "write the list of files that the batch reads, for Make and Ninja",
     .files = writes(".d")},
    {.name = "depfile-target",
     .unit = "PATH",
     .value = textAt<kBatchOf, &BatchSettings::depfile_target>(),
     .group = kOfBatch,
     .commands = kBatch,
     .help = "target of the depfile",
     .fallback = "the output folder"},

    {.name = "max-angle",
     .unit = "DEG",
     .value = numberAt<kJudge, kErrors, &ErrorBounds::angle_degrees>(0, 180),
     .group = kBounds,
     .commands = kBatch | kCheck,
     .common = kBatch | kCheck,
     .help = "fail if the rms error of the direction is larger; not for fitted lobes"},
    {.name = "max-transmittance-rms",
     .unit = "X",
     .value = numberAt<kJudge, kErrors, &ErrorBounds::transmittance_rms>(0, 1),
     .group = kBounds,
     .commands = kBatch | kCheck,
     .common = kCheck,
     .help = "fail if the rms error of the transmittance is larger, 0 to 1"},
    {.name = "max-surface-rms",
     .unit = "X",
     .value = numberAt<kJudge, kErrors, &ErrorBounds::surface_rms>(0, 1),
     .group = kBounds,
     .commands = kBatch | kCheck,
     .help = "fail if the rms error of the transmittance over the surface is larger, 0 to 1",
     .rules = {{{[](const S& s) { return s.judge.against.has_value(); }, " is measured against exact chords: leave out --against"}}}},

    {.name = "dry-run",
     .value = {setDryRun, {.kind = ValueForm::kFlag}},
     .group = kGeneral,
     .commands = kGrow | kBatch,
     .common = kGrow | kBatch,
     .bits = kOfRun | kOfOutputFiles | kNotOnPage,
     .help = "write nothing: grow stops after the spheres, batch lists its work"},
    {.name = "force",
     .value = flagAt<kRun, &RunSettings::force>(),
     .group = kGeneral,
     .commands = kGrow | kBake | kPreview | kMeasure | kShader | kShadow | kImpostor | kPlan | kSequence | kBatch,
     .common = kBatch | kShader,
     .bits = kOfRun | kOfOutputFiles | kNotOnPage,
     .help = "also replace files of other programs where cloudbake makes the names; batch also bakes what is up to date"},
    {.name = "threads",
     .unit = "N",
     .value = numberAt<kRun, &RunSettings::threads>(1, 4096),
     .group = kGeneral,
     .commands = kAll,
     .common = kMeasure | kBatch,
     .bits = kOfRun | kNotOnPage,
     .help = "number of threads; it does not change the result",
     .fallback = "all"},
    {.name = "memory",
     .label = "Memory at most, such as 8G",
     .unit = "SIZE",
     .value = {setMemory, {.examples = "8G 500M"}},
     .group = kGeneral,
     .commands = kAll | kShader,
     .common = kBatch,
     .bits = kOfRun,
     .help = "most memory that the run may take, such as 8G; more is refused before it is taken",
     .fallback = "3/4 of what is free"},
    {.name = "strict",
     .label = "Warnings are errors",
     .value = flagAt<kRun, &RunSettings::strict>(),
     .group = kGeneral,
     .commands = kAll | kShader,
     .common = kGrow | kBake | kCheck,
     .bits = kInBlendersPanel,
     .help = "treat warnings as errors (exit 3) and write nothing"},
    {.name = "json",
     .unit = "FILE",
     .value = textAt<kRun, &RunSettings::json>("a.json b.json"),
     .group = kGeneral,
     .commands = kAll | kShader,
     .common = kAll | kShader,
     .bits = kOfRun | kNotInBlender,
     .help = "write the report, or the error, as JSON",
     .files = writes(".json")},

    {.name = "rules",
     .unit = "FILE",
     .value = sourceOf<SourceKind::kRules>("a.txt b.txt"),
     .group = kRules,
     .commands = kGrow | kMeasure,
     .common = kGrow,
     .help = "a plain list of rules instead of a preset",
     .files = kReads},
    {.name = "variable",
     .unit = "NAME=X",
     .value = {setRecipe, {.shape = "W=X,…", .examples = "b=2 c=0.5"}},
     .group = kRules,
     .commands = kGrows,
     .inputs = kFromRules,
     .bits = kRepeats,
     .help = "sets a variable of the expressions, such as b, c, d; may be given several times"},
};

// The option of a key of the recipe.
Option recipeOption(const RecipeKey& key) {
  static std::deque<std::string> names;
  std::string& name = names.emplace_back(key.name);
  std::replace(name.begin(), name.end(), '_', '-');
  const std::string_view table = key.table;
  return {.name = name.c_str(),
          .unit = key.unit,
          .value = {setRecipe, key.form},
          .group = table == "turtle"    ? kTurtle
                   : table == "spheres" ? kSpheres
                                        : kRules,
          .commands = kGrows,
          .common = key.is_common ? unsigned(kGrow) : 0,
          .inputs = kFromRules,
          .help = key.help};
}

}  // namespace

std::string groupOf(const Option& option, Command command) {
  return std::string(option.group) + (command == kView && needsWatch(option) ? " (with --watch)" : "");
}

std::string defaultOf(const Option& option) {
  return *option.fallback || !option.value.initial ? option.fallback : option.value.initial(Settings(), option);
}

bool isVdbFile(const std::filesystem::path& file) { return lowerCase(file.extension().string()) == ".vdb"; }

std::span<const Option> optionTable() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all(std::begin(kOptions), std::end(kOptions));
    for (const RecipeKey& key : recipeKeys())
      if (*key.unit) all.push_back(recipeOption(key));
    return all;
  }();
  return table;
}

const Option* findOption(std::string_view name, Command command) {
  std::string dashed(name);
  std::replace(dashed.begin(), dashed.end(), '_', '-');
  for (const Option& option : optionTable())
    if (dashed == option.name && (option.commands & command)) return &option;
  return nullptr;
}

const Option* findAssetOption(std::string_view name) {
  const Option* option = findOption(name, kBatch);
  return option && (option->commands & (kGrow | kBake)) && !(option->bits & kOfRun) ? option : nullptr;
}

bool isGiven(std::span<const Given> given, std::string_view name) {
  return std::any_of(given.begin(), given.end(), [&](const Given& one) { return name == one.option->name; });
}

std::vector<std::string> optionChoices(const Option& option) {
  const ValueForm& form = option.value.form;
  if (form.kind == ValueForm::kFlag && *option.unit) return {"true", "false"};
  std::vector<std::string> choices;
  for (const auto& [text, value] : form.words)
    if (form.kind == ValueForm::kChoice && text) choices.emplace_back(text);
  return choices;
}

}  // namespace cloudbake
