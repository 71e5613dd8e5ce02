// The previewer's truth: a volume that is marched along the view and lit through lengths of cloud towards the sun and the sky.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/image.h"
#include "core/types.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {

/// A cloud, and how much of it is between its cells and the light. All three must outlive the volume.
struct Volume {
  const CoverageField* field = nullptr;
  std::span<const float> to_sun, to_sky;  ///< ℓ from every cell's centre, world units, in the order of field->fractions
};

struct VolumeSettings {
  float extinction = 1;  ///< σ towards sun and sky, per world unit, ≥ 0: worldExtinction of the mesh that is compared
  VolumeLight light;     ///< view_extinction ≥ 0; the phase is that of the sun alone
  int steps = 200;       ///< a step is at most the cloud's longest side / steps; ≥ 1
  bool jitter = false;   ///< sample at hashed places of the steps instead of the middles: noise instead of bands
};

/// The cloud over the sky, linear colours, light.samples_per_side² rays per pixel: a sample's colour is
/// lerp(ambient_ground, sun_color, R) + lerp(ambient_ground, ambient_sky, G), R = phase·S(σ ℓ_sun), G = S(σ ℓ_sky), S as OctaveSettings
/// say. Of `light` only the sky and samples_per_side are used. Grazing light shines through the skin of half filled cells: across a ball of
/// 100 cells with σ = 7/100 per cell this adds 1% of the sun's colour in the middle, and it scales with the cells. Throws
/// std::invalid_argument if there is not one length per cell, or if a setting is out of its range.
Image renderVolume(const Volume& volume, const Camera& camera, const LightSettings& light, const VolumeSettings& settings);

/// The part of the cloud that an eye sees along a ray that starts in it or before it.
struct SeenLight {
  float opacity = 0;  ///< 1 − exp(−τ) of the whole ray
  Shade shade;        ///< R and G of the light that comes back, divided by the opacity; without cloud those of the ray's start
};

/// The light along rays of the world with unit directions away from the eye. Throws as renderVolume does.
std::vector<SeenLight> lightAlong(const Volume& volume, std::span<const Ray> rays, Vec3 to_sun, const VolumeSettings& settings);

/// Centres of all cells, world units, in the order of field.fractions.
std::vector<Vec3> cellCenters(const CoverageField& field);

/// ℓ from every point towards a unit direction, world units, by one march per point, which is what a sweep avoids: in equal steps of at
/// most the cloud's longest side / steps. Points may be anywhere.
std::vector<float> plainLengths(const CoverageField& field, std::span<const Vec3> points, Vec3 direction, int steps = 200);

}  // namespace cloudbake
