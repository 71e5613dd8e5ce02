// cloudbake @version@: the body of a Custom node in Unreal: in a fade of a sequence, two segments share the pixels. Inputs: Pixel, the
// SvPosition of ScreenPosition; Shown, float 2: between which thresholds the segment is drawn: 0 and the weight of the later segment for
// that one, this weight and 1 for the earlier one, else 0 and 1. Output: CMOT Float 1, for Opacity Mask of a Masked material.
struct Cloudbake {
#include "noise.hlsl"

#include "soft.hlsl"
};
Cloudbake cloudbake;
const float threshold = cloudbake.ditherThreshold(Pixel);
return threshold >= Shown.x && threshold < Shown.y ? 1.0 : 0.0;
