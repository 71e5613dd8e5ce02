// --lobe fit and --basis: what is fitted to the transmittance that a field gives, beside the mean lobes.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/fields.h"
#include "io/report/report.h"
#include "io/volume/lattice.h"

namespace cloudbake {

/// Directions to the light, as axes, and how much each of their senses counts.
struct LightSet {
  std::vector<Vec3> axes;
  std::vector<float> weights;  ///< 2 per axis; empty: all the same
};
/// About `directions` of them: over the whole sphere, or over the sun's arc with the zenith beside it.
LightSet lightSet(const std::optional<SunArc>& arc, int directions);

/// Fits from the mean lobes. Resolves k and b into `report.info`, whose shape and extinctions must hold what the settings give.
std::vector<Lobe> fittedLobes(const Scene& scene, const IntegrationField& field, const std::vector<Lobe>& mean, const Settings& settings,
                              BakeReport& report);

/// Tells in `report.fit` how near the mean lobes at their default k and b, and the fitted ones as they will be written, come to the
/// transmittance, over directions that the fit did not see.
void judgeFit(const Scene& scene, const IntegrationField& field, const std::vector<Lobe>& mean, const std::vector<Lobe>& fitted,
              const Settings& settings, BakeReport& report);

/// Coefficients of the transmittance at every point, #points × (settings.harmonic_order + 1)² (core/harmonics.h).
std::vector<float> bakeHarmonics(std::span<const Vec3> positions, const IntegrationField& field, const Settings& settings,
                                 float extinction);

/// The same at the cells of a lattice over the scene's box and a cell around it.
HarmonicLattice bakeLattice(const Scene& scene, const IntegrationField& field, const Settings& settings, float extinction);

}  // namespace cloudbake
