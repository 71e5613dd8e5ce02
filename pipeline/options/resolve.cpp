#include "pipeline/options/resolve.h"

#include <algorithm>

#include "core/error.h"
#include "pipeline/options/presets.h"
#include "pipeline/options/scene_needs.h"

namespace cloudbake {

namespace {

// Throws an error that names the place where the option was given.
[[noreturn]] void refuseAt(const Given& given, const std::string& message) {
  if (given.file.empty()) throw UsageError(message);
  throw InputError(given.file, given.line, given.column, message);
}

// The options in order, with every shorthand replaced by the options that it stands for.
std::vector<Given> expanded(std::span<const Given> given) {
  std::vector<Given> all;
  for (const Given& one : given) {
    if (!*one.option->stands_for) {
      all.push_back(one);
      continue;
    }
    if (one.value != "true" && one.value != "false")
      refuseAt(one, "--" + std::string(one.option->name) + ": '" + one.value + "' is not true or false");
    if (one.value == "false") continue;
    const std::string list = one.option->stands_for;
    for (size_t begin = 0; begin < list.size();) {
      const size_t end = std::min(list.find(' ', begin), list.size()), equals = list.find('=', begin);
      Given part = one;
      part.option = findOption(list.substr(begin, equals - begin), kBake);
      part.value = list.substr(equals + 1, end - equals - 1);
      all.push_back(std::move(part));
      begin = end + 1;
    }
  }
  return all;
}

void apply(Settings& settings, const Given& given) {
  try {
    given.option->value.set(settings, *given.option, given.value);
  } catch (const UsageError& error) {
    refuseAt(given, error.message);
  }
}

// Lobes are fitted to the volume, with a search of k and b, where that can be done and nothing else is asked for.
void chooseLobe(std::span<const Given> given, bool separate, LobeSettings& lobe) {
  const bool is_sweep = lobe.bake.method == Method::kSweep;
  if (!isGiven(given, "lobe")) lobe.fit = is_sweep && !separate;
  if (!isGiven(given, "fit-to")) lobe.fit_to_volume = is_sweep && lobe.fit;
  if (!lobe.fit_to_volume) return;
  lobe.fit_exponent = lobe.fit_exponent || !lobe.exponent;
  lobe.fit_bias = lobe.fit_bias || !lobe.bias;
}

// A scene asks for an error of T of one step of 8 bits, and for lobes that are fitted for its sun. Explicit options take precedence.
void takeSceneNeeds(const SceneNeeds& scene, std::span<const Given> given, LobeSettings& lobe) {
  constexpr double kEightBitStep = 1.0 / 255;
  const bool chosen_by_hand = isGiven(given, "rays") || isGiven(given, "bake-voxels") || lobe.bake.method == Method::kRays;
  if (!lobe.target_error && !chosen_by_hand) lobe.target_error = TargetError{kEightBitStep, true};
  if (lobe.fit && !lobe.sun_arc) lobe.sun_arc = scene.sun_arc;
  if (!lobe.fit_to_volume) return;
  if (!lobe.volume.view_extinction) lobe.volume.view_extinction = scene.volume.view_extinction;
  if (!lobe.volume.octaves) lobe.volume.octaves = scene.volume.octaves;
  if (!lobe.volume.asymmetry) lobe.volume.asymmetry = scene.volume.asymmetry;
}

// Whatever takes memory knows how much the run may take.
void passMemoryLimit(Settings& settings) {
  const uint64_t limit = settings.run.memory.value_or(settings.source.memory_limit);
  settings.source.memory_limit = settings.source.read.memory_limit = settings.source.volume.memory_limit = limit;
  settings.mesh.memory_limit = settings.field.memory_limit = settings.lobe.memory_limit = limit;
  settings.picture.memory_limit = settings.judge.memory_limit = limit;
}

}  // namespace

const char* kindText(SourceKind kind) {
  switch (inputBit(kind)) {
    case kFromRules: return "a grown cloud";
    case kFromSpheres: return "a file of spheres";
    case kFromVolume: return "a VDB";
    default: return "a sculpt";
  }
}

SourceKind sourceKindOf(const std::filesystem::path& input) {
  if (findPreset(input.string())) return SourceKind::kPreset;
  if (input.extension() == ".toml") return SourceKind::kRecipe;
  return isVdbFile(input) ? SourceKind::kVolume : SourceKind::kSculpt;
}

PictureSettings resolvePicture(const PictureSettings& base, std::span<const Given> given) {
  Settings settings;
  settings.picture = base;
  for (const Given& one : expanded(given)) apply(settings, one);
  return settings.picture;
}

void useView(const ViewAngles& angles, std::span<const Given> given, PictureSettings& picture) {
  if (!isGiven(given, "sun")) picture.sun_azimuth_degrees = angles.sun_azimuth, picture.sun_elevation_degrees = angles.sun_elevation;
  if (!isGiven(given, "camera"))
    picture.camera_azimuth_degrees = angles.camera_azimuth, picture.camera_elevation_degrees = angles.camera_elevation;
}

SourceSettings sourceOfFile(const std::filesystem::path& file) {
  SourceSettings source;
  source.memory_limit = defaultMemoryLimit();
  source.input = file;
  source.kind = isVdbFile(file) ? SourceKind::kVolume : SourceKind::kSculpt;
  return source;
}

std::vector<Given> givenBy(std::span<const std::pair<std::string, std::string>> options, Command command) {
  std::vector<Given> given;
  for (const auto& [name, value] : options) {
    const Option* option = findOption(name, command);
    if (!option || option->files.kind != FileUse::kNone)
      throw UsageError("unknown option '" + name + "': `cloudbake " + (command == kGrow ? "grow" : "bake") + " --help-all` lists them");
    given.push_back({option, value, "", 0, 0});
  }
  return given;
}

Settings resolve(const SourceSettings& source, std::span<const Given> given, const std::optional<SceneNeeds>& scene) {
  const std::vector<Given> all = expanded(given);
  Settings settings;
  settings.source = source;
  for (const Given& one : all) apply(settings, one);
  if (settings.picture.plain || settings.picture.compare) useView(kPlainView, all, settings.picture);
  BakeSettings& bake = settings.lobe.bake;
  if (!isGiven(all, "sampler") && bake.method == Method::kSweep) bake.sampler = Sampler::kFibonacci;
  settings.field.noise_seed = bake.seed;
  chooseLobe(all, settings.mesh.separate, settings.lobe);
  if (scene) takeSceneNeeds(*scene, all, settings.lobe);
  passMemoryLimit(settings);

  for (const Given& one : all) {
    for (const OptionRule& rule : one.option->rules)
      if (rule.broken && rule.broken(settings)) refuseAt(one, "--" + std::string(one.option->name) + rule.message);
    if (!(one.option->inputs & inputBit(settings.source.kind)))
      refuseAt(one, "--" + std::string(one.option->name) + " does not apply to " + kindText(settings.source.kind) + ": leave it out");
  }
  return settings;
}

}  // namespace cloudbake
