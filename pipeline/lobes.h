// The lobes of a cloud: mean or fitted, smoothed if asked for, and the spherical harmonics beside them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/figures.h"
#include "io/volume/lattice.h"
#include "pipeline/fields.h"
#include "pipeline/parameters.h"

namespace cloudbake {

/// Directions to the light, as axes, and how much each of their senses counts.
struct LightSet {
  std::vector<Vec3> axes;
  std::vector<float> weights;  ///< 2 per axis; empty: all the same
};
/// About `directions` of them: over the whole sphere, or over the sun's arc with the zenith beside it.
LightSet lightSet(const std::optional<SunArc>& arc, int directions);

/// Lobes of all vertices of a cloud, in order of the parts.
struct BakedLobes {
  std::vector<Lobe> lobes;
  LobeShape shape;            ///< k and b, as given or as a search found them
  std::vector<FitError> fit;  ///< of fitted lobes, one per σ: how near they and the mean lobes come to the transmittance
};

/// Bakes them; the seconds of "bake", "fit" and "smooth" go to `seconds`. The figures of a fit are over directions that it did not see, and
/// over lobes as they will be written.
BakedLobes bakeLobes(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings, const BakeParameters& parameters,
                     Warnings& warnings, Stopwatch& watch, StageSeconds& seconds);

/// Coefficients of the transmittance at every point, #points × (order + 1)² (core/harmonics.h), for an extinction per world unit.
std::vector<float> bakeHarmonics(std::span<const Vec3> positions, const IntegrationField& field, int order,
                                 const BakeParameters& parameters);

/// The same at the cells of a lattice over the cloud's box and a cell around it.
HarmonicLattice bakeLattice(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings,
                            const BakeParameters& parameters);

}  // namespace cloudbake
