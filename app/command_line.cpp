#include <sstream>

#include "app/commands.h"
#include "pipeline/asset/asset.h"
#include "pipeline/asset/levels.h"
#include "pipeline/kit/engine_kit.h"
#include "pipeline/options/resolve.h"
#include "pipeline/picture/shadow_picture.h"
#include "pipeline/scene/scene_file.h"
#include "pipeline/sequence/sequence.h"
#include "pipeline/sources/grown.h"

namespace cloudbake {

SourceSettings sourceOf(const CommandLine& line) {
  const bool has_rules = isGiven(line.given, "rules"), has_spheres = isGiven(line.given, "from-spheres");
  if (int(!line.input.empty()) + int(has_rules) + int(has_spheres) > 1)
    throw UsageError("a preset or recipe, --rules and --from-spheres are different clouds: give one of them");
  SourceSettings source;
  source.input = line.input;
  source.kind = has_rules ? SourceKind::kRules : has_spheres ? SourceKind::kSpheres : sourceKindOf(line.input);
  if (line.command == kGrow && !isGrown(source.kind)) source.kind = SourceKind::kPreset;
  if (line.command == kBake && isGrown(source.kind)) source.kind = SourceKind::kSculpt;
  source.read.child_program = line.child_program;
  source.memory_limit = line.memory_limit;
  return source;
}

Settings settingsOf(const CommandLine& line, std::span<const Given> given, const std::optional<SceneNeeds>& scene) {
  Settings settings = resolve(sourceOf(line), given, scene);
  settings.output.file = line.output;
  settings.batch.inputs = line.inputs;
  settings.run.quiet = line.quiet;
  return settings;
}

RunFile outputOf(const CommandLine& line) {
  RunFile file{line.output, "-o"};
  if (line.command != kSequence) return file;
  Settings scratch;
  for (const Given& given : line.given)
    if (given.option->value.set) given.option->value.set(scratch, *given.option, given.value);
  if (scratch.sequence.output != SequenceOutput::kKeys) return file;
  return {std::filesystem::path(line.output).replace_extension(), "-o", kKeyFileEnding, true};
}

RunFiles filesOf(const CommandSpec& command, const CommandLine& line) {
  RunFiles files;
  if (!line.input.empty() && sourceKindOf(line.input) != SourceKind::kPreset) files.inputs.push_back({line.input, "the input"});
  const bool names_engine = command.bit == kShader && !line.inputs.empty();  // the first input is its name
  for (size_t i = names_engine; i < line.inputs.size(); ++i) files.inputs.push_back({line.inputs[i], "the input"});
  for (const Given& given : line.given) addFilesOf(given, files);
  if (!line.output.empty() && std::string_view(command.output) == "FILE") {
    refuseOtherFormat({line.output, "-o"}, command.output_extensions);
    files.outputs.push_back(outputOf(line));
  }
  for (const Given& given : line.given) {
    if (given.option->files.kind != FileUse::kLevels || line.command == kBatch) continue;
    Settings scratch;
    given.option->value.set(scratch, *given.option, given.value);
    for (size_t level = 1; level <= scratch.mesh.levels.size(); ++level)
      files.outputs.push_back({levelFile(line.output, level), "--lods", "", true});
  }
  if (command.bit == kShadow && !line.output.empty()) files.outputs.push_back({shadowFrameFile(line.output), "-o", "", true});
  std::istringstream names(command.output_names);
  if (!line.output.empty())
    for (std::string name; names >> name;) files.outputs.push_back({line.output / name, "-o", "", true});
  if (names_engine && !line.output.empty())
    for (const EngineFile& file : engineFiles(line.inputs[0].string(), defaultAssetInfo()))
      files.outputs.push_back({line.output / file.name, "-o", "", true});
  if (line.command != kBatch) addNamedFiles(files);  // a batch knows them when it has read its inputs
  return files;
}

std::optional<SceneNeeds> sceneOf(const CommandLine& line) {
  for (auto given = line.given.rbegin(); given != line.given.rend(); ++given)
    if (std::string_view(given->option->name) == "scene") return readSceneNeeds(given->value);
  return std::nullopt;
}

ResolvedCloud resolveCloud(const CommandLine& line, BakeReport& report, Stopwatch& watch) {
  const std::optional<SceneNeeds> scene = sceneOf(line);
  const Settings asked = settingsOf(line, line.given, scene);
  if (!isGrown(asked.source.kind)) return {asked, readCloud(asked, report, watch)};
  // The options of the command line override those of the recipe.
  GrownSource source = readGrownSource(asked.source);
  std::vector<Given> given = source.given;
  given.insert(given.end(), line.given.begin(), line.given.end());
  const Settings settings = settingsOf(line, given, scene);
  return {settings, growCloud(std::move(source), settings, scene, report, watch)};
}

}  // namespace cloudbake
