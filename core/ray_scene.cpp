// start_threads=0: an Embree device that is created with a number of threads would limit TBB in the whole process.
#include "core/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <new>
#include <stdexcept>

namespace cloudbake {

void RayScene::Release::operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
void RayScene::Release::operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }

RayScene::RayScene(std::span<const Vec3> positions, std::span<const Triangle> triangles, RaysToCome rays)
    : device_(rtcNewDevice("start_threads=0")) {
  if (!device_) throw std::runtime_error("Embree cannot start on this machine");
  scene_.reset(rtcNewScene(device_.get()));
  const RTCBuildQuality quality = rays == RaysToCome::kFew ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
  rtcSetSceneBuildQuality(scene_.get(), quality);
  rtcSetSceneFlags(scene_.get(), RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
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
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_.get());
}

}  // namespace cloudbake
