// The result of `measure`: the error of a bake against an independent truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/gltf/asset_info.h"
#include "pipeline/lobes/lobes.h"
#include "pipeline/measure/radiance.h"

namespace cloudbake {

struct MeasuredFigures {
  BakeFigures bake;
  TransmittanceError lengths;              ///< of the estimated lengths themselves
  std::vector<FitError> fit;               ///< of a fitted lobe, against the truth
  std::optional<HarmonicError> harmonics;  ///< of --basis
  std::vector<RadianceFigures> radiance;   ///< of a fit to a volume, instead of `fit` and `harmonics`
};

/// Measures a bake of the cloud against its oracle.
MeasuredFigures measureBake(const Cloud& cloud, const IntegrationField& field, const BakedLobes& baked, const Settings& settings,
                            const BakeParameters& parameters);

/// The figures as aligned lines.
std::string figuresText(const MeasuredFigures& figures);
Json figuresJson(const MeasuredFigures& figures);

}  // namespace cloudbake
