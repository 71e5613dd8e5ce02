// Seconds of each kernel on one and on two threads, with a hash of what it computed: the same for any number of threads, or the bench
// fails. A kernel is one call of addBench with its name, how many items one run treats, and a function that returns its result's bytes.
//   cloudbake_bench [Google Benchmark's options] [closed mesh in place of a torus]
#include <benchmark/benchmark.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <stdexcept>

#include "bake/field/coverage.h"
#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/field/winding.h"
#include "bake/lobe/directions.h"
#include "bake/lobe/fit_lobe.h"
#include "bake/lobe/sliced_field.h"
#include "bake/lobe/sphere_rays.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_target.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/smooth_lobes.h"
#include "bake/mesh/surface.h"
#include "bake/truth/peers.h"
#include "bake/truth/reference.h"
#include "core/level_set_type.h"
#include "core/lobe_lighting.h"
#include "core/random.h"
#include "core/vertex_normals.h"
#include "io/file/write_file.h"
#include "io/sculpt/read_mesh.h"
#include "lsystem/recipe.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

/// What the kernels work on.
struct BenchInput {
  SurfaceMesh mesh = torusMesh(1, 0.4F, 256, 128);  // 65,536 triangles
  std::vector<Sphere> spheres;
  LevelSet level_set;  // of the mesh, 100 voxels
  DenseField dense;
  std::unique_ptr<Reference> exact;
  std::vector<Vec3> positions, normals;  // 256 vertices of the mesh
  BakeSettings settings;                 // N = 100, S = 100
  BakePoints points() const { return {positions, normals}; }
};

BenchInput makeInput(const char* file) {
  BenchInput input;
  if (file) {
    Warnings warnings;
    input.mesh = surfaceInScene(readMesh(file, {}, warnings));
    input.mesh.normals = vertexNormals(input.mesh.positions, input.mesh.triangles);
  }
  const std::vector<Vec3> centers = fibonacciDirections(60);
  for (size_t i = 0; i < centers.size(); ++i) input.spheres.push_back({centers[i], 0.3F + 0.3F * float(i % 7) / 7});
  Warnings warnings;
  input.level_set = levelSetFromMesh(input.mesh, {}, warnings);
  input.dense = denseFromLevelSet(input.level_set);
  input.exact = meshReference(input.mesh);
  for (size_t v = 0; v < input.mesh.positions.size(); v += std::max<size_t>(input.mesh.positions.size() / 256, 1))
    input.positions.push_back(input.mesh.positions[v]), input.normals.push_back(input.mesh.normals[v]);
  input.settings.ray_length = boundingBox(input.mesh).diagonal();
  return input;
}

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::string bytesOf(const std::vector<Lobe>& lobes) {
  std::vector<float> values;
  for (const auto& [direction, density] : lobes) values.insert(values.end(), {direction.x, direction.y, direction.z, density});
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::string bytesOf(const LevelSet& level_set) {
  std::vector<float> values;
  for (auto it = level_set.grid->vdb->cbeginValueOn(); it; ++it) values.push_back(*it);
  return bytesOf(values);
}

// The label is the hash; "per_item" is seconds for one of `items`. The first run sets the hash that all others must find.
void addBench(const std::string& name, double items, const std::function<std::string()>& work) {
  const auto expected = std::make_shared<std::string>();
  const auto run = [=](benchmark::State& state) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, size_t(state.range(0)));
    std::string bytes;
    for (auto _ : state) bytes = work();
    const std::string hash = hashBytes(bytes);
    if (expected->empty()) *expected = hash;
    if (hash != *expected) state.SkipWithError("another result than with the first number of threads");
    state.SetLabel("hash " + hash.substr(0, 16));
    state.counters["per_item"] = benchmark::Counter(items, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  };
  benchmark::RegisterBenchmark(name.c_str(), run)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
}

void addFieldBenches(const BenchInput& input) {
  addBench("level_set/mesh", double(input.mesh.triangles.size()), [&] {
    Warnings warnings;
    return bytesOf(levelSetFromMesh(input.mesh, {}, warnings));
  });
  addBench("level_set/spheres", double(input.spheres.size()), [&] {
    Warnings warnings;
    return bytesOf(levelSetFromSpheres(input.spheres, {}, warnings));
  });
  addBench("dense_field", double(input.dense.values.size()), [&] { return bytesOf(denseFromLevelSet(input.level_set).values); });
  addBench("winding_columns", double(input.mesh.triangles.size()), [&] {
    std::vector<Vec3> positions;
    for (const Vec3& p : input.mesh.positions) positions.push_back(input.level_set.frame.toIndex(p));
    std::vector<float> heights;
    for (const auto& crossing : windingColumns(latticePoints(positions), input.mesh.triangles).crossings) heights.push_back(crossing.z);
    return bytesOf(heights);
  });
}

LevelSetSettings voxels(int count) {
  LevelSetSettings settings;
  settings.voxels = count;
  return settings;
}

// OpenVDB's own call, alone: what a sculpt's level set costs at least.
void addMeshToLevelSet(const BenchInput& input, int count) {
  addBench("peer/mesh_to_level_set/voxels:" + std::to_string(count), double(input.mesh.triangles.size()), [&input, count] {
    const GridFrame frame = frameFor(boundingBox(input.mesh), voxels(count));
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    for (const Vec3& p : input.mesh.positions) {
      const Vec3 index = frame.toIndex(p);
      points.emplace_back(index.x, index.y, index.z);
    }
    for (const Triangle& t : input.mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    return bytesOf(
        std::vector<uint64_t>{openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles, 3)->activeVoxelCount()});
  });
}

// Triangles to coverage, coverage to lobes: along vertices, directions and voxels.
void addSweepBenches(const BenchInput& input) {
  const double triangles = double(input.mesh.triangles.size());
  const auto sweep = [](const std::string& name, const SurfaceMesh& mesh, int voxel_count, int directions) {
    const auto field = std::make_shared<CoverageField>(*coverageFromMesh(mesh, frameFor(boundingBox(mesh), voxels(voxel_count))));
    BakeSettings settings;
    settings.rays = directions;
    settings.ray_length = boundingBox(mesh).diagonal();
    addBench(name, double(mesh.positions.size()) * directions, [&mesh, field, settings] {
      Warnings warnings;
      return bytesOf(bakeSweep({mesh.positions, mesh.normals}, *field, settings, warnings));
    });
  };
  for (const int count : {35, 100, 200}) {
    const GridFrame frame = frameFor(boundingBox(input.mesh), voxels(count));
    addBench("coverage/voxels:" + std::to_string(count), triangles,
             [&input, frame] { return bytesOf(coverageFromMesh(input.mesh, frame)->fractions); });
  }
  for (const int count : {35, 70, 100, 140, 200}) sweep("sweep/voxels:" + std::to_string(count), input.mesh, count, 100);
  for (const int directions : {36, 100, 400, 1600}) sweep("sweep/directions:" + std::to_string(directions), input.mesh, 35, directions);
  static const SurfaceMesh k10 = torusMesh(1, 0.4F, 125, 80), k100 = torusMesh(1, 0.4F, 400, 250), k1000 = torusMesh(1, 0.4F, 1250, 800);
  for (const SurfaceMesh* mesh : {&k10, &k100, &k1000}) sweep("sweep/vertices:" + std::to_string(mesh->positions.size()), *mesh, 100, 100);
}

// The edges of a mesh and what is made of them.
void addEdgeBenches() {
  static const SurfaceMesh k13 = torusMesh(1, 0.4F, 160, 80), k205 = torusMesh(1, 0.4F, 640, 320), k1024 = torusMesh(1, 0.4F, 1600, 640);
  for (const SurfaceMesh* mesh : {&k13, &k205, &k1024}) {
    const size_t count = mesh->positions.size();
    const auto add = [&](const std::string& name, const std::function<std::string()>& work) {
      addBench("edges/" + name + "/vertices:" + std::to_string(count), double(count), work);
    };
    add("walk", [mesh] {
      uint64_t edges = 0;
      forEachEdge(mesh->positions.size(), mesh->triangles, Degenerate::kKept, [&](uint32_t, std::span<EdgeSide>) { ++edges; });
      return bytesOf(std::vector{edges});
    });
    add("reduce", [mesh, count] {
      SurfaceMesh reduced = *mesh;
      Warnings warnings;
      reduceVertices(reduced, count / 2, warnings);
      return bytesOf(reduced.triangles);
    });
    add("defects", [mesh] { return bytesOf(std::vector{findDefects(*mesh).unmatched_edges}); });
    add("smooth", [mesh] {
      std::vector<Lobe> lobes;
      for (const Vec3& p : mesh->positions) lobes.push_back({Vec3{0, -1, 0}, 1 + p.x * p.x});
      smoothLobes(lobes, *mesh, 2);
      return bytesOf(lobes);
    });
  }
}

// What limits a sweep: the slices of one axis, added along a diagonal direction as a sweep adds them, per byte that they touch; and copies
// of as much as a sweep's planes and of far more than the caches hold, per byte read or written.
void addSliceBenches(const BenchInput& input) {
  for (const size_t kibibytes : {320, 65536})
    addBench("copy/kibibytes:" + std::to_string(kibibytes), 2.0 * 1024 * double(kibibytes),
             [kibibytes, from = std::string(), to = std::string()]() mutable {
               if (from.empty()) from.assign(kibibytes << 10, 'x'), to.assign(kibibytes << 10, ' ');  // not before it runs
               std::memcpy(to.data(), from.data(), to.size());
               benchmark::ClobberMemory();
               return to.substr(to.size() / 2, 8);
             });
  for (const int count : {100, 200}) {
    const CoverageField field = *coverageFromMesh(input.mesh, frameFor(boundingBox(input.mesh), voxels(count)));
    const auto sliced = std::make_shared<SlicedFields>(slicedFields(field));
    const SlicedField& across = sliced->across[2];
    constexpr float kSlope = 0.5F;
    const auto [columns, rows, slices] = across.cells;
    const size_t reach = size_t(slices / 2) + 2, stride = (size_t(columns) + reach + 16) / 8 * 8,
                 plane = (size_t(rows) + reach + 4) * stride + 32;
    double filled = 0;
    for (const auto& [first, end] : across.spans) filled += std::max(end - first, 0);
    // The field is read once and the sum read and written where it is filled; the last slice is written everywhere, and the sum cleared.
    const double bytes = 4 * (3 * filled + double(columns) * rows * slices + double(plane));
    addBench("sweep/slices/voxels:" + std::to_string(count), bytes,
             [sliced, stride, plane, reach, planes = std::vector<float>(2 * plane),
              scratch = std::vector<float>(size_t(columns) + 32)]() mutable {
               std::fill(planes.begin(), planes.begin() + ptrdiff_t(plane), 0.0F);
               const SlicedField& slices_of = sliced->across[2];
               for (int slice = 0; slice < slices_of.cells[2]; ++slice) {
                 const float shift = kSlope * float(slice);
                 const SliceShift at{int(shift), int(shift), shift - std::floor(shift), shift - std::floor(shift)};
                 addSlice(slices_of.slice(slice), at, {planes.data() + reach * stride + reach, ptrdiff_t(plane), stride}, scratch);
               }
               return bytesOf(planes);
             });
  }
}

void addFitBench(const BenchInput& input) {
  const std::vector<Vec3> directions = fibonacciDirections(100);
  const std::vector<float> lengths = trueLengths(*input.exact, input.positions, directions, double(*input.settings.ray_length));
  Warnings warnings;
  const std::vector<Lobe> starts = bakeSphereRays(input.points(), input.dense, input.settings, warnings);
  FitSettings settings;
  const float extinction = 7 / boundingBox(input.mesh).longestSide();
  settings.extinctions = extinctionSteps(extinction / 2, extinction * 2);
  addBench("fit/vertex", double(starts.size()), [=] { return bytesOf(fitLobes(starts, {directions, lengths, {}}, settings)); });
}

// R of all vertices towards 100 lights at three σ.
void addVolumeTargetBenches(const BenchInput& input) {
  const auto field = std::make_shared<CoverageField>(*coverageFromMesh(input.mesh, frameFor(boundingBox(input.mesh), voxels(100))));
  const float extinction = 7 / boundingBox(input.mesh).longestSide();
  for (const auto& [name, light] :
       {std::pair("single", VolumeLight{}), std::pair("octaves:6", VolumeLight{1, {6}, 0}), std::pair("phase", VolumeLight{1, {}, 0.5F})}) {
    const VolumeTargetSettings settings{extinctionSteps(extinction / 2, extinction * 2), light, double(*input.settings.ray_length)};
    addBench(std::string("volume_target/") + name, double(input.mesh.positions.size()), [&input, field, settings] {
      return bytesOf(volumeTarget({input.mesh.positions, input.mesh.normals}, sweepAxes(100), *field, settings).radiance);
    });
  }
}

// Per chord; a chord of the plain port is `steps` + 1 samples.
void addBakeBenches(const BenchInput& input) {
  const double chords = double(input.positions.size()) * (input.settings.rays + 1), samples = chords * (input.settings.steps + 1);
  addBench("bake/sphere_rays/sample", samples, [&] {
    Warnings warnings;
    return bytesOf(bakeSphereRays(input.points(), input.dense, input.settings, warnings));
  });
  addBench("peer/plain/sample", samples, [&] {
    Warnings warnings;
    return bytesOf(plainSphereRays(input.points(), input.level_set, input.settings, warnings));
  });
  addBench("peer/hdda/chord", chords, [&] {
    Warnings warnings;
    return bytesOf(hddaSphereRays(input.points(), input.level_set, input.settings, warnings));
  });
  addBench("peer/embree/chord", chords, [&] {
    Warnings warnings;
    return bytesOf(referenceSphereRays(input.points(), *input.exact, input.settings, warnings));
  });
}

void addSmallBenches(const BenchInput& input) {
  constexpr int kRows = 1000;
  addBench("mean_direction/direction", 100.0 * kRows, [] {
    const std::vector<Vec3> directions = fibonacciDirections(100);
    std::vector<float> lengths(directions.size());
    std::vector<Vec3> means;
    for (int row = 0; row < kRows; ++row) {
      for (size_t i = 0; i < lengths.size(); ++i) lengths[i] = float((i * 7 + size_t(row)) % 13);
      means.push_back(meanDirection(directions, lengths).direction);
    }
    return bytesOf(means);
  });
  addBench("lobe_formula/light", double(input.positions.size()) * 512, [&] {
    const std::vector<Vec3> lights = fibonacciDirections(512);
    std::vector<float> transmittances;
    for (const Vec3& normal : input.normals)
      for (const Vec3& light : lights) transmittances.push_back(lobeTransmittance({-normal, 0.8F}, light, {3, -0.008F}, 2.5F));
    return bytesOf(transmittances);
  });
  for (const auto& [name, sampler] : {std::pair{"stratified", Sampler::kStratified}, std::pair{"fibonacci", Sampler::kFibonacci}})
    addBench(std::string("directions/") + name, 100.0 * kRows, [sampler = sampler] {
      BakeSettings settings;
      settings.sampler = sampler;
      const std::vector<Vec3> fibonacci = fibonacciDirections(settings.rays);
      std::vector<Vec3> directions(size_t(settings.rays) * kRows);
      for (size_t row = 0; row < kRows; ++row)
        sampleDirections(settings, fibonacci, row, std::span(directions).subspan(row * size_t(settings.rays), size_t(settings.rays)));
      return bytesOf(directions);
    });
}

// Expansions of ten million modules and more, the limit raised; the string's length and keys are what is hashed.
void addGrowthBenches() {
  struct Growth {
    const char *name, *premise;
    std::vector<const char*> rules;
    double generations;
    uint64_t modules;
  };
  for (const Growth& growth :
       {Growth{"doubling", "F", {"F=FF"}, 24, 16'777'216}, Growth{"plant", "X", {"X=F[+X]F[-X]+X", "F=FF"}, 13, 10'346'712},
        Growth{"parametric", "A(0)", {"A(i):i<30=A(i+1)B(i*2,rand())A(i+1)B(i)"}, 22, 12'582'910},
        Growth{"stochastic", "A", {"A=AB:0.5", "A=BA:0.5", "B=AA"}, 23.5, 16'777'216},
        Growth{"context", "AB", {"B<A=AA", "A=AB", "B=A"}, 29, 13'551'746}}) {
    CloudRecipe recipe;
    recipe.grammar.premise = {growth.premise, 1, 1};
    for (const char* rule : growth.rules) recipe.grammar.rules.push_back({rule, 1, 1});
    recipe.derive.generations = growth.generations;
    recipe.derive.max_modules = 30'000'000;
    addBench(std::string("derive/") + growth.name + "/modules:" + std::to_string(growth.modules), double(growth.modules),
             [recipe, expected = growth.modules] {
               Warnings quiet;
               const ModuleString string = derive(parseGrammar(recipe.grammar, quiet), recipe.derive, recipe.turtle, quiet);
               if (string.modules.size() != expected) throw std::logic_error(std::to_string(string.modules.size()) + " modules");
               uint64_t keys = 0;
               for (const Module& module : string.modules) keys = mix64(keys ^ module.key);
               return bytesOf(std::vector<uint64_t>{string.modules.size(), keys});
             });
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc > 2) {
    benchmark::ReportUnrecognizedArguments(argc, argv);
    return 1;
  }
  const BenchInput input = makeInput(argc > 1 ? argv[1] : nullptr);
  addFieldBenches(input);
  for (const int count : {35, 100}) addMeshToLevelSet(input, count);
  addSweepBenches(input);
  addEdgeBenches();
  addSliceBenches(input);
  addFitBench(input);
  addVolumeTargetBenches(input);
  addBakeBenches(input);
  addSmallBenches(input);
  addGrowthBenches();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
