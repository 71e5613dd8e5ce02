#include "pipeline/cloudbake.h"

#include <algorithm>

#include "core/parallel.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/asset.h"
#include "pipeline/resolve.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

// Bakes the cloud that `make` returns for these settings.
template <class Make>
BakeResult bakeCloud(const SourceSettings& source, const Options& options, const StageListener& on_stage, const Make& make) {
  const Settings settings = resolve(source, givenBy(options, kBake));
  const ThreadLimit limit(settings.run.threads);
  BakeReport report;
  report.command = "bake";
  Stopwatch watch(on_stage);
  const Cloud cloud = make(settings, report, watch);
  const BakeParameters parameters = resolveParameters(cloud, settings, report, watch);
  BakedAsset asset = bakeAsset(cloud, settings, parameters, report, watch);
  BakeResult result{
      std::move(asset.lobes), report.info, std::move(asset.glb), {}, reportJson(report), warningLines(report) + reportText(report)};
  for (const auto& [kind, entry] : report.warnings.entries())
    result.warnings.push_back({std::string(warningName(kind)), entry.count, entry.first});
  return result;
}

}  // namespace

BakeResult bake(const SurfaceMesh& mesh, const Options& options, const StageListener& on_stage) {
  return bakeCloud({}, options, on_stage, [&](const Settings& settings, BakeReport& report, Stopwatch& watch) {
    Sculpt sculpt;
    sculpt.parts.push_back({"mesh", mesh.positions, mesh.normals, {}, mesh.triangles, {}});
    checkSculpt("mesh", sculpt, report.warnings);
    report.input = "mesh";
    return namingFile("mesh", [&] { return cloudOfSculpt(std::move(sculpt), settings.mesh, report, watch); });
  });
}

BakeResult bake(const std::filesystem::path& file, const Options& options, const StageListener& on_stage) {
  return bakeCloud(sourceOfFile(file), options, on_stage, readCloud);
}

BakedMesh readAsset(std::string_view glb, const std::string& name) {
  Warnings not_told;
  return decodeGlb(name, glb, not_told);
}

const char* version() { return CLOUDBAKE_VERSION; }

}  // namespace cloudbake
