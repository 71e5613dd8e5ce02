// What `measure` measures against, and its speed–error curve.
#pragma once

#include <string>
#include <vector>

#include "io/report/report.h"
#include "pipeline/fields.h"
#include "core/error.h"

namespace cloudbake {

constexpr int kTruthDirections = 4096, kTransmittanceDirections = 512;

/// The truth at some vertices: lobes over kTruthDirections, and ℓ along kTransmittanceDirections.
struct Oracle {
  std::string name;
  std::vector<size_t> vertices;  ///< which of the scene's
  std::vector<Vec3> positions;
  Truth truth;
  std::vector<Vec3> axes;      ///< of bothSenses(axes)
  std::vector<float> lengths;  ///< #vertices × 2 #axes, world units
};
/// `axes`: of the lights; empty: over the whole sphere.
Oracle askOracle(const Scene& scene, const Settings& settings, const std::vector<Vec3>& axes = {});

/// Bakes the scene by every method, sampler, quadrature, N, S and resolution worth showing, and by the peers (bake/truth/peers.h), one after the
/// other in this run. Prints the table, and writes curve.csv, curve.json and curve.svg into the folder settings.output.
ExitCode runCurve(const Scene& scene, const Settings& settings, const BakeReport& report);

}  // namespace cloudbake
