// cloudbake @version@: the body of a Custom node in Unreal, of the material that clouds have while a SceneCapture2D draws them. Inputs:
// Light, the output of LightOfLobe (through a VertexInterpolator node); Normal, VertexNormalWS; ToSun; Along, the PixelDepth;
// DepthRange, float 2: the distances where the depth is 0 and 1, in centimetres. Output: CMOT Float 3 (sun, sky, depth), for Emissive Color
// of an Unlit material. The capture has the opacity: its source is "SceneColor (HDR) in RGB, Inv Opacity in A".
struct Cloudbake {
#include "lobe.hlsl"

#include "channels.hlsl"
};
Cloudbake cloudbake;
const float2 shares = Light * float2(cloudbake.surfaceFactor(Normal, ToSun, @light_half_lambert@),
                                     cloudbake.surfaceFactor(Normal, float3(0.0, 0.0, 1.0), @light_half_lambert_sky@));
return cloudbake.channelsOf(shares, Along, DepthRange).xyw;
