// Source: "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves: from each vertex N rays over the sphere, each weighted
// by the square of the cloud that it meets,
//   m = Σᵢ ωᵢ ℓ(p, ωᵢ)²,   o = m/‖m‖,   d = ℓ(p, o).
#include "bake/lobe/sphere_rays.h"

#include <atomic>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/lobe/march_kernels.h"
#include "core/parallel.h"
#include "core/random.h"

namespace cloudbake {

namespace {

constexpr size_t kPointsPerTask = 64, kLanes = 8;

// Rays of a task, padded to a multiple of 8 by repeating the last.
class RayBuffer {
 public:
  explicit RayBuffer(size_t most) {
    for (auto& array : arrays_) array.resize((most + kLanes - 1) / kLanes * kLanes);
    lengths_.resize(arrays_[0].size());
  }
  void clear() { count_ = 0; }
  void add(Vec3 origin, Vec3 direction) {
    const float values[] = {origin.x, origin.y, origin.z, direction.x, direction.y, direction.z};
    for (size_t n = 0; n < arrays_.size(); ++n) arrays_[n][count_] = values[n];
    ++count_;
  }
  // Inside lengths in voxels, one per ray.
  std::span<const float> march(const DenseField& field, const MarchSettings& settings) {
    const size_t padded = (count_ + kLanes - 1) / kLanes * kLanes;
    for (auto& array : arrays_) std::fill(array.begin() + ptrdiff_t(count_), array.begin() + ptrdiff_t(padded), array[count_ - 1]);
    const auto& a = arrays_;
    marchRays(field, {{a[0].data(), a[1].data(), a[2].data()}, {a[3].data(), a[4].data(), a[5].data()}, padded}, settings, lengths_.data());
    return std::span(lengths_).first(count_);
  }

 private:
  std::array<std::vector<float>, 6> arrays_;
  std::vector<float> lengths_;
  size_t count_ = 0;
};

MarchSettings marchSettings(const BakeSettings& settings, const GridFrame& frame) {
  return {settings.quadrature, settings.steps, float(double(settings.ray_length.value()) / frame.voxel_size)};
}

// An index position on the field's lattice.
Vec3 onLattice(Vec3 index, const DenseField& field) {
  return index - Vec3{float(field.first[0]), float(field.first[1]), float(field.first[2])};
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

std::vector<Lobe> bakeSphereRays(const BakePoints& points, const DenseField& field, const BakeSettings& settings, Warnings& warnings) {
  const MarchSettings march = marchSettings(settings, field.frame);
  const std::vector<Vec3> fibonacci = settings.sampler == Sampler::kFibonacci ? fibonacciDirections(settings.rays) : std::vector<Vec3>{};
  const double noise = concentrationNoise(settings.sampler, settings.rays);
  std::vector<Lobe> lobes(points.positions.size());
  std::atomic<uint64_t> undefined = 0;

  // The rays of eight neighbouring points through the same stratum form a vector, because they have about the same length.
  const auto rays = size_t(settings.rays);
  const LoopProgress::Counted counted;
  parallelBlocks(lobes.size(), kPointsPerTask, [&](size_t begin, size_t end) {
    RayBuffer spheres(kLanes * rays), means(kLanes);
    std::vector<Vec3> directions(kLanes * rays);
    std::vector<float> lengths(rays);
    for (size_t first = begin; first < end; first += kLanes) {
      std::array<Vec3, kLanes> origins;
      for (size_t n = 0; n < kLanes; ++n) {
        const Vec3 index = field.frame.toIndex(points.positions[std::min(first + n, end - 1)]);
        origins[n] = onLattice(index, field);
        sampleDirections(settings, fibonacci, pointStream(settings.seed, index), std::span(directions).subspan(n * rays, rays));
      }
      spheres.clear();
      for (size_t i = 0; i < rays; ++i)
        for (size_t n = 0; n < kLanes; ++n) spheres.add(origins[n], directions[n * rays + i]);
      const std::span<const float> all_lengths = spheres.march(field, march);

      means.clear();
      const size_t count = std::min(kLanes, end - first);
      for (size_t n = 0; n < count; ++n) {
        for (size_t i = 0; i < rays; ++i) lengths[i] = all_lengths[i * kLanes + n];
        MeanDirection mean = meanDirection(std::span(directions).subspan(n * rays, rays), lengths);
        if (!(mean.concentration >= noise)) {
          mean.direction = undefinedDirection(points, first + n);
          undefined.fetch_add(1, std::memory_order_relaxed);
        }
        lobes[first + n].direction = mean.direction;
        means.add(origins[n], mean.direction);
      }
      const std::span<const float> densities_voxels = means.march(field, march);
      for (size_t n = 0; n < count; ++n) lobes[first + n].thickness = float(densities_voxels[n] * field.frame.voxel_size);
    }
  });
  warnUndefined(undefined, warnings);
  return lobes;
}

std::vector<float> marchedLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const DenseField& field,
                                  const BakeSettings& settings) {
  const MarchSettings march = marchSettings(settings, field.frame);
  std::vector<float> lengths(positions.size() * directions.size());
  const LoopProgress::Counted counted;
  parallelBlocks(positions.size(), kPointsPerTask, [&](size_t begin, size_t end) {
    RayBuffer rays(directions.size());
    for (size_t v = begin; v < end; ++v) {
      const Vec3 origin = onLattice(field.frame.toIndex(positions[v]), field);
      rays.clear();
      for (const Vec3& direction : directions) rays.add(origin, direction);
      const std::span<const float> voxels = rays.march(field, march);
      for (size_t i = 0; i < voxels.size(); ++i) lengths[v * voxels.size() + i] = float(voxels[i] * field.frame.voxel_size);
    }
  });
  return lengths;
}

}  // namespace cloudbake
