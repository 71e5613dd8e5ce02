#include "pipeline/asset.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pipeline/lobes.h"
#include "pipeline/sources/sculpt.h"
#include "pipeline/target.h"
#include "pipeline/sources/volume.h"
#include "bake/lobe/directions.h"
#include "bake/field/level_set.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/smooth_lobes.h"
#include "bake/field/thin_parts.h"
#include "io/report/report.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

constexpr LobeShape kMeanShape{3, -0.003F}, kFitShape{4, 0};  // b as a share of the longest side
constexpr float kDefaultOpticalDepth = 7;

std::string timesOf(uint64_t count) { return count > 1 ? " (" + std::to_string(count) + " in all)" : ""; }

}  // namespace

void addSeconds(std::vector<std::pair<std::string, double>>& sums, const std::string& name, double seconds) {
  const auto found = std::find_if(sums.begin(), sums.end(), [&name](const auto& sum) { return sum.first == name; });
  if (found != sums.end())
    found->second += seconds;
  else
    sums.emplace_back(name, seconds);
}

void Stopwatch::lap(BakeReport& report, const std::string& stage) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  if (on_lap_) on_lap_(stage);
  addSeconds(report.seconds, stage, seconds);
}

Scene readScene(Settings& settings, BakeReport& report, Stopwatch& watch) {
  report.input = settings.input.string();
  takeSceneView(settings);
  resolveMethod(settings);
  if (isVdbFile(settings.input)) return readVolume(settings, report, watch);
  return readSculpt(settings, report, watch);
}

LobeShape defaultMeanShape(const SurfaceMesh& surface) {
  return {kMeanShape.exponent, kMeanShape.bias * boundingBox(surface).longestSide()};
}

void resolveInfo(Settings& settings, const Scene& scene, BakeReport& report, Stopwatch& watch) {
  const Box box = boundingBox(scene.surface);
  const float longest = box.longestSide();
  if (!settings.bake.ray_length) settings.bake.ray_length = box.diagonal();
  AssetInfo& info = report.info;
  const LobeShape& shape = settings.fit ? kFitShape : kMeanShape;
  info.lobe = settings.fit ? "fit" : "mean";
  info.shape = {settings.exponent.value_or(shape.exponent), settings.bias.value_or(Length{shape.bias, true}).resolve(longest)};
  const float extinction = kDefaultOpticalDepth / longest;
  const auto [low, high] =
      settings.extinction_range.value_or(settings.fit ? std::pair(extinction / 2, extinction * 2) : std::pair(extinction, extinction));
  info.extinction = low == high ? low : float(std::sqrt(double(low) * high));
  if (settings.fit) info.extinction_low = low, info.extinction_high = high, info.sun_arc = settings.sun_arc;
  info.method = settings.bake.method == Method::kSweep ? "sweep" : "rays";
  info.sampler = samplerName(settings.bake.sampler);
  if (settings.bake.method == Method::kRays) {
    info.quadrature = quadratureName(settings.bake.quadrature);
    info.steps = settings.bake.steps;
  }
  info.rays = settings.bake.rays;
  info.ray_length = *settings.bake.ray_length;
  info.smooth = settings.smooth;
  info.harmonic_order = settings.harmonic_order;
  info.seed = settings.bake.seed;
  report.vertices = scene.surface.positions.size();
  report.triangles = scene.surface.triangles.size();
  if (settings.target_error) {
    namingFile(report.input, [&] { chooseForTarget(scene, settings, report); });
    watch.lap(report, "target");
  }
}

namespace {

// A part's own normals show most parts to be thick. Where some are not, outward normals of the whole solid decide: at a hard edge the
// part's own lead along the surface, and those of an inverted mesh lead out of it.
void warnOfThinParts(const Scene& scene, const IntegrationField& field, BakeReport& report) {
  const auto thinUnder = [&](const std::vector<Vec3>& normals) {
    const BakePoints points{scene.surface.positions, normals};
    return field.coverage ? findThinParts(points, *field.coverage) : findThinParts(points, *field.dense);
  };
  if (thinUnder(scene.surface.normals).count == 0) return;
  const SurfaceMesh& solid = scene.solid() ? *scene.solid() : scene.surface;
  std::vector<Vec3> outward = smoothNormals(solid);
  if (signedVolume(solid) < 0)
    for (Vec3& normal : outward) normal = -normal;
  const Defect thin = thinUnder(outward);
  if (thin.count > 0)
    report.warnings.add(WarningKind::kThinPart,
                        "a vertex lies on a part thinner than a voxel: more --voxels (or --bake-voxels) hold it, first at " +
                            placeInSculpt(scene.sculpt, thin.first, true),
                        thin.count);
}

}  // namespace

IntegrationField fieldOfScene(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  IntegrationField field = namingFile(report.input, [&] { return buildField(scene, settings, report.warnings); });
  report.info.field = field.kind;
  report.info.voxel_size = std::max(report.info.voxel_size, float(field.voxelSize()));
  if (scene.spheres.empty()) warnOfThinParts(scene, field, report);
  watch.lap(report, "field");
  return field;
}

std::vector<Lobe> bakeScene(const Scene& scene, const IntegrationField& field, const Settings& settings, BakeReport& report,
                            Stopwatch& watch) {
  const std::vector<Lobe> mean = meanLobes({scene.surface.positions, scene.surface.normals}, field, settings.bake, report.warnings);
  const auto& entries = report.warnings.entries();
  if (const auto undefined = entries.find(WarningKind::kUndefinedDirection); undefined != entries.end())
    report.undefined_directions = undefined->second.count;
  watch.lap(report, "bake");
  std::vector<Lobe> lobes = mean;
  if (settings.fit) {
    lobes = fittedLobes(scene, field, mean, settings, report);
    watch.lap(report, "fit");
  }
  if (settings.smooth > 0) {
    smoothLobes(lobes, scene.surface, settings.smooth);
    watch.lap(report, "smooth");
  }
  if (settings.fit) {
    judgeFit(scene, field, mean, lobes, settings, report);
    watch.lap(report, "fit");
  }
  return lobes;
}

namespace {

// Lobes, and what --basis and --lattice add.
struct WholeBake {
  std::vector<Lobe> lobes;
  std::vector<float> harmonics;
  std::vector<LatticeFile> lattice;
};

WholeBake bakeWhole(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const IntegrationField field = fieldOfScene(scene, settings, report, watch);
  WholeBake whole;
  whole.lobes = bakeScene(scene, field, settings, report, watch);
  if (settings.harmonic_order == 0) return whole;
  whole.harmonics = bakeHarmonics(scene.surface.positions, field, settings, report.info.extinction);
  if (settings.lattice)
    whole.lattice = encodeLattice(bakeLattice(scene, field, settings, report.info.extinction), settings.lattice->stem().string());
  watch.lap(report, "harmonics");
  return whole;
}

// Every object in a field of its own, as if it were alone; k, b, σ and L are the whole file's.
std::vector<Lobe> bakeSeparately(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  std::vector<Lobe> lobes;
  for (const Scene& object : separateObjects(scene, settings, report)) {
    const std::vector<Lobe> own = bakeWhole(object, settings, report, watch).lobes;
    lobes.insert(lobes.end(), own.begin(), own.end());
  }
  return lobes;
}

}  // namespace

EncodedAsset encodeAsset(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  WholeBake whole =
      settings.separate ? WholeBake{bakeSeparately(scene, settings, report, watch), {}, {}} : bakeWhole(scene, settings, report, watch);
  EncodedAsset asset{std::move(whole.lobes), {}, std::move(whole.lattice)};
  std::vector<std::vector<Lobe>> per_part;
  for (auto first = asset.lobes.begin(); const SculptPart& part : scene.sculpt.parts) {
    const auto end = first + ptrdiff_t(part.positions.size());
    per_part.emplace_back(first, end);
    first = end;
  }
  asset.glb = namingFile(report.input, [&] {
    report.info.first_uv_set = chooseUvSet(scene.sculpt, settings.gltf);
    report.info.separate = settings.separate;
    return encodeGlb(scene.sculpt, per_part, report.info, settings.gltf, report.warnings, whole.harmonics);
  });
  enforceStrict(settings, report);
  return asset;
}

void writeAsset(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const EncodedAsset asset = encodeAsset(scene, settings, report, watch);
  for (const LatticeFile& file : asset.lattice) writeFileAtomically(settings.lattice->parent_path() / file.name, file.bytes);
  writeFileAtomically(settings.output, asset.glb);
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

std::string warningLines(const BakeReport& report) {
  std::string lines;
  for (const auto& [kind, entry] : report.warnings.entries())
    lines +=
        "cloudbake: " + report.input + ": warning: " + std::string(warningName(kind)) + ": " + entry.first + timesOf(entry.count) + "\n";
  return lines;
}

namespace {

void printReport(const Settings& settings, const BakeReport& report) {
  std::fputs(warningLines(report).c_str(), stderr);
  if (settings.quiet) return;
  for (const auto& [kind, entry] : report.findings.entries())
    std::printf("%-11s %s%s\n", "found", (std::string(warningName(kind)) + ": " + entry.first).c_str(), timesOf(entry.count).c_str());
  std::fputs(reportText(report).c_str(), stdout);
}

}  // namespace

void tellReport(const Settings& settings, const BakeReport& report) {
  if (settings.json) writeFileAtomically(*settings.json, reportJson(report));
  printReport(settings, report);
}

void tellReport(const Settings& settings, const BakeReport& report, const char* key, const Json& more, const std::string& text) {
  if (settings.json) {
    Json json = Json::parse(reportJson(report));
    json[key] = more;
    writeFileAtomically(*settings.json, json.dump(2) + "\n");
  }
  printReport(settings, report);
  if (!settings.quiet) std::fputs(text.c_str(), stdout);
}

}  // namespace cloudbake
