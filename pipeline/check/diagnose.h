// What went wrong with an asset's lobes: each hypothesis is undone on a sample of vertices; the one whose error vanishes is the cause.
#pragma once

#include <string>
#include <vector>

#include "core/lobe_packing.h"
#include "core/types.h"

namespace cloudbake {

/// Some vertices: what their UVs hold, where their nodes put them, and what would be right.
struct DiagnosisSample {
  std::vector<LobeUvs> stored;   ///< #V
  std::vector<Affine> to_scene;  ///< #V
  std::vector<Lobe> truth;       ///< #V, in scene space; of a fitted asset the lobes fitted anew
  std::vector<uint32_t> pieces;  ///< #V: which connected piece of the mesh each lies on
  std::vector<float> thickness;  ///< #V, or empty: of the cloud there, half the median of its chords; no part of the diagnosis
  std::vector<float> true_fit;   ///< of a fitted asset, which is judged by its transmittance: exp(−σℓ), #V × #lights; else empty
  std::vector<Vec3> lights;      ///< of `true_fit`
  LobeShape shape;               ///< likewise
  float extinction = 0;          ///< likewise
};

struct Hypothesis {
  std::string cause;       ///< a short key, the same in every version
  std::string what, cure;  ///< for people
  double error = 0;        ///< what is left once it is undone: mean over the vertices of vertexErrors, 0 … 2
  double right = 0;        ///< share of the vertices whose error is then small
};

struct Diagnosis {
  std::vector<Hypothesis> tried;  ///< the first: the asset as it is; then the best of each kind, simple ones first
  size_t best = 0;                ///< which explains the error: 0: none does, or there is nothing to explain
  bool explained() const { return best > 0; }
};

/// How far each vertex is from the truth: of mean lobes ‖o·d − o*·d*‖ over (d + d*)/2, of fitted ones the rms of T.
std::vector<double> vertexErrors(const std::vector<Lobe>& lobes, const DiagnosisSample& sample);

/// Causes: "v-flipped", "sets-swapped", "channels-swapped", "handedness", "axes", "inverted", "units" (d scaled; also with axes),
/// "node-transform", "rescaled". A hypothesis explains the error if it leaves less than 60 % of it and no simpler one does as well.
Diagnosis diagnose(const DiagnosisSample& sample);

/// The linear map that takes `from` to `to` best, ‖to − M·from‖² with outliers counting less; nothing where they do not span space.
std::optional<Affine> linearMapBetween(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

/// The rotation nearest to a map with a determinant above 0.
Affine nearestRotation(const Affine& map);

}  // namespace cloudbake
