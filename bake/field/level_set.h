// Spheres or a closed mesh → narrow-band level set in a frame centred on the shape.
#pragma once

#include <optional>
#include <span>

#include "bake/field/billow_noise.h"
#include "core/types.h"

namespace cloudbake {

struct LevelSetSettings {
  int voxels = 100;                    ///< along the longest side of the bounding box, ≥ 1
  std::optional<float> voxel_size;     ///< world units; overrides `voxels`
  float blend = 0;                     ///< spheres: width of the smooth union, world units; 0 = exact union
  std::optional<float> flat_base;      ///< spheres: height (world y) of a plane that cuts the cloud, smoothed by `blend`
  std::optional<BillowNoise> noise;    ///< spheres: bumps that grow outwards, above the flat base; they do not change the voxel size
  uint64_t memory_limit = 8ULL << 30;  ///< bytes; an estimate above is refused
};

/// The lattice that the settings give for a shape. Throws InputError where the box is empty or has no extent.
GridFrame frameFor(const Box& box, const LevelSetSettings& settings);

/// The lattice for a mesh, after the checks that every field needs: triangles, finite positions, a memory estimate under the limit.
/// Counts coarse coordinates. Throws InputError.
using BytesEstimate = double (*)(const Box& box, double voxel_size);
GridFrame meshFrame(const SurfaceMesh& mesh, const LevelSetSettings& settings, BytesEstimate estimate, Warnings& warnings);

/// Counts an inverted mesh (negative signed volume), and a field that holds under half of the mesh's volume. World units³.
void warnIfNotHeld(double volume_of_mesh, double volume_of_field, Warnings& warnings);

/// Upper estimate of the bytes that a level set of this box takes, the mesh drawn from it included.
double estimateBytes(const Box& box, double voxel_size);

/// Union of spheres. Smooth where `blend` > 0: surfaces at equal distance are raised by blend/4.
/// Counts spheres under 1.5 voxels (they stay in, but the grid cannot hold them faithfully) and coarse coordinates.
/// Noise moves and scales with the shape: its place is relative to the middle of the box. Every bump on an exact union hangs on a sphere.
/// Counts noise whose finest bumps are under 2 voxels wide.
/// Throws InputError: no spheres, a sphere that is not finite, nothing inside, memory estimate above the limit; noise that is
/// negative, not finite, not of 1 … 8 octaves, or so steep that bumps could come loose: amplitude · billowSlope(octaves) ≥ size.
LevelSet levelSetFromSpheres(std::span<const Sphere> spheres, const LevelSetSettings& settings, Warnings& warnings);

/// Inside = winding number ≠ 0: overlapping shells count once, a reversed inner shell is a cavity, and a mesh turned inside
/// out is solid. The mesh must be closed (findDefects: no unmatched edges); `levelSetFromOpenMesh` is for the rest.
/// Counts coarse coordinates, an inverted mesh, and a volume that the grid lost. Throws InputError as above.
LevelSet levelSetFromMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings);

/// OpenVDB's own signing, which floods from outside: right where every hole is narrower than the band.
/// Throws InputError where the result holds under half of the volume that the mesh suggests (a scan that fell to crumbs).
LevelSet levelSetFromOpenMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings);

/// Volume of the voxels whose centre is inside, world units³.
double insideVolume(const LevelSet& level_set);

}  // namespace cloudbake
