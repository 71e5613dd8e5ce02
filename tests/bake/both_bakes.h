// A mesh through the whole pipeline, by both methods: coverage and sweep, level set and rays.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/lobe/sphere_rays.h"
#include "bake/lobe/sweep.h"
#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "tests/bake/lobe_helpers.h"
#include "tests/warnings.h"

namespace cloudbake {

struct BothBakes {
  std::vector<Lobe> sweep, rays;
  Warnings sweep_warnings, rays_warnings;
};

inline LevelSetSettings latticeOf(int voxels) {
  LevelSetSettings settings;
  settings.voxels = voxels;
  return settings;
}

inline std::vector<Lobe> sweptLobes(const SurfaceMesh& solid, const BakePoints& points, const LevelSetSettings& lattice, Warnings& warnings,
                                    int directions = 100) {
  BakeSettings settings;
  settings.rays = directions;
  settings.ray_length = boundingBox(solid).diagonal();
  return bakeSweep(points, coverageFromClosedMesh(solid, lattice, warnings).value(), settings, warnings);
}

/// A fixed Fibonacci set, so that rays have no noise of their own.
inline std::vector<Lobe> rayLobes(const SurfaceMesh& solid, const BakePoints& points, const LevelSetSettings& lattice, Warnings& warnings,
                                  int directions = 100) {
  BakeSettings settings;
  settings.method = Method::kRays;
  settings.sampler = Sampler::kFibonacci;
  settings.rotate_directions = false;
  settings.rays = directions;
  settings.steps = 150;
  settings.ray_length = boundingBox(solid).diagonal();
  return bakeSphereRays(points, denseFromLevelSet(levelSetFromMesh(solid, lattice, warnings)), settings, warnings);
}

/// The lobes of points of a closed mesh.
inline BothBakes bakedBothWays(const SurfaceMesh& solid, const BakePoints& points, const LevelSetSettings& lattice, int directions = 100) {
  BothBakes bakes;
  bakes.sweep = sweptLobes(solid, points, lattice, bakes.sweep_warnings, directions);
  bakes.rays = rayLobes(solid, points, lattice, bakes.rays_warnings, directions);
  return bakes;
}

/// The lobes of its own vertices.
inline BothBakes bakedBothWays(const SurfaceMesh& solid, int voxels, int directions = 100) {
  return bakedBothWays(solid, {solid.positions, solid.normals}, latticeOf(voxels), directions);
}

/// Degrees between two bakes.
struct AngleFigures {
  double median = 0, p95 = 0, largest = 0;
};
inline AngleFigures anglesBetween(std::span<const Lobe> a, std::span<const Lobe> b) {
  std::vector<double> angles;
  for (size_t v = 0; v < a.size(); ++v) angles.push_back(angleDegrees(a[v].direction, b[v].direction));
  std::sort(angles.begin(), angles.end());
  return {angles.at(angles.size() / 2), angles[angles.size() * 95 / 100], angles.back()};
}

/// What an InputError says; empty where nothing is refused.
template <class Run>
std::string refusalOf(const Run& run) {
  try {
    run();
  } catch (const InputError& error) {
    return error.message;
  }
  return "";
}

}  // namespace cloudbake
