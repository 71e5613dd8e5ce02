// cloudbake @version@: the body of a Custom node in Unreal, of a light function or of what a cloud casts its shadow on: the share of the
// sun's light. Inputs: Shadow, a texture object: the picture of `cloudbake shadow`, sRGB off, addressing Clamp; Place, WorldPosition less
// that of the cloud; Origin, Right, Up, ToSun, Width, Height, Top and Bottom: those of the JSON beside the picture, with y and z swapped,
// and the lengths in centimetres; Strength, 0 to 1. Output: CMOT Float 1.
struct Cloudbake {
#include "cast_shadow.hlsl"
};
Cloudbake cloudbake;
const float2 at = cloudbake.shadowPlace(Place, Origin, Right / Width, Up / Height);
const float transmittance = Shadow.SampleLevel(ShadowSampler, float2(at.x, 1.0 - at.y), 0.0).r;
return cloudbake.shadowFactor(transmittance, at, Strength * cloudbake.shadowDepth(Place, Origin, ToSun, Top, Bottom));
