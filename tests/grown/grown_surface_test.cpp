// Surfaces of grown clouds, of volumes and of sculpts are valid at every size. CLOUDBAKE_SWEEP=N in the environment takes N seeds per
// preset instead of one, and finer lattices; the default is what a change should not have to wait for.
#include <array>
#include <cstdlib>
#include <map>

#include "bake/field/level_set.h"
#include "bake/mesh/repair.h"
#include "bake/mesh/shells.h"
#include "bake/mesh/surface.h"
#include "core/level_set_type.h"
#include "core/parallel.h"
#include "core/random.h"
#include "pipeline/options/presets.h"
#include "tests/folders.h"
#include "tests/grown/grown_cloud.h"
#include "tests/mesh_validity.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"
#include "tests/warnings.h"

namespace cloudbake {
namespace {

// The number of seeds, if a sweep was asked for.
std::optional<uint64_t> sweepSeeds() {
  const char* text = std::getenv("CLOUDBAKE_SWEEP");
  return text ? std::optional<uint64_t>(std::strtoull(text, nullptr, 10)) : std::nullopt;
}

struct Tally {
  size_t meshes = 0, missed = 0, faulty = 0;
};

// A surface of as many vertices as asked, or with a reason why not.
void checkSurface(const LevelSet& level_set, std::optional<size_t> budget, size_t full, const std::string& what, Tally& tally) {
  Warnings warnings;
  const SurfaceMesh mesh = meshFromLevelSet(level_set, {budget}, warnings);
  const MeshFaults faults = faultsOf(mesh);
  EXPECT_EQ(faults.count(), 0U) << what << ": " << faults;
  EXPECT_GT(signedVolume(mesh), 0) << what;
  ++tally.meshes, tally.faulty += faults.count() > 0;
  if (!budget) return;
  const size_t expected = std::min(*budget, full);
  const bool is_missed = mesh.positions.size() > expected;
  tally.missed += is_missed;
  EXPECT_GE(mesh.positions.size(), expected) << what;
  EXPECT_EQ(countOf(warnings, WarningKind::kVertexBudget), is_missed ? 1U : 0U) << what << ": " << mesh.positions.size();
}

// Where the surface is one ball-like body, every budget that has a use is met.
TEST(GrownSurface, IsValidForEveryPresetSeedLatticeAndBudget) {
  const uint64_t seeds = sweepSeeds().value_or(1);
  const std::vector<int> lattices = sweepSeeds() ? std::vector{40, 100, 237} : std::vector{40, 100};
  Tally tally;
  for (const Preset& preset : presets())
    for (uint64_t seed = 1; seed <= seeds; ++seed)
      for (const int voxels : lattices) {
        const std::string name = std::string(preset.name) + " --seed " + std::to_string(seed) + " --voxels " + std::to_string(voxels);
        const Cloud cloud = grownCloud(preset.name, {"seed=" + std::to_string(seed), "voxels=" + std::to_string(voxels)});
        const size_t full = cloud.surface.positions.size();
        for (const size_t budget : {size_t(0), full / 2, size_t(10000), size_t(3000), size_t(300)})
          checkSurface(*cloud.level_set, budget > 0 ? std::optional(budget) : std::nullopt, full,
                       name + " --vertices " + std::to_string(budget), tally);
      }
  std::printf("[  figures ] %zu surfaces, %zu with faults, %zu budgets missed\n", tally.meshes, tally.faulty, tally.missed);
}

// A base with bumps cuts off no crumbs: every preset that connects its spheres is one body, on the lattice of its own.
TEST(GrownSurface, PresetsThatConnectAreOneBody) {
  for (const Preset& preset : presets()) {
    if (std::string_view(preset.toml).find("connect = false") != std::string_view::npos) continue;
    for (uint64_t seed = 1; seed <= sweepSeeds().value_or(runsWhole() ? 3 : 1); ++seed) {
      const Cloud cloud = grownCloud(preset.name, {"seed=" + std::to_string(seed)});
      const std::vector<Shell> shells = shellsOf(cloud.surface);
      const std::vector<bool> inner = innerShells(cloud.surface, shells);  // hollows between spheres
      EXPECT_EQ(std::count(inner.begin(), inner.end(), false), 1) << preset.name << " --seed " << seed;
    }
  }
}

// Noise on the lattice itself: sheets and handles in every cell, and every kind of ambiguous one. `coarse` repeats a value so often along
// each axis, and `rounded` leaves only signs and zeros.
LevelSet noise(uint64_t seed, int coarse, bool rounded) {
  constexpr int kSide = 20, kRim = 2;
  const auto grid = openvdb::FloatGrid::create(kBandHalfWidth_voxels);
  const auto is_rim = [](int x) { return x < kRim || x >= kSide - kRim; };
  for (int x = 0; x < kSide; ++x)
    for (int y = 0; y < kSide; ++y)
      for (int z = 0; z < kSide; ++z) {
        const auto side = uint64_t(kSide), cell = (uint64_t(x / coarse) * side + uint64_t(y / coarse)) * side + uint64_t(z / coarse);
        const auto value = float(2 * uniformDouble(mix64(seed << 32 | cell)) - 1);
        grid->tree().setValue({x, y, z}, is_rim(x) || is_rim(y) || is_rim(z) ? 1 : rounded ? std::round(value) : value);
      }
  return {std::make_shared<LevelSetGrid>(LevelSetGrid{grid}), {}};
}

TEST(GrownSurface, IsValidForVolumesOfNoise) {
  Tally tally;
  for (uint64_t seed = 1; seed <= sweepSeeds().value_or(1); ++seed)
    for (const int coarse : {1, 2})
      for (const bool rounded : {false, true}) {
        const LevelSet level_set = noise(seed, coarse, rounded);
        Warnings warnings;
        const size_t full = meshFromLevelSet(level_set, {}, warnings).positions.size();
        for (const size_t budget : {size_t(0), full / 2, full / 8, size_t(4)})
          checkSurface(level_set, budget > 0 ? std::optional(budget) : std::nullopt, full,
                       "seed " + std::to_string(seed) + ", coarse " + std::to_string(coarse) + (rounded ? ", rounded" : "") +
                           ", vertices " + std::to_string(budget),
                       tally);
      }
  EXPECT_GT(tally.missed, 0U);  // no four vertices hold so many handles
}

TEST(GrownSurface, IsTheSameForAnyNumberOfThreads) {
  const Cloud cloud = grownCloud("hero", {"seed=1", "voxels=100"});
  const auto reduced = [&] {
    SurfaceMesh mesh = cloud.surface;
    Warnings warnings;
    reduceVertices(mesh, 5000, warnings);
    return mesh;
  };
  const SurfaceMesh many = reduced();
  const ThreadLimit limit(1);
  const SurfaceMesh one = reduced();
  EXPECT_EQ(many.positions, one.positions);
  EXPECT_EQ(many.triangles, one.triangles);
}

TEST(GrownSurface, IsValidForSculptsOfNewTriangles) {
  const SurfaceMesh box = boxMesh({-1, -0.4F, -0.6F}, {1, 0.4F, 0.6F});
  for (const auto& [name, sculpt] :
       {std::pair("ball", ballMesh(1, 4)), std::pair("torus", torusMesh(1, 0.4F, 80, 40)), std::pair("box", box)})
    for (const double edge : {0.2, 0.05}) {
      SurfaceMesh mesh;
      try {
        mesh = remeshed(sculpt, edge);
      } catch (const InputError& error) {
        if (std::string(error.what()).find("CGAL") == std::string::npos) throw;
        GTEST_SKIP() << error.what();
      }
      const size_t full = mesh.positions.size();
      for (const size_t budget : {full, full / 4}) {
        Warnings warnings;
        reduceVertices(mesh, budget, warnings);
        mesh.normals = smoothNormals(mesh);
        EXPECT_EQ(mesh.positions.size(), budget) << name;
        EXPECT_EQ(faultsOf(mesh).count(), 0U) << name << ", edge " << edge << ", vertices " << budget << ": " << faultsOf(mesh);
      }
    }
}

// What is counted is found.
TEST(GrownSurface, FaultsAreCounted) {
  const auto faults = [](const auto& spoil) {
    SurfaceMesh ball = ballMesh(1, 2);
    ball.normals = smoothNormals(ball);
    spoil(ball);
    return faultsOf(ball);
  };
  EXPECT_EQ(faults([](SurfaceMesh&) {}).count(), 0U);
  EXPECT_EQ(faults([](SurfaceMesh& m) { m.triangles.push_back(m.triangles[3]); }).doubled_triangles, 1U);
  EXPECT_EQ(faults([](SurfaceMesh& m) { m.triangles.pop_back(); }).unmatched_sides, 3U);
  EXPECT_EQ(faults([](SurfaceMesh& m) { m.normals[5] = {}; }).wrong_normals, 1U);
  EXPECT_EQ(faults([](SurfaceMesh& m) { m.positions.push_back({9, 9, 9}), m.normals.push_back({0, 1, 0}); }).unused_vertices, 1U);
  EXPECT_GT(faults([](SurfaceMesh& m) { m.positions[m.triangles[0][0]] = m.positions[m.triangles[0][1]]; }).flat_triangles, 0U);
  EXPECT_GT(faults([](SurfaceMesh& m) { m.positions[m.triangles[0][0]] = m.positions[m.triangles[0][1]]; }).repeated_positions, 0U);
  // A triangle that comes back over its neighbour.
  EXPECT_GT(faults([](SurfaceMesh& m) {
              const Vec3 far = 0.5F * (m.positions[m.triangles[0][1]] + m.positions[m.triangles[0][2]]);
              m.positions[m.triangles[0][0]] = far + 1.5F * (far - m.positions[m.triangles[0][0]]);
            }).folds,
            0U);
  // Two balls that share a vertex.
  EXPECT_EQ(faults([](SurfaceMesh& m) {
              const auto count = uint32_t(m.positions.size());
              const size_t triangles = m.triangles.size();
              for (uint32_t v = 0; v < count; ++v) m.positions.push_back(m.positions[v] + Vec3{5, 0, 0}), m.normals.push_back(m.normals[v]);
              for (size_t f = 0; f < triangles; ++f) {
                Triangle t = m.triangles[f];
                for (uint32_t& v : t) v = v == 0 ? 0 : v + count;
                m.triangles.push_back(t);
              }
            }).pinched_vertices,
            1U);
}

}  // namespace
}  // namespace cloudbake
