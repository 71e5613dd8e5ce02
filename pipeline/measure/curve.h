// The speed–error curve of `measure`.
#pragma once

#include <string>
#include <vector>

#include "io/report/curve.h"
#include "pipeline/lobes/parameters.h"

namespace cloudbake {

/// Bakes the cloud by every method, sampler, quadrature, N, S and resolution worth showing, and by the peers (bake/truth/peers.h), one
/// after the other in the same run. The rows are ranked against the plain port.
std::vector<CurveRow> measureCurve(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters);

/// The rows as an SVG plot of error over seconds. `input` names what was measured.
std::string curveSvg(const std::vector<CurveRow>& rows, const std::string& input);

}  // namespace cloudbake
