#include "pipeline/check/measure_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "bake/lobe/sweep.h"
#include "bake/truth/error_metrics.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/sculpt.h"
#include "pipeline/check/bake_anew.h"
#include "pipeline/fields/fields.h"
#include "pipeline/sources/sculpt.h"

namespace cloudbake {

namespace {

constexpr size_t kVertices = 200;
constexpr int kLightsOfKeys = 32;
// Halfway between two keys, lobes are blended too.
constexpr double kAgreementBetween = 0.1, kMostFolded = 0.05;

// Of the triangles, those that face against their own normals.
double foldedShare(const SurfaceMesh& mesh) {
  size_t folded = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 face = cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    folded += dot(face, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) < 0;
  }
  return double(folded) / double(std::max<size_t>(1, mesh.triangles.size()));
}

// The rms of T, over the sampled vertices and the lights, between the lobes of a mesh and those of a new bake.
double differenceOfT(BakedMesh mesh, const MeshSettings& settings, const std::vector<Vec3>& lights) {
  BakeReport report;
  Stopwatch watch;
  const Cloud cloud = cloudOfSculpt(sculptOf("cloud", std::move(mesh.surface)), settings, report, watch);
  Warnings told_by_the_bake;
  const NewBake anew = bakeAnew(cloud, mesh.info, settings, kVertices, told_by_the_bake);
  return compareLobeTransmittance(pick(mesh.lobes, anew.vertices), anew.lobes, mesh.info.shape, lights, mesh.info.extinction).rms;
}

std::string placeOf(const KeyFigures& one) {
  return one.is_key ? fmt::format("the key at frame {:g}", one.frame) : fmt::format("frame {:g}, halfway between two keys", one.frame);
}

}  // namespace

SequenceFigures measureKeys(const CloudSequence& sequence, const MeshSettings& mesh) {
  SequenceFigures figures;
  for (size_t s = 0; s < sequence.segments.size(); ++s) {
    const std::vector<SequenceKey>& keys = sequence.segments[s].keys;
    for (size_t k = 0; k < keys.size(); ++k) {
      figures.keys.push_back({s, keys[k].frame, true});
      if (k + 1 < keys.size()) figures.keys.push_back({s, (keys[k].frame + keys[k + 1].frame) / 2, false});
    }
  }
  const std::vector<Vec3> lights = bothSenses(sweepAxes(kLightsOfKeys));
  parallelForAll(figures.keys.size(), [&](size_t i) {
    KeyFigures& one = figures.keys[i];
    try {
      BakedMesh own = meshAt(sequence, {one.segment, one.frame});
      one.folded = foldedShare(own.surface);
      one.transmittance_rms = differenceOfT(std::move(own), mesh, lights);
    } catch (const InputError& error) {
      throw InputError(error.file, placeOf(one) + ": " + error.message);
    }
  });
  return figures;
}

std::optional<AssetFault> judgeKeys(const SequenceFigures& figures) {
  for (const KeyFigures& one : figures.keys) {
    if (!(one.folded <= kMostFolded))
      return AssetFault{"folded", fmt::format("{}: {:.0f} % of the triangles face against their normals", placeOf(one), 100 * one.folded),
                        "make the sequence again, with a smaller --change if it is between two keys"};
    if (!one.is_key && !(one.transmittance_rms <= kAgreementBetween))
      return AssetFault{"between",
                        fmt::format("{}: T differs by {:.2g} rms from a new bake of the blended mesh, over {:g}", placeOf(one),
                                    one.transmittance_rms, kAgreementBetween),
                        "make the sequence again with a smaller --change"};
  }
  if (figures.seal == SequenceFigures::Seal::kBroken)
    return AssetFault{"changed", "the keys or the constants are not those of the bake, although the light still fits the meshes",
                      "use the file that `cloudbake sequence` wrote"};
  return std::nullopt;
}

}  // namespace cloudbake
