// cloudbake @version@: a mesh cloud in Unity's Universal Render Pipeline, lit by the main light and the sky through its lobes.
// The lobes must be in the mesh's UV sets @first_set@ and @second_set@; docs/engines/unity.md has the steps.
Shader "Cloudbake/Cloud" {
  Properties {
    [Header(From the asset)]
    _Exponent ("Exponent k", Float) = @exponent@
    _Bias ("Bias b, world units", Float) = @bias@
    _Extinction ("Extinction sigma, per world unit", Float) = @extinction@
    [Header(Light)]
    _SunStrength ("Strength of the main light", Float) = 1
    _AmbientSky ("Light of the sky", Color) = (0.32, 0.42, 0.62, 1)
    _AmbientGround ("Light in the shadow", Color) = (0.16, 0.17, 0.21, 1)
    _HalfLambert ("Half-Lambert: 1 is the lobe alone", Range(0, 1)) = 1
    [Header(Phase)]
    _PhaseShare ("Share: 0 is without", Range(0, 1)) = 0
    _PhaseAsymmetry ("Asymmetry g", Range(0, 0.95)) = 0.6
    _PhaseLimit ("Limit", Float) = 4
  }
  SubShader {
    Tags { "RenderPipeline" = "UniversalPipeline" "RenderType" = "Opaque" "Queue" = "Geometry" }
    Pass {
      Tags { "LightMode" = "UniversalForward" }
      HLSLPROGRAM
      #pragma vertex vertex
      #pragma fragment fragment
      #pragma multi_compile_instancing
      #pragma multi_compile_fog
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Lighting.hlsl"
      #include "CloudbakeLobe.hlsl"

      CBUFFER_START(UnityPerMaterial)
      float _Exponent, _Bias, _Extinction, _SunStrength, _HalfLambert, _PhaseShare, _PhaseAsymmetry, _PhaseLimit;
      float4 _AmbientSky, _AmbientGround;
      CBUFFER_END

      struct Attributes {
        float3 position : POSITION;
        float3 normal : NORMAL;
        float2 first : TEXCOORD@first_set@;
        float2 second : TEXCOORD@second_set@;
        UNITY_VERTEX_INPUT_INSTANCE_ID
      };
      struct Varyings {
        float4 position : SV_POSITION;
        float2 light : TEXCOORD0;  // the shares of sun and sky
        float3 world : TEXCOORD1;
        float fog : TEXCOORD2;
      };

      Varyings vertex(Attributes input) {
        UNITY_SETUP_INSTANCE_ID(input);
        Varyings output;
        float3 to_sun = GetMainLight().direction;
        CloudbakeLight_float(input.first, input.second, to_sun, _Exponent, _Bias, _Extinction, output.light.x, output.light.y);
        output.light.x *= surfaceFactor(TransformObjectToWorldNormal(input.normal), to_sun, _HalfLambert);
        output.world = TransformObjectToWorld(input.position);
        output.position = TransformWorldToHClip(output.world);
        output.fog = ComputeFogFactor(output.position.z);
        return output;
      }

      half4 fragment(Varyings input) : SV_Target {
        Light sun = GetMainLight();
        float3 view = normalize(input.world - GetCameraPositionWS());
        float factor = _SunStrength * phaseFactor(view, sun.direction, _PhaseShare, _PhaseAsymmetry, _PhaseLimit);
        float3 color = cloudColor(input.light.x, input.light.y, factor * sun.color, _AmbientSky.rgb, _AmbientGround.rgb);
        return half4(MixFog(color, input.fog), 1);
      }
      ENDHLSL
    }
  }
}
