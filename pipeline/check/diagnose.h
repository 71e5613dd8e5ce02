// Finds what went wrong with an asset's lobes. Each hypothetical change is undone on a sample of vertices; the one that removes the error
// is the cause.
#pragma once

#include <string>
#include <vector>

#include "core/lobe_packing.h"
#include "core/types.h"

namespace cloudbake {

/// Sampled vertices: their UVs, the transforms of their nodes, and the right lobes.
struct DiagnosisSample {
  std::vector<LobeUvs> stored;   ///< #V
  std::vector<Affine> to_scene;  ///< #V
  std::vector<Lobe> truth;       ///< #V, in scene space: what a bake gives
  std::vector<uint32_t> pieces;  ///< #V: which connected piece of the mesh each lies on
  std::vector<float> true_fit;   ///< the light of `truth`, #V × #lights, of a fitted asset, which is judged by its light; else empty
  std::vector<Vec3> lights;      ///< of `true_fit`
  LobeShape shape;               ///< likewise
  float extinction = 0;          ///< likewise
};

struct Hypothesis {
  std::string cause;       ///< a short key, the same in every version
  std::string what, cure;  ///< for messages
  double error = 0;        ///< the error that is left once the change is undone: mean of vertexErrors, 0 … 2
  double right = 0;        ///< fraction of the vertices whose error is then small
};

struct Diagnosis {
  std::vector<Hypothesis> tried;  ///< first the asset as it is, then the best of each kind, simple ones first
  size_t best = 0;                ///< index of the one that explains the error; 0: none does, or there is nothing to explain
  bool explained() const { return best > 0; }
};

/// The error of each vertex: for mean lobes ‖o·d − o*·d*‖ over (d + d*)/2, for fitted ones the rms of T.
std::vector<double> vertexErrors(const std::vector<Lobe>& lobes, const DiagnosisSample& sample);

/// Causes: "v-flipped", "sets-swapped", "channels-swapped", "handedness", "axes", "inverted", "units" (d scaled; also with axes),
/// "node-transform", "rescaled". A hypothesis explains the error if it leaves less than 60 % of it and no simpler one does as well.
Diagnosis diagnose(const DiagnosisSample& sample);

/// The linear map M that best takes `from` to `to`: least ‖to − M·from‖², with outliers weighted less. None if they do not span space.
std::optional<Affine> linearMapBetween(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

/// The rotation nearest to a map with a positive determinant.
Affine nearestRotation(const Affine& map);

}  // namespace cloudbake
