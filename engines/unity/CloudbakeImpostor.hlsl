// cloudbake @version@: what CloudbakeImpostor.shader has in every render pipeline. Places are those of the file, whose x Unity's importers
// of glTF mirror.
#ifndef CLOUDBAKE_IMPOSTOR_INCLUDED
#define CLOUDBAKE_IMPOSTOR_INCLUDED

#include "CloudbakeLobe.hlsl"

#include "impostor.hlsl"

CBUFFER_START(UnityPerMaterial)
float _Exponent, _Extinction, _SunStrength, _OfVolume, _VolumeGain, _PhaseShare, _PhaseAsymmetry, _PhaseLimit;
float4 _AmbientSky, _AmbientGround, impostor_atlas, _Ball;
CBUFFER_END
Texture2D<float4> impostor_lobe, impostor_rest;
SamplerState samplerimpostor_lobe, samplerimpostor_rest;
// Textures of Unity begin at the bottom.
#define textureLod(image, at, level) image.SampleLevel(sampler##image, float2((at).x, 1.0 - (at).y), level)

#include "impostor_atlas.hlsl"

float3 mirroredX(float3 v) { return float3(-v.x, v.y, v.z); }

struct ImpostorSquare {
  float3 world;                // the corner
  float3 place, ray, to_eye;   // in radii, from the center
  float texels;
};

// `position`: a corner of the file's square. `axis` leads from the scene to a camera without perspective, `eye` is the place of another
// one. `side`: of a pixel of the picture, at the distance 1 where there is perspective.
ImpostorSquare impostorSquare(float3 position, float4x4 to_world, float3x3 to_object, float3 eye, float3 axis, bool has_perspective,
                              float side) {
  ImpostorSquare square;
  float3 center = mul(to_world, float4(_Ball.xyz, 1.0)).xyz;
  float3 towards = has_perspective ? eye - center : axis;
  float3 own_eye = mirroredX(mul(to_object, towards)) / _Ball.w;
  square.to_eye = normalize(own_eye);
  square.place = impostorCorner((position - _Ball.xyz).xy / _Ball.w, own_eye, has_perspective);
  square.ray = impostorRay(square.place, own_eye, has_perspective);
  float size = pow(abs(determinant((float3x3)to_world)), 1.0 / 3.0) * _Ball.w;
  square.texels = impostorTexels(has_perspective ? side * length(towards) : side, size, impostor_atlas.y);
  square.world = center + mul((float3x3)to_world, mirroredX(square.place) * _Ball.w);
  return square;
}

// The shares of the light of sun and sky, and the opacity.
float3 impostorLight(float3 place, float3 ray, float3 to_eye, float texels, float3x3 to_world, float3 to_sun) {
  float3 rest;
  float4 own = impostorSeen(place, ray, normalize(to_eye), texels, rest);
  float4 lobe = lobeInWorld(float4(mirroredX(own.xyz), own.w), to_world);
  float2 shape = float2(_Exponent, 0.0);
  float sun = lerp(1.0, _VolumeGain, _OfVolume) * rest.x * lobeTransmittance(lobe, to_sun, shape, _Extinction);
  return float3(min(sun, 1.0), rest.x * lobeTransmittance(lobe, float3(0.0, 1.0, 0.0), shape, _Extinction), rest.z);
}

#endif
