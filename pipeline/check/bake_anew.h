// What a bake with an asset's recorded settings gives the asset's mesh as it is now.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/harmonic_lattice.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Lobes and coefficients at some vertices.
struct NewBake {
  std::vector<size_t> vertices;  ///< indices of the cloud's vertices, ascending
  std::vector<Lobe> lobes;       ///< #vertices, fitted if the asset's are
  std::vector<float> harmonics;  ///< #vertices × coefficients, or empty
};

/// Bakes at most about `most` vertices, one drawn at random from each of as many stretches, or all if the lobes were smoothed. A setting
/// that `info` lacks, or that no bake can have, is as by default. Throws InputError if the mesh bounds nothing.
NewBake bakeAnew(const Cloud& cloud, const AssetInfo& info, const MeshSettings& mesh, size_t most, Warnings& warnings);

/// The range of σ that a fit was made for; nothing if the asset records none, or one that no fit can have.
std::optional<std::pair<float, float>> rangeOfFit(const AssetInfo& info);

/// Lobes at some vertices, fitted with the default σ, k and b, or with those that a search finds, in place of the recorded ones. `shape`:
/// k and b of these lobes.
std::vector<Lobe> lobesByDefault(const Cloud& cloud, const AssetInfo& info, std::span<const size_t> vertices, LobeShape& shape,
                                 Warnings& warnings);

/// A lattice of the same order and size of cells as `like`.
HarmonicLattice latticeAnew(const Cloud& cloud, const AssetInfo& info, const MeshSettings& mesh, const HarmonicLattice& like);

}  // namespace cloudbake
