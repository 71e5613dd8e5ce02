// preview --compare: compares the light on an asset with exact transmittance, a render of its volume, and the light of engines without
// lobes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "io/gltf/asset_info.h"
#include "io/report/report.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// The difference between two pictures as shown (tone mapped), over the pixels with cloud.
struct PictureFigures {
  double rms = 0, psnr = 0, ssim = 1;
};

struct ComparedPicture {
  std::string name;
  PictureFigures to_truth, to_volume;  ///< from the per-vertex truth, and from the volume render
  double luminance_spread = 0;         ///< standard deviation of the luminance over the pixels with cloud
};

/// One asset under one sun.
struct SunComparison {
  float azimuth_degrees = 0, elevation_degrees = 0;
  std::vector<ComparedPicture> pictures;
  /// rms error of T on the visible surface against exp(−σℓ), by the name of the model. This is what a lobe models, without colours.
  std::vector<std::pair<std::string, double>> surface_rms;
};

struct Comparison {
  Image sheet;                      ///< labelled panels with their errors below; display-referred
  SunComparison sun;                ///< of the sheet
  std::vector<SunComparison> suns;  ///< those of --suns
};

/// Reads settings.source.input and compares it under the sun of settings.picture, and under settings.picture.suns other suns, above the
/// horizon or on the arc that the lobes were fitted for. Throws as decodeGlb and readSculpt do.
Comparison compareAsset(const Settings& settings, BakeReport& report, Stopwatch& watch);

std::string comparisonText(const Comparison& comparison);
Json comparisonJson(const Comparison& comparison);

}  // namespace cloudbake
