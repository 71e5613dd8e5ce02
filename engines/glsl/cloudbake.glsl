// cloudbake @version@: lights mesh clouds. These are plain functions, for GLSL 3.30 and GLSL ES 3.00 and later; they need no uniforms or
// textures. docs/engines/own_engine.md shows how to use them, docs/asset_format.md what is stored.

// k, b and sigma of the asset; b and sigma are in its scene's units. Where a whole scene is scaled by c, use b * c and sigma / c.
const vec2 CLOUDBAKE_SHAPE = vec2(@exponent@, @bias@);
const float CLOUDBAKE_EXTINCTION = @extinction@;
// The lobes are in TEXCOORD_@first_set@ and TEXCOORD_@second_set@.

#include "lobe.glsl"

#include "light.glsl"

#include "lamp.glsl"

#include "cast_shadow.glsl"

#include "noise.glsl"

#include "soft.glsl"

#include "harmonics.glsl"

#include "sky.glsl"

#include "tone.glsl"

// The shares of the light of sun and sky at a vertex: its two UV sets as glTF has them, the linear part of the matrix that places it, and
// the unit vector to the sun. The sky is above, along `up`.
vec2 cloudbakeLight(vec2 first, vec2 second, mat3 to_world, vec3 to_sun, vec3 up) {
  vec4 lobe = lobeInWorld(unpackLobe(first, second, 0.0), to_world);
  return vec2(lobeTransmittance(lobe, to_sun, CLOUDBAKE_SHAPE, CLOUDBAKE_EXTINCTION),
              lobeTransmittance(lobe, up, CLOUDBAKE_SHAPE, CLOUDBAKE_EXTINCTION));
}
