// The field of a mesh, and lobes against each other and against those of a ball.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "bake/field/coverage.h"
#include "bake/field/level_set.h"
#include "tests/shapes.h"

namespace cloudbake {

/// The coverage of a closed mesh with so many voxels along its longest side.
inline CoverageField coverageOf(const SurfaceMesh& mesh, int voxels) {
  LevelSetSettings settings;
  settings.voxels = voxels;
  return coverageFromMesh(mesh, frameFor(boundingBox(mesh), settings)).value();
}

using LobeBits = std::array<uint32_t, 4>;
inline LobeBits bitsOf(const Lobe& lobe) { return std::bit_cast<LobeBits>(lobe); }

inline bool sameBytes(const std::vector<Lobe>& a, const std::vector<Lobe>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Lobe)) == 0;
}

/// Degrees of the directions, and shares of the thickness.
struct BallFigures {
  double median, p95, density_bias, density_worst;
};
/// Ball of radius R: o = inward normal, d = 2R at every vertex.
inline BallFigures ballFigures(std::span<const Lobe> lobes, std::span<const Vec3> positions, Vec3 center, float radius) {
  std::vector<double> angles;
  double sum = 0, worst = 0;
  for (size_t v = 0; v < lobes.size(); ++v) {
    const Lobe truth = ballLobe(positions[v], center, radius);
    angles.push_back(angleDegrees(lobes[v].direction, truth.direction));
    const double error = double(lobes[v].thickness) / truth.thickness - 1;
    sum += error, worst = std::max(worst, std::fabs(error));
  }
  std::sort(angles.begin(), angles.end());
  return {angles[angles.size() / 2], angles[angles.size() * 95 / 100], sum / double(lobes.size()), worst};
}

}  // namespace cloudbake
