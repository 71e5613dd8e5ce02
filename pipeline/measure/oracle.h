// The truth that bakes of a cloud are measured against.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/figures.h"
#include "core/surface_points.h"
#include "pipeline/fields/fields.h"
#include "pipeline/lobes/lobes.h"
#include "pipeline/lobes/parameters.h"

namespace cloudbake {

constexpr int kTruthDirections = 4096, kTransmittanceDirections = 512;

/// The truth at points that are spread over the surface.
struct SurfaceOracle {
  std::vector<SurfacePoint> points;  ///< of the cloud's surface
  std::vector<float> light;          ///< #points × 2 #axes, for the axes of the Oracle
};

/// The truth at some vertices: mean lobes, and ℓ and light along kTransmittanceDirections directions.
struct Oracle {
  std::string name;
  std::vector<size_t> vertices;  ///< indices of the cloud's vertices
  std::vector<Vec3> positions;
  Truth truth;
  std::vector<Vec3> axes;      ///< `lengths` are along bothSenses(axes)
  std::vector<float> lengths;  ///< #vertices × 2 #axes, world units
  std::vector<float> light;    ///< likewise: the light that lobes are judged by, exp(−σℓ) or that of a volume
  SurfaceOracle surface;       ///< empty unless it was asked for
};

/// What lobes are judged by.
struct OracleQuestion {
  float extinction = 1;                 ///< σ per world unit
  std::optional<VolumeLight> volume{};  ///< judge by the picture of this volume, at the vertices that some view sees
  double ray_length = 0;                ///< world units
  std::vector<Vec3> axes = {};          ///< both senses of these are the lights; empty: axes over the whole sphere
  int directions = kTruthDirections;    ///< of the mean lobes
  bool over_surface = false;            ///< also at as many points of the surface
  /// For a check: the vertices are drawn at random, one from each stretch, and not evenly spread; a volume is marched on a coarser lattice.
  bool is_check = false;
};

/// The truth at up to `vertices` vertices (unset: 2000, or 200 if the truth is marched). Points that no view of a volume sees are left out.
Oracle askOracle(const Cloud& cloud, const FieldSettings& settings, std::optional<size_t> vertices, const OracleQuestion& question);

/// The lights of an asset for askOracle, of about as many directions as its question can have: over the whole sphere or over the arc of its
/// fit.
LightSet judgingLights(const AssetInfo& info);

/// Compares the lobes at the oracle's vertices, and blended at its points of the surface, with the truth, for the formula's k, b and σ.
/// `all_lobes` are those of all vertices; `weights` says how much each light counts for T, empty = all equal.
BakeFigures figuresAgainst(const Oracle& oracle, const std::vector<Lobe>& all_lobes, bool is_fit, LobeShape shape, float extinction,
                           std::span<const float> weights = {});

}  // namespace cloudbake
