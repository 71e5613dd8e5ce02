#include "pipeline/batch/thumbnail.h"

#include "bake/mesh/mesh_topology.h"
#include "io/file/write_file.h"
#include "io/gltf/gltf.h"
#include "io/image/image.h"
#include "pipeline/settings.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/render.h"

namespace cloudbake {

std::string thumbnailOf(const std::filesystem::path& asset) {
  Warnings told_at_the_bake;
  const BakedMesh mesh = decodeGlb(asset, readFileBytes(asset), told_at_the_bake);
  const PictureSettings view;
  const Camera camera = frameCamera(boundingBox(mesh.surface), view.camera_azimuth_degrees, view.camera_elevation_degrees,
                                    view.field_of_view_degrees, 240, 160);
  return encodePng(toneMap(renderLobe(mesh, camera, lightForSun(view.sun_azimuth_degrees, view.sun_elevation_degrees)), view.exposure));
}

}  // namespace cloudbake
