// Two questions are asked. Are the lobes and constants still those of the bake? The seal and a new bake answer that. And is the bake good
// enough? The truth answers that, under the bounds.
//
// Default bounds of mean lobes: the median error of the direction is at most 10°, its rms 20°, and the mean of d is right within a quarter.
// Bakes of closed sculpts at default settings keep a median of 6° (docs/sculpts.md). Fitted lobes are judged by the light that they were
// fitted to: they may be a tenth worse than lobes that are fitted to the truth itself.
#include "pipeline/check/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bake/mesh/mesh_topology.h"
#include "pipeline/check/name_change.h"
#include "pipeline/measure/oracle.h"

namespace cloudbake {

namespace {

constexpr double kMedian_degrees = 10, kRms_degrees = 20, kDensityBias = 0.25;
constexpr double kFitFactor = 1.1, kFitSlack = 0.02;
constexpr double kRounded = 2e-3;  // relative change of the lobes by half floats and less
constexpr double kLatticeAgreement = 0.02;
// σ · longest side beyond which next to no light comes through, or next to nothing is held back. The default is 7.
constexpr double kLeastOpticalDepth = 0.1, kMostOpticalDepth = 100;
constexpr double kLargestBias = 1;  // |b| over the longest side; searched ones are within ±1 optical depth, a seventh
constexpr double kLargestExponent = 64;
constexpr double kShortestRay = 0.01, kLongestRay = 1000;  // over the longest side
constexpr const char* kRebake = "bake the mesh as it is now";

// The size of the asset when it was baked over its size now, as far as that is known. Lengths among the constants belong to the former.
double sizeAtTheBake(const AssetInfo& info, const SurfaceMesh& surface) {
  const double size = std::sqrt(surfaceArea(surface));
  return info.seal && info.seal->size > 0 && size > 0 ? double(info.seal->size) / size : 1;
}

AssetFault oddMetadata(const std::string& what) {
  return {"odd-metadata", "asset.extras.cloudbake: " + what, "bake again, or restore the constants of the bake"};
}

// Whether the settings only give a rough bake. The longest side is at least 1/√3 of the diagonal, which is the length of a ray.
bool isRough(const AssetInfo& info) {
  return (info.rays > 0 && info.rays < 64) || (info.voxel_size > 0 && info.ray_length < 90 * info.voxel_size) || info.sampler == "uniform";
}

// The bake is as its settings make it, and yet over a bound.
AssetFault namePoorBake(const std::string& over, const AssetSample& sample, const CheckReport& report) {
  constexpr double kWrong = 0.25, kThinVoxels = 2;
  size_t wrong = 0, thin = 0;
  for (size_t v = 0; v < sample.off.size(); ++v)
    if (sample.off[v] >= kWrong) ++wrong, thin += sample.thickness[v] < kThinVoxels * double(report.run.info.voxel_size);
  const std::string likely = over + "; likely cause: ";
  if (report.figures->bake.is_fit)
    return {"bound", likely + "the bake itself; no other program changed the lobes",
            "a single lobe cannot come closer: use a looser bound"};
  if (2 * thin > wrong)
    return {"too-coarse", likely + "most of the wrong vertices are on parts thinner than two voxels of the bake",
            "bake again with more --voxels or --bake-voxels"};
  if (isRough(report.run.info))
    return {"rough", likely + "a bake with few directions or voxels, which is somewhat wrong everywhere",
            "bake again with more --rays or --voxels"};
  return {"bound", likely + "the bake itself; no other program changed the lobes",
          "bake with more --rays or --voxels, or for transmittance with --lobe fit"};
}

std::string reshapedText(const SealDifference& seal) {
  return fmt::format("the mesh is not the one that was baked: its shape differs by {:.2g} %", 100 * seal.shape);
}

// What tells that something has changed, for people; empty if nothing has.
std::string changeOf(const CheckReport& report) {
  const Agreement& agreement = report.figures->agreement;
  const auto& seal = report.seal;
  const bool rebake_differs = !(agreement.rms <= agreement.most);
  if (seal && seal->mesh && (seal->isReshaped() || rebake_differs))
    return seal->isReshaped() ? reshapedText(*seal) : "the mesh is not the one that was baked";
  if (seal && !seal->mesh && !(seal->lobes <= kRounded))
    return fmt::format("the lobes are not those of the bake: they differ by {:.2g} % rms", 100 * seal->lobes);
  if (rebake_differs && seal && !seal->mesh && seal->isReshaped())
    return "a node or a joint was moved, scaled, added or removed since the bake";
  if (rebake_differs)
    return fmt::format("a new bake of the mesh gives other lobes: T differs by {:.2g} rms, over {:.2g}", agreement.rms, agreement.most);
  return "";
}

std::string harmonicsChange(const CheckReport& report) {
  const Agreement& agreement = report.figures->agreement;
  if (report.seal && !report.seal->mesh && !(report.seal->harmonics <= kRounded))
    return fmt::format("the spherical harmonics are not those of the bake: they differ by {:.2g} % rms", 100 * report.seal->harmonics);
  if (report.figures->harmonics && !(agreement.harmonics_rms <= agreement.most))
    return fmt::format("a new bake of the mesh gives other spherical harmonics: T differs by {:.2g} rms, over {:.2g}",
                       agreement.harmonics_rms, agreement.most);
  return "";
}

// Constants with which mean lobes show much less than they could. Of an asset with a seal, its own constants are known.
std::optional<AssetFault> unlikelyConstants(const CheckReport& report) {
  constexpr double kFactor = 1.1, kSlack = 0.05;
  const CheckFigures& figures = *report.figures;
  if (report.seal || figures.bake.is_fit || figures.bake.transmittance.rms <= kFactor * figures.mean_rms + kSlack) return std::nullopt;
  return AssetFault{
      "constants",
      fmt::format("the lobes are right, but with k {:.4g} and b {:.4g} T is off by {:.2g} rms, with the default ones by {:.2g}",
                  report.run.info.shape.exponent, report.run.info.shape.bias, figures.bake.transmittance.rms, figures.mean_rms),
      "give the asset the exponent and bias of its bake, or bake again"};
}

void noteHarmless(CheckReport& report) {
  if (!report.seal) return;
  const auto note = [&](const char* cause, const std::string& what) { report.file.harmless.push_back({cause, what, "nothing"}); };
  if (report.seal->mesh)
    return note("re-encoded", "the mesh has other bits than at the bake; its shape and what a new bake gives are the same");
  if (report.seal->isReshaped())
    note("placed-anew", fmt::format("nodes or joints have other places than at the bake (shape {:+.2g} %), which changes no lobe",
                                    100 * report.seal->shape));
  const bool is_half =
      std::any_of(report.file.harmless.begin(), report.file.harmless.end(), [](const auto& fault) { return fault.cause == "half-float"; });
  if (report.seal->lobes > 1e-6 && !is_half)
    note("rounded", fmt::format("the lobes were rounded since the bake, by {:.2g} % rms", 100 * report.seal->lobes));
}

}  // namespace

std::vector<FigureBound> boundsFor(const CheckFigures& figures, const ErrorBounds& asked) {
  std::vector<FigureBound> bounds;
  const auto bound = [&](const char* key, double most) { bounds.push_back({&figureField(key), most}); };
  if (asked.angle_degrees && !figures.bake.is_fit) bound("direction_rms_degrees", *asked.angle_degrees);
  if (asked.transmittance_rms) bound("transmittance_rms", *asked.transmittance_rms);
  for (const char* key : kSurfaceRmsKeys)
    if (asked.surface_rms) bound(key, *asked.surface_rms);
  if (!bounds.empty()) return bounds;
  if (figures.bake.is_fit) {
    bound("transmittance_rms", kFitFactor * figures.best_fit_rms + kFitSlack);
  } else {
    bound("direction_median_degrees", kMedian_degrees);
    bound("direction_rms_degrees", kRms_degrees);
    bound("density_bias", kDensityBias);
  }
  return bounds;
}

std::optional<AssetFault> staleFault(const std::optional<SealDifference>& seal) {
  if (!seal || seal->constants || !seal->mesh || !seal->isReshaped()) return std::nullopt;
  return AssetFault{"stale", reshapedText(*seal), kRebake};
}

std::optional<AssetFault> oddConstants(const AssetInfo& info, const SurfaceMesh& surface) {
  const double longest = boundingBox(surface).longestSide() * sizeAtTheBake(info, surface), depth = double(info.extinction) * longest;
  const double bias = std::fabs(double(info.shape.bias)) / longest;
  if (!(info.extinction > 0) || !std::isfinite(info.extinction))
    return oddMetadata(fmt::format("extinction {:g} is not a number above 0", info.extinction));
  if (depth > kMostOpticalDepth)
    return oddMetadata(
        fmt::format("extinction {:.4g} is so large that everything is opaque: the cloud is {:.3g} optical depths long (by default 7)",
                    info.extinction, depth));
  if (depth < kLeastOpticalDepth)
    return oddMetadata(
        fmt::format("extinction {:.4g} is so small that the cloud is invisible: it is {:.3g} optical depths long (by default 7)",
                    info.extinction, depth));
  if (!(info.shape.exponent > 0) || !(info.shape.exponent <= kLargestExponent))
    return oddMetadata(fmt::format("exponent {:g} is not a number above 0 and at most {:g}", info.shape.exponent, kLargestExponent));
  if (!(bias <= kLargestBias))
    return oddMetadata(fmt::format("bias {:.4g} is longer than the cloud, whose longest side is {:.4g}", info.shape.bias, longest));
  if (!(info.ray_length >= 0) || !std::isfinite(info.ray_length))
    return oddMetadata(fmt::format("ray_length {:g} is not a length", info.ray_length));
  if (info.ray_length > 0 && (info.ray_length > kLongestRay * longest || info.ray_length < kShortestRay * longest))
    return oddMetadata(fmt::format("ray_length {:.4g} does not fit a cloud whose longest side is {:.4g}", info.ray_length, longest));
  const bool no_range = info.extinction_low == 0 && info.extinction_high == 0;
  if (info.lobe == "fit" && !no_range &&
      !(info.extinction_low > 0 && info.extinction_low <= info.extinction && info.extinction <= info.extinction_high &&
        std::isfinite(info.extinction_high)))
    return oddMetadata(fmt::format("extinction {:.4g} is not within extinction_range {:.4g} to {:.4g}", info.extinction,
                                   info.extinction_low, info.extinction_high));
  return std::nullopt;
}

std::optional<AssetFault> judge(const CheckedAsset& asset, const AssetSample& sample, CheckReport& report) {
  const std::vector<AssetFault>& faults = report.file.faults;
  const std::string over = overBound(report.figures->bake, report.bounds), change = changeOf(report);
  const Diagnosis& diagnosis = *report.diagnosis;
  const Hypothesis& cause = diagnosis.tried[diagnosis.best];

  // Another program has moved or converted the UV sets.
  if (!faults.empty() && (report.file.undone || faults.front().cause == "moved")) {
    AssetFault fault = faults.front();
    fault.what += diagnosis.explained() ? "; also " + cause.what
                  : over.empty()        ? "; apart from that the lobes are intact"
                                        : "; apart from that " + over;
    return fault;
  }
  if (report.seal && report.seal->constants)
    return AssetFault{"constants",
                      "k, b, extinction, ray length or the target of the fit is not that of the bake" +
                          (diagnosis.explained() && report.seal->lobes > kRounded ? "; also " + cause.what : ""),
                      "restore the values of asset.extras.cloudbake, or bake again with other values"};
  // Where there is nothing, no change can be undone.
  if (!faults.empty() && (faults.front().cause == "not-finite" || faults.front().cause == "zeros")) return faults.front();
  const ChangedLobes changed{asset.lobes, sample.vertices, sample.right, sample.errors, report.seal && !report.seal->mesh};
  if (auto constant = change.empty() ? std::nullopt : nameConstant(changed)) return constant;
  if (!change.empty() && !sample.other_constants.empty())
    return AssetFault{"constants",
                      fmt::format("the lobes are those of {}, but asset.extras.cloudbake says exponent {:.4g} and bias {:.4g}",
                                  sample.other_constants, report.run.info.shape.exponent, report.run.info.shape.bias),
                      "give the asset the constants of its bake, or bake again"};
  // The seal tells what cannot be the cause: of lobes that are intact on nodes that moved, no change of lobes, and of a mesh that has
  // changed, none that would fit any mesh.
  const bool is_reshaped = report.seal && report.seal->isReshaped(), has_new_mesh = report.seal && report.seal->mesh;
  const bool is_placed_anew = is_reshaped && !has_new_mesh && report.seal->lobes <= kRounded;
  const bool fits_any_mesh = cause.cause == "node-transform" || cause.cause == "rescaled";
  const bool is_likely = !is_placed_anew && !(is_reshaped && has_new_mesh && fits_any_mesh);
  if (diagnosis.explained() && is_likely && (!change.empty() || !over.empty() || !faults.empty())) {
    const std::string symptom = !over.empty() ? over : !faults.empty() ? faults.front().what : change;
    return AssetFault{cause.cause, symptom + "; likely cause: " + cause.what, cause.cure};
  }
  if (!faults.empty()) return faults.front();
  if (!change.empty()) {
    if (has_new_mesh || is_placed_anew) return AssetFault{"stale", change, kRebake};
    AssetFault fault = nameChange(changed);
    fault.what = change + "; likely cause: " + fault.what;
    return fault;
  }
  if (const std::string harmonics = harmonicsChange(report); !harmonics.empty())
    return AssetFault{"harmonics", harmonics, "keep the attributes _TRANSMITTANCE_SH_0 and up as they are, or bake as the last step"};
  if (report.lattice_rms && !(*report.lattice_rms <= kLatticeAgreement))
    return AssetFault{"lattice",
                      fmt::format("a new lattice of the mesh has other coefficients: T differs by {:.2g} rms", *report.lattice_rms),
                      "write the lattice and the asset with one bake"};
  if (!over.empty()) return namePoorBake(over, sample, report);
  if (auto unlikely = unlikelyConstants(report)) return unlikely;
  noteHarmless(report);
  return std::nullopt;
}

}  // namespace cloudbake
