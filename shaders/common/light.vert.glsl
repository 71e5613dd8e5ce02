// How much light of sun and sky reaches a vertex of a placed cloud.
in vec3 normal;
in vec4 lobe;      // direction and thickness, in the world
in vec4 compared;  // the other kind of lobe
in vec2 lengths;   // exact, to sun and sky
in float sun_share;  // what comes of the sun's light past other clouds
in vec4 harmonics_0, harmonics_1, harmonics_2, harmonics_3;

uniform vec3 to_sun;
uniform vec2 shape, compared_shape;  // k and b
uniform float extinction, half_lambert, half_lambert_sky;
uniform mat3 to_own;           // from the world to the axes of the harmonics
uniform float own_extinction;  // for which they were made, per unit of their mesh
uniform bool of_error;         // 1/2 + 1/2 · the error of T towards the sun, instead of the light
uniform vec2 gains;            // of the sun's term, left and right of the divider
uniform ivec2 lights;          // what the light left and right of the divider follows: lobe, other lobe, harmonics, exact lengths

out vec4 shade;  // light of sun and sky, left and right of the divider

float transmittance(int light, vec3 to_light, float inside) {
  if (light == 1) {
    return lobeTransmittance(compared, to_light, compared_shape, extinction);
  }
  if (light == 2) {
    return placedHarmonicTransmittance(mat4(harmonics_0, harmonics_1, harmonics_2, harmonics_3), to_light, to_own, own_extinction,
                                       extinction);
  }
  if (light == 3) {
    return exp(-extinction * inside);
  }
  return lobeTransmittance(lobe, to_light, shape, extinction);
}

vec2 shadeBy(int light, float gain) {
  if (of_error) {
    return vec2(0.5 + 0.5 * (transmittance(light, to_sun, lengths.x) - transmittance(3, to_sun, lengths.x)), 0.0);
  }
  float sun = min(gain * transmittance(light, to_sun, lengths.x), 1.0) * surfaceFactor(normal, to_sun, half_lambert) * sun_share;
  vec3 above = vec3(0.0, 1.0, 0.0);
  return vec2(sun, transmittance(light, above, lengths.y) * surfaceFactor(normal, above, half_lambert_sky));
}

void main() {
  shade.xy = shadeBy(lights.x, gains.x);
  shade.zw = lights.x == lights.y ? shade.xy : shadeBy(lights.y, gains.y);
}
