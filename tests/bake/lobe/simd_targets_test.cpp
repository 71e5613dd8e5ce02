// All that is computed by Highway's kernels, once per target that this CPU can run: the same bytes.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/lobe/fit_lobe.h"
#include "bake/lobe/sparse_points.h"
#include "bake/lobe/sphere_rays.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_target.h"
#include "bake/mesh/mesh_topology.h"
#include "late/simd_targets.h"
#include "tests/forced_target.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

struct Result {
  std::string name;
  std::vector<unsigned char> bytes;
};

template <class T>
Result resultOf(std::string name, const std::vector<T>& values) {
  Result result{std::move(name), std::vector<unsigned char>(values.size() * sizeof(T))};
  std::memcpy(result.bytes.data(), values.data(), result.bytes.size());
  return result;
}

// A torus and a ball beside it, with an odd number of vertices.
SurfaceMesh cloudMesh() { return merged(torusMesh(1, 0.4F, 47, 19), ballMesh(0.31F, 3, {0.1F, 0.9F, 0.2F})); }

std::vector<Result> computeAll() {
  const SurfaceMesh mesh = cloudMesh();
  const BakePoints points{mesh.positions, mesh.normals};
  const float diagonal = boundingBox(mesh).diagonal();
  Warnings warnings;
  LevelSetSettings level_set_settings;
  level_set_settings.voxels = 45;
  const LevelSet level_set = levelSetFromMesh(mesh, level_set_settings, warnings);
  const CoverageField by_mesh = coverageFromMesh(mesh, level_set.frame).value(),
                      by_level_set = coverageFromLevelSet(level_set, mesh.positions);

  std::vector<Result> results;
  for (const float ray_length : {diagonal, 0.3F * diagonal}) {
    BakeSettings settings;
    settings.rays = 60;
    settings.ray_length = ray_length;
    const std::string length_name = ray_length < diagonal ? "-short" : "";
    results.push_back(resultOf("sweep-coverage" + length_name, bakeSweep(points, by_mesh, settings, warnings)));
    results.push_back(resultOf("sweep-level-set" + length_name, bakeSweep(points, by_level_set, settings, warnings)));
    results.push_back(resultOf("swept-lengths" + length_name, sweptLengths(mesh.positions, sweepAxes(30), by_mesh, double(ray_length))));
  }
  VolumeTargetSettings volume{{2, 5}, {1.5F, {2}, 0.4F}, double(diagonal), 16, 3};
  results.push_back(resultOf("volume-target", volumeTarget(points, sweepAxes(10), by_mesh, volume).radiance));
  volume.may_interpolate = true;
  results.push_back(resultOf("volume-target-lattice", volumeTarget(points, sweepAxes(10), by_mesh, volume).radiance));
  const std::vector<Vec3> axes = sweepAxes(30);
  const std::vector<float> by_axis = sweptLengths(mesh.positions, axes, by_mesh, double(diagonal));
  std::vector<float> by_point;
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    for (size_t j = 0; j < 2 * axes.size(); ++j) by_point.push_back(by_axis[j * mesh.positions.size() + v]);
  FitSettings fit;
  fit.extinctions = {1, 2, 5};
  const std::vector<Lobe> starts(mesh.positions.size(), {{0, 1, 0}, 0.5F});
  results.push_back(resultOf("fit", fitLobes(starts, {bothSenses(axes), by_point, {}}, fit)));
  // Many places with few cells, whose lobes are blended
  const SurfaceMesh fine = torusMesh(1, 0.4F, 521, 307);
  const CoverageField coarse = coverageFromMesh(fine, {{0, 0, 0}, 0.1}).value();
  const SparsePoints sparse = SparsePoints::choose({fine.positions, fine.normals}, coarse).value();
  std::vector<Lobe> some;
  for (const size_t v : sparse.chosen()) some.push_back({fine.normals[v], 1 + fine.positions[v].y});
  results.push_back(resultOf("blended", sparse.blended(some)));
  const DenseField dense = denseFromLevelSet(level_set);
  for (const Sampler sampler : {Sampler::kStratified, Sampler::kFibonacci, Sampler::kUniform})
    for (const Quadrature quadrature : {Quadrature::kCrossing, Quadrature::kMidpoint, Quadrature::kEnd}) {
      BakeSettings settings;
      settings.rays = 33;
      settings.sampler = sampler;
      settings.quadrature = quadrature;
      settings.ray_length = diagonal;
      results.push_back(resultOf("rays-" + std::to_string(int(sampler)) + "-" + std::to_string(int(quadrature)),
                                 bakeSphereRays(points, dense, settings, warnings)));
    }
  BakeSettings marched;
  marched.ray_length = 0.4F * diagonal;
  results.push_back(resultOf("marched-lengths", marchedLengths(mesh.positions, sweepAxes(14), dense, marched)));
  return results;
}

}  // namespace

#ifdef CLOUDBAKE_FINDS_SIMD_TARGETS
// The program starts without libhwy, and dispatches to what libhwy would choose.
TEST(SimdTargets, AreThoseThatHighwayFinds) { EXPECT_EQ(supportedSimdTargets(), (hwy::SupportedTargets() | HWY_EMU128) & HWY_TARGETS); }
#endif

// Each target gives the bytes that the default one gives, and the dispatch table is at the target that was asked for.
TEST(SimdTargets, AllGiveTheSameBytes) {
  const std::vector<Result> expected = computeAll();
  std::string ran;
  int count = 0;
  std::vector<size_t> indices;
  for (const int64_t target : runnableTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    const ForcedTarget forced(target);
    indices.push_back(hwy::GetChosenTarget().GetIndex());
    ran += std::string(" ") + hwy::TargetName(target);
    ++count;
    const std::vector<Result> results = computeAll();
    ASSERT_EQ(results.size(), expected.size());
    for (size_t i = 0; i < results.size(); ++i) {
      EXPECT_EQ(results[i].bytes.size(), expected[i].bytes.size());
      EXPECT_TRUE(results[i].bytes == expected[i].bytes) << results[i].name;
    }
    EXPECT_EQ(hwy::GetChosenTarget().GetIndex(), indices.back());
  }
  std::printf("[figures] SIMD targets that ran:%s\n", ran.c_str());
  std::sort(indices.begin(), indices.end());
  EXPECT_TRUE(std::adjacent_find(indices.begin(), indices.end()) == indices.end()) << "two targets share an entry of the dispatch table";
  EXPECT_GE(count, 2) << "no target but the default could be forced";
}

// What is compared are results, not zeros: lengths and densities are positive for most points.
TEST(SimdTargets, ResultsAreNotTrivial) {
  for (const Result& result : computeAll()) {
    size_t zeros = 0, values = result.bytes.size() / sizeof(float);
    for (size_t i = 0; i < values; ++i) {
      float value;
      std::memcpy(&value, result.bytes.data() + i * sizeof(float), sizeof(float));
      ASSERT_TRUE(std::isfinite(value)) << result.name;
      zeros += value == 0;
    }
    EXPECT_GT(values, 1000U) << result.name;
    EXPECT_LT(zeros, values * 3 / 4) << result.name;
  }
}

// One number per result: tests/cli/same_under_tunables compares them between glibc's variants of the maths functions.
TEST(SimdTargets, PrintsItsHash) {
  for (const Result& result : computeAll()) {
    uint64_t hash = 0xCBF29CE484222325ULL;  // FNV-1a
    for (const unsigned char byte : result.bytes) hash = (hash ^ byte) * 0x100000001B3ULL;
    std::printf("[hash] %s %016llx\n", result.name.c_str(), static_cast<unsigned long long>(hash));
  }
}
