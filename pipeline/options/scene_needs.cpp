#include "pipeline/options/scene_needs.h"

#include <algorithm>
#include <cmath>

#include "bake/mesh/mesh_topology.h"
#include "core/portable_math.h"
#include "preview/camera.h"

namespace cloudbake {

double pixelSize(const SceneNeeds& scene, const Box& box) {
  const PictureSettings& view = scene.view;
  const auto framed = [&] {
    const Camera camera =
        frameCamera(box, view.camera_azimuth_degrees, view.camera_elevation_degrees, view.field_of_view_degrees, view.width, view.height);
    return double(length(camera.look_from - camera.look_at));
  };
  const double distance = scene.camera_distance ? *scene.camera_distance : framed();
  return 2 * distance * tanDegrees(double(view.field_of_view_degrees) / 2) / view.height;
}

size_t vertexBudget(const SceneNeeds& scene, const SurfaceMesh& mesh) {
  constexpr double kEdge_pixels = 8;
  const double edge = kEdge_pixels * pixelSize(scene, boundingBox(mesh));
  return size_t(std::clamp(surfaceArea(mesh) / (0.5 * std::sqrt(3.0) * edge * edge), 4.0, 1e9));
}

}  // namespace cloudbake
