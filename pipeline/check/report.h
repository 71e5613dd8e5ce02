// The result of `check`, as text and as JSON (docs/check.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/figures.h"
#include "core/seal.h"
#include "io/gltf/asset/validate_asset.h"
#include "io/report/figures.h"
#include "io/report/report.h"
#include "pipeline/check/diagnose.h"

namespace cloudbake {

/// An asset's lobes beside those of a new bake of its mesh with its own settings: rms over vertices and lights of the difference of T.
struct Agreement {
  uint64_t vertices = 0;
  double rms = 0;            ///< of the lobes
  double harmonics_rms = 0;  ///< of the spherical harmonics, if there are any
  double noise = 0;          ///< of the lobes, between two new bakes with other seeds: 0 for a sweep
  double most = 0;           ///< more than this is a change
};

/// Figures of a sample of an asset's lobes against the truth.
struct CheckFigures {
  BakeFigures bake;                        ///< is_fit: judged as a fitted lobe
  size_t lights = 0;                       ///< number of lights that it was judged by
  double mean_rms = 0;                     ///< rms of the light of the exact mean lobe at the default k and b
  double best_fit_rms = 0;                 ///< of a fitted asset: rms of the light of a lobe fitted to the truth
  std::optional<HarmonicError> harmonics;  ///< of the stored coefficients, if there are any, beside the stored lobe
  Agreement agreement;
};

/// An asset compared with what it was before another program.
struct ComparisonFigures {
  std::string before;
  uint64_t matched = 0, added = 0, lost = 0;  ///< vertices: in both, only in the asset, only before
  BakeFigures difference;                     ///< between the asset's lobes and those before
  double density_max = 0;                     ///< largest difference of d, as a fraction of the mean d before
  std::optional<double> harmonics_rms;        ///< of T by the coefficients, if either has any; infinite if only one has
  std::string constants;                      ///< which of the constants differ, with both values; empty: none
  std::string sets_before, sets, materials_before, materials;
};

/// The certificate of a packed asset, and what its integers prove.
struct CertificateFigures {
  PackingCertificate recorded, proved;
  uint64_t matched = 0;           ///< vertices that the other asset has too
  std::optional<double> largest;  ///< the largest difference of T from it, if there is one
};

/// A key of a sequence, or the moment halfway to the next key, beside a new bake of its mesh.
struct KeyFigures {
  size_t segment = 0;
  double frame = 0;
  bool is_key = false;
  double transmittance_rms = 0;  ///< difference of T, over vertices and lights
  double folded = 0;             ///< the share of the triangles that face against their normals
};

struct SequenceFigures {
  std::vector<KeyFigures> keys;
  enum class Seal { kNone, kWhole, kBroken } seal = Seal::kNone;  ///< kBroken: numbers have changed since the bake
};
/// The worst of the keys, or of the moments between them; null if there is none.
const KeyFigures* worstOf(const SequenceFigures& figures, bool of_keys);

struct CheckReport {
  BakeReport run;  ///< input, metadata, counts, seconds, warnings
  AssetExamination file;
  std::optional<SealDifference> seal;  ///< what has changed since the bake; none if the asset has no seal
  std::optional<CheckFigures> figures;
  std::optional<double> lattice_rms;  ///< rms of T of the lattice (--lattice) beside a new one
  std::optional<ComparisonFigures> comparison;
  std::optional<CertificateFigures> certificate;
  std::optional<SequenceFigures> sequence;  ///< figures, diagnosis and bounds are then those of its worst key
  std::optional<Diagnosis> diagnosis;
  std::vector<FigureBound> bounds;    ///< the bounds that were applied
  std::optional<AssetFault> verdict;  ///< why it fails; none: it is sound
};

std::string checkText(const CheckReport& report);
/// One JSON object, "schema": "cloudbake-check-1", keys in a fixed order.
std::string checkJson(const CheckReport& report);

}  // namespace cloudbake
