// The lobe of a vertex: how much light reaches it through the cloud. The same functions as in preview/glsl/lobe.glsl. Matrices are
// multiplied from the left, mul(M, v); in a constant buffer, row_major says how they lie in memory.

// The direction o towards the cloud's bulk and the thickness d from the two UV sets. `flipped`: 1.0 if the importer stored 1 - v.
float4 unpackLobe(float2 first, float2 second, float flipped) {
  return float4(first.x, lerp(first.y, 1.0 - first.y, flipped), second.x, lerp(second.y, 1.0 - second.y, flipped));
}

// The lobe in the world: the vector o * d is moved by the model's matrix.
float4 lobeInWorld(float4 lobe, float3x3 to_world) {
  float3 moved = mul(to_world, lobe.xyz * lobe.w);
  float thickness = length(moved);
  if (!(thickness > 0.0)) {
    return float4(lobe.xyz, 0.0);
  }
  return float4(moved / thickness, thickness);
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

// How much cloud lies between the vertex and a light, world units. `shape`: k and b of asset.extras.cloudbake.
float lobeThickness(float4 lobe, float3 to_light, float2 shape) {
  float half_cosine = max(0.0, dot(to_light, lobe.xyz) * 0.5 + 0.5);
  return max(0.0, lobePower(half_cosine, shape.x) * lobe.w + shape.y);
}

// The share of light that comes through, 0 to 1. `extinction`: sigma per world unit.
float lobeTransmittance(float4 lobe, float3 to_light, float2 shape, float extinction) {
  return exp(-extinction * lobeThickness(lobe, to_light, shape));
}

// The share of the sun that a surface shows: `half_lambert` = 1.0 is the lobe alone, less mixes in how the surface faces the sun.
float surfaceFactor(float3 normal, float3 to_sun, float half_lambert) {
  return lerp(half_lambert, 1.0, dot(normal, to_sun) * 0.5 + 0.5);
}
