// Baked meshes as the previewer draws them: in their places, lit by their lobes, ready for rays.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/ray_scene.h"
#include "core/types.h"
#include "preview/backdrop/sky.h"

namespace cloudbake {

/// How clouds are lit and drawn. Colours are linear.
struct LightSettings {
  SkySettings sky;                  ///< background, direction to the sun, and the colours of sun and ambient light
  std::optional<float> extinction;  ///< σ, per world unit, of all meshes; unset: worldExtinction says
  bool lobes_only = false;          ///< T of the lobe formula also where a mesh has spherical harmonics
  float half_lambert = 0.5F;        ///< f: R is multiplied by lerp(f, 1, n·l/2 + 1/2); 0 … 1, 1 = the lobe alone
  float view_extinction = 4;  ///< opacity along the view, in units of σ, > 0: edges soften where the cloud is thin. 0 = opaque surface
  int samples_per_side = 4;   ///< n·n rays per pixel, ≥ 1
};

/// Settings for a sun at this place, with the sky's and the light's colours of that hour.
LightSettings lightForSun(float azimuth_degrees, float elevation_degrees);

/// A mesh where it stands in the scene. The mesh must outlive the instance.
struct Instance {
  const BakedMesh* mesh = nullptr;
  Affine to_world;  ///< the mesh's space → the world; invertible, mirrored and non-uniform scales included
};

/// The lobe of a vertex that `to_world` carries along: v = M·(o·d) with M the linear part, o = v/‖v‖, d = ‖v‖.
Lobe transformedLobe(const Lobe& lobe, const Affine& to_world);

/// How many world units one unit of the mesh's own space takes: ∛|det M|, the mean over directions of scale.
float unitScale(const Affine& to_world);

/// σ of an instance per world unit. A σ that the asset records counts per unit of its own, and so does 7 / longest side where it
/// records none: an instance s times as large has σ/s, so that σ·d and its look stay the same, as b·s keeps its share of d.
/// `light.extinction` counts per world unit for all meshes: then larger clouds are thicker ones of the same fog.
float worldExtinction(const Instance& instance, const LightSettings& light);

/// The box of all triangles, where `to_world` carries them. A vertex that no triangle uses is not drawn and does not count.
Box drawnBox(const SurfaceMesh& surface, const Affine& to_world = {});

/// T of spherical harmonics that were made at an extinction `own` per unit of the mesh, towards a unit direction of the world where
/// `to_own` = M⁻¹ brings it back: a length ℓ along M⁻¹l is ℓ/‖M⁻¹l‖ in the world, so that T' = T^(σ/(own·‖M⁻¹l‖)).
float placedTransmittance(std::span<const float> coefficients, Vec3 to_light, const Affine& to_own, float own, float extinction);

/// The two fields of a vertex, or of a point between vertices: R = T(sun)·(half-Lambert factor), G = T(+Y), with T of the lobe or, where
/// the mesh has them, of its spherical harmonics.
struct Shade {
  float sun = 0, sky = 0;
};

/// All instances as one mesh, in a frame that is centred on what their triangles span and whose longest side is 1.
struct LitMesh {
  std::vector<Vec3> positions;
  std::vector<Shade> shades;
  std::vector<Triangle> triangles;
  Vec3 center;
  float size = 1;                        ///< world units per unit of the frame
  std::shared_ptr<const RayScene> rays;  ///< none where there are no triangles

  Vec3 toFrame(Vec3 world) const { return (world - center) / size; }
};

/// Places and lights meshes: finite positions, indices in range; normals may be missing (then they are made by angle).
/// Throws std::invalid_argument where a mesh has not one lobe per vertex, or a transform cannot be inverted.
LitMesh lightMeshes(std::span<const Instance> instances, const LightSettings& light);

/// One mesh where it is, in the same frame, with shades from elsewhere; lobes and normals are not read. Throws std::invalid_argument where
/// there is not one shade per vertex.
LitMesh shadedMesh(const BakedMesh& mesh, std::span<const Shade> shades);

/// R = exp(−σ ℓ_sun), G = exp(−σ ℓ_sky) of lengths per vertex: the truth that a lobe stands for. Throws std::invalid_argument where there
/// are not as many of the one as of the other.
std::vector<Shade> transmittanceShades(std::span<const float> to_sun, std::span<const float> to_sky, float extinction);

/// R = max(0, n·l), G = ½ + ½ n.y: an opaque surface. Missing normals are made by angle.
std::vector<Shade> lambertShades(const SurfaceMesh& surface, Vec3 to_sun);

/// One crossing of the surface.
struct Crossing {
  float t = 0;   ///< distance along the ray, in the frame
  int sign = 0;  ///< +1 into the cloud, −1 out of it
  uint32_t triangle = 0;
  Shade shade;
};

/// Every triangle that a ray of the frame meets, near to far. A ray through an edge meets both its triangles and gets both.
void findCrossings(const LitMesh& lit, const Ray& ray, std::vector<Crossing>& crossings);

/// The first of them; nothing where the ray meets no triangle.
std::optional<Crossing> nearestCrossing(const LitMesh& lit, const Ray& ray);

/// The cloud's colour: lerp(ambient_ground, sun_color, R) + lerp(ambient_ground, ambient_sky, G).
Vec3 cloudColor(const Shade& shade, const SkyColors& colors);

}  // namespace cloudbake
