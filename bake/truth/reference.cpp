// Chords of a closed oriented surface: along a ray the winding number falls by one where the ray leaves through a face that
// points along it (n·ω > 0), and rises by one where it enters. It is 0 beyond the last hit. So, counted from the far end by
//   w(before hit) = w(after hit) + sign(n·ω)
// the winding number of each interval is known even if the ray starts on the surface. RayScene finds all hits. Rays from one point go side
// by side.
#include "bake/truth/reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "bake/lobe/directions.h"
#include "bake/lobe/sphere_rays.h"
#include "bake/mesh/mesh_topology.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "core/ray_scene.h"

namespace cloudbake {

namespace {

// Positions are in the shape's frame, so that float arithmetic is the same for every size and place.
std::vector<Vec3> allInFrame(const std::vector<Vec3>& positions, Vec3 center, float size) {
  std::vector<Vec3> local;
  for (const Vec3& p : positions) local.push_back((p - center) / size);
  return local;
}

// Each triangle once. Whole shells may lie on one another, which changes nothing but the number of hits.
SurfaceMesh withoutDoubles(SurfaceMesh mesh) {
  for (Triangle& t : mesh.triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::vector<uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [&](uint32_t a, uint32_t b) { return std::pair(mesh.triangles[a], a) < std::pair(mesh.triangles[b], b); };
  parallelSort(order.begin(), order.end(), before);
  const auto same = [&](uint32_t a, uint32_t b) { return mesh.triangles[a] == mesh.triangles[b]; };
  order.erase(std::unique(order.begin(), order.end(), same), order.end());
  if (order.size() == mesh.triangles.size()) return mesh;
  std::sort(order.begin(), order.end());
  std::vector<Triangle> kept;
  for (const uint32_t triangle : order) kept.push_back(mesh.triangles[triangle]);
  mesh.triangles = std::move(kept);
  return mesh;
}

class MeshReference : public Reference {
 public:
  explicit MeshReference(const SurfaceMesh& mesh)
      : mesh_(withoutDoubles(weldedByPosition(mesh))),
        center_(boundingBox(mesh_).center()),
        size_(boundingBox(mesh_).longestSide()),
        scene_(allInFrame(mesh_.positions, center_, size_), mesh_.triangles) {}

  double insideLength(const Ray& ray, double length) const override {
    thread_local std::vector<RayHit> hits;
    hits.clear();
    scene_.forHits({inFrame(ray.origin), ray.direction}, [](const RayHit& hit) {
      if (hit.sign != 0) hits.push_back(hit);
    });
    return lengthInside(hits, length);
  }

  void insideLengths(Vec3 origin, std::span<const Vec3> directions, double length, std::span<float> lengths) const override {
    thread_local std::array<std::vector<RayHit>, kRaysTogether> hits;
    for (size_t first = 0; first < directions.size(); first += kRaysTogether) {
      const std::span<const Vec3> some = directions.subspan(first, std::min(kRaysTogether, directions.size() - first));
      for (std::vector<RayHit>& of_ray : hits) of_ray.clear();
      scene_.addHits(inFrame(origin), some, hits);
      for (size_t i = 0; i < some.size(); ++i) lengths[first + i] = float(lengthInside(hits[i], length));
    }
  }
  std::string name() const override { return RayScene::kName + std::string(", all hits"); }

 private:
  Vec3 inFrame(Vec3 world) const { return (world - center_) / size_; }

  // From the hits of one ray, which it sorts.
  double lengthInside(std::vector<RayHit>& hits, double length) const {
    std::sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) { return a.t != b.t ? a.t < b.t : a.sign < b.sign; });
    dropRepeats(hits);
    const double end = length / size_;
    double inside = 0;
    int winding = 0;
    for (size_t i = hits.size(); i-- > 0;) {
      winding += hits[i].sign;
      const double from = i > 0 ? hits[i - 1].t : 0.0;
      if (winding != 0) inside += std::max(0.0, std::min(double(hits[i].t), end) - from);
    }
    return inside * size_;
  }

  // A ray through an edge or a corner may hit several of its triangles. These hits are one crossing, recognised by place, sense and a
  // shared corner. Where the ray starts, they enclose nothing.
  void dropRepeats(std::vector<RayHit>& hits) const {
    size_t kept = 0;
    for (size_t i = 0; i < hits.size(); ++i) {
      bool repeated = false;
      for (size_t j = kept; j-- > 0 && hits[i].t > 1e-5F && hits[i].t - hits[j].t <= 4e-7F && !repeated;)
        repeated = hits[i].sign == hits[j].sign && shareCorner(hits[i].triangle, hits[j].triangle);
      if (!repeated) hits[kept++] = hits[i];
    }
    hits.resize(kept);
  }
  bool shareCorner(uint32_t a, uint32_t b) const {
    for (const uint32_t v : mesh_.triangles[a])
      for (const uint32_t w : mesh_.triangles[b])
        if (v == w) return true;
    return false;
  }

  SurfaceMesh mesh_;
  Vec3 center_;
  float size_;
  RayScene scene_;
};

class SphereReference : public Reference {
 public:
  explicit SphereReference(std::span<const Sphere> spheres) : spheres_(spheres.begin(), spheres.end()) {}

  double insideLength(const Ray& ray, double length) const override {
    // |o + tω − c|² = r²  →  t = b ± √(b² − |o − c|² + r²), b = (c − o)·ω, computed by the distance of the line from c.
    thread_local std::vector<std::pair<double, double>> intervals;
    intervals.clear();
    for (const Sphere& s : spheres_) {
      const double x = double(s.center.x) - ray.origin.x, y = double(s.center.y) - ray.origin.y, z = double(s.center.z) - ray.origin.z;
      const double dx = ray.direction.x, dy = ray.direction.y, dz = ray.direction.z, scale = dx * dx + dy * dy + dz * dz;
      const double b = (x * dx + y * dy + z * dz) / scale;
      const double ex = x - b * dx, ey = y - b * dy, ez = z - b * dz;
      const double half = (double(s.radius) * s.radius - (ex * ex + ey * ey + ez * ez)) / scale;
      if (half <= 0) continue;
      const double from = std::max(0.0, b - std::sqrt(half)), to = std::min(length, b + std::sqrt(half));
      if (to > from) intervals.emplace_back(from, to);
    }
    std::sort(intervals.begin(), intervals.end());
    double inside = 0, covered = 0;
    for (const auto& [from, to] : intervals) {
      inside += std::max(0.0, to - std::max(from, covered));
      covered = std::max(covered, to);
    }
    return inside;
  }
  std::string name() const override { return "union of sphere intervals"; }

 private:
  std::vector<Sphere> spheres_;
};

class MarchReference : public Reference {
 public:
  explicit MarchReference(DenseField field) : field_(std::move(field)) {}

  double insideLength(const Ray& ray, double length) const override {
    constexpr double kStepsPerVoxel = 10;
    BakeSettings settings;
    settings.ray_length = float(length);
    settings.steps = std::max(1, int(std::ceil(kStepsPerVoxel * length / field_.frame.voxel_size)));
    return marchedLengths({&ray.origin, 1}, {&ray.direction, 1}, field_, settings).front();
  }
  std::string name() const override { return "march of the level set at a tenth of a voxel"; }

 private:
  DenseField field_;
};

}  // namespace

std::unique_ptr<Reference> marchReference(DenseField field) { return std::make_unique<MarchReference>(std::move(field)); }

std::unique_ptr<Reference> meshReference(const SurfaceMesh& mesh) { return std::make_unique<MeshReference>(mesh); }

std::unique_ptr<Reference> sphereReference(std::span<const Sphere> spheres) { return std::make_unique<SphereReference>(spheres); }

void Reference::insideLengths(Vec3 origin, std::span<const Vec3> directions, double length, std::span<float> lengths) const {
  for (size_t i = 0; i < directions.size(); ++i) lengths[i] = float(insideLength({origin, directions[i]}, length));
}

namespace {

class CoherentDirections {
 public:
  explicit CoherentDirections(std::span<const Vec3> directions) : order_(coherentOrder(directions)) {
    for (const size_t i : order_) directions_.push_back(directions[i]);
  }

  /// lengths[i] is that along the i-th of the given directions.
  void insideLengths(const Reference& reference, Vec3 origin, double length, std::span<float> lengths) const {
    thread_local std::vector<float> in_order;
    in_order.resize(directions_.size());
    reference.insideLengths(origin, directions_, length, in_order);
    for (size_t i = 0; i < order_.size(); ++i) lengths[order_[i]] = in_order[i];
  }

 private:
  std::vector<size_t> order_;
  std::vector<Vec3> directions_{};
};

}  // namespace

Truth trueLobes(const Reference& reference, std::span<const Vec3> positions, std::span<const Vec3> directions, double ray_length) {
  Truth truth{std::vector<Lobe>(positions.size()), std::vector<double>(positions.size())};
  const CoherentDirections coherent(directions);
  const LoopProgress::Counted counted;
  parallelBlocks(positions.size(), 16, [&](size_t begin, size_t end) {
    std::vector<float> lengths(directions.size());
    for (size_t v = begin; v < end; ++v) {
      coherent.insideLengths(reference, positions[v], ray_length, lengths);
      const MeanDirection mean = meanDirection(directions, lengths);
      truth.concentration[v] = mean.concentration;
      truth.lobes[v] = {mean.direction,
                        mean.concentration > 0 ? float(reference.insideLength({positions[v], mean.direction}, ray_length)) : 0.0F};
    }
  });
  return truth;
}

std::vector<float> trueLengths(const Reference& reference, std::span<const Vec3> positions, std::span<const Vec3> directions,
                               double ray_length) {
  const CoherentDirections coherent(directions);
  std::vector<float> lengths(positions.size() * directions.size());
  const LoopProgress::Counted counted;
  parallelBlocks(positions.size(), 16, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v)
      coherent.insideLengths(reference, positions[v], ray_length, std::span(lengths).subspan(v * directions.size(), directions.size()));
  });
  return lengths;
}

}  // namespace cloudbake
