// From a cloud to the bytes of its asset, with a report of what happened on the way.
#pragma once

#include <string>
#include <vector>

#include "io/report/report.h"
#include "io/volume/lattice.h"
#include "pipeline/lobes.h"

namespace cloudbake {

/// Reads a sculpt or a VDB (pipeline/sources) and records it.
Cloud readCloud(const Settings& settings, BakeReport& report, Stopwatch& watch);

/// parametersFor, recorded.
BakeParameters resolveParameters(const Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch);
/// The integration field, recorded; warns of parts that it cannot hold.
IntegrationField fieldOfCloud(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report,
                              Stopwatch& watch);
/// bakeLobes, recorded.
BakedLobes lobesOfCloud(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings, const BakeParameters& parameters,
                        BakeReport& report, Stopwatch& watch);

/// A baked cloud as the bytes of a GLB.
struct BakedAsset {
  std::vector<Lobe> lobes;  ///< of all vertices of the cloud
  std::string glb;
  std::vector<LatticeFile> lattice;  ///< of --lattice
};
/// Bakes and encodes a cloud for its parameters; with --strict it throws as enforceStrict does.
BakedAsset bakeAsset(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report, Stopwatch& watch);
/// Resolves the parameters, bakes and writes, the lattice first.
void writeAsset(const Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
