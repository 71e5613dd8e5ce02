// preview --compare: an asset's light beside exact transmittance, a render of its volume, and what engines do without lobes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "io/gltf/asset_info.h"
#include "io/report/report.h"
#include "pipeline/settings.h"
#include "pipeline/stopwatch.h"

namespace cloudbake {

/// How far a picture is from another, as shown (tone mapped), over the pixels with cloud.
struct PictureFigures {
  double rms = 0, psnr = 0, ssim = 1;
};

struct ComparedPicture {
  std::string name;
  PictureFigures to_truth, to_volume;  ///< from the per-vertex truth, and from the volume render
};

/// One asset under one sun.
struct SunComparison {
  float azimuth_degrees = 0, elevation_degrees = 0;
  std::vector<ComparedPicture> pictures;
  /// rms of T as the surface shows it, against exp(−σℓ), by what stands for it: what a lobe models, free of colours.
  std::vector<std::pair<std::string, double>> surface_rms;
};

struct Comparison {
  Image sheet;                      ///< labelled panels, and their errors below them; display-referred
  SunComparison sun;                ///< of the sheet
  std::vector<SunComparison> suns;  ///< of --suns
};

/// Reads settings.source.input and compares it under the sun of settings.picture, and under settings.picture.suns others: above the
/// horizon, or on the arc that the lobes were fitted for. Throws as decodeGlb and readSculpt.
Comparison compareAsset(const Settings& settings, BakeReport& report, Stopwatch& watch);

std::string comparisonText(const Comparison& comparison);
Json comparisonJson(const Comparison& comparison);

}  // namespace cloudbake
