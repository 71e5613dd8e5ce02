// The GLSL that both engines share: functions, and the uniforms that they read.

const HARMONICS = `
#include "harmonics.glsl"

uniform float own_extinction;  // for which the harmonics were made, per unit of the file
uniform mat3 to_mesh;          // from the scene of the file, in whose axes they are, to the mesh
`;

// Of harmonics up to an order, the attributes with their coefficients, four in each; none for the lobes alone.
export const harmonicNames = order =>
  Array.from({ length: order > 0 ? Math.ceil((order + 1) ** 2 / 4) : 0 }, (_, i) => `_transmittance_sh_${i}`);

// The coefficients of a vertex as the columns of a mat4; those of higher orders, which the attributes may have, are 0.
function coefficientsTo(order) {
  const columns = harmonicNames(order).map((name, i) => order === 2 && i === 2 ? `vec4(${name}.x, 0.0, 0.0, 0.0)` : name);
  return `mat4(${[0, 1, 2, 3].map(i => columns[i] ?? 'vec4(0.0)').join(', ')})`;
}

// By harmonics up to `order`, or by lobes alone if it is 0.
export const vertexLight = (order = 0) => `
#include "lobe.glsl"
${order > 0 ? `${HARMONICS}${harmonicNames(order).map(name => `attribute vec4 ${name};`).join('\n')}\n` : ''}
uniform vec3 to_sun;    // of length 1, in the world
uniform vec2 shape;     // k and b
uniform float extinction, half_lambert, volume_gain, flipped;
uniform float density_max;  // of a packed asset, else 0

// The share of a light that comes through the cloud to the vertex.
float shareOf(vec3 to_light, vec4 lobe, mat3 to_world) {
  return ${order > 0 ? `placedHarmonicTransmittance(${coefficientsTo(order)}, to_light,
    inverse(to_world * to_mesh), own_extinction, extinction)`
    : 'lobeTransmittance(lobe, to_light, shape, extinction)'};
}

// The unit normal in the world, by the matrix that places the mesh.
vec3 normalInWorld(vec3 own_normal, mat3 to_world) {
  mat3 cofactors = mat3(cross(to_world[1], to_world[2]), cross(to_world[2], to_world[0]), cross(to_world[0], to_world[1]));
  vec3 facing = cofactors * own_normal * sign(dot(to_world[0], cofactors[0]));
  float size = length(facing);
  return size > 0.0 ? facing / size : vec3(0.0);
}

// The shares of the light of sun and sky that reach a vertex, by its lobe and its normal in the world.
vec2 lightOfVertex(vec4 lobe, vec3 facing, mat3 to_world) {
  float sun = min(volume_gain * shareOf(to_sun, lobe, to_world), 1.0) * surfaceFactor(facing, to_sun, half_lambert);
  return vec2(sun, shareOf(vec3(0.0, 1.0, 0.0), lobe, to_world));
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

// What pixels get from the vertices.
export const VARYINGS = `
varying vec2 cloud_light;
varying vec3 cloud_view;
#ifdef SOFT
  varying vec3 cloud_normal, cloud_place;
#endif
#ifdef LAMPS
  varying vec3 cloud_lamps;
#endif
`;

// All of it but cloud_view, from the names of the two UV sets and the GLSL for the normal of the mesh and, in the world, matrix and place.
export const writeVaryings = (sets, normal, matrix, place) => `
  vec4 lobe = lobeInWorld(decodeLobe(${sets.join(', ')}, flipped, density_max), mat3(${matrix}));
  vec3 facing = normalInWorld(${normal}, mat3(${matrix}));
  cloud_light = lightOfVertex(lobe, facing, mat3(${matrix}));
  #ifdef SOFT
    cloud_normal = facing;
    cloud_place = position;
  #endif
  #ifdef LAMPS
    cloud_lamps = lampsOfVertex(lobe, ${place}, facing);
  #endif
`;

// What comes of the sun's light to a vertex past other clouds.
export const SHADE = `
#include "cloud_shade.glsl"
uniform highp sampler3D cloud_shades;
uniform vec4 cloud_shade_rows[3];

float shadePastOthers(vec3 place, vec3 shift) {
  vec3 at = shadePlace(place, cloud_shade_rows[0], cloud_shade_rows[1], cloud_shade_rows[2], shift);
  return texture(cloud_shades, at / vec3(textureSize(cloud_shades, 0))).r;
}
`;

// The share of the sun's light that comes to a place below all clouds.
export const GROUND_SHADE = `
#include "cloud_shade.glsl"
uniform highp sampler2D cloud_ground;
uniform vec4 cloud_shade_rows[3];
uniform float cloud_shade_strength;

float shadeOfClouds(vec3 place) {
  vec2 at = shadeGroundPlace(place, cloud_shade_rows[0], cloud_shade_rows[1]) / vec2(textureSize(cloud_ground, 0));
  return 1.0 - cloud_shade_strength * (1.0 - texture(cloud_ground, at).r);
}
`;

// The light of LAMPS lamps.
export const LAMPS = `
#include "lamp.glsl"
uniform Lamp lamps[LAMPS];

// What a vertex shows of it, by its lobe, its place and its normal in the world.
vec3 lampsOfVertex(vec4 lobe, vec3 place, vec3 normal) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < LAMPS; i++) {
    sum += lampLight(lamps[i], lobe, place, normal, half_lambert, shape, extinction);
  }
  return sum;
}
`;

// The picture of `cloudbake shadow` on other things.
export const CAST_SHADOW = `
#include "cast_shadow.glsl"
uniform highp sampler2D cloud_shadow;
uniform vec3 shadow_origin, shadow_right, shadow_up, shadow_to_sun;  // right and up: over width and height
uniform vec3 shadow_share;  // strength, and top and bottom of the cloud from the origin along shadow_to_sun

float castShadow(vec3 place) {
  vec2 at = shadowPlace(place, shadow_origin, shadow_right, shadow_up);
  float depth = shadowDepth(place, shadow_origin, shadow_to_sun, shadow_share.y, shadow_share.z);
  return shadowFactor(texture(cloud_shadow, at).r, at, shadow_share.x * depth);
}
`;

// Rims, fades and levels, for materials that are `soft`.
export const SOFT = `
#include "noise.glsl"
#include "soft.glsl"
uniform vec2 rim, near_fade, far_fade, shown;  // shown: the thresholds by which this level is drawn
uniform float rim_frequency, soft_distance, dither_shift, inside_light;
uniform vec3 rim_scroll;

// How opaque a pixel is. 'view' leads from the eye to it, 'away' is its distance along the view's axis and 'solid' that of something solid.
float opacityOfPixel(vec3 normal, vec3 view, vec3 own_place, float away, float solid) {
  float opacity = fadeBetween(away, near_fade.x, near_fade.y) * fadeBetween(away, far_fade.y, far_fade.x)
    * fadeBetween(solid - away, 0.0, soft_distance);
  if (rim.x == rim.y) {
    return opacity;
  }
  return opacity * rimOpacity(abs(dot(normalize(normal), normalize(view))), rimNoise(own_place, rim_frequency, rim_scroll), rim);
}

// A factor of the light of what rims let show: the inside of the far surface.
float insideFactor(vec3 normal, vec3 view) {
  return rim.x != rim.y && dot(normal, view) > 0.0 ? inside_light : 1.0;
}

// The threshold of a pixel; 1.0 where another level is drawn.
float thresholdOfPixel() {
  float threshold = fract(ditherThreshold(gl_FragCoord.xy) + dither_shift);
  return threshold >= shown.x && threshold < shown.y ? threshold : 1.0;
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

// The square of an impostor turns to the eye: what its pixels need.
export const IMPOSTOR_VARYINGS = `
varying vec3 impostor_place, impostor_ray, impostor_to_eye;  // in radii of the impostor, from its center
varying vec3 impostor_right, impostor_up, impostor_back;     // the columns of the matrix that places it
varying float impostor_texels;
varying vec3 cloud_view;
`;

// Writes them. A corner of the square is -1 or 1 to the right and upwards.
export const IMPOSTOR_SQUARE = `
#include "lobe.glsl"
#include "impostor.glsl"
uniform vec3 impostor_center;
uniform float impostor_radius;
uniform float impostor_scale;  // world units per pixel of the picture; of a camera with perspective at the distance 1
uniform vec4 impostor_atlas;

// The place of a corner in the world. 'axis' leads from the scene to a camera without perspective, else 'eye' is its place.
vec3 cornerInWorld(vec2 corner, mat4 to_world, vec3 eye, vec3 axis, bool has_perspective) {
  mat3 linear = mat3(to_world);
  vec3 center = (to_world * vec4(impostor_center, 1.0)).xyz;
  vec3 own_eye = inverse(linear) * (has_perspective ? eye - center : axis) / impostor_radius;
  impostor_to_eye = normalize(own_eye);
  impostor_place = impostorCorner(corner, own_eye, has_perspective);
  impostor_ray = impostorRay(impostor_place, own_eye, has_perspective);
  impostor_right = linear[0];
  impostor_up = linear[1];
  impostor_back = linear[2];
  float size = pow(abs(determinant(linear)), 1.0 / 3.0) * impostor_radius;
  impostor_texels = impostorTexels((has_perspective ? length(eye - center) : 1.0) * impostor_scale, size, impostor_atlas.y);
  return center + linear * (impostor_place * impostor_radius);
}
`;

// The colour of a pixel, which is lit, and its opacity.
export const IMPOSTOR_PIXEL = `
uniform highp sampler2D impostor_lobe, impostor_rest;
uniform vec4 impostor_atlas;
#include "lobe.glsl"
#include "impostor.glsl"
#include "impostor_atlas.glsl"
uniform float impostor_exponent, extinction, volume_gain;

// The shares of the light of sun and sky, and the opacity.
vec3 impostorLight(vec3 to_sun_) {
  vec3 rest;
  vec4 own = impostorSeen(impostor_place, impostor_ray, normalize(impostor_to_eye), impostor_texels, rest);
  vec4 lobe = lobeInWorld(own, mat3(impostor_right, impostor_up, impostor_back));
  float sun = rest.x * lobeTransmittance(lobe, to_sun_, vec2(impostor_exponent, 0.0), extinction);
  float sky = rest.x * lobeTransmittance(lobe, vec3(0.0, 1.0, 0.0), vec2(impostor_exponent, 0.0), extinction);
  return vec3(min(volume_gain * sun, 1.0), sky, rest.z);
}
`;
