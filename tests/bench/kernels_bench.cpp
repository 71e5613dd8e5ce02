// Seconds of each kernel on one and on two threads, with a hash of what it computed: the same for any number of threads, or the bench
// fails. A kernel is one call of addBench with its name, how many items one run treats, and a function that returns its result's bytes.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cstring>
#include <functional>

#include "bake/dense_field.h"
#include "bake/directions.h"
#include "bake/level_set.h"
#include "bake/mesh_topology.h"
#include "bake/peers.h"
#include "bake/reference.h"
#include "bake/sphere_rays.h"
#include "bake/winding.h"
#include "core/level_set_type.h"
#include "core/lobe_lighting.h"
#include "io/write_file.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

/// What the kernels work on.
struct BenchInput {
  SurfaceMesh torus = torusMesh(1, 0.4F, 256, 128);  // 65,536 triangles
  std::vector<Sphere> spheres;
  LevelSet level_set;  // of the torus, 100 voxels
  DenseField dense;
  std::unique_ptr<Reference> exact;
  std::vector<Vec3> positions, normals;  // 256 vertices of the torus
  BakeSettings settings;                 // N = 100, S = 100
  BakePoints points() const { return {positions, normals}; }
};

BenchInput makeInput() {
  BenchInput input;
  const std::vector<Vec3> centers = fibonacciDirections(60);
  for (size_t i = 0; i < centers.size(); ++i) input.spheres.push_back({centers[i], 0.3F + 0.3F * float(i % 7) / 7});
  Warnings warnings;
  input.level_set = levelSetFromMesh(input.torus, {}, warnings);
  input.dense = denseFromLevelSet(input.level_set);
  input.exact = meshReference(input.torus);
  for (size_t v = 0; v < input.torus.positions.size(); v += input.torus.positions.size() / 256)
    input.positions.push_back(input.torus.positions[v]), input.normals.push_back(input.torus.normals[v]);
  input.settings.ray_length = boundingBox(input.torus).diagonal();
  return input;
}

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
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
  addBench("level_set/mesh", double(input.torus.triangles.size()), [&] {
    Warnings warnings;
    return bytesOf(levelSetFromMesh(input.torus, {}, warnings));
  });
  addBench("level_set/spheres", double(input.spheres.size()), [&] {
    Warnings warnings;
    return bytesOf(levelSetFromSpheres(input.spheres, {}, warnings));
  });
  addBench("dense_field", double(input.dense.values.size()), [&] { return bytesOf(denseFromLevelSet(input.level_set).values); });
  addBench("winding_columns", double(input.torus.triangles.size()), [&] {
    std::vector<Vec3> positions;
    for (const Vec3& p : input.torus.positions) positions.push_back(input.level_set.frame.toIndex(p));
    std::vector<float> heights;
    for (const auto& crossing : windingColumns(latticePoints(positions), input.torus.triangles).crossings) heights.push_back(crossing.z);
    return bytesOf(heights);
  });
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
    return bytesOf(embreeSphereRays(input.points(), *input.exact, input.settings, warnings));
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

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  const BenchInput input = makeInput();
  addFieldBenches(input);
  addBakeBenches(input);
  addSmallBenches(input);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
