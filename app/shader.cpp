// cloudbake shader ENGINE [ASSET.glb] [--scene FILE] -o DIR: the engine kit for one engine, with the constants of an asset and a scene.
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/impostor/impostor_file.h"
#include "io/gltf/sequence/sequence_file.h"
#include "pipeline/kit/engine_kit.h"

namespace cloudbake {

namespace {

AssetInfo infoOf(const std::filesystem::path& asset, const std::string& engine, const ReadSettings& settings, Warnings& warnings) {
  const std::string bytes = readFileBytes(asset);
  if (isImpostor(bytes)) return boxWithImpostor(decodeImpostor(asset, bytes, settings.memory_limit)).info;
  if (playsSequences(engine) && isSequence(bytes)) return decodeSequence(asset, bytes, settings.memory_limit).info;
  const StoredAsset stored = readStoredAsset(asset, bytes, warnings, settings);
  if (!stored.info_fault.empty()) throw InputError(asset.string(), stored.info_fault + ", or give no asset");
  return *stored.info;
}

SceneFile sceneOf(const Settings& settings) {
  if (!settings.scene) return defaultScene();
  return readSceneFile(*settings.scene, readFileBytes(*settings.scene), [](const PictureSettings& view) { return view; });
}

}  // namespace

ExitCode runShader(const CommandLine& line) {
  const Settings settings = settingsOf(line, line.given);
  if (line.inputs.size() > 2)
    throw UsageError("'" + line.inputs[2].string() + "' is one input too many: ENGINE and at most one ASSET.glb are expected");
  const bool has_asset = line.inputs.size() == 2;
  BakeReport report;
  report.command = "shader";
  report.input = line.inputs.back().string();
  report.output = settings.output.file.string();
  report.info = has_asset ? infoOf(line.inputs.back(), line.inputs[0].string(), settings.source.read, report.warnings) : defaultAssetInfo();
  enforceStrict(settings.run.strict, report);
  Json names = Json::array();
  for (const EngineFile& file : engineFiles(line.inputs[0].string(), report.info, sceneOf(settings))) {
    const std::filesystem::path path = settings.output.file / file.name;
    createFolder(path.parent_path());
    writeFileAtomically(path, file.text);
    names.push_back(path.string());
  }
  std::string text;
  for (const Json& name : names) text += "wrote       " + name.get<std::string>() + "\n";
  tellReport(settings.run, report, {{"engine", line.inputs[0].string()}, {"files", names}}, text);
  return ExitCode::kDone;
}

}  // namespace cloudbake
