// Chords of a closed oriented surface: along a ray the winding number falls by one where the ray leaves through a face that
// points along it (n·ω > 0), and rises by one where it enters. It is 0 beyond the last hit. So, counted from the far end by
//   w(before hit) = w(after hit) + sign(n·ω)
// the winding number of each interval is known even if the ray starts on the surface. Intel Embree 3 finds all hits: an intersection
// filter records each hit and rejects it, so the traversal continues (Embree API reference, "Filter functions"). Rays from one point go
// side by side in packets.
#include "bake/truth/reference.h"

#include <embree3/rtcore.h>

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

struct Hit {
  float t;
  int32_t sign;  // sign of n·ω; +1 leaves the solid
  uint32_t triangle;
};

constexpr int kPacket = 8;  // rays; with 4 or 16 they take longer

struct HitContext {
  RTCIntersectContext embree;  // must be the first member: Embree passes its address to the filter
  std::array<std::vector<Hit>, kPacket>* hits;
};

void recordHits(const RTCFilterFunctionNArguments* args) {
  auto* context = reinterpret_cast<HitContext*>(args->context);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const float facing = RTCHitN_Ng_x(args->hit, args->N, i) * RTCRayN_dir_x(args->ray, args->N, i) +
                         RTCHitN_Ng_y(args->hit, args->N, i) * RTCRayN_dir_y(args->ray, args->N, i) +
                         RTCHitN_Ng_z(args->hit, args->N, i) * RTCRayN_dir_z(args->ray, args->N, i);
    if (facing != 0)
      (*context->hits)[RTCRayN_id(args->ray, args->N, i)].push_back(
          {RTCRayN_tfar(args->ray, args->N, i), facing > 0 ? 1 : -1, RTCHitN_primID(args->hit, args->N, i)});
    args->valid[i] = 0;
  }
}

// Positions are in the shape's frame, so that Embree's float arithmetic is the same for every size and place.
std::vector<Vec3> inFrame(const std::vector<Vec3>& positions, Vec3 center, float size) {
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
        scene_(inFrame(mesh_.positions, center_, size_), mesh_.triangles) {}

  double insideLength(const Ray& ray, double length) const override {
    thread_local std::array<std::vector<Hit>, kPacket> hits;
    hits[0].clear();
    HitContext context = contextFor(hits);
    const Vec3 o = (ray.origin - center_) / size_;
    RTCRayHit query{};
    query.ray = {o.x, o.y, o.z, 0, ray.direction.x, ray.direction.y, ray.direction.z, 0, INFINITY, 0xffffffffU, 0, 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.handle(), &context.embree, &query);
    return lengthInside(hits[0], length);
  }

  void insideLengths(Vec3 origin, std::span<const Vec3> directions, double length, std::span<float> lengths) const override {
    thread_local std::array<std::vector<Hit>, kPacket> hits;
    for (size_t first = 0; first < directions.size(); first += kPacket) {
      const std::span<const Vec3> some = directions.subspan(first, std::min<size_t>(kPacket, directions.size() - first));
      findHits(origin, some, hits);
      for (size_t i = 0; i < some.size(); ++i) lengths[first + i] = float(lengthInside(hits[i], length));
    }
  }
  std::string name() const override { return "Embree, all hits"; }

 private:
  static HitContext contextFor(std::array<std::vector<Hit>, kPacket>& hits) {
    HitContext context{};
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = recordHits;
    context.hits = &hits;
    return context;
  }

  void findHits(Vec3 origin, std::span<const Vec3> directions, std::array<std::vector<Hit>, kPacket>& hits) const {
    HitContext context = contextFor(hits);
    context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const Vec3 o = (origin - center_) / size_;
    alignas(32) std::array<int, kPacket> valid{};
    RTCRayHit8 query{};
    for (size_t i = 0; i < directions.size(); ++i) {
      hits[i].clear();
      valid[i] = -1;
      query.ray.org_x[i] = o.x, query.ray.org_y[i] = o.y, query.ray.org_z[i] = o.z;
      query.ray.dir_x[i] = directions[i].x, query.ray.dir_y[i] = directions[i].y, query.ray.dir_z[i] = directions[i].z;
      query.ray.tfar[i] = INFINITY;
      query.ray.mask[i] = 0xffffffffU;
      query.ray.id[i] = unsigned(i);
      query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), scene_.handle(), &context.embree, &query);
  }

  // From the hits of one ray, which it sorts.
  double lengthInside(std::vector<Hit>& hits, double length) const {
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.t != b.t ? a.t < b.t : a.sign < b.sign; });
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
  void dropRepeats(std::vector<Hit>& hits) const {
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
