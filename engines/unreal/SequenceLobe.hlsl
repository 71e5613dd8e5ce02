// cloudbake @version@: the body of a Custom node in Unreal: the lobe of a vertex of a sequence, in place of DecodeLobe.hlsl. Inputs: those
// of SequencePosition.hlsl. Output: CMOT Float 3, the vector o * d in the mesh's space, in centimetres.
struct Cloudbake {
Texture2D<float4> sequence_keys;
float3 sequence_low, sequence_high, sequence_place;
float2 sequence_moment;
float sequence_densest;
#include "lobe.hlsl"

#include "sequence.hlsl"

float3 sequenceKey(float2 at) {
  return sequence_keys.Load(int3(at, 0)).rgb;
}

#include "sequence_keys.hlsl"
};
Cloudbake cloudbake;
cloudbake.sequence_keys = KeysPicture;
cloudbake.sequence_low = Low;
cloudbake.sequence_high = High;
cloudbake.sequence_densest = Densest;
cloudbake.sequence_place = Place;
cloudbake.sequence_moment = Moment;
float3 normal;
float4 lobe;
cloudbake.sequenceVertex(Texel, normal, lobe);
return lobe.xzy * (lobe.w * 100.0);
