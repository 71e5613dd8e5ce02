// The lobe of a vertex: how much light reaches it through the cloud. The same as core/lobe_lighting.h and core/lobe_packing.h.

// The direction o towards the cloud's bulk and the thickness d from the two UV sets. 'flipped': 1.0 if the importer stored 1 - v, as
// engines do whose textures begin at the bottom.
vec4 unpackLobe(vec2 first, vec2 second, float flipped) {
  return vec4(first.x, mix(first.y, 1.0 - first.y, flipped), second.x, mix(second.y, 1.0 - second.y, flipped));
}

// The lobe in the world: the vector o * d is moved by the model's matrix.
vec4 lobeInWorld(vec4 lobe, mat3 to_world) {
  vec3 moved = to_world * (lobe.xyz * lobe.w);
  float thickness = length(moved);
  if (!(thickness > 0.0)) {
    return vec4(lobe.xyz, 0.0);
  }
  return vec4(moved / thickness, thickness);
}

// x^k for x >= 0; k = 3 and k = 4, which bakes have most, by multiplication.
float lobePower(float x, float exponent) {
  if (exponent == 3.0) {
    return x * x * x;
  }
  if (exponent == 4.0) {
    return (x * x) * (x * x);
  }
  return pow(x, exponent);
}

// How much cloud lies between the vertex and a light, world units. 'shape': k and b of asset.extras.cloudbake.
float lobeThickness(vec4 lobe, vec3 to_light, vec2 shape) {
  float half_cosine = max(0.0, dot(to_light, lobe.xyz) * 0.5 + 0.5);
  return max(0.0, lobePower(half_cosine, shape.x) * lobe.w + shape.y);
}

// The share of light that comes through, 0 to 1. 'extinction': sigma per world unit.
float lobeTransmittance(vec4 lobe, vec3 to_light, vec2 shape, float extinction) {
  return exp(-extinction * lobeThickness(lobe, to_light, shape));
}

// The share of the sun that a surface shows: 'half_lambert' = 1.0 is the lobe alone, less mixes in how the surface faces the sun.
float surfaceFactor(vec3 normal, vec3 to_sun, float half_lambert) {
  return mix(half_lambert, 1.0, dot(normal, to_sun) * 0.5 + 0.5);
}
