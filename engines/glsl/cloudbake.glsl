// cloudbake @version@: lights mesh clouds. These are plain functions, for GLSL 3.30 and GLSL ES 3.00 and later; they need no uniforms or
// textures. docs/engines/own_engine.md shows how to use them, docs/asset_format.md what is stored.

// k, b and sigma of the asset; b and sigma are in its scene's units. Where a whole scene is scaled by c, use b * c and sigma / c.
const vec2 CLOUDBAKE_SHAPE = vec2(@exponent@, @bias@);
const float CLOUDBAKE_EXTINCTION = @extinction@;
// The largest d of a packed asset; 0.0: the asset is not packed.
const float CLOUDBAKE_DENSITY_MAX = @density_max@;
// The lobes are in TEXCOORD_@first_set@ and TEXCOORD_@second_set@.

// The light and the fog of a scene file, or those of the previewer: the unit vector to the sun, linear colors, half-Lambert of sun and sky,
// the share, the asymmetry and the limit of the phase, and the density of fog per world unit.
const vec3 CLOUDBAKE_TO_SUN = vec3(@sun_direction@);
const vec3 CLOUDBAKE_SUN_COLOR = vec3(@sky_colors_sun@);
const vec3 CLOUDBAKE_AMBIENT_SKY = vec3(@sky_colors_ambient_sky@);
const vec3 CLOUDBAKE_AMBIENT_GROUND = vec3(@sky_colors_ambient_ground@);
const vec2 CLOUDBAKE_HALF_LAMBERT = vec2(@light_half_lambert@, @light_half_lambert_sky@);
const vec3 CLOUDBAKE_PHASE = vec3(@light_phase@, @light_phase_asymmetry@, @light_phase_limit@);
const vec3 CLOUDBAKE_FOG_COLOR = vec3(@fog_color@);
const float CLOUDBAKE_FOG_PER_UNIT = @fog_per_unit@;

#include "lobe.glsl"

#include "light.glsl"

#include "lamp.glsl"

#include "cast_shadow.glsl"
#include "cloud_shade.glsl"

#include "noise.glsl"

#include "soft.glsl"

#include "impostor.glsl"

#include "sequence.glsl"

#include "harmonics.glsl"

#include "sky.glsl"

#include "tone.glsl"

// The shares of the light of sun and sky at a vertex: its two UV sets as glTF has them, the linear part of the matrix that places it, and
// the unit vector to the sun. The sky is above, along `up`.
vec2 cloudbakeLight(vec2 first, vec2 second, mat3 to_world, vec3 to_sun, vec3 up) {
  vec4 lobe = lobeInWorld(decodeLobe(first, second, 0.0, CLOUDBAKE_DENSITY_MAX), to_world);
  return vec2(lobeTransmittance(lobe, to_sun, CLOUDBAKE_SHAPE, CLOUDBAKE_EXTINCTION),
              lobeTransmittance(lobe, up, CLOUDBAKE_SHAPE, CLOUDBAKE_EXTINCTION));
}
