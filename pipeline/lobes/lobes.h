// The lobes of a cloud, mean or fitted and optionally smoothed, and its spherical harmonics.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/figures.h"
#include "io/volume/lattice.h"
#include "pipeline/fields/fields.h"
#include "pipeline/lobes/parameters.h"

namespace cloudbake {

/// Directions to the light as axes, with a weight for both senses of each.
struct LightSet {
  std::vector<Vec3> axes;
  std::vector<float> weights;  ///< 2 per axis; empty: all equal
};
/// About `directions` directions, over the whole sphere or, with an arc, over the arc plus the zenith.
LightSet lightSet(const std::optional<SunArc>& arc, int directions);

/// About `count` suns over an arc.
std::vector<Vec3> sunsOver(const SunArc& arc, int count);

/// The lights of a fit: the same, but of a fit to a volume without an arc those below the horizon count a tenth, because no sun is there,
/// and the zenith, which stands for the sky, counts as much as a tenth of the suns above it.
LightSet fitLights(const std::optional<SunArc>& arc, bool to_volume, int directions);

/// Lobes of all vertices of a cloud, in the order of its parts.
struct BakedLobes {
  std::vector<Lobe> lobes;
  LobeShape shape;            ///< k and b, as given or as found by a search
  std::vector<FitError> fit;  ///< of fitted lobes, one per σ: errors of T of the mean and of the fitted lobes
};

/// Lobes of points as a bake has them before any smoothing. The triangles of `points` are not used.
struct ShapedLobes {
  std::vector<Lobe> lobes;
  LobeShape shape;  ///< k and b, as given or as found by a search
};
ShapedLobes lobesAt(const SurfaceMesh& points, const IntegrationField& field, const LobeSettings& settings,
                    const BakeParameters& parameters, Warnings& warnings);

/// What lobes are to show at points, for parameters.extinction, towards both senses of the axes, #points × 2 #axes: the transmittance, or
/// what a fit to a volume is fitted to.
std::vector<float> lightAt(const BakePoints& points, std::span<const Vec3> axes, const IntegrationField& field,
                           const LobeSettings& settings, const BakeParameters& parameters);

/// Bakes the lobes, and adds the seconds of "bake", "fit" and "smooth" to `seconds`. The errors of a fit are over directions that the fit
/// did not use, for the lobes as they will be written.
BakedLobes bakeLobes(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings, const BakeParameters& parameters,
                     Warnings& warnings, Stopwatch& watch, StageSeconds& seconds);

/// Throws MemoryError if the light of so many points that harmonics are fitted to would take more than the settings' memory limit.
void requireHarmonicsMemory(size_t points, const LobeSettings& settings, const BakeParameters& parameters);

/// Coefficients of the light at vertices, #points × (order + 1)² (core/harmonics.h), for parameters.extinction: the transmittance, or what
/// a fit to a volume is fitted to.
std::vector<float> bakeHarmonics(const BakePoints& points, const IntegrationField& field, int order, const LobeSettings& settings,
                                 const BakeParameters& parameters);

/// Coefficients of the transmittance at the cell centres of a lattice that covers the cloud's box and one cell around it. Of a fit to a
/// volume they are of S(σℓ), the light that arrives at a point after all scatterings, because whoever reads a lattice marches along the
/// view.
HarmonicLattice bakeLattice(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings,
                            const BakeParameters& parameters);

}  // namespace cloudbake
