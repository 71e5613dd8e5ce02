// cloudbake @version@: the lobes of mesh clouds in Unity. The shaders use this file, and so can a Custom Function node of Shader
// Graph (CloudbakeLight). docs/engines/unity.md has the steps.
#ifndef CLOUDBAKE_LOBE_INCLUDED
#define CLOUDBAKE_LOBE_INCLUDED

#include "lobe.hlsl"

#include "light.hlsl"

#include "lamp.hlsl"

#include "cast_shadow.hlsl"
#include "cloud_shade.hlsl"

#include "noise.hlsl"

#include "soft.hlsl"

// The lobe of a vertex in object space. Unity's importers of glTF store 1 - v, and mirror x for its left-handed space.
// `density_max`: of a packed asset, else 0.
float4 objectLobe(float2 first, float2 second, float density_max) {
  float4 lobe = decodeLobe(first, second, 1.0, density_max);
  return float4(-lobe.x, lobe.yzw);
}

// For Shader Graph, in the vertex stage: the shares of the light of sun and sky. `to_sun` is a unit vector in world space.
// CloudbakeLight is for assets that are not packed.
void CloudbakePackedLight_float(float2 first, float2 second, float3 to_sun, float exponent, float bias, float extinction, float density_max,
                                out float sun, out float sky) {
  float4 lobe = lobeInWorld(objectLobe(first, second, density_max), (float3x3)UNITY_MATRIX_M);
  sun = lobeTransmittance(lobe, to_sun, float2(exponent, bias), extinction);
  sky = lobeTransmittance(lobe, float3(0.0, 1.0, 0.0), float2(exponent, bias), extinction);
}
void CloudbakeLight_float(float2 first, float2 second, float3 to_sun, float exponent, float bias, float extinction,
                          out float sun, out float sky) {
  CloudbakePackedLight_float(first, second, to_sun, exponent, bias, extinction, 0.0, sun, sky);
}

#endif
