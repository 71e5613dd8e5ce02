#include "pipeline/library/cloudbake.h"

#include <algorithm>

#include "core/lobe_packing.h"
#include "core/parallel.h"
#include "core/text/scan.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/sculpt/read_mesh.h"
#include "pipeline/asset/asset.h"
#include "pipeline/asset/refine.h"
#include "pipeline/library/stage_plan.h"
#include "pipeline/options/resolve.h"
#include "pipeline/sources/grown.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

// The lobes as the asset has them: packing rounds them once more. Where a part's own space is the scene's, these are the stored floats.
std::vector<Lobe> lobesInAsset(const Cloud& cloud, std::vector<Lobe> lobes) {
  auto lobe = lobes.begin();
  for (const SculptPart& part : cloud.sculpt.parts)
    for (size_t v = 0; v < part.positions.size(); ++v, ++lobe) {
      if (part.toScene(v).linear == Affine{}.linear) *lobe = mappedLobe(*lobe, *inverted(part.toScene(v)));
    }
  return lobes;
}

// Bakes the cloud that `make` returns.
template <class Make>
BakeResult bakeCloud(const char* command, const Settings& settings, const StageListener& on_stage, const Make& make) {
  const ThreadLimit limit(settings.run.threads);
  BakeReport report;
  report.command = command;
  StagePlan plan = StagePlan::ofBake(settings, std::string_view(command) == "grow");
  Stopwatch watch([&](const std::string& stage) {
    if (on_stage) on_stage(stage);
    throwIfLoopsStop();
    plan.end(stage);
  });
  const Cloud cloud = make(settings, report, watch);
  const BakeParameters parameters = resolveParameters(cloud, settings, report, watch);
  BakedAsset asset = bakeAsset(cloud, settings, parameters, report, watch);
  BakeResult result{lobesInAsset(cloud, std::move(asset.lobes)),
                    report.info,
                    std::move(asset.glb),
                    {},
                    reportJson(report),
                    warningLines(report) + findingLines(report) + reportText(report)};
  for (const auto& [kind, entry] : report.warnings.entries())
    result.warnings.push_back({std::string(warningName(kind)), entry.count, entry.first});
  return result;
}

SourceSettings sourceOfGrowth(const std::filesystem::path& preset_or_file) {
  SourceSettings source = sourceOfFile(preset_or_file);
  source.kind = sourceKindOf(preset_or_file);
  if (isGrown(source.kind)) return source;
  const std::string ending = lowerCase(preset_or_file.extension().string());
  source.kind = ending == ".ply" || ending == ".csv" ? SourceKind::kSpheres : ending == ".txt" ? SourceKind::kRules : SourceKind::kPreset;
  return source;
}

}  // namespace

BakeResult bake(SurfaceMesh mesh, const Options& options, const StageListener& on_stage) {
  const std::vector<Given> given = givenBy(options, kBake);
  for (const Given& one : given)
    if (one.option->bits & kOfInputFile) throw UsageError("--" + std::string(one.option->name) + " is for files: leave it out for a mesh");
  return bakeCloud("bake", resolve(sourceOfFile("mesh"), given), on_stage,
                   [&](const Settings& settings, BakeReport& report, Stopwatch& watch) {
                     Sculpt sculpt = sculptOf("mesh", std::move(mesh));
                     checkSculpt("mesh", sculpt, report.warnings);
                     report.input = "mesh";
                     Cloud cloud = namingFile("mesh", [&] { return cloudOfSculpt(std::move(sculpt), settings.mesh, report, watch); });
                     refineCloud(cloud, settings, report, watch);
                     return cloud;
                   });
}

BakeResult bake(const std::filesystem::path& file, const Options& options, const StageListener& on_stage) {
  return bakeCloud("bake", resolve(sourceOfFile(file), givenBy(options, kBake)), on_stage, readCloud);
}

BakeResult grow(const std::filesystem::path& preset_or_file, const Options& options, const StageListener& on_stage) {
  const std::vector<Given> own = givenBy(options, kGrow);
  if (isGiven(own, "dry-run")) throw UsageError("--dry-run makes no asset: leave it out");
  const SourceSettings asked = sourceOfGrowth(preset_or_file);
  resolve(asked, own);  // a wrong option is reported before anything is read
  GrownSource source = readGrownSource(asked);
  std::vector<Given> given = source.given;
  given.insert(given.end(), own.begin(), own.end());
  return bakeCloud("grow", resolve(asked, given), on_stage, [&](const Settings& settings, BakeReport& report, Stopwatch& watch) {
    return growCloud(std::move(source), settings, std::nullopt, report, watch);
  });
}

BakedMesh readAsset(std::string_view glb, const std::string& name) {
  Warnings not_told;
  return decodeGlb(name, glb, not_told);
}

const char* version() { return CLOUDBAKE_VERSION; }

}  // namespace cloudbake
