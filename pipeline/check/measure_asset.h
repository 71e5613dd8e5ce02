// Measures an asset: a sample of its vertices against the truth, and against a new bake.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/check/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// The mesh and the lobes of an asset.
struct CheckedAsset {
  Cloud cloud;
  std::vector<Affine> to_scene;  ///< #V
  std::vector<Lobe> lobes;       ///< #V, in scene space
  std::vector<float> harmonics;  ///< #V × coefficients, or empty
  bool has_metadata = false;
  std::optional<double> most_disagreement{};  ///< of T from a new bake, rms, instead of what the metadata and the seal let expect
};

/// What the judge needs besides the figures.
struct AssetSample {
  DiagnosisSample diagnosis;
  std::vector<size_t> vertices;  ///< those of a new bake
  std::vector<Lobe> right;       ///< their lobes in it
  std::vector<double> errors;    ///< #vertices: rms of T over lights between the stored lobe and the right one
  std::vector<double> off;       ///< of the vertices of the truth: vertexErrors against it
  std::vector<float> thickness;  ///< likewise: of the cloud there, half the median of its chords
  std::string other_constants;   ///< of a fitted asset that differs from its new bake: the constants that give its lobes; empty: not known
};

/// How the asset differs from the seal of its own metadata; none if it has no seal. `uvs` are its lobes as they are stored.
std::optional<SealDifference> sealDifference(const CheckedAsset& asset, const AssetInfo& info, std::span<const LobeUvs> uvs);

/// Fills in report.figures and report.lattice_rms. The lobes are read as report.run.info says. Throws InputError if the mesh bounds nothing
/// that can be measured.
AssetSample measureAsset(const CheckedAsset& asset, const Settings& settings, float ray_length, CheckReport& report);

}  // namespace cloudbake
