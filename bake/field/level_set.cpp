// Spheres: φ of bake/field/sphere_field.h, in the blocks that the band touches.
//
// Meshes: OpenVDB's meshToVolume gives the unsigned distance. It is signed by the winding number of each voxel (bake/field/winding.h)
// and then flooded inwards. OpenVDB's own signing floods from outside, so it would fill every closed cavity.
#include "bake/field/level_set.h"

#include <fmt/format.h>

#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "bake/field/sphere_field.h"
#include "bake/field/winding.h"
#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/level_set_type.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "core/portable_math.h"

namespace cloudbake {

namespace {

constexpr float kBand = kBandHalfWidth_voxels;
constexpr int kBlock = 8;  // OpenVDB's leaf: 8³ voxels
constexpr float kSmallestRadius_voxels = 1.5F;
constexpr double kFinestBump_voxels = 1e-3;  // so that float resolves the position in a bump everywhere

// --- spheres ---

using Leaf = openvdb::FloatTree::LeafNodeType;

// One block of φ, or nothing if the surface is farther away than the band.
std::unique_ptr<Leaf> sphereBlock(const openvdb::Coord& origin, std::span<const IndexSphere> spheres, const SphereField& field) {
  const float middle = 0.5F * (kBlock - 1), half_diagonal = std::sqrt(3.0F) * middle;
  const Vec3 center{origin.x() + middle, origin.y() + middle, origin.z() + middle};
  const std::vector<IndexSphere> near = spheresNear(center, half_diagonal, spheres, field);
  if (near.empty()) return nullptr;
  std::vector<float> distances(near.size());
  if (isBeyondBand(center, half_diagonal, near, distances, field)) return nullptr;

  auto leaf = std::make_unique<Leaf>(origin, kBand, false);
  bool any = false;
  for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
    const openvdb::Coord ijk = leaf->offsetToGlobalCoord(n);
    const float phi = sphereFieldAt({float(ijk.x()), float(ijk.y()), float(ijk.z())}, near, distances, field);
    const bool in_band = std::fabs(phi) < kBand;
    leaf->setValueOnly(n, std::clamp(phi, -kBand, kBand));
    leaf->setActiveState(n, in_band);
    any = any || in_band;
  }
  return any ? std::move(leaf) : nullptr;
}

openvdb::FloatGrid::Ptr gridFromBlocks(std::vector<std::unique_ptr<Leaf>>& blocks) {
  auto grid = openvdb::FloatGrid::create(kBand);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  for (auto& leaf : blocks)
    if (leaf) grid->tree().addLeaf(leaf.release());
  openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

Box widened(const Box& box, float by) { return {box.low - Vec3{by, by, by}, box.high + Vec3{by, by, by}}; }

Box sphereBox(std::span<const Sphere> spheres, const LevelSetSettings& settings) {
  if (spheres.empty()) throw InputError("", "there are no spheres to make a cloud from");
  Box box;
  for (size_t i = 0; i < spheres.size(); ++i) {
    const auto [center, radius] = spheres[i];
    if (!isFinite(center) || !std::isfinite(radius) || radius < 0)
      throw InputError("", "sphere " + std::to_string(i) + " is not finite or has a negative radius");
    box.add(center - Vec3{radius, radius, radius});
    box.add(center + Vec3{radius, radius, radius});
  }
  const float hanging = settings.base_bumps ? settings.base_bumps->amplitude : 0;
  if (settings.flat_base) box.low.y = std::max(box.low.y, *settings.flat_base - hanging);
  if (!(box.low.y <= box.high.y))
    throw InputError("", fmt::format("the base at y = {:g} cuts the whole cloud away: lower --flat-base", *settings.flat_base));
  return box;
}

// The options that set a noise, for messages.
struct NoiseOptions {
  const char *amplitude, *size, *coarser;
};

void checkNoise(const BillowNoise& noise, const NoiseOptions& told, double voxel_size, Warnings& warnings) {
  const auto& [amplitude, size, octaves, seed] = noise;
  if (!std::isfinite(amplitude) || !std::isfinite(size) || amplitude < 0 || size < 0 || (amplitude > 0 && size == 0))
    throw InputError(
        "", fmt::format("noise of amplitude {:g} and size {:g}: the amplitude must be 0 or more and the size above 0", amplitude, size));
  if (octaves < 1 || octaves > kMostOctaves) throw InputError("", fmt::format("{} octaves of noise: use 1 to {}", octaves, kMostOctaves));
  if (amplitude == 0) return;
  if (!(amplitude / double(size) * billowSlope(octaves) < 1))
    throw InputError("", fmt::format("noise of amplitude {:g} is so steep at size {:g} that bumps could come loose", amplitude, size) +
                             fmt::format(" (a size over {0:.4g} is safe): use a smaller {1} or a larger {2}",
                                         amplitude * billowSlope(octaves), told.amplitude, told.size));
  const double finest_voxels = size / voxel_size / (1 << (octaves - 1));
  if (finest_voxels < kFinestBump_voxels)
    throw InputError("", fmt::format("the finest bumps of the noise are {:.2g} voxels wide: use {} or a larger {}", finest_voxels,
                                     told.coarser, told.size));
  if (finest_voxels < kSmallestBump_voxels)
    warnings.add(WarningKind::kNoiseTooFine,
                 fmt::format("the finest bumps of the noise are {:.2g} voxels wide, under {:g}: use more --voxels or {}", finest_voxels,
                             kSmallestBump_voxels, told.coarser));
}

BillowNoise inVoxels(BillowNoise noise, double voxel_size) {
  noise.amplitude = float(noise.amplitude / voxel_size);
  noise.size = float(noise.size / voxel_size);
  return noise;
}

double slopeOf(const BillowNoise& noise) { return noise.amplitude / double(noise.size) * billowSlope(noise.octaves); }

// The settings in index space.
SphereField sphereField(const LevelSetSettings& settings, const GridFrame& frame) {
  const auto widthOf = [&](float blend) { return float(blend / frame.voxel_size / (4 * portableLog(2.0F))); };
  SphereField field{.band_voxels = kBand, .k_voxels = widthOf(settings.blend)};
  if (settings.flat_base) field.base_voxels = float((double(*settings.flat_base) - frame.origin[1]) / frame.voxel_size);
  if (settings.noise && settings.noise->amplitude > 0) {
    field.noise = inVoxels(*settings.noise, frame.voxel_size);
    field.steepest = float(1 + slopeOf(*settings.noise));
  }
  field.base_k_voxels = widthOf(settings.base_softness.value_or(settings.blend));
  if (settings.flat_base && settings.base_bumps && settings.base_bumps->amplitude > 0) {
    field.base_bumps = inVoxels(*settings.base_bumps, frame.voxel_size);
    field.steepest = std::max(field.steepest, float(1 + slopeOf(*settings.base_bumps)));
  }
  return field;
}

// For the first of equal spheres, how many there are; 0 for the others.
std::vector<uint32_t> copiesOf(std::span<const Sphere> spheres) {
  const auto key = [&](uint32_t i) { return std::tie(spheres[i].center.x, spheres[i].center.y, spheres[i].center.z, spheres[i].radius); };
  std::vector<uint32_t> order(spheres.size()), copies(spheres.size());
  std::iota(order.begin(), order.end(), 0U);
  parallelSort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  uint32_t first = 0;
  for (const uint32_t i : order) {
    if (key(i) != key(first) || copies[first] == 0) first = i;
    ++copies[first];
  }
  return copies;
}

// Equal spheres become one: in the union, n of them are one whose radius is larger by k ln n.
std::vector<IndexSphere> toIndexSpheres(std::span<const Sphere> spheres, const GridFrame& frame, float k_voxels, Warnings& warnings) {
  const std::vector<uint32_t> copies = copiesOf(spheres);
  std::vector<IndexSphere> result;
  uint64_t small = 0;
  for (size_t i = 0; i < spheres.size(); ++i) {
    const float radius = float(spheres[i].radius / frame.voxel_size);
    small += radius < kSmallestRadius_voxels;
    if (copies[i] > 0) result.push_back({frame.toIndex(spheres[i].center), radius + k_voxels * portableLog(float(copies[i]))});
  }
  warnings.add(WarningKind::kSphereTooSmall, "a sphere has a radius under 1.5 voxels: use more --voxels to keep its shape", small);
  return result;
}

// --- meshes ---

struct IndexMesh {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
};

std::vector<Vec3> indexPositions(const SurfaceMesh& mesh, const GridFrame& frame) {
  std::vector<Vec3> result;
  result.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) result.push_back(frame.toIndex(p));
  return result;
}

// OpenVDB's distances near the band's edge depend on the order of the triangles and of their corners, so both are sorted by position.
IndexMesh toIndexMesh(std::span<const Vec3> positions_index, const SurfaceMesh& mesh) {
  const auto is_before = [&](uint32_t a, uint32_t b) {
    const Vec3 &p = positions_index[a], &q = positions_index[b];
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  std::vector<Triangle> triangles = mesh.triangles;
  for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end(), is_before), t.end());
  std::sort(triangles.begin(), triangles.end(), [&](const Triangle& a, const Triangle& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), is_before);
  });
  IndexMesh result;
  for (const Vec3& p : positions_index) result.points.emplace_back(p.x, p.y, p.z);
  for (const Triangle& t : triangles) result.triangles.emplace_back(t[0], t[1], t[2]);
  return result;
}

// What OpenVDB asks, from any thread, whether it is to stop.
struct Interrupter {
  const LoopStop* stop = LoopStop::current();
  void start(const char* /*name*/ = nullptr) {}
  void end() {}
  bool wasInterrupted(int /*percent*/ = -1) const { return stop && stop->isRequested(); }
};

openvdb::FloatGrid::Ptr distanceGrid(const IndexMesh& mesh, int flags) {
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(mesh.points, mesh.triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  Interrupter interrupter;
  auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(interrupter, adapter, *transform, kBand, kBand, flags);
  throwIfLoopsStop();
  return grid;
}

void signByWinding(openvdb::FloatGrid& grid, const WindingColumns& columns) {
  std::vector<Leaf*> leaves;
  grid.tree().getNodes(leaves);
  parallelFor(leaves.size(), [&](size_t l) {
    for (auto value = leaves[l]->beginValueAll(); value; ++value) {
      const openvdb::Coord ijk = value.getCoord();
      if (windingNumber(columns, ijk.x(), ijk.y(), float(ijk.z())) != 0) value.setValue(-*value);
    }
  });
  openvdb::tools::signedFloodFill(grid.tree());
  grid.setGridClass(openvdb::GRID_LEVEL_SET);
}

LevelSet held(openvdb::FloatGrid::Ptr vdb, const GridFrame& frame) {
  return {std::make_shared<LevelSetGrid>(LevelSetGrid{std::move(vdb)}), frame};
}

}  // namespace

LevelSet levelSetFromSpheres(std::span<const Sphere> spheres, const LevelSetSettings& settings, Warnings& warnings) {
  const Box box = sphereBox(spheres, settings);
  const GridFrame frame = frameFor(box, settings);
  if (settings.noise) checkNoise(*settings.noise, {"--noise", "--noise-size", "fewer --noise-octaves"}, frame.voxel_size, warnings);
  if (settings.base_bumps)
    checkNoise(*settings.base_bumps, {"--base-bumps", "--base-bump-size", "a larger --base-bump-size"}, frame.voxel_size, warnings);
  const Box bumpy_box = settings.noise ? widened(box, settings.noise->amplitude) : box;
  checkMemory(estimateBytes(bumpy_box, frame.voxel_size), bumpy_box, frame.voxel_size, settings.memory_limit);
  warnIfCoarse(box, warnings);
  const SphereField field = sphereField(settings, frame);
  const std::vector<IndexSphere> index_spheres = toIndexSpheres(spheres, frame, field.k_voxels, warnings);

  // Blocks of the box, widened by the band and by the most that blend and noise can add.
  const float margin = field.farthestThatCounts() + 2 + 4 * field.k_voxels * portableLog(float(spheres.size()) + 1);
  const Vec3 low = frame.toIndex(box.low), high = frame.toIndex(box.high);
  const auto block = [](float index) { return int(std::floor(index / kBlock)); };
  const openvdb::Coord first(block(low.x - margin), block(low.y - margin), block(low.z - margin));
  const openvdb::Coord last(block(high.x + margin), block(high.y + margin), block(high.z + margin));
  const openvdb::Coord count = last - first + openvdb::Coord(1);
  const double all = double(count.x()) * count.y() * count.z();
  requireMemory({countText(all) + " blocks of 8×8×8 voxels, as far as the spheres, their blend and their noise reach,", all * sizeof(void*),
                 "use fewer --voxels or a smaller --blend"},
                settings.memory_limit);
  std::vector<std::unique_ptr<Leaf>> blocks(size_t(count.x()) * size_t(count.y()) * size_t(count.z()));
  const LoopProgress::Counted counted;
  parallelFor(blocks.size(), [&](size_t i) {
    const openvdb::Coord at(int(i / size_t(count.z()) / size_t(count.y())), int(i / size_t(count.z()) % size_t(count.y())),
                            int(i % size_t(count.z())));
    const openvdb::Coord b = first + at;
    blocks[i] = sphereBlock(openvdb::Coord(b.x() * kBlock, b.y() * kBlock, b.z() * kBlock), index_spheres, field);
  });
  LevelSet level_set = held(gridFromBlocks(blocks), frame);
  if (!(insideVolume(level_set) > 0)) throw InputError("", "the spheres are too small for the grid, so nothing is left: use more --voxels");
  return level_set;
}

LevelSet levelSetFromMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings) {
  const GridFrame frame = meshFrame(mesh, settings, estimateBytes, warnings);
  const std::vector<Vec3> positions = indexPositions(mesh, frame);
  LevelSet level_set = held(distanceGrid(toIndexMesh(positions, mesh), openvdb::tools::UNSIGNED_DISTANCE_FIELD), frame);
  signByWinding(*level_set.grid->vdb, windingColumns(latticePoints(positions), mesh.triangles));

  warnIfNotHeld(signedVolume(mesh), insideVolume(level_set), warnings);
  return level_set;
}

LevelSet levelSetFromOpenMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings) {
  const GridFrame frame = meshFrame(mesh, settings, estimateBytes, warnings);
  LevelSet level_set = held(distanceGrid(toIndexMesh(indexPositions(mesh, frame), mesh), 0), frame);
  const double of_mesh = std::fabs(signedVolume(mesh)), of_grid = insideVolume(level_set);
  if (of_grid < 0.5 * of_mesh || of_grid == 0)
    throw InputError("", fmt::format("the mesh is open, and its level set contains only {:.2g} of its signed volume: close the holes",
                                     of_grid / of_mesh));
  return level_set;
}

LevelSet withoutDetail(const LevelSet& level_set, double radius_voxels) {
  openvdb::FloatGrid::Ptr grid = level_set.grid->vdb->deepCopy();
  openvdb::tools::LevelSetFilter<openvdb::FloatGrid> filter(*grid);
  filter.setSpatialScheme(openvdb::math::FIRST_BIAS);  // quick, and the offsets undo each other
  filter.setTemporalScheme(openvdb::math::TVD_RK1);
  filter.setNormCount(2);
  const auto r = float(radius_voxels);
  filter.offset(-r);
  filter.offset(2 * r);
  filter.offset(-r);
  return held(std::move(grid), level_set.frame);
}

double insideVolume(const LevelSet& level_set) {
  double voxels = 0;
  for (auto value = level_set.grid->vdb->cbeginValueAll(); value; ++value)
    voxels += (*value < 0 ? 1.0 : *value == 0 ? 0.5 : 0.0) * double(value.getVoxelCount());
  const double h = level_set.frame.voxel_size;
  return voxels * h * h * h;
}

}  // namespace cloudbake
