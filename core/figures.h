// Error figures, as they are passed between stages.
#pragma once

#include <cstdint>
#include <string>

namespace cloudbake {

/// How far lobes are from the true lobes.
struct LobeError {
  // Angle between estimated and true direction, degrees, over vertices whose true concentration is ≥ 0.1.
  double angle_rms_degrees = 0, angle_median_degrees = 0, angle_p95_degrees = 0, angle_max_degrees = 0;
  uint64_t vertices = 0, left_out = 0;  ///< all vertices, and those below 0.1
  // Density along the mean over the same vertices, as a fraction of their mean true density.
  double density_rms = 0, density_bias = 0;
};

/// How far transmittances are from the true transmittances.
struct TransmittanceError {
  double rms = 0, bias = 0;  ///< of T, over all vertices and directions
};

/// The same over points that are spread over the surface by area, with the lobes blended between the vertices as an engine blends them.
struct SurfaceLightError {
  uint64_t points = 0;            ///< 0: not measured
  TransmittanceError per_pixel;   ///< the formula is evaluated at the pixel, from blended floats
  TransmittanceError per_vertex;  ///< the formula is evaluated at the vertices, and its result is blended
};

/// How far a bake is from the truth at some of its vertices (docs/lobe_math.md). NaN means undefined.
struct BakeFigures {
  std::string truth;                 ///< how the truth was computed
  uint64_t vertices = 0;             ///< number of vertices measured
  bool is_fit = false;               ///< a fitted o is not a mean direction and a fitted d is not a thickness: ignore `lobe`
  LobeError lobe;                    ///< of o and d
  TransmittanceError transmittance;  ///< of the lobe formula, against exp(−σℓ)
  SurfaceLightError surface{};       ///< likewise, between the vertices
};

/// How far a shading is from the light that a render of the volume shows there: rms over all pairs of a vertex and a view, and all lights.
struct RadianceError {
  double rms = 0;          ///< plain
  double exposed_rms = 0;  ///< after the exposure that makes it least
  double exposure = 1;     ///< that exposure: a factor on the shading
  double limit = 0;        ///< rms of the best shading that does not know the view
};

/// How near a fitted lobe comes to what it was fitted to, exp(−σℓ) or the light of a volume, beside the mean lobe at the default k and b:
/// rms over directions that the fit did not see.
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

/// A level of detail beside the full asset.
struct LevelFigures {
  std::string file;
  uint64_t vertices = 0, triangles = 0;
  SurfaceError distance;         ///< between the two surfaces, from either side: the larger rms and the larger largest
  double transmittance_rms = 0;  ///< between the lobes of both at points that are spread over the full surface, over lights from everywhere
  int switch_pixels = 0;         ///< as in AssetInfo
};

}  // namespace cloudbake
