// Baked meshes as the previewer draws them: placed, lit by their lobes, and ready for rays.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/keys.h"
#include "core/ray_scene.h"
#include "core/types.h"
#include "preview/backdrop/sky.h"
#include "preview/lamp.h"
#include "preview/mesh_clouds/cloud_shadow.h"

namespace cloudbake {

/// What the two fields of a vertex are: the light of sun and sky, or red and green, or blue and nothing of the light of lamps or of the
/// clouds' own colours.
enum class ShownLight : uint8_t { kSunAndSky, kLampsRedGreen, kLampsBlue, kOwnRedGreen, kOwnBlue };

/// How clouds are lit and drawn. Colours are linear.
struct LightSettings {
  SkySettings sky;                  ///< background, direction to the sun, and the colours of sun and ambient light
  std::optional<float> extinction;  ///< σ, per world unit, of all meshes; unset: worldExtinction says
  bool lobes_only = false;          ///< T of the lobe formula also where a mesh has spherical harmonics
  float half_lambert = 0.5F;        ///< f: R is multiplied by lerp(f, 1, n·l/2 + 1/2); 0 … 1, 1 = the lobe alone
  float half_lambert_sky = 1;       ///< the same for G, with the direction up; the re-implementation of the published method has 0.5
  float volume_gain = 1;            ///< R of meshes that were fitted to a volume is multiplied by it, up to 1
  float view_extinction = 4;   ///< opacity along the view, in units of σ, > 0: edges soften where the cloud is thin. 0 = opaque surface
  bool first_surface = false;  ///< the first surface shows its light; else light changes evenly from the front of the cloud to its back
  bool own_colors = true;      ///< the base colours of sculpts multiply the light of their clouds
  int samples_per_side = 4;    ///< n·n rays per pixel, ≥ 1
  std::vector<Lamp> lamps;     ///< beside sun and sky
  ShownLight shown = ShownLight::kSunAndSky;
  RaysToCome rays = RaysToCome::kMany;  ///< how the mesh is prepared; the picture is the same
};
/// Its keys in a scene file.
const Keys<LightSettings>& lightKeys();

/// Settings for a sun at these angles, with the colours of sky and light at that hour.
LightSettings lightForSun(float azimuth_degrees, float elevation_degrees);

/// What is known of a cloud of a field, so that a picture of thousands need not look at all vertices, and that neither the camera nor the
/// depth of the chain follows clouds that drift.
struct Scattered {
  Box own;                 ///< of the mesh's triangles, in its own space
  Box field;               ///< which the clouds of the field never leave
  Vec3 wind;               ///< how far the field has drifted
  float longest_side = 1;  ///< of the cloud where nothing shrinks it, world units
  float turn_degrees = 0;  ///< about y
};

/// A mesh placed in the scene. The mesh must outlive the instance.
struct Instance {
  const BakedMesh* mesh = nullptr;
  Affine to_world;                                ///< the mesh's space → the world; invertible, mirrored and non-uniform scales included
  const ShadowCaster* caster = nullptr;           ///< its shadow on other things; null: none
  std::span<const float> sun_shares = {};         ///< the share of the sun's light that reaches each vertex past other things; empty: all
  std::span<const BakedMesh* const> levels = {};  ///< of detail, from fine to coarse; they must outlive the instance (levels.h)
  std::optional<Scattered> scattered = std::nullopt;  ///< of a cloud of a field
  bool is_seen = true;                                ///< else nothing of it is in the picture, and it is not drawn
  const BakedMesh* sized_as = nullptr;                ///< the full mesh, where `mesh` is a level of it
  // Of a cloud that changes (core/sequence.h):
  std::optional<Box> whole = std::nullopt;                   ///< of the mesh at all times, in its own space
  std::shared_ptr<const BakedMesh> now = nullptr;            ///< owns `mesh`
  std::shared_ptr<const BakedMesh> before = nullptr;         ///< what it fades from; null: it does not fade
  float before_share = 0;                                    ///< of the picture with `before` in the place of `mesh`
  std::shared_ptr<const ShadowCaster> own_caster = nullptr;  ///< owns `caster`
};

/// The own colour of each vertex, linear; white where a mesh has none.
std::vector<Vec3> ownColors(const BakedMesh& mesh);

/// Whether something is drawn in a colour of its own.
bool haveOwnColors(std::span<const Instance> instances, const LightSettings& light);

/// The lobe of a vertex that is moved by `to_world`: v = M·(o·d) with M the linear part, o = v/‖v‖, d = ‖v‖.
Lobe transformedLobe(const Lobe& lobe, const Affine& to_world);

/// World units per unit of the mesh's own space: ∛|det M|, the mean scale over directions.
float unitScale(const Affine& to_world);

/// The box of the triangles of an instance in the world; of a cloud of a field or one that changes, that of its own box.
Box placedBox(const Instance& instance);

/// σ · longest side of an asset that records no σ.
inline constexpr float kDefaultExtinctionTimesSize = 7;

/// σ of an instance per world unit. The σ that the asset records is per unit of its own, and so is kDefaultExtinctionTimesSize / longest
/// side if it records none. An instance that is s times as large has σ/s, so that σ·d and its look stay the same, and b·s keeps its ratio
/// to d. `light.extinction` is per world unit for all meshes, so that larger clouds are thicker clouds of the same fog.
float worldExtinction(const Instance& instance, const LightSettings& light);

/// The box of all triangles after `to_world`. A vertex that no triangle uses is not drawn and does not count.
Box drawnBox(const SurfaceMesh& surface, const Affine& to_world = {});

/// T of spherical harmonics that were made at an extinction `own` per unit of the mesh, towards a unit direction of the world. `to_own` =
/// M⁻¹ takes that direction to the mesh: a length ℓ along M⁻¹l is ℓ/‖M⁻¹l‖ in the world, so that T' = T^(σ/(own·‖M⁻¹l‖)).
float placedTransmittance(std::span<const float> coefficients, Vec3 to_light, const Affine& to_own, float own, float extinction);

/// The two fields of a vertex, or of a point between vertices: R = T(sun)·(half-Lambert factor), G = T(+Y), with T of the lobe or, if the
/// mesh has them, of its spherical harmonics.
struct Shade {
  float sun = 0, sky = 0;
};

/// An instance in the world, with what an engine needs to light it by its lobes.
struct PlacedMesh {
  std::vector<Vec3> positions, normals;
  std::vector<Lobe> lobes;
  std::vector<Triangle> triangles;  ///< counter-clockwise from outside, also after a mirror
  LobeShape shape;
  float extinction = 0;  ///< σ per world unit
};

/// Only the extinction of `light` counts. Throws as placeMeshes does.
PlacedMesh placedMesh(const Instance& instance, const LightSettings& light);

/// All instances as one mesh, in a frame that is centred on the box of their triangles, with the longest side 1.
struct LitMesh {
  std::vector<Vec3> positions;
  std::vector<Shade> shades;
  std::vector<Vec3> colors;  ///< own ones; empty if all are white
  std::vector<Triangle> triangles;
  Vec3 center;
  float size = 1;                        ///< world units per unit of the frame
  std::shared_ptr<const RayScene> rays;  ///< once prepareForRays made it

  Vec3 toFrame(Vec3 world) const { return (world - center) / size; }
};

/// The vertices of an instance in the world.
std::vector<Vec3> worldPositions(const Instance& instance);

/// Places and lights meshes with finite positions and indices in range. Missing normals are computed by angle.
/// Throws std::invalid_argument if a mesh does not have one lobe per vertex, or some but not all shares of the sun, or if a transform
/// cannot be inverted.
LitMesh lightMeshes(std::span<const Instance> instances, const LightSettings& light);
/// The same without colours.
LitMesh placeMeshes(std::span<const Instance> instances, const LightSettings& light);

/// One mesh in its own place, in the same frame, with the given shades; lobes and normals are not read. Throws std::invalid_argument if
/// there is not one shade per vertex.
LitMesh shadedMesh(const BakedMesh& mesh, std::span<const Shade> shades);

/// Must come before the first ray to a mesh with triangles.
void prepareForRays(LitMesh& lit, RaysToCome rays = RaysToCome::kMany);

/// R = exp(−σ ℓ_sun), G = exp(−σ ℓ_sky) of lengths per vertex: the truth that a lobe approximates. Throws std::invalid_argument if the
/// numbers of lengths differ.
std::vector<Shade> transmittanceShades(std::span<const float> to_sun, std::span<const float> to_sky, float extinction);

/// R = max(0, n·l), G = ½ + ½ n.y: an opaque surface. Missing normals are computed by angle.
std::vector<Shade> lambertShades(const SurfaceMesh& surface, Vec3 to_sun);

/// One crossing of the surface.
struct Crossing {
  float t = 0;   ///< distance along the ray, in the frame
  int sign = 0;  ///< +1 into the cloud, −1 out of it
  uint32_t triangle = 0;
  Shade shade;
  Vec3 color{1, 1, 1};  ///< the cloud's own
};

/// Every triangle that a ray of the frame meets, near to far. A ray through an edge meets both triangles of the edge.
void findCrossings(const LitMesh& lit, const Ray& ray, std::vector<Crossing>& crossings);
/// The same for a ray of which it is known which triangles it meets.
void findCrossings(const LitMesh& lit, const Ray& ray, std::span<const uint32_t> met, std::vector<Crossing>& crossings);

/// The first of them; none if the ray meets no triangle.
std::optional<Crossing> nearestCrossing(const LitMesh& lit, const Ray& ray);

/// The cloud's colour: lerp(ambient_ground, sun_color, R) + lerp(ambient_ground, ambient_sky, G).
Vec3 cloudColor(const Shade& shade, const SkyColors& colors);

}  // namespace cloudbake
