// The truth that bakes of a cloud are measured against.
#pragma once

#include <string>
#include <vector>

#include "core/figures.h"
#include "pipeline/fields.h"
#include "pipeline/parameters.h"

namespace cloudbake {

constexpr int kTruthDirections = 4096, kTransmittanceDirections = 512;

/// The truth at some vertices: lobes over kTruthDirections, and ℓ along kTransmittanceDirections.
struct Oracle {
  std::string name;
  std::vector<size_t> vertices;  ///< which of the cloud's
  std::vector<Vec3> positions;
  Truth truth;
  std::vector<Vec3> axes;      ///< of bothSenses(axes)
  std::vector<float> lengths;  ///< #vertices × 2 #axes, world units
};
/// At most `vertices` of them (unset: 2000, or 200 where the truth is a march), for rays of this length. `axes`: of the lights; empty: over
/// the whole sphere.
Oracle askOracle(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, double ray_length,
                 const std::vector<Vec3>& axes = {});

/// Figures of the lobes of all vertices against the oracle's, with the formula's k, b and σ.
BakeFigures figuresAgainst(const Oracle& oracle, const std::vector<Lobe>& all_lobes, bool is_fit, LobeShape shape, float extinction);

}  // namespace cloudbake
