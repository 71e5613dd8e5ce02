#include "pipeline/cloudbake.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <optional>

#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/asset.h"
#include "pipeline/resolve.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

std::vector<Given> givenBy(const Options& options) {
  std::vector<Given> given;
  for (const auto& [name, value] : options) {
    const Option* option = findOption(name, kBake);
    if (!option || option->files.kind != FileUse::kNone)  // files are for the program
      throw UsageError("unknown option '" + name + "': `cloudbake bake --help-all` lists them");
    given.push_back({option, value, "", 0, 0});
  }
  return given;
}

// Bakes the cloud that `make` returns for these settings.
template <class Make>
BakeResult bakeCloud(const SourceSettings& source, const Options& options, const Make& make) {
  const Settings settings = resolve(source, givenBy(options));
  std::optional<tbb::global_control> limit;
  if (settings.run.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(settings.run.threads));
  BakeReport report;
  Stopwatch watch;
  const Cloud cloud = make(settings, report, watch);
  const BakeParameters parameters = resolveParameters(cloud, settings, report, watch);
  BakedAsset asset = bakeAsset(cloud, settings, parameters, report, watch);
  BakeResult result{std::move(asset.lobes), report.info, std::move(asset.glb), {}};
  for (const auto& [kind, entry] : report.warnings.entries())
    result.warnings.push_back({std::string(warningName(kind)), entry.count, entry.first});
  return result;
}

}  // namespace

BakeResult bake(const SurfaceMesh& mesh, const Options& options) {
  return bakeCloud({}, options, [&](const Settings& settings, BakeReport& report, Stopwatch& watch) {
    Sculpt sculpt;
    sculpt.parts.push_back({"mesh", mesh.positions, mesh.normals, {}, mesh.triangles, {}});
    checkSculpt("mesh", sculpt, report.warnings);
    report.input = "mesh";
    return namingFile("mesh", [&] { return cloudOfSculpt(std::move(sculpt), settings.mesh, report, watch); });
  });
}

BakeResult bake(const std::filesystem::path& file, const Options& options) {
  SourceSettings source;
  source.input = file;
  source.kind = isVdbFile(file) ? SourceKind::kVolume : SourceKind::kSculpt;
  return bakeCloud(source, options, readCloud);
}

BakedMesh readAsset(std::string_view glb, const std::string& name) {
  Warnings not_told;
  return decodeGlb(name, glb, not_told);
}

const char* version() { return CLOUDBAKE_VERSION; }

}  // namespace cloudbake
