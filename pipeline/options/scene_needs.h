// The facts about a scene that a bake needs: the size of a pixel at the cloud, and the range of the sun.
#pragma once

#include <optional>

#include "pipeline/options/settings.h"

namespace cloudbake {

/// The camera and the sun of a scene file (pipeline/scene/scene_file.h).
struct SceneNeeds {
  PictureSettings view;                   ///< angles, field of view and size of the picture
  std::optional<double> camera_distance;  ///< to the cloud, world units; unset: the cloud fills the picture
  std::optional<SunArc> sun_arc;
  VolumeChoices volume;  ///< of a fit to a volume
};

/// The size of a pixel at a cloud with this bounding box, world units.
double pixelSize(const SceneNeeds& scene, const Box& box);

/// The number of vertices at which an edge of the mesh spans eight pixels: surface area / (√3/2 · edge²).
size_t vertexBudget(const SceneNeeds& scene, const SurfaceMesh& mesh);

}  // namespace cloudbake
