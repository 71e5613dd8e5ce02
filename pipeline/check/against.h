// `check A.glb --against B.glb`: finds what a pipeline did to an asset.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/check/report.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// For each vertex of `mesh` the vertex of `before` at the same position, or kUnmatched. Positions agree within `tolerance` of the
/// diagonal of `before`. The nearest vertex is taken, and among equally near ones the one whose normal agrees best.
constexpr uint32_t kUnmatched = UINT32_MAX;
std::vector<uint32_t> matchVertices(const SurfaceMesh& mesh, const SurfaceMesh& before, double tolerance = 1e-4);

/// Compares an asset with settings.against and judges it.
CheckReport checkAgainst(const std::filesystem::path& asset, const JudgeSettings& settings, const ReadSettings& read = {},
                         const std::function<void(const std::string& stage)>& on_stage = {});

}  // namespace cloudbake
