#include "pipeline/sources/grown.h"

#include <algorithm>

#include "pipeline/sources/presets.h"
#include "pipeline/target.h"
#include "bake/field/level_set.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "io/report/report.h"
#include "io/volume/spheres.h"
#include "io/file/write_file.h"
#include "lsystem/recipe.h"

namespace cloudbake {

namespace {

// What is grown: rules, or spheres as they are.
struct CloudSource {
  std::optional<CloudRecipe> recipe;
  std::vector<Sphere> spheres;
  std::string file, name, bytes;
};

CloudSource sourceOfRecipe(CloudRecipe recipe, const std::filesystem::path& file, std::string bytes) {
  const std::string named = recipe.grammar.file;
  return {std::move(recipe), {}, named, file.stem().string(), std::move(bytes)};
}

CloudSource findSource(const Settings& settings) {
  if (int(!settings.input.empty()) + int(settings.rules.has_value()) + int(settings.from_spheres.has_value()) > 1)
    throw UsageError("a preset or recipe, --rules and --from-spheres are different clouds: give one of them");
  if (settings.from_spheres) {
    if (!settings.recipe_keys.empty())
      throw UsageError("--" + settings.recipe_keys.front().first +
                       " is an option of a recipe: --from-spheres takes the spheres as they are");
    const std::filesystem::path& file = *settings.from_spheres;
    sphereFormatOf(file);  // a wrong name is told first
    const std::string bytes = readFileBytes(file);
    return {std::nullopt, decodeSpheres(file, bytes), file.string(), file.stem().string(), bytes};
  }
  if (settings.rules) return sourceOfRecipe(readRules(*settings.rules), *settings.rules, readFileBytes(*settings.rules));
  const std::string name = settings.input.string();
  if (const auto preset = findPreset(name)) return sourceOfRecipe(parseRecipe(*preset, "preset " + name), settings.input, *preset);
  if (settings.input.extension() != ".toml")
    throw InputError(name, "no preset of this name and no .toml file: the presets are " + presetNames());
  const std::string bytes = readFileBytes(settings.input);
  return sourceOfRecipe(parseRecipe(bytes, name), settings.input, bytes);
}

void warnOfParts(const CloudSource& source, Warnings& warnings) {
  const std::vector<int> parts = findParts(source.spheres);
  if (const int count = *std::max_element(parts.begin(), parts.end()) + 1; count > 1)
    warnings.add(WarningKind::kGrammar, source.file + ": the cloud is in " + std::to_string(count) + " parts: larger spheres join them");
}

std::vector<Sphere> spheresOf(const CloudSource& source, const Settings& settings, BakeReport& report) {
  GrowthSummary* summary = settings.explain || settings.dry_run ? &report.growth.emplace() : nullptr;
  if (source.recipe) return growSpheres(*source.recipe, settings.bake.seed, report.warnings, summary);
  warnOfParts(source, report.warnings);
  return source.spheres;
}

// How many times an axis of the surface is as long as the domain allows; 1 where it may be as it is.
Double3 overshoot(const SurfaceMesh& surface, const Double3& domain) {
  const Vec3 size = boundingBox(surface).size();
  const auto excess = [](double length, double allowed) { return allowed > 0 ? std::max(1.0, length / allowed) : 1.0; };
  return {excess(size.x, domain.x), excess(size.y, domain.y), excess(size.z, domain.z)};
}

void growSurface(Scene& scene, const Settings& settings, std::optional<size_t> vertices, BakeReport& report, Stopwatch& watch) {
  if (!scene.level_set) scene.level_set = levelSetOf(scene, settings, Lattice::kSurface, report.warnings);
  watch.lap(report, "level set");
  scene.surface = meshFromLevelSet(*scene.level_set, {vertices}, report.warnings);
  watch.lap(report, "surface");
}

// Spheres and surface. A smooth union and noise stand out of the spheres: with a domain all is grown again until they fit too.
Scene growShape(CloudSource& source, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  constexpr int kAttempts = 4;
  constexpr double kSlack = 1.001;
  const Warnings before = report.warnings;
  const Double3 domain = source.recipe ? source.recipe->spheres.domain.value_or(Double3{}) : Double3{};
  Scene scene;
  for (int attempt = 1;; ++attempt) {
    report.warnings = before;
    scene.level_set.reset();
    scene.spheres = spheresOf(source, settings, report);
    watch.lap(report, "grow");
    if (settings.dry_run) return scene;
    growSurface(scene, settings, settings.vertices, report, watch);
    const Double3 over = overshoot(scene.surface, domain);
    if (std::max({over.x, over.y, over.z}) <= kSlack || attempt == kAttempts) return scene;
    Double3& fitted = *source.recipe->spheres.domain;
    fitted = {fitted.x / over.x, fitted.y / over.y, fitted.z / over.z};
  }
}

}  // namespace

bool isGrown(const Settings& settings) {
  return settings.rules || settings.from_spheres || settings.input.extension() == ".toml" ||
         findPreset(settings.input.string()).has_value();
}

std::string presetNames() {
  std::string names;
  for (const Preset& preset : presets()) names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return names;
}

Scene growScene(Settings& settings, const std::function<void(Settings&)>& apply_command_line, BakeReport& report, Stopwatch& watch) {
  // The command line names the source, whose own settings it then overrides.
  apply_command_line(settings);
  CloudSource source = findSource(settings);
  report.input = settings.rules          ? settings.rules->string()
                 : settings.from_spheres ? settings.from_spheres->string()
                                         : settings.input.string();
  if (source.recipe) {
    settings.bake.seed = source.recipe->derive.seed;
    settings.recipe_keys.clear();
    for (const RecipeOption& option : source.recipe->bake_options)
      setFromToml(settings, option.key, option.value, source.recipe->grammar.file, option.line);
    apply_command_line(settings);
    for (const auto& [key, value] : settings.recipe_keys) {
      setRecipeKey(*source.recipe, key, value);
      source.bytes += "\n--" + key + "=" + value;
    }
    source.recipe->spheres.floor = settings.flat_base;
  }
  report.info.input_hash = hashBytes(source.bytes);
  if (settings.remesh) throw UsageError("--remesh is for sculpts: --voxels and --vertices rule the mesh of a grown cloud");
  const std::optional<SceneView> view = takeSceneView(settings);
  resolveMethod(settings);

  return namingFile(source.file, [&] {
    Scene scene = growShape(source, settings, report, watch);
    if (settings.dry_run) return scene;
    if (const size_t budget = view ? vertexBudget(*view, scene.surface) : SIZE_MAX;
        !settings.vertices && budget < scene.surface.positions.size()) {
      settings.vertices = budget;
      growSurface(scene, settings, budget, report, watch);
    }
    scene.exact_spheres =
        settings.blend.value == 0 && (!settings.noise || settings.noise->value == 0) && !settings.flat_base && !settings.vertices;
    scene.closed = findDefects(scene.surface).unmatched_edges == 0;
    scene.sculpt.parts.push_back({source.name, scene.surface.positions, scene.surface.normals, {}, scene.surface.triangles, {}});
    return scene;
  });
}

}  // namespace cloudbake
