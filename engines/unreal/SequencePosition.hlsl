// cloudbake @version@: the body of a Custom node in Unreal: the position of a vertex of a sequence (`cloudbake sequence --as picture`).
// Inputs: Texel, the TextureCoordinate 2; KeysPicture, a texture object: the picture `keys` of the file, sRGB off, uncompressed, without
// mip levels; Low and High, float 3, and Densest: box and density_max of the sequence, as the file has them; Place, float 3: of the segment
// its first_row, the rows that its vertices need (their number over 1024, rounded up), and how many keys it has; Moment, float 2: the last
// key that is not after the moment, and the share of the way to the next one. Output: CMOT Float 3, the position in the mesh's space, in
// centimetres. docs/engines/unreal.md has the steps.
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
const float3 position = cloudbake.sequenceVertex(Texel, normal, lobe);
// Unreal swaps y and z of what it imports, and scales metres to centimetres.
return position.xzy * 100.0;
