// Bakes the texels of lobe impostors (core/impostor.h). The view of a texel is known, so that its lobe is fitted to what this view sees:
//   C(l) = ∫ σ_v e^{−τ(t)} S(σ ℓ(t, l)) dt / (1 − e^{−τ(∞)})
// along the texel's rays, or to the lobes of the mesh where it is the mesh that is shown.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "bake/lobe/sliced_field.h"
#include "core/impostor.h"
#include "core/ray_scene.h"
#include "core/surface_points.h"
#include "core/types.h"

namespace cloudbake {

/// Directions to the light: both senses of the axes, with a weight ≥ 0 for each.
struct ImpostorLights {
  std::span<const Vec3> axes;
  std::span<const float> weights;
};

/// What the texels of some frames show, for the texels that something is seen in.
struct SeenTexels {
  std::vector<uint32_t> texels;  ///< their numbers, row by row of the atlas, rising within a frame
  std::vector<float> opacity;    ///< 0 … 1
  std::vector<float> depth;      ///< as in Impostor, the mean of what is seen
  std::vector<float> light;      ///< #texels × 2 #axes: 0 … 1, what shows of a light from there
};

struct VolumeFrames {
  const SweepField& field;
  VolumeLight light;
  double ray_length = 0;  ///< L, world units
  int nodes = 2;          ///< places of a ray at which the light is taken, in the middles of equal parts of its opacity
};
/// The volume in frames first … first + count − 1, counted row by row. The result is the same for any number of threads.
SeenTexels seenOfVolume(const ImpostorInfo& info, int first, int count, const VolumeFrames& volume, std::span<const Vec3> axes);

/// A mesh, prepared for the rays of all frames. It refers to the mesh.
class MeshFrames {
 public:
  /// `half_lambert`: f of the factor lerp(f, 1, n·l/2 + ½) of all lights; 1: none. Of `info` only the ball counts.
  MeshFrames(const BakedMesh& mesh, float half_lambert, const ImpostorInfo& info);
  const BakedMesh& mesh() const { return mesh_; }
  float halfLambert() const { return half_lambert_; }
  std::span<const Vec3> normals() const { return normals_; }

  /// What a ray from the eye meets first; distances are in radii, as are the ray's own numbers, from the center of the ball.
  struct Hit {
    SurfacePoint place;
    float distance = 0;
  };
  std::optional<Hit> nearest(const Ray& ray) const;

 private:
  const BakedMesh& mesh_;
  float half_lambert_;
  std::vector<Vec3> normals_, places_;  // places: from the center, in radii, for rays in floats
  RayScene scene_;
};
/// The mesh, opaque.
SeenTexels seenOfMesh(const ImpostorInfo& info, int first, int count, const MeshFrames& mesh, std::span<const Vec3> axes);

/// The smallest ball around points, within a percent (Bădoiu and Clarkson, "Smaller core-sets for balls", SODA 2003), as center and radius.
std::pair<Vec3, float> ballAround(std::span<const Vec3> points);

/// Lobes fitted to the light of texels with this k. `light` is as in SeenTexels. In turns, lobes are fitted to the light divided by `lit`,
/// and `lit` is the best factor for these lobes.
std::vector<TexelLobe> fitTexels(std::span<const float> light, const ImpostorLights& lights, float exponent, float extinction);
/// k for all texels, from about `most` of them.
float fitTexelExponent(std::span<const float> light, const ImpostorLights& lights, float start, float extinction, size_t most);

/// The mean of (shown − light)² over lights by weight and texels by opacity: its root is the rms.
struct TexelError {
  double squares = 0, weight = 0;
  double rms() const;
};
/// Adds the error of what texels show, shown(texel, light). `light` numbers both senses of the lights' axes.
template <class Shown>
void addTexelError(const SeenTexels& seen, const ImpostorLights& lights, TexelError& error, const Shown& shown) {
  const size_t count = 2 * lights.axes.size();
  for (size_t t = 0; t < seen.texels.size(); ++t)
    for (size_t l = 0; l < count; ++l) {
      const double difference = shown(t, l) - seen.light[t * count + l], weight = double(seen.opacity[t]) * double(lights.weights[l]);
      error.squares += weight * difference * difference;
      error.weight += weight;
    }
}

/// The axes of the frame that a texel of the atlas is in.
FrameAxes axesOfTexel(const ImpostorInfo& info, uint32_t texel);

/// Writes the lobes, opacities and depths of texels into the atlas, whose info says how they are scaled.
void storeTexels(const SeenTexels& seen, std::span<const TexelLobe> lobes, Impostor& impostor);
/// The lobe that is stored at a texel.
TexelLobe storedTexel(const Impostor& impostor, uint32_t texel);
/// Gives texels in which nothing is seen the lobe and depth of their neighbours, so that filters do not mix others in.
void fillEmptyTexels(Impostor& impostor);

/// Six-way light maps: what shows of light along the axes of the view (+x right, +y up, +z towards the eye; then −x, −y, −z), fitted to the
/// same light by least squares. Light from l shows Σ lᵢ² map(axis i, sense of lᵢ), as in Unity's Six-way Smoke Lit. #texels × 6 values.
std::vector<float> fitSixWay(const SeenTexels& seen, const ImpostorInfo& info, const ImpostorLights& lights);
/// What they show.
float sixWayLight(std::span<const float> maps, Vec3 light_in_view);

}  // namespace cloudbake
