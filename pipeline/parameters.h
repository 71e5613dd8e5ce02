// What the settings of a bake come to for one shape: L, k, b, σ, and with a target error N and the voxels.
#pragma once

#include <optional>

#include "io/report/report.h"
#include "pipeline/cloud.h"
#include "pipeline/settings.h"
#include "pipeline/stopwatch.h"

namespace cloudbake {

/// k, and b as a share of the longest side, where no option gives them: 3 and −0.3 % of a mean lobe, 4 and 0 of a fitted one.
struct DefaultShape {
  float exponent = 0, relative_bias = 0;
};
constexpr DefaultShape defaultShape(bool fit) { return fit ? DefaultShape{4, 0} : DefaultShape{3, -0.003F}; }
/// The shape of a mean lobe at its defaults.
LobeShape defaultMeanShape(const SurfaceMesh& surface);

/// σ · longest side where no option gives σ.
constexpr float kDefaultOpticalDepth = 7;

/// World units.
struct BakeParameters {
  BakeSettings bake;                              ///< with L, and with the N that keeps a target error
  LobeShape shape;                                ///< k and b; of a search (fit_exponent, fit_bias) where it starts
  float extinction = 0;                           ///< σ; of a fit over a range its geometric mean
  float extinction_low = 0, extinction_high = 0;  ///< the range of a fit; 0: no fit
  std::optional<int> bake_voxels;                 ///< those of the settings, or those that keep a target error
  std::optional<TargetReport> target;
};

/// Resolves them for a cloud; with a target error by a search (pipeline/target.h), which throws Error with ExitCode::kBound where nothing
/// within reach keeps it.
BakeParameters parametersFor(const Cloud& cloud, const Settings& settings);

/// The lattice and the field that they ask for.
FieldSettings fieldSettings(const FieldSettings& settings, const BakeParameters& parameters);

/// What the asset records of the settings and of what they came to; the field, the voxel size and the input's hash are still to be filled
/// in.
AssetInfo describe(const Settings& settings, const BakeParameters& parameters);

}  // namespace cloudbake
