// Bakes a cloud, encodes its asset, and records every step in a report.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/report/report.h"
#include "io/volume/lattice.h"
#include "pipeline/asset/levels.h"
#include "pipeline/lobes/lobes.h"

namespace cloudbake {

/// Reads a sculpt or a VDB (pipeline/sources) and records it in the report.
Cloud readCloud(const Settings& settings, BakeReport& report, Stopwatch& watch);

/// Calls parametersFor and records the result.
BakeParameters resolveParameters(const Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch);
/// Builds the integration field and records it. Warns about parts that are too thin for it.
IntegrationField fieldOfCloud(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report,
                              Stopwatch& watch);
/// Calls bakeLobes and records the result.
BakedLobes lobesOfCloud(const Cloud& cloud, const IntegrationField& field, const LobeSettings& settings, const BakeParameters& parameters,
                        BakeReport& report, Stopwatch& watch);

/// The lobes of all vertices as encodeGlb takes them, those of each part. They refer to `lobes`.
std::vector<std::span<const Lobe>> lobesPerPart(const Sculpt& sculpt, std::span<const Lobe> lobes);

/// A baked cloud as the bytes of a GLB.
struct BakedAsset {
  std::vector<Lobe> lobes;  ///< of all vertices of the cloud
  std::string glb;
  std::vector<LatticeFile> lattice;  ///< files of --lattice
  std::vector<LevelAsset> levels;    ///< of --lods
};
/// Bakes and encodes a cloud with these parameters. With --strict it throws as enforceStrict does.
BakedAsset bakeAsset(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters, BakeReport& report, Stopwatch& watch);
/// Resolves the parameters, bakes, and writes the files, the lattice first.
void writeAsset(const Cloud& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch);
/// The same for a cloud that nobody needs any more: large ones take less memory. What is left of it has no surface.
void writeAsset(Cloud&& cloud, const Settings& settings, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
