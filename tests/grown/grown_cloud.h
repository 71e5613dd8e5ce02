// A cloud that grows from a preset.
#pragma once

#include <string>
#include <vector>

#include "pipeline/sources/grown.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {

/// `texts` are options, as "voxels=40".
inline Cloud grownCloud(const char* preset, const std::vector<std::string>& texts) {
  const SourceSettings from = sourceOf(SourceKind::kPreset, preset);
  GrownSource source = readGrownSource(from);
  std::vector<Given> given = source.given;
  for (const Given& one : options(texts, kGrow)) given.push_back(one);
  BakeReport report;
  Stopwatch watch;
  return growCloud(std::move(source), resolve(from, given), std::nullopt, report, watch);
}

}  // namespace cloudbake
