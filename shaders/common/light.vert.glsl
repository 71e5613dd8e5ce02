// How much light of sun and sky reaches a vertex of a placed cloud.
in vec3 normal;
in vec4 lobe;      // direction and thickness, in the world
in vec4 compared;  // the other kind of lobe
in vec2 lengths;   // exact, to sun and sky
in vec2 seen;      // light that an eye sees of the volume through the vertex: seen.vert
in vec2 latticed;  // T towards sun and sky, by a lattice of harmonics
in float sun_share;  // what comes of the sun's light past other clouds
in vec4 harmonics_0, harmonics_1, harmonics_2, harmonics_3;
in vec3 mesh_position;  // in the world

uniform vec3 to_sun;
uniform vec2 shape, compared_shape;  // k and b
uniform float extinction, half_lambert, half_lambert_sky;
uniform mat3 to_own;           // from the world to the axes of the harmonics
uniform float own_extinction;  // for which they were made, per unit of their mesh
uniform bool of_lamps;         // the light of lamps, instead of that of sun and sky
uniform bool of_error;         // 1/2 + 1/2 · the error of the light of the sun, instead of the light
uniform vec2 gains;            // of the sun's term, left and right of the divider
uniform ivec2 lights;          // what the light left and right of the divider follows: LIGHTS of vertices.js
uniform ivec2 orders;          // of the harmonics there

out vec4 shade;  // light of sun and sky, left and right of the divider

const int COMPARED = 1;
const int HARMONICS = 2;
const int EXACT = 3;
const int LAMBERT = 4;
const int BLENDED = 5;  // the lobe with half of a Lambert factor
const int TRUTH = 6;
const int LATTICE = 7;

// The coefficients up to an order; those of the others are 0.
mat4 coefficientsTo(int order) {
  if (order == 1) {
    return mat4(harmonics_0, vec4(0.0), vec4(0.0), vec4(0.0));
  }
  if (order == 2) {
    return mat4(harmonics_0, harmonics_1, vec4(harmonics_2.x, 0.0, 0.0, 0.0), vec4(0.0));
  }
  return mat4(harmonics_0, harmonics_1, harmonics_2, harmonics_3);
}

float transmittance(int light, int order, vec3 to_light, float inside) {
  if (light == COMPARED) {
    return lobeTransmittance(compared, to_light, compared_shape, extinction);
  }
  if (light == HARMONICS) {
    return placedHarmonicTransmittance(coefficientsTo(order), to_light, to_own, own_extinction, extinction);
  }
  if (light == EXACT) {
    return exp(-extinction * inside);
  }
  return lobeTransmittance(lobe, to_light, shape, extinction);
}

// The light of sun and sky, before the factor of the surface.
vec2 lightBy(int light, int order) {
  if (light == LAMBERT) {
    return vec2(max(0.0, dot(normal, to_sun)), 0.5 + 0.5 * normal.y);
  }
  if (light == TRUTH) {
    return seen;
  }
  if (light == LATTICE) {
    return latticed;
  }
  return vec2(transmittance(light, order, to_sun, lengths.x), transmittance(light, order, vec3(0.0, 1.0, 0.0), lengths.y));
}

// The part of half-Lambert's factor that is even; 1.0 leaves it out.
float evenPart(int light, float own) {
  if (light == BLENDED) {
    return 0.5;
  }
  return light == LAMBERT || light == TRUTH ? 1.0 : own;
}

vec2 shadeBy(int light, int order, float gain) {
  vec2 found = lightBy(light, order);
  if (of_error) {
    float factor = surfaceFactor(normal, to_sun, evenPart(light, 1.0));
    return vec2(0.5 + 0.5 * (found.x * factor - exp(-extinction * lengths.x)), 0.0);
  }
  float factor = surfaceFactor(normal, to_sun, evenPart(light, half_lambert));
  float above = light == LAMBERT || light == TRUTH ? 1.0 : surfaceFactor(normal, vec3(0.0, 1.0, 0.0), half_lambert_sky);
  float most = light == TRUTH ? found.x : 1.0;  // a phase may send more than all of the light towards the eye
  return vec2(min(gain * found.x, most) * factor * sun_share, found.y * above);
}

void main() {
  if (of_lamps) {
    shade = vec4(lampsLight(lobe, mesh_position, normal, half_lambert, shape, extinction), 0.0);
    return;
  }
  shade.xy = shadeBy(lights.x, orders.x, gains.x);
  shade.zw = lights.x == lights.y && orders.x == orders.y ? shade.xy : shadeBy(lights.y, orders.y, gains.y);
}
