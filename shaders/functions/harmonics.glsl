// Spherical harmonics of the transmittance of a vertex, up to band 3. The same as core/harmonics.h and placedTransmittance
// (preview/mesh_clouds/lit_mesh.h).

// The share of light that comes through, 0 to 1. 'coefficients': the 1, 4, 9 or 16 of a vertex, in order, then zeros; 'd': the unit
// direction of the light in the axes of the coefficients.
float harmonicTransmittance(mat4 coefficients, vec3 d) {
  vec3 square = d * d;
  vec4 first = vec4(0.28209479, 0.48860251 * d.y, 0.48860251 * d.z, 0.48860251 * d.x);
  vec4 second = vec4(1.09254843 * d.x * d.y, 1.09254843 * d.y * d.z, 0.31539157 * (3.0 * square.z - 1.0), 1.09254843 * d.x * d.z);
  vec4 third = vec4(0.54627422 * (square.x - square.y), 0.59004359 * d.y * (3.0 * square.x - square.y), 2.89061144 * d.x * d.y * d.z,
                    0.45704580 * d.y * (5.0 * square.z - 1.0));
  vec4 fourth = vec4(0.37317633 * d.z * (5.0 * square.z - 3.0), 0.45704580 * d.x * (5.0 * square.z - 1.0),
                     1.44530572 * d.z * (square.x - square.y), 0.59004359 * d.x * (square.x - 3.0 * square.y));
  float sum = dot(coefficients[0], first) + dot(coefficients[1], second) + dot(coefficients[2], third) + dot(coefficients[3], fourth);
  return clamp(sum, 0.0, 1.0);
}

// The same in the world. 'to_own': the inverse of the model's matrix; 'own': the extinction for which the harmonics were made, per unit
// of the model; 'extinction': the one of now, per world unit.
float placedHarmonicTransmittance(mat4 coefficients, vec3 to_light, mat3 to_own, float own, float extinction) {
  vec3 back = to_own * to_light;
  float stretch = length(back);
  float through = harmonicTransmittance(coefficients, back / stretch);
  float power = extinction / (own * stretch);
  return abs(power - 1.0) < 1e-5 ? through : pow(through, power);
}
