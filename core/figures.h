// Figures of error, as they cross stages.
#pragma once

#include <cstdint>
#include <string>

namespace cloudbake {

/// How far lobes are from the true ones.
struct LobeError {
  // Angle between estimated and true direction, degrees, over vertices whose true concentration is ≥ 0.1.
  double angle_rms_degrees = 0, angle_median_degrees = 0, angle_p95_degrees = 0, angle_max_degrees = 0;
  uint64_t vertices = 0, left_out = 0;  ///< all, and those under 0.1
  // Density along the mean over the same vertices, as a fraction of their mean true density.
  double density_rms = 0, density_bias = 0;
};

/// How far transmittances are from the true ones.
struct TransmittanceError {
  double rms = 0, bias = 0;  ///< of T, over all vertices and directions
};

/// How far a bake is from the truth on some of its vertices (docs/lobe_math.md). NaN: undefined.
struct BakeFigures {
  std::string truth;                 ///< how it was found
  uint64_t vertices = 0;             ///< that were measured
  bool is_fit = false;               ///< a fitted o is no mean direction and a fitted d no thickness: `lobe` is not judged
  LobeError lobe;                    ///< of o and d
  TransmittanceError transmittance;  ///< of the lobe formula, against exp(−σℓ)
};

/// How near a fitted lobe comes to exp(−σℓ), beside the mean lobe at the default k and b: rms of T over directions that the fit did not
/// see.
struct FitError {
  double extinction = 0, mean_rms = 0, fitted_rms = 0;
};

/// How near spherical harmonics come to exp(−σℓ), beside the lobe: rms of T over directions that the fit did not see.
struct HarmonicError {
  int order = 0;
  double lobe_rms = 0, rms = 0;
};

/// How far the points of a new surface lie from the sculpt that it replaces, as shares of the sculpt's longest side.
struct SurfaceError {
  double rms = 0, largest = 0;
};

}  // namespace cloudbake
