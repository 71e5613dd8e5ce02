// Pictures of a baked mesh: what an engine shows with the lobe formula, on a sky.
#pragma once

#include <optional>

#include "core/image.h"
#include "core/types.h"
#include "preview/camera.h"
#include "preview/sky.h"

namespace cloudbake {

/// How a cloud is lit and drawn. Colours are linear.
struct LightSettings {
  SkySettings sky;                  ///< background, direction to the sun, and the colours of sun and ambient light
  std::optional<float> extinction;  ///< σ, per world unit; unset: the asset's; if it records none, 7 / longest side
  float half_lambert = 0.5F;        ///< f: R is multiplied by lerp(f, 1, n·l/2 + 1/2); 0 … 1, 1 = the lobe alone
  float view_extinction = 4;  ///< opacity along the view, in units of σ, > 0: edges soften where the cloud is thin. 0 = opaque surface
  int samples_per_side = 4;   ///< n·n rays per pixel, ≥ 1
};

/// Settings for a sun at this place, with the sky's and the light's colours of that hour.
LightSettings lightForSun(float azimuth_degrees, float elevation_degrees);

/// Per vertex R = T_lobe(sun)·(half-Lambert factor) and G = T_lobe(+Y), interpolated over each triangle;
/// cloud = lerp(ambient_ground, sun_color, R) + lerp(ambient_ground, ambient_sky, G), over the sky. Linear colours.
/// `mesh`: finite positions, indices in range, one lobe per vertex; normals may be missing (then they are made by area).
/// A mesh without triangles gives the sky. The picture does not depend on the mesh's size and place or on the thread count.
/// Where a ray finds no inside (an open mesh), the first surface is opaque. Throws std::invalid_argument where lobes are missing.
Image renderLobe(const BakedMesh& mesh, const Camera& camera, const LightSettings& light);

/// Display-referred sRGB in [0, 1]: a filmic curve on exposure·colour, then the sRGB transfer function. `exposure` > 0.
Image toneMap(const Image& image, float exposure = 1);

}  // namespace cloudbake
