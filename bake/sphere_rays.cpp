// Source: "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves: from each vertex N rays over the sphere, each weighted
// by the square of the cloud that it meets,
//   m = Σᵢ ωᵢ ℓ(p, ωᵢ)²,   o = m/‖m‖,   d = ℓ(p, o).
#include "bake/sphere_rays.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>

#include "bake/directions.h"
#include "bake/inside_length.h"
#include "core/level_set_type.h"
#include "core/random.h"

namespace cloudbake {

namespace {

constexpr size_t kPointsPerTask = 64;

// The one function through which a bake reads the level set: trilinear φ at an index position, in voxels.
class LevelSetSampler {
 public:
  explicit LevelSetSampler(const LevelSet& level_set) : accessor_(level_set.grid->vdb->getConstAccessor()) {}
  float operator()(Vec3 p) const { return openvdb::tools::BoxSampler::sample(accessor_, openvdb::Vec3d(p.x, p.y, p.z)); }

 private:
  openvdb::FloatGrid::ConstAccessor accessor_;
};

MarchSettings marchSettings(const BakeSettings& settings, const GridFrame& frame) {
  return {settings.quadrature, settings.steps, float(double(settings.ray_length.value()) / frame.voxel_size)};
}

void fillDirections(const BakeSettings& settings, std::span<const Vec3> fibonacci, uint64_t stream, std::span<Vec3> out) {
  switch (settings.sampler) {
    case Sampler::kStratified: return stratifiedDirections(stream, out);
    case Sampler::kUniform: return uniformDirections(stream, out);
    case Sampler::kFibonacci:
      if (settings.rotate_directions) return rotatedDirections(fibonacci, stream, out);
      std::copy(fibonacci.begin(), fibonacci.end(), out.begin());
  }
}

template <class Body>
void forBlocks(size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, kPointsPerTask),
                    [&](const tbb::blocked_range<size_t>& range) { body(range.begin(), range.end()); });
}

}  // namespace

MeanDirection meanDirection(std::span<const Vec3> directions, std::span<const float> lengths) {
  double x = 0, y = 0, z = 0, sum = 0;
  for (size_t i = 0; i < directions.size(); ++i) {
    const double weight = double(lengths[i]) * lengths[i];
    x += weight * directions[i].x, y += weight * directions[i].y, z += weight * directions[i].z, sum += weight;
  }
  const double norm = std::sqrt(x * x + y * y + z * z);
  if (!(sum > 0) || !(norm > 0)) return {};
  return {{float(x / norm), float(y / norm), float(z / norm)}, norm / sum};
}

void warnUndefined(uint64_t count, Warnings& warnings) {
  warnings.add(WarningKind::kUndefinedDirection, "no mean occlusion direction (no cloud around, or as much on every side): −normal was stored",
               count);
}

std::vector<Lobe> bakeSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings) {
  const MarchSettings march = marchSettings(settings, level_set.frame);
  const std::vector<Vec3> fibonacci = settings.sampler == Sampler::kFibonacci ? fibonacciDirections(settings.rays) : std::vector<Vec3>{};
  const double noise = concentrationNoise(settings.sampler, settings.rays);
  std::vector<Lobe> lobes(points.positions.size());
  std::atomic<uint64_t> undefined = 0;

  forBlocks(lobes.size(), [&](size_t begin, size_t end) {
    const LevelSetSampler sdf(level_set);
    std::vector<Vec3> directions(size_t(settings.rays));
    std::vector<float> lengths(directions.size());
    for (size_t v = begin; v < end; ++v) {
      const Vec3 origin = level_set.frame.toIndex(points.positions[v]);
      fillDirections(settings, fibonacci, pointStream(settings.seed, origin), directions);
      for (size_t i = 0; i < directions.size(); ++i) lengths[i] = insideLength(sdf, {origin, directions[i]}, march);

      MeanDirection mean = meanDirection(directions, lengths);
      if (!(mean.concentration >= noise)) {
        mean.direction = points.normals.empty() ? Vec3{0, -1, 0} : -points.normals[v];
        undefined.fetch_add(1, std::memory_order_relaxed);
      }
      const float density_voxels = insideLength(sdf, {origin, mean.direction}, march);
      lobes[v] = {mean.direction, float(density_voxels * level_set.frame.voxel_size)};
    }
  });
  warnUndefined(undefined, warnings);
  return lobes;
}

std::vector<float> marchedLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const LevelSet& level_set,
                                  const BakeSettings& settings) {
  const MarchSettings march = marchSettings(settings, level_set.frame);
  std::vector<float> lengths(positions.size() * directions.size());
  forBlocks(positions.size(), [&](size_t begin, size_t end) {
    const LevelSetSampler sdf(level_set);
    for (size_t v = begin; v < end; ++v) {
      const Vec3 origin = level_set.frame.toIndex(positions[v]);
      for (size_t i = 0; i < directions.size(); ++i)
        lengths[v * directions.size() + i] = float(insideLength(sdf, {origin, directions[i]}, march) * level_set.frame.voxel_size);
    }
  });
  return lengths;
}

}  // namespace cloudbake
