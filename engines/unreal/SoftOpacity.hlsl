// cloudbake @version@: the body of a Custom node in Unreal: soft rims and fades without passes after the clouds. Inputs: Normal,
// PixelNormalWS; View, the unit vector from the eye (CameraVectorWS times -1); OwnPlace, LocalPosition in metres (divided by 100);
// Seconds, the Time node; Pixel, the SvPosition of ScreenPosition; Along, PixelDepth; Away, the distance to the eye; Solid, SceneDepth (of
// a Translucent material; else a large number); Rim, float 2: |facing| where the surface begins and is whole; Noise, float 4: cells per
// metre, and how many it moves in a second along x, y, z; SoftDistance; NearFade and FarFade, float 2, in centimetres (0: none). Output:
// CMOT Float 2: the opacity for a Translucent material, and the same by dither, for Opacity Mask of a Masked one.
struct Cloudbake {
#include "noise.hlsl"

#include "soft.hlsl"
};
Cloudbake cloudbake;
const float noise = Rim.y > 0.0 ? cloudbake.rimNoise(OwnPlace, Noise.x, Noise.yzw * Seconds) : 0.0;
const float opacity = cloudbake.rimOpacity(abs(dot(Normal, View)), noise, Rim) * cloudbake.fadeBetween(Solid - Along, 0.0, SoftDistance)
                      * cloudbake.fadeBetween(Away, NearFade.x, NearFade.y) * cloudbake.fadeBetween(Along, FarFade.y, FarFade.x);
return float2(opacity, opacity > cloudbake.ditherThreshold(Pixel) ? 1.0 : 0.0);
