// Computes the inside fractions of cells, directly from triangles or from a level set.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "bake/field/level_set.h"
#include "core/types.h"

namespace cloudbake {

/// Upper estimate of the bytes that a coverage field of this box and a sweep through it need, including the copies per axis and the planes
/// of every thread.
double estimateCoverageBytes(const Box& box, double voxel_size);

/// A field of zeros over the index positions from `low` to `high`, and a margin of cells around them.
CoverageField emptyField(const GridFrame& frame, const std::array<int, 3>& low, const std::array<int, 3>& high);

/// Rasterises a mesh whose inside (winding number ≠ 0) is well defined. A cell's fraction is the mean of the inside fractions of three
/// lines through its centre, one along each axis. It is exact on average over the positions of a surface in a cell, and off by up to a
/// third of a cell for a single position. Returns nothing if a column's winding does not close: then the mesh is open and needs a level
/// set. Triangles must be finite.
std::optional<CoverageField> coverageFromMesh(const SurfaceMesh& mesh, const GridFrame& frame);

/// The same on the lattice of the settings, after the checks of meshFrame. Counts an inverted mesh and a lost volume.
std::optional<CoverageField> coverageFromClosedMesh(const SurfaceMesh& mesh, const LevelSetSettings& settings, Warnings& warnings);

/// Fractions from the signed distance at the cells' centres: ½ − φ in voxels, clamped to 0 … 1. The field is made large enough to contain
/// `points` (world units).
CoverageField coverageFromLevelSet(const LevelSet& level_set, std::span<const Vec3> points = {});

}  // namespace cloudbake
