// cloudbake @version@: the body of a Custom node in Unreal. Inputs: Vector, the output of DecodeLobe after a TransformVector node from
// local to world space; ToSun, the unit vector to the sun in world space. Output: CMOT Float 2, the shares of the light of sun and sky.
struct Cloudbake {
#include "lobe.hlsl"

#include "light.hlsl"
};
Cloudbake cloudbake;
const float2 shape = float2(@exponent@, @bias@ * 100.0);  // k, and b in centimetres
const float extinction = @extinction@ / 100.0;            // per centimetre
const float thickness = length(Vector);
const float4 lobe = float4(thickness > 0.0 ? Vector / thickness : float3(0.0, 0.0, -1.0), thickness);
return float2(cloudbake.lobeTransmittance(lobe, ToSun, shape, extinction),
              cloudbake.lobeTransmittance(lobe, float3(0.0, 0.0, 1.0), shape, extinction));
