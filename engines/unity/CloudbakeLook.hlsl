// cloudbake @version@: what Cloudbake.shader has in every render pipeline: the properties of the material, and which pixels are drawn.
#ifndef CLOUDBAKE_LOOK_INCLUDED
#define CLOUDBAKE_LOOK_INCLUDED

#include "CloudbakeLobe.hlsl"

CBUFFER_START(UnityPerMaterial)
float _Exponent, _Bias, _Extinction, _DensityMax, _SunStrength, _HalfLambert, _PhaseShare, _PhaseAsymmetry, _PhaseLimit;
float _RimStart, _RimEnd, _RimFrequency, _SoftDistance, _AlphaToMask;
float4 _RimScroll, _NearFade, _FarFade, _AmbientSky, _AmbientGround;
float4 sequence_low, sequence_high, sequence_place, sequence_moment, _SequenceShown;
float sequence_densest;
CBUFFER_END
Texture2D<float4> _CameraDepthTexture;

// The lobe of a vertex in the world.
float4 worldLobe(float2 first, float2 second) {
  return lobeInWorld(objectLobe(first, second, _DensityMax), (float3x3)UNITY_MATRIX_M);
}

#ifdef CLOUDBAKE_SEQUENCE
#include "CloudbakeSequence.hlsl"

// The same of a sequence, with the position and the normal in object space.
float4 worldVertex(float2 texel, out float3 position, out float3 normal) {
  float4 lobe;
  objectVertex(texel, position, normal, lobe);
  return lobeInWorld(lobe, (float3x3)UNITY_MATRIX_M);
}
#endif

// The shares of the light of sun and sky.
float2 sunAndSky(float4 lobe, float3 normal, float3 to_sun) {
  float2 shape = float2(_Exponent, _Bias);
  return float2(lobeTransmittance(lobe, to_sun, shape, _Extinction) * surfaceFactor(normal, to_sun, _HalfLambert),
                lobeTransmittance(lobe, float3(0.0, 1.0, 0.0), shape, _Extinction));
}

// A lamp of Unity at a vertex: `color` is its light there, past its range and its cone.
float3 lampShare(float3 lamp_place, float3 color, float4 lobe, float3 place, float3 normal) {
  float3 way = lamp_place - place;
  Lamp lamp = makeLamp(lamp_place, color * dot(way, way), 0.0, 0.0, float3(0.0, 1.0, 0.0), float2(-1.0, -1.0));
  return lampLight(lamp, lobe, place, normal, _HalfLambert, float2(_Exponent, _Bias), _Extinction);
}

// How much of the cloud is drawn at a pixel. `along` is its distance along the view's axis, `zbuffer` is _ZBufferParams.
float opacityAt(float4 pixel, float3 own_place, float3 normal, float3 from_eye, float along, float4 zbuffer) {
  float away = length(from_eye);
  float noise = _RimEnd > 0.0 ? rimNoise(own_place, _RimFrequency, _RimScroll.xyz * _Time.y) : 0.0;
  float opacity = rimOpacity(abs(dot(normalize(normal), from_eye / away)), noise, float2(_RimStart, _RimEnd));
  if (_SoftDistance > 0.0) {
    float solid = 1.0 / (zbuffer.z * _CameraDepthTexture.Load(int3(pixel.xy, 0)).x + zbuffer.w);
    opacity *= fadeBetween(solid - along, 0.0, _SoftDistance);
  }
  return opacity * fadeBetween(away, _NearFade.x, _NearFade.y) * fadeBetween(along, _FarFade.y, _FarFade.x);
}

// Leaves pixels out, unless the samples of a pixel do it. `fade` is unity_LODFade.x: between two levels each has a share of the pixels, and
// so has each of two segments of a sequence.
void leaveOut(float4 pixel, float opacity, float fade) {
  float threshold = ditherThreshold(pixel.xy);
  if (_AlphaToMask < 0.5 && opacity <= threshold) discard;
#ifdef CLOUDBAKE_SEQUENCE
  float of_segment = ditherThreshold(pixel.xy + 16.0);
  if (of_segment < _SequenceShown.x || of_segment >= _SequenceShown.y) discard;
#endif
#ifdef LOD_FADE_CROSSFADE
  float of_level = ditherThreshold(pixel.xy + 32.0);
  if (fade >= 0.0 ? of_level >= fade : of_level < -fade) discard;
#endif
}

#endif
