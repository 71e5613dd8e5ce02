// Draws a scene: mesh clouds, backdrops and other clouds, each a layer, over its sky.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "pipeline/picture/scene_file.h"

namespace cloudbake {

/// A scene with the meshes that it names.
struct Scenery {
  SceneFile scene;
  std::map<std::string, BakedMesh> meshes;  ///< by file, or by what was grown
  std::vector<Instance> instances;          ///< of the meshes
};

/// Everything at less cost and no other size: fewer samples, coarser steps. For looking at while a scene is made.
void makeDraft(SceneFile& scene);

/// `turn` about the vertical through what is looked at, degrees.
Camera cameraFor(const Scenery& scenery, const PictureSettings& view, float turn);

/// What was drawn beside the picture.
struct DrawnParts {
  MeshCloudSteps steps;                                 ///< of the mesh clouds
  std::vector<std::pair<std::string, double>> seconds;  ///< per renderer
};

/// A whole picture, display-referred: drawn, tone mapped and graded, for a light that may differ from the scene's (a moving sun).
Image drawScene(const Scenery& scenery, const LightSettings& light, const PictureSettings& view, float turn, DrawnParts& parts);

}  // namespace cloudbake
