// The lobe of a vertex: how much light reaches it through the cloud. The same as core/lobe_lighting.h and core/lobe_packing.h.

// The direction o towards the cloud's bulk and the thickness d from the two UV sets. 'flipped': 1.0 if the importer stored 1 - v, as
// engines do whose textures begin at the bottom.
vec4 unpackLobe(vec2 first, vec2 second, float flipped) {
  return vec4(first.x, mix(first.y, 1.0 - first.y, flipped), second.x, mix(second.y, 1.0 - second.y, flipped));
}

// A direction from the octahedron that is unfolded to the square: 'place' is -1 to 1 along both axes.
vec3 octahedralDirection(vec2 place) {
  float height = 1.0 - abs(place.x) - abs(place.y);
  float fold = max(-height, 0.0);
  float x = place.x - (place.x < 0.0 ? -fold : fold);
  float y = place.y - (place.y < 0.0 ? -fold : fold);
  return normalize(vec3(x, y, height));
}

// The lobe of any asset. 'density_max': of asset.extras.cloudbake, if the asset is packed, else 0.0. Of packed ones the sets have o on the
// octahedron and, as the second number of the second set, the root of d / density_max.
vec4 decodeLobe(vec2 first, vec2 second, float flipped, float density_max) {
  vec4 stored = unpackLobe(first, second, flipped);
  if (density_max > 0.0) {
    return vec4(octahedralDirection(stored.xy), density_max * stored.w * stored.w);
  }
  return stored;
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
