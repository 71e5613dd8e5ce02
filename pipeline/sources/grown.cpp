#include "pipeline/sources/grown.h"

#include <algorithm>

#include "bake/field/level_set.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "core/error.h"
#include "core/memory_budget.h"
#include "io/file/write_file.h"
#include "io/volume/spheres.h"
#include "pipeline/fields/fields.h"
#include "pipeline/lobes/parameters.h"
#include "pipeline/options/presets.h"

namespace cloudbake {

namespace {

GrownSource sourceOfRecipe(CloudRecipe recipe, const std::filesystem::path& file, std::string bytes) {
  GrownSource source;
  source.file = recipe.grammar.file;
  source.name = file.stem().string();
  source.bytes = std::move(bytes);
  source.given.push_back({findOption("seed", kGrow), std::to_string(recipe.derive.seed), source.file, 0, 0});
  for (const auto& [key, value, line] : recipe.bake_options) {
    const Option* option = findOption(key, kGrow);
    if (!option || !(option->bits & kInRecipe))
      throw InputError(source.file, line, "unknown key '" + key + "' in [bake]: `cloudbake grow --help-all` lists the options");
    source.given.push_back({option, value, source.file, line, 0});
  }
  for (const auto& [key, value, line] : recipe.sequence_options) {
    const Option* option = findOption(key, kSequence);
    if (!option || !isOfSequence(*option))
      throw InputError(source.file, line, "unknown key '" + key + "' in [sequence]: `cloudbake sequence --help` lists the options");
    source.of_sequence.push_back({option, value, source.file, line, 0});
  }
  source.recipe = std::move(recipe);
  return source;
}

void warnOfParts(const GrownSource& source, Warnings& warnings) {
  const std::vector<int> parts = findParts(source.spheres);
  if (const int count = *std::max_element(parts.begin(), parts.end()) + 1; count > 1)
    warnings.add(WarningKind::kGrammar,
                 source.file + ": the cloud has " + std::to_string(count) + " separate parts: larger spheres would join them");
}

std::vector<Sphere> spheresOf(GrownSource& source, const Settings& settings, BakeReport& report) {
  GrowthSummary* summary = settings.source.explain || settings.source.spheres_only ? &report.growth.emplace() : nullptr;
  if (source.recipe) source.recipe->derive.memory_limit = source.recipe->turtle.memory_limit = settings.source.memory_limit;
  if (source.recipe) return growSpheres(*source.recipe, settings.lobe.bake.seed, report.warnings, summary);
  warnOfParts(source, report.warnings);
  return source.spheres;
}

// The command line alone does not know what the recipe says, so these rules are held here.
void requireBase(const GrownSource& source, const FieldSettings& field) {
  const auto refuse = [&](const char* option, const char* missing) {
    throw InputError(source.file, std::string(option) + " needs " + missing);
  };
  if (field.base_softness && !field.flat_base) refuse("base-softness", "flat-base, the height of the base");
  if (field.base_bumps && !field.flat_base) refuse("base-bumps", "flat-base, the height of the base");
  if (field.base_bump_size && !field.base_bumps) refuse("base-bump-size", "base-bumps, their height");
}

// The ratio of the surface's length to that of the domain along each axis; 1 if the surface fits.
Double3 overshoot(const SurfaceMesh& surface, const Double3& domain) {
  const Vec3 size = boundingBox(surface).size();
  const auto excess = [](double length, double allowed) { return allowed > 0 ? std::max(1.0, length / allowed) : 1.0; };
  return {excess(size.x, domain.x), excess(size.y, domain.y), excess(size.z, domain.z)};
}

void growSurface(Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, BakeReport& report, Stopwatch& watch) {
  if (!cloud.level_set) {
    watch.announce(levelSetWork(cloud.spheres, settings));
    cloud.level_set = levelSetOf(cloud, settings, Lattice::kSurface, report.warnings);
  }
  watch.lap(report.seconds, "level set");
  cloud.surface = meshFromLevelSet(*cloud.level_set, {vertices}, report.warnings);
  requireUsableSize(boundingBox(cloud.surface));
  watch.lap(report.seconds, "surface");
}

// Grows the spheres and their surface. A smooth union and noise extend beyond the spheres, so with a domain the cloud is grown again until
// the surface fits.
Cloud growShape(GrownSource& source, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  constexpr int kAttempts = 4;
  constexpr double kSlack = 1.001;
  const Warnings before = report.warnings;
  const Double3 domain = source.recipe ? source.recipe->spheres.domain.value_or(Double3{}) : Double3{};
  Cloud cloud;
  for (int attempt = 1;; ++attempt) {
    report.warnings = before;
    cloud.level_set.reset();
    cloud.spheres = spheresOf(source, settings, report);
    watch.lap(report.seconds, "grow");
    if (settings.source.spheres_only) return cloud;
    growSurface(cloud, settings.field, settings.mesh.vertices, report, watch);
    const Double3 over = overshoot(cloud.surface, domain);
    if (std::max({over.x, over.y, over.z}) <= kSlack || attempt == kAttempts) return cloud;
    Double3& fitted = *source.recipe->spheres.domain;
    fitted = {fitted.x / over.x, fitted.y / over.y, fitted.z / over.z};
  }
}

}  // namespace

GrownSource readGrownSource(const SourceSettings& source) {
  const std::filesystem::path& file = source.input;
  const std::string name = file.string();
  if (source.kind == SourceKind::kPreset) {
    const auto preset = findPreset(name);
    if (!preset) throw InputError(name, "neither a preset nor a .toml file: the presets are " + presetNames());
    return sourceOfRecipe(parseRecipe(*preset, "preset " + name), file, *preset);
  }
  if (source.kind == SourceKind::kSpheres) {
    sphereFormatOf(file);  // a wrong name is reported before the file is read
    GrownSource spheres;
    requireMemoryForFile(file, source.memory_limit);
    spheres.bytes = source.read.read_file(file);
    spheres.spheres = decodeSpheres(file, spheres.bytes);
    spheres.file = name;
    spheres.name = file.stem().string();
    return spheres;
  }
  const std::string bytes = source.read.read_file(file);
  return sourceOfRecipe(source.kind == SourceKind::kRules ? parseRules(bytes, name) : parseRecipe(bytes, name), file, bytes);
}

Cloud growCloud(GrownSource source, const Settings& settings, const std::optional<SceneNeeds>& scene, BakeReport& report,
                Stopwatch& watch) {
  report.input = settings.source.input.string();
  if (source.recipe) {
    for (const auto& [key, value] : settings.source.recipe_keys) {
      setRecipeKey(*source.recipe, key, value);
      source.bytes += "\n--" + key + "=" + value;
    }
    source.recipe->spheres.floor = settings.field.flat_base;
  }
  report.info.input_hash = hashBytes(source.bytes);
  requireBase(source, settings.field);

  const auto grow = [&] {
    Cloud cloud = growShape(source, settings, report, watch);
    if (settings.source.spheres_only) return cloud;
    bool has_budget = settings.mesh.vertices.has_value();
    if (const size_t budget = scene && !has_budget ? vertexBudget(*scene, cloud.surface) : SIZE_MAX;
        budget < cloud.surface.positions.size()) {
      has_budget = true;
      growSurface(cloud, settings.field, budget, report, watch);
    }
    const FieldSettings& field = settings.field;
    cloud.exact_spheres = field.blend.value == 0 && (!field.noise || field.noise->value == 0) && !field.flat_base && !has_budget;
    cloud.closed = findDefects(cloud.surface).unmatched_edges == 0;
    cloud.sculpt = sculptOf(source.name, cloud.surface);
    return cloud;
  };
  return namingFile(source.file, [&] { return inStage("growing this cloud", "use fewer --generations or --voxels", grow); });
}

}  // namespace cloudbake
