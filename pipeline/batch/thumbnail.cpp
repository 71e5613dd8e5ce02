#include "pipeline/batch/thumbnail.h"

#include "bake/mesh/mesh_topology.h"
#include "core/sequence.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/sequence/sequence_file.h"
#include "io/image/image.h"
#include "io/report/batch_report.h"
#include "pipeline/options/resolve.h"
#include "pipeline/page/live_page.h"
#include "pipeline/picture/picture.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

namespace {

// What a sequence shows halfway through.
BakedMesh meshInTheMiddle(const CloudSequence& sequence) {
  const double seconds = sequence.period / 2 / sequence.frames_per_second;
  return meshAt(sequence, seenAt(sequence, seconds).back());
}

}  // namespace

Image drawThumbnail(const std::filesystem::path& asset, uint64_t memory_limit) {
  ReadSettings read;
  read.memory_limit = memory_limit;
  Warnings told_at_the_bake;
  const std::string bytes = readFileBytes(asset);
  const BakedMesh mesh =
      isSequence(bytes) ? meshInTheMiddle(decodeSequence(asset, bytes, memory_limit)) : decodeGlb(asset, bytes, told_at_the_bake, read);
  const PictureSettings view;
  const Camera camera = frameCamera(boundingBox(mesh.surface), kPlainView.camera_azimuth, kPlainView.camera_elevation,
                                    view.field_of_view_degrees, kThumbnailWidth, kThumbnailHeight);
  LightSettings light = lightForSun(kPlainView.sun_azimuth, kPlainView.sun_elevation);
  light.samples_per_side = 1;  // the page shows the picture smaller than it is
  light.rays = RaysToCome::kFew;
  return toneMap(renderLobe(mesh, camera, light), view.exposure);
}

std::string thumbnailOf(const std::filesystem::path& asset, uint64_t memory_limit) {
  constexpr int kQuality = 70;
  return encodeJpeg(drawThumbnail(asset, memory_limit), kQuality);
}

std::string liveViewOf(const std::filesystem::path& asset, uint64_t memory_limit) {
  SourceSettings from;
  from.input = asset;
  from.memory_limit = memory_limit;
  const Given plain[] = {{findOption("look", kView), "plain", "", 0, 0}};
  BakeReport told_at_the_bake;
  const LiveScene scene = liveScene(readScenery(resolve(from, plain), plain, told_at_the_bake), asset.stem().string());
  return livePage({&scene, 1});
}

}  // namespace cloudbake
