// The only file that knows Embree. An intersection filter reports each hit and rejects it, so that the traversal continues to the next one
// (Embree API reference, "Filter functions"). The scene is in Embree's robust mode, so that no ray slips through an edge.
// start_threads=0: an Embree device that is created with a number of threads would limit TBB in the whole process.
#include "core/ray_scene.h"

#ifdef CLOUDBAKE_PORTABLE

#include "core/triangle_tree.h"

namespace cloudbake {

struct RayScene::Scene {
  TriangleTree tree;
};

RayScene::RayScene(std::span<const Vec3> positions, std::span<const Triangle> triangles, RaysToCome /*rays*/)
    : scene_(new Scene{TriangleTree(positions, triangles)}) {}
RayScene::~RayScene() = default;

void RayScene::forHits(const Ray& ray, HitVisit visit) const { scene_->tree.forHits(ray, visit); }
void RayScene::addHits(Vec3 origin, std::span<const Vec3> directions, std::span<std::vector<RayHit>> hits) const {
  scene_->tree.addHits(origin, directions, hits);
}
void RayScene::forTrianglesNear(Vec3 point, NearVisit visit) const { scene_->tree.forTrianglesNear(point, visit); }

}  // namespace cloudbake

#else

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <stdexcept>

namespace cloudbake {

namespace {

struct Release {
  void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
  void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
};

// The context of a query. Embree passes its address to the filter.
template <typename Receiver>
struct AllHits {
  RTCIntersectContext embree;  // must be the first member
  Receiver receive;            // (ray, hit)
};

template <typename Receiver>
AllHits<Receiver> allHits(const Receiver& receive) {
  AllHits<Receiver> context{{}, receive};
  rtcInitIntersectContext(&context.embree);
  context.embree.filter = [](const RTCFilterFunctionNArguments* args) {
    const auto* hits = reinterpret_cast<const AllHits<Receiver>*>(args->context);
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] != -1) continue;
      const float facing = RTCHitN_Ng_x(args->hit, args->N, i) * RTCRayN_dir_x(args->ray, args->N, i) +
                           RTCHitN_Ng_y(args->hit, args->N, i) * RTCRayN_dir_y(args->ray, args->N, i) +
                           RTCHitN_Ng_z(args->hit, args->N, i) * RTCRayN_dir_z(args->ray, args->N, i);
      hits->receive(RTCRayN_id(args->ray, args->N, i),
                    RayHit{RTCRayN_tfar(args->ray, args->N, i), int(facing > 0) - int(facing < 0), RTCHitN_primID(args->hit, args->N, i)});
      args->valid[i] = 0;
    }
  };
  return context;
}

bool lookAtTriangle(RTCPointQueryFunctionArguments* args) {
  const float radius = (*static_cast<const NearVisit*>(args->userPtr))(args->primID, args->query->radius);
  if (radius == args->query->radius) return false;
  args->query->radius = radius;
  return true;
}

}  // namespace

struct RayScene::Scene {
  std::unique_ptr<RTCDeviceTy, Release> device{rtcNewDevice("start_threads=0")};
  std::unique_ptr<RTCSceneTy, Release> triangles{};
};

RayScene::RayScene(std::span<const Vec3> positions, std::span<const Triangle> triangles, RaysToCome rays) {
  auto scene = std::make_unique<Scene>();
  if (!scene->device) throw std::runtime_error("Embree cannot start on this machine");
  scene->triangles.reset(rtcNewScene(scene->device.get()));
  const RTCBuildQuality quality = rays == RaysToCome::kFew ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
  rtcSetSceneBuildQuality(scene->triangles.get(), quality);
  rtcSetSceneFlags(scene->triangles.get(), RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  const RTCGeometry geometry = rtcNewGeometry(scene->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), positions.size()));
  auto* indices = static_cast<uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangles.size()));
  if (!corners || !indices) {
    rtcReleaseGeometry(geometry);
    throw std::bad_alloc();
  }
  for (const Vec3& p : positions) corners = std::copy_n(&p.x, 3, corners);
  for (const Triangle& triangle : triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene->triangles.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene->triangles.get());
  scene_ = std::move(scene);
}
RayScene::~RayScene() = default;

void RayScene::forHits(const Ray& ray, HitVisit visit) const {
  auto context = allHits([&](unsigned /*ray*/, const RayHit& hit) { visit(hit); });
  const auto& [o, d] = ray;
  RTCRayHit query{};
  query.ray = {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, INFINITY, 0xffffffffU, 0, 0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_->triangles.get(), &context.embree, &query);
}

void RayScene::addHits(Vec3 origin, std::span<const Vec3> directions, std::span<std::vector<RayHit>> hits) const {
  static_assert(kRaysTogether == 8);
  if (directions.size() > std::min(kRaysTogether, hits.size())) throw std::invalid_argument("RayScene::addHits: too many rays");
  auto context = allHits([of_ray = hits.data()](unsigned ray, const RayHit& hit) {
    if (hit.sign != 0) of_ray[ray].push_back(hit);
  });
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, kRaysTogether> valid{};
  RTCRayHit8 query{};
  for (size_t i = 0; i < directions.size(); ++i) {
    valid[i] = -1;
    query.ray.org_x[i] = origin.x, query.ray.org_y[i] = origin.y, query.ray.org_z[i] = origin.z;
    query.ray.dir_x[i] = directions[i].x, query.ray.dir_y[i] = directions[i].y, query.ray.dir_z[i] = directions[i].z;
    query.ray.tfar[i] = INFINITY;
    query.ray.mask[i] = 0xffffffffU;
    query.ray.id[i] = unsigned(i);
    query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect8(valid.data(), scene_->triangles.get(), &context.embree, &query);
}

void RayScene::forTrianglesNear(Vec3 point, NearVisit visit) const {
  RTCPointQuery query{point.x, point.y, point.z, 0, INFINITY};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_->triangles.get(), &query, &context, lookAtTriangle, &visit);
}

}  // namespace cloudbake

#endif
