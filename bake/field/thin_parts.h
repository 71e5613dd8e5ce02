// Finds where a shape is thinner than the voxels of its integration field.
#pragma once

#include "bake/field/dense_field.h"
#include "bake/mesh/mesh_topology.h"

namespace cloudbake {

/// Counts points below which the field is nowhere inside at a depth of one to three voxels (a fraction under ½, a distance above 0). They
/// are on parts thinner than a voxel, whose density the field blurs or loses. `first` is a point's index. Points without a normal are
/// skipped.
Defect findThinParts(const BakePoints& points, const CoverageField& field);
Defect findThinParts(const BakePoints& points, const DenseField& field);

}  // namespace cloudbake
