#include "app/pipeline.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/presets.h"
#include "bake/dense_field.h"
#include "bake/directions.h"
#include "bake/level_set.h"
#include "bake/mesh_topology.h"
#include "bake/repair.h"
#include "bake/sphere_rays.h"
#include "bake/surface.h"
#include "core/vertex_normals.h"
#include "io/report.h"
#include "io/write_file.h"
#include "lsystem/recipe.h"

namespace cloudbake {

namespace {

constexpr float kDefaultExponent = 3, kDefaultOpticalDepth = 7;
constexpr Length kDefaultBias{-0.003F, true};

LevelSetSettings levelSetSettings(const Settings& settings, float longest_side) {
  LevelSetSettings result;
  result.voxels = settings.voxels;
  result.voxel_size = settings.voxel_size;
  result.blend = settings.blend.resolve(longest_side);
  result.flat_base = settings.flat_base;
  return result;
}

CloudRecipe findRecipe(const Settings& settings, std::string& bytes) {
  if (settings.rules) {
    bytes = readFileBytes(*settings.rules);
    return readRules(*settings.rules);
  }
  const std::string name = settings.input.string();
  if (const auto preset = findPreset(name)) {
    bytes = *preset;
    return parseRecipe(bytes, "preset " + name);
  }
  if (settings.input.extension() != ".toml")
    throw InputError(name, "no preset of this name and no .toml file: the presets are " + presetNames());
  bytes = readFileBytes(settings.input);
  return parseRecipe(bytes, name);
}

void overrideRecipe(CloudRecipe& recipe, const GrowOverrides& overrides) {
  const auto take = [](const std::optional<double>& value, double& field) { field = value.value_or(field); };
  take(overrides.generations, recipe.derive.generations);
  take(overrides.step, recipe.turtle.step);
  take(overrides.step_scale, recipe.turtle.step_scale);
  take(overrides.angle, recipe.turtle.angle);
  take(overrides.angle_scale, recipe.turtle.angle_scale);
  take(overrides.thickness, recipe.turtle.thickness);
  take(overrides.thickness_scale, recipe.turtle.thickness_scale);
  take(overrides.gravity, recipe.turtle.gravity);
}

// A closed mesh as it is; an open one through OpenVDB's own signing where that agrees with a wrap of it, else through the wrap.
LevelSet sculptLevelSet(const SurfaceMesh& surface, const LevelSetSettings& settings, bool closed, Warnings& warnings) {
  if (closed) return levelSetFromMesh(surface, settings, warnings);
  if (!canWrap()) return levelSetFromOpenMesh(surface, settings, warnings);
  const Box box = boundingBox(surface);
  const double voxel_size = frameFor(box, settings).voxel_size;
  if (estimateBytes(box, voxel_size) > double(settings.memory_limit))
    return levelSetFromMesh(surface, settings, warnings);  // refuses with the number
  const Wrap wrap = wrapClosed(surface, 4 * voxel_size);
  Warnings tried;
  try {
    LevelSet flooded = levelSetFromOpenMesh(surface, settings, tried);
    if (std::fabs(insideVolume(flooded) / wrap.volume - 1) < 0.2) {
      for (const auto& [kind, entry] : tried.entries()) warnings.add(kind, entry.first, entry.count);
      return flooded;
    }
  } catch (const InputError&) {
    // Crumbs: the flood entered through a hole. The wrap is the volume.
  }
  char text[128];
  std::snprintf(text, sizeof text, "the open mesh was closed by a wrap: holes up to %.3g world units", wrap.alpha);
  warnings.add(WarningKind::kVolumeMismatch, text);
  return levelSetFromMesh(wrap.mesh, settings, warnings);
}

// A budget gives a sculpt a mesh of ours: one part in scene space.
void reduceSculpt(Scene& scene, size_t vertices, Warnings& warnings) {
  if (scene.surface.positions.size() <= vertices) return;
  reduceVertices(scene.surface, vertices, warnings);
  scene.surface.normals = vertexNormals(scene.surface.positions, scene.surface.triangles);
  const std::string name = scene.sculpt.parts.front().name;
  warnings.add(WarningKind::kPartIgnored, "--vertices makes one new mesh: parts, UVs and materials of the sculpt are not carried over");
  scene.sculpt = {{SculptPart{name, scene.surface.positions, scene.surface.normals, {}, scene.surface.triangles, {}}}, nullptr};
}

std::string timesOf(uint64_t count) { return count > 1 ? " (" + std::to_string(count) + " in all)" : ""; }

}  // namespace

void Stopwatch::lap(BakeReport& report, const std::string& stage) {
  const auto now = std::chrono::steady_clock::now();
  report.seconds.emplace_back(stage, std::chrono::duration<double>(now - last_).count());
  last_ = now;
}

bool isGrown(const Settings& settings) {
  return settings.rules || settings.input.extension() == ".toml" || findPreset(settings.input.string()).has_value();
}

std::string presetNames() {
  std::string names;
  for (const Preset& preset : presets()) names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return names;
}

Scene growScene(Settings& settings, const std::function<void(Settings&)>& apply_command_line, BakeReport& report, Stopwatch& watch) {
  apply_command_line(settings);  // names the recipe, whose own settings it then overrides
  std::string bytes;
  CloudRecipe recipe = findRecipe(settings, bytes);
  settings.bake.seed = recipe.derive.seed;
  for (const RecipeOption& option : recipe.bake_options) setFromToml(settings, option.key, option.value, recipe.grammar.file, option.line);
  apply_command_line(settings);
  overrideRecipe(recipe, settings.grow);
  report.input = settings.rules ? settings.rules->string() : settings.input.string();
  report.info.input_hash = hashBytes(bytes);

  Scene scene;
  return namingFile(recipe.grammar.file, [&] {
    scene.spheres = growSpheres(recipe, settings.bake.seed, report.warnings);
    watch.lap(report, "grow");
    Box box;
    for (const Sphere& s : scene.spheres)
      box.add(s.center - Vec3{s.radius, s.radius, s.radius}), box.add(s.center + Vec3{s.radius, s.radius, s.radius});
    const LevelSetSettings level_set_settings = levelSetSettings(settings, box.longestSide());
    scene.exact_spheres = level_set_settings.blend == 0 && !level_set_settings.flat_base && !settings.vertices;
    scene.level_set = levelSetFromSpheres(scene.spheres, level_set_settings, report.warnings);
    watch.lap(report, "level set");
    scene.surface = meshFromLevelSet(scene.level_set, {settings.vertices}, report.warnings);
    watch.lap(report, "surface");
    scene.closed = findDefects(scene.surface).unmatched_edges == 0;
    const std::string name = settings.rules ? settings.rules->stem().string() : settings.input.stem().string();
    scene.sculpt.parts.push_back({name, scene.surface.positions, scene.surface.normals, {}, scene.surface.triangles, {}});
    return std::move(scene);
  });
}

Scene readScene(Settings& settings, BakeReport& report, Stopwatch& watch) {
  report.input = settings.input.string();
  Scene scene;
  return namingFile(report.input, [&] {
    scene.sculpt = readMesh(settings.input, settings.read, report.warnings);
    report.info.input_hash = hashBytes(readFileBytes(settings.input));
    scene.surface = surfaceInScene(scene.sculpt);
    watch.lap(report, "read");
    const MeshDefects defects = findDefects(scene.surface);
    scene.closed = defects.unmatched_edges == 0;
    reportDefects(defects, report.warnings);
    watch.lap(report, "check");
    scene.level_set =
        sculptLevelSet(scene.surface, levelSetSettings(settings, boundingBox(scene.surface).longestSide()), scene.closed, report.warnings);
    watch.lap(report, "level set");
    if (settings.vertices) {
      reduceSculpt(scene, *settings.vertices, report.warnings);
      watch.lap(report, "surface");
    }
    return std::move(scene);
  });
}

void resolveInfo(Settings& settings, const Scene& scene, BakeReport& report) {
  const Box box = boundingBox(scene.surface);
  const float longest = box.longestSide();
  if (!settings.bake.ray_length) settings.bake.ray_length = box.diagonal();
  AssetInfo& info = report.info;
  info.shape = {settings.exponent.value_or(kDefaultExponent), settings.bias.value_or(kDefaultBias).resolve(longest)};
  info.extinction = settings.extinction.value_or(kDefaultOpticalDepth / longest);
  info.sampler = samplerName(settings.bake.sampler);
  info.quadrature = quadratureName(settings.bake.quadrature);
  info.rays = settings.bake.rays;
  info.steps = settings.bake.steps;
  info.ray_length = *settings.bake.ray_length;
  info.voxel_size = float(scene.level_set.frame.voxel_size);
  info.seed = settings.bake.seed;
  report.vertices = scene.surface.positions.size();
  report.triangles = scene.surface.triangles.size();
}

std::vector<Lobe> bakeScene(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  std::vector<Lobe> lobes =
      bakeSphereRays({scene.surface.positions, scene.surface.normals}, denseFromLevelSet(scene.level_set), settings.bake, report.warnings);
  const auto& entries = report.warnings.entries();
  if (const auto undefined = entries.find(WarningKind::kUndefinedDirection); undefined != entries.end())
    report.undefined_directions = undefined->second.count;
  watch.lap(report, "bake");
  return lobes;
}

void writeAsset(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const std::vector<Lobe> lobes = bakeScene(scene, settings, report, watch);
  std::vector<std::vector<Lobe>> per_part;
  for (size_t first = 0; const SculptPart& part : scene.sculpt.parts) {
    per_part.emplace_back(lobes.begin() + ptrdiff_t(first), lobes.begin() + ptrdiff_t(first + part.positions.size()));
    first += part.positions.size();
  }
  const std::string glb = namingFile(report.input, [&] {
    report.info.first_uv_set = chooseUvSet(scene.sculpt, settings.gltf);
    return encodeGlb(scene.sculpt, per_part, report.info, settings.gltf, report.warnings);
  });
  enforceStrict(settings, report);
  writeFileAtomically(settings.output, glb);
  report.output = settings.output.string();
  watch.lap(report, "write");
}

void enforceStrict(const Settings& settings, const BakeReport& report) {
  if (!settings.strict || report.warnings.empty()) return;
  std::string all;
  for (const auto& [kind, entry] : report.warnings.entries())
    all += (all.empty() ? "" : "; ") + std::string(warningName(kind)) + ": " + entry.first + timesOf(entry.count);
  throw InputError(report.input, "--strict refuses " + all);
}

void tellReport(const Settings& settings, const BakeReport& report) {
  if (settings.json) writeFileAtomically(*settings.json, reportJson(report));
  for (const auto& [kind, entry] : report.warnings.entries())
    std::fprintf(stderr, "cloudbake: %s: warning: %s: %s%s\n", report.input.c_str(), std::string(warningName(kind)).c_str(),
                 entry.first.c_str(), timesOf(entry.count).c_str());
  if (!settings.quiet) std::fputs(reportText(report).c_str(), stdout);
}

}  // namespace cloudbake
