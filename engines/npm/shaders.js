// The GLSL that both engines share: functions, and the uniforms that they read.

export const VERTEX_LIGHT = `
#include "lobe.glsl"

uniform vec3 to_sun;    // of length 1, in the world
uniform vec2 shape;     // k and b
uniform float extinction, half_lambert, volume_gain, flipped;

// The shares of the light of sun and sky that reach a vertex. The two UV sets and the normal are those of the mesh; to_world places it.
vec2 lightOfVertex(vec2 first, vec2 second, vec3 own_normal, mat3 to_world) {
  vec4 lobe = lobeInWorld(unpackLobe(first, second, flipped), to_world);
  mat3 cofactors = mat3(cross(to_world[1], to_world[2]), cross(to_world[2], to_world[0]), cross(to_world[0], to_world[1]));
  vec3 facing = cofactors * own_normal * sign(dot(to_world[0], cofactors[0]));
  float size = length(facing);
  facing = size > 0.0 ? facing / size : vec3(0.0);
  float sun = min(volume_gain * lobeTransmittance(lobe, to_sun, shape, extinction), 1.0) * surfaceFactor(facing, to_sun, half_lambert);
  return vec2(sun, lobeTransmittance(lobe, vec3(0.0, 1.0, 0.0), shape, extinction));
}
`;

export const PIXEL_COLOR = `
#include "light.glsl"

uniform vec3 to_sun, sun_color, ambient_sky, ambient_ground;
uniform vec3 phase;  // share, asymmetry, limit

// The colour of a pixel; view leads from the eye to it.
vec3 colorOfPixel(vec2 light, vec3 view) {
  vec2 shares = clamp(light, 0.0, 1.0);
  float factor = phaseFactor(normalize(view), to_sun, phase.x, phase.y, phase.z);
  return cloudColor(shares.x, shares.y, sun_color * factor, ambient_sky, ambient_ground);
}
`;

export const CHANNELS = `
#include "channels.glsl"
`;

export const SKY_COLOR = `
#include "sky.glsl"

uniform vec3 to_sun, zenith, low_sky, horizon, ground, sun_color;

vec3 colorOfSky(vec3 view) {
  vec3 disc = vec3(4000.0, 250.0, 0.12);
  return skyColor(normalize(view), Sky(to_sun, zenith, low_sky, horizon, ground, sun_color, disc, 24.0, 0.0, vec4(horizon, 1.0)));
}
`;

export const TONE = `
#include "tone.glsl"

uniform float exposure;
`;
