// Draws a scene: mesh clouds, backdrops and other clouds, each as a layer over the sky.
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
  std::map<std::string, BakedMesh> meshes;         ///< by file, or by the preset and its settings
  std::vector<Instance> instances;                 ///< they point into `meshes`
  std::map<const BakedMesh*, BakedMesh> compared;  ///< of view --compare: the same mesh with the other lobes, and with harmonics
};

/// Makes everything faster to draw at the same size, with fewer samples and coarser steps, for looking at while a scene is made.
void makeDraft(SceneFile& scene);

/// The camera of a view, turned by `turn` degrees about the vertical axis through its target.
Camera cameraFor(const Scenery& scenery, const PictureSettings& view, float turn);

/// What drawing a picture yields in addition to the picture.
struct DrawnParts {
  std::vector<ChainStep> steps;                         ///< of the mesh clouds
  Image background;                                     ///< behind everything, linear
  std::vector<std::pair<std::string, double>> seconds;  ///< per renderer
};

/// Draws, tone maps and grades a whole display-referred picture. The light may differ from the scene's, as with a moving sun.
Image drawScene(const Scenery& scenery, const LightSettings& light, const PictureSettings& view, float turn, DrawnParts& parts);

}  // namespace cloudbake
