// What a scene asks of a bake: how large a pixel is at the cloud, and where the sun goes.
#pragma once

#include <optional>

#include "pipeline/settings.h"

namespace cloudbake {

/// The camera and the sun of a scene file (pipeline/picture/scene_file.h).
struct SceneNeeds {
  PictureSettings view;                   ///< angles, field of view and size of the picture
  std::optional<double> camera_distance;  ///< to the cloud, world units; unset: the cloud fills the picture
  std::optional<SunArc> sun_arc;
};

/// Size of a pixel at a cloud of this box, world units.
double pixelSize(const SceneNeeds& scene, const Box& box);

/// Vertices at which an edge of the mesh spans eight pixels: surface area / (√3/2 · edge²).
size_t vertexBudget(const SceneNeeds& scene, const SurfaceMesh& mesh);

}  // namespace cloudbake
