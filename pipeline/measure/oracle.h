// The truth that bakes of a cloud are measured against.
#pragma once

#include <string>
#include <vector>

#include "core/figures.h"
#include "pipeline/fields.h"
#include "pipeline/parameters.h"

namespace cloudbake {

constexpr int kTruthDirections = 4096, kTransmittanceDirections = 512;

/// The truth at some vertices: lobes from kTruthDirections directions, and ℓ along kTransmittanceDirections directions.
struct Oracle {
  std::string name;
  std::vector<size_t> vertices;  ///< indices of the cloud's vertices
  std::vector<Vec3> positions;
  Truth truth;
  std::vector<Vec3> axes;      ///< `lengths` are along bothSenses(axes)
  std::vector<float> lengths;  ///< #vertices × 2 #axes, world units
};
/// The truth at up to `vertices` vertices (unset: 2000, or 200 if the truth is marched), for rays of this length. `axes` are those of the
/// lights; empty: axes over the whole sphere.
Oracle askOracle(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, double ray_length,
                 const std::vector<Vec3>& axes = {});

/// Compares the lobes at the oracle's vertices with the truth, for the formula's k, b and σ. `all_lobes` are those of all vertices.
BakeFigures figuresAgainst(const Oracle& oracle, const std::vector<Lobe>& all_lobes, bool is_fit, LobeShape shape, float extinction);

}  // namespace cloudbake
