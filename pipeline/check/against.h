// `check A.glb --against B.glb`: what a pipeline did to an asset.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/check/report.h"
#include "pipeline/settings.h"

namespace cloudbake {

/// Per vertex of `mesh` the vertex of `before` at its place, or kUnmatched. Places agree within 1e-4 of the diagonal of `before`; of
/// several the nearest is taken, of equally near ones the one whose normal agrees best.
constexpr uint32_t kUnmatched = UINT32_MAX;
std::vector<uint32_t> matchVertices(const SurfaceMesh& mesh, const SurfaceMesh& before);

/// Compares an asset with settings.against and judges it.
CheckReport checkAgainst(const std::filesystem::path& asset, const JudgeSettings& settings);

}  // namespace cloudbake
