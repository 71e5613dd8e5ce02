#include "pipeline/check/measure_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>
#include <vector>

#include "bake/lobe/sweep.h"
#include "core/error.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "pipeline/check/bake_anew.h"
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

// The rms of T over the sampled vertices and lights between the lobes of a mesh and those of a new bake.
double differenceOfT(const BakedMesh& mesh, const MeshSettings& settings, const std::vector<Vec3>& lights) {
  Sculpt sculpt;
  sculpt.parts.push_back({"cloud", mesh.surface.positions, mesh.surface.normals, {}, mesh.surface.triangles, {}});
  BakeReport report;
  Stopwatch watch;
  const Cloud cloud = cloudOfSculpt(std::move(sculpt), settings, report, watch);
  Warnings told_by_the_bake;
  const NewBake anew = bakeAnew(cloud, mesh.info, settings, kVertices, told_by_the_bake);
  double squares = 0;
  for (size_t i = 0; i < anew.vertices.size(); ++i)
    for (const Vec3& light : lights) {
      const auto seen = [&](const Lobe& lobe) { return double(lobeTransmittance(lobe, light, mesh.info.shape, mesh.info.extinction)); };
      const double difference = seen(mesh.lobes[anew.vertices[i]]) - seen(anew.lobes[i]);
      squares += difference * difference;
    }
  return std::sqrt(squares / double(std::max<size_t>(1, anew.vertices.size() * lights.size())));
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
  std::vector<std::exception_ptr> errors(figures.keys.size());
  parallelFor(figures.keys.size(), [&](size_t i) {
    KeyFigures& one = figures.keys[i];
    try {
      const BakedMesh own = meshAt(sequence, {one.segment, one.frame});
      one.transmittance_rms = differenceOfT(own, mesh, lights);
      one.folded = foldedShare(own.surface);
    } catch (const InputError& error) {
      errors[i] = std::make_exception_ptr(InputError(error.file, placeOf(one) + ": " + error.message));
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
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
