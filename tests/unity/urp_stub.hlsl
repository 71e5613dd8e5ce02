// What Cloudbake.shader uses of the libraries of the Universal Render Pipeline, as far as a compiler must know it.
float4x4 unity_ObjectToWorld;
float3 _WorldSpaceCameraPos;
#define UNITY_MATRIX_M unity_ObjectToWorld
#define UNITY_VERTEX_INPUT_INSTANCE_ID
#define UNITY_SETUP_INSTANCE_ID(input)
#define CBUFFER_START(name) cbuffer name {
#define CBUFFER_END };
struct Light { half3 direction; half3 color; half distanceAttenuation; };
Light GetMainLight() {
  Light light;
  light.direction = half3(0, 1, 0);
  light.color = half3(1, 1, 1);
  light.distanceAttenuation = 1;
  return light;
}
float3 TransformObjectToWorld(float3 position) { return mul(unity_ObjectToWorld, float4(position, 1)).xyz; }
float3 TransformObjectToWorldNormal(float3 normal) { return normal; }
float4 TransformWorldToHClip(float3 position) { return float4(position, 1); }
float3 GetCameraPositionWS() { return _WorldSpaceCameraPos; }
float ComputeFogFactor(float depth) { return depth; }
float3 MixFog(float3 color, float factor) { return color * factor; }
float4 _Time, _ZBufferParams, unity_LODFade;
#define UNITY_TRANSFER_INSTANCE_ID(input, output)
float3 TransformWorldToView(float3 position) { return position; }
float4 _AdditionalLightsPosition[16];
uint GetAdditionalLightsCount() { return 2u; }
int GetPerObjectLightIndex(uint index) { return int(index); }
Light GetAdditionalLight(uint index, float3 position) { return GetMainLight(); }
