// cloudbake @version@: the vertices of a sequence (`cloudbake sequence --as picture`) in Unity, which CloudbakeSequence.cs plays.
// CloudbakeLook.hlsl includes it after the uniforms that it needs.
#ifndef CLOUDBAKE_SEQUENCE_INCLUDED
#define CLOUDBAKE_SEQUENCE_INCLUDED

#include "sequence.hlsl"

Texture2D<float4> sequence_keys;

// Textures of Unity begin at the bottom.
float3 sequenceKey(float2 at) {
  uint width, height;
  sequence_keys.GetDimensions(width, height);
  return sequence_keys.Load(int3(int(at.x), int(height) - 1 - int(at.y), 0)).rgb;
}

#include "sequence_keys.hlsl"

// A vertex at the moment, in object space. Unity's importers of glTF store 1 - v, and mirror x.
void objectVertex(float2 texel, out float3 position, out float3 normal, out float4 lobe) {
  float3 own = sequenceVertex(float2(texel.x, 1.0 - texel.y), normal, lobe);
  position = float3(-own.x, own.yz);
  normal = float3(-normal.x, normal.yz);
  lobe = float4(-lobe.x, lobe.yzw);
}

#endif
