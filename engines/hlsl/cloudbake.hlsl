// cloudbake @version@: lights mesh clouds. These are plain functions for HLSL; they need no buffers or textures.
// docs/engines/own_engine.md shows how to use them, docs/asset_format.md what is stored. Matrices are multiplied from the left,
// mul(M, v); in a constant buffer, row_major says how they lie in memory.

// k, b and sigma of the asset; b and sigma are in its scene's units. Where a whole scene is scaled by c, use b * c and sigma / c.
static const float2 CLOUDBAKE_SHAPE = float2(@exponent@, @bias@);
static const float CLOUDBAKE_EXTINCTION = @extinction@;
// The largest d of a packed asset; 0.0: the asset is not packed.
static const float CLOUDBAKE_DENSITY_MAX = @density_max@;
// The lobes are in TEXCOORD_@first_set@ and TEXCOORD_@second_set@.

// The light and the fog of a scene file, or those of the previewer: the unit vector to the sun, linear colors, half-Lambert of sun and sky,
// the share, the asymmetry and the limit of the phase, and the density of fog per world unit.
static const float3 CLOUDBAKE_TO_SUN = float3(@sun_direction@);
static const float3 CLOUDBAKE_SUN_COLOR = float3(@sky_colors_sun@);
static const float3 CLOUDBAKE_AMBIENT_SKY = float3(@sky_colors_ambient_sky@);
static const float3 CLOUDBAKE_AMBIENT_GROUND = float3(@sky_colors_ambient_ground@);
static const float2 CLOUDBAKE_HALF_LAMBERT = float2(@light_half_lambert@, @light_half_lambert_sky@);
static const float3 CLOUDBAKE_PHASE = float3(@light_phase@, @light_phase_asymmetry@, @light_phase_limit@);
static const float3 CLOUDBAKE_FOG_COLOR = float3(@fog_color@);
static const float CLOUDBAKE_FOG_PER_UNIT = @fog_per_unit@;

#include "lobe.hlsl"

#include "light.hlsl"

#include "lamp.hlsl"

#include "cast_shadow.hlsl"
#include "cloud_shade.hlsl"

#include "noise.hlsl"

#include "soft.hlsl"

#include "impostor.hlsl"

#include "sequence.hlsl"

// The shares of the light of sun and sky at a vertex: its two UV sets as glTF has them, the linear part of the matrix that places it, and
// the unit vector to the sun. The sky is above, along `up`.
float2 cloudbakeLight(float2 first, float2 second, float3x3 to_world, float3 to_sun, float3 up) {
  float4 lobe = lobeInWorld(decodeLobe(first, second, 0.0, CLOUDBAKE_DENSITY_MAX), to_world);
  return float2(lobeTransmittance(lobe, to_sun, CLOUDBAKE_SHAPE, CLOUDBAKE_EXTINCTION),
                lobeTransmittance(lobe, up, CLOUDBAKE_SHAPE, CLOUDBAKE_EXTINCTION));
}
