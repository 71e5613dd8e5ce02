#include "pipeline/fields/fields.h"

#include <fmt/format.h>

#include <cmath>

#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/repair.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"

namespace cloudbake {

namespace {

constexpr int kBaseOctaves = 2;
constexpr float kBumpSpacing = 5;  // of the bumps of a base, in heights

// The size of the largest bumps of this many octaves of noise.
float bumpSize(const FieldSettings& settings, float amplitude, int octaves, float longest_side) {
  const float least = amplitude * float(billowSlope(octaves));  // smaller bumps would come loose
  return settings.noise_size ? settings.noise_size->resolve(longest_side) : 1.5F * least;
}

// The octaves of noise that were asked for, else as many, up to 3, as the lattice of the mesh can show. The integration field has the same.
int noiseOctaves(const Cloud& cloud, const FieldSettings& settings, float amplitude, float longest_side) {
  constexpr int kUsual = 3;
  constexpr float kClear = 1.001F * float(kSmallestBump_voxels);  // whatever is rounded
  if (settings.noise_octaves) return *settings.noise_octaves;
  const float voxel = cloud.voxel_size      ? float(*cloud.voxel_size)
                      : settings.voxel_size ? *settings.voxel_size
                                            : longest_side / float(settings.voxels);
  int octaves = kUsual;
  while (octaves > 1 && bumpSize(settings, amplitude, octaves, longest_side) < kClear * voxel * float(1 << (octaves - 1))) --octaves;
  return octaves;
}

LevelSetSettings levelSetSettings(const Cloud& cloud, const FieldSettings& settings, Lattice lattice, float longest_side) {
  LevelSetSettings result;
  result.voxels = settings.voxels;
  result.voxel_size = cloud.voxel_size ? cloud.voxel_size : settings.voxel_size;
  if (lattice == Lattice::kIntegration && settings.bake_voxels) {
    result.voxels = *settings.bake_voxels;
    result.voxel_size.reset();
  }
  result.blend = settings.blend.resolve(longest_side);
  result.flat_base = settings.flat_base;
  if (settings.base_softness) result.base_softness = settings.base_softness->resolve(longest_side);
  if (settings.base_bumps && settings.base_bumps->value > 0) {
    const float amplitude = settings.base_bumps->resolve(longest_side);
    const float size = settings.base_bump_size ? settings.base_bump_size->resolve(longest_side) : kBumpSpacing * amplitude;
    result.base_bumps = BillowNoise{amplitude, size, kBaseOctaves, settings.noise_seed};
  }
  result.memory_limit = settings.memory_limit;
  if (settings.noise && settings.noise->value > 0) {
    const float amplitude = settings.noise->resolve(longest_side);
    const int octaves = noiseOctaves(cloud, settings, amplitude, longest_side);
    result.noise = BillowNoise{amplitude, bumpSize(settings, amplitude, octaves, longest_side), octaves, settings.noise_seed};
  }
  return result;
}

// The wrap of a mesh, with an α of down to four voxels of the lattice. Throws if the lattice would need too much memory. Warnings about the
// lattice are dropped here, because building the field from the wrap reports them again.
Wrap wrapFor(const SurfaceMesh& surface, const LevelSetSettings& settings) {
  Warnings told_later;
  return wrapClosed(surface, 4 * meshFrame(surface, settings, estimateBytes, told_later).voxel_size);
}

// The level set of a closed mesh, or of one whose holes could be filled, is made directly. For any other mesh OpenVDB's own signing is used
// if its volume agrees with that of a wrap, else the wrap.
LevelSet sculptLevelSet(const Cloud& cloud, const FieldSettings& choices, Lattice lattice, Warnings& warnings) {
  const SurfaceMesh& surface = cloud.surface;
  const LevelSetSettings settings = levelSetSettings(cloud, choices, lattice, boundingBox(surface).longestSide());
  if (cloud.wrapped) return levelSetFromMesh(wrapFor(surface, settings).mesh, settings, warnings);
  if (const SurfaceMesh* solid = cloud.solid()) return levelSetFromMesh(*solid, settings, warnings);
  if (!hasCgal()) return levelSetFromOpenMesh(surface, settings, warnings);
  const Wrap wrap = wrapFor(surface, settings);
  Warnings tried;
  try {
    LevelSet flooded = levelSetFromOpenMesh(surface, settings, tried);
    if (std::fabs(insideVolume(flooded) / wrap.volume - 1) < 0.2) {
      for (const auto& [kind, entry] : tried.entries()) warnings.add(kind, entry.first, entry.count);
      return flooded;
    }
  } catch (const MemoryError&) {
    throw;
  } catch (const InputError&) {
    // The level set fell apart, because the flood entered through a hole. Use the wrap.
  }
  warnings.add(WarningKind::kVolumeMismatch,
               fmt::format("the open mesh was closed by a wrap, across holes of up to {:.3g} world units", wrap.alpha));
  return levelSetFromMesh(wrap.mesh, settings, warnings);
}

}  // namespace

Box boundingBox(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& s : spheres) {
    box.add(s.center - Vec3{s.radius, s.radius, s.radius});
    box.add(s.center + Vec3{s.radius, s.radius, s.radius});
  }
  return box;
}

LevelSet levelSetOf(const Cloud& cloud, const FieldSettings& settings, Lattice lattice, Warnings& warnings) {
  if (cloud.level_set && !(lattice == Lattice::kIntegration && settings.bake_voxels)) return *cloud.level_set;
  if (!cloud.spheres.empty())
    return levelSetFromSpheres(cloud.spheres, levelSetSettings(cloud, settings, lattice, boundingBox(cloud.spheres).longestSide()),
                               warnings);
  return sculptLevelSet(cloud, settings, lattice, warnings);
}

// A moved field has its coverage in another place.
const SweepField& IntegrationField::swept() const {
  if (!swept_ || &swept_->coverage != &*coverage) swept_ = std::make_shared<SweepField>(*coverage);
  return *swept_;
}

IntegrationField buildField(const Cloud& cloud, const FieldSettings& settings, Method method, Warnings& warnings) {
  IntegrationField field;
  if (method == Method::kSweep && settings.kind != FieldChoice::kLevelSet) {
    const LevelSetSettings lattice = levelSetSettings(cloud, settings, Lattice::kIntegration, boundingBox(cloud.surface).longestSide());
    if (cloud.wrapped)
      field.coverage = coverageFromClosedMesh(wrapFor(cloud.surface, lattice).mesh, lattice, warnings);
    else if (const SurfaceMesh* solid = cloud.solid())
      field.coverage = coverageFromClosedMesh(*solid, lattice, warnings);
    if (!field.coverage && settings.kind == FieldChoice::kCoverage)
      warnings.add(WarningKind::kFieldFallback, "--field coverage needs a closed mesh: the level set is used instead");
    field.kind = "coverage";
    if (field.coverage) return field;
  }
  field.kind = "level set";
  const LevelSet level_set = levelSetOf(cloud, settings, Lattice::kIntegration, warnings);
  if (method == Method::kSweep)
    field.coverage = coverageFromLevelSet(level_set, cloud.surface.positions);
  else
    field.dense = denseFromLevelSet(level_set);
  return field;
}

std::vector<Lobe> meanLobes(const BakePoints& points, const IntegrationField& field, const BakeSettings& settings, Warnings& warnings) {
  if (field.coverage) return bakeSweep(points, field.swept(), settings, warnings);
  return bakeSphereRays(points, *field.dense, settings, warnings);
}

std::vector<float> estimatedLengths(std::span<const Vec3> positions, std::span<const Vec3> axes, const IntegrationField& field,
                                    const BakeSettings& settings) {
  if (field.dense) return marchedLengths(positions, bothSenses(axes), *field.dense, settings);
  const LoopProgress::Counted counted;
  const std::vector<float> swept = sweptLengths(positions, axes, field.swept(), settings.ray_length.value());
  std::vector<float> lengths(swept.size());
  const size_t directions = 2 * axes.size();
  for (size_t i = 0; i < directions; ++i)
    for (size_t v = 0; v < positions.size(); ++v) lengths[v * directions + i] = swept[i * positions.size() + v];
  return lengths;
}

bool truthIsMarched(const Cloud& cloud) { return !cloud.exact_spheres && !cloud.solid(); }

std::unique_ptr<Reference> referenceFor(const Cloud& cloud, const FieldSettings& settings) {
  if (cloud.exact_spheres) return sphereReference(cloud.spheres);
  if (const SurfaceMesh* solid = cloud.solid()) return meshReference(*solid);
  Warnings told_already;
  return marchReference(denseFromLevelSet(levelSetOf(cloud, settings, Lattice::kSurface, told_already)));
}

std::vector<size_t> evenlySpread(size_t count, size_t wanted) {
  std::vector<size_t> indices;
  const size_t n = std::min(count, wanted);
  for (size_t i = 0; i < n; ++i) indices.push_back(i * count / n);
  return indices;
}

std::vector<size_t> drawnFromStretches(size_t count, size_t wanted) {
  std::vector<size_t> drawn;
  const size_t stretches = std::min(count, wanted);
  for (size_t i = 0; i < stretches; ++i) {
    const size_t begin = i * count / stretches, end = (i + 1) * count / stretches;
    drawn.push_back(begin + hashDraw(kGolden64, uint32_t(i), 0) % (end - begin));
  }
  return drawn;
}

}  // namespace cloudbake
