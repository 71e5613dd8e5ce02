// cloudbake @version@: the body of a Custom node in Unreal: the light of a lamp at a vertex; add it to that of ColorOfLight (through a
// VertexInterpolator node, so that it is computed per vertex). Inputs: Vector, the output of DecodeLobe after a TransformVector node from
// local to world space; Place, WorldPosition; Normal, VertexNormalWS; LampPlace; LampColor, linear, at a distance of a metre; Range, in
// centimetres, 0: without end; Axis, the unit vector in which a spotlight shines; Cone, float 2: the cosines of its inner and outer angle,
// (-1, -1) of a point light. Output: CMOT Float 3.
#structure Cloudbake lobe lamp
Cloudbake cloudbake;
const float2 shape = float2(@exponent@, @bias@ * 100.0);  // k, and b in centimetres
const float extinction = @extinction@ / 100.0;            // per centimetre
const float thickness = length(Vector);
const float4 lobe = float4(thickness > 0.0 ? Vector / thickness : float3(0.0, 0.0, -1.0), thickness);
const Lamp lamp = cloudbake.makeLamp(LampPlace, LampColor * 10000.0, Range, 0.0, Axis, Cone);  // a metre is 100 centimetres
return cloudbake.lampLight(lamp, lobe, Place, Normal, 1.0, shape, extinction);
