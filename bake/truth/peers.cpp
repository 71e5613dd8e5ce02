// Mean direction and density along it, m = Σᵢ ωᵢ ℓ(p, ωᵢ)², o = m/‖m‖, d = ℓ(p, o), with three ways to compute ℓ:
//  - a sample of the tree per step ("On Mesh Cloud Rendering", 2019-06-30);
//  - the zero crossings that OpenVDB's LevelSetHDDA finds (K. Museth, "Hierarchical Digital Differential Analyzer for Efficient
//    Ray-Marching in OpenVDB", SIGGRAPH Talks 2014), ℓ = Σ (leaving − entering);
//  - a reference's exact chords.
#include "bake/truth/peers.h"

#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/math/Stencils.h>
#include <openvdb/tools/Interpolation.h>

#include <atomic>

#include "bake/lobe/directions.h"
#include "bake/lobe/inside_length.h"
#include "core/level_set_type.h"
#include "core/parallel.h"
#include "core/random.h"

namespace cloudbake {

namespace {

constexpr size_t kPointsPerTask = 64;

// `make_length()` returns a function ℓ(ray) → float for a block of points. Rays and lengths are in index space.
template <class MakeLength>
std::vector<Lobe> bakeBy(const MakeLength& make_length, const BakePoints& points, const GridFrame& frame, const BakeSettings& settings,
                         Warnings& warnings) {
  const std::vector<Vec3> fibonacci = settings.sampler == Sampler::kFibonacci ? fibonacciDirections(settings.rays) : std::vector<Vec3>{};
  const double noise = concentrationNoise(settings.sampler, settings.rays);
  std::vector<Lobe> lobes(points.positions.size());
  std::atomic<uint64_t> undefined = 0;

  parallelBlocks(lobes.size(), kPointsPerTask, [&](size_t begin, size_t end) {
    auto length = make_length();
    std::vector<Vec3> directions(size_t(settings.rays));
    std::vector<float> lengths(directions.size());
    for (size_t v = begin; v < end; ++v) {
      const Vec3 origin = frame.toIndex(points.positions[v]);
      sampleDirections(settings, fibonacci, pointStream(settings.seed, origin), directions);
      for (size_t i = 0; i < directions.size(); ++i) lengths[i] = length(Ray{origin, directions[i]});

      MeanDirection mean = meanDirection(directions, lengths);
      if (!(mean.concentration >= noise)) {
        mean.direction = undefinedDirection(points, v);
        undefined.fetch_add(1, std::memory_order_relaxed);
      }
      lobes[v] = {mean.direction, float(length(Ray{origin, mean.direction}) * frame.voxel_size)};
    }
  });
  warnUndefined(undefined, warnings);
  return lobes;
}

// Trilinear φ at an index position, in voxels.
class TreeSampler {
 public:
  explicit TreeSampler(const LevelSet& level_set) : accessor_(level_set.grid->vdb->getConstAccessor()) {}
  float operator()(Vec3 p) const { return openvdb::tools::BoxSampler::sample(accessor_, openvdb::Vec3d(p.x, p.y, p.z)); }

 private:
  openvdb::FloatGrid::ConstAccessor accessor_;
};

// A tester for LevelSetHDDA, like tools::LinearSearchImpl, except that it continues after a crossing. It samples φ where the ray passes
// from voxel to voxel near the surface, and adds up the intervals between sign changes. Members that OpenVDB requires keep OpenVDB's names.
class CrossingTester {
 public:
  using RayT = openvdb::math::Ray<double>;

  explicit CrossingTester(const LevelSet& level_set) : stencil_(*level_set.grid->vdb) {
    level_set.grid->vdb->tree().root().evalActiveBoundingBox(box_, /*visit individual voxels*/ false);
  }

  double insideLength(const Ray& ray, double length) {
    ray_ = RayT({ray.origin.x, ray.origin.y, ray.origin.z}, {ray.direction.x, ray.direction.y, ray.direction.z});
    ray_.setTimes(ray_.t0(), std::max(length, 2 * ray_.t0()));
    if (box_.empty() || !ray_.clip(box_)) return 0;
    const double end = ray_.t1();
    inside_voxels_ = 0, entered_ = sample_time_ = ray_.t0();
    sample_ = phi(sample_time_);
    openvdb::math::LevelSetHDDA<openvdb::FloatTree, openvdb::FloatTree::RootNodeType::ChildNodeType::LEVEL>::test(*this);
    return inside_voxels_ + (sample_ < 0 ? end - entered_ : 0);
  }

  const RayT& ray() const { return ray_; }
  void setRange(double t0, double t1) { ray_.setTimes(t0, t1); }
  template <class Node>
  bool hasNode(const openvdb::Coord& voxel) {
    return stencil_.accessor().probeConstNode<Node>(voxel) != nullptr;
  }
  void init(double time) { voxel_time_ = time; }

  // Handles one voxel, from the time of the last call (or init) to `leave`. Its corner is within √3 voxels of any surface in it.
  bool operator()(const openvdb::Coord& voxel, double leave) {
    const double enter = voxel_time_;
    voxel_time_ = leave;
    float corner = 0;
    if (!stencil_.accessor().probeValue(voxel, corner) || std::fabs(corner) >= 2) return false;
    if (enter != sample_time_) takeSample(enter);
    takeSample(leave);
    return false;
  }

 private:
  float phi(double time) {
    const auto position = ray_(time);
    stencil_.moveTo(position);
    return stencil_.interpolation(openvdb::Vec3f(position));
  }

  void takeSample(double time) {
    const float before = sample_, after = phi(time);
    if ((before < 0) != (after < 0)) {
      const double crossing = sample_time_ + (time - sample_time_) * (double(before) / (double(before) - after));
      if (before < 0) inside_voxels_ += crossing - entered_;
      entered_ = crossing;
    }
    sample_ = after, sample_time_ = time;
  }

  openvdb::math::BoxStencil<openvdb::FloatGrid> stencil_;
  openvdb::CoordBBox box_;
  RayT ray_;
  double voxel_time_ = 0, sample_time_ = 0, entered_ = 0, inside_voxels_ = 0;
  float sample_ = 0;  // φ at sample_time_
};

}  // namespace

std::vector<Lobe> plainSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings) {
  const MarchSettings march{settings.quadrature, settings.steps, float(double(settings.ray_length.value()) / level_set.frame.voxel_size)};
  const auto make_length = [&] { return [&, sdf = TreeSampler(level_set)](const Ray& ray) { return insideLength(sdf, ray, march); }; };
  return bakeBy(make_length, points, level_set.frame, settings, warnings);
}

std::vector<Lobe> hddaSphereRays(const BakePoints& points, const LevelSet& level_set, const BakeSettings& settings, Warnings& warnings) {
  const double length_voxels = double(settings.ray_length.value()) / level_set.frame.voxel_size;
  const auto make_length = [&] {
    return [&, tester = CrossingTester(level_set)](const Ray& ray) mutable { return float(tester.insideLength(ray, length_voxels)); };
  };
  return bakeBy(make_length, points, level_set.frame, settings, warnings);
}

std::vector<Lobe> referenceSphereRays(const BakePoints& points, const Reference& reference, const BakeSettings& settings,
                                      Warnings& warnings) {
  const double ray_length = settings.ray_length.value();
  const auto make_length = [&] { return [&](const Ray& ray) { return float(reference.insideLength(ray, ray_length)); }; };
  return bakeBy(make_length, points, GridFrame{}, settings, warnings);
}

std::vector<float> hddaLengths(std::span<const Vec3> positions, std::span<const Vec3> directions, const LevelSet& level_set,
                               double ray_length) {
  const double voxel_size = level_set.frame.voxel_size;
  std::vector<float> lengths(positions.size() * directions.size());
  parallelBlocks(positions.size(), kPointsPerTask, [&](size_t begin, size_t end) {
    CrossingTester tester(level_set);
    for (size_t v = begin; v < end; ++v) {
      const Vec3 origin = level_set.frame.toIndex(positions[v]);
      for (size_t i = 0; i < directions.size(); ++i)
        lengths[v * directions.size() + i] = float(tester.insideLength({origin, directions[i]}, ray_length / voxel_size) * voxel_size);
    }
  });
  return lengths;
}

}  // namespace cloudbake
