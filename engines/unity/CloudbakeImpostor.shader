// cloudbake @version@: a lobe impostor (`cloudbake impostor`) in Unity, which turns to the camera and is lit like the cloud: in the
// Universal Render Pipeline and in the built-in one. Assets > Cloudbake > Create Impostor makes its material.
Shader "Cloudbake/Impostor" {
  Properties {
    [Header(From the file)]
    [NoScaleOffset] impostor_lobe ("impostor_lobe.png, linear", 2D) = "black" {}
    [NoScaleOffset] impostor_rest ("impostor_rest.png, linear", 2D) = "black" {}
    impostor_atlas ("Views, pixels of a view, last mip level, thickest", Vector) = (8, 64, 4, 1)
    _Ball ("Center and radius of the ball", Vector) = (0, 0, 0, 1)
    _Exponent ("Exponent k", Float) = @exponent@
    _Extinction ("Extinction sigma, per world unit", Float) = @extinction@
    _OfVolume ("1: the light is that of a volume", Float) = 0
    [Header(Light)]
    _SunStrength ("Strength of the main light", Float) = 1
    _VolumeGain ("Gain of the main light through a volume", Float) = 1
    _AmbientSky ("Light of the sky", Color) = (0.32, 0.42, 0.62, 1)
    _AmbientGround ("Light in the shadow", Color) = (0.16, 0.17, 0.21, 1)
    [Header(Phase)]
    _PhaseShare ("Share: 0 is without", Range(0, 1)) = 0
    _PhaseAsymmetry ("Asymmetry g", Range(0, 0.95)) = 0.6
    _PhaseLimit ("Limit", Float) = 4
  }

  SubShader {
    PackageRequirements { "com.unity.render-pipelines.universal": "14.0" }
    Tags { "RenderPipeline" = "UniversalPipeline" "RenderType" = "Transparent" "Queue" = "Transparent" "DisableBatching" = "True" }
    Pass {
      Tags { "LightMode" = "UniversalForward" }
      Blend SrcAlpha OneMinusSrcAlpha
      ZWrite Off
      Cull Off
      HLSLPROGRAM
      #pragma target 3.5
      #pragma vertex vertex
      #pragma fragment fragment
      #pragma multi_compile_instancing
      #pragma multi_compile_fog
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Lighting.hlsl"
      #include "CloudbakeImpostor.hlsl"

      struct Attributes {
        float3 position : POSITION;
        UNITY_VERTEX_INPUT_INSTANCE_ID
      };
      struct Varyings {
        float4 position : SV_POSITION;
        float4 world : TEXCOORD0;  // and the fog
        float3 place : TEXCOORD1;
        float3 ray : TEXCOORD2;
        float4 to_eye : TEXCOORD3;  // and texels
        UNITY_VERTEX_INPUT_INSTANCE_ID
      };

      Varyings vertex(Attributes input) {
        UNITY_SETUP_INSTANCE_ID(input);
        Varyings output = (Varyings)0;
        UNITY_TRANSFER_INSTANCE_ID(input, output);
        ImpostorSquare square = impostorSquare(input.position, UNITY_MATRIX_M, (float3x3)UNITY_MATRIX_I_M, GetCameraPositionWS(),
          UNITY_MATRIX_V[2].xyz, unity_OrthoParams.w == 0.0, 2.0 / (abs(UNITY_MATRIX_P[1][1]) * _ScreenParams.y));
        output.position = TransformWorldToHClip(square.world);
        output.world = float4(square.world, ComputeFogFactor(output.position.z));
        output.place = square.place;
        output.ray = square.ray;
        output.to_eye = float4(square.to_eye, square.texels);
        return output;
      }

      half4 fragment(Varyings input) : SV_Target {
        UNITY_SETUP_INSTANCE_ID(input);
        Light sun = GetMainLight();
        float3 light = impostorLight(input.place, input.ray, input.to_eye.xyz, input.to_eye.w, (float3x3)UNITY_MATRIX_M, sun.direction);
        float3 view = normalize(input.world.xyz - GetCameraPositionWS());
        float factor = _SunStrength * phaseFactor(view, sun.direction, _PhaseShare, _PhaseAsymmetry, _PhaseLimit);
        float3 color = cloudColor(light.x, light.y, factor * sun.color, _AmbientSky.rgb, _AmbientGround.rgb);
        return half4(MixFog(color, input.world.w), light.z);
      }
      ENDHLSL
    }
  }

  SubShader {
    Tags { "RenderType" = "Transparent" "Queue" = "Transparent" "DisableBatching" = "True" }
    Pass {
      Tags { "LightMode" = "ForwardBase" }
      Blend SrcAlpha OneMinusSrcAlpha
      ZWrite Off
      Cull Off
      CGPROGRAM
      #pragma target 3.5
      #pragma vertex vertex
      #pragma fragment fragment
      #pragma multi_compile_instancing
      #pragma multi_compile_fog
      #include "UnityCG.cginc"
      #include "Lighting.cginc"
      #include "CloudbakeImpostor.hlsl"

      struct Attributes {
        float4 vertex : POSITION;
        UNITY_VERTEX_INPUT_INSTANCE_ID
      };
      struct Varyings {
        float4 pos : SV_POSITION;
        float3 world : TEXCOORD0;
        float3 place : TEXCOORD1;
        float3 ray : TEXCOORD2;
        float4 to_eye : TEXCOORD3;  // and texels
        UNITY_FOG_COORDS(4)
        UNITY_VERTEX_INPUT_INSTANCE_ID
      };

      Varyings vertex(Attributes v) {
        UNITY_SETUP_INSTANCE_ID(v);
        Varyings output = (Varyings)0;
        UNITY_TRANSFER_INSTANCE_ID(v, output);
        ImpostorSquare square = impostorSquare(v.vertex.xyz, unity_ObjectToWorld, (float3x3)unity_WorldToObject, _WorldSpaceCameraPos,
          UNITY_MATRIX_V[2].xyz, unity_OrthoParams.w == 0.0, 2.0 / (abs(UNITY_MATRIX_P[1][1]) * _ScreenParams.y));
        output.pos = mul(UNITY_MATRIX_VP, float4(square.world, 1.0));
        output.world = square.world;
        output.place = square.place;
        output.ray = square.ray;
        output.to_eye = float4(square.to_eye, square.texels);
        UNITY_TRANSFER_FOG(output, output.pos);
        return output;
      }

      half4 fragment(Varyings input) : SV_Target {
        UNITY_SETUP_INSTANCE_ID(input);
        float3 to_sun = _WorldSpaceLightPos0.xyz;
        float3 light = impostorLight(input.place, input.ray, input.to_eye.xyz, input.to_eye.w, (float3x3)unity_ObjectToWorld, to_sun);
        float3 view = normalize(input.world - _WorldSpaceCameraPos);
        float factor = _SunStrength * phaseFactor(view, to_sun, _PhaseShare, _PhaseAsymmetry, _PhaseLimit);
        float3 color = cloudColor(light.x, light.y, factor * _LightColor0.rgb, _AmbientSky.rgb, _AmbientGround.rgb);
        UNITY_APPLY_FOG(input.fogCoord, color);
        return half4(color, light.z);
      }
      ENDCG
    }
  }
}
