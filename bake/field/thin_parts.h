// Where a shape is thinner than the lattice of its integration field.
#pragma once

#include "bake/field/dense_field.h"
#include "bake/mesh/mesh_topology.h"

namespace cloudbake {

/// Points under which, one to three voxels down, the field is nowhere inside (a fraction under ½, a distance above 0): they lie on parts of
/// less than a voxel, whose density the field blurs or loses. `first` is a point's index. Points need normals; those without one are passed
/// over.
Defect findThinParts(const BakePoints& points, const CoverageField& field);
Defect findThinParts(const BakePoints& points, const DenseField& field);

}  // namespace cloudbake
