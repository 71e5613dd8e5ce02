// Pictures of a baked mesh as an engine shows it with the lobe formula, before a sky.
#pragma once

#include <span>

#include "core/image.h"
#include "core/types.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/lit_mesh.h"

namespace cloudbake {

/// Per vertex R = T_lobe(sun)·(half-Lambert factor) and G = T_lobe(+Y), interpolated over each triangle;
/// cloud = lerp(ambient_ground, sun_color, R) + lerp(ambient_ground, ambient_sky, G), over the sky. Linear colours.
/// `mesh`: finite positions, indices in range, one lobe per vertex; missing normals are computed by angle.
/// A mesh without triangles gives the sky. The picture does not depend on the mesh's size and place, or on the number of threads.
/// If a ray finds no inside (an open mesh), the first surface is opaque. Throws std::invalid_argument if lobes are missing.
/// `sky`: the picture of a mesh without triangles, if it is there already. Then the light must have one ray per pixel.
Image renderLobe(const BakedMesh& mesh, const Camera& camera, const LightSettings& light, const Image* sky = nullptr);

/// The same picture of a mesh with given shades, one per vertex (preview/mesh_clouds/lit_mesh.h makes some); lobes and light.half_lambert
/// are ignored. renderLobe does this with the shades of lightMeshes. Throws std::invalid_argument if shades are missing.
Image renderShaded(const BakedMesh& mesh, std::span<const Shade> shades, const Camera& camera, const LightSettings& light);

/// Display-referred sRGB in [0, 1]: a filmic curve on exposure·colour, then the sRGB transfer function. `exposure` > 0.
Image toneMap(Image image, float exposure = 1);
/// The same for a row of colours.
void toneRow(std::span<Vec3> colors, float exposure = 1);

/// The inverse of the sRGB transfer function: values of 0 … 1 of a picture file to linear ones.
Image linearOfSrgb(Image srgb);

/// Prepares a display-referred picture for 8 bits: an ordered pattern of 8 × 8 pixels changes each pixel by less than half a step of 1/255,
/// so that gradients do not show bands once they are rounded. Values of whole steps do not change.
Image dithered(Image tone_mapped);

}  // namespace cloudbake
