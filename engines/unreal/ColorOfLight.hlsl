// cloudbake @version@: the body of a Custom node in Unreal. Inputs: Light, the output of LightOfLobe (through a VertexInterpolator node, so
// that it is computed per vertex); SunColor, AmbientSky, AmbientGround, linear colours; View, the unit vector from the eye (CameraVectorWS
// times -1); ToSun; Phase, float 3: share, asymmetry, limit (share 0 leaves the phase out). Output: CMOT Float 3, for Emissive Color of an
// Unlit material.
struct Cloudbake {
#include "light.hlsl"
};
Cloudbake cloudbake;
const float factor = cloudbake.phaseFactor(View, ToSun, Phase.x, Phase.y, Phase.z);
return cloudbake.cloudColor(Light.x, Light.y, SunColor * factor, AmbientSky, AmbientGround);
