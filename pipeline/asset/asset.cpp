#include "pipeline/asset/asset.h"

#include <algorithm>

#include "bake/field/thin_parts.h"
#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/memory_budget.h"
#include "core/parallel.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/write.h"
#include "pipeline/asset/refine.h"
#include "pipeline/sources/sculpt.h"
#include "pipeline/sources/volume.h"

namespace cloudbake {

Cloud readCloud(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  report.input = settings.source.input.string();
  if (settings.source.kind == SourceKind::kVolume) return readVolume(settings, report, watch);
  Cloud cloud = readSculpt(settings, report, watch);
  refineCloud(cloud, settings, report, watch);
  return cloud;
}

BakeParameters resolveParameters(const Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  BakeParameters parameters = namingFile(report.input, [&] { return parametersFor(cloud, settings); });
  if (parameters.target) watch.lap(report.seconds, "target");
  const std::string input_hash = report.info.input_hash;
  report.info = describe(settings, parameters);
  report.info.input_hash = input_hash;
  report.target = parameters.target;
  report.vertices = cloud.surface.positions.size();
  report.triangles = cloud.surface.triangles.size();
  return parameters;
}

namespace {

// For most meshes, the search against their own normals already finds no thin part. If it finds one, the outward normals of the whole solid
// decide, because the mesh's own normals lead along the surface at a hard edge, and out of the solid if the mesh is inverted.
void warnOfThinParts(const Cloud& cloud, const IntegrationField& field, BakeReport& report) {
  const auto thinUnder = [&](const std::vector<Vec3>& normals) {
    const BakePoints points{cloud.surface.positions, normals};
    return field.coverage ? findThinParts(points, *field.coverage) : findThinParts(points, *field.dense);
  };
  if (thinUnder(cloud.surface.normals).count == 0) return;
  const SurfaceMesh& solid = cloud.solid() ? *cloud.solid() : cloud.surface;
  std::vector<Vec3> outward = smoothNormals(solid);
  if (signedVolume(solid) < 0)
    for (Vec3& normal : outward) normal = -normal;
  const Defect thin = thinUnder(outward);
  if (thin.count > 0)
    report.warnings.add(WarningKind::kThinPart,
                        "a vertex is on a part thinner than a voxel: use more --voxels (or --bake-voxels), first at " +
                            placeInSculpt(cloud.sculpt, thin.first, true),
                        thin.count);
}

// The lobes, and the results of --basis and --lattice.
struct WholeBake {
  std::vector<Lobe> lobes;
  std::vector<float> harmonics;
  std::vector<LatticeFile> lattice;
};

WholeBake bakeWhole(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report, Stopwatch& watch) {
  const int order = settings.lobe.harmonic_order;
  if (order > 0) namingFile(report.input, [&] { requireHarmonicsMemory(cloud.surface.positions.size(), settings.lobe, parameters); });
  const IntegrationField field = fieldOfCloud(cloud, settings, parameters, report, watch);
  WholeBake whole;
  whole.lobes = lobesOfCloud(cloud, field, settings.lobe, parameters, report, watch).lobes;
  if (order == 0) return whole;
  whole.harmonics = bakeHarmonics({cloud.surface.positions, cloud.surface.normals}, field, order, settings.lobe, parameters);
  if (const auto& file = settings.output.lattice)
    whole.lattice = encodeLattice(bakeLattice(cloud, field, settings.lobe, parameters), file->stem().string());
  watch.lap(report.seconds, "harmonics");
  return whole;
}

// Bakes every object in its own field, as if it were alone. k, b, σ and L are those of the whole file.
std::vector<Lobe> bakeSeparately(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report,
                                 Stopwatch& watch) {
  std::vector<Lobe> lobes;
  const std::vector<Cloud> objects = separateObjects(cloud, settings.mesh, report);
  for (size_t i = 0; i < objects.size(); ++i) {
    const LoopProgress::Part part(double(i) / double(objects.size()), double(i + 1) / double(objects.size()));
    const std::vector<Lobe> own = bakeWhole(objects[i], settings, parameters, report, watch).lobes;
    lobes.insert(lobes.end(), own.begin(), own.end());
  }
  return lobes;
}

}  // namespace

IntegrationField fieldOfCloud(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report,
                              Stopwatch& watch) {
  if (parameters.bake.method == Method::kSweep) {
    const FieldSettings& choices = settings.field;
    const Box box = boundingBox(cloud.surface);
    const double voxel = parameters.bake_voxels ? double(box.longestSide()) / *parameters.bake_voxels
                         : choices.voxel_size   ? double(*choices.voxel_size)
                         : cloud.voxel_size     ? double(*cloud.voxel_size)
                                                : double(box.longestSide()) / choices.voxels;
    watch.announce(sweepWork(box, voxel, parameters.bake.rays, cloud.surface.positions.size()));
  }
  const auto build = [&] { return buildField(cloud, fieldSettings(settings.field, parameters), parameters.bake.method, report.warnings); };
  IntegrationField field =
      namingFile(report.input, [&] { return inStage("the integration field", "use fewer --voxels or --bake-voxels", build); });
  report.info.field = field.kind;
  report.info.voxel_size = std::max(report.info.voxel_size, float(field.voxelSize()));
  if (cloud.spheres.empty()) warnOfThinParts(cloud, field, report);
  watch.lap(report.seconds, "field");
  return field;
}

BakedLobes lobesOfCloud(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings, const BakeParameters& parameters,
                        BakeReport& report, Stopwatch& watch) {
  const auto bake = [&] { return bakeLobes(cloud, field, settings, parameters, report.warnings, watch, report.seconds); };
  BakedLobes baked = inStage("the lobes of these vertices", "use fewer --vertices or --rays", bake);
  report.info.shape = baked.shape;
  report.fit = baked.fit;
  const auto& entries = report.warnings.entries();
  if (const auto undefined = entries.find(WarningKind::kUndefinedDirection); undefined != entries.end())
    report.undefined_directions = undefined->second.count;
  return baked;
}

std::vector<std::span<const Lobe>> lobesPerPart(const Sculpt& sculpt, std::span<const Lobe> lobes) {
  std::vector<std::span<const Lobe>> per_part;
  for (size_t first = 0; const SculptPart& part : sculpt.parts) {
    per_part.push_back(lobes.subspan(first, part.positions.size()));
    first += part.positions.size();
  }
  return per_part;
}

namespace {

// `spent`: the cloud, if nobody needs it any more. Then what bounds its volume makes room for the file.
BakedAsset bakedAsset(const Cloud& cloud, Cloud* spent, const Settings& settings, const BakeParameters& parameters, BakeReport& report,
                      Stopwatch& watch) {
  WholeBake whole = settings.mesh.separate ? WholeBake{bakeSeparately(cloud, settings, parameters, report, watch), {}, {}}
                                           : bakeWhole(cloud, settings, parameters, report, watch);
  BakedAsset asset{std::move(whole.lobes), {}, std::move(whole.lattice), {}};
  const std::vector<std::span<const Lobe>> per_part = lobesPerPart(cloud.sculpt, asset.lobes);
  if (spent && settings.mesh.levels.empty()) spent->surface = {}, spent->filled.reset(), spent->level_set.reset();
  const auto encode = [&] {
    report.info.first_uv_set = chooseUvSet(cloud.sculpt, settings.output.gltf);
    std::string glb = encodeGlb(cloud.sculpt, per_part, report.info, settings.output.gltf, report.warnings, whole.harmonics);
    if (!settings.mesh.levels.empty()) {
      watch.lap(report.seconds, "encode");
      asset.levels = makeLevels(cloud, asset.lobes, whole.harmonics, settings, report, watch);
    }
    return glb;
  };
  asset.glb =
      namingFile(report.input, [&] { return inStage("the GLB and its levels of detail", "use fewer --vertices or --lods", encode); });
  enforceStrict(settings.run.strict, report);
  return asset;
}

void writeAssetOf(const Cloud& cloud, Cloud* spent, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const OutputSettings& output = settings.output;
  for (const std::filesystem::path& stale : staleLevels(output.file, settings.mesh.levels.size()))
    report.warnings.add(WarningKind::kStaleLevel, stale.string() + ": this level of detail is of an earlier bake: remove it");
  const BakeParameters parameters = resolveParameters(cloud, settings, report, watch);
  const BakedAsset asset = bakedAsset(cloud, spent, settings, parameters, report, watch);
  for (const LatticeFile& file : asset.lattice) writeFileAtomically(output.lattice->parent_path() / file.name, file.bytes);
  for (const LevelAsset& level : asset.levels) writeFileAtomically(level.file, level.glb);
  writeFileAtomically(output.file, asset.glb);
  report.output = output.file.string();
  watch.lap(report.seconds, "write");
}

}  // namespace

BakedAsset bakeAsset(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report, Stopwatch& watch) {
  return bakedAsset(cloud, nullptr, settings, parameters, report, watch);
}

void writeAsset(const Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  writeAssetOf(cloud, nullptr, settings, report, watch);
}

void writeAsset(Cloud&& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  writeAssetOf(cloud, &cloud, settings, report, watch);
}

}  // namespace cloudbake
