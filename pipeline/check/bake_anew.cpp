#include "pipeline/check/bake_anew.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "bake/lobe/directions.h"
#include "bake/lobe/sparse_points.h"
#include "bake/mesh/mesh_topology.h"
#include "io/report/report.h"
#include "pipeline/lobes/lobes.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

// A bake with more than these would take long, and they are not what makes it right.
constexpr int kMostRays = 4096, kMostSteps = 4096, kMostSmoothing = 100;
constexpr float kMostVoxels = 1000, kLeastVoxels = 4;

template <typename Choice>
Choice chosen(const std::string& name, std::initializer_list<Choice> choices, const auto& nameOf) {
  const auto found = std::find_if(choices.begin(), choices.end(), [&](Choice choice) { return nameOf(choice) == name; });
  return found == choices.end() ? *choices.begin() : *found;
}

struct NewBakeSettings {
  LobeSettings lobe;
  FieldSettings field;
  BakeParameters parameters;
};

// The longest side of the largest object.
float longestObject(const Cloud& cloud) {
  std::map<int, Box> boxes;
  for (size_t i = 0, first = 0; i < cloud.sculpt.parts.size(); ++i) {
    const SculptPart& part = cloud.sculpt.parts[i];
    for (size_t v = 0; v < part.positions.size(); ++v) boxes[part.object].add(cloud.surface.positions[first + v]);
    first += part.positions.size();
  }
  float longest = 0;
  for (const auto& [object, box] : boxes) longest = std::max(longest, box.longestSide());
  return longest;
}

enum class Constants { kRecorded, kDefault };

NewBakeSettings settingsOfAsset(const Cloud& cloud, const AssetInfo& info, const MeshSettings& mesh,
                                Constants constants = Constants::kRecorded) {
  const Box box = boundingBox(cloud.surface);
  Settings settings;
  settings.mesh = mesh;
  LobeSettings& lobe = settings.lobe;
  BakeSettings& bake = lobe.bake;
  if (info.method == "rays") bake.method = Method::kRays;
  bake.sampler = chosen(info.sampler, {Sampler::kStratified, Sampler::kFibonacci, Sampler::kUniform}, samplerName);
  bake.quadrature = chosen(info.quadrature, {Quadrature::kCrossing, Quadrature::kMidpoint, Quadrature::kEnd}, quadratureName);
  if (info.rays > 0) bake.rays = std::min(info.rays, kMostRays);
  if (bake.method == Method::kSweep) bake.rays += bake.rays % 2;
  if (info.steps > 0) bake.steps = std::min(info.steps, kMostSteps);
  if (info.ray_length > 0) bake.ray_length = info.ray_length;
  bake.seed = info.seed;
  lobe.fit = info.lobe == "fit";
  lobe.fit_to_volume = info.volume.has_value();
  if (info.volume) lobe.volume = {info.volume->view_extinction, info.volume->asymmetry, info.volume->octaves};
  if (constants == Constants::kRecorded) {
    lobe.exponent = info.shape.exponent;
    lobe.bias = Length{info.shape.bias, false};
    const std::pair one(info.extinction, info.extinction);
    lobe.extinction_range = lobe.fit ? rangeOfFit(info).value_or(one) : one;
  } else {
    lobe.fit_exponent = lobe.fit_bias = lobe.fit_to_volume;
  }
  lobe.sun_arc = info.sun_arc;
  lobe.harmonic_order = info.harmonic_order;
  lobe.smooth = std::min(info.smooth, kMostSmoothing);
  if (info.field == "level set") settings.field.kind = FieldChoice::kLevelSet;
  const float longest = info.separate ? longestObject(cloud) : box.longestSide();
  if (info.voxel_size >= longest / kMostVoxels && info.voxel_size <= longest / kLeastVoxels) {
    // A whole number of voxels along the longest side gives their size with all its digits, and to each object its own lattice.
    const double voxels = double(longest) / double(info.voxel_size), whole = std::round(voxels);
    if (std::fabs(voxels - whole) < 1e-4)
      settings.field.voxels = int(whole);
    else
      settings.field.voxel_size = info.voxel_size;
  }
  const BakeParameters parameters = parametersFor(cloud, settings);
  return {lobe, fieldSettings(settings.field, parameters), parameters};
}

SurfaceMesh pickedPoints(const SurfaceMesh& surface, std::span<const size_t> vertices) {
  return {pick(surface.positions, vertices), pick(surface.normals, vertices), {}};
}

// The lobes of some vertices as a bake of all gives them: those of many are blended between those of a few.
ShapedLobes lobesLike(const SurfaceMesh& surface, const SurfaceMesh& some, std::span<const size_t> chosen, const IntegrationField& field,
                      const NewBakeSettings& settings, Warnings& warnings) {
  if (!settings.lobe.fit || !settings.lobe.fit_to_volume || !SparsePoints::mayChoose(surface.positions.size()))
    return lobesAt(some, field, settings.lobe, settings.parameters, warnings);
  ShapedLobes lobes = lobesAt(surface, field, settings.lobe, settings.parameters, warnings);
  lobes.lobes = pick(lobes.lobes, chosen);
  return lobes;
}

// Appends the bake of a cloud whose vertices follow `first` others.
void bakeOne(const Cloud& cloud, const NewBakeSettings& settings, size_t first, size_t most, Warnings& warnings, NewBake& baked) {
  const IntegrationField field = buildField(cloud, settings.field, settings.parameters.bake.method, warnings);
  const size_t count = cloud.surface.positions.size();
  const bool whole = settings.lobe.smooth > 0;
  const std::vector<size_t> own = drawnFromStretches(count, whole ? count : most);
  const SurfaceMesh points = pickedPoints(cloud.surface, own);
  if (whole) {
    Stopwatch watch;
    StageSeconds seconds;
    const BakedLobes lobes = bakeLobes(cloud, field, settings.lobe, settings.parameters, warnings, watch, seconds);
    baked.lobes.insert(baked.lobes.end(), lobes.lobes.begin(), lobes.lobes.end());
  } else {
    const ShapedLobes lobes = lobesLike(cloud.surface, points, own, field, settings, warnings);
    baked.lobes.insert(baked.lobes.end(), lobes.lobes.begin(), lobes.lobes.end());
  }
  for (const size_t v : own) baked.vertices.push_back(first + v);
  if (settings.lobe.harmonic_order == 0) return;
  const std::vector<float> harmonics =
      bakeHarmonics({points.positions, points.normals}, field, settings.lobe.harmonic_order, settings.lobe, settings.parameters);
  baked.harmonics.insert(baked.harmonics.end(), harmonics.begin(), harmonics.end());
}

}  // namespace

std::optional<std::pair<float, float>> rangeOfFit(const AssetInfo& info) {
  if (!(info.extinction_low > 0 && info.extinction_high >= info.extinction_low)) return std::nullopt;
  return std::pair(info.extinction_low, info.extinction_high);
}

std::vector<Lobe> lobesByDefault(const Cloud& cloud, const AssetInfo& info, std::span<const size_t> vertices, LobeShape& shape,
                                 Warnings& warnings) {
  const NewBakeSettings settings = settingsOfAsset(cloud, info, {}, Constants::kDefault);
  const IntegrationField field = buildField(cloud, settings.field, settings.parameters.bake.method, warnings);
  // A search looks at vertices of the whole cloud.
  if (settings.lobe.fit_exponent) {
    const ShapedLobes all = lobesAt(cloud.surface, field, settings.lobe, settings.parameters, warnings);
    shape = all.shape;
    return pick(all.lobes, vertices);
  }
  const ShapedLobes some = lobesAt(pickedPoints(cloud.surface, vertices), field, settings.lobe, settings.parameters, warnings);
  shape = some.shape;
  return some.lobes;
}

HarmonicLattice latticeAnew(const Cloud& cloud, const AssetInfo& info, const MeshSettings& mesh, const HarmonicLattice& like) {
  NewBakeSettings settings = settingsOfAsset(cloud, info, mesh);
  settings.lobe.harmonic_order = like.order;
  settings.lobe.lattice_cells = int(std::lround(boundingBox(cloud.surface).longestSide() / like.cell_size));
  Warnings told_by_the_bake;
  const IntegrationField field = buildField(cloud, settings.field, settings.parameters.bake.method, told_by_the_bake);
  return bakeLattice(cloud, field, settings.lobe, settings.parameters);
}

NewBake bakeAnew(const Cloud& cloud, const AssetInfo& info, const MeshSettings& mesh, size_t most, Warnings& warnings) {
  const NewBakeSettings settings = settingsOfAsset(cloud, info, mesh);
  NewBake baked;
  if (!info.separate) {
    bakeOne(cloud, settings, 0, most, warnings, baked);
    return baked;
  }
  BakeReport report;
  size_t first = 0;
  for (const Cloud& object : separateObjects(cloud, mesh, report)) {
    const size_t own = object.surface.positions.size();
    bakeOne(object, settings, first, std::max<size_t>(1, most * own / cloud.surface.positions.size()), warnings, baked);
    first += own;
  }
  return baked;
}

}  // namespace cloudbake
