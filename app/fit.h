// --lobe fit: the lobes of a whole asset, fitted to the transmittance that its field gives.
#pragma once

#include <vector>

#include "app/fields.h"

namespace cloudbake {

/// Fits from the mean lobes. Resolves k and b into `report.info`, whose shape and extinctions must hold what the settings give.
std::vector<Lobe> fittedLobes(const Scene& scene, const IntegrationField& field, const std::vector<Lobe>& mean, const Settings& settings,
                              BakeReport& report);

/// Tells in `report.fit` how near the mean lobes at their default k and b, and the fitted ones as they will be written, come to the
/// transmittance, over directions that the fit did not see.
void judgeFit(const Scene& scene, const IntegrationField& field, const std::vector<Lobe>& mean, const std::vector<Lobe>& fitted,
              const Settings& settings, BakeReport& report);

}  // namespace cloudbake
