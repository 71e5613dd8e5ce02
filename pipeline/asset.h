// What several commands do alike: combine the stages, time them, tell what happened.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include "pipeline/fields.h"
#include "pipeline/options.h"
#include "core/error.h"
#include "core/types.h"
#include "io/gltf/asset_info.h"
#include "io/report/report.h"
#include "io/volume/lattice.h"

namespace cloudbake {

/// Adds to the sum of that name, or begins it.
void addSeconds(std::vector<std::pair<std::string, double>>& sums, const std::string& name, double seconds);

/// Adds the seconds since its making, or since the last lap, to a stage of a report.
class Stopwatch {
 public:
  Stopwatch() = default;
  /// `on_lap` is called with every stage that ends.
  explicit Stopwatch(std::function<void(const std::string& stage)> on_lap) : on_lap_(std::move(on_lap)) {}
  void lap(BakeReport& report, const std::string& stage);

 private:
  std::function<void(const std::string&)> on_lap_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Reads a sculpt, or a VDB (pipeline/sources/volume.h).
Scene readScene(Settings& settings, BakeReport& report, Stopwatch& watch);
/// Resolves what depends on the shape (L, k, b, σ; with a target error also N and the voxels) and records it in `report.info`.
void resolveInfo(Settings& settings, const Scene& scene, BakeReport& report, Stopwatch& watch);

/// k and b of a mean lobe where nothing else is asked for: 3, and −0.3 % of the longest side.
LobeShape defaultMeanShape(const SurfaceMesh& surface);

/// The field of the scene, recorded in `report.info`.
IntegrationField fieldOfScene(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch);
/// Lobes of all vertices of the scene, in order of the parts: mean, or fitted.
std::vector<Lobe> bakeScene(const Scene& scene, const IntegrationField& field, const Settings& settings, BakeReport& report,
                            Stopwatch& watch);
/// A baked scene as the bytes of a GLB.
struct EncodedAsset {
  std::vector<Lobe> lobes;  ///< of all vertices of the scene
  std::string glb;
  std::vector<LatticeFile> lattice;  ///< of --lattice
};
/// Bakes and encodes the asset; with --strict it throws as enforceStrict does.
EncodedAsset encodeAsset(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch);
/// The same, and writes it, the lattice first.
void writeAsset(const Scene& scene, const Settings& settings, BakeReport& report, Stopwatch& watch);

/// With --strict, throws InputError if anything was warned of. To be called before anything is written.
void enforceStrict(const Settings& settings, const BakeReport& report);
/// A line for stderr per kind of warning.
std::string warningLines(const BakeReport& report);
/// Prints warnings and, but for -q, the report (stdout), and writes --json.
void tellReport(const Settings& settings, const BakeReport& report);
/// The same with more to tell: `more` under a key of the JSON, `text` behind the report.
void tellReport(const Settings& settings, const BakeReport& report, const char* key, const Json& more, const std::string& text);

/// Runs `body`; an InputError that names no file gets `file`.
template <class Body>
auto namingFile(const std::string& file, const Body& body) {
  try {
    return body();
  } catch (const InputError& error) {
    if (!error.file.empty()) throw;
    throw InputError(file, error.line, error.column, error.message);
  }
}

}  // namespace cloudbake
