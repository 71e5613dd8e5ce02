// Inside fractions of cells, straight from triangles or from a level set.
#pragma once

#include <optional>
#include <span>

#include "bake/field/level_set.h"
#include "core/types.h"

namespace cloudbake {

/// Upper estimate of the bytes that a coverage field of this box and a sweep through it take: the copies per axis, and the planes of every
/// thread.
double estimateCoverageBytes(const Box& box, double voxel_size);

/// Rasterises a mesh whose inside (winding number ≠ 0) is definite. A cell's fraction is the mean of the inside shares of three lines
/// through its centre, one along each axis: right in the mean over the places of a surface in its cell, by up to a third of a cell off at
/// one place. Nothing where a column's winding does not close: the mesh is open, and needs a level set. Triangles must be finite.
std::optional<CoverageField> coverageFromMesh(const SurfaceMesh& mesh, const GridFrame& frame);

/// The same on the lattice that the settings give, after the checks of meshFrame. Counts an inverted mesh and a lost volume.
std::optional<CoverageField> coverageFromClosedMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings);

/// Fractions from the signed distance at the cells' centres: ½ − φ in voxels, between 0 and 1. The field reaches around `points` (world
/// units), wherever they lie.
CoverageField coverageFromLevelSet(const LevelSet& level_set, std::span<const Vec3> points = {});

}  // namespace cloudbake
