// Draws a scene: mesh clouds, backdrops and other clouds, each as a layer over the sky.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "core/sequence.h"
#include "pipeline/picture/motion.h"
#include "pipeline/scene/scene_file.h"

namespace cloudbake {

/// A field of clouds with its meshes.
struct DrawnField {
  ScatterSettings settings;
  std::vector<ScatteredCloud> clouds;
  std::vector<Instance> meshes;  ///< that the clouds are copies of, placed before they are scattered
};

/// A cloud that changes.
struct SceneSequence {
  CloudSequence sequence;
  Box whole;  ///< of all its meshes
};

/// A scene with the meshes that it names.
struct Scenery {
  SceneFile scene;                                                   ///< at the view's own time and sun
  std::function<SceneFile(const std::optional<Moment>&)> read;       ///< the scene's file at another moment, or as it is; none for an asset
  std::map<std::string, BakedMesh> meshes;                           ///< by file, or by the preset and its settings
  std::map<const BakedMesh*, SceneSequence> sequences;               ///< of meshes that are the first of a cloud that changes
  std::map<const BakedMesh*, std::vector<const BakedMesh*>> levels;  ///< of detail, in `meshes`
  std::map<const BakedMesh*, ShadowCaster> casters;                  ///< of meshes that shadow something
  std::vector<Instance> instances;                                   ///< they point into `meshes`, `levels` and `casters`
  std::vector<DrawnField> fields;                                    ///< so do theirs
  std::map<const BakedMesh*, BakedMesh> compared;  ///< of view --compare: the same mesh with the other lobes, and with harmonics
};

/// The box of an instance's triangles in its own space; of a cloud that changes, at all times.
Box boxOfMesh(const Instance& instance);

/// A box that the clouds of a field never leave.
Box boxOf(const DrawnField& field);

/// The instances of a scenery at a time: its own, then those of its fields.
std::vector<Instance> instancesAt(const Scenery& scenery, double seconds);
/// The same at the moment of a view: fields are ahead of its time by its offset.
inline std::vector<Instance> instancesAt(const Scenery& scenery, const PictureSettings& view) {
  return instancesAt(scenery, view.time_seconds + view.time_offset_seconds);
}

/// How much light comes to places of dust through its lattice. As for harmonics of a mesh, σ shrinks with the scale, unless the scene gives
/// one for all clouds. It refers to the dust.
LightAt lightThrough(const SceneDust& dust, std::optional<float> extinction);

/// Makes everything faster to draw at the same size, with fewer samples and coarser steps, for looking at while a scene is made.
void makeDraft(SceneFile& scene);

/// The scene at another moment, as a still of it would be read.
SceneFile sceneAt(const Scenery& scenery, const Moment& moment);

/// The camera of a scene's view, turned by `turn` degrees about the vertical axis through its target. On the terrain's path it is not
/// turned.
Camera cameraFor(const SceneFile& scene, std::span<const Instance> instances, float turn = 0);

/// How a scene's mesh clouds are laid over what is behind them, with its fog: that of the chain, unless there is fog over distance, which
/// composeLayers adds.
CompositeSettings compositeOf(const SceneFile& scene);

/// What drawing a picture yields in addition to the picture.
struct DrawnParts {
  std::vector<ChainStep> steps;                         ///< of the mesh clouds
  Image background;                                     ///< behind everything, linear
  std::vector<std::pair<std::string, double>> seconds;  ///< per renderer
};

/// How far the camera is turned as for cameraFor, now and when the shutter opened.
struct CameraTurn {
  float now = 0, before = 0;
};

/// The instances as a camera sees them: each with the level of detail that is drawn there, clouds of fields with whether they are seen.
/// What casts shadows stays.
std::vector<Instance> withLevels(std::span<const Instance> instances, const Camera& camera);

/// Draws, tone maps and grades a whole display-referred picture of the scene's view.
Image drawScene(const SceneFile& scene, std::span<const Instance> instances, const CameraTurn& turn, DrawnParts& parts);

}  // namespace cloudbake
