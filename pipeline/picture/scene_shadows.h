// How the things of a scene shadow each other: terrain, mesh clouds, slabs and marched clouds.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/memory_budget.h"
#include "core/warnings.h"
#include "pipeline/scene/scene_file.h"
#include "preview/layer.h"
#include "preview/light_passage.h"
#include "preview/mesh_clouds/cloud_shadow.h"
#include "preview/mesh_clouds/shade_grid.h"

namespace cloudbake {

/// The field of a mesh cloud that casts its shadow, kCasterVoxels along the longest side. An open mesh is closed as a bake closes it. One
/// that encloses nothing casts no shadow, and is counted.
inline constexpr int kCasterVoxels = 64;
std::optional<ShadowCaster> shadowCasterOf(const BakedMesh& mesh, Warnings& warnings);
/// The same with as many voxels as given. Throws InputError, without a file, if the mesh encloses nothing.
ShadowCaster shadowCasterOf(const BakedMesh& mesh, int voxels, uint64_t memory_limit = kMemoryLimit);

/// The fields of casters are this many times coarser in a grid by which many clouds shade each other.
inline constexpr int kShadeCoarser = 4;
/// What the grid of a scene encloses: the clouds that cast shadows, wherever they drift.
struct ShadeExtent {
  Box box;
  float cloud_size = 1;      ///< the mean longest side
  std::optional<Vec3> wind;  ///< how far they have drifted, if the first of them is of a field
};
/// None if no instance casts a shadow.
std::optional<ShadeExtent> shadeExtent(std::span<const Instance> instances);

/// The grid by which the instances of a scene that cast shadows shade each other, under a light. `number[i]` is the number of the cloud of
/// instance i in the grid, if it casts a shadow.
struct SceneShade {
  ShadeGrid grid;
  std::vector<size_t> number;
};
/// None if no instance casts a shadow.
std::optional<SceneShade> shadeOf(std::span<const Instance> instances, const LightSettings& light, const ShadowSettings& shadows,
                                  Vec3 to_light);

/// Whether there are two things of which one could shadow the other, and the scene wants them to.
bool drawsShadows(const SceneFile& scene);

/// The shadows under the key light of a scene. It refers to the scene and the instances.
class SceneShadows {
 public:
  SceneShadows(const SceneFile& scene, std::span<const Instance> instances);

  enum class Kind { kMesh, kTerrain, kSlab, kDistance, kDensity };
  /// How much of the light passes everything but one thing: the one that is lit, which has its own shadows. Empty if there is nothing else.
  LightPassage past(Kind kind, size_t index = 0) const;
  /// How mesh clouds shadow the samples of marched clouds. Like `past`, it refers to this, which must outlive it.
  MarchedShadow onSamples() const;

  /// What comes of the light to every vertex of each instance; nothing if nothing is in the way.
  std::vector<std::vector<float>> sharesOfVertices() const;

  /// Darkens the layers of clouds of noise by what stands between their distance and the light, as MarchedShadow does; those of marched
  /// clouds without what is onSamples.
  void darken(std::span<Layer> layers, Kind kind, size_t index, const Camera& camera) const;

 private:
  Vec3 skyShare() const;
  LightPassage pastAll(bool with_meshes, bool with_others, Kind but, size_t index) const;

  struct Thing {
    Kind kind;
    size_t index;
    LightPassage passage;
  };

  void makeShadows(Vec3 to_light);
  void makeGrid(Vec3 to_light);
  LightPassage pastMeshes(bool are_lit_meshes, size_t owner) const;

  const SceneFile& scene_;
  std::span<const Instance> instances_;
  CloudShadows meshes_;
  std::optional<ShadeGrid> grid_;                     // in place of these
  std::vector<std::optional<ShadeBlock>> others_of_;  // by instance, of those that are seen and cast a shadow
  std::vector<Thing> others_;
};

}  // namespace cloudbake
