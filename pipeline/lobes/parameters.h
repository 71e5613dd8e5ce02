// The parameters of a bake of one shape: L, k, b, σ, and with a target error also N and the voxels.
#pragma once

#include <optional>

#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// The default k, and the default b as a fraction of the longest side: 3 and −0.3 % for a mean lobe, 4 and 0 for a fitted one.
struct DefaultShape {
  float exponent = 0, relative_bias = 0;
};
constexpr DefaultShape defaultShape(bool fit) { return fit ? DefaultShape{4, 0} : DefaultShape{3, -0.003F}; }
/// The default shape of a mean lobe.
LobeShape defaultMeanShape(const SurfaceMesh& surface);

/// The default of σ · longest side.
constexpr float kDefaultOpticalDepth = 7;

/// In world units.
struct BakeParameters {
  BakeSettings bake;                              ///< includes L, and the N that meets a target error
  LobeShape shape;                                ///< k and b; of a search (fit_exponent, fit_bias) the starting point
  float extinction = 0;                           ///< σ; of a fit over a range, its geometric mean
  float extinction_low = 0, extinction_high = 0;  ///< the range of a fit; 0: no fit
  std::optional<int> bake_voxels;                 ///< those of the settings, or those that meet a target error
  std::optional<TargetReport> target;
};

/// Sizes of shapes whose constants, σ = 7 / longest side among them, and whose chords, areas and lights stay in the range of float.
inline constexpr float kSmallestShape = 1e-37F, kLargestShape = 1e37F;
/// Throws InputError for a shape that is smaller or larger, or that lies farther from the origin. No extent at all is left to its own
/// error.
void requireUsableSize(const Box& box);

/// Resolves the parameters for a cloud. With a target error this is a search (pipeline/lobes/target.h), which throws Error with
/// ExitCode::kBound if nothing that it tries meets the target.
BakeParameters parametersFor(const Cloud& cloud, const Settings& settings);

/// The field settings with the voxels of these parameters.
FieldSettings fieldSettings(const FieldSettings& settings, const BakeParameters& parameters);

/// The metadata of the asset for these settings and parameters. The caller fills in the field, the voxel size and the input's hash.
AssetInfo describe(const Settings& settings, const BakeParameters& parameters);

}  // namespace cloudbake
