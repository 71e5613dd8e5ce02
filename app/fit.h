// --lobe fit: the lobes of a whole asset, fitted to the transmittance that its field gives.
#pragma once

#include <vector>

#include "app/fields.h"

namespace cloudbake {

/// Fits from the mean lobes. Resolves k, b and the range of σ into `report.info`, and tells the error of both lobes in `report.fit`.
/// `report.info.shape` and the extinctions must hold what the settings give.
std::vector<Lobe> fittedLobes(const Scene& scene, const IntegrationField& field, const std::vector<Lobe>& mean, const Settings& settings,
                              BakeReport& report);

}  // namespace cloudbake
