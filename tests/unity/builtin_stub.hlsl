// What the shaders use of Unity's UnityCG.cginc, Lighting.cginc and AutoLight.cginc, as far as a compiler must know it.
#define fixed4 half4
#define CBUFFER_START(name) cbuffer name {
#define CBUFFER_END };
float4x4 unity_ObjectToWorld;
cbuffer PerFrame {
  float4x4 unity_MatrixV;
  float4 _WorldSpaceLightPos0, _LightColor0, _Time, _ZBufferParams, unity_LODFade;
  float3 _WorldSpaceCameraPos;
};
#define UNITY_MATRIX_M unity_ObjectToWorld
#define UNITY_MATRIX_V unity_MatrixV
#define UNITY_VERTEX_INPUT_INSTANCE_ID
#define UNITY_SETUP_INSTANCE_ID(input)
#define UNITY_TRANSFER_INSTANCE_ID(input, output)
#define UNITY_FOG_COORDS(index) float fogCoord : TEXCOORD##index;
#define UNITY_TRANSFER_FOG(output, position) output.fogCoord = position.z
#define UNITY_APPLY_FOG(coord, color) color *= coord
#define UNITY_APPLY_FOG_COLOR(coord, color, fog) color *= coord
#define UNITY_LIGHTING_COORDS(first, second) float3 lightCoord : TEXCOORD##first;
#define UNITY_TRANSFER_LIGHTING(output, uv) output.lightCoord = output.world
#define UNITY_LIGHT_ATTENUATION(name, input, place) float name = input.lightCoord.x
float3 UnityObjectToWorldNormal(float3 normal) { return normalize(mul((float3x3)unity_ObjectToWorld, normal)); }
float4 UnityObjectToClipPos(float4 position) { return mul(unity_ObjectToWorld, float4(position.xyz, 1)); }
