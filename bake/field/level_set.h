// Converts spheres or a mesh to a narrow-band level set, in a frame centred on the shape.
#pragma once

#include <optional>
#include <span>

#include "bake/field/billow_noise.h"
#include "core/memory_budget.h"
#include "core/types.h"

namespace cloudbake {

struct LevelSetSettings {
  int voxels = 100;                            ///< voxels along the longest side of the bounding box, ≥ 1
  std::optional<float> voxel_size;             ///< world units; overrides `voxels`
  float blend = 0;                             ///< spheres: width of the smooth union, world units; 0 = exact union
  std::optional<float> flat_base;              ///< spheres: height (world y) of a plane that cuts the cloud, smoothed by `blend`
  std::optional<float> base_softness = {};     ///< spheres: width over which the flat base rounds its rim, world units; unset = blend
  std::optional<BillowNoise> base_bumps = {};  ///< spheres: bumps that hang from the flat base
  std::optional<BillowNoise> noise;      ///< spheres: bumps that grow outwards, above the flat base; noise does not change the voxel size
  uint64_t memory_limit = kMemoryLimit;  ///< bytes; an estimate above this is an error
};

/// The lattice of a shape for these settings. Throws InputError if the box is empty or has no extent.
GridFrame frameFor(const Box& box, const LevelSetSettings& settings);

/// The lattice of a mesh. Counts coarse coordinates. Throws InputError unless the mesh has triangles and finite positions and the memory
/// estimate is within the limit.
using BytesEstimate = double (*)(const Box& box, double voxel_size);
GridFrame meshFrame(const SurfaceMesh& mesh, const LevelSetSettings& settings, BytesEstimate estimate, Warnings& warnings);

/// Counts coordinates so far from the origin that float32 has visible steps there.
void warnIfCoarse(const Box& box, Warnings& warnings);

/// Throws InputError if `bytes` exceed the limit, or the voxels along a side those of the winding numbers' lattice.
void checkMemory(double bytes, const Box& box, double voxel_size, uint64_t limit);

/// Counts an inverted mesh (negative signed volume) and a field that contains less than half of the mesh's volume. World units³.
void warnIfNotHeld(double volume_of_mesh, double volume_of_field, Warnings& warnings);

/// Upper estimate of the bytes that a level set of this box needs, including the mesh that is extracted from it.
double estimateBytes(const Box& box, double voxel_size);

/// Bumps of noise that are narrower than this are counted as kNoiseTooFine.
inline constexpr double kSmallestBump_voxels = 2;

/// The union of spheres. It is smooth if `blend` > 0, and then rises by blend/4 where two surfaces are equally far.
/// Counts spheres with a radius under 1.5 voxels (they are kept, but the grid cannot represent them well) and coarse coordinates.
/// Noise moves and scales with the shape, because its position is relative to the centre of the box. Every bump on an exact union is
/// attached to a sphere. Counts noise whose finest bumps are under 2 voxels wide.
/// Throws InputError for no spheres, a sphere that is not finite, nothing inside, or a memory estimate above the limit; also for noise that
/// is negative, not finite, not of 1 … 8 octaves, or so steep that bumps could come loose: amplitude · billowSlope(octaves) ≥ size.
LevelSet levelSetFromSpheres(std::span<const Sphere> spheres, const LevelSetSettings& settings, Warnings& warnings);

/// Inside means a winding number ≠ 0: overlapping shells count once, a reversed inner shell is a cavity, and a mesh turned inside
/// out is solid. The mesh must be closed (findDefects: no unmatched edges); for open meshes use `levelSetFromOpenMesh`.
/// Counts coarse coordinates, an inverted mesh, and volume that the grid lost. Throws InputError as above.
LevelSet levelSetFromMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings);

/// Uses OpenVDB's own signing, which floods from outside. The result is right if every hole is narrower than the band.
/// Throws InputError if the result contains less than half of the mesh's signed volume (a scan that fell apart).
LevelSet levelSetFromOpenMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings);

/// The shape without what is narrower than two radii: first gaps, holes and folds are closed (a closing by a ball), then threads and sheets
/// are removed (an opening). `radius` in voxels. Thick parts keep their place within a tenth of a voxel. May be empty.
LevelSet withoutDetail(const LevelSet& level_set, double radius_voxels);

/// Volume of the voxels whose centre is inside, world units³.
double insideVolume(const LevelSet& level_set);

}  // namespace cloudbake
